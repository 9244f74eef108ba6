// GPL-2.0-or-later. SH grid: lamps against quadrature, and what stands between.
#include "tests/support/light_fixture.h"

#include <cmath>

namespace q3::test {

namespace {

using AreaTest = LightTest;

/// q3map_surfacelight 600 of the shaders here: light of a hemisphere full of it. Byte scale.
constexpr double kAdd = 600 * 0.75;
constexpr Vec3d kLampColor{1, 0.8, 0.5};

constexpr char kLampScript[] = R"(textures/test/lamp
{
	q3map_surfacelight 600
	q3map_lightRGB 1 0.8 0.5
	q3map_backsplash 0 0
	{
		map $whiteimage
	}
}
textures/test/splash
{
	q3map_surfacelight 600
	q3map_lightRGB 1 0.8 0.5
	{
		map $whiteimage
	}
}
)";

/// A lamp of 128 x 64 in the middle of the ceiling, and its light.
SceneBuilder CeilingLamp() {
    SceneBuilder scene = Room();
    const int box = scene.AddBox({-64, -32, 236}, {64, 32, 252}, TestShader("textures/test/wall"), BoxKind::Detail);
    scene.SetFaceShader(box, BoxFace::MinusZ, TestShader("textures/test/lamp"));
    return scene;
}

Coefficients FromCeilingLamp(const Vec3d &p) {
    return FromRectangle(p, {-64, -32, 236}, {128, 0, 0}, {0, 64, 0}, {0, 0, -1}, kAdd, kLampColor);
}

TEST_F(AreaTest, LampInFullViewGivesAllCoefficients) {
    Script(kLampScript);
    const SceneBuilder scene = CeilingLamp();
    ExpectPoints(LitGrid(scene), kExact, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromCeilingLamp(p);
        return Inside(p, RoomBounds());
    });
}

TEST_F(AreaTest, SubdivisionDoesNotMatter) {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/vec/lite_sub"));
    ExpectPoints(LitGrid(scene, "-gridsh 50 50 64"), 5 * kExact, 100, [](const Vec3d &p, Coefficients &c) {
        if (!Inside(p, RoomBounds(), 20))
            return false;
        c = FromRectangle(p, {-250, -186, 4}, {0, 372, 0}, {0, 0, 248}, {1, 0, 0}, kAdd, kLampColor);
        return true;
    });
}

TEST_F(AreaTest, BacksplashLightsTheWallBehindTheLamp) {
    Script(kLampScript);
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/test/splash"));
    // Cells of 120 have points 10 and 130 units before the wall: one behind the backsplash's plane, 23 units before it.
    int behind = 0;
    ExpectPoints(LitGrid(scene, "-gridsh 120 60 60"), kExact, 60, [&](const Vec3d &p, Coefficients &c) {
        if (!Inside(p, RoomBounds(), 5))
            return false;
        behind += p.x < -227;
        c = FromRectangle(p, {-250, -186, 4}, {0, 372, 0}, {0, 0, 248}, {1, 0, 0}, kAdd, kLampColor) +
            FromRectangle(p, {-227, -186, 4}, {0, 372, 0}, {0, 0, 248}, {-1, 0, 0}, 0.35 * kAdd, kLampColor);
        return true;
    });
    EXPECT_GE(behind, 12);
}

TEST_F(AreaTest, TwoSidedLampShinesBothWays) {
    SceneBuilder scene = Room();
    scene.AddQuad({{{0, -40, 60}, {0, -40, 140}, {0, 40, 140}, {0, 40, 60}}}, TestShader("textures/vec/lite_two"));
    int sides[2] = {0, 0};
    ExpectPoints(LitGrid(scene, "-noshfill"), kExact, 400, [&](const Vec3d &p, Coefficients &c) {
        if (!Inside(p, RoomBounds()))
            return false;
        if (p.x != 0)
            sides[p.x > 0]++;
        for (const double side : {1.0, -1.0})
            c = c + FromRectangle(p, {0, -40, 60}, {0, 80, 0}, {0, 0, 80}, {side, 0, 0}, kAdd, kLampColor);
        return true;
    });
    EXPECT_GT(sides[0], 100);
    EXPECT_GT(sides[1], 100);
}

