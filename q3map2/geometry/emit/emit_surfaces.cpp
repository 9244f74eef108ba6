// GPL-2.0-or-later. Draw surfaces before they are written: leafs that they reach, last changes to vertices, order of
// triangles.
#include "q3map2/geometry/emit/emit_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace q3 {

// ---- Adds draw surfaces to the leafs that they reach ----

namespace {

constexpr double kOnPlaneEpsilon = 0.1; ///< game units

/// Adds one surface to the leafs that its polygons and points reach.
class SurfaceFilter {
  public:
    SurfaceFilter(Tree &tree, const PlaneTable &planes, int number, bool &inSkyBox)
        : tree_(tree), planes_(planes), number_(number), inSkyBox_(inSkyBox) {}

    bool ReachesLeaf() const { return reachesLeaf_; }
    /// `planeNum`: plane of the polygon; -1: unknown.
    void AddPolygon(Polygon polygon, int planeNum);
    void AddPoint(const Vec3f &p) { AddHull({&p, 1}); }
    /// Adds all leafs that the convex hull of the points may reach (conservative).
    void AddHull(std::span<const Vec3f> points);
    void AddEverywhere();

  private:
    void AddLeaf(TreeNode &leaf);
    std::vector<std::pair<int, Polygon>> Split(const TreeNode &node, const Polygon &polygon, int planeNum) const;

    Tree &tree_;
    const PlaneTable &planes_;
    int number_;
    bool &inSkyBox_;
    bool reachesLeaf_ = false;
    std::vector<int> stack_;
};

void SurfaceFilter::AddLeaf(TreeNode &leaf) {
    if (leaf.opaque)
        return;
    inSkyBox_ |= leaf.skyBox;
    reachesLeaf_ = true;
    if (leaf.surfaces.empty() || leaf.surfaces.back() != number_)
        leaf.surfaces.push_back(number_);
}

/// Parts of a polygon in front of and behind the plane of a node.
std::vector<std::pair<int, Polygon>> SurfaceFilter::Split(const TreeNode &node, const Polygon &polygon,
                                                          int planeNum) const {
    if (planeNum >= 0 && planeNum == node.planeNum)
        return {{node.children[0], polygon}};
    if (planeNum >= 0 && OppositePlane(planeNum) == node.planeNum)
        return {{node.children[1], polygon}};
    Polygon front, back;
    ClipPolygon(polygon, planes_[node.planeNum], kOnPlaneEpsilon, front, back);
    if (front.empty() && back.empty())
        return {{node.children[1], polygon}, {node.children[0], polygon}};
    std::vector<std::pair<int, Polygon>> parts;
    if (!back.empty())
        parts.emplace_back(node.children[1], std::move(back));
    if (!front.empty())
        parts.emplace_back(node.children[0], std::move(front));
    return parts;
}

void SurfaceFilter::AddPolygon(Polygon polygon, int planeNum) {
    std::vector<std::pair<int, Polygon>> stack;
    stack.emplace_back(tree_.head, std::move(polygon));
    while (!stack.empty()) {
        const auto [number, piece] = std::move(stack.back());
        stack.pop_back();
        TreeNode &node = tree_.nodes[std::size_t(number)];
        if (node.IsLeaf()) {
            AddLeaf(node);
            continue;
        }
        for (auto &part : Split(node, piece, planeNum))
            stack.push_back(std::move(part));
    }
}

void SurfaceFilter::AddHull(std::span<const Vec3f> points) {
    stack_.assign(1, tree_.head);
    while (!stack_.empty()) {
        TreeNode &node = tree_.nodes[std::size_t(stack_.back())];
        stack_.pop_back();
        if (node.IsLeaf()) {
            AddLeaf(node);
            continue;
        }
        const Plane &plane = planes_[node.planeNum];
        double least = plane.Distance(Vec3d(points[0])), most = least;
        for (const Vec3f &p : points.subspan(1)) {
            const double d = plane.Distance(Vec3d(p));
            least = std::min(least, d);
            most = std::max(most, d);
        }
        if (least <= kOnPlaneEpsilon)
            stack_.push_back(node.children[1]);
        if (most >= -kOnPlaneEpsilon)
            stack_.push_back(node.children[0]);
    }
}

void SurfaceFilter::AddEverywhere() {
    for (TreeNode &node : tree_.nodes)
        if (node.IsLeaf() && node.cluster >= 0)
            AddLeaf(node);
}

/// Points whose convex hull holds every level of detail of a 3 x 3 cell of a patch: the control points of the same
/// surface as a bicubic one (Bezier degree elevation), which are nearer to the surface than the biquadratic ones.
std::array<Vec3f, 16> CellHull(const DrawSurface &patch, int column, int row) {
    const auto elevate = [](const Vec3f &a, const Vec3f &b, const Vec3f &c) {
        return std::array<Vec3f, 4>{a, (a + b * 2.0f) / 3.0f, (b * 2.0f + c) / 3.0f, c};
    };
    const auto at = [&](int x, int y) { return patch.verts[std::size_t((row + y) * patch.width + column + x)].xyz; };
    std::array<std::array<Vec3f, 4>, 3> rows;
    for (int y = 0; y < 3; ++y)
        rows[std::size_t(y)] = elevate(at(0, y), at(1, y), at(2, y));
    std::array<Vec3f, 16> hull;
    for (std::size_t x = 0; x < 4; ++x) {
        const auto points = elevate(rows[0][x], rows[1][x], rows[2][x]);
        for (std::size_t y = 0; y < 4; ++y)
            hull[y * 4 + x] = points[y];
    }
    return hull;
}

Polygon PolygonOf(const DrawSurface &surface) {
    Polygon polygon;
    for (const DrawVert &vert : surface.verts)
        polygon.push_back(vert.xyz);
    return polygon;
}

/// Adds the leafs that a polygon may reach when deformVertexes moves it.
void AddMoving(const Polygon &polygon, const std::pair<Vec3f, Vec3f> &move, SurfaceFilter &filter) {
    std::vector<Vec3f> corners;
    for (const Vec3f &p : polygon)
        for (unsigned corner = 0; corner < 8; ++corner) {
            Vec3f moved = p;
            for (std::size_t axis = 0; axis < 3; ++axis)
                moved[axis] += (corner >> axis & 1) != 0 ? move.second[axis] : move.first[axis];
            corners.push_back(moved);
        }
    filter.AddHull(corners);
}

void AddPolygonOf(const DrawSurface &surface, Polygon polygon, int planeNum, SurfaceFilter &filter) {
    if (const auto &move = surface.shader->geometry.move)
        AddMoving(polygon, *move, filter);
    else
        filter.AddPolygon(std::move(polygon), planeNum);
}

void AddTriangles(const DrawSurface &surface, SurfaceFilter &filter) {
    for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3) {
        Polygon triangle;
        for (std::size_t j = 0; j < 3; ++j)
            triangle.push_back(surface.verts[std::size_t(surface.indexes[i + j])].xyz);
        AddPolygonOf(surface, std::move(triangle), surface.planar ? surface.planeNum : -1, filter);
    }
    for (const DrawVert &vert : surface.verts)
        filter.AddPoint(vert.xyz);
}

} // namespace

