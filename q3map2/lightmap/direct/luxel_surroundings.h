// GPL-2.0-or-later. What lies around the luxels of a raw lightmap: where its surfaces go on in other lightmaps.
#pragma once

#include "q3map2/lightmap/direct/surface_finder.h"
#include "q3map2/lightmap/raw/luxel_masks.h"

#include <span>

namespace q3 {

/// What a cell of LuxelSurroundings holds.
enum class CellState : std::uint8_t {
    Empty,   ///< no surface goes on there
    Blocked, ///< a surface does, but it has no luxels there
    Own,     ///< a mapped luxel of the raw lightmap
    Tapped   ///< luxels of another raw lightmap, or of the other end of a closed curve
};

/// The super grid of a raw lightmap grown by `Reach` cells on all sides. From its outermost luxels the walk goes on
/// cell by cell over surfaces that continue those of the lightmap: in the same plane, or with normals that turn slowly,
/// and with no surface in between. For one thread; reused from lightmap to lightmap.
class LuxelSurroundings {
  public:
    /// Keeps references.
    LuxelSurroundings(const SurfaceInputs &in, const SurfaceLight &surfaces, const SurfaceFinder &finder)
        : in_(in), surfaces_(surfaces), finder_(finder) {}

    /// Sets the cells of a lightmap and of `reach` cells around it.
    void Walk(std::size_t lightmap, int reach);

    int Reach() const { return reach_; }
    int Width() const { return width_; }
    int Height() const { return height_; }
    /// The cell of luxel (x, y), which may be outside the super grid.
    std::size_t CellOf(int x, int y) const {
        return std::size_t(y + reach_) * std::size_t(width_) + std::size_t(x + reach_);
    }
    CellState At(std::size_t cell) const { return states_[cell]; }
    /// Only for cells that are Tapped.
    const LuxelTap &TapOf(std::size_t cell) const { return taps_[tapOf_[cell]]; }
    /// Lightmaps that are tapped, ascending.
    const std::vector<std::uint32_t> &Neighbors() const { return neighbors_; }

  private:
    /// A position on a surface, the normals there (as in SurfacePlace), and the steps to the next cell across and down.
    struct Footing {
        Vec3f position, normal, facet, across, down;
    };
    /// A step of the walk to a cell.
    struct Step {
        std::size_t cell = 0;
        Footing from; ///< the cell that it comes from
        Vec3f target; ///< in the tangent plane of `from`
        SurfacePlace found{};
    };
    bool Faces(const Vec3f &normal, const SurfacePlace &place) const;
    bool Continues(const Footing &from, const SurfacePlace &place) const;
    void Tap(std::size_t cell, const LuxelTap &tap);
    Footing FootingOf(int x, int y) const;
    void LookAtBorder(const LuxelMask &outside);
    void TakeSteps(std::vector<Step> &steps);
    void Arrive(const Step &step);
    void FindNextSteps(std::span<const std::size_t> last, std::vector<Step> &steps);

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    const SurfaceFinder &finder_;
    const RawLightmap *raw_ = nullptr;
    std::size_t lightmap_ = 0;
    int reach_ = 0, width_ = 0, height_ = 0;
    bool translucent_ = false;
    std::vector<CellState> states_;
    std::vector<std::uint8_t> visited_; // whether the walk has been at the cell
    std::vector<std::uint32_t> tapOf_, footingOf_;
    std::vector<LuxelTap> taps_;
    std::vector<Footing> footings_;
    std::vector<std::uint32_t> neighbors_;
};

} // namespace q3
