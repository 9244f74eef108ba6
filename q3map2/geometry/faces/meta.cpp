// GPL-2.0-or-later. The meta step: triangles of faces with smoothed normals, merged into draw surfaces.
#include "q3map2/geometry/faces/meta.h"

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/geometry/faces/face_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

namespace q3 {

// ---- The meta step: triangles with shared vertices from faces ----

namespace {

constexpr double kMinEdge = 0.125;    ///< game units: triangles with a shorter edge are left out
constexpr float kSameTexture = 1e-4f; ///< difference of s or t

bool SameCorner(const DrawVert &a, const DrawVert &b) {
    return SameVector(a.normal, b.normal) && std::abs(a.st[0] - b.st[0]) <= kSameTexture &&
           std::abs(a.st[1] - b.st[1]) <= kSameTexture && a.color[3] == b.color[3];
}

bool HasShortEdge(const std::array<DrawVert, 3> &corners) {
    for (std::size_t i = 0; i < 3; ++i)
        // Not `<`, so that NaN, which models may contain, counts as short.
        if (!(Length(Vec3d(corners[(i + 1) % 3].xyz) - Vec3d(corners[i].xyz)) >= kMinEdge))
            return true;
    return false;
}

/// The plane of the surface, or of the corners. Zero normal: collinear corners.
Plane TrianglePlane(const DrawSurface &surface, const std::array<DrawVert, 3> &corners, const PlaneTable &planes) {
    if (surface.planar && surface.planeNum >= 0)
        return planes[surface.planeNum];
    const Vec3d a(corners[0].xyz), b(corners[1].xyz), c(corners[2].xyz);
    const Vec3d normal = Normalize(Cross(c - a, b - a));
    return {normal, Dot(normal, a)};
}

/// The axis along which the triangle is projected to the lightmap; zero: it is lit at its vertices.
Vec3f LightmapAxisOf(const DrawSurface &surface, const Plane &plane) {
    if (surface.lightmapAxis != Vec3f{} || IsVertexLit(surface))
        return surface.lightmapAxis;
    if (surface.shader->lightmap.axis != Vec3f{})
        return surface.shader->lightmap.axis;
    return DominantAxis(Vec3f(plane.normal));
}

/// Whether the surface takes part in the meta step.
bool IsMetaSurface(const DrawSurface &surface, const BspOptions &options) {
    if (surface.Empty() || surface.shader == nullptr || surface.shader->autosprite)
        return false;
    // Faces of too many corners for one surface of an engine are cut up in any case.
    const bool isLarge = int(surface.verts.size()) > options.maxVertexLitVerts;
    if (!options.meta && !surface.shader->geometry.forceMeta && !isLarge)
        return false;
    return surface.kind == SurfaceKind::Face || surface.kind == SurfaceKind::Decal ||
           surface.kind == SurfaceKind::ForcedMeta;
}

} // namespace

bool SameVector(const Vec3f &a, const Vec3f &b) {
    const Vec3d d = Vec3d(a) - Vec3d(b);
    return std::abs(d.x) <= kSameVectorEpsilon && std::abs(d.y) <= kSameVectorEpsilon &&
           std::abs(d.z) <= kSameVectorEpsilon;
}

int MetaMesh::KeyOf(const DrawSurface &surface) {
    MetaKey key;
    key.shaderOrder = shaderOrder_.try_emplace(surface.shader, int(shaderOrder_.size())).first->second;
    key.fogNum = surface.fogNum;
    key.entity = surface.settings.entity;
    key.castShadows = surface.settings.castShadows, key.receiveShadows = surface.settings.receiveShadows;
    key.sampleSize = surface.sampleSize;
    key.ambient = surface.settings.ambient;
    key.backSide = surface.backSide;
    // Searched from the back, because the newest key nearly always matches.
    const auto found = std::find(keys_.rbegin(), keys_.rend(), key);
    if (found != keys_.rend())
        return int(keys_.rend() - found) - 1;
    keys_.push_back(key);
    return int(keys_.size()) - 1;
}

int MetaMesh::VertOf(const DrawVert &vert) {
    const int group = positions_.FindOrAdd(vert.xyz);
    if (group == int(groups_.size()))
        groups_.emplace_back();
    std::vector<int> &members = groups_[std::size_t(group)];
    for (const int i : members)
        if (SameCorner(verts_[std::size_t(i)].vert, vert))
            return i;
    members.push_back(int(verts_.size()));
    verts_.push_back({vert, group, {}});
    return members.back();
}

bool MetaMesh::HasTriangle(const MetaTriangle &triangle) const {
    const std::vector<int> &candidates = verts_[std::size_t(triangle.verts[0])].triangles;
    return std::ranges::any_of(candidates, [&](int i) {
        const MetaTriangle &other = triangles_[std::size_t(i)];
        return other.key == triangle.key && std::ranges::is_permutation(other.verts, triangle.verts);
    });
}

MetaTriangle MetaMesh::WithVerts(MetaTriangle triangle, const std::array<DrawVert, 3> &corners) {
    for (std::size_t i = 0; i < 3; ++i)
        triangle.verts[i] = VertOf(corners[i]);
    return triangle;
}

void MetaMesh::Append(const MetaTriangle &triangle) {
    for (const int v : triangle.verts)
        verts_[std::size_t(v)].triangles.push_back(int(triangles_.size()));
    triangles_.push_back(triangle);
}

void MetaMesh::Add(const DrawSurface &surface, int number, const PlaneTable &planes, const BspContext &context) {
    const int key = KeyOf(surface);
    for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3) {
        std::array<DrawVert, 3> corners;
        for (std::size_t c = 0; c < 3; ++c)
            corners[c] = surface.verts[std::size_t(surface.indexes[i + c])];
        MetaTriangle triangle;
        triangle.plane = TrianglePlane(surface, corners, planes);
        if (HasShortEdge(corners) || triangle.plane.normal == Vec3d{})
            continue;
        for (DrawVert &corner : corners)
            if (corner.normal == Vec3f{})
                corner.normal = Vec3f(triangle.plane.normal);
        triangle.key = key, triangle.surface = number;
        triangle.planeNum = surface.planar ? surface.planeNum : -1;
        triangle.lightmapAxis = LightmapAxisOf(surface, triangle.plane);
        triangle = WithVerts(triangle, corners);
        if (HasTriangle(triangle))
            context.WarnAt("duplicate triangle", surface.settings.entity, surface.primitive,
                           "two triangles of shader " + surface.shader->name +
                               " have the same corners; one of them is left out");
        else
            Append(triangle);
    }
}

