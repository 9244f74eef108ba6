// GPL-2.0-or-later. The SH grid that names lights in maps that are scaled and moved: places keep their light.
#include "q3map2/edit/scale_shift.h"
#include "tests/support/named_grid.h"
#include "tests/support/small_bsp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace q3::test {

namespace {

Bsp NamedBsp() {
    Bsp bsp = SmallBsp();
    bsp.namedGridSH = SmallNamedGrid(3);
    return bsp;
}

/// A grid through its lump and the reader for engines.
struct NamedView {
    std::vector<std::byte> lump;
    shgrid_grid grid{};
    explicit NamedView(const Bsp &bsp) : lump(EncodeNamedGrid(*bsp.namedGridSH)) {
        EXPECT_EQ(shgrid_parse(lump.data(), lump.size(), &grid), SHGRID_OK);
    }
    shgrid_lighting At(const Vec3f &p) const {
        const float at[3] = {p.x, p.y, p.z};
        shgrid_lighting lighting;
        shgrid_lights(&grid, at, nullptr, &lighting);
        return lighting;
    }
};

/// Compares all light at places all over the box of the grid with that where the map moved them.
void ExpectSameLight(const Bsp &before, const Bsp &after, float factor, const Vec3f &shift) {
    const NamedView old(before), moved(after);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int round = 0; round < 300; ++round) {
        const Vec3f place{-64 + 32 * unit(random), 8 + 32 * unit(random), 64 * unit(random)};
        const shgrid_lighting a = old.At(place), b = moved.At(place * factor + shift);
        ASSERT_EQ(a.count, b.count);
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(a.rest.c[k][channel], b.rest.c[k][channel], 1e-3f);
        for (int i = 0; i < a.count; ++i) {
            EXPECT_EQ(a.direct[i].light, b.direct[i].light);
            EXPECT_NEAR(a.direct[i].spread, b.direct[i].spread, 1e-3f);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                EXPECT_NEAR(a.direct[i].color[channel], b.direct[i].color[channel],
                            1e-3f * std::max(1.0f, std::abs(a.direct[i].color[channel])));
                EXPECT_NEAR(a.direct[i].direction[channel], b.direct[i].direction[channel], 1e-3f);
            }
        }
    }
}

TEST(NamedMove, PlacesOfAScaledAndMovedMapKeepTheirLight) {
    KeptLog log;
    for (const float factor : {1.0f, 2.0f, 0.3f}) {
        const Vec3f shift{64, -8, 1000};
        Bsp bsp = NamedBsp();
        ScaleMap(bsp, {.factors = Vec3d{1, 1, 1} * double(factor)}, "map", log.log);
        ShiftMap(bsp, Vec3d(shift), "map", log.log);
        ASSERT_TRUE(bsp.namedGridSH);
        ExpectSameLight(NamedBsp(), bsp, factor, shift);
    }
}

TEST(NamedMove, AShiftChangesPositionsOnly) {
    KeptLog log;
    Bsp bsp = NamedBsp();
    ShiftMap(bsp, {64, -8, 16}, "map", log.log);
    const NamedGridSH old = *NamedBsp().namedGridSH, &moved = *bsp.namedGridSH;
    EXPECT_EQ(moved.mins, (Float3{0, 0, 16}));
    EXPECT_EQ(moved.cell, old.cell);
    EXPECT_EQ(moved.points, old.points);
    for (std::size_t i = 0; i < old.table.lights.size(); ++i) {
        GridLight light = moved.table.lights[i];
        light.origin = old.table.lights[i].origin;
        EXPECT_EQ(light, old.table.lights[i]);
    }
    EXPECT_EQ(moved.table.polygons[0].dist, 66);
    EXPECT_EQ(moved.table.polygons[0].area, old.table.polygons[0].area);
}

TEST(NamedMove, PolygonsOfAnotherShapeAreInTheirPlanes) {
    KeptLog log;
    Bsp bsp = NamedBsp();
    bsp.namedGridSH->table = {};
    AddPolygonLight(bsp.namedGridSH->table, "slope", {{0, 0, 0}, {0, 20, 0}, {10, 20, 10}, {10, 0, 10}});
    bsp.namedGridSH->names.assign(bsp.namedGridSH->names.size(), 0);
    ScaleMap(bsp, {.factors = {2, 1, 4}}, "map", log.log);
    const GridLights &table = bsp.namedGridSH->table;
    const GridPolygon &polygon = table.polygons[0];
    EXPECT_NEAR(Length(Vec3f(polygon.normal)), 1, 1e-6f);
    for (const Float3 &vertex : table.vertices) {
        EXPECT_NEAR(Dot(Vec3f(polygon.normal), Vec3f(vertex)), polygon.dist, 1e-4f);
        EXPECT_LE(Length(Vec3f(vertex) - Vec3f(polygon.center)), polygon.radius * 1.0001f);
    }
    EXPECT_NEAR(polygon.area, 20 * std::hypot(20.0f, 40.0f), 1e-3f);
}

} // namespace

} // namespace q3::test
