// GPL-2.0-or-later. The space of a leaf as a convex polytope, and positions of ambient cubes in it.
#include "q3map2/light/cubes/leaf_positions.h"

#include "libs/math/sampling.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspfile_cubes.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- The space of a leaf as a convex polytope ----

namespace {

/// Planes are the same if their distances differ by less than kSamePlane (game units), their normals by less than
/// kSameNormal.
constexpr double kSamePlane = 1e-3, kSameNormal = 1e-6;
/// Corners within this distance of a plane count as on it. Game units.
constexpr double kOnFace = 1e-4;

std::vector<Plane> BoxPlanes(const bspLeaf_t &leaf) {
    std::vector<Plane> planes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Vec3d normal;
        normal[axis] = 1;
        planes.push_back({normal, double(leaf.mins[axis])});
        planes.push_back({-normal, -double(leaf.maxs[axis])});
    }
    return planes;
}

/// Whether the plane cuts off a part of the leaf's box; else it does not bound the leaf.
bool CutsBox(const Plane &plane, const bspLeaf_t &leaf) {
    Vec3d nearest;
    for (std::size_t axis = 0; axis < 3; ++axis)
        nearest[axis] = double(plane.normal[axis] > 0 ? leaf.mins[axis] : leaf.maxs[axis]);
    return plane.Distance(nearest) < -kSamePlane;
}

void AddPlane(const Plane &plane, std::vector<Plane> &planes) {
    const auto isSame = [&](const Plane &other) {
        return std::abs(other.dist - plane.dist) < kSamePlane && Length(other.normal - plane.normal) < kSameNormal;
    };
    if (std::none_of(planes.begin(), planes.end(), isSame))
        planes.push_back(plane);
}

/// Sets bounds, volume and center from the planes.
void Measure(LeafPolytope &polytope) {
    std::vector<Winding<double>> faces;
    Vec3d sum;
    double corners = 0;
    for (const Plane &plane : polytope.planes) {
        Winding<double> face = BaseWinding(plane);
        for (const Plane &other : polytope.planes)
            if (&other != &plane && !face.empty() && !ChopPolygon(face, other, kOnFace))
                face.clear();
        for (const Vec3d &corner : face) {
            polytope.bounds.Add(corner);
            sum += corner, corners += 1;
        }
        faces.push_back(std::move(face));
    }
    if (corners == 0)
        return;
    const Vec3d inside = sum / corners;
    Vec3d moment;
    for (std::size_t i = 0; i < faces.size(); ++i)
        for (std::size_t k = 2; k < faces[i].size(); ++k) { // tetrahedra from `inside`
            const Vec3d &a = faces[i][0], &b = faces[i][k - 1], &c = faces[i][k];
            const double volume = std::abs(Dot(a - inside, Cross(b - inside, c - inside))) / 6;
            polytope.volume += volume;
            moment += (a + b + c + inside) * (volume / 4);
        }
    polytope.center = polytope.volume > 0 ? moment / polytope.volume : inside;
}

} // namespace

bool LeafPolytope::Contains(const Vec3d &p, double margin) const {
    return std::all_of(planes.begin(), planes.end(), [&](const Plane &plane) { return plane.Distance(p) >= margin; });
}

LeafPolytopes::LeafPolytopes(const Bsp &bsp)
    : bsp_(bsp), nodeParents_(bsp.nodes.size()), leafParents_(bsp.leafs.size()) {
    for (std::size_t node = 0; node < bsp.nodes.size(); ++node)
        for (int child = 0; child < 2; ++child) {
            const int number = bsp.nodes[node].children[std::size_t(child)];
            (number >= 0 ? nodeParents_[std::size_t(number)] : leafParents_[std::size_t(LeafOf(number))]) = {int(node),
                                                                                                             child};
        }
}

LeafPolytope LeafPolytopes::Of(std::size_t leaf) const {
    LeafPolytope polytope;
    const bspLeaf_t &record = bsp_.leafs[leaf];
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (record.mins[axis] >= record.maxs[axis])
            return polytope;
    polytope.planes = BoxPlanes(record);
    std::size_t steps = 0; // nodes that node 0 does not reach may form a cycle
    for (Parent at = leafParents_[leaf]; at.node >= 0 && steps < bsp_.nodes.size(); ++steps) {
        const bspPlane_t &stored = bsp_.planes[std::size_t(bsp_.nodes[std::size_t(at.node)].planeNum)];
        const Vec3d normal(stored.normal);
        const double length = Length(normal), side = (at.child == 0 ? 1 : -1) / length;
        const Plane plane{normal * side, double(stored.dist) * side};
        if (CutsBox(plane, record))
            AddPlane(plane, polytope.planes);
        at = nodeParents_[std::size_t(at.node)];
    }
    Measure(polytope);
    return polytope;
}

// ---- Positions of ambient cubes in a leaf ----

namespace {

/// Size of the box for one sample. Game units.
constexpr std::array<double, 3> kCubeCell = {32, 32, 64};

/// Minimum distance of a sample from the planes that bound its leaf. Game units.
constexpr double kInsideLeaf = 1.0 / 32;
/// Positions to try: kTriesEach for each sample wanted, plus kMoreTries.
constexpr int kTriesEach = 16, kMoreTries = 256;
constexpr std::uint64_t kSeedCubes = 0x43756265ull; ///< "Cube" in ASCII

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
    return int(std::clamp(std::round(count * filled), 1.0, double(kMaxCubePlaces)));
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
        const Sample3 s = R3Sample(i, kSeedCubes + leaf);
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
