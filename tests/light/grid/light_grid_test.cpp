// GPL-2.0-or-later. Legacy light grids of NetRadiant's q3map2: the same maps and options must give the same bytes.
#include "common/files/files.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/lightmap/light_stage.h"
#include "tests/support/game_folder.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

const std::filesystem::path kVectors = TEST_DATA "/vectors";

/// No file has -bouncegrid, whose bounced light differs in this version on purpose, nor -lowquality, which turns
/// floodlight off in NetRadiant's q3map2 and makes it coarser in this one.
std::vector<std::string> VectorNames() {
    std::vector<std::string> names;
    for (const auto &entry : std::filesystem::directory_iterator(kVectors / "grid"))
        names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

class GridVectorTest : public testing::TestWithParam<std::string> {
  protected:
    void SetUp() override {
        expected_ = nlohmann::json::parse(std::ifstream(kVectors / "grid" / (GetParam() + ".json")));
        auto words = expected_.at("light_args").get<std::vector<std::string>>();
        words.erase(words.begin()); // the stage
        Arguments arguments(words);
        const Game &game = *FindGame("quake3");
        const LightOptions options = ParseLightOptions(arguments, game, out_.log);
        VirtualFileSystem vfs(out_.log);
        vfs.Mount(kVectors / "baseq3", "pk3");
        ShaderLibrary library(vfs, game, options.shader, out_.log);
        const std::string map = (kVectors / "maps" / expected_.at("map").get<std::string>()).string();
        bsp_ = ReadBspFile(map + ".bsp", {}, out_.log);
        const LightInputs inputs{GetParam(), ParseMapEntities(ReadTextFile(map + ".map"), map),
                                 ReadTextFile(map + ".srf")};
        CountAreaLights(inputs, options, library);
        LightmapOptions lightmap = ParseLightmapOptions(arguments, options, game, out_.log);
        lightmap.onlyGrid = true;
        LightWorld(bsp_, inputs, options, lightmap, library, JobPool(2), out_.log);
        const Entity world = ParseEntities(bsp_.entities, map).front();
        const Vec3f cell = world.Vector({"gridsize"}).value_or(Vec3f{64, 64, 128});
        layout_ = LayoutGrid(bsp_.models[0].mins, bsp_.models[0].maxs, {cell.x, cell.y, cell.z});
        ASSERT_EQ(bsp_.gridPoints.size(), std::size_t(layout_.Count()));
    }

    void CountAreaLights(const LightInputs &inputs, const LightOptions &options, ShaderLibrary &library) {
        const auto &entities = *inputs.mapEntities;
        SurfaceTable table = MakeSurfaceTable(bsp_, entities, inputs.surfaceFile, inputs.name, library, out_.log);
        const auto lights = CreateLights(BspSpace(bsp_, OpaqueBrushes(bsp_, library)), entities, table, options,
                                         ReadWorldLight(entities.front(), options), library, out_.log);
        areaLights_ =
            std::count_if(lights.begin(), lights.end(), [](const Light &l) { return l.type == LightType::Area; });
    }

    /// One point against eight bytes, as the reference's own accuracy allows: 1 per byte. The second byte of a
    /// direction means nothing where the first is nearly vertical or nothing is directed; at 180 degrees it has two
    /// forms.
    static bool SamePoint(const bspGridPoint_t &point, const std::array<int, 8> &wanted) {
        const auto near = [](int a, int b) { return std::abs(a - b) <= 1; };
        const auto nearAngle = [](int a, int b) { return ((a - b + 1) & 255) <= 2; };
        for (std::size_t i = 0; i < 3; i++)
            if (!near(point.ambient[0][i], wanted[i]) || !near(point.directed[0][i], wanted[3 + i]))
                return false;
        if (!nearAngle(point.latLong[0], wanted[6]))
            return false;
        const bool black = wanted[3] == 0 && wanted[4] == 0 && wanted[5] == 0;
        const auto opposite = [](int a) { return a >= 127 && a <= 129; };
        const bool vertical = wanted[6] < 3 || (wanted[6] >= 126 && wanted[6] <= 129);
        return vertical || black || nearAngle(point.latLong[1], wanted[7]) ||
               (opposite(point.latLong[1]) && opposite(wanted[7]));
    }

    static std::string Show(const bspGridPoint_t &p) {
        return fmt::format("{} | {} | {}", fmt::join(p.ambient[0], " "), fmt::join(p.directed[0], " "),
                           fmt::join(p.latLong, " "));
    }

    void ExpectPoint(std::size_t index, const std::array<int, 8> &wanted) {
        ASSERT_LT(index, bsp_.gridPoints.size());
        if (SamePoint(bsp_.gridPoints[index], wanted))
            return;
        const auto width = std::size_t(layout_.bounds[0]), height = std::size_t(layout_.bounds[1]);
        const Float3 p = layout_.Position(int(index % width), int(index / width % height), int(index / width / height));
        ADD_FAILURE() << fmt::format("point {} at {}: {}, expected {}", index, fmt::join(p, " "),
                                     Show(bsp_.gridPoints[index]), fmt::join(wanted, " "));
    }

    void ExpectGrid(const nlohmann::json &grid) {
        EXPECT_EQ(layout_.size, grid.at("size").get<Float3>());
        EXPECT_EQ(layout_.mins, grid.at("mins").get<Float3>());
        ASSERT_EQ(layout_.bounds, grid.at("bounds").get<Int3>());
        std::string hex;
        for (const auto &row : grid.at("hex"))
            hex += row.get<std::string>();
        ASSERT_EQ(hex.size(), 16 * bsp_.gridPoints.size());
        const auto ignore = grid.value("ignore", std::vector<std::size_t>{});
        EXPECT_EQ(ignore.empty(), !expected_.contains("ignored")) << "a reason stands beside points left out";
        EXPECT_LT(4 * ignore.size(), bsp_.gridPoints.size()) << "three quarters of the points are compared";
        for (std::size_t i = 0; i < bsp_.gridPoints.size(); i++) {
            std::array<int, 8> wanted;
            for (std::size_t b = 0; b < 8; b++)
                wanted[b] = std::stoi(hex.substr(16 * i + 2 * b, 2), nullptr, 16);
            if (std::find(ignore.begin(), ignore.end(), i) == ignore.end())
                ExpectPoint(i, wanted);
        }
    }

    std::size_t IndexAt(const Float3 &at) const {
        std::size_t index = 0, stride = 1;
        for (std::size_t axis = 0; axis < 3; axis++) {
            index += stride * std::size_t(std::lround((at[axis] - layout_.mins[axis]) / layout_.size[axis]));
            stride *= std::size_t(layout_.bounds[axis]);
        }
        return index;
    }

    nlohmann::json expected_;
    KeptLog out_;
    Bsp bsp_;
    GridLayout layout_;
    long areaLights_ = 0;
};

TEST_P(GridVectorTest, GivesTheSameBytes) {
    bool compared = false;
    if (expected_.contains("area_lights")) {
        EXPECT_EQ(areaLights_, expected_["area_lights"].get<long>());
    }
    if (expected_.contains("grid")) {
        ExpectGrid(expected_["grid"]);
        compared = true;
    }
    if (expected_.contains("probes"))
        for (const auto &probe : expected_["probes"]) {
            ExpectPoint(IndexAt(probe.at("at").get<Float3>()), probe.at("bytes").get<std::array<int, 8>>());
            compared = true;
        }
    if (expected_.contains("expected_bounds")) {
        EXPECT_EQ(layout_.bounds, expected_["expected_bounds"].get<Int3>());
        const auto size = expected_["expected_gridsize"].get<Float3>();
        EXPECT_EQ(layout_.size, size);
        const std::string key = fmt::format("\"gridsize\" \"{}\"", fmt::join(size, " "));
        EXPECT_NE(bsp_.entities.find(key), std::string::npos) << bsp_.entities;
        compared = true;
    }
    EXPECT_TRUE(compared) << "nothing to compare with";
}

INSTANTIATE_TEST_SUITE_P(Vectors, GridVectorTest, testing::ValuesIn(VectorNames()),
                         [](const auto &of) { return of.param; });

} // namespace

} // namespace q3::test
