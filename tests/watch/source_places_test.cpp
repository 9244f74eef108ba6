// GPL-2.0-or-later. Where things of a map source are.
#include "q3map2/watch/source_places.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace {

/// A brush: a box.
std::string Box(int x0, int y0, int z0, int x1, int y1, int z1) {
    const auto side = [](int ax, int ay, int az, int bx, int by, int bz, int cx, int cy, int cz) {
        return fmt::format("( {} {} {} ) ( {} {} {} ) ( {} {} {} ) a 0 0 0 1 1\n", ax, ay, az, bx, by, bz, cx, cy, cz);
    };
    return "{\n" + side(x0, y0, z1, x0, y1, z1, x1, y0, z1) + side(x0, y0, z0, x1, y0, z0, x0, y1, z0) +
           side(x1, y0, z0, x1, y0, z1, x1, y1, z0) + side(x0, y0, z0, x0, y1, z0, x0, y0, z1) +
           side(x0, y1, z0, x1, y1, z0, x0, y1, z1) + side(x0, y0, z0, x0, y0, z1, x1, y0, z0) + "}\n";
}

std::string Source() {
    return "{\n\"classname\" \"worldspawn\"\n" + Box(0, 0, 0, 64, 64, 64) + Box(100, 0, 0, 120, 40, 8) +
           "}\n{\n\"classname\" \"func_group\"\n" + Box(-8, -8, -8, 8, 8, 8) +
           "}\n{\n\"classname\" \"light\"\n\"origin\" \"1 2 3\"\n}\n{\n\"classname\" \"func_door\"\n" +
           "{\npatchDef2\n{\na\n( 3 3 0 0 0 )\n(\n( ( 0 0 0 0 0 ) ( 0 5 0 0 0 ) ( 0 10 0 0 0 ) )\n"
           "( ( 5 0 0 0 0 ) ( 5 5 0 0 0 ) ( 5 10 0 0 0 ) )\n( ( 10 0 20 0 0 ) ( 10 5 20 0 0 ) ( 10 10 20 0 0 ) )\n"
           ")\n}\n}\n}\n";
}

TEST(SourcePlaces, AreCentersOfPrimitivesAndOrigins) {
    const SourcePlaces places(Source(), *FindGame("quake3"));
    EXPECT_EQ(places.Of(0, 0), (Vec3f{32, 32, 32}));
    EXPECT_EQ(places.Of(0, 1), (Vec3f{110, 20, 4}));
    EXPECT_EQ(places.Of(1, 0), (Vec3f{0, 0, 0})) << "of a group";
    EXPECT_EQ(places.Of(2, 0), (Vec3f{1, 2, 3})) << "an entity without brushes";
    EXPECT_EQ(places.Of(3, 0), (Vec3f{5, 5, 10})) << "a patch";
    EXPECT_EQ(places.Of(0, 2), std::nullopt);
    EXPECT_EQ(places.Of(9, 0), std::nullopt);
    EXPECT_EQ(places.Of(-1, -1), std::nullopt);
}

TEST(SourcePlaces, DamagedSourcesHaveFewer) {
    const std::string whole = Source();
    for (std::size_t size = 0; size < whole.size(); size += 7) {
        const SourcePlaces places(whole.substr(0, size), *FindGame("quake3"));
        EXPECT_EQ(places.Of(9, 9), std::nullopt);
        LightsOfSource(whole.substr(0, size));
    }
}

TEST(SourcePlaces, LightsAreEntitiesOfThatClass) {
    const std::vector<Entity> lights = LightsOfSource(Source());
    ASSERT_EQ(lights.size(), 1u);
    EXPECT_EQ(lights[0].Value("origin"), "1 2 3");
}

} // namespace

} // namespace q3::test
