// GPL-2.0-or-later. Rebuilds the brushes of a .bsp as convex polyhedra.
#include "q3map2/convert/source/bsp_brushes.h"

#include "common/text/text.h"
#include "libs/math/winding_clip.h"
#include "q3map2/bspfile/bsp_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace q3 {

namespace {

constexpr double kClipEpsilon = 1e-6; ///< game units
constexpr std::size_t kFewestSides = 4;

bool IsInWorld(const Winding<double> &winding) {
    return std::ranges::all_of(winding, [](const Vec3d &p) {
        return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= kMaxWorldCoord;
    });
}

/// Numbers of the named sides, in an order that compiles to the stored one. For each axial direction, 0 to 5, a
/// compiler appends a bevel if no side has it, then swaps the side that has it with the one at that place. This undoes
/// it for bevels.
std::vector<std::size_t> SourceOrderOfSides(const Bsp &bsp, const bspBrush_t &brush) {
    constexpr std::size_t kAxialSides = 6;
    std::vector<std::size_t> order(std::size_t(brush.numSides));
    std::iota(order.begin(), order.end(), std::size_t(brush.firstSide));
    const auto isBevel = [&](std::size_t side) { return IsUnnamed(SideShader(bsp, side)); };
    while (order.size() > kAxialSides && isBevel(order.back()))
        order.pop_back();
    for (std::size_t place = std::min(kAxialSides, order.size()); place-- > 0;)
        if (isBevel(order[place])) {
            std::swap(order[place], order.back());
            order.pop_back();
        }
    std::erase_if(order, isBevel);
    return order;
}

bool AreOpposite(const Plane &a, const Plane &b) {
    return a.normal == -b.normal && a.dist == -b.dist;
}

} // namespace

bool IsUnnamed(std::string_view shader) {
    return shader.empty() || EqualNoCase(shader, "noshader") || EqualNoCase(shader, "default");
}

std::string_view SideShader(const Bsp &bsp, std::size_t i) {
    return FieldName(bsp.shaders[std::size_t(bsp.brushSides[i].shaderNum)].shader);
}

bool IsModelClip(const Bsp &bsp, const bspBrush_t &brush) {
    int named = 0;
    for (std::int32_t i = 0; i < brush.numSides; ++i)
        named += !IsUnnamed(SideShader(bsp, std::size_t(brush.firstSide + i)));
    return named <= 1;
}

std::vector<RebuiltSide> RebuildBrush(const Bsp &bsp, const bspBrush_t &brush) {
    std::vector<std::size_t> numbers = SourceOrderOfSides(bsp, brush);
    if (IsModelClip(bsp, brush)) {
        numbers.resize(std::size_t(brush.numSides));
        std::iota(numbers.begin(), numbers.end(), std::size_t(brush.firstSide));
    }
    std::vector<RebuiltSide> sides;
    for (const std::size_t i : numbers) {
        const bspPlane_t &plane = bsp.planes[std::size_t(bsp.brushSides[i].planeNum)];
        sides.push_back({SideShader(bsp, i), {Vec3d(plane.normal), double(plane.dist)}, {}});
    }
    for (RebuiltSide &side : sides) {
        side.winding = BaseWinding(side.plane);
        for (const RebuiltSide &other : sides)
            if (&other != &side && !side.winding.empty() && !AreOpposite(other.plane, side.plane))
                ChopPolygon(side.winding, {-other.plane.normal, -other.plane.dist}, kClipEpsilon);
        if (!IsInWorld(side.winding))
            return {};
    }
    std::erase_if(sides, [](const RebuiltSide &side) { return side.winding.size() < 3; });
    if (sides.size() < kFewestSides)
        sides.clear();
    return sides;
}

std::vector<bool> BrushesInTheOpen(const Bsp &bsp) {
    std::vector<bool> open(bsp.brushes.size());
    for (const bspLeaf_t &leaf : bsp.leafs)
        for (std::int32_t i = 0; i < leaf.numBSPLeafBrushes && leaf.cluster != kSolidCluster; ++i)
            open[std::size_t(bsp.leafBrushes[std::size_t(leaf.firstBSPLeafBrush + i)])] = true;
    return open;
}

} // namespace q3
