// GPL-2.0-or-later. Sky boxes: a small room whose enlarged copy surrounds the map.
#include "q3map2/geometry/effects/skybox.h"

#include "q3map2/bspfile/object_keys.h"
#include "q3map2/model/model_transform.h"

namespace q3 {
namespace {

constexpr double kDefaultScale = 64;

Vec3d ScaleOf(const Entity &pairs) {
    if (const auto scale = keys::kSkyBoxScale.Vector(pairs))
        return Vec3d(*scale);
    const double scale = NumberFromText(keys::kSkyBoxScale.Text(pairs));
    return scale == 0 ? Vec3d{kDefaultScale, kDefaultScale, kDefaultScale} : Vec3d{scale, scale, scale};
}

} // namespace

std::optional<SkyBoxTransform> ReadSkyBox(const Map &map) {
    std::optional<SkyBoxTransform> result;
    for (const MapEntity &entity : map.entities) {
        if (!EqualNoCase(entity.pairs.ClassName(), "_skybox"))
            continue;
        const Vec3d angles = AnglesOf(entity.pairs);
        const ModelTransform turned = MakeModelTransform({1, 1, 1}, angles, {});
        const ModelTransform scaled = MakeModelTransform(ScaleOf(entity.pairs), angles, {});
        const Vec3d shift = scaled.Point(Vec3d(entity.origin));
        result.emplace();
        for (std::size_t i = 0; i < 3; ++i) {
            result->rows[i] = {scaled.rows[i].x, scaled.rows[i].y, scaled.rows[i].z, -shift[i]};
            result->rotation[i] = turned.rows[i];
        }
    }
    return result;
}

DrawSurface SkyBoxCopy(const DrawSurface &surface, int number, const SkyBoxTransform &transform) {
    DrawSurface copy = surface;
    copy.skyBoxCopy = true;
    copy.parent = number;
    copy.bounds = {};
    for (DrawVert &vert : copy.verts) {
        const Vec3d p(vert.xyz), n(vert.normal);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto &row = transform.rows[i];
            vert.xyz[i] = float(row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3]);
            vert.normal[i] = float(Dot(transform.rotation[i], n));
        }
        copy.bounds.Add(vert.xyz);
    }
    if (copy.kind == SurfaceKind::Patch && !copy.bounds.Empty()) // bounds by which engines choose its level of detail
        copy.lightmapVecs = {copy.bounds.mins, copy.bounds.maxs, Vec3f{}};
    copy.lightmapVecs[2] = {};
    return copy;
}

} // namespace q3
