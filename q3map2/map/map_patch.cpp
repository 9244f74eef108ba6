// GPL-2.0-or-later. Patches: normals, shared level of detail, tessellation.
#include "q3map2/map/map_patch.h"

#include "libs/math/patch_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace q3 {

namespace {

/// Patches with points closer than this along each axis share their level of detail. Game units.
constexpr float kTouching = 1;
/// Greatest distance per axis between first and last column (or row) of a closed patch. Game units.
constexpr float kClosed = 1;
/// Cosine between the normals of control points and curve below which the curve's normal is used.
constexpr float kNormalsDiffer = 0.75f;
constexpr int kMaxNeighborSteps = 3; ///< in search of a distinct neighbor

using PatchGrid = MeshOf<DrawVert>;

bool AreNear(const Vec3f &a, const Vec3f &b, float distance) {
    return std::abs(a.x - b.x) < distance && std::abs(a.y - b.y) < distance && std::abs(a.z - b.z) < distance;
}

/// Union-find over patches.
class PatchGroups {
  public:
    explicit PatchGroups(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0); }
    std::size_t Of(std::size_t i) {
        while (parents_[i] != i)
            i = parents_[i] = parents_[parents_[i]];
        return i;
    }
    void Join(std::size_t a, std::size_t b) { parents_[Of(a)] = Of(b); }

  private:
    std::vector<std::size_t> parents_;
};

/// A control point and its cell in a grid of spacing kTouching.
struct CellPoint {
    std::uint64_t cell = 0;
    Vec3f xyz;
    std::size_t patch = 0;
};

constexpr int kCellBits = 20;                      ///< of a cell's number along an axis
constexpr double kCellOffset = kMaxWorldCoord + 8; ///< added to numbers along an axis, so that none is negative

std::uint64_t CellOf(const Vec3f &p, int stepX, int stepY, int stepZ) {
    const auto index = [](float v, int step) {
        const double inside = std::clamp(double(v), -kMaxWorldCoord, kMaxWorldCoord);
        return std::uint64_t(std::floor(inside / double(kTouching)) + kCellOffset) + std::uint64_t(step + 1);
    };
    return (index(p.x, stepX) << (2 * kCellBits)) | (index(p.y, stepY) << kCellBits) | index(p.z, stepZ);
}

using CellSpan = std::span<const CellPoint>;

void JoinCells(CellSpan a, CellSpan b, PatchGroups &groups) {
    if (b.empty() || groups.Of(a.front().patch) == groups.Of(b.front().patch))
        return;
    for (const CellPoint &p : a)
        for (const CellPoint &q : b)
            if (AreNear(p.xyz, q.xyz, kTouching))
                return groups.Join(p.patch, q.patch);
}

/// Groups of patches that touch. All points of a cell touch each other, so a cell belongs to one group.
PatchGroups TouchingPatches(const std::deque<Patch> &patches) {
    std::vector<CellPoint> points;
    for (std::size_t i = 0; i < patches.size(); ++i)
        for (const DrawVert &v : patches[i].verts)
            points.push_back({CellOf(v.xyz, 0, 0, 0), v.xyz, i});
    std::ranges::stable_sort(points, {}, &CellPoint::cell);
    PatchGroups groups(patches.size());
    for (std::size_t i = 1; i < points.size(); ++i)
        if (points[i].cell == points[i - 1].cell)
            groups.Join(points[i].patch, points[i - 1].patch);
    const auto cellAt = [&](std::uint64_t cell) {
        const auto first = std::ranges::lower_bound(points, cell, {}, &CellPoint::cell);
        return CellSpan(first, std::ranges::upper_bound(points, cell, {}, &CellPoint::cell));
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0 && points[i].cell == points[i - 1].cell)
            continue;
        const CellSpan own = cellAt(points[i].cell);
        // A neighbor's number is 9 (x + 1) + 3 (y + 1) + z + 1 of the steps to it. 13 is the cell itself; the numbers
        // above are half of its neighbors, so that each pair of cells is visited once.
        for (int neighbor = 14; neighbor < 27; ++neighbor)
            JoinCells(own, cellAt(CellOf(points[i].xyz, neighbor / 9 - 1, neighbor / 3 % 3 - 1, neighbor % 3 - 1)),
                      groups);
    }
    return groups;
}

