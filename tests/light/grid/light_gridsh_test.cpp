// GPL-2.0-or-later. SH grid: lights without size against their formulas.
#include "tests/support/light_fixture.h"

#include <cmath>

namespace q3::test {

namespace {

class ClosedFormTest : public LightTest {
  protected:
    void ExpectSunlight(int morePieces);
};

constexpr double kRadians = std::numbers::pi / 180;

Entity PointLight(std::string_view origin, std::string_view intensity) {
    return MakeEntity("light", {{"origin", std::string(origin)}, {"light", std::string(intensity)}});
}

Entity With(Entity entity, std::initializer_list<std::pair<std::string, std::string>> keys) {
    for (const auto &[key, value] : keys)
        entity.Set(key, value);
    return entity;
}

/// Where a ray from p along d leaves the room: whether through the ceiling, and how far from its border.
bool LeavesByCeiling(const Vec3d &p, const Vec3d &d, double &margin) {
    const Boundsf room = RoomBounds();
    if (d.z <= 0) {
        margin = 1e9;
        return false;
    }
    const Vec3d at = p + d * ((double(room.maxs.z) - p.z) / d.z);
    margin = std::min(std::min(at.x - double(room.mins.x), double(room.maxs.x) - at.x),
                      std::min(at.y - double(room.mins.y), double(room.maxs.y) - at.y));
    return margin > 0;
}

Vec3d SunDirection(double azimuth, double elevation) {
    const double a = azimuth * kRadians, e = elevation * kRadians;
    return {std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)};
}

/// Cells grow until the grid leaves a file of 2 GiB, where offsets of BSP files end, a quarter of a GiB for other lumps.
TEST(GridSHLayout, OfALargeWorldLeavesRoomInTheFile) {
    Bsp bsp;
    bspModel_t world{};
    world.mins = {-32768, -32768, -4096};
    world.maxs = {32768, 32768, 4096};
    bsp.models.push_back(world);
    const GridLayout layout = LayoutGridSH(bsp, {8, 8, 8});
    const std::int64_t bytes = layout.Count() * std::int64_t(sizeof(bspGridPointSH_t));
    EXPECT_LE(bytes, 7 * (std::int64_t(1) << 28));
    EXPECT_GT(bytes, std::int64_t(1) << 30) << "they grow no more than needed";
}

TEST_F(ClosedFormTest, PointLightGivesAllCoefficients) {
    // The third is where a grid point is: there its light comes from everywhere, as from 16 units.
    for (const Vec3d at : {Vec3d{40, -24, 150}, Vec3d{-200, 150, 20}, Vec3d{32, -64, 128}, Vec3d{33, -65, 129}}) {
        SceneBuilder scene = Room();
        scene.AddEntity(PointLight(fmt::format("{} {} {}", at.x, at.y, at.z), "100"));
        ExpectPoints(LitGrid(scene), kExact, 400, [&](const Vec3d &p, Coefficients &c) {
            c = FromPoint(p, at, 100);
            return Inside(p, RoomBounds());
        });
    }
}

TEST_F(ClosedFormTest, ColorsAreNormalisedUnlessToldOtherwise) {
    SceneBuilder scene = Room();
    scene.AddEntity(With(PointLight("-100 20 100", "100"), {{"_color", "0.1 0.3 0.2"}}));
    scene.AddEntity(With(PointLight("90 20 200", "50"), {{"_color", "0.5 2 0"}, {"spawnflags", "32"}, {"scale", "3"}}));
    ExpectPoints(LitGrid(scene), kExact, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromPoint(p, {-100, 20, 100}, 100, {1.0 / 3, 1, 2.0 / 3}) + FromPoint(p, {90, 20, 200}, 150, {0.5, 2, 0});
        return Inside(p, RoomBounds());
    });
}

TEST_F(ClosedFormTest, SpotlightHasAConeWithASoftRim) {
    SceneBuilder scene = Room();
    const Vec3d light{-100, -40, 240}, target{20, 30, 10};
    scene.AddEntity(With(PointLight("-100 -40 240", "200"), {{"target", "aim"}, {"radius", "100"}}));
    scene.AddEntity(MakeEntity("info_null", {{"origin", "20 30 10"}, {"targetname", "aim"}}));
    const Vec3d aim = Normalize(target - light);
    int core = 0, rim = 0, dark = 0;
    ExpectPoints(LitGrid(scene, "-gridsh 16 16 16"), 5 * kExact, 4000, [&](const Vec3d &p, Coefficients &c) {
        const double along = Dot(p - light, aim), off = Length(p - light - aim * along);
        const double radius = 116 / Length(target - light) * along;
        if (std::abs(off - radius) < 0.5 || std::abs(along) < 0.01)
            return false;
        const double share = along < 0 || off >= radius ? 0 : std::min(1.0, (radius - off) / 32);
        if (Inside(p, RoomBounds()))
            (share == 0 ? dark : share == 1 ? core : rim)++;
        c = FromPoint(p, light, 200 * share);
        return Inside(p, RoomBounds());
    });
    EXPECT_GT(core, 100);
    EXPECT_GT(rim, 100);
    EXPECT_GT(dark, 1000);
}

