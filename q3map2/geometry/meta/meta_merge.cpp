// GPL-2.0-or-later. Greedy merging: a surface grows from a seed by the candidate with the highest score.
#include "q3map2/geometry/meta/meta_merge.h"

#include "q3map2/geometry/surface/surface_class.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <utility>

namespace q3 {
namespace {

// Parts of a candidate's score. The best candidate joins if its score exceeds kAdequate; the first with at least kGood
// ends the search.
constexpr int kSameSurface = 1000, kSameAxis = 100000, kSharedVertex = 10000, kTextureKept = 200;
constexpr int kTextureRangeKept = 100, kTextureShorterAxisGrows = 50;
constexpr int kAdequate = 110000, kGood = 120200;
/// Seeds with the same key are ordered along this direction.
constexpr Vec3d kSweep{0.786868, 0.316861, 0.529564};

using TextureBounds = std::array<std::array<float, 2>, 2>; ///< mins, maxs

struct Growth {
    DrawSurface surface;
    const MetaTriangle *seed = nullptr;
    bool vertexLit = false, anyPlane = false;
    int maxVerts = 0, maxExtent = 0;
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
    std::vector<double> sweep;
    for (const MetaTriangle &t : mesh_.Triangles()) {
        std::array<double, 3> along{};
        for (std::size_t i = 0; i < 3; ++i)
            along[i] = Dot(kSweep, Vec3d(Vert(mesh_, t.verts[i]).xyz));
        sweep.push_back(std::ranges::min(along));
    }
    const auto rank = [&](int i) {
        const MetaKey &k = mesh_.Keys()[std::size_t(mesh_.Triangles()[std::size_t(i)].key)];
        return std::tuple(k.shaderOrder, k.fogNum, k.entity, k.castShadows, k.receiveShadows, k.sampleSize, k.ambient.x,
                          k.ambient.y, k.ambient.z, k.backSide, sweep[std::size_t(i)]);
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
    // Ranges in whole texels, limited so that huge texture coordinates do not overflow the conversion to long long.
    const auto range = [&](const TextureBounds &b, std::size_t i) {
        return (long long)(std::min(1e15, (double(b[1][i]) - double(b[0][i])) * texels[i]));
    };
    int score = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const long long old = range(growth.texture, i), other = range(growth.texture, 1 - i);
        if (range(bounds, i) <= old)
            score += kTextureRangeKept;
        else if (other > old)
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
