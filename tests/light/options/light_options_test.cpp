// GPL-2.0-or-later. SH grid: what the options change, and what they must not.
#include "libs/sh/sh.h"
#include "q3map2/bspfile/entity_key.h"
#include "tests/support/light_fixture.h"

#include <cmath>

#include <fmt/format.h>

namespace q3::test {

namespace {

using OptionsTest = LightTest;

/// What may be gained or lost by leaving out faint lights. Byte scale.
constexpr double kSkipBound = 0.75;

/// A lamp of shader lite, two point lights, a slab between and a sky with its sun above.
SceneBuilder MixedScene() {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/vec/sky_sun"));
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/vec/lite"));
    scene.AddBox({-60, -50, 60}, {70, 80, 76}, TestShader("textures/test/wall"), BoxKind::Detail);
    scene.AddEntity(MakeEntity("light", {{"origin", "5 -7 170"}, {"light", "200"}, {"_color", "1 0.2 0.4"}}));
    scene.AddEntity(MakeEntity("light", {{"origin", "150 90 30"}, {"light", "80"}}));
    return scene;
}

/// Points in solids are filled by a rule that weighs by brightness; these are lit where they stand.
bool InTheOpen(const Vec3d &p) {
    return Inside(p, RoomBounds()) && !Inside(p, {{-60, -50, 60}, {70, 80, 76}}, -1);
}

TEST_F(OptionsTest, GridScaleMultipliesEverything) {
    SceneBuilder scene = MixedScene();
    scene.SetWorldKey("_ambient", "7");
    scene.SetWorldKey("_mingridlight", "30");
    const GridView plain = LitGrid(scene), scaled = LitGrid(scene, "-gridscale 0.5 -gridscale 5");
    ASSERT_EQ(plain.Count(), scaled.Count());
    int open = 0;
    for (std::size_t i = 0; i < plain.Count(); i++)
        if (InTheOpen(plain.Position(i))) {
            EXPECT_LE(Difference(scaled.At(i), plain.At(i) * Vec3d{2.5, 2.5, 2.5}), kExact * Largest(scaled.At(i)))
                << i;
            open++;
        }
    EXPECT_GT(open, 400);
}

TEST_F(OptionsTest, BacksplashAreaIsTheFactorAlone) {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/vec/lite"));
    const auto sum = [&](std::string_view options) {
        const GridView grid = LitGrid(scene, options);
        double light = 0;
        for (std::size_t i = 0; i < grid.Count(); i++)
            light += Largest(grid.At(i));
        return light;
    };
    const double none = sum("-backsplasharea 0"), usual = sum(""), sixfold = sum("-backsplasharea 3 -backsplasharea 2");
    EXPECT_GT(usual, none);
    EXPECT_NEAR(sixfold, sum("-backsplash 6 -999"), kExact * sixfold); // the distance of the default
    EXPECT_EQ(sum("-backsplash 6 64"), sum("-backsplasharea 6 -backsplash 1 64"));
}

TEST_F(OptionsTest, RadianceIsTheFormWithoutTheCosine) {
    SceneBuilder scene = MixedScene();
    scene.SetWorldKey("_ambient", "7");
    const Bsp bsp = Lit(scene, "-shradiance");
    const GridView radiance(bsp), convolved = LitGrid(scene);
    ASSERT_EQ(radiance.Count(), convolved.Count());
    int lit = 0;
    for (std::size_t i = 0; i < convolved.Count(); i++) {
        if (!InTheOpen(convolved.Position(i)))
            continue;
        Coefficients a = radiance.At(i);
        for (std::size_t k = 0; k < 9; k++)
            a[k] *= Lobe(k);
        EXPECT_LE(Difference(a, convolved.At(i)), kExact * Largest(a)) << i;
        lit += Largest(a) > 0;
    }
    EXPECT_GT(lit, 400);
    EXPECT_EQ(ParseEntities(bsp.entities, "test").front().Value(kGridSHKey), "radiance");
}

TEST_F(OptionsTest, RadianceMarkGoesWithTheNextBake) {
    const SceneBuilder scene = MixedScene();
    const Bsp again = Lit(Lit(scene, "-shradiance"));
    EXPECT_FALSE(ParseEntities(again.entities, "test").front().Has(kGridSHKey));
}

TEST_F(OptionsTest, FaintLightsMayBeRepresentedByAFew) {
    SceneBuilder scene = Room({-1500, -1500, 0}, {1500, 1500, 300});
    for (int i = 0; i < 60; i++)
        scene.AddEntity(MakeEntity(
            "light", {{"origin", fmt::format("{} {} 150", i % 10 * 280 - 1250, i / 10 * 450 - 1150)}, {"light", "2"}}));
    const GridView plain = LitGrid(scene, "-gridsh 100 100 100");
    EXPECT_GT(result.gridSH.skippedFaint, 0u);
    const GridView all = LitGrid(scene, "-gridsh 100 100 100 -noskip");
    EXPECT_EQ(result.gridSH.skippedFaint, 0u);
    ASSERT_EQ(plain.Count(), all.Count());
    double worst = 0, sum = 0;
    for (std::size_t i = 0; i < all.Count(); i++)
        for (const Vec3d &normal : Normals()) {
            const double off = (Evaluate(plain.At(i), normal) - Evaluate(all.At(i), normal)).x * 255;
            worst = std::max(worst, std::abs(off));
            sum += off;
        }
    EXPECT_GT(worst, 0);
    EXPECT_LE(worst, kSkipBound);
    EXPECT_LE(std::abs(sum / double(all.Count() * Normals().size())), kSkipBound / 16) << "the mean stays";
}

TEST_F(OptionsTest, SkipsChangeLessThanTheirBoundAmongOccluders) {
    const SceneBuilder scene = MixedScene();
    const GridView plain = LitGrid(scene), all = LitGrid(scene, "-noskip");
    for (std::size_t i = 0; i < all.Count(); i++)
        for (const Vec3d &normal : Normals()) {
            const Vec3d off = Evaluate(all.At(i), normal) - Evaluate(plain.At(i), normal);
            ASSERT_LE(std::max(std::abs(off.x), std::max(std::abs(off.y), std::abs(off.z))) * 255, 1.0 / 8 * 17 / 16)
                << i;
        }
}

/// 16 by 16 lights that give a fraction of a byte each.
SceneBuilder ManyDimLights() {
    SceneBuilder scene = Room();
    for (int i = 0; i < 256; i++)
        scene.AddEntity(MakeEntity(
            "light", {{"origin", fmt::format("{} {} 170", i % 16 * 18 - 135, i / 16 * 14 - 105)}, {"light", "2"}}));
    return scene;
}

TEST_F(OptionsTest, FastTakesFewOfManyDimLightsAndKeepsTheirLight) {
    const SceneBuilder scene = ManyDimLights();
    const GridView all = LitGrid(scene);
    const std::uint64_t rays = result.gridSH.counts.rays;
    const GridView fast = LitGrid(scene, "-fast");
    EXPECT_LT(result.gridSH.counts.rays, rays / 3);
    // A light of g bytes is taken with a probability p >= g / kChoice, as g / p: a variance of at most kChoice g. So
    // the light of a point, L bytes of many lights, has one of at most kChoice L. Of one direction, a normal facing it
    // gets four times the mean over all normals, and no normal gets more from any light.
    constexpr double kChoice = 4; // bytes of faint light that one taken light stands for: 1/4 over 1/16, the samples
    double sumAll = 0, sumFast = 0, squares = 0;
    for (std::size_t i = 0; i < all.Count(); i++) {
        if (!Inside(all.Position(i), RoomBounds()))
            continue;
        const double one = 255 * Evaluate(all.At(i), {0, 0, 1}).x, other = 255 * Evaluate(fast.At(i), {0, 0, 1}).x;
        const double light = 4 * 255 * kSHC0 * (all.At(i)[0].x);
        sumAll += light, sumFast += 4 * 255 * kSHC0 * (fast.At(i)[0].x);
        squares += (one - other) * (one - other);
        EXPECT_LE(std::abs(one - other), 4 * std::sqrt(kChoice * light)) << "four standard deviations, point " << i;
    }
    EXPECT_LE(squares, kChoice * sumAll) << "the variance of all points";
    EXPECT_NEAR(sumFast / sumAll, 1, 0.01);
}

TEST_F(OptionsTest, FastKeepsFewLightsAsTheyAre) {
    SceneBuilder scene = Room();
    scene.AddEntity(MakeEntity("light", {{"origin", "5 -7 170"}, {"light", "60"}}));
    scene.AddEntity(MakeEntity("light", {{"origin", "150 90 30"}, {"light", "3"}}));
    const GridView fast = LitGrid(scene, "-fast");
    ExpectPoints(fast, kExact, 400, [&](const Vec3d &p, Coefficients &c) {
        c = FromPoint(p, {5, -7, 170}, 60) + FromPoint(p, {150, 90, 30}, 3);
        return Inside(p, RoomBounds());
    });
}

TEST_F(OptionsTest, SunOnlyLeavesTheSunAlone) {
    const SceneBuilder scene = MixedScene();
    const GridView sun = LitGrid(scene, "-sunonly -notrace");
    const double a = 120 * std::numbers::pi / 180, e = 60 * std::numbers::pi / 180;
    ExpectPoints(sun, kExact, 400, [&](const Vec3d &p, Coefficients &c) {
        c = FromDirection({std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)},
                          Vec3d{1, 0.9, 0.7} * (150.0 / 255));
        return InTheOpen(p);
    });
}

TEST_F(OptionsTest, NoTraceHasNoShadows) {
    SceneBuilder scene = Room();
    scene.AddBox({-20, -186, 4}, {-10, 186, 200}, TestShader("textures/test/wall"));
    scene.AddEntity(MakeEntity("light", {{"origin", "100 0 60"}, {"light", "200"}}));
    ExpectPoints(LitGrid(scene, "-notrace"), kExact, 400, [](const Vec3d &p, Coefficients &c) {
        c = FromPoint(p, {100, 0, 60}, 200);
        return Inside(p, RoomBounds()) && !Inside(p, {{-20, -186, 4}, {-10, 186, 200}}, -1);
    });
}

TEST_F(OptionsTest, NoSurfLeavesSolidsAsTheOnlyBlockers) {
    SceneBuilder scene = Room();
    scene.AddBox({-20, -186, 4}, {-10, 186, 200}, TestShader("textures/test/wall"), BoxKind::Detail);
    scene.AddBox({-120, -186, 4}, {-110, 186, 252}, TestShader("textures/test/wall"));
    scene.AddEntity(MakeEntity("light", {{"origin", "100 0 60"}, {"light", "200"}}));
    ExpectPoints(LitGrid(scene, "-nosurf"), kExact, 400, [](const Vec3d &p, Coefficients &c) {
        if (p.x > -109)
            c = FromPoint(p, {100, 0, 60}, 200);
        return Inside(p, RoomBounds()) && (p.x < -121 || p.x > -109) && (p.x < -21 || p.x > -9);
    });
}

TEST_F(OptionsTest, FloodlightIsFiniteAndPositiveAndBrighterInTheOpen) {
    SceneBuilder scene = Room();
    const GridView grid = LitGrid(scene, "-floodlight");
    int open = 0;
    for (std::size_t i = 0; i < grid.Count(); i++) {
        ASSERT_TRUE(AllFinite(grid.At(i)));
        if (!Inside(grid.Position(i), RoomBounds()))
            continue;
        open++;
        for (const Vec3d &normal : Normals())
            ASSERT_GT(Evaluate(grid.At(i), normal).x, 0) << i;
    }
    EXPECT_GT(open, 400);
    const Vec3d up{0, 0, 1};
    EXPECT_GT(Evaluate(grid.Sample({0, 0, 64}), up).z, Evaluate(grid.Sample({0, 0, 192}), up).z);
}

TEST_F(OptionsTest, FloodlightKeyGivesItsColor) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_floodlight", "240 120 60 300 64");
    const GridView grid = LitGrid(scene);
    const Vec3d shown = grid.Sample({32, 32, 128})[0];
    EXPECT_NEAR(shown.y / shown.x, 0.5, 1e-5);
    EXPECT_NEAR(shown.z / shown.x, 0.25, 1e-5);
}