TEST_F(ClosedFormTest, LinearFalloffEnds) {
    SceneBuilder scene = Room();
    const Vec3d light{10, 20, 100};
    scene.AddEntity(With(PointLight("10 20 100", "100"), {{"spawnflags", "1"}, {"fade", "0.6"}}));
    int dark = 0;
    ExpectPoints(LitGrid(scene), kExact, 400, [&](const Vec3d &p, Coefficients &c) {
        const double distance = Length(light - p);
        const double arriving = std::max(0.0, 7500 * 100.0 / 8000 - std::max(16.0, distance) * 0.6);
        c = FromDirection((light - p) / distance, Vec3d{arriving, arriving, arriving} / 255);
        dark += Inside(p, RoomBounds()) && arriving == 0;
        return Inside(p, RoomBounds());
    });
    EXPECT_GT(dark, 50);
}

TEST_F(ClosedFormTest, ExtraDistanceSoftensTheCore) {
    SceneBuilder scene = Room();
    const Vec3d light{10, 20, 100};
    scene.AddEntity(With(PointLight("10 20 100", "100"), {{"_extradist", "50"}}));
    ExpectPoints(LitGrid(scene), kExact, 400, [&](const Vec3d &p, Coefficients &c) {
        const double d2 = Dot(light - p, light - p), share = std::max(256.0, d2) / std::max(256.0, d2 + 2500);
        c = FromPoint(p, light, 100 * share);
        return Inside(p, RoomBounds());
    });
}

TEST_F(ClosedFormTest, NegativeLightIsSubtractedAndNeverGoesBelowBlack) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight("-150 0 100", "100"));
    scene.AddEntity(With(PointLight("150 0 100", "-100"), {{"_color", "1 0.5 0"}}));
    int black = 0;
    ExpectPoints(LitGrid(scene), 3 * kExact, 400, [&](const Vec3d &p, Coefficients &c) {
        c = FromPoint(p, {-150, 0, 100}, 100) + FromPoint(p, {150, 0, 100}, 100, {-1, -0.5, 0});
        for (std::size_t channel = 0; channel < 3; channel++) {
            if (std::abs(c[0][channel]) < 1e-6)
                return false;
            if (c[0][channel] > 0)
                continue;
            for (Vec3d &k : c)
                k[channel] = 0;
            black++;
        }
        return Inside(p, RoomBounds());
    });
    EXPECT_GT(black, 100);
}

TEST_F(ClosedFormTest, SamplesOfOneLightAddUpToIt) {
    SceneBuilder scene = Room();
    scene.AddEntity(With(PointLight("40 -24 150", "100"), {{"_samples", "7"}}));
    ExpectPoints(LitGrid(scene), kExact, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromPoint(p, {40, -24, 150}, 100);
        return Inside(p, RoomBounds());
    });
}

TEST_F(ClosedFormTest, IntensityOptionsMultiply) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight("40 -24 150", "100"));
    const GridView grid = LitGrid(scene, "-point 2 -pointscale 0.5 -spherical 3 -scale 0.1 -spot 9 -area 9 -sky 9");
    ExpectPoints(grid, kExact, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromPoint(p, {40, -24, 150}, 30);
        return Inside(p, RoomBounds());
    });
}

/// A sun over the room, and so many more pieces of its sky where nothing looks.
void ClosedFormTest::ExpectSunlight(int morePieces) {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/vec/sky_sun"));
    for (int i = 0; i < morePieces; ++i) {
        const float z = -1000 - 10 * float(i);
        scene.AddQuad({{{0, 0, z}, {0, 40, z}, {40, 40, z}, {40, 0, z}}}, TestShader("textures/vec/sky_sun"));
    }
    const Boundsf slab{{-60, -50, 120}, {70, 80, 132}};
    scene.AddBox(slab.mins, slab.maxs, TestShader("textures/test/wall"), BoxKind::Detail);
    const Vec3d sun = SunDirection(120, 60);
    int lit = 0, shadow = 0, wall = 0;
    ExpectPoints(LitGrid(scene, "-gridsh 16 16 32"), kExact, 2000, [&](const Vec3d &p, Coefficients &c) {
        double margin = 0;
        const bool sky = LeavesByCeiling(p, sun, margin);
        const bool behind = SegmentMeets(p, p + sun * 1000, slab, -0.5);
        if (std::abs(margin) < 0.5 || behind != SegmentMeets(p, p + sun * 1000, slab, 0.5) || Inside(p, slab, -1) ||
            !Inside(p, RoomBounds()))
            return false;
        (!sky ? wall : behind ? shadow : lit)++;
        if (sky && !behind)
            c = FromDirection(sun, Vec3d{1, 0.9, 0.7} * (150.0 / 255));
        return true;
    });
    EXPECT_GT(lit, 500);
    EXPECT_GT(shadow, 50);
    EXPECT_GT(wall, 100);
}

