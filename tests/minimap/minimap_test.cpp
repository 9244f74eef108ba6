// GPL-2.0-or-later. Minimaps: thickness of solids, which brushes count, box, files.
#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "tests/minimap/minimap_fixture.h"

#include <gmock/gmock.h>

#include <random>

namespace q3::test {

namespace {

using testing::Each;
using testing::ElementsAre;
using testing::FloatEq;
using testing::FloatNear;
using testing::HasSubstr;

std::uint8_t ByteAt(const std::vector<std::byte> &file, std::size_t at) {
    return std::to_integer<std::uint8_t>(file.at(at));
}

/// Length of a vertical segment that is behind all planes, cut by one after the other.
double ClippedLength(const std::vector<bspPlane_t> &planes, double x, double y) {
    Vec3d a{x, y, -1e5}, b{x, y, 1e5};
    for (const bspPlane_t &plane : planes) {
        const double da = Dot(Vec3d(plane.normal), a) - plane.dist, db = Dot(Vec3d(plane.normal), b) - plane.dist;
        if (da > 0 && db > 0)
            return 0;
        const Vec3d cut = a + (b - a) * (da / (da - db));
        if (da > 0)
            a = cut;
        else if (db > 0)
            b = cut;
    }
    return Length(b - a);
}

TEST_F(MinimapTest, AQuarterOfTheHeightIsAQuarterOfTheValue) {
    AddBox({0, 0, 32}, {64, 128, 96});
    EXPECT_THAT(Values(2), ElementsAre(0.25f, 0, 0.25f, 0));
    EXPECT_THAT(MinimapBytes(Values(2)), ElementsAre(64, 0, 64, 0));
}

TEST_F(MinimapTest, FullSolidIs255) {
    AddBox({0, 0, 0}, {128, 128, 256});
    EXPECT_THAT(MinimapBytes(Values(3)), Each(255));
}

TEST_F(MinimapTest, OverlappingSolidsCountTwice) {
    AddBox({0, 0, 0}, {128, 128, 64});
    AddBox({0, 0, 32}, {128, 128, 96});
    EXPECT_THAT(Values(1), ElementsAre(0.5f));
}

TEST_F(MinimapTest, MatchesSegmentsCutByThePlanes) {
    std::mt19937 random(7);
    const auto number = [&](double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; };
    std::vector<std::vector<bspPlane_t>> brushes;
    for (int i = 0; i < 40; ++i) {
        const Vec3d center{number(10, 118), number(10, 118), number(20, 200)};
        const double radius = number(5, 40);
        std::vector<bspPlane_t> planes = BoxPlanes(Vec3f(center - Vec3d{radius, radius, radius}).Array(),
                                                   Vec3f(center + Vec3d{radius, radius, radius}).Array());
        for (int k = 0; k < i % 9; ++k) {
            const Vec3d n = Normalize(Vec3d{number(-1, 1), number(-1, 1), k % 3 == 0 ? 0 : number(-1, 1)});
            planes.push_back({Vec3f(n).Array(), float(Dot(n, center) + radius * number(0.2, 1.2))});
        }
        AddBrush(planes);
        brushes.push_back(planes);
    }
    constexpr int kSize = 47;
    const std::vector<float> values = Values(kSize);
    double most = 0;
    for (int row = 0; row < kSize; ++row)
        for (int column = 0; column < kSize; ++column) {
            double sum = 0;
            for (const auto &planes : brushes)
                sum += ClippedLength(planes, (column + 0.5) * 128 / kSize, (row + 0.5) * 128 / kSize);
            EXPECT_NEAR(values[std::size_t(row * kSize + column)], sum / 256, 1e-6) << column << ", " << row;
            most = std::max(most, sum);
        }
    EXPECT_GT(most, 50);
}

TEST_F(MinimapTest, OnlySolidsWithoutSkyCount) {
    folder.Write("scripts/test.shader",
                 "textures/sky\n{\nsurfaceparm sky\n}\ntextures/clip\n{\nsurfaceparm playerclip\n}\n"
                 "textures/water\n{\nsurfaceparm water\n}\n");
    AddBox({0, 0, 0}, {128, 128, 64}, AddShader("textures/sky", 1));
    AddBox({0, 0, 0}, {128, 128, 64}, AddShader("textures/clip", 0x10000));
    AddBox({0, 0, 0}, {128, 128, 64}, AddShader("textures/water", 0x20));
    AddBox({0, 0, 0}, {128, 128, 64}, AddShader("noshader", 1));
    EXPECT_THAT(Values(1), ElementsAre(0));
    AddBox({0, 0, 0}, {128, 128, 32});
    bsp.brushSides.back().shaderNum = 4; // a side without a shader changes nothing
    EXPECT_THAT(Values(1), ElementsAre(0.125f));
    bsp.brushSides.back().shaderNum = 1; // one of sky does
    EXPECT_THAT(Values(1), ElementsAre(0));
}

TEST_F(MinimapTest, BrushesOfEntitiesDoNotCount) {
    AddBox({0, 0, 0}, {128, 128, 64});
    bsp.models.push_back({{0, 0, 0}, {128, 128, 64}, 0, 0, 0, 1});
    bsp.models.front().numBSPBrushes = 0;
    EXPECT_THAT(Values(1), ElementsAre(0));
}

TEST_F(MinimapTest, TheBoxGrowsToASquareAndABorder) {
    const Boundsd given{{-100, -200, -300}, {400, 500, 600}};
    const Boundsd square = MinimapBox(given, true, 0);
    EXPECT_EQ(square.mins, Vec3d(-200, -200, -300));
    EXPECT_EQ(square.maxs, Vec3d(500, 500, 600));
    // 1/66 of the image on each side: 64/66 are the map, so it grows by 1/64 of its size.
    const Boundsd wide = MinimapBox(given, true, 1.0 / 66);
    EXPECT_NEAR(wide.mins.x, -210.9375, 1e-9);
    EXPECT_NEAR(wide.maxs.y, 510.9375, 1e-9);
    EXPECT_NEAR(wide.mins.z, -314.0625, 1e-9);
    EXPECT_NEAR(wide.maxs.z, 614.0625, 1e-9);
    const Boundsd stretched = MinimapBox(given, false, 0);
    EXPECT_EQ(stretched.mins, given.mins);
    EXPECT_EQ(stretched.maxs, given.maxs);
}

TEST_F(MinimapTest, PrintsTheBoxBeforeAndAfter) {
    options.border = 0.25;
    Draw(1);
    EXPECT_THAT(out.text, HasSubstr("size 0.000000 0.000000 0.000000 128.000000 128.000000 256.000000\n"));
    EXPECT_THAT(out.text,
                HasSubstr("size_texcoords -64.000000 -64.000000 -128.000000 192.000000 192.000000 384.000000\n"));
}

TEST_F(MinimapTest, ABoxCanBeGiven) {
    AddBox({0, 0, 0}, {128, 128, 64});
    options.box = Boundsd{{0, 64, 0}, {128, 192, 128}};
    EXPECT_THAT(Values(2), ElementsAre(0.5f, 0.5f, 0, 0));
}

TEST_F(MinimapTest, AWorldWithoutHeightIsAnError) {
    bsp.models.front().maxs[2] = 0;
    EXPECT_THROW(Draw(1), Error);
}

TEST_F(MinimapTest, TheLastRowOfTheFileIsTheNorthEnd) {
    AddBox({0, 64, 0}, {64, 128, 64}); // low x, high y
    const auto file = MinimapTga(Draw(2).image, MinimapPixels::Gray);
    ASSERT_EQ(file.size(), 18u + 4u);
    EXPECT_THAT((std::vector<int>{ByteAt(file, 18), ByteAt(file, 19), ByteAt(file, 20), ByteAt(file, 21)}),
                ElementsAre(0, 0, 64, 0));
    const Image image = DecodeTga(file, "minimap"); // row 0 on top
    EXPECT_EQ(image.Texel(0, 0)[0], 64);
    EXPECT_EQ(image.Texel(0, 1)[0], 0);
}

TEST_F(MinimapTest, GrayFilesHaveOneByteAPixel) {
    const auto file = MinimapTga(Draw(300).image, MinimapPixels::Gray);
    EXPECT_EQ(file.size(), 18u + 300u * 300u);
    const std::vector<int> expected{0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 44, 1, 44, 1, 8, 0};
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_EQ(ByteAt(file, i), expected[i]) << i;
}

TEST_F(MinimapTest, BlackAndWhiteKeepTheValueAsAlpha) {
    AddBox({0, 0, 0}, {128, 128, 128});
    for (const auto &[pixels, color] : {std::pair(MinimapPixels::Black, 0), std::pair(MinimapPixels::White, 255)}) {
        const auto file = MinimapTga(Draw(1).image, pixels);
        ASSERT_EQ(file.size(), 18u + 4u);
        EXPECT_EQ(ByteAt(file, 2), 2);
        EXPECT_EQ(ByteAt(file, 16), 32);
        EXPECT_EQ(ByteAt(file, 17), 8) << "bits of alpha, first row at the bottom";
        EXPECT_THAT(DecodeTga(file, "minimap").Texel(0, 0), ElementsAre(color, color, color, 128));
    }
}

TEST_F(MinimapTest, ThreadsDoNotChangeTheImage) {
    for (float i = 0; i < 20; ++i)
        AddBox({6 * i, 128 - 6 * i, 3 * i}, {6 * i + 9, 140 - 6 * i, 200 - 7 * i});
    options.randomSamples = 3;
    EXPECT_EQ(Draw(33, "quake3", 1).image.values, Draw(33, "quake3", 4).image.values);
}

TEST_F(MinimapTest, GamesHaveTheirOwnDefaults) {
    const std::filesystem::path bspPath = "/game/maps/arena.bsp";
    EXPECT_EQ(options.Output(MinimapStyleOf("quake3"), bspPath), "/game/maps/arena.tga");
    EXPECT_EQ(options.Output(MinimapStyleOf("Xonotic"), bspPath), "/game/gfx/arena_mini.tga");
    EXPECT_EQ(options.Output(MinimapStyleOf("unvanquished"), bspPath), "/game/minimaps/arena.tga");
    EXPECT_EQ(options.Pixels(MinimapStyleOf("nexuiz")), MinimapPixels::Gray);
    EXPECT_EQ(options.Pixels(MinimapStyleOf("unvanquished")), MinimapPixels::White);
    EXPECT_DOUBLE_EQ(options.Border(MinimapStyleOf("nexuiz")), 1.0 / 66);
    EXPECT_DOUBLE_EQ(options.Border(MinimapStyleOf("unvanquished")), 0);
    options.gray = true;
    options.border = 0.125;
    options.output = "/else/where.tga";
    EXPECT_EQ(options.Pixels(MinimapStyleOf("unvanquished")), MinimapPixels::Gray);
    EXPECT_DOUBLE_EQ(options.Border(MinimapStyleOf("nexuiz")), 0.125);
    EXPECT_EQ(options.Output(MinimapStyleOf("xonotic"), bspPath), "/else/where.tga");
}

TEST_F(MinimapTest, WritesImageAndTextFileIntoANewFolder) {
    Load();
    options.size = 4;
    WriteMinimap(bsp, folder / "maps/arena.bsp", *library, options, MinimapStyleOf("unvanquished"), JobPool(1),
                 out.log);
    EXPECT_EQ(folder.ReadBack("minimaps/arena.tga").size(), 18u + 64u);
    EXPECT_EQ(folder.ReadBack("minimaps/arena.minimap"),
              "{\n\tbackgroundColor 0.0 0.0 0.0 0.333\n\tzone {\n"
              "\t\tbounds 0.000000 0.000000 0.000000 128.000000 128.000000 256.000000\n"
              "\t\timage \"minimaps/arena\" 0.000000 0.000000 128.000000 128.000000\n\t}\n}\n");
}

} // namespace

} // namespace q3::test
