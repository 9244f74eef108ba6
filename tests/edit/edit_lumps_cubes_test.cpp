// GPL-2.0-or-later. Ambient cubes of maps that are merged, scaled and moved.
#include "q3map2/edit/merge_maps.h"
#include "q3map2/edit/scale_shift.h"
#include "tests/support/small_bsp.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

/// SmallBsp with a sample in its open leaf 1, in the middle of (64 0 0) to (100 20 30).
Bsp CubesBsp(std::uint8_t red) {
    Bsp bsp = SmallBsp();
    AmbientCubes &cubes = bsp.ambientCubes.emplace();
    cubes.leafs = {{0, 1}, {1, 0}, {0, 1}};
    cubes.samples.resize(1);
    cubes.samples[0].position = {128, 128, 128};
    cubes.samples[0].sides[0] = {red, 0, 0, 0};
    return bsp;
}

TEST(CubesMerge, ThoseOfTheFirstMapStay) {
    KeptLog log;
    const Bsp main = CubesBsp(200), added = CubesBsp(201);
    const Bsp merged = MergeMaps({main, "main"}, {added, "added"}, {.world = true}, log.log);
    ASSERT_TRUE(merged.ambientCubes);
    EXPECT_EQ(merged.ambientCubes->samples[0].sides[0].r, 200);
    EXPECT_FALSE(Bytes(merged).empty());
    EXPECT_THAT(log.text, testing::HasSubstr("added: the BSPX lump AMBIENT_CUBES is dropped"));
}

TEST(CubesMove, SamplesStayWithTheirLeafs) {
    KeptLog log;
    for (const bool scales : {false, true}) {
        Bsp bsp = CubesBsp(200);
        scales ? ScaleMap(bsp, {.factors = {2, 2, 2}}, "map", log.log) : ShiftMap(bsp, {64, -8, 0}, "map", log.log);
        ASSERT_TRUE(bsp.ambientCubes);
        const Vec3f at = CubePosition(bsp.leafs[1], bsp.ambientCubes->samples[0]);
        const Vec3f middle = scales ? Vec3f{164, 20, 30} : Vec3f{146, 2, 15};
        EXPECT_LT(Length(at - middle), 0.5f);
        EXPECT_FALSE(Bytes(bsp).empty());
    }
}

} // namespace

} // namespace q3::test
