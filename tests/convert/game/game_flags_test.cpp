// GPL-2.0-or-later. Maps of one game for another.
#include "q3map2/convert/game/game_flags.h"
#include "tests/support/game_folder.h"

namespace q3::test {

namespace {

class GameConvertTest : public testing::Test {
  protected:
    /// The flags that a shader with those of `from` has in `to`.
    bspShader_t Converted(const char *from, const char *to, std::uint32_t surface, std::uint32_t content) {
        Bsp bsp;
        bsp.shaders.push_back({.shader = {}, .surfaceFlags = surface, .contentFlags = content});
        ConvertToGame(bsp, *FindGame(from), *FindGame(to), out.log);
        return bsp.shaders[0];
    }
    KeptLog out;
};

TEST_F(GameConvertTest, SurfaceparmsKeepTheirMeaning) {
    // Quake Live: snowsteps 0x80000; Wolfenstein: 0x400000. Slick is 0x2 in both, solid 0x1.
    const bspShader_t snow = Converted("quakelive", "wolf", 0x80002, 0x1);
    EXPECT_EQ(snow.surfaceFlags, 0x400002u);
    EXPECT_EQ(snow.contentFlags, 0x1u);
    EXPECT_EQ(Converted("wolf", "quakelive", 0x400002, 0x1).surfaceFlags, 0x80002u) << "and back";
    // Wolfenstein has two names for 0x1000, metal and metalsteps; Quake III knows the second.
    EXPECT_EQ(Converted("wolf", "quake3", 0x1000, 0).surfaceFlags, 0x1000u);
    EXPECT_EQ(out.log.WarningCount("surfaceparm of another game"), 0);
}

TEST_F(GameConvertTest, WhatTheOtherGameLacksIsDroppedWithAWarning) {
    EXPECT_EQ(Converted("quakelive", "quake3", 0x100002, 0).surfaceFlags, 0x2u + 0x100000u)
        << "woodsteps: Quake III gives the bit no meaning, so it may stay";
    // The same bit means nobody may build here, in Tremulous.
    EXPECT_EQ(Converted("quakelive", "tremulous", 0x100002, 0).surfaceFlags, 0x2u);
    EXPECT_EQ(out.log.WarningCount("surfaceparm of another game"), 1);
    EXPECT_NE(out.text.find("tremulous has no surfaceparm woodsteps"), std::string::npos) << out.text;
}

TEST_F(GameConvertTest, BitsOfTheGamesCodeStay) {
    EXPECT_EQ(Converted("quake3", "wolf", 0, 0x40001).contentFlags, 0x40001u) << "teleporters";
}

TEST_F(GameConvertTest, GamesOfRavenHaveOtherBits) {
    const auto contents = [this](const char *from, const char *to, std::uint32_t flags) {
        return Converted(from, to, 0, flags).contentFlags;
    };
    EXPECT_EQ(contents("quake3", "ja", 0x1), 0x8001u) << "solid, and no sight through it";
    EXPECT_EQ(contents("quake3", "ja", 0x20), 0x8004u) << "water";
    EXPECT_EQ(contents("quake3", "ja", 0x40), 0x8u) << "fog is not in the way of sight";
    EXPECT_EQ(contents("quake3", "ja", 0x10008000), 0x80000000u) << "areaportal; structural has no bits there";
    EXPECT_EQ(contents("ja", "quake3", 0x80000000), 0x8000u) << "areaportal";
    EXPECT_EQ(contents("ja", "quake3", 0x80008001), 0x20000001u) << "trans has the same bit";
    EXPECT_EQ(contents("ja", "quake3", 0x8004), 0x20u) << "water";
    EXPECT_EQ(contents("ja", "jk2", 0x8004), 0x8004u);
    EXPECT_EQ(contents("ja", "jk2", 0x1), 0x1u) << "nonopaque";
    // nodamage, slick, sky, nonsolid; metalsteps.
    EXPECT_EQ(Converted("quake3", "ja", 0x4007, 0).surfaceFlags, 0x40000u + 0x4000u + 0x2000u);
    EXPECT_EQ(Converted("sof2", "quake3", 0x8000, 0x8001).surfaceFlags, 0x1000u);
    EXPECT_EQ(Converted("sof2", "ja", 0x8017, 0x8001).surfaceFlags, 0x8017u) << "metalsteps on rock";
    EXPECT_EQ(out.log.WarningCount("surfaceparm of another game"), 0) << out.text;
}

TEST_F(GameConvertTest, LostMaterialsAreNamed) {
    EXPECT_EQ(Converted("ja", "quake3", 0x4017, 0x8001).surfaceFlags, 0x2u);
    EXPECT_NE(out.text.find("quake3 has no material rock"), std::string::npos) << out.text;
}

TEST_F(GameConvertTest, FoliageIsEmptiedForEnginesThatRefuseIt) {
    Bsp bsp;
    bsp.drawSurfaces.resize(1);
    bsp.drawSurfaces[0].surfaceType = MST_FOLIAGE;
    bsp.drawSurfaces[0].numVerts = 5;
    ConvertToGame(bsp, *FindGame("et"), *FindGame("wolf"), out.log);
    EXPECT_EQ(bsp.drawSurfaces[0].surfaceType, MST_FOLIAGE);
    ConvertToGame(bsp, *FindGame("et"), *FindGame("ja"), out.log);
    EXPECT_EQ(bsp.drawSurfaces[0].surfaceType, MST_TRIANGLE_SOUP);
    EXPECT_EQ(bsp.drawSurfaces[0].numVerts, 0);
    EXPECT_NE(out.text.find("1 surfaces of foliage are left out"), std::string::npos) << out.text;
}

TEST_F(GameConvertTest, LightmapsOfAnotherSizeNeedNewLight) {
    Bsp bsp;
    bsp.lightmaps.resize(kLightmapPageBytes);
    ConvertToGame(bsp, *FindGame("quake3"), *FindGame("tenebrae"), out.log);
    EXPECT_NE(out.text.find("light the map again"), std::string::npos);
}

} // namespace

} // namespace q3::test