TEST_F(ClosedFormTest, SunShinesThroughTheSkyAndThingsCastShadows) {
    ExpectSunlight(0);
}
TEST_F(ClosedFormTest, SunShinesTheSameThroughASkyOfManyPieces) {
    ExpectSunlight(30);
}

TEST_F(ClosedFormTest, SunEntityShinesFromItsTargetOn) {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/vec/sky_plain"));
    scene.AddEntity(With(PointLight("100 50 200", "120"), {{"_sun", "1"}, {"target", "aim"}, {"_color", "0.5 1 1"}}));
    scene.AddEntity(MakeEntity("info_null", {{"origin", "0 0 0"}, {"targetname", "aim"}}));
    const Vec3d sun = Normalize(Vec3d{100, 50, 200});
    ExpectPoints(LitGrid(scene, "-skyscale 0.5"), kExact, 300, [&](const Vec3d &p, Coefficients &c) {
        double margin = 0;
        if (LeavesByCeiling(p, sun, margin))
            c = FromDirection(sun, Vec3d{0.5, 1, 1} * (60.0 / 255));
        return std::abs(margin) > 0.5 && Inside(p, RoomBounds());
    });
}

TEST_F(ClosedFormTest, SkyLightIsASumOfSuns) {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/vec/sky_light"));
    // q3map_skyLight 90 3: two rings of eight, the second turned by half a step, and the zenith.
    std::vector<Vec3d> suns{{0, 0, 1}};
    for (int i = 0; i < 8; i++) {
        suns.push_back(SunDirection(45 * i, 15));
        suns.push_back(SunDirection(22.5 + 45 * i, 45));
    }
    ExpectPoints(LitGrid(scene), 2 * kExact, 50, [&](const Vec3d &p, Coefficients &c) {
        for (const Vec3d &sun : suns) {
            double margin = 0;
            if (LeavesByCeiling(p, sun, margin))
                c = c + FromDirection(sun, Vec3d{0.6, 0.8, 1} * (90.0 / 17 / 255));
            if (std::abs(margin) < 0.5)
                return false;
        }
        return Inside(p, RoomBounds());
    });
}

TEST_F(ClosedFormTest, AmbientLightIsTheSameFromEverySide) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", "20");
    scene.SetWorldKey("_color", "0.5 1 0.25");
    const GridView grid = LitGrid(scene);
    ExpectPoints(grid, kExact, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromEverywhere(Vec3d{10, 20, 5} / 255);
        return Inside(p, RoomBounds());
    });
    const Vec3d shown = Evaluate(grid.Sample({10, 20, 100}), Normalize(Vec3d{1, -2, 3}));
    EXPECT_NEAR(shown.y * 255, 20, 1e-4);
}

TEST_F(ClosedFormTest, MinimumLightRaisesTheMean) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_minlight", "200"); // for lightmaps only when there is one for the grid
    scene.SetWorldKey("_mingridlight", "8");
    scene.AddEntity(PointLight("-150 0 100", "60"));
    const double least = FromEverywhere(Vec3d{8, 8, 8} / 255)[0].x;
    int raised = 0;
    ExpectPoints(LitGrid(scene), kExact, 400, [&](const Vec3d &p, Coefficients &c) {
        c = FromPoint(p, {-150, 0, 100}, 60);
        raised += Inside(p, RoomBounds()) && c[0].x < least;
        c[0] = Max(c[0], Vec3d{least, least, least});
        return Inside(p, RoomBounds());
    });
    EXPECT_GT(raised, 50);
}

TEST_F(ClosedFormTest, OtherStylesAndNonGridLightsAreLeftOut) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight("-150 0 100", "60"));
    scene.AddEntity(With(PointLight("150 0 100", "300"), {{"style", "3"}}));
    scene.AddEntity(With(PointLight("150 0 100", "300"), {{"spawnflags", "16"}}));
    Entity junior = PointLight("0 100 60", "50");
    junior.Set("classname", "lightJunior");
    scene.AddEntity(junior);
    ExpectPoints(LitGrid(scene), kExact, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromPoint(p, {-150, 0, 100}, 60) + FromPoint(p, {0, 100, 60}, 50);
        return Inside(p, RoomBounds());
    });
    EXPECT_TRUE(Printed("1 light of other styles than 0 left out"));
}

} // namespace

} // namespace q3::test
