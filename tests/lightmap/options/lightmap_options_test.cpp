// GPL-2.0-or-later. Options of lightmaps, vertex light and bounces on the command line.
#include "q3map2/lightmap/options/lightmap_options.h"

#include "common/error.h"
#include "common/settings.h"
#include "tests/support/game_folder.h"

#include <sstream>

namespace q3::test {

namespace {

class LightmapOptionsTest : public testing::Test {
  protected:
    LightmapOptions Parse(const std::string &text, std::string_view game = "quake3") {
        std::istringstream in(text);
        Arguments arguments({std::istream_iterator<std::string>(in), {}});
        light = ParseLightOptions(arguments, *FindGame(game), log.log);
        const LightmapOptions options = ParseLightmapOptions(arguments, light, *FindGame(game), log.log);
        rest = arguments.Rest();
        return options;
    }

    KeptLog log;
    LightOptions light;
    std::vector<std::string> rest;
};

TEST_F(LightmapOptionsTest, Defaults) {
    const LightmapOptions o = Parse("");
    EXPECT_EQ(o.super, 1);
    EXPECT_EQ(o.samples, 1);
    EXPECT_EQ(o.bounces, 0);
    EXPECT_FLOAT_EQ(o.bounceScale, 0.25f);
    EXPECT_EQ(o.pageSize, (std::array{128, 128}));
    EXPECT_TRUE(o.collapse && o.fastAllocate && o.fastPoint);
    EXPECT_FALSE(o.external || o.deluxe || o.dirty || o.shade || o.noVertex || o.halfLambert || o.onlyGrid);
}

TEST_F(LightmapOptionsTest, EveryOptionIsTaken) {
    const LightmapOptions o = Parse(
        "-super 3 -samples 4 -randomsamples -samplessearchboxsize 2 -filter -thresh 0.5 -samplesize 8 -minsamplesize 4 "
        "-samplescale 2 -rawlightmapsizelimit 64 -trianglecheck -extravisnudge -dark -shadeangle 70 -lightanglehl 1 "
        "-nofastpoint -fastbounce -dirty -dirtmode 1 -dirtdepth 64 -dirtscale 2 -dirtgain 3 -bounce 5 -bouncegrid "
        "-bounceonly -nobouncestore -bouncescale 2 -bouncecolorratio 0.5 -vertexscale 3 -cpma -nolm -brightness 1.5 "
        "-approx 8 -nocollapse -slowallocate -lightmapsearchblocksize 4 -fill -fillpink -export -trisoup -dump "
        "-sRGBtex -debug -border -debugnormals -debugdeluxe -debugsamplesize -debugaxis -onlygrid");
    EXPECT_TRUE(rest.empty()) << rest.front();
    EXPECT_EQ(o.super, 3);
    EXPECT_EQ(o.samples, 4);
    EXPECT_TRUE(o.randomSamples && !o.samplesExact && o.filter && o.triangleCheck && o.extraVisNudge && o.dark);
    EXPECT_EQ(o.samplesSearchBox, 2);
    EXPECT_FLOAT_EQ(o.threshold, 0.5f);
    EXPECT_EQ((std::array{o.sampleSize, o.minSampleSize, o.sampleScale, o.rawSizeLimit}), (std::array{8, 4, 2, 64}));
    EXPECT_TRUE(o.shade && o.halfLambert && !o.fastPoint && !o.fast);
    EXPECT_FLOAT_EQ(o.shadeAngle, 70);
    EXPECT_TRUE(o.dirty && o.dirtRandom);
    EXPECT_EQ((std::array{o.dirtDepth, o.dirtScale, o.dirtGain}), (std::array{64.0f, 2.0f, 3.0f}));
    EXPECT_EQ(o.bounces, 5);
    EXPECT_TRUE(o.bounceGrid && o.bounceOnly);
    EXPECT_FLOAT_EQ(o.bounceScale, 0.5f);
    EXPECT_FLOAT_EQ(o.bounceColorRatio, 0.5f);
    EXPECT_FLOAT_EQ(o.vertexScale, 3);
    EXPECT_TRUE(o.cpma && o.noLightmaps && !o.collapse && !o.fastAllocate && o.fill && o.fillPink);
    EXPECT_FLOAT_EQ(o.brightness, 1.5f);
    EXPECT_FLOAT_EQ(o.approximate, 8);
    EXPECT_EQ(o.searchBlock, 4);
    EXPECT_TRUE(o.exportPages && o.triangleSoup && o.sRgbTexture && o.debug && o.border && o.debugNormals);
    EXPECT_TRUE(o.debugDeluxe && o.deluxe && o.debugSampleSize && o.onlyGrid);
    EXPECT_EQ(o.show, DebugView::Axis);
}

TEST_F(LightmapOptionsTest, WhatTheGridsShareComesFromTheirs) {
    const LightmapOptions o = Parse("-faster -cheap");
    EXPECT_TRUE(o.fast && o.faster && o.cheap);
    EXPECT_TRUE(light.fastGrid && light.cheapGrid);
    const LightmapOptions grid = Parse("-fastgrid -cheapgrid");
    EXPECT_FALSE(grid.fast || grid.faster || grid.cheap) << "the grids only";
    EXPECT_TRUE(light.fastGrid && light.cheapGrid);
    EXPECT_TRUE(Parse("-sRGB").sRgbTexture);
    EXPECT_FALSE(Parse("-nosRGB", "xonotic").sRgbTexture);
}

TEST_F(LightmapOptionsTest, UnknownWordsStay) {
    Parse("-bounce 2 -extra -samples 2 4");
    EXPECT_EQ(rest, (std::vector<std::string>{"-extra", "4"}));
    WarnOfUnknown(Arguments(rest), log.log);
    EXPECT_EQ(log.log.WarningCount("unknown argument"), 2);
}

TEST_F(LightmapOptionsTest, LiteralNumbersOfSamples) {
    const LightmapOptions o = Parse("-samples +100 -randomsamples");
    EXPECT_TRUE(o.samplesExact);
    EXPECT_EQ(o.samples, 100);
}

TEST_F(LightmapOptionsTest, ConstantVertexLightHasAnOptionalValue) {
    EXPECT_FLOAT_EQ(*Parse("-novertex").noVertex, 1);
    EXPECT_FLOAT_EQ(*Parse("-novertex 0.25 -dark").noVertex, 0.25f);
    const LightmapOptions o = Parse("-novertex -dark");
    EXPECT_FLOAT_EQ(*o.noVertex, 1);
    EXPECT_TRUE(o.dark && rest.empty());
}

TEST_F(LightmapOptionsTest, PageSizes) {
    LightmapOptions o = Parse("-lightmapsize 512");
    EXPECT_EQ(o.pageSize, (std::array{512, 512}));
    EXPECT_TRUE(o.external) << "not the game's size: images beside the map";
    o = Parse("-lightmapsize 256 64 -fill");
    EXPECT_EQ(o.pageSize, (std::array{256, 64}));
    EXPECT_TRUE(o.fill && rest.empty());
    o = Parse("-lightmapsize 128");
    EXPECT_FALSE(o.external);
    o = Parse("-lightmapsize 100");
    EXPECT_EQ(o.pageSize, (std::array{128, 128}));
    EXPECT_EQ(log.log.WarningCount("page size"), 1);
    EXPECT_THROW(Parse("-lightmapsize"), Error);
    o = Parse("-lightmapsize 512", "tenebrae");
    EXPECT_FALSE(o.external) << "the size of that game";
    o = Parse("-extlmhacksize 256");
    EXPECT_EQ(o.pageSize, (std::array{256, 256}));
    EXPECT_FALSE(o.external) << "shown by made shaders";
    o = Parse("-lightmapdir light/maps");
    EXPECT_TRUE(o.external);
    EXPECT_EQ(o.externalFolder, "light/maps");
}

TEST_F(LightmapOptionsTest, SearchBlocks) {
    EXPECT_EQ(Parse("").searchBlock, 0);
    EXPECT_EQ(Parse("-nolightmapsearch").searchBlock, 1);
    EXPECT_EQ(Parse("-lightmapsearchpower 2").searchBlock, 16);
    EXPECT_EQ(Parse("-lightmapsearchpower 2 -lightmapsize 256").searchBlock, 4);
    EXPECT_EQ(Parse("-lightmapsearchpower -3").searchBlock, 1);
}

TEST_F(LightmapOptionsTest, GamesHaveTheirDefaults) {
    EXPECT_TRUE(Parse("", "tenebrae").deluxe);
    EXPECT_EQ(Parse("", "tenebrae").gamePageSize, (std::array{512, 512}));
    EXPECT_TRUE(Parse("", "dq").deluxeTangent);
    EXPECT_TRUE(Parse("", "prophecy").deluxe && !Parse("", "prophecy").deluxeTangent);
    EXPECT_FALSE(Parse("-nodeluxe", "dq").deluxe);
    EXPECT_FALSE(Parse("-deluxemode 0", "dq").deluxeTangent);
    EXPECT_TRUE(Parse("-deluxe -deluxemode 1").deluxeTangent);
    EXPECT_TRUE(Parse("", "xonotic").sRgbTexture);
}

TEST_F(LightmapOptionsTest, ValuesWithoutMeaningAreDefaults) {
    const LightmapOptions o = Parse("-dirtdepth 0 -dirtscale -1 -dirtmode 7 -thresh -2 -brightness -1");
    EXPECT_EQ((std::array{o.dirtDepth, o.dirtScale, o.threshold, o.brightness}),
              (std::array{128.0f, 1.0f, 1.0f, 1.0f}));
    EXPECT_EQ(log.log.WarningCount("value out of range"), 5);
    EXPECT_FALSE(o.dirtRandom);
}

TEST_F(LightmapOptionsTest, NumbersOutOfRangeFail) {
    for (const auto *text : {"-super 9", "-super 0", "-samples 0", "-samples 65", "-bounce -1", "-bounce x -super x",
                             "-samplessearchboxsize 5", "-samplesize 0", "-bounce", "-dirtgain x", "-dirtgain 1.5x",
                             "-bounce 2.5", "-thresh nan", "-brightness inf", "-novertex 2", "-lightmapdir -dark"})
        EXPECT_THROW(Parse(text), Error) << text;
}

TEST_F(LightmapOptionsTest, NeedlessOptionsAreNamed) {
    Parse("-lomem -fastallocate");
    EXPECT_EQ(log.log.WarningCount("options without effect"), 1);
    EXPECT_NE(log.text.find("without effect: -lomem (Memory is always saved), -fastallocate ("), std::string::npos);
    EXPECT_TRUE(rest.empty());
}

} // namespace

} // namespace q3::test
