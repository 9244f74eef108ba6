// GPL-2.0-or-later. Explanations of light: three faults of maps, each with its smallest map.
#include "q3map2/lightmap/explain/explain.h"
#include "q3map2/lightmap/explain/explain_report.h"
#include "tests/support/compiled_map.h"
#include "tests/support/light_fixture.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <functional>

namespace q3::test {

namespace {

/// Number of the first line that holds `part`, from 1.
int LineOf(std::string_view text, std::string_view part) {
    const std::size_t at = text.find(part);
    EXPECT_NE(at, std::string_view::npos) << part;
    return 1 + int(std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'));
}

/// Number of the line with the "{" before the first `part`.
int BraceBefore(std::string_view text, std::string_view part) {
    const std::size_t at = text.rfind('{', text.find(part));
    return 1 + int(std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'));
}

class ExplainTest : public LightTest {
  protected:
    /// Compiles and lights the scene, and sets it up to be explained with the same options.
    void Explain(const SceneBuilder &scene, std::string_view options,
                 const std::function<void(const Explainer &, const JobPool &)> &use) {
        KeptLog quiet;
        VirtualFileSystem vfs(quiet.log);
        vfs.Mount(folder.Root(), "pk3");
        vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
        text = scene.MapText();
        surfaces = true;
        const Bsp lit = Lit(CompiledText(text, vfs), options);
        std::istringstream words("-sh " + std::string(options));
        Arguments arguments({std::istream_iterator<std::string>(words), {}});
        const Game &game = *FindGame("quake3");
        const LightOptions light = ParseLightOptions(arguments, game, quiet.log);
        const LightmapOptions lightmap = ParseLightmapOptions(arguments, light, game, quiet.log);
        ShaderLibrary library(vfs, game, light.shader, quiet.log);
        LightInputs inputs;
        inputs.name = "test";
        inputs.mapEntities = ParseMapEntities(text, "test.map");
        const JobPool jobs(1);
        const Bsp before = lit;
        const Explainer explainer(lit, inputs, text, "test.map", light, lightmap, library, game, jobs, quiet.log);
        use(explainer, jobs);
        EXPECT_EQ(lit.lightmaps, before.lightmaps);
        EXPECT_EQ(lit.entities, before.entities);
    }
    Explanation Explained(const SceneBuilder &scene, const Vec3f &p, std::string_view options = "") {
        Explanation explanation;
        Explain(scene, options,
                [&](const Explainer &explainer, const JobPool &) { explanation = explainer.Explain(p); });
        report = ReportOf(explanation);
        return explanation;
    }
    bool Reports(std::string_view part) const { return report.find(part) != std::string::npos; }

    std::string text, report;
};

/// A room in two halves, with a lamp in the half of x > 0.
SceneBuilder HalvedRoom(float wallBottom) {
    SceneBuilder scene = Room({-250, -186, -60}, {250, 186, 196});
    scene.AddBox({-2, -186, wallBottom}, {2, 186, 196}, TestShader("textures/test/thin"));
    scene.AddEntity(MakeEntity("light", {{"origin", "120 10 70"}, {"light", "300"}, {"targetname", "lamp"}}));
    return scene;
}

const LightAccount *Lamp(const std::vector<LightAccount> &lights) {
    const auto found = std::ranges::find(lights, std::string("lamp"),
                                         [](const LightAccount &light) { return light.source.targetName; });
    return found == lights.end() ? nullptr : &*found;
}

const GridPointAccount *CornerAt(const Explanation &explanation, const Vec3f &p) {
    const auto found = std::ranges::find(explanation.grid, p, &GridPointAccount::position);
    return found == explanation.grid.end() ? nullptr : &*found;
}

TEST_F(ExplainTest, AWallInTheWayIsNamedWithItsLine) {
    const Explanation dark = Explained(HalvedRoom(-60), {-100, 10, 70});
    ASSERT_FALSE(dark.place.solid);
    const LightAccount *lamp = Lamp(dark.lights);
    ASSERT_TRUE(lamp);
    EXPECT_EQ(lamp->fate, LightFate::Blocked);
    EXPECT_NEAR(double(lamp->distance), 220, 0.01);
    // 300 * 7500 / d^2
    EXPECT_NEAR(double(lamp->unshadowed.x), 300 * 7500 / (220.0 * 220), 0.1);
    EXPECT_EQ(lamp->arriving, Vec3f{});
    ASSERT_EQ(lamp->obstacles.size(), 1u);
    EXPECT_EQ(lamp->obstacles[0].kind, ObstacleKind::Brush);
    EXPECT_EQ(lamp->obstacles[0].shader, "textures/test/thin");
    EXPECT_NEAR(double(lamp->obstacles[0].length), 98, 0.5);
    EXPECT_EQ(lamp->obstacles[0].source.location, fmt::format("test.map:{}", LineOf(text, "test/thin")));
    EXPECT_EQ(lamp->source.location, fmt::format("test.map:{}", BraceBefore(text, "\"light\"")));
    EXPECT_TRUE(Reports("entity 1, light \"lamp\"")) << report;
}

TEST_F(ExplainTest, LightThatLeaksBelowAWallIsNamed) {
    // 10 units of gap over the floor; the lamp is 6 units over it.
    SceneBuilder scene = Room({-250, -186, -60}, {250, 186, 196});
    scene.AddBox({-2, -186, -50}, {2, 186, 196}, TestShader("textures/test/thin"));
    scene.AddEntity(MakeEntity("light", {{"origin", "120 10 -54"}, {"light", "3000"}, {"targetname", "lamp"}}));
    const Explanation leak = Explained(scene, {-100, 10, -56});
    const LightAccount *lamp = Lamp(leak.lights);
    ASSERT_TRUE(lamp);
    EXPECT_EQ(lamp->fate, LightFate::Arrives);
    EXPECT_NEAR(double(lamp->Visible()), 1, 1e-4);
    EXPECT_TRUE(lamp->obstacles.empty());
    ASSERT_TRUE(leak.luxel);
    const LightAccount *onFloor = Lamp(leak.luxel->lights);
    ASSERT_TRUE(onFloor);
    EXPECT_EQ(onFloor->fate, LightFate::Arrives) << report;
    // The floor gets 3000 * 7500 / d^2 times the cosine, at the position that the report names.
    ASSERT_TRUE(leak.luxel->samples.at(0).position);
    const Vec3d way = Vec3d{120, 10, -54} - Vec3d(*leak.luxel->samples[0].position);
    const double expected = 3000 * 7500 / Dot(way, way) * (way.z / Length(way));
    EXPECT_NEAR(double(onFloor->arriving.x), expected, 0.01 * expected);
    ASSERT_TRUE(leak.luxel->direct && leak.luxel->stored);
    EXPECT_NEAR(double(leak.luxel->direct->x), expected, 0.01 * expected);
    EXPECT_NEAR(double((*leak.luxel->stored)[0]), expected, 1);
}

TEST_F(ExplainTest, AGridPointInAThinWallSaysWhichSidesItTookLightFrom) {
    const Explanation dark = Explained(HalvedRoom(-60), {-10, 20, 70}, "-gridsh 32 32 32");
    const GridPointAccount *inWall = CornerAt(dark, {0, 0, 64});
    ASSERT_TRUE(inWall);
    EXPECT_TRUE(inWall->solid);
    EXPECT_EQ(inWall->state, PointState::Filled);
    EXPECT_EQ(inWall->groups, 2);
    double fraction[2] = {}; // of the dark and of the lit side
    for (const SourceAccount &source : inWall->sources) {
        EXPECT_GT(std::abs(source.litFrom.x), 2);
        EXPECT_EQ(source.light > 1, source.litFrom.x > 0);
        fraction[source.litFrom.x > 0 ? 1 : 0] += double(source.fraction);
    }
    EXPECT_NEAR(fraction[0] + fraction[1], 1, 1e-4);
    EXPECT_GT(fraction[0], 0.99); // the darker side counts more
    EXPECT_TRUE(Reports("2 groups that do not see each other")) << report;
    const GridPointAccount *behind = CornerAt(dark, {-32, 0, 64});
    ASSERT_TRUE(behind);
    EXPECT_EQ(behind->state, PointState::Open);
    EXPECT_EQ(behind->litFrom, behind->position);
    EXPECT_EQ(behind->traced, 0);
}

TEST_F(ExplainTest, ALightInABrushIsNamedWithTheBrush) {
    SceneBuilder scene = Room({-250, -186, -60}, {250, 186, 196});
    scene.AddBox({100, -20, 40}, {140, 40, 100}, TestShader("textures/test/block"));
    scene.AddEntity(MakeEntity("light", {{"origin", "120 10 70"}, {"light", "300"}, {"targetname", "lamp"}}));
    scene.AddEntity(MakeEntity("light", {{"origin", "-120 10 70"}, {"light", "100"}}));
    const Explanation point = Explained(scene, {0, 10, 70});
    const LightAccount *lamp = Lamp(point.lights);
    ASSERT_TRUE(lamp);
    EXPECT_EQ(lamp->fate, LightFate::InSolid);
    ASSERT_TRUE(lamp->inside);
    EXPECT_EQ(lamp->inside->kind, ObstacleKind::Brush);
    EXPECT_EQ(lamp->inside->source.location, fmt::format("test.map:{}", LineOf(text, "test/block")));
    EXPECT_TRUE(Reports("it is inside a solid: brush")) << report;
    EXPECT_TRUE(Reports(fmt::format("(test.map:{})", LineOf(text, "test/block"))));
    EXPECT_EQ(point.lights[0].fate, LightFate::Arrives);
    EXPECT_NEAR(double(point.lights[0].arriving.x), 100 * 7500 / (120.0 * 120), 0.1);
}

TEST_F(ExplainTest, AGridPointLitFromTheWrongSideSaysWhere) {
    // Cells of 64 put no point into either room; the nearest open place of that in the wall is in the lit room.
    SceneBuilder scene = Room({-60, -28, -28}, {60, 28, 28});
    scene.AddBox({-20, -28, -28}, {24, 28, 28}, TestShader("textures/test/thick"));
    scene.AddEntity(MakeEntity("light", {{"origin", "-40 0 0"}, {"light", "30"}, {"targetname", "lamp"}}));
    const Explanation dark = Explained(scene, {40, 0, 0}, "-gridsh 64 64 64");
    const LightAccount *lamp = Lamp(dark.lights);
    ASSERT_TRUE(lamp);
    EXPECT_EQ(lamp->fate, LightFate::Blocked);
    const GridPointAccount *wrong = CornerAt(dark, {0, 0, 0});
    ASSERT_TRUE(wrong);
    EXPECT_EQ(wrong->state, PointState::Moved);
    ASSERT_TRUE(wrong->litFrom && wrong->solid);
    EXPECT_LT(wrong->litFrom->x, -20);
    EXPECT_EQ(wrong->solid->shader, "textures/test/thick");
    EXPECT_GT(wrong->traced, 50);
    EXPECT_TRUE(Reports("Moved (lit from the nearest open place), in brush")) << report;
    EXPECT_TRUE(Reports("lit from -32 ")) << report;
}

TEST_F(ExplainTest, APointInASolidNamesTheBrush) {
    const Explanation solid = Explained(HalvedRoom(-60), {1, 40, 70});
    ASSERT_TRUE(solid.place.solid);
    EXPECT_EQ(solid.place.solid->shader, "textures/test/thin");
    EXPECT_EQ(solid.place.solid->source.location, fmt::format("test.map:{}", LineOf(text, "test/thin")));
    ASSERT_TRUE(solid.place.litFrom);
    EXPECT_EQ(*solid.place.litFrom, (Vec3f{3, 40, 70}));
}

TEST_F(ExplainTest, WhatTheOptionsExcludeIsSaid) {
    SceneBuilder scene = Room();
    scene.AddEntity(MakeEntity(
        "light",
        {{"origin", "100 0 128"}, {"light", "300"}, {"target", "aim"}, {"radius", "16"}, {"targetname", "lamp"}}));
    scene.AddEntity(MakeEntity("info_null", {{"origin", "100 0 20"}, {"targetname", "aim"}}));
    const Explanation point = Explained(scene, {-100, 0, 100});
    const LightAccount *lamp = Lamp(point.lights);
    ASSERT_TRUE(lamp);
    EXPECT_EQ(lamp->type, LightType::Spot);
    EXPECT_EQ(lamp->fate, LightFate::OutsideCone);
    EXPECT_TRUE(Reports("outside of its cone")) << report;
}

/// Samples of a luxel beside a block: those in it are named.
TEST_F(ExplainTest, SamplesOfALuxelInsideASolidAreNamed) {
    SceneBuilder scene = Room({-250, -186, 0}, {250, 186, 252});
    scene.AddBox({-41, -41, 0}, {41, 41, 60}, TestShader("textures/test/block"));
    scene.AddEntity(MakeEntity("light", {{"origin", "150 0 128"}, {"light", "300"}, {"targetname", "lamp"}}));
    const Explanation point = Explained(scene, {47, 0, 1}, "-super 4");
    ASSERT_TRUE(point.luxel);
    EXPECT_EQ(point.luxel->samples.size(), 16u);
    const auto in = std::ranges::count_if(point.luxel->samples, [](const SampleAccount &sample) {
        return !sample.position && sample.solid && sample.solid->shader == "textures/test/block";
    });
    const auto lit = std::ranges::count_if(point.luxel->samples,
                                           [](const SampleAccount &sample) { return sample.position.has_value(); });
    EXPECT_GT(lit, 0);
    EXPECT_EQ(in + lit, 16) << report;
}

/// Luxels of the report are those of the bake: the direct light, rounded, is in the page.
TEST_F(ExplainTest, TheDirectLightOfALuxelIsThatOfThePage) {
    SceneBuilder scene = HalvedRoom(-60);
    for (const Vec3f p : {Vec3f{50, 3, -50}, {200, -100, -50}, {240, 20, 70}, {120, 160, 100}}) {
        const Explanation point = Explained(scene, p, "-samples 3 -dirty");
        ASSERT_TRUE(point.luxel && point.luxel->direct && point.luxel->stored);
        for (std::size_t channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(double((*point.luxel->stored)[channel]),
                        std::min(255.0, double((*point.luxel->direct)[channel])), 1.01)
                << report;
    }
}

/// A room of 500 x 372 x 256 units without a wall: 16 places or more for each of its six sides.
TEST_F(ExplainTest, PlacesCoverAllSidesOfARoom) {
    Explain(Room({-250, -186, -60}, {250, 186, 196}), "", [](const Explainer &explainer, const JobPool &) {
        const std::vector<PlaceInFront> places = PlacesInFrontOfSurfaces(explainer, 200);
        EXPECT_LE(places.size(), 200u);
        std::map<std::array<int, 3>, int> byDirection;
        for (const PlaceInFront &place : places) {
            const Vec3f direction = (place.point - place.onSurface) / 24.0f;
            EXPECT_NEAR(double(Length(direction)), 1, 1e-4);
            ++byDirection[{int(std::lround(direction.x)), int(std::lround(direction.y)),
                           int(std::lround(direction.z))}];
        }
        EXPECT_EQ(byDirection.size(), 6u);
        for (const auto &[direction, count] : byDirection)
            EXPECT_GE(count, 16) << direction[0] << ' ' << direction[1] << ' ' << direction[2];
        EXPECT_EQ(PlacesInFrontOfSurfaces(explainer, 1).size(), 1u);
    });
}

/// Between a floor and a block 10 units over it there is room for 8 units, not for a player's 24.
TEST_F(ExplainTest, PlacesAreOnTheSideOfTheirSurface) {
    SceneBuilder scene = Room({-250, -186, -60}, {250, 186, 196});
    scene.AddBox({-250, -186, -50}, {250, 186, -40}, TestShader("textures/test/block"));
    Explain(scene, "", [](const Explainer &explainer, const JobPool &) {
        int between = 0;
        for (const PlaceInFront &place : PlacesInFrontOfSurfaces(explainer, 300)) {
            EXPECT_TRUE(place.point.z < -50 || place.point.z > -40) << place.point.z;
            EXPECT_EQ(place.point.z < -50, place.onSurface.z < -45) << place.onSurface.z;
            between += place.point.z < -50 ? 1 : 0;
        }
        EXPECT_GT(between, 20);
    });
}

TEST_F(ExplainTest, ExplanationsOfPlacesHaveTheReportAndTheRays) {
    Explain(HalvedRoom(-60), "", [](const Explainer &explainer, const JobPool &jobs) {
        const std::array<PlaceInFront, 2> places{
            {{{120, 10, -60}, {120, 10, -36}}, {{-120, 10, -60}, {-120, 10, -36}}}};
        KeptLog quiet;
        const auto json =
            nlohmann::json::parse(ExplanationsJson(explainer, places, "maps/x.bsp", "-sh", jobs, quiet.log));
        EXPECT_EQ(json["map"], "maps/x.bsp");
        EXPECT_EQ(json["options"], "-sh");
        ASSERT_EQ(json["places"].size(), 2u);
        const auto &lit = json["places"][0], &dark = json["places"][1];
        EXPECT_EQ(lit["on"], nlohmann::json({120, 10, -60}));
        EXPECT_EQ(lit["text"], ReportOf(explainer.Explain({120, 10, -36}), {.lights = 8, .nothing = 6, .sources = 4}));
        ASSERT_EQ(lit["rays"].size(), 1u);
        EXPECT_EQ(lit["rays"][0]["to"], nlohmann::json({120, 10, 70}));
        EXPECT_EQ(lit["rays"][0]["visible"], 1);
        EXPECT_FALSE(lit["rays"][0].contains("stops"));
        ASSERT_EQ(dark["rays"].size(), 1u);
        EXPECT_EQ(dark["rays"][0]["visible"], 0);
        ASSERT_EQ(dark["rays"][0]["stops"].size(), 1u);
        EXPECT_NEAR(dark["rays"][0]["stops"][0][0].get<double>(), -2, 0.01); // the wall is 4 units thick
    });
}

} // namespace

} // namespace q3::test