/// Normals from the directions of control points of a grid to their neighbors.
class NeighborDirections {
  public:
    explicit NeighborDirections(const PatchGrid &grid) : grid_(grid) {
        wrapsX_ = wrapsY_ = true;
        for (int y = 0; y < grid.height; ++y)
            wrapsX_ = wrapsX_ && AreNear(grid.At(0, y).xyz, grid.At(grid.width - 1, y).xyz, kClosed);
        for (int x = 0; x < grid.width; ++x)
            wrapsY_ = wrapsY_ && AreNear(grid.At(x, 0).xyz, grid.At(x, grid.height - 1).xyz, kClosed);
    }

    Vec3f NormalAt(int x, int y) const {
        constexpr std::array<std::array<int, 2>, 8> steps{
            {{0, 1}, {1, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}}};
        std::array<Vec3f, 8> directions;
        for (std::size_t i = 0; i < 8; ++i)
            directions[i] = Direction(x, y, steps[i][0], steps[i][1]);
        Vec3f sum;
        for (std::size_t i = 0; i < 8; ++i) {
            const Vec3f &here = directions[i], &next = directions[(i + 1) % 8];
            if (here != Vec3f{} && next != Vec3f{})
                sum += Normalize(Cross(next, here));
        }
        return Normalize(sum);
    }

  private:
    /// Unit vector to the first distinct point along the step; zero if there is none.
    Vec3f Direction(int x, int y, int stepX, int stepY) const {
        const Vec3f &base = grid_.At(x, y).xyz;
        int atX = x, atY = y;
        for (int step = 0; step < kMaxNeighborSteps; ++step) {
            if (!Step(atX, stepX, grid_.width, wrapsX_) || !Step(atY, stepY, grid_.height, wrapsY_))
                return {};
            const Vec3f offset = grid_.At(atX, atY).xyz - base;
            if (offset != Vec3f{})
                return Normalize(offset);
        }
        return {};
    }

    /// Wraps around closed grids, where first and last index are the same point. False: beyond the border.
    static bool Step(int &at, int step, int size, bool wraps) {
        at += step;
        if (wraps && at < 0)
            at = size - 1 + at;
        else if (wraps && at >= size)
            at = 1 + at - size;
        return at >= 0 && at < size;
    }

    const PatchGrid &grid_;
    bool wrapsX_ = false, wrapsY_ = false;
};

} // namespace

void FinishPatches(std::deque<Patch> &patches) {
    struct Group {
        float longestCurve = 0;
        Boundsf bounds;
    };
    PatchGroups groups = TouchingPatches(patches);
    std::vector<Group> byRoot(patches.size());
    for (std::size_t i = 0; i < patches.size(); ++i) {
        Group &group = byRoot[groups.Of(i)];
        group.longestCurve = std::max(
            group.longestCurve, LargestHalvingMeasure(patches[i].width, patches[i].height, patches[i].verts.data()));
        for (const DrawVert &v : patches[i].verts)
            group.bounds.Add(v.xyz);
    }
    for (std::size_t i = 0; i < patches.size(); ++i) {
        patches[i].longestCurve = byRoot[groups.Of(i)].longestCurve;
        patches[i].lodBounds = byRoot[groups.Of(i)].bounds;
    }
}

void SetPatchNormals(Patch &patch) {
    const PatchGrid control{patch.width, patch.height, patch.verts}, curve = OnCurve(control);
    const NeighborDirections atControl(control), atCurve(curve);
    for (int y = 0; y < patch.height; ++y)
        for (int x = 0; x < patch.width; ++x) {
            const Vec3f first = atControl.NormalAt(x, y), second = atCurve.NormalAt(x, y);
            patch.verts[std::size_t(y) * std::size_t(patch.width) + std::size_t(x)].normal =
                Dot(first, second) < kNormalsDiffer ? second : first;
        }
}

PatchMesh TessellatePatch(const Patch &patch, int subdivisions) {
    PatchGrid mesh =
        Tessellated(PatchGrid{patch.width, patch.height, patch.verts}, patch.longestCurve, std::max(subdivisions, 1));
    return {mesh.width, mesh.height, std::move(mesh.verts)};
}

std::vector<std::array<int, 3>> MeshTriangles(const PatchMesh &mesh) {
    std::vector<std::array<int, 3>> triangles;
    for (int y = 0; y + 1 < mesh.height; ++y)
        for (int x = 0; x + 1 < mesh.width; ++x) {
            const int a = y * mesh.width + x, b = a + mesh.width, c = b + 1, d = a + 1;
            const std::array<int, 4> quad = (x + y) % 2 == 0 ? std::array{a, b, c, d} : std::array{b, c, d, a};
            triangles.push_back({quad[0], quad[1], quad[2]});
            triangles.push_back({quad[0], quad[2], quad[3]});
        }
    return triangles;
}

} // namespace q3
