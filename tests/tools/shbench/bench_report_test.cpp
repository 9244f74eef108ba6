// GPL-2.0-or-later. Errors, reports and charts.
#include "tests/tools/shbench/bench_fixture.h"
#include "tools/measure/shbench/bench_run.h"
#include "tools/measure/shbench/embree_throughput.h"
#include "tools/measure/shbench/plain.h"
#include "tools/measure/shbench/scaling.h"

#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace q3::test {

namespace {

using namespace bench;

constexpr double kY0 = 0.28209479177387814;

/// A position where the same light comes from everywhere.
TruthPoint Uniform(const Vec3f &position, float light) {
    TruthPoint point;
    point.position = position;
    point.light.fill({light, light, light});
    point.projection.fill({});
    point.projection[0] = Vec3f{light, light, light} / float(kY0);
    return point;
}

ShownLight Always(float light) {
    return [light](const Vec3f &) {
        NormalLight shown;
        shown.fill({light, light, light});
        return shown;
    };
}

TEST(Errors, AGridOfConstantLightHasNone) {
    Bsp bsp;
    LightGridSH grid;
    grid.header = {{0, 0, 0}, {32, 32, 64}, {3, 3, 2}, 18};
    grid.points.resize(18);
    for (bspGridPointSH_t &point : grid.points)
        point.coeffs[0] = {float(0.25 / kY0), float(0.25 / kY0), float(0.25 / kY0)};
    bsp.gridSH = grid;
    Truth truth;
    for (const Vec3f &p : {Vec3f{1, 2, 3}, Vec3f{33, 60, 50}, Vec3f{64, 64, 64}})
        truth.points.push_back(Uniform(p, 0.25f));
    const ShownErrors errors = MeasureErrors(truth, ShownBy(BakedFormat::GridSH, bsp));
    EXPECT_NEAR(errors.rmse, 0, 1e-4);
    EXPECT_NEAR(errors.percentile99, 0, 1e-4);
    EXPECT_NEAR(errors.grid, 0, 1e-4);
    EXPECT_NEAR(errors.relative, 0, 1e-6);
    EXPECT_EQ(errors.leak, 0);
    EXPECT_NEAR(FloorError(truth), 0, 1e-4);
}

TEST(Errors, AreMeasuredOnWhatAScreenShows) {
    Truth truth;
    truth.points = {Uniform({}, 0.5f), Uniform({}, 3)};
    const ShownErrors errors = MeasureErrors(truth, Always(1.5f));
    EXPECT_NEAR(errors.rmse, 127.5 / std::sqrt(2), 1e-3); // off by half of white at one, white at the other
    EXPECT_NEAR(errors.percentile95, 127.5, 1e-3);
    EXPECT_NEAR(errors.relative, std::sqrt((1 + 2.25) / (0.25 + 9)), 1e-6);
}

TEST(Errors, ALeakIsADarkPlaceShownLit) {
    Truth truth;
    truth.points = {Uniform({}, 0), Uniform({}, 0.5f), Uniform({}, 0.5f), Uniform({}, 1)}; // mean 0.5
    EXPECT_EQ(MeasureErrors(truth, Always(0.026f)).leak, 0.25);
    EXPECT_EQ(MeasureErrors(truth, Always(0.024f)).leak, 0);
    truth.points[0] = Uniform({}, 0.006f);
    EXPECT_EQ(MeasureErrors(truth, Always(0.026f)).leak, 0);
}

TEST(Errors, TheWorstPositionsComeFirst) {
    Truth truth;
    truth.points = {Uniform({1, 0, 0}, 0.4f), Uniform({2, 0, 0}, 0.9f), Uniform({3, 0, 0}, 0.5f)};
    const auto worst = WorstPositions(truth, Always(0.5f), 2);
    ASSERT_EQ(worst.size(), 2u);
    EXPECT_EQ(worst[0].point, 1u);
    EXPECT_EQ(worst[1].point, 0u);
    EXPECT_NEAR(worst[0].error, 0.4 * 255, 1e-3);
}

TEST(Errors, TheWorstAgainstTheProjectionAreWhereTheGridIsOff) {
    Truth truth;
    truth.points = {Uniform({1, 0, 0}, 0.9f), Uniform({2, 0, 0}, 0.4f)};
    truth.points[0].projection[0] = Vec3f{0.5f, 0.5f, 0.5f} / float(kY0); // what is shown is all that can be
    EXPECT_EQ(WorstPositions(truth, Always(0.5f), 1)[0].point, 0u);
    EXPECT_EQ(WorstPositions(truth, Always(0.5f), 1, WorstBy::Projection)[0].point, 1u);
    const PositionErrors errors = ErrorsByPlace(truth, Always(0.5f))[0];
    EXPECT_NEAR(errors.shown, 0.4 * 255, 1e-3);
    EXPECT_NEAR(errors.floor, 0.4 * 255, 1e-3);
    EXPECT_NEAR(errors.grid, 0, 1e-3);
}

class RunTest : public BenchTest {};

TEST_F(RunTest, MeasuresEverySettingOfASmallRoom) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({40, 20, 100}, 300));
    scene.AddBox({-200, -40, -300}, {-120, 40, 200}, {"textures/test/wall"});
    const auto map = Map(scene);
    BenchSettings settings;
    settings.truth.positions = 200;
    settings.rawSeconds = 0.02;
    settings.worstCount = 3;
    settings.drawWorst = true;
    settings.bakes = {{"default", ""}, {"coarse", "-gridsh 128 128 128"}};
    Log silent(Log::Nowhere());
    const BenchResult result = RunBench(*map, Library(), settings, *FindGame("quake3"), JobPool(1), silent);
    const BenchReport &report = result.report;
    ASSERT_EQ(report.lines.size(), 5u);
    const BenchLine *fine = report.Line("default"), *coarse = report.Line("coarse"), *plain = report.Line("naive baseline"),
                    *legacy = report.Line("legacy grid"), *cubes = report.Line("ambient cubes");
    ASSERT_TRUE(fine && coarse && plain && legacy && cubes);
    EXPECT_EQ(report.rawRates.size(), 6u);
    EXPECT_EQ(fine->sharesOfRaw.size(), 1u);
    EXPECT_GT(fine->ShareOfRaw(), 0);
    EXPECT_GT(report.floor, 0);
    // Nothing in nine coefficients beats the floor by more than chance, and interpolation over larger cells errs more.
    EXPECT_GT(fine->errors.rmse, 0.9 * report.floor);
    EXPECT_GT(coarse->errors.grid, fine->errors.grid);
    EXPECT_GT(legacy->errors.rmse, 0);
    // A lamp in a room: cubes are wrong between the axes, but not black.
    EXPECT_GT(cubes->errors.rmse, fine->errors.rmse);
    EXPECT_LT(cubes->errors.relative, 1);
    EXPECT_GE(cubes->cost.bytes, 16 + 28 * cubes->cost.points);
    EXPECT_EQ(fine->cost.points, plain->cost.points);
    EXPECT_EQ(fine->cost.bytes, 40 + 108 * fine->cost.points);
    EXPECT_EQ(legacy->cost.bytes, 8 * legacy->cost.points);
    EXPECT_LE(plain->cost.rays, std::uint64_t(plain->cost.litPoints));
    EXPECT_GT(fine->cost.rays, 0u);
    EXPECT_THAT(result.worst, testing::HasSubstr("worst positions of default"));
    EXPECT_THAT(result.worst, testing::HasSubstr("squared grid error %"));
    ASSERT_TRUE(result.worstView);
    EXPECT_EQ(result.worstView->dots.size(), 200u);
    EXPECT_EQ(result.worstView->rings.size(), 3u);

    const auto json = nlohmann::json::parse(JsonText(report));
    EXPECT_EQ(json["settings"].size(), 5u);
    EXPECT_EQ(json["settings"][0]["name"], "default");
    EXPECT_EQ(json["settings"][0]["rays"], fine->cost.rays);
    EXPECT_DOUBLE_EQ(json["settings"][1]["timesFloor"], coarse->errors.rmse / report.floor);
    const std::string table = TableText(report);
    for (const char *text : {"of Embree", "x limit", "x naive", "coarse", "legacy grid", "ambient cubes"})
        EXPECT_THAT(table, testing::HasSubstr(text));
}

