// GPL-2.0-or-later. Positions of ambient cubes in a leaf.
#include "q3map2/light/cubes/leaf_positions.h"

#include "libs/math/low_discrepancy.h"
#include "q3map2/bspfile/bspfile_cubes.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Size of the box for one sample. Game units.
constexpr std::array<double, 3> kCubeCell = {32, 32, 64};
constexpr double kMostPositions = 128;
/// Minimum distance of a sample from the planes that bound its leaf. Game units.
constexpr double kInsideLeaf = 1.0 / 32;
/// Positions to try: kTriesEach for each sample wanted, plus kMoreTries.
constexpr int kTriesEach = 16, kMoreTries = 256;
constexpr std::uint64_t kSeedCubes = 0x43756265ull;

bool IsOpen(const BspSpace &space, const Vec3f &p) {
    return space.ClusterAt(p, 0) >= 0;
}

} // namespace

int CubeCount(const LeafPolytope &polytope) {
    if (!(polytope.volume > 0))
        return 0;
    const Vec3d size = polytope.bounds.maxs - polytope.bounds.mins;
    double count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
        count *= std::max(1.0, std::round(size[axis] / kCubeCell[axis]));
    const double filled = std::min(1.0, polytope.volume / (size.x * size.y * size.z));
    return int(std::clamp(std::round(count * filled), 1.0, kMostPositions));
}

std::vector<CubePlace> FindCubePlaces(const BspSpace &space, const LeafPolytopes &polytopes, std::size_t leaf) {
    const LeafPolytope polytope = polytopes.Of(leaf);
    const bspLeaf_t &record = space.Map().leafs[leaf];
    const auto wanted = std::size_t(CubeCount(polytope));
    const auto tries = wanted == 0 ? 0u : std::uint32_t(kTriesEach * int(wanted) + kMoreTries);
    const Vec3d size = polytope.bounds.maxs - polytope.bounds.mins;
    std::vector<CubePlace> found;
    const auto isNew = [&](const bspCubeSample_t &sample) {
        return std::none_of(found.begin(), found.end(),
                            [&](const CubePlace &place) { return place.stored == sample.position; });
    };
    for (std::uint32_t i = 0; i < tries && found.size() < wanted; ++i) {
        const Sample3 s = PlasticSample3(i, kSeedCubes + leaf);
        const Vec3d asked = polytope.bounds.mins + Vec3d{s.u, s.v, s.w} * size;
        bspCubeSample_t stored;
        stored.position = EncodeCubePosition(record, Vec3f(asked));
        const Vec3f p = CubePosition(record, stored);
        if (polytope.Contains(Vec3d(p), kInsideLeaf) && isNew(stored) && IsOpen(space, p))
            found.push_back({stored.position, p});
    }
    if (const Vec3f center(polytope.center); found.empty() && wanted > 0 && IsOpen(space, center))
        found.push_back({EncodeCubePosition(record, center), center});
    return found;
}

} // namespace q3
