// GPL-2.0-or-later. From where one luxel is lit: a place in the open near its surface.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_axes.h"

#include <optional>

namespace q3 {

/// The plane that luxels are placed on, and the triangle in it if it is one.
struct LuxelPlane {
    Vec3f normal;
    float dist = 0;
    const std::array<SurfaceVertex, 3> *triangle = nullptr;
};

/// How many luxels were placed where. Attempts that failed may be several for one luxel.
struct PlacementCounts {
    std::array<std::uint64_t, 9> nudges{}; ///< [0]: not nudged
    std::uint64_t atVertex = 0, failed = 0;
};

/// Which clusters may hold receivers of luxels: those that see one of the surface's.
class ClusterFilter {
  public:
    /// `clusters` empty: all are allowed. Both are kept as references.
    ClusterFilter(const BspSpace &space, const std::vector<int> &clusters)
        : space_(space), clusters_(clusters), known_(clusters.empty() ? 0 : std::size_t(space.ClusterCount())) {}
    /// The cluster, or kSolidCluster.
    int Allowed(int cluster);

  private:
    enum Known : std::uint8_t { Unasked, No, Yes };
    const BspSpace &space_;
    const std::vector<int> &clusters_;
    std::vector<Known> known_;
};

/// Receivers luxels of one raw lightmap. Keeps references. For one thread.
class LuxelPlacer {
  public:
    LuxelPlacer(const SurfaceInputs &in, const RawLightmap &raw, const Boundsf &around);

    /// Closed where no light may be taken: cluster < 0.
    struct Place {
        Vec3f xyz;
        int cluster = kSolidCluster;
        bool Closed() const { return cluster < 0; }
    };
    /// Where super luxel (x, y) is lit from: its middle, or else an open place beside it; closed if there is none.
    /// offset: lift off the surface, game units. sample: where the surface passes through the luxel; without vectors
    /// the middle is there. Null: somewhere in plane.triangle, of a planar lightmap. `lastTry`: also right above the
    /// sample, or the middle of the triangle's part in the luxel.
    Place Find(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane, float offset, bool lastTry,
               ClusterFilter &filter, PlacementCounts &counts) {
        const Place middle = Middle(x, y, sample, plane, offset, filter, counts);
        return middle.Closed() ? Beside(x, y, middle.xyz, sample, plane, offset, lastTry, filter, counts) : middle;
    }

  private:
    Place Middle(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane, float offset,
                 ClusterFilter &filter, PlacementCounts &counts);
    Place Beside(int x, int y, const Vec3f &middle, const SurfaceVertex *sample, const LuxelPlane &plane, float offset,
                 bool lastTry, ClusterFilter &filter, PlacementCounts &counts);
    /// The last try.
    Vec3f Above(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane, float offset) const;
    /// Holds it.
    Boundsf AboveBox(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane, float offset) const;
    /// The part of the tree around a few neighbouring luxels, made when the first of them is placed.
    struct Tile {
        Boundsf box;
        std::optional<BspRegion> region;
    };
    /// That of luxel (x, y), one of whose receivers is p, lifted by `lift` along the projection.
    const Tile &TileOf(int x, int y, const Vec3f &p, float lift);
    Boundsf TileBox(int x, int y, const Vec3f &p, float lift) const;
    void SetTileReach();
    int ClusterAt(const Vec3f &p, const Tile &tile, ClusterFilter &filter) const;
    /// Whether some place of the box may be open.
    bool AnyOpen(const Boundsf &box, const Tile &tile) const;
    /// Where the lightmap's (x, y) is on the plane, in luxels from the middle of the first.
    Vec3f OnPlane(float x, float y, const LuxelPlane &plane) const;
    Vec3f OnSurface(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane) const;
    float Lift(const LuxelPlane &plane, float offset) const {
        return plane.normal[axes_.along] >= 0 ? offset : -offset;
    }
    /// From a place to where its cluster is looked up.
    Vec3f Probe(const LuxelPlane &plane) const { return in_.lightmap.extraVisNudge ? plane.normal : Vec3f{}; }
    std::array<Vec3f, 2> NudgeSteps(const LuxelPlane &plane) const;

    const SurfaceInputs &in_;
    const RawLightmap &raw_;
    LuxelAxes axes_;
    Boundsf box_;
    BspRegion region_;
    bool middles_ = false; ///< middles of tiles are known
    Vec3f tileReach_;      ///< of boxes of tiles, to both sides
    int tilesAcross_ = 0;
    std::vector<Tile> tiles_;
};

} // namespace q3
