// GPL-2.0-or-later. The demo of lights: every kind of light reaches its bay, and nothing is wrong with the map.
#include "common/files/files.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/prop_light.h"
#include "tests/support/run_program.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

constexpr int kBays = 24, kBaysInRow = 6;

/// A point of a bay from the lower left corner of its front; the back wall is at 112.
struct BayPoint {
    int bay;
    Vec3f at;
};

/// Where the light of each bay is to be seen. Suns: behind the panes of the windows. 5: between the two boards, where
/// no light arrives directly. 21, 22: through the middle of a pane.
constexpr std::array<BayPoint, kBays> kLitPoints{{
    {1, {74, 112, 45}},   {2, {80, 112, 58}},   {3, {65, 112, 92}},  {4, {80, 112, 58}},  {5, {80, 112, 58}},
    {6, {86, 112, 44}},   {7, {80, 112, 58}},   {8, {80, 112, 58}},  {9, {80, 112, 58}},  {10, {80, 112, 58}},
    {11, {80, 112, 58}},  {12, {80, 112, 58}},  {13, {80, 112, 58}}, {14, {80, 112, 58}}, {15, {80, 112, 58}},
    {16, {110, 112, 80}}, {17, {100, 112, 58}}, {18, {80, 112, 90}}, {19, {80, 112, 50}}, {20, {80, 112, 30}},
    {21, {96, 112, 74}},  {22, {96, 112, 74}},  {23, {44, 112, 58}}, {24, {80, 112, 58}},
}};

/// Position in the map: six bays in a row, the first row highest.
Vec3f PositionOf(const BayPoint &point) {
    constexpr float kWidth = 176, kHeight = 128, kLeft = 16, kLowest = 108;
    const int column = (point.bay - 1) % kBaysInRow, row = (point.bay - 1) / kBaysInRow;
    return Vec3f{kLeft + kWidth * float(column), 0, kLowest + kHeight * float(kBays / kBaysInRow - 1 - row)} + point.at;
}

/// Light of the lightmaps at a point of a flat surface: the texel around it, without filtering. Empty: no lightmap.
std::optional<Vec3f> LightAt(const Bsp &bsp, const Vec3f &p) {
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
        if (surface.lightmapNum[0] < 0)
            continue;
        for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
            std::array<const bspDrawVert_t *, 3> v{};
            for (int k = 0; k < 3; ++k)
                v[std::size_t(k)] = &bsp.drawVerts[std::size_t(
                    surface.firstVert + bsp.drawIndexes[std::size_t(surface.firstIndex + i + k)])];
            const Vec3f a(v[0]->xyz), b(v[1]->xyz), c(v[2]->xyz), n = Cross(b - a, c - a);
            const float area = Dot(n, n);
            if (area == 0 || std::abs(Dot(n, p - a)) > 0.1f * std::sqrt(area))
                continue;
            const std::array<float, 3> weight{Dot(Cross(b - p, c - p), n) / area, Dot(Cross(c - p, a - p), n) / area,
                                              Dot(Cross(a - p, b - p), n) / area};
            if (*std::min_element(weight.begin(), weight.end()) < -1e-4f)
                continue;
            std::array<float, 2> st{};
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t axis = 0; axis < 2; ++axis)
                    st[axis] += 128 * weight[k] * v[k]->lightmap[0][axis];
            const auto texel =
                std::size_t(surface.lightmapNum[0]) * 128 * 128 + std::size_t(st[1]) * 128 + std::size_t(st[0]);
            const std::uint8_t *rgb = &bsp.lightmaps.at(3 * texel);
            return Vec3f{float(rgb[0]), float(rgb[1]), float(rgb[2])};
        }
    }
    return std::nullopt;
}

/// The point of the legacy grid at this place; its cells are cubes of 64 units, as worldspawn says.
bspGridPoint_t GridPointAt(const Bsp &bsp, const Vec3f &p) {
    constexpr float kCell = 64;
    std::array<int, 3> size{}, at{};
    for (std::size_t i = 0; i < 3; ++i) {
        const float low = std::ceil(bsp.models[0].mins[i] / kCell);
        size[i] = int(std::floor(bsp.models[0].maxs[i] / kCell) - low) + 1;
        at[i] = int(p[i] / kCell - low);
    }
    EXPECT_EQ(bsp.gridPoints.size(), std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]));
    return bsp.gridPoints.at(std::size_t((at[2] * size[1] + at[1]) * size[0] + at[0]));
}

