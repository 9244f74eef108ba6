// GPL-2.0-or-later. -recoverlights: the lamps of a lit room, from its lightmaps alone.
#include "common/files/files.h"
#include "q3map2/bspfile/entities.h"
#include "tests/program/lit_room.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace q3::test {

namespace {

class RecoverLightsTest : public LitRoomTest {
  protected:
    struct Found {
        Vec3f origin, color;
        float light = 0;
    };
    /// Lights the room with its source, and finds its lamps without. Strongest first.
    std::vector<Found> Recover(const std::string &lamps, std::string_view options = "",
                               const std::string &brushes = {}) {
        Compile(lamps, {}, brushes);
        Light(options);
        return FindLamps(options);
    }
    std::vector<Found> FindLamps(std::string_view options) {
        const Outcome outcome = RunWords(fmt::format("-recoverlights {}", options));
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        std::vector<Found> found;
        for (const Entity &entity : LampEntities())
            if (IsLight(entity))
                found.push_back({*entity.Vector({"origin"}), entity.Vector({"_color"}).value_or(Vec3f{1, 1, 1}),
                                 float(entity.Number({"light"}))});
        return found;
    }
    std::vector<Entity> LampEntities() const {
        return ParseMapEntities(ReadTextFile(maps_ / "room.lights.map"), "room.lights.map");
    }
    /// The largest difference of a byte of lightmaps.
    static int WorstDifference(const Bsp &a, const Bsp &b) {
        EXPECT_EQ(a.lightmaps.size(), b.lightmaps.size());
        int worst = 0;
        for (std::size_t i = 0; i < std::min(a.lightmaps.size(), b.lightmaps.size()); ++i)
            worst = std::max(worst, std::abs(int(a.lightmaps[i]) - int(b.lightmaps[i])));
        return worst;
    }
    static void ExpectLamp(const Found &found, const Vec3f &origin, float light) {
        EXPECT_LT(Length(found.origin - origin), 2) << found.origin.x << " " << found.origin.y << " " << found.origin.z;
        EXPECT_NEAR(found.light, light, 0.02f * light);
    }
};

TEST_F(RecoverLightsTest, OneLamp) {
    const auto found = Recover(Lamp({40, -56, 120}, 150));
    ASSERT_EQ(found.size(), 1u);
    ExpectLamp(found[0], {40, -56, 120}, 150);
}

/// Luxels near the lamp are at their limit: they only say that there is at least so much light.
TEST_F(RecoverLightsTest, LampThatClampsLuxels) {
    const auto found = Recover(Lamp({40, -56, 72}, 300));
    ASSERT_GE(found.size(), 1u);
    EXPECT_LT(Length(found[0].origin - Vec3f{40, -56, 72}), 4);
    EXPECT_NEAR(found[0].light, 300, 15);
}

TEST_F(RecoverLightsTest, TwoColoredLampsNextToEachOther) {
    auto found = Recover(Lamp({-32, 0, 100}, 100, {1, 0.5f, 0.25f}) + Lamp({32, 0, 100}, 100, {0.25f, 0.5f, 1}));
    ASSERT_EQ(found.size(), 2u);
    std::ranges::sort(found, {}, [](const Found &one) { return one.origin.x; });
    ExpectLamp(found[0], {-32, 0, 100}, 100);
    ExpectLamp(found[1], {32, 0, 100}, 100);
    EXPECT_NEAR(found[0].color.y, 0.5f, 0.02f);
    EXPECT_NEAR(found[0].color.z, 0.25f, 0.02f);
}

TEST_F(RecoverLightsTest, ToneIsUndone) {
    const auto found = Recover(Lamp({40, -56, 120}, 120), "-gamma 1.3 -compensate 1.2");
    ASSERT_EQ(found.size(), 1u);
    ExpectLamp(found[0], {40, -56, 120}, 120);
}

/// Without a .map, -light lights the room by the lamps that were found: no byte differs by more than 2.
TEST_F(RecoverLightsTest, RoomIsRelit) {
    Recover(Lamp({40, -56, 120}, 150));
    const Bsp lit = Load();
    std::filesystem::remove(maps_ / "room.map");
    EXPECT_TRUE(Light("").Printed("room.lights.map"));
    EXPECT_LE(WorstDifference(Load(), lit), 2);
}

TEST_F(RecoverLightsTest, LampBehindAPillar) {
    const auto found = Recover(Lamp({-100, 0, 60}, 120), "", BoxText({-40, -60, 0}, {-10, 60, 256}, "test/pillar"));
    ASSERT_EQ(found.size(), 1u);
    ExpectLamp(found[0], {-100, 0, 60}, 120);
}

/// A cone of 28.8 degrees, aimed 11.3 degrees off the vertical.
TEST_F(RecoverLightsTest, Spotlight) {
    const auto found = Recover(Lamp({0, 0, 200}, 300, {1, 1, 1}, {{"target", "aim"}, {"radius", "96"}}) +
                               EntityText({{"classname", "info_null"}, {"targetname", "aim"}, {"origin", "40 0 0"}}));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_LT(Length(found[0].origin - Vec3f{0, 0, 200}), 16);
    const std::vector<Entity> entities = LampEntities();
    const auto target = std::ranges::find_if(entities, [](const Entity &e) { return !e.Value("targetname").empty(); });
    ASSERT_NE(target, entities.end()) << "no cone";
    const Vec3f aim = *target->Vector({"origin"}) - found[0].origin;
    constexpr float kDegree = std::numbers::pi_v<float> / 180;
    EXPECT_GT(Dot(Normalize(aim), Normalize(Vec3f{40, 0, -200})), std::cos(5 * kDegree));
    const auto light = std::ranges::find_if(entities, IsLight);
    EXPECT_NEAR(std::atan((float(light->Number({"radius"})) + 16) / Length(aim)), 28.8f * kDegree, 5 * kDegree);
    const Bsp lit = Load();
    std::filesystem::remove(maps_ / "room.map");
    Light("");
    EXPECT_LE(WorstDifference(Load(), lit), 12) << "the target of the spotlight is in room.lights.map alone";
}

/// Light that a surface emits is known, so no lamp stands for it.
TEST_F(RecoverLightsTest, NoLampsWhereSurfacesShine) {
    folder_.Write("base/baseq3/scripts/shaderlist.txt", "test\nglow\n");
    folder_.Write("base/baseq3/scripts/glow.shader", "textures/test/glow\n{\n\tq3map_surfacelight 2000\n}\n");
    EXPECT_TRUE(Recover("", "", BoxText({-32, -32, 200}, {32, 32, 240}, "test/glow")).empty());
}

/// The map was lit when the script said less: its factor, and the lamp, are found.
TEST_F(RecoverLightsTest, SurfacesThatEmitLessThanTheirScriptSays) {
    const auto setScript = [this](int light) {
        folder_.Write("base/baseq3/scripts/glow.shader",
                      fmt::format("textures/test/glow\n{{\n\tq3map_surfacelight {}\n}}\n", light));
    };
    folder_.Write("base/baseq3/scripts/shaderlist.txt", "test\nglow\n");
    setScript(1000);
    Compile(Lamp({150, 150, 80}, 60), {}, BoxText({-64, -64, 200}, {64, 64, 240}, "test/glow"));
    Light("");
    const Bsp lit = Load();
    setScript(2000);
    const auto found = FindLamps("");
    ASSERT_EQ(found.size(), 1u);
    EXPECT_LT(Length(found[0].origin - Vec3f{150, 150, 80}), 8);
    EXPECT_NEAR(found[0].light, 60, 6);
    std::istringstream factors(ReadTextFile(maps_ / "room.lights.rad"));
    std::string word, name;
    float factor = 0;
    factors >> word >> name >> factor;
    EXPECT_EQ(word + " " + name, "lightscale textures/test/glow");
    EXPECT_NEAR(factor, 0.5f, 0.03f);
    std::filesystem::remove(maps_ / "room.map");
    Light("");
    EXPECT_LE(WorstDifference(Load(), lit), 12);
}

TEST_F(RecoverLightsTest, BouncedLightIsNoLamp) {
    const auto found = Recover(Lamp({40, -56, 120}, 100), "-bounce 3");
    ASSERT_GE(found.size(), 1u);
    EXPECT_LT(Length(found[0].origin - Vec3f{40, -56, 120}), 4);
    EXPECT_NEAR(found[0].light, 100, 3);
    for (std::size_t i = 1; i < found.size(); ++i)
        EXPECT_LT(found[i].light, 2);
}

/// The map records the light run, which -recoverlights without options repeats.
TEST_F(RecoverLightsTest, OptionsThatTheMapRecords) {
    Compile(Lamp({40, -56, 120}, 120));
    Light("-gamma 1.3 -compensate 1.2");
    const auto found = FindLamps("");
    ASSERT_EQ(found.size(), 1u);
    ExpectLamp(found[0], {40, -56, 120}, 120);
}

/// The light grid has the same tone, and minimum light is no lamp.
TEST_F(RecoverLightsTest, GridAndMinimumLight) {
    Compile(Lamp({-100, 0, 60}, 30), {{"_minlight", "20"}}, BoxText({-40, -256, 0}, {-10, 200, 256}, "test/pillar"));
    ASSERT_EQ(RunWords("-light -gamma 1.3").status, 0);
    const auto found = FindLamps("");
    ASSERT_EQ(found.size(), 1u);
    EXPECT_LT(Length(found[0].origin - Vec3f{-100, 0, 60}), 4);
    EXPECT_NEAR(found[0].light, 30, 1);
    const Outcome again = RunWords("-force -recoverlights");
    const std::string text = again.text.substr(again.text.find("Lit with these lamps"));
    float surfaces = 9, grid = 9;
    EXPECT_EQ(std::sscanf(text.c_str(),
                          "Lit with these lamps, the map differs from the file by %f bytes RMS on surfaces and %f",
                          &surfaces, &grid),
              2)
        << text;
    EXPECT_LT(surfaces, 1);
    EXPECT_LT(grid, 2);
}

TEST_F(RecoverLightsTest, LampsAndLightInOneRun) {
    Compile(Lamp({40, -56, 120}, 150));
    Light("");
    const Bsp lit = Load();
    const Outcome withSource = RunWords("-light -nogrid -recoverlights");
    EXPECT_EQ(withSource.status, 0);
    EXPECT_TRUE(withSource.Printed("room.map has the lights of the map")) << withSource.text;
    EXPECT_FALSE(std::filesystem::exists(maps_ / "room.lights.map"));
    std::filesystem::remove(maps_ / "room.map");
    const Outcome outcome = RunWords("-light -nogrid -recoverlights");
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    EXPECT_LE(WorstDifference(Load(), lit), 2);
    EXPECT_TRUE(std::filesystem::exists(maps_ / "room.lights.map"));
}

/// A grid that was lit later, without the lamps, says nothing about them; nor do the options of that run.
TEST_F(RecoverLightsTest, GridOfALaterRunIsNotRead) {
    Compile(Lamp({40, -56, 120}, 120));
    ASSERT_EQ(RunWords("-light -gamma 1.3").status, 0);
    std::filesystem::remove(maps_ / "room.map");
    const Outcome dark = RunWords("-force -light -onlygrid -gamma 2");
    EXPECT_TRUE(dark.Printed("-recoverlights finds lamps")) << dark.text;
    const auto found = FindLamps("");
    ASSERT_EQ(found.size(), 1u);
    ExpectLamp(found[0], {40, -56, 120}, 120);
}

TEST_F(RecoverLightsTest, InsertPutsLampsIntoTheMap) {
    Compile(Lamp({40, -56, 120}, 150));
    Light("");
    const Bsp lit = Load();
    EXPECT_EQ(RunWords("-recoverlights -insert").status, 0);
    const Bsp inserted = Load();
    EXPECT_EQ(inserted.lightmaps, lit.lightmaps);
    EXPECT_EQ(std::ranges::count_if(StoredEntities(inserted.entities, "room"), IsLight), 1);
}

/// The file that the viewer shows: next to nothing is unexplained.
TEST_F(RecoverLightsTest, UnexplainedLight) {
    Recover(Lamp({40, -56, 120}, 150));
    const auto json = nlohmann::json::parse(ReadTextFile(maps_ / "room.unexplained.json"));
    EXPECT_EQ(json["format"], "q3map2-sh unexplained light");
    ASSERT_GT(json["positions"].size(), 100u);
    for (const auto &row : json["positions"])
        EXPECT_LE(std::abs(row[3].get<float>()), 2) << row;
}

TEST_F(RecoverLightsTest, AnyNumberOfThreadsFindsTheSame) {
    Recover(Lamp({-32, 0, 100}, 100, {1, 0.5f, 0.25f}) + Lamp({90, 60, 150}, 140), "-threads 1");
    const std::string one = ReadTextFile(maps_ / "room.lights.map");
    EXPECT_EQ(RunWords("-threads 3 -force -recoverlights").status, 0);
    EXPECT_EQ(ReadTextFile(maps_ / "room.lights.map"), one);
}

TEST_F(RecoverLightsTest, SaysWhatHasNoEffect) {
    Compile(Lamp({0, 0, 100}, 100));
    Light("");
    const Outcome outcome = RunWords("-recoverlights -sh");
    EXPECT_TRUE(outcome.Printed("options that say what -light stores")) << outcome.text;
    EXPECT_TRUE(outcome.Printed("-light reads the lights of " + (maps_ / "room.map").string())) << outcome.text;
}

TEST_F(RecoverLightsTest, MapsAreNotReplaced) {
    Recover(Lamp({0, 0, 100}, 100));
    const Outcome again = RunWords("-recoverlights");
    EXPECT_EQ(again.status, 1);
    EXPECT_TRUE(again.Printed("room.lights.map exists; -force replaces it")) << again.text;
    EXPECT_EQ(RunWords("-force -recoverlights").status, 0);
}

} // namespace

} // namespace q3::test