void MetaMesh::ReplaceNormals(const std::vector<std::array<Vec3f, 3>> &normals) {
    const std::vector<MetaTriangle> triangles = std::exchange(triangles_, {});
    const std::vector<MetaVert> verts = std::exchange(verts_, {});
    for (std::vector<int> &group : groups_)
        group.clear();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        std::array<DrawVert, 3> corners;
        for (std::size_t c = 0; c < 3; ++c) {
            corners[c] = verts[std::size_t(triangles[t].verts[c])].vert;
            corners[c].normal = normals[t][c];
        }
        Append(WithVerts(triangles[t], corners));
    }
}

void MakeMetaSurfaces(Geometry &geometry, std::size_t first, PlaneTable &planes, const BspContext &context) {
    MetaMesh mesh;
    int strips = 0, fans = 0, forced = 0;
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i) {
        DrawSurface &surface = geometry.surfaces[i];
        if (!IsMetaSurface(surface, context.options))
            continue;
        if (surface.kind == SurfaceKind::ForcedMeta)
            ++forced;
        else {
            const std::size_t verts = surface.verts.size();
            TriangulateFace(surface, context);
            ++(surface.verts.size() > verts ? fans : strips);
        }
        mesh.Add(surface, int(i), planes, context);
        surface.verts.clear(), surface.indexes.clear();
    }
    if (mesh.Triangles().empty())
        return;
    Log &log = context.log;
    log.VerboseCount(strips, "strip faces");
    log.VerboseCount(fans, "fan faces");
    log.VerboseCount(forced, "forced meta surfaces");
    log.VerboseCount(mesh.GroupCount(), "meta positions");
    log.VerboseCount(int(mesh.Triangles().size()), "meta triangles");
    SmoothNormals(mesh, geometry, context);
    const std::size_t before = geometry.surfaces.size();
    MergeTriangles(mesh, geometry, planes, context);
    std::size_t verts = 0;
    for (std::size_t i = before; i < geometry.surfaces.size(); ++i)
        verts += geometry.surfaces[i].verts.size();
    log.VerboseCount(int(geometry.surfaces.size() - before), "merged surfaces");
    log.VerboseCount(verts, "merged vertices");
}

// ---- Smoothed normals ----

