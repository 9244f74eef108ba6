// GPL-2.0-or-later. -part and -join: one map in parts, with the bytes of one run.
#include "tests/program/lit_room.h"
#include "tests/support/this_system.h"

#include "common/files/files.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

namespace q3::test {

namespace {

using testing::HasSubstr;

/// Walls inside the room, so that there are portals, shadows and several surfaces.
std::string Walls() {
    return BoxText({-256, -8, 0}, {-48, 8, 256}, "test/pillar") + BoxText({48, -8, 0}, {256, 8, 256}, "test/pillar") +
           BoxText({-8, 64, 0}, {8, 256, 200}, "test/pillar") + BoxText({-8, -256, 0}, {8, -64, 160}, "test/pillar");
}

class PartsTest : public LitRoomTest {
  protected:
    PartsTest() { Compile(Lamp({-128, -128, 200}, 300) + Lamp({128, 128, 120}, 200, {1, 0.5f, 0.25f}), {}, Walls()); }
    std::string File(const std::string &name) const { return (maps_ / name).string(); }
    std::string MapFile() const { return File("room.bsp"); }

    /// The files of all parts of a round, in any order. join: options before them.
    std::vector<std::string> ComputeParts(const std::string &stage, const std::string &join, int count, int round) {
        std::vector<std::string> files;
        for (int part = 1; part <= count; ++part) {
            files.push_back(File("p" + std::to_string(round) + "_" + std::to_string(part)));
            const Outcome run = RunWords(stage + " " + join + " -part " + std::to_string(part) + "/" +
                                         std::to_string(count) + " -partfile " + files.back());
            EXPECT_EQ(run.status, 0) << run.text;
        }
        std::mt19937 random(unsigned(count * 10 + round));
        std::ranges::shuffle(files, random);
        return files;
    }
    /// Runs the stage in parts, as many rounds as it needs, and returns the bytes of the map.
    std::vector<std::byte> InParts(const std::string &stage, int count) {
        std::string joined;
        for (int round = 1; round < 8; ++round) {
            const std::vector<std::string> files =
                ComputeParts(stage, joined.empty() ? "" : "-join " + joined, count, round);
            std::string words = stage + " -join";
            if (!joined.empty())
                words += " " + joined;
            for (const std::string &file : files)
                words += " " + file;
            const std::string next = File("joined" + std::to_string(round));
            std::filesystem::remove(next);
            const Outcome run = RunWords(words + " -partfile " + next);
            EXPECT_EQ(run.status, 0) << run.text;
            if (!std::filesystem::exists(next))
                return MapBytes();
            joined = next;
        }
        ADD_FAILURE() << "the rounds have no end";
        return {};
    }

    /// Expects the bytes of one run for several numbers of parts.
    void ExpectSameBytes(const std::string &stage, std::initializer_list<int> counts = {1, 3}) {
        const std::vector<std::byte> before = MapBytes();
        ASSERT_EQ(RunWords(stage).status, 0);
        const std::vector<std::byte> whole = MapBytes();
        for (const int count : counts) {
            ReplaceFile(MapFile(), before);
            EXPECT_TRUE(InParts(stage, count) == whole) << stage << " in " << count << " parts";
        }
        ReplaceFile(MapFile(), before);
    }
};

TEST_F(PartsTest, VisHasTheBytesOfOneRun) {
    ExpectSameBytes("-vis -saveprt -flowrounds 4", {1, 2, 16});
    ExpectSameBytes("-vis -saveprt -nopassage -flowrounds 2");
    ExpectSameBytes("-vis -saveprt -fast");
    ExpectSameBytes("-vis -saveprt -plain");
}

TEST_F(PartsTest, LightHasTheBytesOfOneRun) {
    ASSERT_EQ(RunWords("-vis -saveprt").status, 0);
    ExpectSameBytes("-light -sh -gridsh 32 32 32", {1, 4, 16});
    ExpectSameBytes("-light -samples 2 -filter -deluxe -rnm -hdr");
}

TEST_F(PartsTest, BouncesTakeASecondRound) {
    ASSERT_EQ(RunWords("-vis -saveprt").status, 0);
    ExpectSameBytes("-light -sh -gridsh 32 32 32 -bounce 3 -bouncegrid", {2, 16});
    ExpectSameBytes("-light -bounce 2 -fast");
}

TEST_F(PartsTest, LightOfOtherStylesComesBack) {
    Compile(Lamp({-128, -128, 200}, 300) +
                Lamp({128, 128, 120}, 200, {1, 1, 1}, {{"style", "32"}, {"targetname", "a"}}),
            {}, Walls());
    ASSERT_EQ(RunWords("-vis -saveprt").status, 0);
    ExpectSameBytes("-light -bounce 2 -bouncegrid");
}

TEST_F(PartsTest, PartsLeaveTheMapAsItIs) {
    const std::vector<std::byte> before = MapBytes();
    ComputeParts("-light", "", 2, 1);
    EXPECT_TRUE(MapBytes() == before);
}

TEST_F(PartsTest, WrongPartsAreRefusedByName) {
    ComputeParts("-light", "", 3, 1);
    const std::string one = File("p1_1"), two = File("p1_2"), three = File("p1_3");
    const auto expect = [&](const std::string &words, const std::string &text) {
        const std::vector<std::byte> before = MapBytes();
        const Outcome run = RunWords(words);
        EXPECT_EQ(run.status, 1) << words;
        EXPECT_TRUE(run.Printed(text)) << run.text;
        EXPECT_TRUE(MapBytes() == before) << words;
    };
    expect("-light -join " + one + " " + three, "part 2 of 3 of round 1 is missing");
    expect("-light -join " + one + " " + two + " " + one + " " + three, one + ": part 1 of 3, which is there twice");
    expect("-light -samples 3 -join " + one + " " + two + " " + three, "other options");
    expect("-vis -join " + one + " " + two + " " + three, one + ": results of -light, expected those of -vis");
    expect("-light -join", "-join: expected the files");
    expect("-light -part 4/3 -partfile x", "-part 4/3: expected I/N");
    expect("-light -part 1/3", "-partfile FILE too");

    std::vector<std::byte> bytes = ReadFile(two);
    bytes[bytes.size() / 2] ^= std::byte(1);
    ReplaceFile(two, bytes);
    expect("-light -join " + one + " " + two + " " + three, two + ": damaged");
    bytes.resize(bytes.size() / 3);
    ReplaceFile(two, bytes);
    expect("-light -join " + one + " " + two + " " + three, two + ": damaged");
    ReplaceFile(two, std::vector<std::byte>(4));
    expect("-light -join " + one + " " + two + " " + three, two + ": no file of results");

    ComputeParts("-light", "", 2, 2);
    expect("-light -join " + one + " " + File("p2_2"), "but another file is of 3 parts");
}

TEST_F(PartsTest, PartsOfAnotherMapAreRefused) {
    ComputeParts("-light", "", 1, 1);
    Compile(Lamp({-128, -128, 200}, 301), {}, Walls());
    const Outcome run = RunWords("-light -join " + File("p1_1"));
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.text, HasSubstr("another map"));
}

} // namespace

} // namespace q3::test
