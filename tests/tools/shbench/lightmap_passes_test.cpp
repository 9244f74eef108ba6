// GPL-2.0-or-later. Lightmaps pass by pass: names, rays, shares.
#include "common/error.h"
#include "tests/tools/shbench/bench_fixture.h"
#include "tools/measure/shbench/lightmap_passes.h"

#include <nlohmann/json.hpp>

#include <algorithm>

#include <gmock/gmock.h>

namespace q3::test {
namespace {

using namespace bench;

class LightmapPassTest : public BenchTest {
  protected:
    std::vector<LightmapPass> Light(const std::string &options, int repeats = 1) {
        SceneBuilder scene = Room();
        scene.AddEntity(PointLight({40, 20, 100}, 300));
        scene.AddBox({-200, -40, -300}, {-120, 40, 200}, {"textures/test/wall"});
        const auto map = Map(scene);
        return LightmapPasses(*map, LightmapSettingsFrom(options, *FindGame("quake3")), Library(), JobPool(1), repeats);
    }
    static const LightmapPass &Of(const std::vector<LightmapPass> &passes, std::string_view name) {
        const auto found =
            std::find_if(passes.begin(), passes.end(), [&](const LightmapPass &pass) { return pass.name == name; });
        EXPECT_NE(found, passes.end()) << name;
        return found == passes.end() ? passes.front() : *found;
    }
};

TEST_F(LightmapPassTest, EveryPartOfTheStageIsThereOnceInOrder) {
    std::vector<std::string> names;
    for (const LightmapPass &pass : Light("-dirty -bounce 1"))
        names.push_back(pass.name);
    EXPECT_THAT(names,
                testing::ElementsAre("set-up", "SetupSurfaceLightmaps", "MapRawLightmap", "DirtyRawLightmap",
                                     "IlluminateRawLightmap", "Radiosity", "Final gathering", "StoreSurfaceLightmaps"));
}

TEST_F(LightmapPassTest, PartsThatTraceSayHowManyRays) {
    const auto plain = Light("", 2), dirty = Light("-dirty -bounce 1");
    EXPECT_EQ(Of(plain, "MapRawLightmap").rays, 0u);
    // One light: a ray from each luxel that faces it, at most.
    const std::uint64_t direct = Of(plain, "IlluminateRawLightmap").rays;
    EXPECT_GT(direct, 0u);
    EXPECT_EQ(Of(dirty, "IlluminateRawLightmap").rays, direct);
    // 49 rays of dirt a luxel, twice where what is behind a surface is asked.
    EXPECT_GT(Of(dirty, "DirtyRawLightmap").rays, 49 * direct / 2);
    EXPECT_GT(Of(dirty, "Radiosity").rays, 0u);
}

TEST_F(LightmapPassTest, UnknownOptionsAndNoLightmapsAreErrors) {
    const Game &game = *FindGame("quake3");
    EXPECT_THROW(LightmapSettingsFrom("-dirty -nosuch", game), Error);
    EXPECT_THROW(LightmapSettingsFrom("-onlygrid", game), Error);
    EXPECT_TRUE(LightmapSettingsFrom("-dirty", game).lightmap.dirty);
}

TEST(LightmapPassReport, SharesAreOfRaysPerCpuSecond) {
    const std::vector<LightmapPass> passes = {{"quiet", 1, 0}, {"direct", 2, 6'000'000}};
    const std::string table = LightmapPassTable(passes, 12e6);
    EXPECT_THAT(table, testing::ContainsRegex("direct +2.000 +6.000 +3.00 +0.25"));
    EXPECT_THAT(table, testing::ContainsRegex("all +3.000 +6.000 +2.00 +0.17"));
    EXPECT_THAT(LightmapPassTable(passes, 0), testing::Not(testing::HasSubstr("bare Embree")));
    const auto json = nlohmann::json::parse(LightmapPassJson(passes, 12e6));
    EXPECT_EQ(json["passes"].size(), 2u);
    EXPECT_DOUBLE_EQ(json["passes"][1]["shareOfRaw"], 0.25);
    EXPECT_EQ(json["passes"][1]["rays"], 6'000'000u);
    EXPECT_FALSE(nlohmann::json::parse(LightmapPassJson(passes, 0))["passes"][1].contains("shareOfRaw"));
}

} // namespace
} // namespace q3::test
