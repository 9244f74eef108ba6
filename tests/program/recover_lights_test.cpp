// GPL-2.0-or-later. -recoverlights: the lamps of a lit room, from its lightmaps alone.
#include "common/files/files.h"
#include "q3map2/bspfile/entities.h"
#include "tests/program/lit_room.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace q3::test {

namespace {

class RecoverLightsTest : public LitRoomTest {
  protected:
    struct Found {
        Vec3f origin, color;
        float light = 0;
    };
    /// Lights the room with its source, and finds its lamps without. Strongest first.
    std::vector<Found> Recover(const std::string &lamps, std::string_view options = "") {
        Compile(lamps);
        Light(options);
        const Outcome outcome = RunWords(fmt::format("-recoverlights {}", options));
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        std::vector<Found> found;
        for (const Entity &entity : ParseMapEntities(ReadTextFile(maps_ / "room.lights.map"), "room.lights.map"))
            if (IsLight(entity))
                found.push_back({*entity.Vector({"origin"}), entity.Vector({"_color"}).value_or(Vec3f{1, 1, 1}),
                                 float(entity.Number({"light"}))});
        return found;
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
    const Bsp relit = Load();
    ASSERT_EQ(relit.lightmaps.size(), lit.lightmaps.size());
    int worst = 0;
    for (std::size_t i = 0; i < lit.lightmaps.size(); ++i)
        worst = std::max(worst, std::abs(int(relit.lightmaps[i]) - int(lit.lightmaps[i])));
    EXPECT_LE(worst, 2);
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
