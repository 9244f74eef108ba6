// GPL-2.0-or-later. What lies around the luxels of a raw lightmap: drawn surfaces by place, and where they go on in
// other lightmaps.
#pragma once

#include "q3map2/light/batch/receivers.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <array>
#include <memory>
#include <span>

namespace q3 {

class FaceScene;

/// Up to four luxels of a raw lightmap that stand for a place between them, with weights that add up to 1.
struct LuxelTap {
    std::uint32_t lightmap = 0;
    std::array<std::uint32_t, 4> luxels{}; ///< of the super grid
    std::array<float, 4> weights{};        ///< 0: the luxel is not mapped

    /// Blend of `values`, which has an entry for each luxel of the super grid.
    Vec3f Of(const std::vector<Vec3f> &values) const {
        Vec3f sum;
        for (std::size_t i = 0; i < luxels.size(); ++i)
            if (weights[i] > 0)
                sum += values[luxels[i]] * weights[i];
        return sum;
    }
};

/// Where a ray meets the front of a drawn surface.
struct SurfacePlace {
    int surface = -1;  ///< -1: no surface, or the back of one
    int lightmap = -1; ///< -1: it is lit at its vertices
    Vec3f position;
    Vec3f normal, facet;          ///< unit normals: interpolated between the vertices, and of the triangle
    std::array<float, 2> luxel{}; ///< coordinates in the super grid of its raw lightmap
};

/// Drawn surfaces as two Embree scenes, opaque and translucent ones, so that a decal does not hide the wall below it.
/// Const after construction; safe from several threads.
class SurfaceFinder {
  public:
    /// Keeps references.
    SurfaceFinder(const SurfaceInputs &in, const SurfaceLight &surfaces);
    ~SurfaceFinder();

    enum class Kind { Opaque, Translucent };
    using Places = std::array<SurfacePlace, kPacketSize>;
    /// First hits of the live rays with surfaces of a kind.
    Places FirstHits(const RayPacket &rays, Kind kind) const;
    /// Clears the live lanes of rays that meet an opaque surface, from either side.
    void TraceOccluded(RayPacket &rays) const;
    Kind KindOf(int surface) const;
    /// Whether both surfaces belong to the same inline model, or to the world.
    bool MoveTogether(int a, int b) const { return models_[std::size_t(a)] == models_[std::size_t(b)]; }
    /// The luxels around a place, by bilinear weights over those that are mapped. False: none is.
    bool FindTap(const SurfacePlace &place, LuxelTap &tap) const;

  private:
    void FindModels();

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    std::vector<int> models_; // by draw surface: number of its inline model, 0: the world
    std::unique_ptr<FaceScene> opaque_, translucent_;
};

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
    LuxelSurroundings(const SurfaceLight &surfaces, const SurfaceFinder &finder)
        : surfaces_(surfaces), finder_(finder) {}

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
    bool FacesAlike(const Vec3f &normal, const SurfacePlace &place) const;
    bool Continues(const Footing &from, const SurfacePlace &place) const;
    void Tap(std::size_t cell, const LuxelTap &tap);
    Footing FootingOf(int x, int y) const;
    void LookAtBorder(const LuxelMask &nearBorder);
    void TakeSteps(std::vector<Step> &steps);
    void Arrive(const Step &step);
    void FindNextSteps(std::span<const std::size_t> frontier, std::vector<Step> &steps);

    const SurfaceLight &surfaces_;
    const SurfaceFinder &finder_;
    const RawLightmap *raw_ = nullptr;
    std::size_t lightmap_ = 0;
    int reach_ = 0, width_ = 0, height_ = 0;
    SurfaceFinder::Kind kind_ = SurfaceFinder::Kind::Opaque; ///< of the surfaces of the raw lightmap
    std::vector<CellState> states_;
    std::vector<std::uint8_t> visited_; // whether the walk has been at the cell
    std::vector<std::uint32_t> tapOf_, footingOf_;
    std::vector<LuxelTap> taps_;
    std::vector<Footing> footings_;
    std::vector<std::uint32_t> neighbors_;
};

} // namespace q3