TEST_F(RunTest, MeasuresSparseGridsByTheirOwnPointsAndBytes) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({40, 20, 100}, 300));
    const auto map = Map(scene);
    BenchSettings settings;
    settings.truth.positions = 200;
    settings.measureRaw = settings.measureBaselines = false;
    settings.bakes = {{"default", ""}, {"rough", "-sherrortarget 4"}, {"fine", "-sherrortarget 1"}};
    Log silent(Log::Nowhere());
    const BenchReport report = RunBench(*map, Library(), settings, *FindGame("quake3"), JobPool(1), silent).report;
    const BenchLine *uniform = report.Line("default"), *rough = report.Line("rough"), *fine = report.Line("fine");
    ASSERT_TRUE(uniform && rough && fine);
    EXPECT_EQ(uniform->format, BakedFormat::GridSH);
    EXPECT_EQ(rough->format, BakedFormat::SparseGridSH);
    EXPECT_GT(rough->cost.points, 0);
    EXPECT_LT(rough->cost.points, fine->cost.points);
    EXPECT_GT(rough->cost.bytes, 28 * rough->cost.points); // a stored point has 28 bytes
    EXPECT_GT(rough->errors.grid, fine->errors.grid);
    EXPECT_LT(fine->errors.relative, 0.5);

    settings.worstCount = 1;
    settings.worstOf = "fine"; // its cells have several sizes
    EXPECT_THROW(RunBench(*map, Library(), settings, *FindGame("quake3"), JobPool(1), silent), std::exception);
}

