// GPL-2.0-or-later. The .srf file: properties of surfaces that the light stage needs and the .bsp cannot hold.
#include "q3map2/geometry/emit/emit_srf.h"

#include <fmt/format.h>

#include <cmath>

namespace q3 {

namespace {

std::string_view KindName(SurfaceKind kind) {
    switch (kind) {
    case SurfaceKind::Face:
        return "Face";
    case SurfaceKind::Patch:
        return "Patch";
    case SurfaceKind::Triangles:
        return "Triangles";
    case SurfaceKind::ForcedMeta:
        return "ForcedMeta";
    case SurfaceKind::Meta:
        return "Meta";
    case SurfaceKind::FogHull:
        return "Foghull";
    case SurfaceKind::Decal:
        return "Decal";
    case SurfaceKind::Flare:
        return "Flare";
    case SurfaceKind::Foliage:
        return "Foliage";
    case SurfaceKind::Shader:
        return "Shader";
    case SurfaceKind::Bad:
        break;
    }
    return "Bad";
}

std::string Triple(const Vec3f &v) {
    return fmt::format("( {:f} {:f} {:f} )", v.x, v.y, v.z);
}

} // namespace

std::string DefaultSurfaceBlock(const SurfaceSettings &world, int sampleSize) {
    return fmt::format("default\n{{\n\tcastShadows 1\n\treceiveShadows 1\n\tsampleSize {}\n\tambientColor {}\n"
                       "\tlongestCurve {:f}\n}}\n\n",
                       sampleSize, Triple(world.ambient), 0.0);
}

std::string SurfaceBlock(const DrawSurface &surface, int number, std::string_view shader, const SurfaceSettings &world,
                         int sampleSize) {
    constexpr float kSameAxis = 0.001f;
    const SurfaceSettings &settings = surface.settings;
    std::string text =
        fmt::format("{} // ESurfaceType::{} V: {} I: {} {}\n{{\n\tshader {}\n", number, KindName(surface.kind),
                    surface.verts.size(), surface.indexes.size(), surface.planar ? "planar" : "", shader);
    if (surface.parent >= 0)
        text += fmt::format("\tparent {}\n", surface.parent);
    if (settings.entity != 0)
        text += fmt::format("\tentity {}\n", settings.entity);
    if (settings.castShadows != 1)
        text += fmt::format("\tcastShadows {}\n", settings.castShadows);
    if (settings.receiveShadows != 1)
        text += fmt::format("\treceiveShadows {}\n", settings.receiveShadows);
    if (surface.sampleSize != sampleSize)
        text += fmt::format("\tsampleSize {}\n", surface.sampleSize);
    if (settings.ambient != Vec3f{} && settings.ambient != world.ambient)
        text += fmt::format("\tambientColor {}\n", Triple(settings.ambient));
    if (surface.longestCurve != 0)
        text += fmt::format("\tlongestCurve {:f}\n", surface.longestCurve);
    const Vec3f &axis = surface.lightmapAxis;
    if (std::abs(axis.x) >= kSameAxis || std::abs(axis.y) >= kSameAxis || std::abs(axis.z) >= kSameAxis)
        text += fmt::format("\tlightmapAxis {}\n", Triple(axis));
    return text + "}\n\n";
}

} // namespace q3
