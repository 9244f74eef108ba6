// GPL-2.0-or-later. Sets of portals of large maps: rows of bits of which only blocks that are not all zero are stored.
#pragma once

#include "common/platform/platform.h"
#include "libs/math/bit_table.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace q3 {

/// Most blocks of a row, and the number of words that have a bit for each.
inline constexpr std::size_t kMaxBlocks = 128, kBlockSetWords = kMaxBlocks / kBitsPerWord;
/// Words of a block of a row of that many words. Smaller blocks take less memory, and more time to be looked up.
inline std::size_t BlockWordsOf(std::size_t words) {
    constexpr std::size_t kFewest = 4;
    return std::max(kFewest, (words + kMaxBlocks - 1) / kMaxBlocks);
}

/// A set of blocks of a row.
class BlockSet {
  public:
    bool Has(std::size_t block) const { return TestBit(words_.data(), block); }
    void Insert(std::size_t block) { SetBit(words_.data(), block); }
    bool IsEmpty() const { return *this == BlockSet(); }
    std::size_t Size() const { return CountBits(words_); }
    /// Number of blocks below one.
    std::size_t CountBelow(std::size_t block) const {
        std::size_t count = 0;
        for (std::size_t i = 0; i < block / kBitsPerWord; ++i)
            count += CountOf(words_[i]);
        return count + CountOf(words_[block / kBitsPerWord] & ((BitWord(1) << block % kBitsPerWord) - 1));
    }
    /// Calls visit(block) for each block, in ascending order.
    template <typename Visit> void ForEach(Visit &&visit) const { ForEachBit(words_, visit); }
    /// Whether test(block) is true for a block. The first one ends the search.
    template <typename Test> bool Any(Test &&test) const {
        for (std::size_t i = 0; i < kBlockSetWords; ++i)
            for (BitWord word = words_[i]; word != 0; word &= word - 1)
                if (test(kBitsPerWord * i + std::size_t(std::countr_zero(word))))
                    return true;
        return false;
    }
    bool operator==(const BlockSet &) const = default;
    friend BlockSet operator&(BlockSet a, const BlockSet &b) {
        for (std::size_t i = 0; i < kBlockSetWords; ++i)
            a.words_[i] &= b.words_[i];
        return a;
    }

  private:
    /// Number of set bits. Plain x86-64 has no instruction for this. The loop ends after the highest byte with a bit.
    static std::size_t CountOf(BitWord set) {
        static constexpr auto kCounts = [] {
            std::array<std::uint8_t, 256> counts{};
            for (std::size_t i = 1; i < counts.size(); ++i)
                counts[i] = std::uint8_t(counts[i / 2] + i % 2);
            return counts;
        }();
        std::size_t count = kCounts[set & 255];
        while ((set >>= 8) != 0)
            count += kCounts[set & 255];
        return count;
    }

    std::array<BitWord, kBlockSetWords> words_{};
};

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

/// A row of bits in the memory of a pool. Blocks of words that are all 0 when it is made are not stored; afterwards
/// bits can only be cleared.
class SparseBits {
  public:
    /// No bits, of any row.
    SparseBits() = default;
    /// dense: all words of a row, a multiple of BlockWordsOf(its size).
    SparseBits(std::span<const BitWord> dense, BitPool &pool) : blockWords_(BlockWordsOf(dense.size())) {
        const auto blockOf = [&](std::size_t block) { return dense.subspan(block * blockWords_, blockWords_); };
        for (std::size_t block = 0; block < dense.size() / blockWords_; ++block)
            if (std::ranges::any_of(blockOf(block), [](BitWord word) { return word != 0; }))
                blocks_.Insert(block);
        BitWord *next = words_ = pool.Allocate(NumWords());
        blocks_.ForEach([&](std::size_t block) { next = std::ranges::copy(blockOf(block), next).out; });
    }

    /// The set of blocks that are stored.
    const BlockSet &Blocks() const { return blocks_; }
    /// The words of a block that is stored.
    const BitWord *operator[](std::size_t block) const { return words_ + blockWords_ * blocks_.CountBelow(block); }
    /// Null for words of blocks that are not stored, which are 0.
    const BitWord *Find(std::size_t word) const {
        const std::size_t block = word / blockWords_;
        return blocks_.Has(block) ? &(*this)[block][word % blockWords_] : nullptr;
    }
    BitWord *Find(std::size_t word) { return const_cast<BitWord *>(std::as_const(*this).Find(word)); }
    BitWord Word(std::size_t word) const {
        const BitWord *const found = Find(word);
        return found ? *found : 0;
    }
    bool Test(std::size_t bit) const { return (Word(bit / kBitsPerWord) >> bit % kBitsPerWord & 1) != 0; }
    void Clear(std::size_t bit) {
        if (BitWord *const word = Find(bit / kBitsPerWord))
            *word &= ~(BitWord(1) << bit % kBitsPerWord);
    }
    std::size_t Count() const { return CountBits({words_, NumWords()}); }
    /// Bytes in memory, this object included.
    std::size_t Bytes() const { return sizeof(*this) + sizeof(BitWord) * NumWords(); }

    /// Calls visit(index, word) for each word that is stored, in ascending order.
    template <typename Visit> void ForEachWord(Visit &&visit) const {
        const BitWord *next = words_;
        blocks_.ForEach([&](std::size_t block) {
            for (std::size_t i = 0; i < blockWords_; ++i)
                visit(blockWords_ * block + i, *next++);
        });
    }
    /// Clears the bits that a dense row of the same length does not have, and sets that row to those that were cleared.
    void Restrict(std::span<BitWord> dense) {
        std::size_t next = 0;
        BitWord *stored = words_;
        ForEachWord([&](std::size_t i, BitWord word) {
            std::fill(&dense[next], &dense[i], BitWord(0));
            *stored = word & dense[i];
            dense[i] = word & ~*stored++;
            next = i + 1;
        });
        std::fill(dense.begin() + std::ptrdiff_t(next), dense.end(), BitWord(0));
    }

  private:
    std::size_t NumWords() const { return blockWords_ * blocks_.Size(); }

    BlockSet blocks_;          ///< those that are stored
    BitWord *words_ = nullptr; ///< those of the blocks that are stored, one block after another
    /// Words of a block. Without a row, a block has the bits of any row, and is not stored.
    std::size_t blockWords_ = std::numeric_limits<std::size_t>::max();
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
    std::size_t NumRows() const { return rows_.size(); }
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
