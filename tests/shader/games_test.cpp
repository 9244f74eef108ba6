// GPL-2.0-or-later. The games table.
#include "q3map2/shader/games.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

std::vector<std::uint32_t> Words(const SurfaceParm *parm) {
    if (!parm)
        return {};
    return {parm->contentSet,   parm->contentClear, parm->surfaceSet,
            parm->surfaceClear, parm->compileSet,   parm->compileClear};
}

using testing::ElementsAre;

TEST(Games, Quake3IsFirstAndNamesHaveNoCase) {
    ASSERT_FALSE(Games().empty());
    EXPECT_EQ(Games()[0].name, "quake3");
    EXPECT_EQ(FindGame("Quake3"), &Games()[0]);
    EXPECT_EQ(FindGame("quake"), nullptr);
    EXPECT_EQ(FindGame(""), nullptr);
    std::set<std::string_view> names;
    for (const Game &game : Games())
        EXPECT_TRUE(names.insert(game.name).second) << game.name;
    EXPECT_EQ(names.size(), 19u);
}

TEST(Games, EveryGameHasTheParmsThatCompilingNeeds) {
    for (const Game &game : Games())
        for (const auto *name : {"default",     "detail",     "structural", "trans",     "hint",       "skip",
                                 "areaportal",  "antiportal", "origin",     "lightgrid", "nodraw",     "alphashadow",
                                 "lightfilter", "nolightmap", "pointlight", "nonsolid",  "water",      "slime",
                                 "lava",        "fog",        "sky",        "nomarks",   "playerclip", "monsterclip"})
            EXPECT_NE(game.FindParm(name), nullptr) << game.name << " " << name;
}

TEST(Games, Quake3Parms) {
    const Game &game = *FindGame("quake3");
    const std::uint32_t all = 0xFFFFFFFF;
    EXPECT_EQ(game.surfaceParms.size(), 40u);
    EXPECT_THAT(Words(game.FindParm("default")), ElementsAre(1, all, 0, all, C_SOLID, all));
    EXPECT_THAT(Words(game.FindParm("NoDraw")), ElementsAre(0, 0, 0x80, 0, C_NODRAW, 0));
    EXPECT_THAT(Words(game.FindParm("nonsolid")), ElementsAre(0, 1, 0x4000, 0, 0, C_SOLID));
    EXPECT_THAT(Words(game.FindParm("lava")), ElementsAre(8, 1, 0, 0, C_TRANSLUCENT | C_LIQUID, C_SOLID));
    EXPECT_THAT(Words(game.FindParm("sky")), ElementsAre(0, 0, 4, 0, C_SKY, 0));
    EXPECT_THAT(Words(game.FindParm("alphashadow")), ElementsAre(0, 0, 0x10000, 0, C_TRANSLUCENT | C_ALPHASHADOW, 0));
    EXPECT_THAT(Words(game.FindParm("nodrop")), ElementsAre(0x80000000, 1, 0, 0, C_TRANSLUCENT, C_SOLID));
    EXPECT_EQ(game.FindParm("landmine"), nullptr);
    EXPECT_EQ(game.NoDrawSurfaceFlags(), 0x80u);
}

TEST(Games, AdditionsOfOtherGames) {
    EXPECT_THAT(Words(FindGame("quakelive")->FindParm("dmgthrough")), ElementsAre(0, 0, 0x200000, 0, 0, 0));
    EXPECT_THAT(Words(FindGame("unvanquished")->FindParm("nobuild")), ElementsAre(0x4000, 0, 0, 0, 0, 0));
    EXPECT_THAT(Words(FindGame("wolf")->FindParm("ai_nosight")), ElementsAre(0x1000, 1, 0, 0, C_TRANSLUCENT, C_SOLID));
    EXPECT_EQ(FindGame("wolf")->FindParm("landmine"), nullptr);
    EXPECT_THAT(Words(FindGame("et")->FindParm("landmine")), ElementsAre(0, 0, 0x80000000, 0, 0, 0));
    EXPECT_NE(FindGame("et")->FindParm("monsterslick"), nullptr);
    EXPECT_THAT(Words(FindGame("ef")->FindParm("ladder")),
                ElementsAre(0x80, 1, 8, 0, C_TRANSLUCENT | C_DETAIL, C_SOLID));
    EXPECT_THAT(Words(FindGame("reaction")->FindParm("rq3_sand")), ElementsAre(0, 0, 0x401000, 0, 0, 0));
    EXPECT_THAT(Words(FindGame("etut")->FindParm("*mat_stucco")), ElementsAre(0, 0, 0x1F00000, 0xFFF00000, 0, 0));
    EXPECT_THAT(Words(FindGame("etut")->FindParm("*mat_none")), ElementsAre(0, 0, 0, 0xFFF00000, 0, 0));
}

