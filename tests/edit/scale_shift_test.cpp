// GPL-2.0-or-later. Maps that are scaled and moved.
#include "common/error.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/edit/scale_shift.h"
#include "tests/support/small_bsp.h"

#include <cmath>

namespace q3::test {

namespace {

/// With a gridsize key, and no lump that may hold positions.
Bsp MovableBsp() {
    Bsp bsp = FullBsp(GridSHContainer::Lump);
    bsp.bspx.pop_back();
    for (bspPlane_t &plane : bsp.planes)
        plane.dist += 0.0f; // of some it is -0, which no sum gives
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"gridsize\" \"64 64 128\"\n}\n"
                   "{\n\"classname\" \"info_player_deathmatch\"\n\"origin\" \"32 -8.5 24\"\n}\n"
                   "{\n\"classname\" \"func_door\"\n\"lip\" \"8\"\n\"angle\" \"90\"\n\"height\" \"12\"\n}\n";
    return bsp;
}

Bsp Scaled(Bsp bsp, const Vec3d &factors, bool projectTextures = false) {
    KeptLog log;
    ScaleMap(bsp, {.factors = factors, .projectTextures = projectTextures}, "map", log.log);
    return bsp;
}

Bsp Shifted(Bsp bsp, const Vec3d &by) {
    KeptLog log;
    ShiftMap(bsp, by, "map", log.log);
    return bsp;
}

std::vector<Entity> Entities(const Bsp &bsp) {
    return ParseEntities(bsp.entities, "map");
}

TEST(Shift, BackGivesTheSameBytes) {
    const Bsp bsp = MovableBsp();
    const Bsp there = Shifted(bsp, {64, -128, 384});
    EXPECT_NE(Bytes(there), Bytes(bsp));
    EXPECT_EQ(Bytes(Shifted(there, {-64, 128, -384})), Bytes(bsp));
}

TEST(Shift, MovesEveryPosition) {
    const Bsp old = MovableBsp();
    const Bsp bsp = Shifted(old, {64, -128, 384});
    EXPECT_EQ(Entities(bsp)[1].Value("origin"), "96 -136.5 408");
    EXPECT_EQ(bsp.models[0].maxs, (Float3{164, -108, 414}));
    EXPECT_EQ(bsp.nodes[0].mins, (Int3{56, -136, 376}));
    EXPECT_EQ(bsp.leafs[1].maxs, (Int3{164, -108, 414}));
    EXPECT_EQ(bsp.drawVerts[2].xyz, (Float3{128, -64, 448}));
    EXPECT_EQ(bsp.planes[0].dist, 128) << "of +x";
    EXPECT_EQ(bsp.planes[1].dist, -128) << "of -x";
    EXPECT_EQ(bsp.gridSH->header.gridMins, (Float3{64, -128, 384}));
    EXPECT_EQ(bsp.gridSH->header.gridSize, old.gridSH->header.gridSize);
    EXPECT_EQ(bsp.gridPoints.size(), old.gridPoints.size());
    EXPECT_EQ(bsp.advertisements[0].rect[0], (Float3{65, -126, 387}));
}

TEST(Shift, ByPartOfACellDropsTheLegacyGridOnly) {
    Bsp bsp = MovableBsp();
    KeptLog log;
    ShiftMap(bsp, {32, 0, 0}, "map", log.log);
    EXPECT_TRUE(bsp.gridPoints.empty());
    EXPECT_NE(log.text.find("legacy light grid is dropped"), std::string::npos);
    EXPECT_EQ(bsp.gridSH->header.gridMins[0], 32);
}

TEST(Shift, DropsLumpsThatMayHoldPositions) {
    Bsp bsp = FullBsp(GridSHContainer::Bspx);
    KeptLog log;
    ShiftMap(bsp, {64, 0, 0}, "map", log.log);
    ASSERT_EQ(bsp.bspx.size(), 1u);
    EXPECT_EQ(bsp.bspx[0].name, "RGBLIGHTING");
    EXPECT_TRUE(bsp.gridSH);
}

/// A second model: the brush and the face once more, with the planes of the first.
void AddInlineModel(Bsp &bsp, std::string_view keys) {
    bsp.models.push_back({{0, 0, 0}, {64, 64, 64}, 1, 1, 1, 1});
    bsp.brushes.push_back({6, 6, 0});
    for (int i = 0; i < 6; ++i)
        bsp.brushSides.push_back(bsp.brushSides[std::size_t(i)]);
    bspDrawSurface_t surface = bsp.drawSurfaces[0];
    surface.firstVert = 4;
    bsp.drawSurfaces.push_back(surface);
    for (int i = 0; i < 4; ++i)
        bsp.drawVerts.push_back(bsp.drawVerts[std::size_t(i)]);
    bsp.entities += fmt::format("{{\n\"classname\" \"func_rotating\"\n\"model\" \"*1\"\n{}}}\n", keys);
}

TEST(Shift, ModelsAtAnOriginMoveWithItOnly) {
    Bsp old = MovableBsp();
    AddInlineModel(old, "\"origin\" \"1 2 3\"\n");
    const Bsp bsp = Shifted(old, {64, 64, 128});
    EXPECT_EQ(Entities(bsp)[3].Value("origin"), "65 66 131");
    EXPECT_EQ(bsp.models[1].mins, old.models[1].mins);
    EXPECT_EQ(bsp.drawVerts[4].xyz, old.drawVerts[4].xyz);
    EXPECT_NE(bsp.drawVerts[0].xyz, old.drawVerts[0].xyz);
    for (std::size_t side = 0; side < 6; ++side) {
        const auto plane = [&](const Bsp &b, std::size_t s) { return b.planes[std::size_t(b.brushSides[s].planeNum)]; };
        EXPECT_EQ(plane(bsp, 6 + side).dist, plane(old, 6 + side).dist) << "own planes, unmoved";
        EXPECT_NE(plane(bsp, side).dist, plane(old, side).dist);
        const int number = bsp.brushSides[6 + side].planeNum;
        EXPECT_EQ(bsp.planes[std::size_t(number)].dist, -bsp.planes[std::size_t(number ^ 1)].dist) << "still a pair";
    }
}

TEST(Shift, ModelsWithoutAnOriginMove) {
    Bsp old = MovableBsp();
    AddInlineModel(old, "");
    const Bsp bsp = Shifted(old, {64, 64, 128});
    EXPECT_FALSE(Entities(bsp)[3].Has("origin"));
    EXPECT_EQ(bsp.models[1].mins, (Float3{64, 64, 128}));
    EXPECT_EQ(bsp.drawVerts[4].xyz, bsp.drawVerts[0].xyz);
    EXPECT_EQ(bsp.planes.size(), old.planes.size());
}

TEST(Scale, ThereAndBackGivesTheSameBytes) {
    const Bsp bsp = MovableBsp();
    const Bsp twice = Scaled(bsp, {2, 2, 2});
    EXPECT_EQ(Bytes(Scaled(twice, {0.5, 0.5, 0.5})), Bytes(bsp));
    EXPECT_EQ(Bytes(Scaled(Scaled(bsp, {2, 4, 8}), {0.5, 0.25, 0.125})), Bytes(bsp));
}

TEST(Scale, ScalesPositionsCellsAndKeys) {
    const Bsp bsp = Scaled(MovableBsp(), {2, 3, 4});
    const auto entities = Entities(bsp);
    EXPECT_EQ(entities[0].Value("gridsize"), "128 192 512");
    EXPECT_EQ(entities[1].Value("origin"), "64 -25.5 96");
    EXPECT_EQ(entities[2].Value("lip"), "24") << "along y";
    EXPECT_EQ(entities[2].Value("height"), "48");
    EXPECT_EQ(bsp.models[0].maxs, (Float3{200, 60, 120}));
    EXPECT_EQ(bsp.leafs[1].maxs, (Int3{200, 60, 120}));
    EXPECT_EQ(bsp.drawVerts[2].xyz, (Float3{128, 192, 256}));
    EXPECT_EQ(bsp.planes[0].normal, (Float3{1, 0, 0}));
    EXPECT_EQ(bsp.planes[0].dist, 128);
    EXPECT_EQ(bsp.gridSH->header.gridSize, (Float3{140, 96, 256}));
    EXPECT_EQ(bsp.gridPoints.size(), 2u);
}

TEST(Scale, PlayersStandOnTheFloor) {
    Bsp bsp = MovableBsp();
    KeptLog log;
    ScaleMap(bsp, {.factors = {2, 2, 2}, .spawnReference = -24}, "map", log.log);
    EXPECT_EQ(Entities(bsp)[1].Value("origin"), "64 -17 24");
}

// Points of a sloped plane, scaled, lie on the scaled plane, whose normal has length 1.
TEST(Scale, SlopesStaySlopes) {
    Bsp bsp = MovableBsp();
    const Vec3d normal = Normalize(Vec3d{1, 2, 3}), onPlane{30, -7, 11}, along = Normalize(Cross(normal, {0, 0, 1}));
    bsp.planes.push_back({Vec3f(normal).Array(), float(Dot(normal, onPlane))});
    const Vec3d factors{2, 0.5, 3};
    const bspPlane_t plane = Scaled(bsp, factors).planes.back();
    EXPECT_NEAR(Length(Vec3d(plane.normal)), 1, 1e-6);
    for (const double t : {-100.0, 0.0, 50.0})
        EXPECT_NEAR(Dot(Vec3d(plane.normal), (onPlane + along * t) * factors), double(plane.dist), 1e-4);
}

// s = y / 64 and t = z / 64 on the face, and on the scaled face.
TEST(Scale, TexturesKeepTheirSizeIfAsked) {
    const Bsp bsp = MovableBsp();
    const Bsp stretched = Scaled(bsp, {2, 2, 4}), projected = Scaled(bsp, {2, 2, 4}, true);
    for (std::size_t i = 0; i < bsp.drawVerts.size(); ++i) {
        EXPECT_EQ(stretched.drawVerts[i].st, bsp.drawVerts[i].st);
        EXPECT_NEAR(projected.drawVerts[i].st[0], projected.drawVerts[i].xyz[1] / 64, 1e-6);
        EXPECT_NEAR(projected.drawVerts[i].st[1], projected.drawVerts[i].xyz[2] / 64, 1e-6);
    }
}

// -512 * 1.1f and 64 * 1.1f are rounded, and their quotient need not be -8.
TEST(Scale, RoundingDoesNotLoseTheGrid) {
    for (const double factor : {1.1, 1.3, 0.7, 1.0 / 3, 2.9}) {
        Bsp bsp = MovableBsp();
        bsp.models[0].mins = {-512, -192, -128};
        bsp.models[0].maxs = {448, 576, 640};
        bsp.gridPoints.assign(16 * 13 * 7, {});
        const Bsp scaled = Scaled(bsp, {factor, factor, factor});
        EXPECT_EQ(scaled.gridPoints.size(), bsp.gridPoints.size()) << factor;
        EXPECT_NEAR(scaled.models[0].mins[0], -512 * factor, 0.01);
    }
}

TEST(Scale, FactorsMustBePositive) {
    for (const double factor : {0.0, -1.0, double(NAN)})
        EXPECT_THROW(Scaled(MovableBsp(), {1, factor, 1}), Error) << factor;
}

TEST(AxisValues, OneTwoOrThree) {
    const auto values = [](std::vector<std::string> words) {
        Arguments arguments(std::move(words));
        const Vec3d v = TakeAxisValues(arguments, "-shift");
        EXPECT_EQ(arguments.Rest().size(), 1u);
        return v;
    };
    EXPECT_EQ(values({"-64", "x.bsp"}), (Vec3d{-64, -64, -64}));
    EXPECT_EQ(values({"1", "2", "x.bsp"}), (Vec3d{1, 1, 2}));
    EXPECT_EQ(values({"1", "-2.5", "3", "x.bsp"}), (Vec3d{1, -2.5, 3}));
    EXPECT_EQ(values({"5", "64"}), (Vec3d{5, 5, 5})) << "64 is the file";
    EXPECT_THROW(values({"x.bsp"}), Error);
    EXPECT_THROW(values({"1", "2", "3", "4", "x.bsp"}), Error);
}

} // namespace

} // namespace q3::test
