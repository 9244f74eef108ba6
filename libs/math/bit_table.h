// GPL-2.0-or-later. Bit sets in rows of 64-bit words: sets of portals, clusters or lights.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

using BitWord = std::uint64_t;
inline constexpr std::size_t kBitsPerWord = 64; ///< of a BitWord

// Bit b of a row is bit b % 64 of word b / 64.

/// Number of words that hold `bits` bits.
inline std::size_t WordsOf(std::size_t bits) {
    return (bits + kBitsPerWord - 1) / kBitsPerWord;
}
inline bool TestBit(const BitWord *row, std::size_t bit) {
    return (row[bit >> 6] >> (bit & 63) & 1) != 0;
}
inline void SetBit(BitWord *row, std::size_t bit) {
    row[bit >> 6] |= BitWord(1) << (bit & 63);
}
inline void ClearBit(BitWord *row, std::size_t bit) {
    row[bit >> 6] &= ~(BitWord(1) << (bit & 63));
}
/// Number of bits that are set.
inline std::size_t CountBits(std::span<const BitWord> row) {
    std::size_t count = 0;
    for (const BitWord word : row)
        count += std::size_t(std::popcount(word));
    return count;
}
/// Calls visit(bit) for each set bit of a word, in ascending order.
template <typename Visit> void ForEachBitOf(BitWord word, Visit &&visit) {
    for (; word != 0; word &= word - 1)
        visit(std::size_t(std::countr_zero(word)));
}
/// Calls visit(bit) for every set bit in ascending order. `visit` may clear bits of the row.
template <typename Visit> void ForEachBit(std::span<const BitWord> row, Visit &&visit) {
    for (std::size_t i = 0; i < row.size(); ++i)
        ForEachBitOf(row[i], [&](std::size_t bit) { visit(kBitsPerWord * i + bit); });
}

/// A table of bits, all clear at first. Rows start at whole words, so threads may write different rows at once.
class BitTable {
  public:
    BitTable() = default;
    BitTable(std::size_t rows, std::size_t bits) : words_(WordsOf(bits)), data_(rows * words_) {}

    /// Words of a row.
    std::size_t Words() const { return words_; }
    BitWord *Row(std::size_t row) { return data_.data() + row * words_; }
    const BitWord *Row(std::size_t row) const { return data_.data() + row * words_; }
    std::span<BitWord> Bits(std::size_t row) { return {Row(row), words_}; }
    std::span<const BitWord> Bits(std::size_t row) const { return {Row(row), words_}; }
    bool Test(std::size_t row, std::size_t bit) const { return TestBit(Row(row), bit); }
    /// All rows, one after another.
    std::span<BitWord> All() { return data_; }
    std::span<const BitWord> All() const { return data_; }

  private:
    std::size_t words_ = 0;
    std::vector<BitWord> data_;
};

} // namespace q3
