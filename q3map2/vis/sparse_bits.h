// GPL-2.0-or-later. Sets of portals of large maps: rows of bits of which only words that are not zero are stored.
#pragma once

#include "common/platform/platform.h"
#include "libs/math/bit_table.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace q3 {

/// A row has at most 64 blocks of at most 48 words, so that bits say which blocks and which of their words are stored.
/// That is enough for twice the 65,536 portals of the largest portal file.
inline constexpr std::size_t kMaxBlocks = 64, kMaxBlockWords = 48;
/// Words of a block of a row of that many words.
inline std::size_t BlockWordsOf(std::size_t words) {
    constexpr std::size_t kFewest = 8;
    return std::max(kFewest, (words + kMaxBlocks - 1) / kMaxBlocks);
}
/// Number of bits of `set` below bit number `end`. The base processor has no instruction that counts bits; most sets
/// have their bits in few bytes.
inline std::size_t CountBelow(BitWord set, std::size_t end) {
    static constexpr auto kCounts = [] {
        std::array<std::uint8_t, 256> counts{};
        for (std::size_t i = 1; i < counts.size(); ++i)
            counts[i] = std::uint8_t(counts[i / 2] + i % 2);
        return counts;
    }();
    BitWord x = set & ((BitWord(1) << end) - 1);
    std::size_t count = kCounts[x & 255];
    while ((x >>= 8) != 0)
        count += kCounts[x & 255];
    return count;
}

/// Memory of rows, in large pieces, of which the system makes large pages: rows are read at random.
class BitPool {
  public:
    BitWord *Allocate(std::size_t words) {
        if (words > left_) {
            left_ = pieceWords_ = std::max(words, std::clamp(2 * pieceWords_, kFirstWords, kMostWords));
            pieces_.push_back(std::make_unique_for_overwrite<BitWord[]>(left_));
            next_ = pieces_.back().get();
            UseLargePages(next_, left_ * sizeof(BitWord));
        }
        left_ -= words;
        return std::exchange(next_, next_ + words);
    }

  private:
    static constexpr std::size_t kFirstWords = std::size_t(1) << 13; ///< 64 KB
    static constexpr std::size_t kMostWords = std::size_t(1) << 22;  ///< 32 MB

    std::vector<std::unique_ptr<BitWord[]>> pieces_;
    BitWord *next_ = nullptr;
    std::size_t left_ = 0, pieceWords_ = 0; ///< words left of the last piece, and its size
};

/// A row of bits in the memory of a pool. Words that are 0 when it is made are not stored; afterwards bits can only be
/// cleared.
class SparseBits {
  public:
    /// A block that is stored.
    struct Block {
        BitWord stored; ///< bit i: word i of the block is stored
        BitWord *words; ///< the words that are stored, one after another
        BitWord *Find(std::size_t i) const { return (stored >> i & 1) != 0 ? words + CountBelow(stored, i) : nullptr; }
        /// Word i, which is stored.
        BitWord operator[](std::size_t i) const { return words[CountBelow(stored, i)]; }
    };

    /// No bits, of any row.
    SparseBits() = default;
    /// dense: all words of a row, a multiple of BlockWordsOf(its size).
    SparseBits(std::span<const BitWord> dense, BitPool &pool) : blockWords_(std::uint32_t(BlockWordsOf(dense.size()))) {
        std::size_t words = 0;
        for (std::size_t i = 0; i < dense.size(); ++i)
            if (dense[i] != 0)
                ++words, blocks_ |= BitWord(1) << i / blockWords_;
        const std::size_t heads = CountBits({&blocks_, 1});
        size_ = std::uint32_t(heads + words);
        data_ = pool.Allocate(size_);
        std::size_t head = 0, at = heads;
        ForEachBitOf(blocks_, [&](std::size_t block) {
            const std::size_t first = at;
            BitWord stored = 0;
            for (std::size_t i = 0; i < blockWords_; ++i)
                if (const BitWord word = dense[block * blockWords_ + i]) {
                    stored |= BitWord(1) << i;
                    data_[at++] = word;
                }
            data_[head++] = BitWord(first) << kMaxBlockWords | stored;
        });
    }

