// GPL-2.0-or-later. Causes of errors in scenes where they are known.
#include "tests/tools/shbench/bench_fixture.h"
#include "tools/measure/shbench/causes.h"
#include "tools/measure/shbench/cell_sight.h"
#include "tools/measure/shbench/plain.h"

#include <cmath>

namespace q3::test {

namespace {

using namespace bench;

/// Points every 64 units through the room.
constexpr bspGridSHHeader_t kGrid = {{-512, -512, -512}, {64, 64, 64}, {17, 17, 17}, 17 * 17 * 17};
constexpr GridLayout kLayout = {kGrid.gridMins, kGrid.gridSize, kGrid.gridBounds};

class CausesTest : public BenchTest {
  protected:
    static TruthPoint TruthOf(const BenchMap &map, const Vec3f &position) {
        std::uint64_t rays = 0;
        return TruthAt(map, position, 1, 0.02, rays);
    }
    /// Of a grid that has the exact light at its points in the open, and nothing in solid.
    static Cause CauseAt(const BenchMap &map, const Vec3f &position) {
        const Baked baked = BakeBaseline(map, kGrid, JobPool(1));
        return CauseOf(map, position, ShownBy(BakedFormat::GridSH, baked.bsp)(position));
    }
    static Cause CauseOf(const BenchMap &map, const Vec3f &position, const NormalLight &shown) {
        const TruthPoint point = TruthOf(map, position);
        return FindCause(map, kLayout, point, ErrorsAt(point, shown, ProjectedLight(point)));
    }
    /// Of a grid that shows everything 25.5 bytes too bright.
    static Cause CauseOfOffset(const BenchMap &map, const Vec3f &position) {
        NormalLight shown = ProjectedLight(TruthOf(map, position));
        for (Vec3f &light : shown)
            light += {0.1f, 0.1f, 0.1f};
        return CauseOf(map, position, shown);
    }
};

TEST_F(CausesTest, OneFarLightErrsByItsProjectionAlone) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({-400, 0, 0}, 1000));
    EXPECT_EQ(CauseAt(*Map(scene), {400, 8, 8}), Cause::Floor);
}

TEST_F(CausesTest, AShadowEdgeInTheCell) {
    // The slab's edge at x = 20 casts its shadow to x = 40 or so at this height: one row of corners is lit.
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({0, 0, 400}, 600));
    scene.AddBox({-512, -512, 100}, {20, 512, 110}, {"textures/test/wall"});
    const auto map = Map(scene);
    EXPECT_EQ(CauseAt(*map, {16, 16, -208}), Cause::ShadowEdge);
    // With the light shown as the corners have it, a uniform offset is nothing that shadows could make.
    EXPECT_EQ(CauseOfOffset(*map, {-300, 16, -208}), Cause::Interpolation);
}

TEST_F(CausesTest, APointLightBesideThePosition) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({10, 40, 20}, 30));
    EXPECT_EQ(CauseAt(*Map(scene), {30, 20, 40}), Cause::NearLight);
}

TEST_F(CausesTest, ALampWhosePlaneRunsThroughTheCell) {
    // It faces down; the upper corners get nothing from it, though nothing hides it.
    SceneBuilder scene = Room();
    scene.AddQuad({{{-64, -64, 170}, {64, -64, 170}, {64, 64, 170}, {-64, 64, 170}}}, {"textures/test/lamp"});
    const auto map = Map(scene, "",
                         "textures/test/lamp\n{\n\tq3map_surfacelight 100\n\tq3map_lightRGB 1 1 1\n"
                         "\tq3map_backsplash 0 0\n}\n");
    EXPECT_EQ(CauseAt(*map, {130, 20, 160}), Cause::NearLight);
}

TEST_F(CausesTest, CornersInSolid) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", "100");
    scene.AddBox({100, -512, -512}, {512, 512, 512}, {"textures/test/wall"});
    const auto map = Map(scene);
    EXPECT_EQ(CauseAt(*map, {80, 10, 10}), Cause::Wall);
    EXPECT_EQ(CauseOfOffset(*map, {40, 10, 10}), Cause::Interpolation);
}

TEST_F(CausesTest, CornersBehindAThinWall) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", "100");
    scene.AddBox({100, -512, -512}, {104, 512, 512}, {"textures/test/wall"}, BoxKind::Detail);
    const auto map = Map(scene);
    EXPECT_EQ(CauseOfOffset(*map, {80, 10, 10}), Cause::Wall);
    EXPECT_EQ(CauseOfOffset(*map, {40, 10, 10}), Cause::Interpolation);
}

