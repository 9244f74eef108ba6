// GPL-2.0-or-later. Hashes of 128 bits, to name contents and to find damage.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace q3 {

/// XXH3 of 128 bits. Different contents have different hashes for all practical purposes, but it is not cryptographic.
struct Hash128 {
    std::uint64_t low = 0, high = 0;

    auto operator<=>(const Hash128 &) const = default;
    /// 32 hexadecimal digits.
    std::string Text() const;
};

Hash128 HashOf(std::span<const std::byte> bytes);
Hash128 HashOf(std::string_view text);

/// HashOf of bytes that come piece by piece.
class StreamHash {
  public:
    StreamHash();
    ~StreamHash();
    StreamHash(const StreamHash &) = delete;
    StreamHash &operator=(const StreamHash &) = delete;
    void Add(std::span<const std::byte> bytes);
    Hash128 Hash() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A type whose values are their bytes, without padding that could differ between equal values.
template <typename T>
concept PlainValue = std::is_trivially_copyable_v<T> &&
    (std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);

/// Collects what a result depends on; Key is the hash of all of it. Floating-point numbers count by their bits.
class KeyBuilder {
  public:
    KeyBuilder() = default;
    explicit KeyBuilder(std::string_view kind) { AddText(kind); }

    template <PlainValue T> void Add(const T &value) { AddBytes(std::as_bytes(std::span(&value, 1))); }
    template <PlainValue T, PlainValue... Rest> void Add(const T &value, const Rest &...rest) {
        Add(value);
        (Add(rest), ...);
    }
    /// The length counts too, so that texts that follow each other stay apart.
    void AddText(std::string_view text) {
        Add(std::uint64_t(text.size()));
        AddBytes(std::as_bytes(std::span(text)));
    }
    /// Elements must have no padding.
    template <typename T> void AddAll(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        Add(std::uint64_t(values.size()));
        AddBytes(std::as_bytes(values));
    }
    template <typename T> void AddAll(const std::vector<T> &values) { AddAll(std::span<const T>(values)); }

    Hash128 Key() const { return HashOf(bytes_); }

  private:
    void AddBytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

    std::vector<std::byte> bytes_;
};

} // namespace q3
