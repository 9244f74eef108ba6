// GPL-2.0-or-later. Foliage surfaces: one model and its instances.
#include "q3map2/geometry/effects/foliage.h"

#include "q3map2/geometry/models/model_scatter.h"
#include "q3map2/model/model_load.h"

namespace q3 {
namespace {

constexpr std::size_t kMaxInstances = 8192;
constexpr double kMinUp = 0.5, kMinAlpha = 0.75;

bool IsSteep(const SurfaceTriangle &t) {
    const Vec3d a(t[0].xyz), b(t[1].xyz), c(t[2].xyz);
    return Normalize(Cross(c - a, b - a)).z < kMinUp;
}

/// Probability that the triangle gets an instance.
double InstanceProbability(const SurfaceTriangle &t, const FoliageDirective &directive) {
    double alpha = (int(t[0].color[3]) + t[1].color[3] + t[2].color[3]) / 765.;
    if (directive.invertAlpha == 1)
        alpha = 1 - alpha;
    else if (directive.invertAlpha == 2)
        alpha = 1;
    return alpha < kMinAlpha ? 0 : alpha * directive.odds;
}

std::vector<DrawVert> Instances(const DrawSurface &surface, const FoliageDirective &directive, ScatterRandom &random,
                                const BspContext &context) {
    std::vector<SurfaceTriangle> triangles = TrianglesOf(surface, context);
    std::erase_if(triangles, IsSteep);
    Bisect(triangles, directive.density);
    std::vector<DrawVert> instances;
    for (const SurfaceTriangle &t : triangles) {
        if (random.Next() >= InstanceProbability(t, directive) || instances.size() >= kMaxInstances)
            continue;
        DrawVert vert = t[0];
        vert.xyz = (t[0].xyz + t[1].xyz + t[2].xyz) / 3.f;
        vert.normal = Normalize(t[0].normal + t[1].normal + t[2].normal);
        instances.push_back(vert);
    }
    return instances;
}

DrawSurface FoliageSurface(const ModelMesh &mesh, float scale, const std::vector<DrawVert> &instances,
                           const DrawSurface &ground, const BspContext &context) {
    DrawSurface surface;
    surface.kind = SurfaceKind::Foliage;
    surface.shader = &context.shaders.Get(mesh.shader);
    surface.settings = ground.settings;
    surface.fogNum = ground.fogNum;
    surface.verts = mesh.verts;
    for (DrawVert &vert : surface.verts)
        vert.xyz *= scale;
    for (const auto &[a, b, c] : mesh.triangles)
        surface.indexes.insert(surface.indexes.end(), {a, b, c});
    surface.width = int(instances.size()), surface.height = int(mesh.verts.size());
    surface.verts.insert(surface.verts.end(), instances.begin(), instances.end());
    for (const DrawVert &vert : instances)
        surface.bounds.Add(vert.xyz);
    return surface;
}

} // namespace

void MakeFoliage(std::size_t surface, Geometry &geometry, const BspContext &context) {
    const DrawSurface ground = geometry.surfaces[surface]; // a copy: appending invalidates references
    if (ground.shader == nullptr || ground.Empty() || (ground.furred && ground.isCopy) ||
        ground.shader->geometry.foliage.empty() || (ground.kind != SurfaceKind::Patch && ground.indexes.empty()) ||
        ground.kind == SurfaceKind::Foliage)
        return;
    if (!geometry.models)
        geometry.models = std::make_shared<ModelLibrary>(context.vfs);
    ScatterRandom random{std::uint32_t(surface)};
    for (const FoliageDirective &directive : ground.shader->geometry.foliage) {
        context.log.Warn("foliage", "{}: q3map_foliage makes surfaces that Quake III engines do not draw",
                         ground.shader->name);
        std::string problem;
        const Model *model = geometry.models->Get(directive.model, 0, problem);
        if (model == nullptr) {
            context.log.Warn("model cannot be read", "{}: the foliage model {} cannot be read: {}", ground.shader->name,
                             directive.model, problem);
            continue;
        }
        const std::vector<DrawVert> instances = Instances(ground, directive, random, context);
        if (instances.empty())
            continue;
        for (const ModelMesh &mesh : model->meshes)
            geometry.surfaces.push_back(FoliageSurface(mesh, directive.scale, instances, ground, context));
    }
}

} // namespace q3
