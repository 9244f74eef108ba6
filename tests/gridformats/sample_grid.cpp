// GPL-2.0-or-later. SH grids with light of closed forms.
#include "tests/gridformats/sample_grid.h"

#include "libs/sh/sh.h"

#include <cmath>
#include <numbers>

namespace q3::test {

bspGridPointSH_t ConstantLight(const Vec3d &color) {
    bspGridPointSH_t point{};
    point.coeffs[0] = Vec3f(color * (2 * std::sqrt(std::numbers::pi))).Array();
    return point;
}

bspGridPointSH_t LightFrom(const Vec3d &direction, const Vec3d &color) {
    bspGridPointSH_t point{};
    const SHVector basis = SHBasis(Normalize(direction));
    for (std::size_t k = 0; k < 9; ++k)
        point.coeffs[k] = Vec3f(color * (kCosineLobe[k] * basis[k])).Array();
    return point;
}

bspGridPointSH_t operator+(bspGridPointSH_t a, const bspGridPointSH_t &b) {
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            a.coeffs[k][channel] += b.coeffs[k][channel];
    return a;
}

StoredGridSH SampleGrid(const Int3 &bounds, const Float3 &mins,
                        const std::function<bspGridPointSH_t(const Vec3f &)> &light) {
    const GridLayout layout{mins, {32, 32, 32}, bounds};
    StoredGridSH stored;
    stored.grid.header = {mins, layout.size, bounds, std::int32_t(layout.Count())};
    for (int z = 0; z < bounds[2]; ++z)
        for (int y = 0; y < bounds[1]; ++y)
            for (int x = 0; x < bounds[0]; ++x)
                stored.grid.points.push_back(light(Vec3f(layout.Position(x, y, z))));
    return stored;
}

Bsp WorldWithWall(const Float3 &mins, const Float3 &maxs, float wall) {
    Bsp bsp;
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n}\n";
    bsp.planes = {{{1, 0, 0}, wall}, {{-1, 0, 0}, -wall}};
    bsp.nodes = {{0, {-2, -3}, {}, {}}};
    bsp.leafs.resize(3);
    bsp.leafs[0].cluster = -1;
    bsp.leafs[1].cluster = 0;
    bsp.leafs[2].cluster = -1;
    bsp.models = {{mins, maxs, 0, 0, 0, 0}};
    for (std::size_t i = 0; i < 3; ++i) {
        const int low = int(mins[i]), high = int(maxs[i]);
        bsp.nodes[0].mins[i] = low, bsp.nodes[0].maxs[i] = high;
        for (bspLeaf_t &leaf : bsp.leafs)
            leaf.mins[i] = low, leaf.maxs[i] = high;
    }
    bsp.leafs[1].mins[0] = bsp.leafs[2].maxs[0] = int(wall);
    return bsp;
}

LegacyPoints OpenPoints(const GridSource &source, const GridLayout &layout) {
    LegacyPoints points;
    points.layout = layout;
    for (int z = 0; z < layout.bounds[2]; ++z)
        for (int y = 0; y < layout.bounds[1]; ++y)
            for (int x = 0; x < layout.bounds[0]; ++x) {
                EXPECT_TRUE(source.Sample(Vec3f(layout.Position(x, y, z)), points.light.emplace_back()));
                points.use.push_back(PointUse::Open);
            }
    return points;
}

std::vector<Vec3f> ProbeNormals() {
    std::vector<Vec3f> normals;
    for (int i = 0; i < 27; ++i)
        if (i != 13)
            normals.push_back(Normalize(Vec3f{float(i % 3 - 1), float(i / 3 % 3 - 1), float(i / 9 - 1)}));
    return normals;
}

} // namespace q3::test