TEST(Games, PathsAndContainer) {
    EXPECT_EQ(FindGame("quake3")->homeDir, ".q3a");
    EXPECT_EQ(FindGame("quake3")->bspVersion, 46);
    EXPECT_EQ(FindGame("unvanquished")->archiveExtension, "dpk");
    EXPECT_TRUE(FindGame("unvanquished")->imageFiles.starts_with("*.webp *.png *.tga"));
    EXPECT_TRUE(FindGame("xonotic")->imageFiles.starts_with("*.tga *.png *.jpg dds/*.dds"));
    EXPECT_EQ(FindGame("quake3")->imageFiles, "*.tga *.png *.jpg *.dds *.ktx *.crn *.webp");
    EXPECT_EQ(FindGame("reaction")->gameDir, "Boomstick");
    std::set<std::string_view> newer;
    for (const Game &game : Games())
        if (game.bspVersion == 47)
            newer.insert(game.name);
    EXPECT_THAT(newer, ElementsAre("et", "etut", "quakelive", "wolf"));
    for (const auto *name : {"sof2", "jk2", "ja", "qfusion"}) {
        const Game &game = *FindGame(name);
        EXPECT_EQ(game.bspIdent, game.name == "qfusion" ? "FBSP" : "RBSP");
        EXPECT_EQ(game.bspVersion, 1);
        EXPECT_TRUE(game.styleSlots);
        EXPECT_EQ(game.shaderDir, game.name == "qfusion" ? "scripts" : "shaders");
        EXPECT_EQ(game.maxFogs, game.name == "qfusion" ? 31 : 30);
    }
    EXPECT_TRUE(FindGame("quakelive")->hasAdvertisements);
}

TEST(Games, ParmsOfRavensGames) {
    const std::uint32_t all = 0xFFFFFFFF;
    const Game &game = *FindGame("ja");
    EXPECT_THAT(Words(game.FindParm("default")), ElementsAre(0x8001, all, 0, all, C_SOLID, all));
    EXPECT_THAT(Words(game.FindParm("fog")), ElementsAre(8, 0x8001, 0, 0, C_TRANSLUCENT | C_DETAIL | C_FOG, C_SOLID));
    EXPECT_THAT(Words(game.FindParm("*mat_rock")), ElementsAre(0, 0, 23, 0x1F, 0, 0));
    EXPECT_THAT(Words(game.FindParm("forcesight")), ElementsAre(0, 0, 0x2000000, 0, 0, 0));
    EXPECT_EQ(FindGame("jk2")->FindParm("forcesight"), nullptr);
    EXPECT_EQ(game.NoDrawSurfaceFlags(), 0x200000u);
    std::uint32_t bevels = 0;
    for (const auto *name : {"slick", "metalsteps", "nodamage", "nosteps", "nomiscents"})
        bevels |= game.FindParm(name)->surfaceSet;
    EXPECT_EQ(game.bevelSurfaceFlags, bevels);
    EXPECT_EQ(FindGame("qfusion")->bevelSurfaceFlags, 0x43043u);
    // trans and areaportal set the same bit.
    EXPECT_EQ(game.CompileFlagsOf(0, 0x80008001), std::uint32_t(C_SOLID | C_TRANSLUCENT));
    EXPECT_EQ(game.CompileFlagsOf(0, 0x80000000), std::uint32_t(C_TRANSLUCENT | C_AREAPORTAL));
}

