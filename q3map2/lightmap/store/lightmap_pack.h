// GPL-2.0-or-later. Receivers of lightmaps on pages.
#pragma once

#include "q3map2/lightmap/store/lightmap_slots.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// The texels that a lightmap needs: runs in rows. Those between may belong to others.
struct Stamp {
    struct Run {
        int row, start, length;
    };
    int width = 1, height = 1;
    int used = 1; ///< texels
    std::vector<Run> runs;
};
Stamp MakeStamp(const StoredSlot &slot);

/// Which texels of a page are taken, kept so that all columns of a row are tested at once.
class PageSpace {
  public:
    PageSpace(int width, int height);
    int Width() const { return width_; }
    int Height() const { return height_; }
    int Free() const { return free_; }
    /// Whether the stamp lies on the page at (x, y), and nothing else where it needs a texel.
    bool Fits(const Stamp &stamp, int x, int y) const;
    /// The first place that fits, row by row, among multiples of the steps.
    std::optional<std::array<int, 2>> Find(const Stamp &stamp, int stepX, int stepY) const;
    void Take(const Stamp &stamp, int x, int y);

  private:
    static constexpr int kLevels = 8;
    /// Row of bits: texel x is set when one of the 2^level from x on is taken.
    std::uint64_t *Row(int row, int level) {
        return bits_.data() + (std::size_t(row) * kLevels + std::size_t(level)) * words_;
    }
    const std::uint64_t *Row(int row, int level) const {
        return bits_.data() + (std::size_t(row) * kLevels + std::size_t(level)) * words_;
    }
    bool Remove(const Stamp::Run &run, int y, std::span<std::uint64_t> open) const;
    void Rebuild(int row);

    int width_, height_, free_;
    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

/// Gives every slot of `order` a page and a place, and twins that of their first. Returns the sizes of the pages.
std::vector<std::array<int, 2>> PackSlots(const std::vector<std::size_t> &order, const LightmapOptions &options,
                                          StoredSlots &stored);

} // namespace q3
