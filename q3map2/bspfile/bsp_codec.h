// GPL-2.0-or-later. What the .bsp formats share: parts and bytes of files, and the decoder and encoder of a format.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// Position rounded up to the next multiple of 4.
constexpr std::uint64_t Align4(std::uint64_t position) {
    return (position + 3) & ~std::uint64_t(3);
}

/// A part of a file. 64 bits, so that sums of untrusted 32-bit values cannot wrap.
struct FilePart {
    std::int64_t offset = 0, length = 0;
    std::int64_t End() const { return offset + length; }
};

/// Loads a record from byte `at`, which need not be aligned.
template <typename Record> Record LoadRecord(std::span<const std::byte> bytes, std::size_t at) {
    Record record;
    std::memcpy(&record, bytes.data() + at, sizeof record);
    return record;
}

/// Where a file is read from: memory or disk.
struct ByteSource {
    std::uint64_t size = 0;
    std::function<void(std::uint64_t at, std::span<std::byte> into)> read; ///< the range must lie in the file

    /// Reads consecutive records from byte `at`.
    template <typename Record> void Fill(std::uint64_t at, std::span<Record> records) const {
        static_assert(std::is_trivially_copyable_v<Record>);
        if (!records.empty())
            read(at, std::as_writable_bytes(records));
    }
};

/// Consecutive ranges of memory: a lump or a file that is to be written. Most of them point into the Bsp, which must
/// outlive this; others are copies that it owns.
class ByteRanges {
  public:
    using Append = std::function<void(std::span<const std::byte>)>;

    ByteRanges() = default;
    ByteRanges(ByteRanges &&) = default;
    ByteRanges &operator=(ByteRanges &&) = default;

    /// Appends the bytes of records, which stay where they are.
    template <typename Record> void Add(std::span<const Record> records) {
        ranges_.push_back(std::as_bytes(records));
        size_ += ranges_.back().size();
    }
    template <typename Record> void Add(const std::vector<Record> &records) { Add(std::span(records)); }
    /// Appends bytes that this keeps.
    void AddOwned(std::vector<std::byte> bytes) {
        owned_.push_back(std::move(bytes));
        Add(owned_.back());
    }
    /// Appends a copy of a record.
    template <typename Record> void AddCopy(const Record &record) {
        const auto bytes = std::as_bytes(std::span(&record, 1));
        AddOwned({bytes.begin(), bytes.end()});
    }
    /// Appends another list of ranges, then zeros up to the next multiple of 4 bytes.
    void AddPadded(ByteRanges lump) {
        const std::uint64_t size = lump.Size();
        ranges_.insert(ranges_.end(), lump.ranges_.begin(), lump.ranges_.end());
        for (std::vector<std::byte> &bytes : lump.owned_)
            owned_.push_back(std::move(bytes));
        size_ += size;
        if (Align4(size) != size)
            AddOwned(std::vector<std::byte>(std::size_t(Align4(size) - size)));
    }

    std::uint64_t Size() const { return size_; }
    /// Appends all bytes in order.
    void Write(const Append &append) const {
        for (const std::span<const std::byte> range : ranges_)
            append(range);
    }
    /// All bytes in order.
    std::vector<std::byte> Bytes() const {
        std::vector<std::byte> bytes;
        bytes.reserve(std::size_t(size_));
        Write([&bytes](std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); });
        return bytes;
    }

  private:
    std::vector<std::span<const std::byte>> ranges_;
    std::vector<std::vector<std::byte>> owned_;
    std::uint64_t size_ = 0;
};

/// A .bsp format. Its row is in bspfile.cpp.
struct BspCodec {
    std::string_view ident; ///< the first four bytes of a file; BspFormat::ident
    /// A whole file as records. `name` is for messages. Errors: Error, one line, for bytes that are no records;
    /// ReadBspFrom validates what the records say.
    Bsp (*decode)(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log);
    /// The bytes of the file. Errors: those of WriteBsp.
    ByteRanges (*encode)(const Bsp &bsp, const BspFormat &format);
};

} // namespace q3