bool FilterSurface(const DrawSurface &surface, int number, Tree &tree, const PlaneTable &planes, bool &inSkyBox) {
    SurfaceFilter filter(tree, planes, number, inSkyBox);
    switch (surface.kind) {
    case SurfaceKind::Face:
    case SurfaceKind::Decal:
        AddPolygonOf(surface, PolygonOf(surface), surface.planeNum, filter);
        break;
    case SurfaceKind::Patch:
        for (int row = 0; row + 2 < surface.height; row += 2)
            for (int column = 0; column + 2 < surface.width; column += 2)
                filter.AddHull(CellHull(surface, column, row));
        break;
    case SurfaceKind::FogHull:
    case SurfaceKind::Shader:
        filter.AddEverywhere();
        break;
    case SurfaceKind::Flare:
        filter.AddPoint(surface.lightmapOrigin);
        break;
    case SurfaceKind::Foliage:
        for (std::size_t i = std::size_t(surface.height); i < surface.verts.size(); ++i)
            filter.AddPoint(surface.verts[i].xyz);
        break;
    default:
        AddTriangles(surface, filter);
        break;
    }
    return filter.ReachesLeaf();
}

// ---- Last changes to vertices before they are written ----

namespace {

constexpr double kVolumeMargin = 1; ///< points this near to a color volume are in it, game units

/// The factor by which a dot-product step scales a color; 1 for other steps.
float DotProductFactor(const ColorStep &step, const Vec3f &normal) {
    using enum ColorStep::Kind;
    const float d = Dot(normal, step.value);
    const float range = step.max - step.min;
    switch (step.kind) {
    case DotProduct:
        return d;
    case DotProductScale:
        return (d - step.min) / range;
    case DotProduct2:
        return d * d;
    case DotProduct2Scale:
        return (d * d - step.min) / range;
    default:
        return 1;
    }
}

void ApplyStep(const ColorStep &step, DrawVert &vert) {
    using enum ColorStep::Kind;
    constexpr float kFull = 255;
    const float dotProductFactor = DotProductFactor(step, vert.normal);
    for (std::size_t channel = step.alpha ? 3 : 0; channel < (step.alpha ? 4u : 3u); ++channel) {
        const float argument = step.alpha ? step.value.x : step.value[channel];
        float value = vert.color[channel];
        if (step.kind == Set)
            value = kFull * argument;
        else
            value *= step.kind == Scale ? argument : dotProductFactor;
        vert.color[channel] = std::uint8_t(std::clamp(value, 0.0f, kFull));
    }
}

bool IsInside(const Brush &brush, const Vec3f &p, const PlaneTable &planes) {
    return std::all_of(brush.sides.begin(), brush.sides.end(), [&](const BrushSide &side) {
        return side.planeNum < 0 || planes[side.planeNum].Distance(Vec3d(p)) <= kVolumeMargin;
    });
}

void ApplyVolumes(DrawSurface &surface, const MapEntity &owner, const PlaneTable &planes) {
    if (owner.colorVolumes.empty())
        return;
    Boundsf bounds;
    for (const DrawVert &vert : surface.verts)
        bounds.Add(vert.xyz);
    for (const Brush &volume : owner.colorVolumes) {
        const bool applies = volume.settings.entity == 0 || volume.settings.entity == surface.settings.entity;
        if (!applies || !volume.contentShader || !volume.bounds.Touches(bounds, float(kVolumeMargin)))
            continue;
        const std::vector<ColorStep> &steps = volume.contentShader->geometry.colorSteps;
        for (DrawVert &vert : surface.verts)
            if (IsInside(volume, vert.xyz, planes))
                for (const ColorStep &step : steps)
                    if (step.kind != ColorStep::Kind::Volume)
                        ApplyStep(step, vert);
    }
}

} // namespace