    /// The set of blocks that are stored.
    BitWord Blocks() const { return blocks_; }
    /// A block that is stored.
    Block operator[](std::size_t block) const { return BlockOf(data_[CountBelow(blocks_, block)]); }
    /// Null for words that are not stored, which are 0.
    BitWord *Find(std::size_t word) {
        const std::size_t block = blocks_ != 0 ? word / blockWords_ : 0;
        return (blocks_ >> block & 1) != 0 ? (*this)[block].Find(word % blockWords_) : nullptr;
    }
    BitWord Word(std::size_t word) const {
        const BitWord *const found = const_cast<SparseBits *>(this)->Find(word);
        return found ? *found : 0;
    }
    bool Test(std::size_t bit) const { return (Word(bit / kBitsPerWord) >> bit % kBitsPerWord & 1) != 0; }
    void Clear(std::size_t bit) {
        if (BitWord *const word = Find(bit / kBitsPerWord))
            *word &= ~(BitWord(1) << bit % kBitsPerWord);
    }
    std::size_t Count() const {
        const std::size_t heads = CountBits({&blocks_, 1});
        return CountBits({data_ + heads, size_ - heads});
    }
    /// Bytes in memory, this object included.
    std::size_t Bytes() const { return sizeof(*this) + sizeof(BitWord) * size_; }

    /// Calls visit(index, word) for each word that is stored, in ascending order; `word` may be changed.
    template <typename Visit> void ForEachWord(Visit &&visit) const {
        const BitWord *head = data_;
        ForEachBitOf(blocks_, [&](std::size_t block) {
            const Block stored = BlockOf(*head++);
            BitWord *word = stored.words;
            ForEachBitOf(stored.stored, [&](std::size_t i) { visit(blockWords_ * block + i, *word++); });
        });
    }
    /// Clears the bits that a dense row of the same length does not have, and sets that row to those that were cleared.
    void Restrict(std::span<BitWord> dense) {
        std::size_t next = 0;
        ForEachWord([&](std::size_t i, BitWord &word) {
            std::fill(&dense[next], &dense[i], BitWord(0));
            const BitWord kept = word & dense[i];
            dense[i] = word & ~kept;
            word = kept;
            next = i + 1;
        });
        std::fill(dense.begin() + std::ptrdiff_t(next), dense.end(), BitWord(0));
    }

  private:
    Block BlockOf(BitWord head) const {
        return {head & ((BitWord(1) << kMaxBlockWords) - 1), data_ + (head >> kMaxBlockWords)};
    }

    BitWord blocks_ = 0; ///< bit b: block b is stored
    /// For each block that is stored: kMaxBlockWords bits for its words, and above them the index of the first one.
    /// Then all words.
    BitWord *data_ = nullptr;
    std::uint32_t size_ = 0, blockWords_ = 0; ///< of data_, and words of a block
};

/// Rows of the same length, and their memory.
class SparseBitTable {
  public:
    SparseBitTable() = default;
    /// workers: those that set rows, numbered from 0.
    explicit SparseBitTable(std::size_t rows, int workers = 1) : rows_(rows), pools_(std::size_t(workers)) {}

    void Set(std::size_t row, std::span<const BitWord> dense, int worker = 0) {
        rows_[row] = SparseBits(dense, pools_[std::size_t(worker)]);
    }
    std::size_t Rows() const { return rows_.size(); }
    SparseBits &operator[](std::size_t row) { return rows_[row]; }
    const SparseBits &operator[](std::size_t row) const { return rows_[row]; }
    bool Test(std::size_t row, std::size_t bit) const { return rows_[row].Test(bit); }
    /// Bytes that the rows take.
    std::uint64_t Bytes() const {
        std::uint64_t bytes = 0;
        for (const SparseBits &row : rows_)
            bytes += row.Bytes();
        return bytes;
    }

  private:
    std::vector<SparseBits> rows_;
    std::vector<BitPool> pools_; ///< by worker
};

} // namespace q3