TEST_F(OptionsTest, CellSizes) {
    SceneBuilder scene = Room();
    const auto size = [&](std::string_view options) { return LitGrid(scene, options).Grid().header.gridSize; };
    EXPECT_EQ(size(""), (Float3{32, 32, 64}));
    EXPECT_EQ(size("-gridscalesh 1"), (Float3{64, 64, 128}));
    EXPECT_EQ(size("-gridscalesh 4"), (Float3{16, 16, 32}));
    EXPECT_EQ(size("-gridscalesh 1000"), (Float3{8, 8, 8}));
    EXPECT_EQ(size("-gridsh 24 24 48 -gridscalesh 4"), (Float3{24, 24, 48}));
    EXPECT_EQ(size("-gridsh 0.001 10.5 64"), (Float3{8, 10.5, 64}));
    scene.SetWorldKey("gridsize", "48 48 96");
    EXPECT_EQ(size(""), (Float3{24, 24, 48}));
    EXPECT_EQ(size("-gridsh 100 100 100"), (Float3{100, 100, 100}));
}

TEST_F(OptionsTest, LegacyGridIsTheSameWithAndWithoutSH) {
    const SceneBuilder scene = MixedScene();
    const auto bytes = [](const Bsp &bsp) {
        std::vector<std::uint8_t> all;
        for (const bspGridPoint_t &p : bsp.gridPoints) {
            all.insert(all.end(), p.ambient[0].begin(), p.ambient[0].end());
            all.insert(all.end(), p.directed[0].begin(), p.directed[0].end());
        }
        return all;
    };
    const Bsp coarse = Lit(scene), fine = Lit(scene, "-gridsh 20 20 20 -noskip");
    EXPECT_EQ(bytes(coarse), bytes(fine));
    EXPECT_GT(coarse.gridPoints.size(), 100u);
    Bsp without = scene.Build();
    without.gridPoints = {{{{1, 2, 3}}, {{4, 5, 6}}, kOnlyStyle0, {7, 8}}};
    const Bsp kept = Lit(without, "-nogrid");
    ASSERT_EQ(kept.gridPoints.size(), 1u) << "-nogrid leaves the legacy grid alone";
    EXPECT_EQ(GridView(kept).Grid().points.size(), GridView(coarse).Grid().points.size());
}

} // namespace

} // namespace q3::test