TEST_F(AreaTest, OneSidedLampLeavesItsBackDark) {
    Script(kLampScript);
    SceneBuilder scene = Room();
    scene.AddQuad({{{0, -40, 60}, {0, -40, 140}, {0, 40, 140}, {0, 40, 60}}}, TestShader("textures/test/lamp"));
    const GridView grid = LitGrid(scene);
    const double east = Largest(grid.Sample({64, 0, 100})), west = Largest(grid.Sample({-64, 0, 100}));
    EXPECT_GT(std::max(east, west), 0.1);
    EXPECT_EQ(std::min(east, west), 0);
}

TEST_F(AreaTest, NothingReachesBehindASlab) {
    Script(kLampScript);
    SceneBuilder scene = CeilingLamp();
    scene.AddBox({-120, -186, 4}, {-110, 186, 252}, TestShader("textures/test/wall"));
    scene.AddEntity(MakeEntity("light", {{"origin", "100 0 100"}, {"light", "2000"}}));
    const GridView grid = LitGrid(scene);
    ExpectPoints(grid, 0, 100, [](const Vec3d &p, Coefficients &) { return p.x < -121 && Inside(p, RoomBounds()); });
    ExpectPoints(grid, kExact, 300, [&](const Vec3d &p, Coefficients &c) {
        c = FromCeilingLamp(p) + FromPoint(p, {100, 0, 100}, 2000);
        return p.x > -109 && Inside(p, RoomBounds());
    });
}

TEST_F(AreaTest, AMirroredSceneTakesTheSameRays) {
    Script(kLampScript);
    // Eight points from 0 to 448 along x, and the room, the lamp and the two slabs are each other's mirror images.
    const auto refined = [&](float from, float to) {
        SceneBuilder scene = Room({-30, -186, 0}, {478, 186, 256});
        const int box =
            scene.AddBox({160, -32, 236}, {288, 32, 252}, TestShader("textures/test/wall"), BoxKind::Detail);
        scene.SetFaceShader(box, BoxFace::MinusZ, TestShader("textures/test/lamp"));
        scene.AddBox({from, -186, 0}, {to, 186, 200}, TestShader("textures/test/wall"), BoxKind::Detail);
        const GridView grid = LitGrid(scene, "-gridsh 64 16 16 -noshfill");
        return result.gridSH.counts.refined;
    };
    const auto left = double(refined(90, 100)), right = double(refined(348, 358));
    EXPECT_GT(left, 300);
    EXPECT_NEAR(left / right, 1, 0.02);
}

TEST_F(AreaTest, PenumbraIsBetweenShadowAndLightAndNearTheTruth) {
    Script(kLampScript);
    SceneBuilder scene = CeilingLamp();
    const Boundsf slab{{-60, -186, 140}, {20, 186, 148}};
    scene.AddBox(slab.mins, slab.maxs, TestShader("textures/test/wall"), BoxKind::Detail);
    const GridView grid = LitGrid(scene);
    int partly = 0;
    double squares = 0;
    for (std::size_t i = 0; i < grid.Count(); i++) {
        const Vec3d p = grid.Position(i);
        if (!Inside(p, RoomBounds()) || Inside(p, slab, -1))
            continue;
        // Slow truth: a fine lattice of rays to the lamp.
        constexpr int kSide = 48;
        int clear = 0;
        Coefficients truth{};
        for (int a = 0; a < kSide; a++)
            for (int b = 0; b < kSide; b++) {
                const Vec3d target{-64 + (a + 0.5) * 128 / kSide, -32 + (b + 0.5) * 64 / kSide, 236};
                if (SegmentMeets(p, target, slab, 0))
                    continue;
                const Vec3d way = target - p;
                const double r = Length(way);
                const double solidAngle = way.z / r * (128.0 * 64 / (kSide * kSide)) / (r * r);
                truth = truth + FromDirection(way / r, kLampColor * (kAdd / 255 / std::numbers::pi * solidAngle));
                clear++;
            }
        if (clear == 0 || clear == kSide * kSide)
            continue;
        partly++;
        const double off = Difference(grid.At(i), truth) * 255;
        EXPECT_LT(off, 4) << "bytes, at " << p.x << ' ' << p.y << ' ' << p.z;
        squares += off * off;
    }
    EXPECT_GE(partly, 30);
    EXPECT_LT(std::sqrt(squares / partly), 1) << "bytes";
}

