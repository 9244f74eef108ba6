// GPL-2.0-or-later. The position at which a luxel is lit: near its surface, clear of solids, and not in walls.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <span>

namespace q3 {

/// World vectors from a luxel of the super grid to the next, across and down.
using LuxelSteps = std::array<Vec3f, 2>;

/// The plane that luxels are projected onto, and the triangle in it; null for quads and for luxels beside the surface.
struct LuxelPlane {
    Vec3f normal;
    float dist = 0;
    const std::array<SurfaceVertex, 3> *triangle = nullptr;
    LuxelSteps steps{}; ///< by LuxelStepsOf; zero if the lightmap is projected
};

/// Steps of the triangle's map from the lightmap to the world; zero if the triangle has no area in the lightmap.
LuxelSteps LuxelStepsOf(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c);

/// How often each kind of position was found. One luxel may have several failed attempts.
struct PositionCounts {
    std::array<std::uint64_t, 9> nudges{}; ///< by nudge + 1; [0]: the center itself
    std::uint64_t atSample = 0;            ///< above the sample, or above the part of the triangle in the luxel
    std::uint64_t failed = 0;
};

/// The position that was found for a luxel.
struct LuxelPosition {
    Vec3f xyz;
    int cluster = kSolidCluster; ///< below 0: it is in a solid, or in a cluster that does not see the surface
    bool Occluded() const { return cluster < 0; }
};

/// Finds positions for the luxels of one raw lightmap. Keeps references. For one thread.
class LuxelPositionFinder {
  public:
    LuxelPositionFinder(const SurfaceInputs &in, const RawLightmap &raw)
        : in_(in), raw_(raw), axes_(AxesOf(raw.axis)) {}

    /// The position of super luxel (x, y): its center, lifted off the surface by `offset` game units, else the first
    /// nudged position that is not occluded (StepsOfNudges; 8 positions half a step aside for each), else the position
    /// above the sample, or above the part of plane.triangle in the luxel. All are on the same side of walls as the
    /// surface; nudged ones on triangles in several planes are over plane.triangle.
    /// sample: a point of the surface in the luxel, which serves as center if the lightmap is not projected; null:
    /// plane.triangle covers part of the luxel.
    LuxelPosition Find(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane, float offset,
                       VisibleClusters &filter, PositionCounts &counts) {
        return Find({x, y, sample, plane, offset, {}}, filter, counts);
    }
    /// The same for a luxel beside the surface: on the same side of walls as one of the `neighbors`, positions of
    /// luxels next to it; the plane has no triangle.
    LuxelPosition FindBeside(int x, int y, std::span<const Vec3f> neighbors, const LuxelPlane &plane, float offset,
                             VisibleClusters &filter, PositionCounts &counts) {
        return Find({x, y, nullptr, plane, offset, neighbors}, filter, counts);
    }

  private:
    /// A luxel that a position is to be found for.
    struct Request {
        int x = 0, y = 0;
        const SurfaceVertex *sample = nullptr;
        const LuxelPlane &plane;
        float offset = 0;
        std::span<const Vec3f> neighbors; ///< not empty: the luxel is beside the surface
        bool IsBeside() const { return !neighbors.empty(); }
    };
    LuxelPosition Find(const Request &luxel, VisibleClusters &filter, PositionCounts &counts) {
        const LuxelPosition center = Centered(luxel, filter, counts);
        return center.Occluded() ? Nudged(luxel, center.xyz, filter, counts) : center;
    }
    LuxelPosition Centered(const Request &luxel, VisibleClusters &filter, PositionCounts &counts);
    LuxelPosition Nudged(const Request &luxel, const Vec3f &center, VisibleClusters &filter, PositionCounts &counts);
    /// Above the sample, or above the part of the triangle in the luxel.
    Vec3f Fallback(const Request &luxel) const;
    /// Bounds of Fallback; cheaper than computing it.
    Boundsf FallbackBounds(const Request &luxel) const;
    /// Whether the surface passes under the center of the luxel, as far as the triangle of the plane tells.
    bool CoversCenter(const Request &luxel) const;
    /// A point of the surface, lifted: that of the triangle nearest to the center of the luxel, or the sample.
    Vec3f Anchor(const Request &luxel) const;
    /// Whether p is on the same side of walls as the surface, which may lie in a solid itself.
    bool IsOnSideOfSurface(const Request &luxel, const Vec3f &p) const;
    /// Whether p is over the triangle, if that matters: in lightmaps of surfaces in several planes.
    bool IsOverTriangle(const LuxelPlane &plane, const Vec3f &p) const;
    Vec3f Lifted(Vec3f p, const LuxelPlane &plane, float offset) const;
    /// Coordinates in the super grid of a world position; the lightmap is projected.
    std::array<float, 2> LuxelCoordinates(const Vec3f &p) const;
    int ClusterAt(const Vec3f &p, VisibleClusters &filter) const;
    /// False if every position in the box is in a solid.
    bool AnyOpen(const Boundsf &box) const;
    /// World position of lightmap coordinates on the plane; (0, 0) is the center of the first luxel.
    Vec3f OnPlane(float x, float y, const LuxelPlane &plane) const;
    Vec3f OnSurface(const Request &luxel) const;
    /// Offset from a position to the point at which its cluster is looked up.
    Vec3f ClusterLookupOffset(const LuxelPlane &plane) const {
        return in_.lightmap.extraVisNudge ? plane.normal : Vec3f{};
    }
    /// The steps of nudges, in the order in which they are tried; the second may be zero: none. Where the luxels of a
    /// curve are closer together in the world than half their nominal size, LuxelPlane::steps come first, since half a
    /// nominal luxel may lead off the curve.
    std::array<LuxelSteps, 2> StepsOfNudges(const LuxelPlane &plane) const;

    const SurfaceInputs &in_;
    const RawLightmap &raw_;
    LuxelAxes axes_;
};

/// Gives luxels of a planar lightmap whose center is in a wall, and which are shown on several sides of it, the least
/// light of these sides: light from another side would come through the wall.
void FillWallLuxels(const BspSpace &space, RawLightmap &raw);

} // namespace q3