TEST_F(CausesTest, WeightsAreTrilinearOverTheCornersThatThePositionSees) {
    SceneBuilder scene = Room();
    scene.AddBox({100, -512, -512}, {104, 512, 512}, {"textures/test/wall"}, BoxKind::Detail);
    const auto map = Map(scene);
    const CellSight open(*map, kLayout, {16, 32, 48});
    EXPECT_FALSE(open.AnyHidden());
    EXPECT_EQ(open.Receivers()[0], (Vec3f{0, 0, 0}));
    EXPECT_EQ(open.Receivers()[7], (Vec3f{64, 64, 64}));
    EXPECT_NEAR(open.Weights()[0], 0.75 * 0.5 * 0.25, 1e-6);
    EXPECT_NEAR(open.Weights()[5], 0.25 * 0.5 * 0.75, 1e-6);
    const CellSight beside(*map, kLayout, {80, 32, 48}); // x = 128 is behind the wall
    EXPECT_TRUE(beside.AnyHidden());
    EXPECT_NEAR(beside.Weights()[0], 0.5 * 0.25, 1e-6);
    EXPECT_EQ(beside.Weights()[1], 0);
    const CellSight between(*map, kLayout, {102, 32, 48}); // in the wall: sees no corner
    EXPECT_TRUE(between.AnyHidden());
    for (const double weight : between.Weights())
        EXPECT_EQ(weight, 0);
}

TEST_F(CausesTest, AShareOfALampIsThatOfItsAreaInSight) {
    SceneBuilder scene = Room();
    scene.AddQuad({{{-64, -64, 200}, {64, -64, 200}, {64, 64, 200}, {-64, 64, 200}}}, {"textures/test/lamp"});
    scene.AddBox({0, -400, 196}, {400, 400, 199}, {"textures/test/wall"}, BoxKind::Detail); // under its half x > 0
    const auto map = Map(scene, "",
                         "textures/test/lamp\n{\n\tq3map_surfacelight 100\n\tq3map_lightRGB 1 1 1\n"
                         "\tq3map_backsplash 0 0\n}\n");
    const CellSight sight(*map, kLayout, {-32, 32, -300});
    double seen = 0, area = 0;
    for (const Light &light : map->lights) {
        seen += sight.Seen(light, 64)[CellSight::kSelf].x * double(light.shape.area);
        area += double(light.shape.area);
    }
    ASSERT_NEAR(area, 128.0 * 128, 1);
    EXPECT_NEAR(seen / area, 0.5, 0.05);
}

TEST_F(CausesTest, UnshadowedLightIsTheReferenceWhereNothingHides) {
    SceneBuilder scene = Room();
    scene.AddQuad({{{-64, -64, 200}, {64, -64, 200}, {64, 64, 200}, {-64, 64, 200}}}, {"textures/test/lamp"});
    scene.AddEntity(PointLight({-100, 60, 100}, 200));
    const auto map = Map(scene, "",
                         "textures/test/lamp\n{\n\tq3map_surfacelight 100\n\tq3map_lightRGB 1 1 1\n"
                         "\tq3map_backsplash 0 0\n}\n");
    const Vec3f p{20, -30, 70};
    SHVector sum{};
    for (const Light &light : map->lights)
        for (std::size_t k = 0; k < 9; ++k)
            sum[k] += UnshadowedLight(light, Vec3d(p))[k] / 255;
    const TruthPoint truth = TruthOf(*map, p);
    for (std::size_t k = 0; k < 9; ++k)
        EXPECT_NEAR(sum[k], double(truth.projection[k].x), 0.002) << k;
}

TEST(CellsToLight, CountsEachAxisInItsOwnCells) {
    Light point;
    point.origin = {32, 0, 128};
    EXPECT_NEAR(CellsToLight(point, {0, 0, 0}, {32, 32, 64}), std::sqrt(5.0), 1e-6);
    Light area;
    area.type = LightType::Area;
    area.polygon = {{-100, -100, 64}, {-100, 100, 64}, {100, 100, 64}, {100, -100, 64}};
    area.SetShape();
    EXPECT_NEAR(CellsToLight(area, {40, 20, 0}, {32, 32, 64}), 1, 1e-6);  // straight under it
    EXPECT_NEAR(CellsToLight(area, {132, 0, 64}, {32, 32, 64}), 1, 1e-6); // beside its edge
    Light sun;
    sun.type = LightType::Sun;
    EXPECT_TRUE(std::isinf(CellsToLight(sun, {0, 0, 0}, {32, 32, 64})));
}

TEST(Shares, AreOfTheSquaredGridError) {
    const std::vector<Cause> causes = {Cause::Wall, Cause::NearLight, Cause::Wall, Cause::Floor};
    const std::vector<PositionErrors> errors = {{0, 0, 1}, {0, 0, 3}, {0, 0, 2}, {9, 9, 0}};
    const auto shares = SharesByCause(causes, errors);
    EXPECT_DOUBLE_EQ(shares[std::size_t(Cause::Wall)].positions, 0.5);
    EXPECT_DOUBLE_EQ(shares[std::size_t(Cause::Wall)].error, 5.0 / 14);
    EXPECT_DOUBLE_EQ(shares[std::size_t(Cause::NearLight)].error, 9.0 / 14);
    EXPECT_DOUBLE_EQ(shares[std::size_t(Cause::Floor)].error, 0);
    for (const CauseShare &share : SharesByCause({}, {}))
        EXPECT_EQ(share.error + share.positions, 0);
}

} // namespace

} // namespace q3::test