namespace {

constexpr double kSameNormal = 0.01; ///< per component
constexpr double kAngleError = 1e-6; ///< of an arc cosine by rounding, radians

/// A corner of a triangle at the point that is being smoothed.
struct SmoothedCorner {
    int triangle = 0, corner = 0;
    double shadeAngle = 0; ///< radians
    Vec3d normal;
    bool isSmoothed = false;
};

double ShadeAngle(const DrawSurface &surface, const BspOptions &options) {
    float degrees = options.nonPlanarAngle;
    if (surface.shader->lightmap.shadeAngle > 0)
        degrees = surface.shader->lightmap.shadeAngle;
    else if (surface.settings.shadeAngle > 0)
        degrees = surface.settings.shadeAngle;
    return std::max(0., double(degrees)) * std::numbers::pi / 180;
}

std::vector<SmoothedCorner> CornersOf(const MetaMesh &mesh, int group, const std::vector<double> &angles) {
    std::vector<SmoothedCorner> corners;
    for (const int v : mesh.Group(group))
        for (const int t : mesh.Verts()[std::size_t(v)].triangles) {
            const MetaTriangle &triangle = mesh.Triangles()[std::size_t(t)];
            const double angle = angles[std::size_t(triangle.surface)];
            if (angle > 0)
                corners.push_back({t, int(std::ranges::find(triangle.verts, v) - triangle.verts.begin()), angle,
                                   Vec3d(mesh.Verts()[std::size_t(v)].vert.normal)});
        }
    return corners;
}

/// Whether the angle between the normals is below the shade angle of both.
bool AreSmoothedTogether(const SmoothedCorner &a, const SmoothedCorner &b) {
    const double angle = std::acos(std::clamp(Dot(a.normal, b.normal), -1., 1.));
    return angle + kAngleError < std::min(a.shadeAngle, b.shadeAngle);
}

/// Adds up the distinct normals and returns their number.
int AddDistinctNormals(const std::vector<SmoothedCorner *> &corners, Vec3d &sum) {
    std::vector<Vec3d> distinct;
    for (const SmoothedCorner *corner : corners) {
        const bool isKnown = std::ranges::any_of(distinct, [&](const Vec3d &n) {
            const Vec3d d = n - corner->normal;
            return std::abs(d.x) <= kSameNormal && std::abs(d.y) <= kSameNormal && std::abs(d.z) <= kSameNormal;
        });
        if (isKnown)
            continue;
        distinct.push_back(corner->normal);
        sum += corner->normal;
    }
    return int(distinct.size());
}

/// Smooths the corners at one point. Returns the number of corners whose normal changed.
int SmoothPoint(std::vector<SmoothedCorner> corners, std::vector<std::array<Vec3f, 3>> &normals) {
    int changed = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (corners[i].isSmoothed)
            continue;
        std::vector<SmoothedCorner *> together{&corners[i]};
        for (std::size_t k = i + 1; k < corners.size(); ++k)
            if (!corners[k].isSmoothed && AreSmoothedTogether(corners[i], corners[k]))
                together.push_back(&corners[k]);
        if (together.size() < 2)
            continue;
        for (SmoothedCorner *corner : together)
            corner->isSmoothed = true;
        Vec3d sum;
        const bool several = AddDistinctNormals(together, sum) > 1;
        const Vec3f normal(Normalize(sum));
        if (!several || normal == Vec3f{})
            continue;
        for (const SmoothedCorner *corner : together)
            normals[std::size_t(corner->triangle)][std::size_t(corner->corner)] = normal;
        changed += int(together.size());
    }
    return changed;
}

} // namespace

void SmoothNormals(MetaMesh &mesh, const Geometry &geometry, const BspContext &context) {
    std::vector<double> angles(geometry.surfaces.size());
    bool anyIsSmoothed = false;
    for (const MetaTriangle &triangle : mesh.Triangles()) {
        const auto number = std::size_t(triangle.surface);
        angles[number] = ShadeAngle(geometry.surfaces[number], context.options);
        anyIsSmoothed |= angles[number] > 0;
    }
    if (!anyIsSmoothed)
        return;
    std::vector<std::array<Vec3f, 3>> normals(mesh.Triangles().size());
    for (std::size_t t = 0; t < normals.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c)
            normals[t][c] = mesh.Verts()[std::size_t(mesh.Triangles()[t].verts[c])].vert.normal;
    int changed = 0;
    for (int group = 0; group < mesh.GroupCount(); ++group)
        changed += SmoothPoint(CornersOf(mesh, group, angles), normals);
    context.log.VerboseCount(changed, "smoothed corners");
    if (changed > 0)
        mesh.ReplaceNormals(normals);
}

