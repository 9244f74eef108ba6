// GPL-2.0-or-later. Two maps in one.
#include "common/error.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/edit/merge_maps.h"
#include "tests/support/small_bsp.h"

#include <algorithm>

namespace q3::test {

namespace {

/// SmallBsp with a door of its own: model 1, one brush, one fogless face.
Bsp WithDoor(std::string_view shader) {
    Bsp bsp = SmallBsp();
    bsp.shaders.push_back({Field<64>(shader), 0, 1});
    bsp.models.push_back({{0, 0, 0}, {64, 64, 64}, 1, 1, 1, 1});
    bsp.brushes.push_back({6, 6, 2});
    for (int i = 0; i < 6; ++i)
        bsp.brushSides.push_back(bsp.brushSides[std::size_t(i)]);
    bspDrawSurface_t surface = bsp.drawSurfaces[0];
    surface.shaderNum = 2;
    surface.firstVert = 4;
    surface.firstIndex = 6;
    bsp.drawSurfaces.push_back(surface);
    for (std::size_t i = 0; i < 4; ++i)
        bsp.drawVerts.push_back(bsp.drawVerts[i]);
    for (std::size_t i = 0; i < 6; ++i)
        bsp.drawIndexes.push_back(bsp.drawIndexes[i]);
    bsp.entities += "{\n\"classname\" \"func_door\"\n\"model\" \"*1\"\n\"targetname\" \"Gate\"\n}\n"
                    "{\n\"classname\" \"func_button\"\n\"target\" \"gate\"\n}\n";
    return bsp;
}

Bsp Merged(const Bsp &main, const Bsp &added, const MergeOptions &options = {}) {
    KeptLog log;
    return MergeMaps({main, "main"}, {added, "added"}, options, log.log);
}

TEST(Merge, AddsEntitiesAndTheirModels) {
    const Bsp main = WithDoor("textures/a"), added = WithDoor("textures/b");
    const Bsp bsp = Merged(main, added);
    EXPECT_EQ(bsp.models.size(), 3u);
    EXPECT_EQ(bsp.shaders.size(), 4u) << "two are in both maps";
    EXPECT_EQ(bsp.planes.size(), main.planes.size() + added.planes.size());
    EXPECT_EQ(bsp.brushes.size(), 4u) << "the added door, and the brush of the added fog";
    EXPECT_EQ(bsp.drawSurfaces.size(), 3u) << "not the added world";
    EXPECT_EQ(bsp.drawVerts.size(), 12u);
    EXPECT_EQ(bsp.fogs.size(), 2u);
    EXPECT_EQ(bsp.nodes.size(), main.nodes.size());
    EXPECT_EQ(bsp.visibility, main.visibility);
    const auto entities = ParseEntities(bsp.entities, "merged");
    ASSERT_EQ(entities.size(), 7u) << "one worldspawn";
    EXPECT_EQ(entities[5].Value("model"), "*2");
    const bspModel_t &door = bsp.models[2];
    const bspDrawSurface_t &face = bsp.drawSurfaces[std::size_t(door.firstBSPSurface)];
    EXPECT_EQ(FieldName(bsp.shaders[std::size_t(face.shaderNum)].shader), "textures/b");
    EXPECT_EQ(face.fogNum, -1) << "no fog stays no fog";
    EXPECT_EQ(bsp.drawVerts[std::size_t(face.firstVert)].xyz, added.drawVerts[4].xyz);
    const bspBrush_t &brush = bsp.brushes[std::size_t(door.firstBSPBrush)];
    EXPECT_EQ(FieldName(bsp.shaders[std::size_t(brush.shaderNum)].shader), "textures/b");
    EXPECT_EQ(bsp.planes[std::size_t(bsp.brushSides[std::size_t(brush.firstSide)].planeNum)].normal,
              added.planes[std::size_t(added.brushSides[6].planeNum)].normal);
}

/// WithDoor as RBSP, with two switchable lights, of styles 32 and 33, on its door.
Bsp WithLamps(std::string_view first, std::string_view second) {
    Bsp bsp = WithDoor("textures/b");
    bsp.ident = kRbspIdent;
    int style = 32;
    for (const std::string_view name : {first, second})
        bsp.entities +=
            fmt::format("{{\n\"classname\" \"light\"\n\"targetname\" \"{}\"\n\"style\" \"{}\"\n}}\n", name, style++);
    bsp.drawSurfaces[1].lightmapStyles = bsp.drawSurfaces[1].vertexStyles = {0, 32, 33, kNoStyle};
    bsp.brushSides[0].surfaceNum = 0;
    bsp.brushSides[8].surfaceNum = 1;
    return bsp;
}

TEST(Merge, SwitchableLightsKeepApart) {
    const Bsp bsp = Merged(WithLamps("hall", "yard"), WithLamps("cellar", "Yard"));
    const bspDrawSurface_t &door = bsp.drawSurfaces[std::size_t(bsp.models[2].firstBSPSurface)];
    EXPECT_EQ(door.lightmapStyles, (Styles{0, 34, 33, kNoStyle})) << "the cellar's are new, the yard's are the yard's";
    EXPECT_EQ(door.vertexStyles, door.lightmapStyles);
    EXPECT_EQ(bsp.drawSurfaces[1].lightmapStyles, (Styles{0, 32, 33, kNoStyle}));
    const auto entities = ParseEntities(bsp.entities, "merged");
    EXPECT_EQ(entities[entities.size() - 2].Value("style"), "34");
    EXPECT_EQ(entities.back().Value("style"), "33");
}

TEST(Merge, SidesKeepTheirSurfaces) {
    const Bsp main = WithLamps("a", "b"), bsp = Merged(main, WithLamps("c", "d"));
    EXPECT_EQ(bsp.brushSides[8].surfaceNum, 1);
    const bspBrush_t &door = bsp.brushes[std::size_t(bsp.models[2].firstBSPBrush)];
    EXPECT_EQ(bsp.brushSides[std::size_t(door.firstSide + 2)].surfaceNum, bsp.models[2].firstBSPSurface);
    EXPECT_EQ(bsp.brushSides[std::size_t(door.firstSide)].surfaceNum, -1);
    const Bsp withWorld = Merged(main, WithLamps("c", "d"), {.world = true});
    EXPECT_EQ(withWorld.brushSides[0].surfaceNum, 0);
    EXPECT_EQ(withWorld.brushSides[8].surfaceNum, withWorld.models[1].firstBSPSurface) << "moved by the added world";
}

TEST(Merge, FormatsAreNotMixed) {
    try {
        Merged(WithDoor("textures/a"), WithLamps("a", "b"));
        ADD_FAILURE();
    } catch (const Error &error) {
        EXPECT_STREQ(error.what(), "main is IBSP, but added is RBSP: maps of two formats cannot be merged");
    }
}

TEST(Merge, FogsFollowTheirBrushesAndSurfaces) {
    Bsp added = WithDoor("textures/b");
    added.drawSurfaces[1].fogNum = 0;
    added.fogs.push_back({Field<64>("textures/everywhere"), -1, -1});
    const Bsp bsp = Merged(WithDoor("textures/a"), added);
    ASSERT_EQ(bsp.fogs.size(), 3u);
    EXPECT_EQ(bsp.drawSurfaces[2].fogNum, 1);
    EXPECT_EQ(bsp.fogs[2].brushNum, -1);
    const bspBrush_t &fogBrush = bsp.brushes[std::size_t(bsp.fogs[1].brushNum)];
    EXPECT_EQ(FieldName(bsp.shaders[std::size_t(fogBrush.shaderNum)].shader), "textures/base/wall");
}

TEST(Merge, LightmapsFollowThePagesOfTheFirst) {
    Bsp main = WithDoor("textures/a"), added = WithDoor("textures/b");
    main.lightmaps.resize(2 * kLightmapPageBytes, 1);
    added.lightmaps.resize(kLightmapPageBytes, 2);
    added.drawSurfaces[1].lightmapNum[0] = 0;
    const Bsp bsp = Merged(main, added);
    EXPECT_EQ(bsp.drawSurfaces[2].lightmapNum[0], 2);
    EXPECT_EQ(bsp.lightmaps[2 * kLightmapPageBytes], 2);
}

TEST(Merge, WorldsShareLeafs) {
    const Bsp main = WithDoor("textures/a"), added = WithDoor("textures/b");
    const Bsp bsp = Merged(main, added, {.world = true});
    EXPECT_EQ(bsp.models[0].numBSPSurfaces, 2);
    EXPECT_EQ(bsp.models[0].numBSPBrushes, 2);
    EXPECT_EQ(bsp.drawSurfaces.size(), 4u);
    EXPECT_EQ(bsp.brushes.size(), 4u);
    // The door of the first map moved behind the world.
    EXPECT_EQ(FieldName(bsp.shaders[std::size_t(bsp.drawSurfaces[2].shaderNum)].shader), "textures/a");
    EXPECT_EQ(bsp.models[1].firstBSPSurface, 2);
    EXPECT_EQ(bsp.models[1].firstBSPBrush, 2);
    // The open leaf begins at x = 64, where the face is; the solid one holds the brush.
    EXPECT_EQ(bsp.leafs[1].numBSPLeafSurfaces, 2);
    EXPECT_EQ(bsp.leafs[2].numBSPLeafSurfaces, 0);
    EXPECT_EQ(bsp.leafs[2].numBSPLeafBrushes, 2);
    std::vector<int> listed(bsp.leafBrushes.begin() + bsp.leafs[2].firstBSPLeafBrush, bsp.leafBrushes.end());
    EXPECT_EQ(std::ranges::count(listed, 1), 1) << "the added one is brush 1";
}

TEST(Merge, NamesOfBothMapsCanBeToldApart) {
    const Bsp main = WithDoor("textures/a"), added = WithDoor("textures/b");
    const auto kept = ParseEntities(Merged(main, added).entities, "merged");
    EXPECT_EQ(kept[5].Value("targetname"), "Gate");
    const auto entities = ParseEntities(Merged(main, added, {.fixNames = true}).entities, "merged");
    EXPECT_EQ(entities[2].Value("targetname"), "Gate");
    EXPECT_EQ(entities[5].Value("targetname"), "Gate_0");
    EXPECT_EQ(entities[6].Value("target"), "Gate_0") << "both ends get one name";
}

} // namespace

} // namespace q3::test
