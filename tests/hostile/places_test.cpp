// GPL-2.0-or-later. Lights and lamps in awkward receivers: far from the origin, on points and planes, in walls, many in
// one spot.
#include "tests/hostile/stress_fixture.h"

#include <cmath>

namespace q3::test {

namespace {

using PlacesTest = StressTest;

constexpr double kAdd = 300;

std::string Text(const Vec3f &v) {
    return fmt::format("{} {} {}", v.x, v.y, v.z);
}

Vec3d Farther(const Vec3f &by, const Vec3d &p) {
    return Vec3d(by) + p;
}

TEST_F(PlacesTest, RoomsAtTheEdgesOfTheWorldAreLitAsAtItsOrigin) {
    LampShader("textures/test/lamp", kAdd);
    std::vector<Coefficients> atOrigin;
    // Multiples of the cell; the walls end at 65522.
    for (const Vec3f &by : {Vec3f{}, {65216, 65216, 65216}, {-65216, 65216, -65216}, {0, -65216, 64}}) {
        SCOPED_TRACE(Text(by));
        const Boundsf room{by + Vec3f{-250, -186, 4}, by + Vec3f{250, 186, 252}};
        SceneBuilder scene = Room(room.mins, room.maxs);
        scene.AddEntity(PointLight(Text(by + Vec3f{10, 20, 100})));
        const float z = by.z + 200;
        scene.AddQuad({{{by.x - 64, by.y - 32, z},
                        {by.x + 64, by.y - 32, z},
                        {by.x + 64, by.y + 32, z},
                        {by.x - 64, by.y + 32, z}}},
                      TestShader("textures/test/lamp"));
        const Bsp lit = LitSoundly(scene, "-gridsh 64 64 64 -shbudget 0.1");
        ExpectPoints(GridView(lit), 3e-5, 60, [&](const Vec3d &p, Coefficients &c) {
            // Above the lamp is its shadow.
            if (!Inside(p, room) || p.z > double(z) - 1)
                return false;
            c = FromPoint(p, Farther(by, {10, 20, 100}), 300) +
                FromRectangle(p, Farther(by, {-64, -32, 200}), {128, 0, 0}, {0, 64, 0}, {0, 0, -1}, kAdd, {1, 1, 1});
            return true;
        });
        const SparseView sparse(*lit.sparseGridSH);
        std::vector<Coefficients> samples;
        for (double x = -245; x < 250; x += 35)
            for (double y = -181; y < 186; y += 35)
                samples.push_back(sparse.Sample(Farther(by, {x, y, 90})));
        if (atOrigin.empty())
            atOrigin = samples;
        for (std::size_t i = 0; i < samples.size(); i++)
            EXPECT_LE(Difference(samples[i], atOrigin[i]), 0.05 * Largest(atOrigin[i])) << i;
    }
}

TEST_F(PlacesTest, RoomAsLargeAsTheWorld) {
    SceneBuilder scene = Room({-65520, -65520, -65520}, {65520, 65520, 65520});
    scene.SetWorldKey("gridsize", "16384 16384 16384");
    scene.AddEntity(PointLight("0 0 0", "1e6"));
    scene.AddEntity(PointLight("65519 65519 -65519", "1e6"));
    // Rays of 113000 units into the very corners.
    ExpectPoints(GridView(LitSoundly(scene, "-gridsh 8192 8192 16384 -shadaptive")), 1e-4, 1500,
                 [](const Vec3d &p, Coefficients &c) {
                     c = FromPoint(p, {0, 0, 0}, 1e6) + FromPoint(p, {65519, 65519, -65519}, 1e6);
                     return Inside(p, {{-65520, -65520, -65520}, {65520, 65520, 65520}});
                 });
}

TEST_F(PlacesTest, LightsOnGridPointsAndPlanes) {
    // On a point, on the edge of a cell, on its face, and all of them together at once.
    const Vec3d receivers[] = {{64, 64, 64}, {64, 64, 96}, {64, 96, 96}, {0, 0, 128}};
    SceneBuilder scene = Room();
    for (const Vec3d &at : receivers)
        scene.AddEntity(PointLight(fmt::format("{} {} {}", at.x, at.y, at.z)));
    ExpectPoints(GridView(LitSoundly(scene)), kExact, 60, [&](const Vec3d &p, Coefficients &c) {
        for (const Vec3d &at : receivers)
            c = c + FromPoint(p, at, 300);
        return Inside(p, RoomBounds());
    });
}

TEST_F(PlacesTest, LightsInSolidsGiveNothing) {
    SceneBuilder scene = Room();
    scene.AddBox({-250, -186, 4}, {-120, -60, 252}, TestShader("textures/test/wall"));
    scene.AddBox({60, 60, 100}, {140, 140, 180}, TestShader("textures/test/wall"), BoxKind::Detail);
    // In the pillar, in the detail box, in a wall, outside the map, beyond the world.
    for (const char *origin :
         {"-200 -120 100", "100 100 140", "258 0 100", "600 0 100", "0 0 -5000", "65536 65536 65536", "1e9 0 0"})
        scene.AddEntity(PointLight(origin, "1e6"));
    const GridView grid(LitSoundly(scene, kBothGrids));
    for (std::size_t i = 0; i < grid.Count(); i++)
        ASSERT_EQ(Largest(grid.At(i)), 0) << i;
}

TEST_F(PlacesTest, LightsOnWallsAndCornersStaySound) {
    SceneBuilder scene = Room();
    scene.AddBox({0, 0, 4}, {64, 64, 128}, TestShader("textures/test/wall"));
    for (const char *origin : {"250 0 100", "250 186 252", "-250 -186 4", "0 0 64", "64 64 128", "32 32 128",
                               "249.999 0 100", "250.001 0 100", "0 0 4", "64.0001 64 128.00001"})
        scene.AddEntity(PointLight(origin));
    LitSoundly(scene, kBothGrids);
    LitSoundly(scene, "-gridsh 64 64 64 -noskip");
}

/// A lamp in the plane x = 0 through grid points: its corners, edges, middle and outside are points.
SceneBuilder LampOnPoints(std::string_view shader) {
    SceneBuilder scene = Room();
    scene.AddQuad({{{0, -64, 64}, {0, -64, 192}, {0, 64, 192}, {0, 64, 64}}}, TestShader(shader));
    return scene;
}

TEST_F(PlacesTest, LampGivesNothingInItsOwnPlane) {
    LampShader("textures/test/one", kAdd);
    LampShader("textures/test/two", kAdd, "cull none");
    for (const char *shader : {"textures/test/one", "textures/test/two"})
        for (const char *options : {"-gridsh 64 64 64 -noshfill", "-gridsh 64 64 64 -noshfill -noskip"}) {
            int inPlane = 0, lit = 0;
            const GridView grid(LitSoundly(LampOnPoints(shader), options));
            for (std::size_t i = 0; i < grid.Count(); i++) {
                if (!Inside(grid.Position(i), RoomBounds()))
                    continue;
                lit += Largest(grid.At(i)) > 0.01;
                if (grid.Position(i).x == 0) {
                    inPlane++;
                    ASSERT_EQ(Largest(grid.At(i)), 0);
                }
            }
            EXPECT_GE(inPlane, 15);
            EXPECT_GE(lit, 40);
        }
}

TEST_F(PlacesTest, LampSeenFromJustOffItsPlane) {
    LampShader("textures/test/two", kAdd, "cull none");
    // The plane of the lamp is this far from a layer of points.
    for (const float off : {1.0f / 32, 0.25f, 1.0f, 4.0f}) {
        SceneBuilder scene = Room();
        scene.AddQuad({{{off, -64, 64}, {off, -64, 192}, {off, 64, 192}, {off, 64, 64}}},
                      TestShader("textures/test/two"));
        ExpectPoints(GridView(LitSoundly(scene)), 1e-4, 40, [&](const Vec3d &p, Coefficients &c) {
            // Straight at the rim half of the lamp is at grazing angle: seen by its plane's side all the same.
            const double side = p.x < double(off) ? -1 : 1;
            c = FromRectangle(p, {double(off), -64, 64}, {0, 128, 0}, {0, 0, 128}, {side, 0, 0}, kAdd, {1, 1, 1});
            return Inside(p, RoomBounds());
        });
    }
}

TEST_F(PlacesTest, NeedlesAndSlivers) {
    LampShader("textures/test/lamp", 30000);
    // Down to 1 square unit, the smallest lamp that counts, on 1/100 unit.
    for (const float width : {0.01f, 0.1f, 1.0f}) {
        SCOPED_TRACE(width);
        SceneBuilder scene = Room();
        scene.AddQuad({{{-100, -width, 200}, {100, -width, 200}, {100, width, 200}, {-100, width, 200}}},
                      TestShader("textures/test/lamp"));
        // Rounding of the width and of the lamp's reach in float.
        ExpectPoints(GridView(LitSoundly(scene)), 2e-3, 40, [&](const Vec3d &p, Coefficients &c) {
            if (!Inside(p, RoomBounds()) || p.z > 190)
                return false;
            c = FromRectangle(p, {-100, -double(width), 200}, {200, 0, 0}, {0, 2 * double(width), 0}, {0, 0, -1}, 30000,
                              {1, 1, 1});
            return true;
        });
    }
    // Without area: nothing, and no harm.
    SceneBuilder scene = Room();
    for (const float z : {64.0f, 65.0f}) {
        scene.AddQuad({{{0, 0, z}, {0, 0, z}, {0, 0, z}, {0, 0, z}}}, TestShader("textures/test/lamp"));
        scene.AddQuad({{{-64, 0, z}, {64, 0, z}, {64, 0, z}, {-64, 0, z}}}, TestShader("textures/test/lamp"));
        scene.AddQuad({{{-64, 0, z}, {64, 0, z}, {64, 1e-30f, z}, {-64, 1e-30f, z}}}, TestShader("textures/test/lamp"));
        scene.AddQuad({{{-64, 0, z}, {64, 0, z}, {-64, 0, z}, {64, 0, z}}}, TestShader("textures/test/lamp"));
    }
    const GridView grid(LitSoundly(scene));
    for (std::size_t i = 0; i < grid.Count(); i++)
        ASSERT_EQ(Largest(grid.At(i)), 0);
}

TEST_F(PlacesTest, ThousandsOfLightsInOneSpot) {
    constexpr int kLights = 5000;
    SceneBuilder one = Room(), many = Room(), none = Room();
    const Entity light = PointLight("10 20 100", "100");
    one.AddEntity(light);
    for (int i = 0; i < kLights; i++)
        many.AddEntity(light);
    const GridView single(Lit(one, "-gridsh 64 64 64"));
    const std::uint64_t rays = result.gridSH.counts.rays;
    EXPECT_GT(rays, 0u);
    const GridView all(LitSoundly(many));
    EXPECT_LE(result.gridSH.counts.rays, rays * kLights);
    int lit = 0;
    // In the open. What points in walls take from their neighbors depends on how bright those are.
    for (std::size_t i = 0; i < all.Count(); i++) {
        if (!Inside(all.Position(i), RoomBounds()))
            continue;
        lit++;
        ASSERT_LE(Difference(all.At(i), single.At(i) * Vec3d{kLights, kLights, kLights}), kExact * Largest(all.At(i)))
            << i;
    }
    EXPECT_GE(lit, 60);
}

TEST_F(PlacesTest, LightAndAsMuchDarknessLeaveNothing) {
    SceneBuilder scene = Room();
    for (int i = 0; i < 200; i++) {
        scene.AddEntity(PointLight("10 20 100", "1000"));
        scene.AddEntity(PointLight("10 20 100", "-1000"));
    }
    const Bsp lit = LitSoundly(scene, kBothGrids);
    const GridView grid(lit);
    for (std::size_t i = 0; i < grid.Count(); i++)
        ASSERT_LE(Largest(grid.At(i)), 1e-4);
    for (const SparseGridPoint &point : lit.sparseGridSH->points)
        ASSERT_EQ(point.mean & 0x7ffffff, 0u);
}

TEST_F(PlacesTest, LightsBelowZeroLeaveNoLightBelowZero) {
    const auto room = [](std::initializer_list<Entity> lights) {
        SceneBuilder scene = Room();
        for (const Entity &light : lights)
            scene.AddEntity(light);
        return scene;
    };
    const Entity light = PointLight("10 20 100"), near = PointLight("60 20 100", "-300"),
                 strong = PointLight("-100 -100 60", "-5000");
    for (const std::string_view options : {"-gridsh 64 64 64 -shadaptive", "-gridsh 64 64 64 -shadaptive -shdering"}) {
        LitSoundly(room({near}), options);
        LitSoundly(room({light, near}), options);
        LitSoundly(room({light, near, strong}), options);
    }
}

TEST_F(PlacesTest, ThousandsOfLampsInOneSpot) {
    LampShader("textures/test/lamp", kAdd);
    constexpr int kLamps = 2000;
    const auto room = [&](int lamps) {
        SceneBuilder scene = Room();
        for (int i = 0; i < lamps; i++)
            scene.AddQuad({{{-64, -32, 236}, {64, -32, 236}, {64, 32, 236}, {-64, 32, 236}}},
                          TestShader("textures/test/lamp"));
        return scene;
    };
    const GridView single(Lit(room(1), "-gridsh 128 128 128"));
    const std::uint64_t rays = result.gridSH.counts.rays;
    const GridView all(Lit(room(kLamps), "-gridsh 128 128 128"));
    EXPECT_LE(result.gridSH.counts.rays, rays * kLamps);
    int lit = 0;
    for (std::size_t i = 0; i < all.Count(); i++) {
        if (!Inside(all.Position(i), RoomBounds()))
            continue;
        lit++;
        ASSERT_LE(Difference(all.At(i), single.At(i) * Vec3d{kLamps, kLamps, kLamps}), 1e-4 * Largest(all.At(i)));
    }
    EXPECT_GE(lit, 5);
}

TEST_F(PlacesTest, LampAsLargeAsTheWorldIsCutIntoAFewThousand) {
    LampShader("textures/test/lamp", kAdd, "q3map_lightSubdivide 1");
    SceneBuilder scene = Room({-2048, -2048, 0}, {2048, 2048, 512});
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/test/lamp"));
    Lit(scene, "-gridsh 2048 2048 256 -nogrid");
    EXPECT_TRUE(Printed("WARNING: textures/test/lamp: q3map_lightSubdivide")) << printed;
}

} // namespace

} // namespace q3::test