void ModifySurface(DrawSurface &surface, const MapEntity &entity, const MapEntity &world, const PlaneTable &planes) {
    const GeometryDirectives &shader = surface.shader->geometry;
    const auto &m = shader.texMod;
    for (DrawVert &vert : surface.verts) {
        const float s = vert.st[0], t = vert.st[1];
        vert.st = {m[0][0] * s + m[0][1] * t + m[0][2], m[1][0] * s + m[1][1] * t + m[1][2]};
        if (!shader.IsColorVolume())
            for (const ColorStep &step : shader.colorSteps)
                ApplyStep(step, vert);
    }
    ApplyVolumes(surface, world, planes);
    if (&entity != &world)
        ApplyVolumes(surface, entity, planes);
}

void BiasTexture(DrawSurface &surface) {
    if (surface.shader->geometry.globalTexture || surface.verts.empty())
        return;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        float least = std::numeric_limits<float>::max(), most = std::numeric_limits<float>::lowest();
        for (const DrawVert &vert : surface.verts) {
            least = std::min(least, vert.st[axis]);
            most = std::max(most, vert.st[axis]);
        }
        const float repeats = std::floor((least + most) * 0.5f);
        for (DrawVert &vert : surface.verts)
            vert.st[axis] -= repeats;
    }
}

void InsetTriangles(DrawSurface &surface) {
    std::vector<DrawVert> verts;
    for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3) {
        std::array<DrawVert, 3> corners;
        Vec3f center;
        for (std::size_t j = 0; j < 3; ++j) {
            corners[j] = surface.verts[std::size_t(surface.indexes[i + j])];
            center += corners[j].xyz / 3.0f;
        }
        for (DrawVert &corner : corners) {
            corner.xyz += Normalize(center - corner.xyz);
            verts.push_back(corner);
        }
    }
    surface.verts = std::move(verts);
    surface.indexes.resize(surface.verts.size());
    for (std::size_t i = 0; i < surface.indexes.size(); ++i)
        surface.indexes[i] = int(i);
}

void ReverseSurface(DrawSurface &surface) {
    for (DrawVert &vert : surface.verts)
        vert.normal = -vert.normal;
    surface.lightmapVecs[2] = -surface.lightmapVecs[2];
    for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3)
        std::swap(surface.indexes[i], surface.indexes[i + 1]);
    if (surface.kind == SurfaceKind::Patch)
        for (int row = 0; row < surface.height; ++row) {
            const auto first = surface.verts.begin() + row * surface.width;
            std::reverse(first, first + surface.width);
        }
}

void OrderSpriteQuad(DrawSurface &surface, const BspContext &context) {
    const auto side = [&](std::size_t i) { return Length(surface.verts[(i + 1) % 4].xyz - surface.verts[i].xyz); };
    if (surface.verts.size() != 4 || surface.indexes.size() != 6) {
        context.WarnAt("sprite shape", surface.settings.entity, surface.primitive,
                       fmt::format("shader {}: autosprite2 needs quads, this surface has {} vertices",
                                   surface.shader->name, surface.verts.size()));
        return;
    }
    constexpr float kSameLength = 0.1f; // game units
    if (std::abs(side(0) - side(1)) < kSameLength) {
        context.WarnAt(
            "sprite shape", surface.settings.entity, surface.primitive,
            fmt::format("shader {}: autosprite2 needs an oblong quad, this one is a square", surface.shader->name));
        return;
    }
    if (side(1) < side(0))
        std::rotate(surface.verts.begin(), surface.verts.begin() + 1, surface.verts.end());
    surface.indexes = {3, 0, 2, 2, 0, 1};
}