class DemoLightsTest : public testing::Test {
  protected:
    DemoLightsTest() : game_(folder_ / "base/baseq3") {
        std::filesystem::create_directories(folder_ / "base");
        std::filesystem::copy(DEMO_LIGHTS, game_, std::filesystem::copy_options::recursive);
    }
    Outcome Run(std::string_view words) const {
        std::vector<std::string> arguments{"-fs_basepath", (folder_ / "base").string()};
        std::istringstream text{std::string(words)};
        for (std::string word; text >> word;)
            arguments.push_back(word);
        arguments.push_back((game_ / "maps/lights.map").string());
        Outcome outcome = RunProgramFile(arguments, folder_.Root());
        EXPECT_EQ(outcome.status, 0) << words << '\n' << outcome.text;
        EXPECT_THAT(outcome.text, HasSubstr("done: no warnings")) << words;
        return outcome;
    }
    Bsp Load() const {
        KeptLog quiet;
        return ReadBspFile(game_ / "maps/lights.bsp", {}, quiet.log);
    }
    /// Lights the map without the lights of even or odd bays, with all light in style 0.
    Bsp LitWithout(bool even) const {
        const std::filesystem::path original = DEMO_LIGHTS;
        std::string map = ReadTextFile(original / "maps/lights.map"),
                    script = ReadTextFile(original / "scripts/lights.shader");
        std::string rad = ReadTextFile(original / "lights.rad");
        for (int bay = even ? 2 : 1; bay <= kBays; bay += 2)
            RemoveEntities(fmt::format("\"_bay\" \"{}\"\n", bay), map);
        if (even) {
            RemoveWord("q3map_surfacelight", script);
            RemoveWord("q3map_sunExt", script);
            RemoveWord("q3map_skyLight", script);
            rad.clear();
        }
        folder_.Write("base/baseq3/maps/lights.map", map);
        folder_.Write("base/baseq3/scripts/lights.shader", script);
        folder_.Write("base/baseq3/lights.rad", rad);
        // libstdc++ sets times of files to whole seconds on Windows: the next one is after the map's.
        std::filesystem::last_write_time(game_ / "maps/lights.bsp",
                                         std::filesystem::file_time_type::clock::now() + std::chrono::seconds(1));
        Run("-light -fast -nogrid -nostyles -samplescale 2 -bounce 2 -bouncerays 16");
        return Load();
    }

    GameFolder folder_;
    std::filesystem::path game_;

  private:
    static void RemoveEntities(std::string_view with, std::string &map) {
        for (std::size_t at = map.find(with); at != std::string::npos; at = map.find(with)) {
            const std::size_t begin = map.rfind("{\n", at), end = map.find("}\n", at) + 2;
            map.erase(begin, end - begin);
        }
    }
    /// Makes a directive of a shader a comment.
    static void RemoveWord(std::string_view word, std::string &script) {
        const std::size_t at = script.find(word);
        ASSERT_NE(at, std::string::npos) << word;
        script.insert(at, "// ");
    }
};

} // namespace

TEST_F(DemoLightsTest, EveryKindOfLightReachesItsBay) {
    Run("-meta");
    Run("-vis -fast");
    const std::array<Bsp, 2> litWithout{LitWithout(true), LitWithout(false)};
    const auto bright = [&](const BayPoint &point, bool with) {
        const bool even = point.bay % 2 == 0;
        const std::optional<Vec3f> light = LightAt(litWithout[even == with ? 1 : 0], PositionOf(point));
        EXPECT_TRUE(light) << "no lightmap in bay " << point.bay;
        return light ? (light->x + light->y + light->z) / 3 : 0;
    };
    for (const BayPoint &point : kLitPoints) {
        const float with = bright(point, true), without = bright(point, false);
        EXPECT_LT(without, 30) << "bay " << point.bay;
        EXPECT_GT(with, without + 20) << "bay " << point.bay;
    }
    // The negative light makes a dark spot.
    EXPECT_LT(2 * bright({17, {44, 112, 58}}, true), bright({17, {116, 112, 58}}, true));
    // Panes of glass have colors; in the middle of the grate, between four holes, bars cross.
    const auto color = [&](int bay, float x, float z) {
        return LightAt(litWithout[bay % 2 == 0 ? 1 : 0], PositionOf({bay, {80 + x, 112, 58 + z}})).value_or(Vec3f{});
    };
    const Vec3f red = color(21, 16, 16), blue = color(21, -16, 16), green = color(21, -16, -16);
    EXPECT_GT(red.x, 2 * std::max(red.y, red.z));
    EXPECT_GT(blue.z, 1.5f * std::max(blue.x, blue.y));
    EXPECT_GT(green.y, 1.5f * std::max(green.x, green.z));
    EXPECT_GT(color(22, 16, 16).x, 4 * color(22, 0, 0).x);
}

TEST_F(DemoLightsTest, HasPropsAndSwitchesAndNoWarnings) {
    Run("-meta");
    Run("-vis");
    Run("-light -fast -samplescale 4 -shbspx -shsmall -bounce 1 -bouncerays 16 -bouncegrid -switchable "
        "-staticproplighting -staticproppolys -textureshadows");
    const Bsp bsp = Load();

    ASSERT_TRUE(bsp.propLight);
    const PropLight &props = *bsp.propLight;
    EXPECT_EQ(props.props.size(), 40u);
    EXPECT_EQ(std::count(props.colors.begin(), props.colors.end(), 0u), 0) << "black vertices";

    const Entity world = ParseEntities(bsp.entities, "lights").front();
    EXPECT_EQ(world.Value("_style12pattern"), "ijklmlkj");
    EXPECT_EQ(world.Value("_switch32"), "red_lamp");
    EXPECT_EQ(world.Value("_switch33"), "blue_lamp");
    const std::string script = ReadTextFile(game_ / "scripts/q3map2_lights.shader");
    EXPECT_THAT(script, HasSubstr("rgbGen const ( 1 1 1 )"));
    EXPECT_THAT(script, HasSubstr("rgbGen wave"));

    // The lightJunior is green and shines on the grids alone.
    const bspGridPoint_t point = GridPointAt(bsp, {512, -576, 192});
    EXPECT_GT(point.directed[0][1], point.directed[0][0] + 20);
    EXPECT_GT(point.directed[0][1], point.directed[0][2] + 20);
}

} // namespace q3::test
