// GPL-2.0-or-later. Patterns and switchable lights in lit maps: keys, shaders, entities.
#include "common/files/files.h"
#include "q3map2/bspfile/entities.h"
#include "tests/program/lit_room.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;
using testing::Not;

/// The ceiling has no script, so its generated shader has a stage for each style.
class StylesTest : public LitRoomTest {
  protected:
    void CompileWith(const std::string &entities, const Keys &worldKeys = {}) {
        Compile(Lamp({-120, 40, 60}, 200) + entities, worldKeys, {}, "test/plain");
    }
    std::string Script() const {
        const auto path = folder_ / "base/baseq3/scripts/q3map2_room.shader";
        return std::filesystem::exists(path) ? ReadTextFile(path) : std::string();
    }
    std::string World(std::string_view key) const {
        return std::string(ParseEntities(Load().entities, "room").front().Value(key));
    }
};

TEST_F(StylesTest, PatternsBecomeWaves) {
    CompileWith(Lamp({100, -60, 120}, 200, {1, 1, 1}, {{"pattern", "mmmaaa"}}));
    Light("");
    EXPECT_EQ(World("_style12pattern"), "mmmaaa");
    EXPECT_THAT(Script(), HasSubstr("rgbGen wave square 0.5 0.5 0 1.66667"));
}

TEST_F(StylesTest, AnRgbGenOfTheWorldWinsOverThePattern) {
    CompileWith(Lamp({100, -60, 120}, 200, {1, 1, 1}, {{"pattern", "mmmaaa"}, {"style", "4"}}),
                {{"_style4rgbgen", "wave sin 1 2 3 4"}});
    Light("");
    EXPECT_EQ(World("_style4pattern"), "mmmaaa");
    EXPECT_THAT(Script(), HasSubstr("rgbGen wave sin 1 2 3 4"));
}

TEST_F(StylesTest, SwitchesAreOnOrDarkAtFirst) {
    const auto hall = Lamp({100, -60, 120}, 200, {1, 1, 1}, {{"targetname", "hall"}});
    CompileWith(hall);
    Light("-switchable");
    EXPECT_EQ(World("_switch32"), "hall");
    EXPECT_THAT(Script(), HasSubstr("rgbGen const ( 1 1 1 )"));
    CompileWith(EntityText({{"classname", "light"},
                            {"origin", "100 -60 120"},
                            {"_light", "255 255 255 300"},
                            {"targetname", "hall"},
                            {"spawnflags", "1"}}),
                {{"_switchable", "1"}});
    Light("");
    EXPECT_EQ(World("_switch32dark"), "1");
    EXPECT_THAT(Script(), HasSubstr("rgbGen const ( 0 0 0 )"));
    EXPECT_THAT(Script(), Not(HasSubstr("const ( 1 1 1 )")));
}

TEST_F(StylesTest, ASurfaceWithLessThanAByteOfAStyleGetsNoStage) {
    CompileWith(Lamp({100, -60, 20}, 2, {1, 1, 1}, {{"pattern", "mmmaaa"}}));
    Light("-bounce 1");
    EXPECT_EQ(Script(), "");
    const std::size_t withoutStage = Load().lightmaps.size();
    Light("-bounce 1 -brightness 20");
    EXPECT_THAT(Script(), HasSubstr("rgbGen wave square"));
    EXPECT_GT(Load().lightmaps.size(), withoutStage);
    Light("-bounce 1 -both"); // HDR pages have what bytes have not
    EXPECT_THAT(Script(), HasSubstr("rgbGen wave square"));
}

TEST_F(StylesTest, ScriptsWithoutAMarkerAreNamed) {
    const std::string lamp = Lamp({100, -60, 60}, 200, {1, 1, 1}, {{"pattern", "mmmaaa"}});
    CompileWith(lamp);
    const Outcome outcome = Light("-v");
    EXPECT_THAT(outcome.text, HasSubstr("textures/test/floor: no q3map_styleMarker in its script"));
    EXPECT_THAT(outcome.text, Not(HasSubstr("textures/test/plain: no q3map_styleMarker"))); // it has no script
    EXPECT_THAT(outcome.text, HasSubstr("(light style without a stage: 2)"));               // floor and wall
}

TEST_F(StylesTest, WithoutTheOptionTargetnamesChangeNothing) {
    CompileWith(Lamp({100, -60, 120}, 200));
    Light("");
    const std::vector<std::uint8_t> plain = Load().lightmaps;
    CompileWith(Lamp({100, -60, 120}, 200, {1, 1, 1}, {{"targetname", "hall"}}));
    Light("");
    EXPECT_EQ(Load().lightmaps, plain);
    EXPECT_EQ(World("_switch32"), "");
    EXPECT_EQ(Script(), "");
}

TEST_F(StylesTest, LightsThatStayInTheMapGetTheirStyle) {
    CompileWith(Lamp({100, -60, 120}, 200, {1, 1, 1}, {{"targetname", "hall"}}), {{"_keepLights", "1"}});
    Light("-switchable");
    int found = 0;
    for (const Entity &entity : ParseEntities(Load().entities, "room"))
        if (entity.Value("targetname") == "hall") {
            EXPECT_EQ(entity.Value("style"), "32");
            ++found;
        }
    EXPECT_EQ(found, 1);
    const auto entities = [&] {
        auto all = ParseEntities(Load().entities, "room");
        all.front().Erase("_q3map2_cmdline");
        return FormatEntities(all);
    };
    const std::string script = Script(), before = entities();
    Light("-switchable");
    EXPECT_EQ(Script(), script) << "a second run changes nothing";
    EXPECT_EQ(entities(), before);
}

TEST_F(StylesTest, OptionNostyleMakesAllLightsConstant) {
    CompileWith(Lamp({100, -60, 120}, 200));
    Light("");
    const std::vector<std::uint8_t> plain = Load().lightmaps;
    CompileWith(Lamp({100, -60, 120}, 200, {1, 1, 1}, {{"style", "5"}, {"pattern", "az"}}));
    Light("-nostyle");
    EXPECT_EQ(Load().lightmaps, plain);
    EXPECT_EQ(Script(), "");
}

} // namespace

} // namespace q3::test
