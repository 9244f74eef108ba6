// GPL-2.0-or-later. Where a point is in the map: leafs, clusters, solids, and what sees what.
#pragma once

#include "libs/math/vec.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// Half the width of a player. Game units.
inline constexpr float kPlayerHalfSize = 16;
/// Points farther than this from a leaf never count as in it. Game units.
inline constexpr float kAtLeaf = 0.2f;

/// Point queries on the tree of a validated Bsp. Const after construction, so safe for concurrent use. Keeps a
/// reference.
class BspSpace {
  public:
    /// opaqueBrush[i]: brush i of the world model blocks light as a volume, so points in it are not lit.
    BspSpace(const Bsp &bsp, const std::vector<bool> &opaqueBrush);

    /// Cluster of p, or kSolidCluster in a solid leaf or not farther than epsilon outside an opaque brush (negative:
    /// deeper than -epsilon inside).
    int ClusterAt(const Vec3f &p, float epsilon) const;
    /// Whether p is in a solid leaf; brushes do not count.
    bool InSolidLeaf(const Vec3f &p) const;
    /// False only if ClusterAt(p, epsilon) is solid for all p in the box; true in doubt.
    bool AnyOpen(const Vec3f &mins, const Vec3f &maxs, float epsilon) const;
    /// Whether the box touches a solid leaf.
    bool AnySolid(const Vec3f &mins, const Vec3f &maxs) const;
    /// Whether a player fits there: p is kPlayerHalfSize clear of solid leafs on all sides.
    bool PlayerFits(const Vec3f &p) const {
        const Vec3f half{kPlayerHalfSize, kPlayerHalfSize, kPlayerHalfSize};
        return !AnySolid(p - half, p + half);
    }

    /// Whether cluster a sees cluster b: true without visibility data, false for kSolidCluster.
    bool Visible(int a, int b) const;
    int ClusterCount() const { return clusterCount_; }
    /// Appends every cluster that the polygon passes through, each once, in no particular order.
    void ClustersOf(const Winding<float> &w, std::vector<int> &clusters) const;
    /// Numbers of the opaque brushes that reach into a leaf.
    std::span<const std::int32_t> OpaqueBrushes(std::size_t leaf) const {
        return std::span(opaqueBrushes_).subspan(opaqueFirst_[leaf], opaqueFirst_[leaf + 1] - opaqueFirst_[leaf]);
    }
    /// Union of the bounds of all leafs whose cluster `cluster` sees.
    Boundsf VisibleBounds(int cluster) const;

    const Bsp &Map() const { return bsp_; }

  private:
    template <typename Leaf> bool Touches(const Vec3f &mins, const Vec3f &maxs, const Leaf &wanted) const;
    bool FilledByBrush(std::size_t leaf, const Boundsf &box, float epsilon) const;
    bool InsideBrush(std::size_t leaf, const Vec3f &center, const Vec3f &half, float epsilon) const;

    const Bsp &bsp_;
    BspTree tree_;
    // Opaque brushes of leaf i: from opaqueFirst_[i] to before opaqueFirst_[i + 1].
    std::vector<std::uint32_t> opaqueFirst_;
    std::vector<std::int32_t> opaqueBrushes_;
    int clusterCount_ = 0;
    std::int32_t visRowBytes_ = 0; ///< of the visibility lump; 0: there is none
};

} // namespace q3
