// GPL-2.0-or-later. Faces that split the tree.
#include "q3map2/tree/tree_faces.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr std::size_t kFewestSides = 4; ///< fewest sides that enclose a volume

int PriorityOf(std::uint32_t flags) {
    int priority = 0;
    if (flags & C_HINT)
        priority += 1000;
    if (flags & C_ANTIPORTAL)
        priority -= 1000;
    if (flags & C_AREAPORTAL)
        priority -= 1000;
    if (flags & C_DETAIL)
        priority -= 3000;
    return priority;
}

/// The face takes the detail flag of the brush, not of the side.
TreeFace FaceOf(const Brush &brush, const BrushSide &side, const Polygon &polygon) {
    TreeFace face;
    face.polygon = polygon;
    face.planeNum = side.planeNum & ~1;
    face.compileFlags = side.compileFlags & ~std::uint32_t(C_DETAIL);
    if (brush.detail)
        face.compileFlags |= C_DETAIL;
    face.priority = PriorityOf(face.compileFlags);
    return face;
}

void WarnOfStructure(const MapEntity &world, const BspContext &context) {
    constexpr std::size_t kManyBrushes = 500;
    const auto structural = std::size_t(
        std::count_if(world.brushes.begin(), world.brushes.end(), [](const Brush &brush) { return !brush.detail; }));
    if (world.brushes.size() > kManyBrushes && structural * 10 > world.brushes.size() * 9)
        context.log.Warn(
            "structural brushes",
            "{} of {} brushes of the world are structural: detail brushes keep the tree small and vis fast", structural,
            world.brushes.size());
}

} // namespace

std::vector<TreeFace> StructuralFaces(MapEntity &world, const BspContext &context) {
    std::vector<TreeFace> faces;
    WarnOfStructure(world, context);
    for (Brush &brush : world.brushes) {
        if (brush.detail && !context.options.deep)
            continue;
        const auto windings = std::count_if(brush.sides.begin(), brush.sides.end(),
                                            [](const auto &side) { return !side.winding.empty(); });
        if (!brush.detail && std::size_t(windings) < kFewestSides) {
            context.WarnAt("structural brush with few sides", brush.settings.entity, brush.primitive,
                           fmt::format("structural brush with {} usable sides becomes detail", windings));
            brush.detail = true;
            continue;
        }
        for (const BrushSide &side : brush.sides)
            if (!side.winding.empty() && !(side.compileFlags & C_SKIP))
                faces.push_back(FaceOf(brush, side, side.winding));
    }
    std::reverse(faces.begin(), faces.end());
    return faces;
}

std::vector<TreeFace> VisibleFaces(const MapEntity &world, const BspContext &context) {
    std::vector<TreeFace> faces;
    for (const Brush &brush : world.brushes) {
        if (brush.detail && !context.options.deep)
            continue;
        for (const BrushSide &side : brush.sides)
            if (!side.visibleHull.empty() && !(side.compileFlags & C_SKIP))
                faces.push_back(FaceOf(brush, side, side.visibleHull));
    }
    std::reverse(faces.begin(), faces.end());
    return faces;
}

} // namespace q3
