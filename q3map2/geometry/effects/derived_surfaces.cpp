// GPL-2.0-or-later. Copies by cel, clone and back shaders.
#include "q3map2/geometry/effects/derived_surfaces.h"

#include <utility>
#include <vector>

namespace q3 {
namespace {

constexpr int kMaxCopyChain = 16;

DrawSurface CopyOf(const DrawSurface &surface, const ShaderInfo &shader) {
    DrawSurface copy = surface;
    copy.shader = &shader;
    copy.isCopy = true;
    if (surface.brush < 0)
        copy.side = -1;
    return copy;
}

const ShaderInfo *CelShaderFor(const DrawSurface &surface) {
    const ShaderInfo *cel = surface.settings.celShader;
    if (cel == nullptr || surface.isCopy || cel == surface.shader ||
        (surface.shader->compileFlags & (C_TRANSLUCENT | C_SKY)))
        return nullptr;
    return cel;
}

/// Appends the copies of surface `number`. chain[i]: number of copying steps from an original to surface i.
void AppendCopies(std::size_t number, std::vector<int> &chain, Geometry &geometry, const BspContext &context) {
    const DrawSurface surface = geometry.surfaces[number]; // a copy: appending invalidates references
    const auto add = [&](DrawSurface copy, int links) {
        geometry.surfaces.push_back(std::move(copy));
        chain.push_back(links);
    };
    if (const ShaderInfo *cel = CelShaderFor(surface)) {
        DrawSurface copy = CopyOf(surface, *cel);
        copy.planar = false;
        copy.planeNum = -1;
        add(std::move(copy), kMaxCopyChain);
    }
    const int links = chain[number];
    if (links >= kMaxCopyChain)
        return;
    const GeometryDirectives &geo = surface.shader->geometry;
    if (!geo.cloneShader.empty())
        add(CopyOf(surface, context.shaders.Get(geo.cloneShader)), links + 1);
    if (!geo.backShader.empty()) {
        DrawSurface copy = CopyOf(surface, context.shaders.Get(geo.backShader));
        copy.backSide = !surface.backSide;
        add(std::move(copy), kMaxCopyChain);
    }
}

} // namespace

void MakeDerivedSurfaces(Geometry &geometry, std::size_t first, const BspContext &context) {
    std::vector<int> chain(geometry.surfaces.size(), 0);
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i)
        if (geometry.surfaces[i].shader != nullptr && !geometry.surfaces[i].Empty())
            AppendCopies(i, chain, geometry, context);
}

} // namespace q3