// ---- Greedy merging: a surface grows from a seed by the candidate with the highest score ----

namespace {

// Parts of a candidate's score: for its source surface, its lightmap axis, and each of its vertices that the surface
// has.
constexpr int kSameSurface = 1000, kSameAxis = 100000, kSharedVertex = 10000;
// For the range of texture coordinates of the surface: it stays; its extent stays on one axis; it grows on the axis on
// which it is shorter.
constexpr int kTextureKept = 200, kTextureRangeKept = 100, kTextureShorterAxisGrows = 50;
/// The best candidate joins if its score exceeds this.
constexpr int kAdequate = kSameAxis + kSharedVertex;
/// The first candidate with at least this score ends the search.
constexpr int kGood = kSameAxis + 2 * kSharedVertex + kTextureKept;
/// Seeds with the same key are ordered along this direction, a unit vector. It is oblique to all axes, so that vertices
/// on a grid seldom tie; any other oblique vector would do.
constexpr Vec3d kSeedDirection{0.786868, 0.316861, 0.529564};

using TextureBounds = std::array<std::array<float, 2>, 2>; ///< mins, maxs

/// A surface while triangles are added to it.
struct Growth {
    DrawSurface surface;
    const MetaTriangle *seed = nullptr;
    bool vertexLit = false;
    bool anyPlane = false; ///< triangles need not be in the plane of the seed
    int maxVerts = 0;
    int maxExtent = 0;      ///< of the lightmap, game units
    std::vector<int> verts; ///< mesh vertices, in the order of surface.verts
    TextureBounds texture{};
    Boundsf bounds;
    std::vector<int> candidates; ///< triangles, in order of discovery
    bool Empty() const { return surface.indexes.empty(); }
};

class SurfaceGrower {
  public:
    SurfaceGrower(const MetaMesh &mesh, Geometry &geometry, PlaneTable &planes, const BspContext &context)
        : mesh_(mesh), geometry_(geometry), planes_(planes), context_(context), used_(mesh.Triangles().size()),
          seenBy_(mesh.Triangles().size(), -1), slots_(mesh.Verts().size(), -1) {}
    void Run();

  private:
    std::vector<int> SeedOrder() const;
    Growth Start(const MetaTriangle &seed) const;
    void Grow(int seed);
    void AddTriangle(Growth &growth, int triangle);
    void Discover(Growth &growth, const MetaTriangle &triangle);
    bool MayJoin(const Growth &growth, const MetaTriangle &triangle) const;
    int Score(const Growth &growth, const MetaTriangle &triangle) const;
    /// Number of vertices of the surface with the position and normal of `vert`; if `vert` is in the surface, only
    /// those up to it. `isNew`: `vert` is not in the surface.
    int Matches(int vert, bool &isNew) const;
    bool FitsLightmap(const Growth &growth, const MetaTriangle &triangle) const;
    int TextureScore(const Growth &growth, const MetaTriangle &triangle) const;
    void Finish(Growth &growth);

