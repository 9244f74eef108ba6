// GPL-2.0-or-later. SH grid: each thing that is skipped, its counter, its switch and what it costs.
#include "tests/support/light_fixture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <fmt/format.h>

namespace q3::test {

namespace {

class SkipTest : public LightTest {
  protected:
    /// A room with a square lamp of that half width, 24 units under the middle of its ceiling.
    SceneBuilder CeilingLamp(const Vec3f &mins, const Vec3f &maxs, float half, int value) {
        Script(fmt::format("textures/test/lamp\n{{\n\tq3map_surfacelight {}\n\tq3map_backsplash 0 0\n\t{{\n\t\tmap "
                           "$whiteimage\n\t}}\n}}\n",
                           value));
        SceneBuilder scene = Room(mins, maxs);
        const int box = scene.AddBox({-half, -half, maxs.z - 24}, {half, half, maxs.z - 8},
                                     TestShader("textures/test/wall"), BoxKind::Detail);
        scene.SetFaceShader(box, BoxFace::MinusZ, TestShader("textures/test/lamp"));
        return scene;
    }
};

/// Largest difference of displayed light over points and the six directions of the axes. Byte scale.
double LargestDifference(const GridView &a, const GridView &b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.Count(); ++i)
        for (const Vec3d normal : {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
            largest = std::max(largest, std::abs(Evaluate(a.At(i), normal).x - Evaluate(b.At(i), normal).x) * 255);
    return largest;
}

/// Two rooms with no opening between them, a light in each.
SceneBuilder TwoRooms() {
    SceneBuilder scene = Room({-500, -200, 0}, {500, 200, 200});
    scene.AddBox({-20, -200, 0}, {20, 200, 200}, TestShader("textures/test/wall"));
    scene.AddEntity(MakeEntity("light", {{"origin", "-250 0 100"}, {"light", "100"}}));
    scene.AddEntity(MakeEntity("light", {{"origin", "250 0 100"}, {"light", "100"}}));
    scene.SetVisibility({.writeLump = true, .sees = [](const Boundsf &from, const Boundsf &to) {
                             return (from.Center().x < 0) == (to.Center().x < 0);
                         }});
    return scene;
}

TEST_F(SkipTest, LightsOutOfReach) {
    SceneBuilder scene = Room({-1500, -200, 0}, {1500, 200, 200});
    // A linear light ends at a distance.
    scene.AddEntity(MakeEntity("light", {{"origin", "-1300 0 100"}, {"light", "300"}, {"spawnflags", "1"}}));
    const GridView skipped = LitGrid(scene);
    EXPECT_GT(result.gridSH.skippedReach, 0u);
    const GridView all = LitGrid(scene, "-noskipreach");
    EXPECT_EQ(result.gridSH.skippedReach, 0u);
    EXPECT_EQ(LargestDifference(skipped, all), 0);
}

TEST_F(SkipTest, LightsHiddenByVisibilityData) {
    // Bricks of 8 cells that end beside the wall between the rooms, and one across it. The box of what a light's
    // cluster sees, which would hide the other room too, counts as reach.
    constexpr const char *kSize = "-gridsh 40 40 40 -noskipreach";
    const SceneBuilder scene = TwoRooms();
    const GridView skipped = LitGrid(scene, kSize);
    EXPECT_GT(result.gridSH.skippedPvs, 0u) << "of bricks within a room";
    EXPECT_GT(result.gridSH.counts.skippedPvs, 0u) << "of points in bricks of both rooms";
    const std::uint64_t rays = result.gridSH.counts.rays;
    const GridView all = LitGrid(scene, std::string(kSize) + " -noskippvs");
    EXPECT_EQ(result.gridSH.skippedPvs + result.gridSH.counts.skippedPvs, 0u);
    EXPECT_LT(rays, result.gridSH.counts.rays);
    EXPECT_LE(LargestDifference(skipped, all), 1e-6);
}

TEST_F(SkipTest, FarLampsAsPoints) {
    const SceneBuilder scene = CeilingLamp({-900, -200, 0}, {900, 200, 300}, 8, 600);
    const GridView skipped = LitGrid(scene);
    EXPECT_GT(result.gridSH.counts.skippedMoments, 0u);
    const GridView all = LitGrid(scene, "-noskipmoments");
    EXPECT_EQ(result.gridSH.counts.skippedMoments, 0u);
    EXPECT_LE(LargestDifference(skipped, all), 2 * 17.0 / 16 / 256) << "1/256 of a byte for each of the two triangles";
}

TEST_F(SkipTest, FaintLampsByOneRay) {
    SceneBuilder scene = CeilingLamp({-600, -200, 0}, {600, 200, 300}, 16, 20);
    scene.AddBox({-100, -40, 100}, {-60, 40, 140}, TestShader("textures/test/wall"));
    const GridView skipped = LitGrid(scene);
    EXPECT_GT(result.gridSH.counts.skippedProbes, 0u);
    const std::uint64_t rays = result.gridSH.counts.rays;
    const GridView all = LitGrid(scene, "-noskipprobes");
    EXPECT_EQ(result.gridSH.counts.skippedProbes, 0u);
    EXPECT_LT(rays, result.gridSH.counts.rays);
    EXPECT_LE(LargestDifference(skipped, all), 2 * 0.5) << "half a byte for each of the two triangles";
}

TEST_F(SkipTest, DimLightsWhereNeighborsAgree) {
    SceneBuilder scene = Room({-600, -400, 0}, {600, 400, 300});
    scene.AddEntity(MakeEntity("light", {{"origin", "0 0 250"}, {"light", "2"}}));
    scene.AddBox({100, -60, 100}, {130, 60, 140}, TestShader("textures/test/wall"));
    const GridView skipped = LitGrid(scene, "-fastgrid -shsamples 1");
    EXPECT_GT(result.gridSH.counts.skippedCoarse, 0u);
    const std::uint64_t rays = result.gridSH.counts.rays;
    const GridView all = LitGrid(scene, "-fastgrid -shsamples 1 -noskipcoarse");
    EXPECT_EQ(result.gridSH.counts.skippedCoarse, 0u);
    EXPECT_LT(rays, result.gridSH.counts.rays);
    EXPECT_LE(LargestDifference(skipped, all), 17.0 / 16) << "a byte";
    LitGrid(scene);
    EXPECT_EQ(result.gridSH.counts.skippedCoarse, 0u) << "only of fast grids";
}

Vec3d InTheSun(int room) {
    return {-5120 + 512.0 * room + 448, -160, 128};
}

/// A hall of rooms along x, each with dim lamps and pillars; a lamp smaller than a cell in every tenth, walls with
/// slits between them. Many dim lights cast shadows everywhere. A sun shines through a hole of 8 by 8 units in the
/// ceiling of each room, on the grid point at InTheSun.
SceneBuilder RoomsOfDimLights() {
    SceneBuilder scene = Room({-5120, -512, 0}, {5120, 512, 256});
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/vec/sky_sun"));
    const SceneShader wall = TestShader("textures/test/wall");
    const float low = 244, high = 252;                         // of the ceiling below the sky
    const Vec3f hole = Vec3f(InTheSun(0)) + Vec3f{-35, 60, 0}; // 120 units up towards the sun
    for (int room = 0; room < 20; ++room) {
        const float x = -5120 + 512.0f * float(room);
        if (room > 0) { // a wall with a slit of 8 units
            scene.AddBox({x - 8, -512, 0}, {x + 8, -4, 256}, wall);
            scene.AddBox({x - 8, 4, 0}, {x + 8, 512, 256}, wall);
        }
        const float left = hole.x + 512 * float(room) - 4, near = hole.y - 4;
        scene.AddBox({x, -512, low}, {left, 512, high}, wall);
        scene.AddBox({left + 8, -512, low}, {x + 512, 512, high}, wall);
        scene.AddBox({left, -512, low}, {left + 8, near, high}, wall);
        scene.AddBox({left, near + 8, low}, {left + 8, 512, high}, wall);
        scene.AddBox({x + 200, 180, 0}, {x + 230, 210, 256}, wall, BoxKind::Detail);
        for (const int y : {-400, 400})
            scene.AddEntity(MakeEntity("light", {{"origin", fmt::format("{} {} 230", x + 128, y)}, {"light", "40"}}));
        if (room % 10 == 3)
            scene.AddEntity(MakeEntity("light", {{"origin", fmt::format("{} 17 61", x + 307)}, {"light", "2"}}));
    }
    return scene;
}

TEST_F(SkipTest, DimLightWhereItIsSmooth) {
    const SceneBuilder scene = RoomsOfDimLights();
    const GridView skipped = LitGrid(scene);
    EXPECT_GT(result.gridSH.skippedSmooth, skipped.Count() / 8);
    const std::uint64_t rays = result.gridSH.counts.rays;
    const GridView all = LitGrid(scene, "-noskipsmooth");
    EXPECT_EQ(result.gridSH.skippedSmooth, 0u);
    EXPECT_LT(rays, result.gridSH.counts.rays);
    const Vec3d toSun{-0.25, 0.433, 0.866}; // of sky_sun: 150 on surfaces that face it
    for (int room = 0; room < 20; ++room)
        for (const GridView *grid : {&skipped, &all})
            EXPECT_GT(255 * Evaluate(grid->Sample(InTheSun(room)), toSun).x, 120) << room;
    // At random places, also between points: 99.9 % within three times the tolerance of 1.5 bytes.
    std::mt19937 random(7);
    std::uniform_real_distribution<double> x(-5100, 5100), y(-480, 480), z(16, 228);
    std::vector<double> errors;
    for (int i = 0; i < 100000; ++i) {
        const Vec3d p{x(random), y(random), z(random)};
        const Coefficients a = skipped.Sample(p), b = all.Sample(p);
        double most = 0;
        for (const Vec3d &normal : Normals()) {
            const Vec3d la = Evaluate(a, normal), lb = Evaluate(b, normal);
            for (std::size_t c = 0; c < 3; ++c)
                most = std::max(most, std::abs(std::clamp(la[c], 0.0, 1.0) - std::clamp(lb[c], 0.0, 1.0)) * 255);
        }
        errors.push_back(most);
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LE(errors[errors.size() * 999 / 1000], 3 * 1.5) << "99.9 %";
    EXPECT_LE(errors[errors.size() / 2], 1.5) << "median";
}

TEST_F(SkipTest, SmoothLightIsTheSameForAnyNumberOfThreads) {
    const SceneBuilder scene = RoomsOfDimLights();
    const GridView one(Lit(scene, "", 1)), five(Lit(scene, "", 5));
    EXPECT_GT(result.gridSH.skippedSmooth, 0u);
    ASSERT_EQ(one.Count(), five.Count());
    EXPECT_EQ(std::memcmp(one.Grid().points.data(), five.Grid().points.data(), one.Count() * sizeof(bspGridPointSH_t)),
              0);
}

TEST_F(SkipTest, SwitchForAllTurnsEachOff) {
    LitGrid(TwoRooms(), "-noskip");
    const GridStats &work = result.gridSH;
    EXPECT_EQ(work.skippedReach + work.skippedPvs + work.skippedFaint + work.counts.skippedPvs +
                  work.counts.skippedFaint + work.counts.skippedMoments + work.counts.skippedProbes +
                  work.counts.skippedCoarse + work.skippedSmooth,
              0u);
}

} // namespace

} // namespace q3::test
