// GPL-2.0-or-later. The picture of the light grids, and the parts that decide what it shows.
#include "common/error.h"
#include "libs/sh/sh.h"
#include "q3map2/convert/preview/grid_preview.h"
#include "q3map2/convert/preview/grid_preview_map.h"
#include "tests/support/game_folder.h"
#include "tests/support/scene/scene_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

namespace q3 {
namespace {

const SceneShader kRoomWall{"textures/test/wall"};
constexpr Vec3f kRedLight{0.8f, 0, 0}, kBlueLight{0, 0, 0.8f};
constexpr std::uint8_t kByte = 204; ///< 0.8 of 255

void AddLight(bspGridPointSH_t &point, const Vec3d &direction, const Vec3f &color) {
    const auto basis = SHBasis(direction);
    for (std::size_t k = 0; k < 9; k++)
        for (std::size_t channel = 0; channel < 3; channel++)
            point.coeffs[k][channel] += float(kCosineLobe[k] * basis[k] * color[channel]);
}

/// A room whose walls, seen from anywhere, shine red from the south and blue from the north.
Bsp TwoColors() {
    SceneBuilder builder;
    builder.SetInterior({-256, -256, 0}, {256, 256, 256}, kRoomWall);
    builder.AddBox({-32, -32, 0}, {32, 32, 256}, kRoomWall);
    builder.AddEntity({{{"classname", "info_player_start"}, {"origin", "100 100 32"}}});
    Bsp bsp = builder.Build();
    const GridLayout sh = LayoutGrid(bsp.models[0].mins, bsp.models[0].maxs, {32, 32, 64});
    bspGridPointSH_t point{};
    AddLight(point, {0, -1, 0}, kRedLight);
    AddLight(point, {0, 1, 0}, kBlueLight);
    bsp.gridSH = LightGridSH{{sh.mins, sh.size, sh.bounds, std::int32_t(sh.Count())}, {}};
    bsp.gridSH->points.assign(std::size_t(sh.Count()), point);
    const GridLayout legacy = LayoutGrid(bsp.models[0].mins, bsp.models[0].maxs, {64, 64, 128});
    bsp.gridPoints.assign(std::size_t(legacy.Count()), {{{20, 0, 20}}, {{kByte, 0, kByte}}, kOnlyStyle0, {0, 0}});
    return bsp;
}

TEST(GridPreview, SHSideTellsTheTwoLightsApart) {
    const Bsp bsp = TwoColors();
    const SHPreview preview(bsp);
    const SHSample coeffs = preview.At({100, 100, 100});
    const Vec3f south = LightOn(coeffs, {0, -1, 0}), north = LightOn(coeffs, {0, 1, 0});
    EXPECT_NEAR(south.x, 0.8 * 1.0625, 1e-5);
    EXPECT_NEAR(south.z, 0.8 * 0.0625, 1e-5);
    EXPECT_NEAR(north.x, 0.8 * 0.0625, 1e-5);
    EXPECT_NEAR(north.z, 0.8 * 1.0625, 1e-5);
}

TEST(GridPreview, PlainProjectionIsConvolvedFirst) {
    Bsp bsp = TwoColors();
    const Vec3f expected = LightOn(SHPreview(bsp).At({0, 0, 100}), {0, -0.6f, 0.8f});
    for (bspGridPointSH_t &point : bsp.gridSH->points)
        for (std::size_t k = 0; k < 9; k++)
            for (float &value : point.coeffs[k])
                value = float(value / kCosineLobe[k]);
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"_q3map2_sh\" \"radiance\"\n}\n";
    EXPECT_NEAR(Length(LightOn(SHPreview(bsp).At({0, 0, 100}), {0, -0.6f, 0.8f}) - expected), 0, 1e-5);
}

TEST(GridPreview, SHSideHasTheToneOfTheLegacySide) {
    Bsp bsp = TwoColors();
    const SHSample plain = SHPreview(bsp).At({100, 100, 100});
    EXPECT_FALSE(SHPreview(bsp).HasTone());
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"_q3map2_tone\" \"gamma 2 scale 0.5\"\n}\n";
    EXPECT_TRUE(SHPreview(bsp).HasTone());
    const SHSample toned = SHPreview(bsp).At({100, 100, 100});
    for (const Vec3f &normal : {Vec3f(0, -1, 0), Vec3f(0, 0, 1), Vec3f(0.6f, 0.8f, 0)}) {
        const Vec3f before = LightOn(plain, normal), after = LightOn(toned, normal);
        for (const std::size_t channel : {0u, 1u, 2u})
            EXPECT_NEAR(after[channel], 0.5 * std::sqrt(before[channel]), 1e-5);
    }
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"_q3map2_tone\" \"gamma\"\n}\n";
    EXPECT_FALSE(SHPreview(bsp).HasTone()) << "not readable";
}

TEST(GridPreview, LegacySideIsAmbientPlusDirected) {
    const Bsp bsp = TwoColors();
    const auto legacy = LegacyPreview::Make(bsp);
    ASSERT_TRUE(legacy);
    const LegacySample sample = legacy->At({100, 100, 100}); // directed from +z
    EXPECT_NEAR(LightOn(sample, {0, 0, 1}).x, (20 + kByte) / 255.0, 1e-5);
    EXPECT_NEAR(LightOn(sample, {0, 0.6f, 0.8f}).z, (20 + 0.8 * kByte) / 255.0, 1e-5);
    EXPECT_NEAR(LightOn(sample, {0, 0, -1}).x, 20 / 255.0, 1e-5);
}

TEST(GridPreview, LegacyCornersInWallsAreLeftOut) {
    Bsp bsp = TwoColors();
    const GridLayout grid = LayoutGrid(bsp.models[0].mins, bsp.models[0].maxs, {64, 64, 128});
    for (int z = 0; z < grid.bounds[2]; z++)
        for (int y = 0; y < grid.bounds[1]; y++)
            for (int x = 0; x < grid.bounds[0]; x++)
                if (grid.Position(x, y, z)[0] > 0)
                    bsp.gridPoints[std::size_t(x + grid.bounds[0] * (y + grid.bounds[1] * z))] = {};
    const auto legacy = LegacyPreview::Make(bsp);
    ASSERT_TRUE(legacy);
    // Three quarters of the way into the wall the one lit side still counts in full.
    EXPECT_NEAR(legacy->At({48, 10, 100}).ambient.x, 20 / 255.0, 1e-5);
    EXPECT_NEAR(legacy->At({48, 10, 100}).directed.x, kByte / 255.0, 1e-5);
    EXPECT_EQ(legacy->At({200, 10, 100}).ambient, Vec3f{});
    EXPECT_EQ(LightOn(legacy->At({200, 10, 100}), {0, 0, 1}), Vec3f{});
}

TEST(GridPreview, LegacyDirectionsAreDecodedAsEnginesDo) {
    Bsp bsp = TwoColors();
    const auto pointing = [&](std::uint8_t polar, std::uint8_t around) {
        for (bspGridPoint_t &point : bsp.gridPoints)
            point.latLong = {polar, around};
        return LegacyPreview::Make(bsp)->At({100, 100, 100}).direction;
    };
    EXPECT_NEAR(Length(pointing(64, 0) - Vec3f(1, 0, 0)), 0, 1e-6);
    EXPECT_NEAR(Length(pointing(64, 64) - Vec3f(0, 1, 0)), 0, 1e-6);
    EXPECT_NEAR(Length(pointing(128, 0) - Vec3f(0, 0, -1)), 0, 1e-6);
}

TEST(GridPreview, LegacyGridOfAnotherLengthIsNone) {
    Bsp bsp = TwoColors();
    bsp.gridPoints.pop_back();
    EXPECT_FALSE(LegacyPreview::Make(bsp));
    bsp.gridPoints.clear();
    EXPECT_FALSE(LegacyPreview::Make(bsp));
}

TEST(GridPreview, PlacesAreOpenAndSpread) {
    const Bsp bsp = TwoColors();
    const PreviewMap map(bsp);
    EXPECT_FALSE(map.IsOpen({0, 0, 100})) << "the pillar";
    EXPECT_FALSE(map.IsOpen({0, 0, 300})) << "outside";
    EXPECT_TRUE(map.IsOverFloor({100, 100, 100}));
    EXPECT_FALSE(map.IsOverFloor({100, 100, 200})) << "the floor is farther than 128 below";
    const auto positions = map.ChoosePositions(12, [](const Vec3f &p) { return p.x > 0 ? 1.0f : 0.0f; });
    ASSERT_EQ(positions.size(), 12u);
    for (std::size_t i = 0; i < positions.size(); i++) {
        EXPECT_TRUE(map.IsOverFloor(positions[i]));
        for (std::size_t j = 0; j < i; j++)
            EXPECT_GT(Length(positions[i] - positions[j]), 64);
    }
    EXPECT_GT(std::ranges::count_if(positions, [](const Vec3f &p) { return p.x > 0; }), 6) << "light draws positions";
}

TEST(GridPreview, PlacesAreWherePlayersAre) {
    SceneBuilder builder;
    builder.SetInterior({-256, -256, 0}, {256, 256, 256}, kRoomWall);
    builder.AddBox({-8, -256, 0}, {8, 256, 256}, kRoomWall); // two rooms apart
    builder.AddEntity({{{"classname", "info_player_start"}, {"origin", "100 100 32"}}});
    SceneVisibility visibility;
    visibility.writeLump = true;
    visibility.sees = [](const Boundsf &a, const Boundsf &b) { return a.Center().x * b.Center().x > 0; };
    builder.SetVisibility(visibility);
    Bsp bsp = builder.Build();
    const PreviewMap map(bsp);
    EXPECT_TRUE(map.IsOpen({100, -100, 100}));
    EXPECT_FALSE(map.IsOpen({-100, -100, 100})) << "no player sees this room";
    for (const Vec3f &position : map.ChoosePositions(12, [](const Vec3f &) { return 1.0f; }))
        EXPECT_GT(position.x, 0);
    bsp.visibility.clear();
    EXPECT_TRUE(PreviewMap(bsp).IsOpen({-100, -100, 100})) << "without visibility data all that is open counts";
}

TEST(GridPreview, SphereShowsTheLightOfItsNormals) {
    Canvas canvas(100, 100, {0, 0, 0});
    DrawSphere(canvas, 50, 50, 40, PlanView(),
               [](const Vec3f &n) { return Vec3f(n.x > 0 ? 1.0f : 0, n.y > 0 ? 1.0f : 0, n.z); });
    using Texel = std::array<std::uint8_t, 4>;
    const auto northEast = canvas.Picture().Texel(70, 30), southWest = canvas.Picture().Texel(30, 70);
    EXPECT_EQ(northEast[0], 255);
    EXPECT_EQ(northEast[1], 255);
    EXPECT_EQ(southWest[0], 0);
    EXPECT_EQ(southWest[1], 0);
    EXPECT_GE(canvas.Picture().Texel(50, 50)[2], 254);
    EXPECT_EQ(canvas.Picture().Texel(5, 50), (Texel{0, 0, 0, 255})) << "outside";
    const View view = ObjectView();
    EXPECT_LT(view.toCamera.x, 0);
    EXPECT_LT(view.toCamera.y, 0);
    EXPECT_GT(view.toCamera.z, 0);
    EXPECT_NEAR(Length(Cross(view.right, view.up) - view.toCamera), 0, 1e-6);
}

TEST(GridPreview, DisplayCurveIsSrgb) {
    EXPECT_NEAR(ToDisplay({0.5f, 0, 2}).x, 0.735357f, 1e-5);
    EXPECT_EQ(ToDisplay({0.5f, 0, 2}).y, 0);
    EXPECT_NEAR(ToDisplay({0.5f, 0, 2}).z, 1, 1e-6);
    EXPECT_NEAR(ToDisplay({0.001f, 0, 0}).x, 0.01292f, 1e-6);
}

struct PictureFile {
    test::GameFolder folder;
    std::filesystem::path path = folder / "preview.png";
    std::string text;
    Log log{[this](LogLevel, std::string_view line) { text += line; }};