    const MetaMesh &mesh_;
    Geometry &geometry_;
    PlaneTable &planes_;
    const BspContext &context_;
    std::vector<char> used_;
    std::vector<int> seenBy_; ///< by triangle: the last seed for which it was discovered
    std::vector<int> slots_;  ///< by vertex: its index in the growing surface; -1: not in it
};

const DrawVert &Vert(const MetaMesh &mesh, int i) {
    return mesh.Verts()[std::size_t(i)].vert;
}

TextureBounds WithTexture(TextureBounds bounds, const DrawVert &vert) {
    for (std::size_t i = 0; i < 2; ++i) {
        bounds[0][i] = std::min(bounds[0][i], vert.st[i]);
        bounds[1][i] = std::max(bounds[1][i], vert.st[i]);
    }
    return bounds;
}

std::vector<int> SurfaceGrower::SeedOrder() const {
    std::vector<double> leastAlong; // by triangle: the least coordinate of its corners along kSeedDirection
    for (const MetaTriangle &t : mesh_.Triangles()) {
        std::array<double, 3> along{};
        for (std::size_t i = 0; i < 3; ++i)
            along[i] = Dot(kSeedDirection, Vec3d(Vert(mesh_, t.verts[i]).xyz));
        leastAlong.push_back(std::ranges::min(along));
    }
    const auto rank = [&](int i) {
        const MetaKey &k = mesh_.Keys()[std::size_t(mesh_.Triangles()[std::size_t(i)].key)];
        return std::tuple(k.shaderOrder, k.fogNum, k.entity, k.castShadows, k.receiveShadows, k.sampleSize, k.ambient.x,
                          k.ambient.y, k.ambient.z, k.backSide, leastAlong[std::size_t(i)]);
    };
    std::vector<int> order(mesh_.Triangles().size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, rank);
    return order;
}

Growth SurfaceGrower::Start(const MetaTriangle &seed) const {
    const DrawSurface &from = geometry_.surfaces[std::size_t(seed.surface)];
    const BspOptions &options = context_.options;
    Growth growth;
    growth.seed = &seed;
    DrawSurface &surface = growth.surface;
    surface.kind = SurfaceKind::Meta;
    surface.shader = from.shader, surface.settings = from.settings;
    surface.planeNum = seed.planeNum, surface.fogNum = from.fogNum;
    surface.sampleSize = from.sampleSize, surface.lightmapAxis = seed.lightmapAxis;
    surface.backSide = from.backSide;
    growth.vertexLit = IsVertexLit(from);
    // Seeds of curves and models mostly have no plane that others could share.
    growth.anyPlane = options.nonPlanarAngle > 0 || from.shader->geometry.nonPlanar || seed.planeNum < 0;
    growth.maxVerts = growth.vertexLit ? options.maxVertexLitVerts : options.maxSurfaceVerts;
    const int custom = from.shader->lightmap.pageSize[0];
    growth.maxExtent = from.sampleSize * ((custom > 0 ? custom : context_.game.lightmapSize) - 1);
    return growth;
}

bool SurfaceGrower::MayJoin(const Growth &growth, const MetaTriangle &triangle) const {
    if (triangle.key != growth.seed->key)
        return false;
    if (growth.anyPlane)
        return true;
    return triangle.planeNum == growth.seed->planeNum &&
           SameVector(Vec3f(triangle.plane.normal), Vec3f(growth.seed->plane.normal)) &&
           std::abs(triangle.plane.dist - growth.seed->plane.dist) <= kSameVectorEpsilon;
}

void SurfaceGrower::Discover(Growth &growth, const MetaTriangle &triangle) {
    const int seed = int(growth.seed - mesh_.Triangles().data());
    for (const int corner : triangle.verts)
        for (const int vert : mesh_.Group(mesh_.Verts()[std::size_t(corner)].group))
            for (const int t : mesh_.Verts()[std::size_t(vert)].triangles) {
                const auto i = std::size_t(t);
                if (used_[i] != 0 || std::exchange(seenBy_[i], seed) == seed)
                    continue;
                if (MayJoin(growth, mesh_.Triangles()[i]))
                    growth.candidates.push_back(t);
            }
}

void SurfaceGrower::AddTriangle(Growth &growth, int number) {
    const MetaTriangle &triangle = mesh_.Triangles()[std::size_t(number)];
    used_[std::size_t(number)] = 1;
    std::vector<SideNumber> &sides = growth.surface.mergedSides;
    const auto side = SideOf(geometry_.surfaces[std::size_t(triangle.surface)]);
    if (side && (sides.empty() || sides.back() != *side))
        sides.push_back(*side);
    for (const int v : triangle.verts) {
        const DrawVert &vert = Vert(mesh_, v);
        int &slot = slots_[std::size_t(v)];
        if (growth.verts.empty())
            growth.texture = {vert.st, vert.st};
        if (slot < 0) {
            slot = int(growth.verts.size());
            growth.verts.push_back(v);
            growth.surface.verts.push_back(vert);
            growth.bounds.Add(vert.xyz);
            growth.texture = WithTexture(growth.texture, vert);
        }
        growth.surface.indexes.push_back(slot);
    }
    Discover(growth, triangle);
}

int SurfaceGrower::Matches(int vert, bool &isNew) const {
    const int own = slots_[std::size_t(vert)];
    isNew = own < 0;
    int matches = 0;
    for (const int other : mesh_.Group(mesh_.Verts()[std::size_t(vert)].group)) {
        const int slot = slots_[std::size_t(other)];
        if (slot >= 0 && (isNew || slot <= own) && SameVector(Vert(mesh_, other).normal, Vert(mesh_, vert).normal))
            ++matches;
    }
    return matches;
}

bool SurfaceGrower::FitsLightmap(const Growth &growth, const MetaTriangle &triangle) const {
    if (growth.vertexLit || growth.surface.lightmapAxis == Vec3f{})
        return true;
    Boundsf bounds = growth.bounds;
    for (const int v : triangle.verts)
        bounds.Add(Vert(mesh_, v).xyz);
    if (bounds.mins == growth.bounds.mins && bounds.maxs == growth.bounds.maxs)
        return true;
    return MaxComponent(bounds.maxs - bounds.mins) <= float(growth.maxExtent);
}

int SurfaceGrower::TextureScore(const Growth &growth, const MetaTriangle &triangle) const {
    TextureBounds bounds = growth.texture;
    for (const int v : triangle.verts)
        bounds = WithTexture(bounds, Vert(mesh_, v));
    if (bounds == growth.texture)
        return kTextureKept;
    const GeometryDirectives &shader = growth.surface.shader->geometry;
    const std::array<double, 2> texels{double(shader.textureWidth), double(shader.textureHeight)};
    // Extents in whole texels, limited so that huge texture coordinates do not overflow the conversion to long long.
    const auto extent = [&](const TextureBounds &b, std::size_t i) {
        constexpr double kMostTexels = 1e15;
        return (long long)(std::min(kMostTexels, (double(b[1][i]) - double(b[0][i])) * texels[i]));
    };
    int score = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const long long old = extent(growth.texture, i), otherAxis = extent(growth.texture, 1 - i);
        if (extent(bounds, i) <= old)
            score += kTextureRangeKept;
        else if (otherAxis > old)
            score += kTextureShorterAxisGrows;
    }
    return score;
}