BenchLine Line(std::string name, std::string options, BakedFormat format, std::int64_t bytes, double grid) {
    BenchLine line;
    line.name = std::move(name), line.options = std::move(options), line.format = format;
    line.cost.bytes = bytes;
    line.errors.grid = grid;
    return line;
}

TEST(Families, DifferInSizeAlone) {
    const auto family = [](const char *options, BakedFormat format = BakedFormat::GridSH) {
        return FamilyOf(Line("x", options, format, 1, 1));
    };
    EXPECT_EQ(family(""), "uniform");
    EXPECT_EQ(family("-gridscalesh 1.5"), "uniform");
    EXPECT_EQ(family("-gridsh 64 64 64"), "uniform");
    EXPECT_EQ(family("-gridsh 64 64 64 -shfit 24"), "uniform -shfit 24");
    EXPECT_EQ(family("-shfit 24 -GridScaleSH 3"), "uniform -shfit 24");
    EXPECT_EQ(family("-sherrortarget 1.5", BakedFormat::SparseGridSH), "sparse");
    EXPECT_EQ(family("-shadaptive -shbudget 2 -fast", BakedFormat::SparseGridSH), "sparse -fast");
}

TEST(SizeChart, JoinsFamiliesBySize) {
    BenchReport report;
    report.lines = {Line("default", "", BakedFormat::GridSH, 8'000'000, 2),
                    Line("fast", "-fast", BakedFormat::GridSH, 8'000'000, 3),
                    Line("coarse", "-gridscalesh 1", BakedFormat::GridSH, 1'000'000, 4),
                    Line("adaptive", "-sherrortarget 1", BakedFormat::SparseGridSH, 500'000, 1),
                    Line("naive baseline", "one ray per light and point", BakedFormat::GridSH, 8'000'000, 9),
                    Line("legacy grid", "no -sh", BakedFormat::LegacyGrid, 70'000, 9),
                    Line("cubes", "-ambientcubes", BakedFormat::AmbientCubes, 70'000, 9)};
    const Chart chart = SizeChart(report);
    ASSERT_EQ(chart.series.size(), 3u);
    EXPECT_EQ(chart.series[0].name, "uniform");
    ASSERT_EQ(chart.series[0].points.size(), 2u);
    EXPECT_TRUE(chart.series[0].joined);
    EXPECT_EQ(chart.series[0].points[0].label, "coarse");
    EXPECT_DOUBLE_EQ(chart.series[0].points[0].x, 1);
    EXPECT_DOUBLE_EQ(chart.series[0].points[1].x, 8);
    EXPECT_DOUBLE_EQ(chart.series[0].points[1].y, 2);
    EXPECT_EQ(chart.series[1].name, "sparse");
    EXPECT_EQ(chart.series[2].name, "others");
    // Blue, green and violet on every map, whether or not it has a line of -shfit, which is orange.
    EXPECT_EQ(chart.series[0].color, 0);
    EXPECT_EQ(chart.series[1].color, 2);
    EXPECT_EQ(chart.series[2].color, 3);
    EXPECT_FALSE(chart.series[2].joined);
    EXPECT_EQ(chart.series[2].points[0].label, "fast");
    const auto json = nlohmann::json::parse(JsonText(report));
    EXPECT_EQ(json["settings"][2]["family"], "uniform");
    EXPECT_TRUE(json["settings"][6]["family"].is_null());
}

TEST_F(RunTest, WorstPositionsOfAnUnknownSettingAreRefused) {
    BenchSettings settings;
    settings.truth.positions = 1;
    settings.measureRaw = false;
    settings.worstCount = 1;
    settings.worstOf = "fastt";
    Log silent(Log::Nowhere());
    const auto map = Map(Room()); // makes the library
    EXPECT_THROW(RunBench(*map, Library(), settings, *FindGame("quake3"), JobPool(1), silent), std::exception);
}

TEST_F(RunTest, UnknownLightOptionsAreRefused) {
    EXPECT_THROW(LightOptionsFrom("-fats", *FindGame("quake3")), std::exception);
    EXPECT_TRUE(LightOptionsFrom("-fast", *FindGame("quake3")).fastGrid);
}

TEST_F(RunTest, APlainBakeIsExactAtItsPointsForPointLights) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({40, 20, 100}, 300));
    const auto map = Map(scene);
    const Baked baked = BakeBaseline(*map, {{-100, -100, 0}, {100, 100, 50}, {3, 3, 2}, 18}, JobPool(1));
    Truth truth;
    for (const Vec3f &p : {Vec3f{-100, 0, 50}, Vec3f{100, 100, 0}}) {
        std::uint64_t rays = 0;
        truth.points.push_back(TruthAt(*map, p, 1, 0.05, rays));
    }
    EXPECT_NEAR(MeasureErrors(truth, ShownBy(BakedFormat::GridSH, baked.bsp)).grid, 0, 1e-3);
}

TEST_F(RunTest, ThePlainGridIsMeasuredOnMapsThatHoldASparseOne) {
    SceneBuilder scene = Room();
    scene.AddEntity(PointLight({40, 20, 100}, 300));
    const auto map = Map(scene);
    const LightOptions options = LightOptionsFrom("-shadaptive", *FindGame("quake3"));
    const Baked lit = Bake(*map, options, BakedFormat::SparseGridSH, Library(), JobPool(1));
    ASSERT_TRUE(lit.bsp.sparseGridSH);
    KeptLog log;
    const BenchMap again(lit.bsp, {"test", {}, {}}, options, Library(), log.log);
    const bspGridSHHeader_t layout{{-300, -300, -300}, {600, 600, 600}, {2, 2, 2}, 8};
    const Vec3f position{10, 20, 30};
    EXPECT_EQ(ShownBy(BakedFormat::GridSH, BakeBaseline(again, layout, JobPool(1)).bsp)(position),
              ShownBy(BakedFormat::GridSH, BakeBaseline(*map, layout, JobPool(1)).bsp)(position));
}

TEST(Hall, HasAsManyLightsAsAskedForWithTheSameLightTogether) {
    for (const int lights : {1, 10}) {
        const LightHall hall = MakeLightHall(lights, HallLights::Points);
        double sum = 0;
        int found = 0;
        for (const Entity &entity : ParseEntities(hall.bsp.entities, "hall"))
            if (entity.ClassName() == "light")
                ++found, sum += entity.Number({"light"});
        EXPECT_EQ(found, lights);
        EXPECT_NEAR(sum, 8000, 1);
    }
}

class ChartTest : public BenchTest {};

TEST_F(ChartTest, IsWrittenAsPngAndSvg) {
    Chart chart;
    chart.title = "errors & time";
    chart.x = {"CPU seconds", AxisScale::Logarithmic};
    chart.y = {"RMSE", AxisScale::Linear};
    chart.series = {{"settings", {{0.1, 3, "fast"}, {0.11, 3.01, "nearly fast"}, {2, 1, "slow"}}, false}};
    chart.level = 0.8;
    chart.levelLabel = "floor";
    WriteChart(chart, folder / "chart");
    const std::string png = folder.ReadBack("chart.png"), svg = folder.ReadBack("chart.svg");
    EXPECT_TRUE(png.starts_with("\x89PNG\r\n\x1a\n"));
    const std::vector<std::byte> bytes(reinterpret_cast<const std::byte *>(png.data()),
                                       reinterpret_cast<const std::byte *>(png.data()) + png.size());
    const Image image = DecodePng(bytes, "chart.png");
    EXPECT_EQ(image.width, 1920);
    EXPECT_EQ(image.Texel(0, 0), (std::array<std::uint8_t, 4>{255, 255, 255, 255}));
    EXPECT_THAT(svg, testing::HasSubstr("<svg"));
    EXPECT_THAT(svg, testing::EndsWith("</svg>\n"));
    EXPECT_THROW(WriteChart(chart, folder / "missing/chart"), std::exception);
}

} // namespace

} // namespace q3::test
