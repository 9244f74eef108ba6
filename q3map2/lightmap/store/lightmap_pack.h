// GPL-2.0-or-later. Packing of lightmaps into pages.
#pragma once

#include "q3map2/lightmap/store/lightmap_layers.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// The texels that a lightmap uses, as runs in rows. Other lightmaps may use the texels between runs.
struct Stamp {
    struct Run {
        int row, start, length;
    };
    int width = 1, height = 1;
    int texels = 1; ///< number of texels in the runs
    std::vector<Run> runs;
};
Stamp MakeStamp(const LightmapLayer &layer);

/// Which texels of a page are taken, as bit rows, so that 64 columns are tested at once.
class PageSpace {
  public:
    PageSpace(int width, int height);
    int Width() const { return width_; }
    int Height() const { return height_; }
    int FreeTexels() const { return free_; }
    /// Whether the stamp is inside the page at (x, y) and all its texels are free.
    bool Fits(const Stamp &stamp, int x, int y) const;
    /// The first (x, y) that fits, row by row, among multiples of the steps.
    std::optional<std::array<int, 2>> Find(const Stamp &stamp, int stepX, int stepY) const;
    void Take(const Stamp &stamp, int x, int y);

  private:
    static constexpr int kLevels = 8; ///< of Row: 1, 2, 4 ... 128 texels
    /// Bit x: whether one of the 2^level texels from x on is taken.
    std::uint64_t *Row(int row, int level) {
        return bits_.data() + (std::size_t(row) * kLevels + std::size_t(level)) * words_;
    }
    const std::uint64_t *Row(int row, int level) const {
        return bits_.data() + (std::size_t(row) * kLevels + std::size_t(level)) * words_;
    }
    bool ClearTaken(const Stamp::Run &run, int y, std::span<std::uint64_t> columns) const;
    void RebuildLevels(int row);

    int width_, height_, free_;
    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

/// Sets page, x and y of every layer in `order`; twins take those of the layer whose texels they share. Returns the
/// sizes of the pages.
std::vector<std::array<int, 2>> PackLayers(const std::vector<std::size_t> &order, const LightmapOptions &options,
                                           LightmapLayers &layers);

} // namespace q3
