// GPL-2.0-or-later. Flares of lights and shaders.
#include "q3map2/geometry/effects/flares.h"

#include "q3map2/bspfile/object_keys.h"

namespace q3 {
namespace {

constexpr float kFlareDistance = 2; ///< game units in front of the surface

DrawSurface FlareAt(const Vec3f &position, const Vec3f &normal, const Vec3f &color, const ShaderInfo &shader) {
    DrawSurface flare;
    flare.kind = SurfaceKind::Flare;
    flare.shader = &shader;
    flare.lightmapOrigin = position;
    flare.lightmapVecs = {color, Vec3f{}, normal};
    flare.bounds.Add(position);
    return flare;
}

Vec3f DirectionOf(const MapEntity &light, const Map &map) {
    const std::string_view name = light.pairs.Value({"target", "_target"});
    if (!name.empty())
        for (const MapEntity &entity : map.entities)
            if (EqualNoCase(keys::kTargetName.Text(entity.pairs), name)) {
                const Vec3f direction = Normalize(entity.origin - light.origin);
                return direction == Vec3f{} ? Vec3f{0, 0, -1} : direction;
            }
    return {0, 0, -1};
}

} // namespace

void MakeFlares(const Map &map, Geometry &geometry, const BspContext &context) {
    if (!context.options.flares)
        return;
    for (const MapEntity &light : map.entities) {
        if (!StartsWithNoCase(light.pairs.ClassName(), "light"))
            continue;
        std::string_view name = keys::kFlareShader.Text(light.pairs);
        if (name.empty() && !keys::kFlare.Flag(light.pairs))
            continue;
        if (name.empty())
            name = keys::kFlareShader.info.initial;
        const Vec3f color = keys::kColor.Vector(light.pairs).value_or(Vec3f{1, 1, 1});
        geometry.surfaces.push_back(FlareAt(light.origin, DirectionOf(light, map), color, context.shaders.Get(name)));
    }
}

void MakeShaderFlare(std::size_t surface, const Vec3f &origin, Geometry &geometry, const BspContext &context) {
    const DrawSurface &source = geometry.surfaces[surface];
    if (!context.options.flares || source.shader == nullptr || source.Empty() || source.kind == SurfaceKind::Flare ||
        (source.furred && source.isCopy) || source.shader->geometry.flareShader.empty())
        return;
    Vec3d middle, normal;
    for (const DrawVert &vert : source.verts)
        middle += Vec3d(vert.xyz), normal += Vec3d(vert.normal);
    middle = middle / double(source.verts.size());
    const Vec3f direction = Vec3f(Normalize(normal));
    const Vec3f position = Vec3f(middle) + origin + direction * kFlareDistance;
    DrawSurface flare =
        FlareAt(position, direction, source.shader->color, context.shaders.Get(source.shader->geometry.flareShader));
    flare.fogNum = source.fogNum;
    flare.settings = source.settings;
    geometry.surfaces.push_back(std::move(flare));
}

} // namespace q3