TEST(Games, LightDefaults) {
    const Game &quake = *FindGame("quake3");
    EXPECT_FALSE(quake.wolfLighting || quake.noStyles || quake.keepLights || quake.patchShadows || quake.sRgbLightmap);
    EXPECT_EQ(quake.gamma, 1);
    EXPECT_TRUE(FindGame("et")->wolfLighting);
    EXPECT_FALSE(FindGame("etut")->wolfLighting);
    EXPECT_TRUE(FindGame("etut")->sRgbLightmap && !FindGame("etut")->sRgbTexture);
    EXPECT_FLOAT_EQ(FindGame("etut")->gamma, 2.2f);
    EXPECT_TRUE(FindGame("xonotic")->sRgbLightmap && FindGame("xonotic")->sRgbColor);
    EXPECT_EQ(FindGame("darkplaces")->exposure, 200);
    EXPECT_FALSE(FindGame("darkplaces")->patchShadows);
    EXPECT_FLOAT_EQ(FindGame("dq")->gridScale, 0.3f);
    EXPECT_FLOAT_EQ(FindGame("prophecy")->gridScale, 0.4f);
    EXPECT_FLOAT_EQ(FindGame("prophecy")->gridAmbientScale, 0.6f);
    const Game &qfusion = *FindGame("qfusion");
    EXPECT_TRUE(qfusion.halfLambert && !qfusion.noStyles && qfusion.keepLights && qfusion.deluxe && !qfusion.flares);
    EXPECT_EQ(qfusion.lightmapSize, 512);
    EXPECT_TRUE(FindGame("sof2")->flares && !FindGame("sof2")->keepLights && !FindGame("sof2")->noStyles);
    EXPECT_EQ(FindGame("sof2")->flareShader, "gfx/misc/lens_flare");
}

TEST(Games, FlagsOfAShaderRecordSayWhatItsParmsDid) {
    const Game &game = *FindGame("quake3");
    EXPECT_EQ(game.CompileFlagsOf(0, 1), std::uint32_t(C_SOLID));
    EXPECT_EQ(game.CompileFlagsOf(0, 0), 0u);
    // Clip with nodraw, as oacmpdm8 has it; a trigger; a sky; water.
    EXPECT_EQ(game.CompileFlagsOf(0x4CB0, 0x10000),
              std::uint32_t(C_TRANSLUCENT | C_DETAIL | C_NODRAW | C_VERTEXLIT | C_NOMARKS));
    EXPECT_EQ(game.CompileFlagsOf(0x80, 0x40000000), std::uint32_t(C_TRANSLUCENT | C_NODRAW));
    EXPECT_EQ(game.CompileFlagsOf(0xC34, 1), std::uint32_t(C_SOLID | C_SKY | C_VERTEXLIT | C_NOMARKS));
    EXPECT_EQ(game.CompileFlagsOf(0, 0x20000020), std::uint32_t(C_TRANSLUCENT | C_LIQUID));
    // Bits of a material, or half of a parm's bits, say nothing.
    EXPECT_EQ(FindGame("etut")->CompileFlagsOf(0x1200000, 1), std::uint32_t(C_SOLID));
    EXPECT_EQ(FindGame("ef")->CompileFlagsOf(0x8, 1), std::uint32_t(C_SOLID));
    EXPECT_EQ(FindGame("ef")->CompileFlagsOf(0x8, 0x80), std::uint32_t(C_TRANSLUCENT | C_DETAIL));
}

/// What a script's parms make of a shader comes back from the bits that it leaves in a .bsp, but for parms without.
TEST(Games, EveryParmComesBackFromItsBits) {
    for (const Game &game : Games())
        for (const SurfaceParm &parm : game.surfaceParms) {
            if (parm.name == "default" || parm.name == "nonsolid" || (parm.contentSet | parm.surfaceSet) == 0)
                continue;
            const std::uint32_t byDefault = game.FindParm("default")->contentSet;
            const std::uint32_t contents = (byDefault & ~parm.contentClear) | parm.contentSet;
            const std::uint32_t expected = (C_SOLID & ~parm.compileClear) | parm.compileSet;
            EXPECT_EQ(game.CompileFlagsOf(parm.surfaceSet, contents) & expected, expected)
                << game.name << ' ' << parm.name;
        }
}

} // namespace
} // namespace q3
