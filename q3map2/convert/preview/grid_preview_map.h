// GPL-2.0-or-later. Where and what a picture of light grids shows: open positions of a map, and the light of its grids
// there.
#pragma once

#include "libs/math/vec.h"
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_sparse.h"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// A cell: its lower corner and log2 of its edge, both in smallest cells.
struct SparseCell {
    Int3 low{};
    int size = 0;
    bool operator==(const SparseCell &) const = default;
};

/// The cell that contains a position; nothing outside the grid, which must be valid.
std::optional<SparseCell> SparseCellAt(const SparseGridSH &grid, const Vec3f &position);
/// Color of cells of that SparseCell::size: red for the smallest, then along the hues; repeats after six.
Vec3f SparseCellColor(int size);

/// What an engine keeps of the SH grid for one object.
struct SHSample {
    shgrid_lighting lighting;
    std::optional<shgrid_tone> tone; ///< tone of lightmaps and legacy grid; nothing if it is plain
};
/// Light on a surface with this unit normal; 1.0 is lightmap byte 255. With a tone: as a lightmap stores it. Without:
/// linear and unclamped.
Vec3f LightOn(const SHSample &sample, const Vec3f &normal);

/// The SH grid through the engine-side reader: the one that names lights if the map has it, else the sparse one. Reads the points of the Bsp in place:
/// the Bsp must outlive this.
class SHPreview {
  public:
    /// Errors: no SH grid.
    explicit SHPreview(const Bsp &bsp);
    SHPreview(const SHPreview &) = delete; // the grid points into the lump
    SHPreview &operator=(const SHPreview &) = delete;
    SHSample At(const Vec3f &position) const;
    const shgrid_grid &Grid() const { return grid_; }
    bool HasTone() const { return tone_.has_value(); }

  private:
    std::vector<std::byte> lump_;
    shgrid_grid grid_{};
    bool needsConvolution_ = false; ///< the coefficients are radiance
    std::optional<shgrid_tone> tone_;
};

/// What an engine keeps of the legacy grid for one object.
struct LegacySample {
    Vec3f ambient, directed;
    Vec3f direction; ///< toward the light, unit or zero
};
/// Light on a surface with this unit normal; 1.0 is byte 255. Unclamped.
Vec3f LightOn(const LegacySample &sample, const Vec3f &normal);

/// The legacy grid as an engine blends it: corners without ambient light are left out, the rest is renormalized.
class LegacyPreview {
  public:
    /// Nothing if the map has no legacy grid, or one whose point count engines reject. The Bsp must
    /// outlive the result.
    static std::optional<LegacyPreview> Make(const Bsp &bsp);
    LegacySample At(const Vec3f &position) const;

  private:
    GridLayout layout_;
    std::span<const bspGridPoint_t> points_;
};

/// The space of a map that players can be in: open leafs that a player start or an item can see by the visibility data
/// (all open leafs without such entities or data), without the solid brushes in them. What lies behind skies or in
/// separate rooms counts as solid. The Bsp must outlive it.
class PreviewMap {
  public:
    explicit PreviewMap(const Bsp &bsp);

    bool IsOpen(const Vec3f &position) const;
    /// Open, with solid other than sky at most 128 units below: where things can stand.
    bool IsOverFloor(const Vec3f &position) const;
    /// Height at which the largest area is over a floor; the middle of the space when none is.
    float BestHeight() const;
    /// Rectangle (in x and y) of what is open at that height; the whole space when nothing is.
    Boundsf OpenArea(float height) const;

    /// Up to `count` open positions, spread over the map by farthest-point choice; distances count more where
    /// `strength` (of a position, >= 0) is large. In reading order: north first.
    std::vector<Vec3f> ChoosePositions(std::size_t count, const std::function<float(const Vec3f &)> &strength) const;

  private:
    const bspLeaf_t &LeafAt(const Vec3f &position) const;
    /// Solid brush of the leaf that holds the position; null when there is none.
    const bspBrush_t *BrushAt(const bspLeaf_t &leaf, const Vec3f &position) const;
    /// Lowers `budget` by the number of planes it tests; false when it runs out.
    bool InBrush(const bspBrush_t &brush, const Vec3f &position, std::int32_t &budget) const;
    bool HasClearance(const Vec3f &position) const;
    std::vector<Vec3f> Candidates() const;

    const Bsp &bsp_;
    std::vector<bool> seenByPlayers_; ///< by cluster: players can see it; empty: all
    Boundsf space_;                   ///< around player starts and items; the world bounds when there are none
};

} // namespace q3
