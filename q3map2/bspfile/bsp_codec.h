// GPL-2.0-or-later. What the .bsp formats share: parts and bytes of files, lumps by slot, and the decoder and encoder
// of a format.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <iterator>
#include <span>
#include <string>
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

/// Lump names for messages, by slot.
inline constexpr std::array<std::string_view, kNumLumps> kLumpNames = {
    "entities",  "shaders",    "planes",     "nodes",          "leafs",        "leaf surfaces", "leaf brushes",
    "models",    "brushes",    "sides",      "verts",          "indexes",      "fogs",          "surfaces",
    "lightmaps", "light grid", "visibility", "advertisements", "SH light grid"};

/// Bytes of a header with `slots` lump entries: ident and version, then offset and length of each lump.
constexpr std::size_t HeaderBytes(std::size_t slots) {
    return 8 + 8 * slots;
}

/// Calls visit(slot, vector) for every lump that is an array of records, and has the same records in all formats.
template <typename AnyBsp, typename Visit> void ForEachCommonArray(AnyBsp &bsp, Visit &&visit) {
    visit(LUMP_SHADERS, bsp.shaders);
    visit(LUMP_PLANES, bsp.planes);
    visit(LUMP_NODES, bsp.nodes);
    visit(LUMP_LEAFS, bsp.leafs);
    visit(LUMP_LEAFSURFACES, bsp.leafSurfaces);
    visit(LUMP_LEAFBRUSHES, bsp.leafBrushes);
    visit(LUMP_MODELS, bsp.models);
    visit(LUMP_BRUSHES, bsp.brushes);
    visit(LUMP_DRAWINDEXES, bsp.drawIndexes);
    visit(LUMP_FOGS, bsp.fogs);
    visit(LUMP_LIGHTMAPS, bsp.lightmaps);
    visit(LUMP_VISIBILITY, bsp.visibility);
}

// ---- Writing ----

/// Layout of a file.
struct FilePlan {
    std::size_t slots = 0;
    std::array<FilePart, kNumLumps> lumps{}; ///< only the first `slots` are in the file
    std::uint64_t bspxStart = 0;             ///< position of the BSPX directory, when there is one
    std::vector<FilePart> bspx;              ///< the lumps of that directory, in its order
    std::uint64_t size = 0;                  ///< of the whole file
};

/// The lumps of a file, by slot.
using LumpBytes = std::array<ByteRanges, kNumLumps>;

/// Which header a file has and in which order its lumps lie behind it.
struct FileLayout {
    std::string_view ident;
    int version = 0;
    std::size_t slots = 0;
    std::span<const int> order; ///< slots; those that the header lacks are passed over
};

/// Lays out the lumps. An empty slot 17 of a 19-slot file gets offset 0. Errors: a file of 2^31 bytes or more, which no
/// reader could address.
FilePlan PlanFile(std::size_t slots, std::span<const int> order, const std::array<std::uint64_t, kNumLumps> &lengths,
                  std::span<const std::uint64_t> bspxLengths);

/// The lumps that ForEachCommonArray visits, and the entities.
LumpBytes CommonLumps(const Bsp &bsp);
/// The file: header, lumps, and the BSPX lumps of the map.
ByteRanges AssembleFile(const FileLayout &layout, LumpBytes lumps, const Bsp &bsp);

/// Converted records as bytes that the result owns.
template <typename FileRecord, typename Record, typename Convert>
ByteRanges ConvertedRecords(const std::vector<Record> &records, const Convert &convert) {
    std::vector<std::byte> bytes(records.size() * sizeof(FileRecord));
    for (std::size_t i = 0; i < records.size(); ++i) {
        const FileRecord record = convert(records[i]);
        std::memcpy(bytes.data() + i * sizeof record, &record, sizeof record);
    }
    ByteRanges ranges;
    ranges.AddOwned(std::move(bytes));
    return ranges;
}

// ---- Reading ----

/// Reads the header of a file, and those of its lumps that are the same in all formats.
class LumpReader {
  public:
    LumpReader(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log);

    /// Entries of the header, checked; `slots` of them. Errors: parts that do not lie in the file.
    void ReadSlots(std::size_t slots);
    std::int32_t Version() const { return LoadRecord<std::int32_t>(head_, 4); }
    bool HasIdent(std::string_view ident) const { return std::memcmp(head_.data(), ident.data(), ident.size()) == 0; }
    /// An error, or a warning with -force.
    void Mismatch(const std::string &text) const;
    /// An entry of the header as it is.
    FilePart Slot(std::size_t slot) const;
    /// Whether a part is not empty and lies in the file, behind a header of this size.
    bool Inside(const FilePart &part, std::size_t header) const;
    const FilePart &Lump(int slot) const { return lumps_[std::size_t(slot)]; }
    void SetLump(int slot, const FilePart &part) { lumps_[std::size_t(slot)] = part; }
    /// Smallest offset of a lump that is not empty.
    std::int64_t FirstByte() const { return firstByte_; }
    const ByteSource &File() const { return file_; }
    std::string_view Name() const { return name_; }
    Log &Messages() const { return log_; }

    /// Warns of lumps that share bytes.
    void WarnOverlap() const;
    /// The entities, the arrays of ForEachCommonArray.
    void ReadCommonLumps(Bsp &bsp) const;
    /// A lump of records as the file has them. Errors: those of RefuseRagged; with -force the lump stays empty.
    template <typename Record> void ReadArray(int slot, std::vector<Record> &records) const {
        const FilePart &part = Lump(slot);
        if (part.length % std::int64_t(sizeof(Record)) != 0)
            return RefuseRagged(slot, sizeof(Record));
        records.resize(std::size_t(part.length) / sizeof(Record));
        file_.Fill(std::uint64_t(part.offset), std::span(records));
    }
    /// The same where records in memory differ from those of the file.
    template <typename FileRecord, typename Record, typename Convert>
    void ReadConverted(int slot, std::vector<Record> &records, const Convert &convert) const {
        std::vector<FileRecord> stored;
        ReadArray(slot, stored);
        records.reserve(stored.size());
        std::ranges::transform(stored, std::back_inserter(records), convert);
    }
    /// Error for a lump that is no whole number of records of `record` bytes; with -force, a warning that the caller
    /// drops it.
    void RefuseRagged(int slot, std::size_t record) const;
    /// The BSPX lumps, which follow the last lump.
    void ReadBspx(Bsp &bsp) const;

  private:
    FilePart CheckedSlot(std::size_t slot, std::size_t slots) const;
    std::string_view LumpName(std::size_t slot) const;

    const ByteSource &file_;
    std::string_view name_;
    const BspFormat &format_;
    Log &log_;
    std::array<std::byte, HeaderBytes(kNumLumps)> head_{}; ///< zeros where the file is shorter
    std::array<FilePart, kNumLumps> lumps_{};
    std::int64_t firstByte_ = INT64_MAX;
};

/// A .bsp format. Its row is in bspfile.cpp.
struct BspCodec {
    std::string_view ident; ///< the first four bytes of a file; BspFormat::ident
    /// A whole file as records. `name` is for messages. Errors: Error, one line, for bytes that are no records;
    /// ReadBspFrom validates what the records say.
    Bsp (*decode)(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log);
    /// The bytes of the file. Errors: those of WriteBsp.
    ByteRanges (*encode)(const Bsp &bsp, const BspFormat &format, Log &log);
};

} // namespace q3