    Image Read() const {
        std::ifstream file(path, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        return DecodePng(std::as_bytes(std::span(bytes)), "preview");
    }
};

// Share of red, of blue and of purple among the bright pixels right of the plan.
std::array<int, 3> ColorsOfThePairs(const Image &image) {
    std::array<int, 3> counts{};
    for (int row = 60; row < 920; row++)
        for (int column = 900; column < image.width; column++) {
            const auto [red, green, blue, alpha] = image.Texel(column, row);
            if (green > 60 || std::max(red, blue) < 120)
                continue;
            counts[red > 2 * blue ? 0 : blue > 2 * red ? 1 : 2]++;
        }
    return counts;
}

TEST(GridPreview, PictureShowsWhatTheLegacyGridMixes) {
    Bsp bsp = TwoColors();
    PictureFile both;
    WriteGridPreview(both.path, bsp, both.log);
    const Image picture = both.Read();
    EXPECT_EQ(picture.width, 1600);
    EXPECT_EQ(picture.height, 1000);
    const auto [red, blue, purple] = ColorsOfThePairs(picture);
    EXPECT_GT(red, 10000);
    EXPECT_GT(blue, 10000);
    EXPECT_GT(purple, 20000) << "the legacy spheres";
    EXPECT_NE(both.text.find("both grids"), std::string::npos);

    bsp.gridPoints.clear();
    WriteGridPreview(both.path, bsp, both.log);
    EXPECT_NE(both.text.find("SH grid only"), std::string::npos);
    EXPECT_LT(ColorsOfThePairs(both.Read())[2], purple / 2);
}

/// TwoColors with a sparse grid in place of the uniform one: cells of 32 in one root, of 64 elsewhere.
Bsp SparseTwoColors() {
    Bsp bsp = TwoColors();
    SparseGridTree tree{{-384, -384, -128}, {32, 32, 32}, {6, 6, 4}, 2, {}, {}};
    tree.nodes.assign(6 * 6 * 4, {0, 0, 0, 255, 0, 0});
    tree.nodes[0].inner = 1, tree.nodes[0].stored = 254;
    tree.nodes.push_back({0, 0, 0, 255, 0, 0});
    tree.values.assign(6 * 6 * 4 * 8 + 7, bsp.gridSH->points[0]);
    bsp.sparseGridSH = PackSparseGrid(tree);
    bsp.gridSH.reset();
    return bsp;
}

TEST(GridPreview, ShowsASparseGridWithoutTheUniformOne) {
    const Bsp bsp = SparseTwoColors();
    const SHPreview preview(bsp);
    const Vec3f south = LightOn(preview.At({100, 100, 100}), {0, -1, 0});
    EXPECT_NEAR(south.x, 0.8 * 1.0625, 0.01);
    EXPECT_NEAR(south.z, 0.8 * 0.0625, 0.01);
    PictureFile sparse, uniform;
    WriteGridPreview(sparse.path, bsp, sparse.log);
    WriteGridPreview(uniform.path, TwoColors(), uniform.log);
    EXPECT_NE(sparse.text.find("both grids"), std::string::npos);
    int outlines = 0;
    const auto shown = sparse.Read(), plain = uniform.Read();
    for (std::size_t i = 0; i < shown.rgba.size(); i += 4)
        outlines += shown.rgba[i + 1] > plain.rgba[i + 1] + 30;
    EXPECT_GT(outlines, 8 * 500) << "eight lines of cells each way across the room";
}

TEST(GridPreview, NeedsAnSHGrid) {
    Bsp bsp = TwoColors();
    bsp.gridSH.reset();
    PictureFile none;
    EXPECT_THROW(WriteGridPreview(none.path, bsp, none.log), Error);
    EXPECT_FALSE(std::filesystem::exists(none.path));
}

TEST(GridPreview, AbsurdBoundsGiveAPicture) {
    Bsp bsp = TwoColors();
    bsp.entities = "";
    bsp.models[0].mins = {-3e38f, -3e38f, 3e38f};
    bsp.models[0].maxs = {3e38f, -3e38f, 3e38f};
    for (bspGridPointSH_t &point : bsp.gridSH->points)
        point.coeffs[0] = {3e38f, -3e38f, 0};
    PictureFile file;
    EXPECT_NO_THROW(WriteGridPreview(file.path, bsp, file.log));
    EXPECT_EQ(file.Read().height, 1000);
}

TEST(GridPreview, DarkAndSolidMapsGiveAPictureToo) {
    Bsp bsp = TwoColors();
    std::ranges::fill(bsp.gridSH->points, bspGridPointSH_t{});
    for (bspLeaf_t &leaf : bsp.leafs)
        leaf.cluster = -1;
    PictureFile file;
    EXPECT_NO_THROW(WriteGridPreview(file.path, bsp, file.log));
    EXPECT_EQ(file.Read().width, 1600);
}

} // namespace
} // namespace q3