int SurfaceGrower::Score(const Growth &growth, const MetaTriangle &triangle) const {
    if (int(growth.surface.indexes.size()) + 3 > context_.options.maxSurfaceIndexes)
        return 0;
    int added = 0, matches = 0;
    for (const int v : triangle.verts) {
        bool isNew = false;
        matches += Matches(v, isNew);
        added += isNew;
    }
    if (added > 0 && int(growth.verts.size()) + added > growth.maxVerts)
        return 0;
    if (!FitsLightmap(growth, triangle))
        return 0;
    int score = matches * kSharedVertex;
    if (triangle.surface == growth.seed->surface)
        score += kSameSurface;
    if (growth.vertexLit || growth.surface.lightmapAxis == triangle.lightmapAxis)
        score += kSameAxis;
    else
        score += int(kSameAxis * Dot(Vec3d(growth.surface.lightmapAxis), triangle.plane.normal));
    return score + TextureScore(growth, triangle);
}

void SurfaceGrower::Finish(Growth &growth) {
    for (const int v : growth.verts)
        slots_[std::size_t(v)] = -1;
    ClassifySurface(growth.surface, planes_, context_);
    growth.surface.lightmapAxis = growth.seed->lightmapAxis;
    std::vector<SideNumber> &sides = growth.surface.mergedSides;
    std::ranges::sort(sides);
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    geometry_.surfaces.push_back(std::move(growth.surface));
}

void SurfaceGrower::Grow(int seed) {
    const BspOptions &options = context_.options;
    const int adequate = options.metaAdequateScore >= 0 ? options.metaAdequateScore : kAdequate;
    const int good = options.metaGoodScore >= 0 ? options.metaGoodScore : kGood;
    Growth growth = Start(mesh_.Triangles()[std::size_t(seed)]);
    AddTriangle(growth, seed);
    while (true) {
        int bestScore = 0;
        std::size_t best = 0;
        for (std::size_t i = 0; i < growth.candidates.size(); ++i) {
            const int score = Score(growth, mesh_.Triangles()[std::size_t(growth.candidates[i])]);
            if (score > bestScore)
                best = i, bestScore = score;
            if (score >= good)
                break;
        }
        if (bestScore <= adequate)
            break;
        const int triangle = growth.candidates[best];
        growth.candidates.erase(growth.candidates.begin() + std::ptrdiff_t(best));
        AddTriangle(growth, triangle);
    }
    Finish(growth);
}

void SurfaceGrower::Run() {
    for (const int seed : SeedOrder())
        if (used_[std::size_t(seed)] == 0)
            Grow(seed);
}

} // namespace

void MergeTriangles(const MetaMesh &mesh, Geometry &geometry, PlaneTable &planes, const BspContext &context) {
    SurfaceGrower(mesh, geometry, planes, context).Run();
}

} // namespace q3