// ---- Order of triangles for the vertex cache ----

namespace {

constexpr int kAllHits = 3; ///< all three vertices are in the cache

/// FIFO of the vertices that entered the cache last, newest first. A hit does not move its entry.
class VertexCache {
  public:
    explicit VertexCache(const std::vector<int> &indexes) { std::copy_n(indexes.begin(), kSize, entries_.begin()); }

    /// Number of entries that the triangle uses. The first indexes fill the cache, repeats included, so a vertex may
    /// count more than once at the start.
    int Hits(const int *triangle) const {
        return int(std::count_if(entries_.begin(), entries_.end(), [&](int entry) {
            return entry == triangle[0] || entry == triangle[1] || entry == triangle[2];
        }));
    }
    void Use(int index) {
        if (Holds(index))
            return;
        std::rotate(entries_.begin(), entries_.end() - 1, entries_.end());
        entries_.front() = index;
    }

    static constexpr std::size_t kSize = 16; ///< vertices

  private:
    bool Holds(int index) const { return std::find(entries_.begin(), entries_.end(), index) != entries_.end(); }

    std::array<int, kSize> entries_{};
};

} // namespace

std::vector<int> OrderTriangles(const std::vector<int> &indexes) {
    if (indexes.size() <= VertexCache::kSize)
        return indexes;
    VertexCache cache(indexes);
    std::vector<char> used(indexes.size() / kIndexesPerTriangle, 0);
    std::vector<int> ordered;
    ordered.reserve(indexes.size());
    std::size_t firstFree = 0;
    while (firstFree < used.size()) {
        std::size_t best = firstFree;
        int bestHits = -1;
        for (std::size_t i = firstFree; i < used.size() && bestHits != kAllHits; ++i)
            if (!used[i])
                if (const int hits = cache.Hits(&indexes[i * kIndexesPerTriangle]); hits > bestHits) {
                    bestHits = hits;
                    best = i;
                }
        used[best] = 1;
        while (firstFree < used.size() && used[firstFree])
            ++firstFree;
        const auto corner = indexes.begin() + std::ptrdiff_t(best * kIndexesPerTriangle);
        std::array<int, kIndexesPerTriangle> triangle{corner[0], corner[1], corner[2]};
        for (const int index : triangle)
            cache.Use(index);
        // Each begins with its smallest index; its orientation stays.
        std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
        ordered.insert(ordered.end(), triangle.begin(), triangle.end());
    }
    return ordered;
}

// ---- Equal runs of draw indexes are stored once ----

namespace {

constexpr std::size_t kIndexesPerPair = 2 * kIndexesPerTriangle;
/// Parameters of the 64-bit FNV hash (Fowler, Noll and Vo).
constexpr std::uint64_t kFnvOffsetBasis = 14695981039346656037u, kFnvPrime = 1099511628211u;

/// Hash of `count` indexes from `at` on: FNV-1a with an index in place of each byte.
template <typename List> std::uint64_t HashOf(const List &list, std::size_t at, std::size_t count) {
    std::uint64_t hash = kFnvOffsetBasis;
    for (std::size_t i = 0; i < count; ++i)
        hash = (hash ^ std::uint64_t(std::uint32_t(list[at + i]))) * kFnvPrime;
    return hash;
}

} // namespace

void IndexRuns::HashNewEntries(const std::vector<std::int32_t> &list) {
    for (; hashedTriangles_ + kIndexesPerTriangle <= list.size(); ++hashedTriangles_)
        triangles_[HashOf(list, hashedTriangles_, kIndexesPerTriangle)].push_back(std::int32_t(hashedTriangles_));
    for (; hashedPairs_ + kIndexesPerPair <= list.size(); ++hashedPairs_)
        pairs_[HashOf(list, hashedPairs_, kIndexesPerPair)].push_back(std::int32_t(hashedPairs_));
}

int IndexRuns::FindOrAppend(std::vector<std::int32_t> &list, std::span<const int> run) {
    const int end = int(list.size());
    if (run.size() < kIndexesPerTriangle)
        return end;
    HashNewEntries(list);
    const bool isLong = run.size() >= kIndexesPerPair;
    const auto &offsets = isLong ? pairs_ : triangles_;
    if (const auto found = offsets.find(HashOf(run, 0, isLong ? kIndexesPerPair : kIndexesPerTriangle));
        found != offsets.end())
        for (const std::int32_t offset : found->second)
            if (std::size_t(offset) + run.size() <= list.size() &&
                std::equal(run.begin(), run.end(), list.begin() + offset))
                return offset;
    list.insert(list.end(), run.begin(), run.end());
    return end;
}

} // namespace q3
