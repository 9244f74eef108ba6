// GPL-2.0-or-later. Errors by position, as a file.
#include "tests/tools/shbench/bench_fixture.h"
#include "tools/measure/shbench/bench_run.h"

#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace q3::test {

namespace {

using namespace bench;

Truth At(std::initializer_list<Vec3f> positions) {
    Truth truth;
    for (const Vec3f &position : positions) {
        TruthPoint point;
        point.position = position;
        truth.points.push_back(point);
    }
    return truth;
}

TEST(ErrorList, IsAFileOfRoundedRows) {
    const Truth truth = At({{1.26f, -2, 3000.04f}, {0, 0.5f, 0}});
    EXPECT_EQ(ErrorListJson("x", truth, {"fine", "-sherrortarget 1", {1.234, 20}, {3, 0.005001}}),
              R"({"format":"q3map2-sh errors","version":1,"map":"maps/x.bsp","unit":"displayed bytes",)"
              R"("setting":"fine","options":"-sherrortarget 1",)"
              R"("positions":[[1.3,-2.0,3000.0,1.23,3.0],[0.0,0.5,0.0,20.0,0.01]]})"
              "\n");
    const auto json = nlohmann::json::parse(ErrorListJson("x", truth, {"fine", "", {1, 2}, {}}));
    EXPECT_TRUE(json["positions"][1][4].is_null()) << "no legacy grid was measured";
}

class ErrorListTest : public BenchTest {
  protected:
    ErrorListTest() {
        SceneBuilder scene = Room();
        scene.AddEntity(PointLight({40, 20, 100}, 300));
        map_ = Map(scene);
        settings_.truth.positions = 150;
        settings_.measureRaw = false;
        settings_.listErrors = true;
        settings_.bakes = {{"rough", "-gridsh 256 256 256"}, {"sparse", " -sherrortarget  2"}};
    }
    BenchResult Run() {
        Log silent(Log::Nowhere());
        return RunBench(*map_, Library(), settings_, *FindGame("quake3"), JobPool(2), silent);
    }
    /// RMS of a column of the rows, and the rows' agreement with the reference's positions.
    double Rms(const nlohmann::json &json, std::size_t column) const {
        double sum = 0;
        const Truth truth = MakeTruth(*map_, settings_.truth, JobPool(2));
        EXPECT_EQ(json["positions"].size(), truth.points.size());
        for (std::size_t i = 0; i < truth.points.size(); ++i) {
            const auto &row = json["positions"][i];
            EXPECT_EQ(row.size(), 5u);
            for (std::size_t axis = 0; axis < 3; ++axis)
                EXPECT_NEAR(row[axis].get<float>(), truth.points[i].position[axis], 0.051f) << i;
            sum += row[column].get<double>() * row[column].get<double>();
        }
        return std::sqrt(sum / double(truth.points.size()));
    }

    std::unique_ptr<BenchMap> map_;
    BenchSettings settings_;
};

TEST_F(ErrorListTest, ItsRmsIsThatOfTheTable) {
    BenchResult result = Run();
    auto json = nlohmann::json::parse(result.errors);
    EXPECT_EQ(json["setting"], "rough") << "the first";
    EXPECT_NEAR(Rms(json, 3), result.report.Line("rough")->errors.rmse, 0.01);
    EXPECT_NEAR(Rms(json, 4), result.report.Line("legacy grid")->errors.rmse, 0.01);

    settings_.errorsOf = "sparse";
    settings_.measureBaselines = false;
    result = Run();
    json = nlohmann::json::parse(result.errors);
    EXPECT_EQ(json["options"], "-sherrortarget 2");
    EXPECT_NEAR(Rms(json, 3), result.report.Line("sparse")->errors.rmse, 0.01);
    EXPECT_TRUE(json["positions"][0][4].is_null());
}

TEST_F(ErrorListTest, IsOfASettingWithAnSHGrid) {
    for (const char *name : {"none", "legacy grid", "ambient cubes"}) {
        settings_.errorsOf = name;
        EXPECT_THROW(Run(), std::exception) << name;
    }
    settings_.listErrors = false;
    EXPECT_TRUE(Run().errors.empty());
}

} // namespace

} // namespace q3::test