/// A sheet at z = 150 over half the room's middle.
constexpr float kSheet = 150;
SceneBuilder SheetScene(std::string_view shader, float halfWidth, float halfDepth) {
    SceneBuilder scene = Room();
    scene.AddQuad({{{-halfWidth, -halfDepth, kSheet},
                    {-halfWidth, halfDepth, kSheet},
                    {halfWidth, halfDepth, kSheet},
                    {halfWidth, -halfDepth, kSheet}}},
                  TestShader(shader));
    return scene;
}

void AddSheetLight(SceneBuilder &scene) {
    scene.AddEntity(MakeEntity("light", {{"origin", "5 -7 230"}, {"light", "200"}}));
}

/// Expected share of light that goes through the sheet of SheetScene(…, 60, 50); false near its border.
bool ThroughSheet(const Vec3d &p, const Vec3d &share, Coefficients &c) {
    const Vec3d light{5, -7, 230};
    const Boundsf sheet{{-60, -50, kSheet}, {60, 50, kSheet}};
    const auto crosses = [&](float margin) {
        const Vec3f edge{margin, margin, 0};
        return SegmentMeets(p, light, {sheet.mins - edge, sheet.maxs + edge}, 1e-6);
    };
    if (crosses(0.5f) != crosses(-0.5f) || !Inside(p, RoomBounds()))
        return false;
    c = FromPoint(p, light, 200, crosses(0) ? share : Vec3d{1, 1, 1});
    return true;
}

TEST_F(AreaTest, AlphaShadowLetsThroughWhatItsAlphaLeaves) {
    SceneBuilder scene = SheetScene("textures/vec/ashadow", 60, 50);
    AddSheetLight(scene);
    const double share = (255 - 64) / 255.0;
    ExpectPoints(LitGrid(scene), kExact, 350, [&](const Vec3d &p, Coefficients &c) {
        return ThroughSheet(p, {share, share, share}, c);
    });
}

TEST_F(AreaTest, LightFilterColorsTheLight) {
    SceneBuilder scene = SheetScene("textures/vec/lfilter", 60, 50);
    AddSheetLight(scene);
    ExpectPoints(LitGrid(scene), kExact, 350, [&](const Vec3d &p, Coefficients &c) {
        return ThroughSheet(p, {0.8, 0.4, 1}, c);
    });
}

TEST_F(AreaTest, LightFilterColorsLampsToo) {
    Script(kLampScript);
    SceneBuilder scene = CeilingLamp();
    scene.AddQuad({{{-250, -186, kSheet}, {-250, 186, kSheet}, {250, 186, kSheet}, {250, -186, kSheet}}},
                  TestShader("textures/vec/lfilter"));
    ExpectPoints(LitGrid(scene), 10 * kExact, 250, [](const Vec3d &p, Coefficients &c) {
        c = FromCeilingLamp(p) * Vec3d{0.8, 0.4, 1};
        return p.z < double(kSheet) && Inside(p, RoomBounds());
    });
}

} // namespace

} // namespace q3::test
