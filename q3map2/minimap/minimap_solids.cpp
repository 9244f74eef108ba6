// GPL-2.0-or-later. Thickness of the solids of a map along vertical lines.
#include "q3map2/minimap/minimap_solids.h"

#include "common/text/text.h"

#include <algorithm>
#include <limits>

namespace q3 {

namespace {

constexpr std::string_view kNoShaderName = "noshader";

/// Flags that any side has.
std::uint32_t FlagsOfSides(const Bsp &bsp, const bspBrush_t &brush, const std::vector<std::uint32_t> &flagsOfShader) {
    std::uint32_t flags = 0;
    for (std::int32_t i = 0; i < brush.numSides; ++i)
        flags |= flagsOfShader[std::size_t(bsp.brushSides[std::size_t(brush.firstSide + i)].shaderNum)];
    return flags;
}

/// Compile flags by number; none for sides without a shader.
std::vector<std::uint32_t> FlagsOfShaders(const Bsp &bsp, ShaderLibrary &library) {
    for (const bspShader_t &shader : bsp.shaders)
        library.SetDefaultFlags(FieldName(shader.shader), shader.surfaceFlags, shader.contentFlags);
    std::vector<std::uint32_t> flags;
    for (const bspShader_t &shader : bsp.shaders) {
        const std::string_view name = FieldName(shader.shader);
        flags.push_back(EqualNoCase(name, kNoShaderName) ? 0 : library.Get(name).compileFlags);
    }
    return flags;
}

MinimapSolid SolidOf(const Bsp &bsp, const bspBrush_t &brush) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    MinimapSolid solid{{}, {{-kInfinite, -kInfinite, -kInfinite}, {kInfinite, kInfinite, kInfinite}}};
    for (std::int32_t i = 0; i < brush.numSides; ++i) {
        const bspPlane_t &side = bsp.planes[std::size_t(bsp.brushSides[std::size_t(brush.firstSide + i)].planeNum)];
        const Plane plane{Vec3d(side.normal), double(side.dist)};
        for (std::size_t axis = 0; axis < 2; ++axis) {
            if (plane.normal[axis] == 1)
                solid.bounds.maxs[axis] = std::min(solid.bounds.maxs[axis], plane.dist);
            if (plane.normal[axis] == -1)
                solid.bounds.mins[axis] = std::max(solid.bounds.mins[axis], -plane.dist);
        }
        solid.planes.push_back(plane);
    }
    return solid;
}

} // namespace

double MinimapSolid::Thickness(double x, double y) const {
    double bottom = -std::numeric_limits<double>::infinity(), top = std::numeric_limits<double>::infinity();
    for (const Plane &plane : planes) {
        const double rest = plane.dist - plane.normal.x * x - plane.normal.y * y;
        if (plane.normal.z > 0)
            top = std::min(top, rest / plane.normal.z);
        else if (plane.normal.z < 0)
            bottom = std::max(bottom, rest / plane.normal.z);
        else if (rest < 0)
            return 0;
    }
    const double length = top - bottom;
    return length > 0 && std::isfinite(length) ? length : 0;
}

std::vector<MinimapSolid> MinimapSolids(const Bsp &bsp, ShaderLibrary &library) {
    const std::vector<std::uint32_t> flagsOfShader = FlagsOfShaders(bsp, library);
    std::vector<MinimapSolid> solids;
    const bspModel_t &world = bsp.models.front();
    for (std::int32_t i = 0; i < world.numBSPBrushes; ++i) {
        const bspBrush_t &brush = bsp.brushes[std::size_t(world.firstBSPBrush + i)];
        const std::uint32_t flags = FlagsOfSides(bsp, brush, flagsOfShader);
        if ((flags & C_SOLID) != 0 && (flags & C_SKY) == 0)
            solids.push_back(SolidOf(bsp, brush));
    }
    return solids;
}

} // namespace q3
