// GPL-2.0-or-later. Brushes of a map as text (.caulk, fakemap), and limits of engines.
#include "q3map2/geometry/map_text.h"

#include <algorithm>
#include <array>

namespace q3 {

namespace {

/// Letter of the shader that an editor should apply to a hidden side; '-': leave the side as it is.
char CaulkLetter(const Brush &brush, const BrushSide &side) {
    const bool isSeen = side.visibleHull.size() >= 3 && !side.culled;
    if (isSeen || !side.shader || (side.compileFlags & C_NODRAW) != 0)
        return '-';
    constexpr std::array<std::pair<std::uint32_t, char>, 3> kLiquids = {{{0x20, 'w'}, {0x10, 's'}, {0x8, 'l'}}};
    if ((brush.compileFlags & C_LIQUID) != 0)
        for (const auto &[flag, letter] : kLiquids)
            if ((brush.contentFlags & flag) != 0)
                return letter;
    if ((brush.compileFlags & C_SOLID) == 0)
        return 'n';
    return (brush.compileFlags & C_TRANSLUCENT) != 0 ? 'N' : 'c';
}

std::string PointText(const Vec3f &p) {
    return fmt::format("( {:g} {:g} {:g} ) ", p.x, p.y, p.z);
}

} // namespace

std::string CaulkText(const MapEntity &world) {
    std::string text;
    for (const Brush &brush : world.brushes) {
        if (brush.settings.entity != 0 || brush.generated)
            continue;
        text += fmt::format("{} ", brush.primitive);
        for (const BrushSide &side : brush.sides)
            if (!side.bevel && side.winding.size() >= 3)
                text += CaulkLetter(brush, side);
        text += '\n';
    }
    return text;
}

std::string FakeMapText(const MapEntity &world, const PlaneTable &planes) {
    constexpr std::string_view kFolder = "textures/";
    std::string text = "{\n\"classname\" \"worldspawn\"\n";
    for (const Brush &brush : world.brushes) {
        text += "{\n";
        for (const BrushSide &side : brush.sides) {
            if (side.bevel || side.planeNum < 0)
                continue;
            const Polygon w = side.winding.size() >= 3 ? side.winding : BasePolygon(planes[side.planeNum]);
            std::string_view name = side.shader ? std::string_view(side.shader->name) : "noshader";
            if (name.starts_with(kFolder))
                name.remove_prefix(kFolder.size());
            text += PointText(w[0]) + PointText(w[1]) + PointText(w[2]) + fmt::format("{} 0 0 0 1 1 0 0 0\n", name);
        }
        text += "}\n";
    }
    return text + "}\n";
}

void WarnOfLimits(const Bsp &bsp, Log &log) {
    int lastArea = 0;
    for (const bspLeaf_t &leaf : bsp.leafs)
        lastArea = std::max(lastArea, leaf.area);
    std::size_t entities = 0; // each begins with "{" on a line of its own
    for (std::size_t at = 0; (at = bsp.entities.find("{\n", at)) != std::string::npos; at++)
        entities += at == 0 || bsp.entities[at - 1] == '\n';
    struct Limit {
        std::string_view what;
        std::size_t count, limit;
        std::string_view wayOut;
    };
    const Limit limits[] = {
        {"models", bsp.models.size(), 256, "make fewer brush entities"},
        {"shaders", bsp.shaders.size(), 1024, "use fewer shaders"},
        {"entities", entities, 2048, "use fewer entities: groups and compiled-in models do not count"},
        {"bytes of entity text", bsp.entities.size(), 262144, "use fewer entities and keys"},
        {"brushes", bsp.brushes.size(), 32768, "use fewer brushes"},
        {"brush sides", bsp.brushSides.size(), 131072, "use fewer or simpler brushes"},
        {"planes", bsp.planes.size(), 131072, "use fewer brushes, and axial ones"},
        {"nodes", bsp.nodes.size(), 131072, "make more brushes detail"},
        {"leafs", bsp.leafs.size(), 131072, "make more brushes detail"},
        {"leaf surfaces", bsp.leafSurfaces.size(), 131072, "make more brushes detail, or use -meta"},
        {"leaf brushes", bsp.leafBrushes.size(), 262144, "make more brushes detail"},
        {"surfaces", bsp.drawSurfaces.size(), 131072, "use -meta"},
        {"draw vertices", bsp.drawVerts.size(), 524288, "use -meta, and simpler models"},
        {"draw indexes", bsp.drawIndexes.size(), 524288, "use simpler models"},
        {"areas", std::size_t(lastArea) + 1, 256, "use fewer area portals"},
        {"fogs", bsp.fogs.size(), 31, "use fewer fog brushes"},
    };
    for (const Limit &one : limits)
        if (one.count > one.limit)
            log.Warn(one.what, "{} {}, engines hold {}: {}", one.count, one.what, one.limit, one.wayOut);
}

} // namespace q3
