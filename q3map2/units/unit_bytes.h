// GPL-2.0-or-later. Results of units of work as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace q3 {

/// Writes values one after another.
class UnitWriter {
  public:
    template <typename T> void Put(const T &value) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto bytes = std::as_bytes(std::span(&value, 1));
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    template <typename T> void PutAll(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        Put(std::uint64_t(values.size()));
        const auto bytes = std::as_bytes(values);
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    template <typename T> void PutAll(const std::vector<T> &values) { PutAll(std::span<const T>(values)); }
    void PutText(std::string_view text) { PutAll(std::span<const char>(text)); }
    void PutTexts(const std::vector<std::string> &texts) {
        Put(std::uint64_t(texts.size()));
        for (const std::string &text : texts)
            PutText(text);
    }

    std::vector<std::byte> Take() { return std::move(bytes_); }

  private:
    std::vector<std::byte> bytes_;
};

/// Reads what UnitWriter wrote. A value that does not fit makes IsComplete false, and is zero or empty.
class UnitReader {
  public:
    explicit UnitReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    template <typename T> void Get(T &value) {
        static_assert(std::is_trivially_copyable_v<T>);
        if (rest_.size() < sizeof(T)) {
            value = {};
            return Fail();
        }
        std::memcpy(&value, rest_.data(), sizeof(T));
        rest_ = rest_.subspan(sizeof(T));
    }
    template <typename T> void GetAll(std::vector<T> &values) {
        std::uint64_t count = 0;
        Get(count);
        if (count > rest_.size() / sizeof(T)) {
            values.clear();
            return Fail();
        }
        values.resize(std::size_t(count));
        if (count > 0)
            std::memcpy(values.data(), rest_.data(), std::size_t(count) * sizeof(T));
        rest_ = rest_.subspan(std::size_t(count) * sizeof(T));
    }
    /// A view into the bytes that are read.
    void GetView(std::span<const std::byte> &view) {
        std::uint64_t count = 0;
        Get(count);
        if (count > rest_.size()) {
            view = {};
            return Fail();
        }
        view = rest_.first(std::size_t(count));
        rest_ = rest_.subspan(std::size_t(count));
    }
    void GetText(std::string &text) {
        std::vector<char> letters;
        GetAll(letters);
        text.assign(letters.begin(), letters.end());
    }
    void GetTexts(std::vector<std::string> &texts) {
        std::uint64_t count = 0;
        Get(count);
        texts.clear();
        for (std::uint64_t i = 0; i < count && fits_; ++i)
            GetText(texts.emplace_back());
    }
    /// Whether so many elements of at least a byte may follow. Else nothing fits any more.
    bool HasRoomFor(std::uint64_t count) {
        if (count > rest_.size())
            Fail();
        return fits_;
    }
    /// Whether everything fitted so far.
    bool Fits() const { return fits_; }
    /// Whether everything fitted and nothing is left.
    bool IsComplete() const { return fits_ && rest_.empty(); }

  private:
    void Fail() { fits_ = false, rest_ = {}; }

    std::span<const std::byte> rest_;
    bool fits_ = true;
};

} // namespace q3
