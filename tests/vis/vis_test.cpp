// GPL-2.0-or-later. What clusters see: small maps with known answers, and maps of rooms against lines of sight.
#include "tests/vis/portal_maps.h"

#include <functional>
#include <random>
#include <system_error>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

std::vector<VisOptions> AllModes() {
    return {
        {},
        {.fast = true},
        {.noPassage = true},
        {.passageOnly = true},
        {.noSort = true},
        {.memory = 0},
        {.triesBeforeKeeping = 0},
        {.merge = true},
        {.mergePortals = true},
        {.merge = true, .keepHints = true},
        {.plain = true},
        {.noPassage = true, .plain = true},
        {.passageOnly = true, .plain = true},
    };
}

/// Slots that alternate between the two sides of a row of rooms.
const std::string kOffset = PrtText(5, {"4 0 1 0 (128 0 48 ) (128 16 48 ) (128 16 80 ) (128 0 80 )",
                                        "4 1 2 0 (256 112 48 ) (256 128 48 ) (256 128 80 ) (256 112 80 )",
                                        "4 2 3 0 (384 0 48 ) (384 16 48 ) (384 16 80 ) (384 0 80 )",
                                        "4 3 4 0 (512 112 48 ) (512 128 48 ) (512 128 80 ) (512 112 80 )"});
/// Around a corner and back: the end rooms share a wall.
const std::string kUTurn = PrtText(4, {"4 0 1 0 (128 16 16 ) (128 112 16 ) (128 112 112 ) (128 16 112 )",
                                       "4 1 2 0 (144 128 16 ) (144 128 112 ) (240 128 112 ) (240 128 16 )",
                                       "4 3 2 0 (128 144 16 ) (128 240 16 ) (128 240 112 ) (128 144 112 )"});
/// A hall cut into four, first by a hint, and a window to a fifth room.
const std::string kCutHall = PrtText(5, {"4 0 1 1 (128 0 0 ) (128 128 0 ) (128 128 128 ) (128 0 128 )",
                                         "4 1 2 0 (256 0 0 ) (256 128 0 ) (256 128 128 ) (256 0 128 )",
                                         "4 2 3 0 (384 0 0 ) (384 128 0 ) (384 128 128 ) (384 0 128 )",
                                         "4 3 4 0 (512 48 48 ) (512 80 48 ) (512 80 80 ) (512 48 80 )"});
/// Two halves of one opening, then a slot.
const std::string kTwoHalves = PrtText(3, {"4 0 1 0 (128 0 0 ) (128 64 0 ) (128 64 128 ) (128 0 128 )",
                                           "4 0 1 0 (128 64 0 ) (128 128 0 ) (128 128 128 ) (128 64 128 )",
                                           "4 1 2 0 (256 0 0 ) (256 16 0 ) (256 16 128 ) (256 0 128 )"});

bool Contains(const Visibility &all, const Visibility &part) {
    for (std::size_t i = 0; i < part.rows.size(); ++i)
        if ((part.rows[i] & ~all.rows[i]) != 0)
            return false;
    return true;
}

TEST(Vis, SlotsOffTheLineHideWhatIsTwoRoomsOn) {
    for (const VisOptions &options : AllModes()) {
        if (options.merge)
            continue; // faces are not given, so rooms merge
        const VisRun run = RunVis(kOffset, options);
        EXPECT_EQ(run.rows, options.fast ? "11111 11111 11111 11111 11111" : "11100 11110 11111 01111 00111");
        EXPECT_TRUE(run.Printed(options.fast ? "Average clusters visible: 5.00 (100.000%/total)"
                                             : "Average clusters visible: 3.80 (76.000%/total)"));
    }
}

TEST(Vis, NobodySeesBackwards) {
    for (const VisOptions &options : AllModes()) {
        if (options.merge)
            continue;
        const VisRun run = RunVis(kUTurn, options);
        EXPECT_EQ(run.rows, "1110 1111 1111 0111");
        EXPECT_TRUE(run.Printed("Average clusters visible: 3.50"));
    }
}

TEST(Vis, RoomsInARowAllSeeEachOther) {
    for (const VisOptions &options : AllModes())
        EXPECT_EQ(RunVis(Corridor(6), options).rows, "111111 111111 111111 111111 111111 111111");
}

TEST(Vis, FarPlaneEndsSightByItsMode) {
    const auto rows = [](const std::string &value, int flags) {
        Entity world;
        world.Set("_farplanedist", value);
        VisOptions options;
        options.farPlane = FarPlaneOf(world);
        return RunVis(Corridor(6, flags), options).rows;
    };
    const std::string all = "111111 111111 111111 111111 111111 111111";
    EXPECT_EQ(rows("", 0), all);
    EXPECT_EQ(rows("far", 0), all);
    EXPECT_EQ(rows("250r", 0), all);
    EXPECT_EQ(rows("300", 0), "111100 111110 111111 111111 011111 001111");
    EXPECT_EQ(rows("250", 0), "111100 111110 111111 111111 011111 001111");
    EXPECT_EQ(rows("250o", 0), "111000 111100 111110 011111 001111 000111");
    EXPECT_EQ(rows("250e", 0), "111110 111111 111111 111111 111111 011111");
    EXPECT_EQ(rows("40r", 0), "110000 111000 011100 001110 000111 000011");
    EXPECT_EQ(rows("250o", 2), "111000 111100 111111 011111 001111 001111") << "sky is seen from any distance";
}

TEST(Vis, FarPlaneIsTheFirstKeyThatIsNotEmpty) {
    Entity world;
    EXPECT_EQ(FarPlaneOf(world).distance, 0);
    world.Set("distancecull", "700");
    EXPECT_EQ(FarPlaneOf(world).distance, 700);
    EXPECT_EQ(FarPlaneOf(world).mode, FarPlaneMode::Nearest);
    world.Set("fogclip", "600e");
    EXPECT_EQ(FarPlaneOf(world).distance, 600);
    EXPECT_EQ(FarPlaneOf(world).mode, FarPlaneMode::Farthest);
    world.Set("_farplanedist", "-5");
    EXPECT_EQ(FarPlaneOf(world).distance, 0);
}

TEST(Vis, MergingStopsAtHintsOnDemand) {
    const std::string all = "11111 11111 11111 11111 11111";
    const VisRun none = RunVis(kCutHall);
    EXPECT_EQ(none.rows, all);
    EXPECT_TRUE(none.Printed("     8 active portals\n     2 hint portals\n"));
    const VisRun merge = RunVis(kCutHall, {.merge = true});
    EXPECT_EQ(merge.rows, all);
    EXPECT_TRUE(merge.Printed("     4 leaves merged\n"));
    EXPECT_TRUE(merge.Printed("     0 active portals\n     0 hint portals\n"));
    const VisRun hint = RunVis(kCutHall, {.merge = true, .keepHints = true});
    EXPECT_EQ(hint.rows, all);
    EXPECT_TRUE(hint.Printed("     3 leaves merged\n"));
    EXPECT_TRUE(hint.Printed("     2 active portals\n     2 hint portals\n"));
}

TEST(Vis, HalvesOfAnOpeningAreJoined) {
    const VisRun none = RunVis(kTwoHalves);
    EXPECT_TRUE(none.Printed("     6 active portals\n"));
    EXPECT_FALSE(none.Printed("portals merged"));
    const VisRun joined = RunVis(kTwoHalves, {.mergePortals = true});
    EXPECT_TRUE(joined.Printed("     2 portals merged\n     0 hint portals merged\n     4 active portals\n"));
    EXPECT_EQ(joined.rows, none.rows);
    const VisRun merged = RunVis(kTwoHalves, {.merge = true});
    EXPECT_TRUE(merged.Printed("     2 leaves merged\n"));
    EXPECT_TRUE(merged.Printed("     0 active portals\n"));
}

TEST(Vis, JoinedPortalsKeepTheSky) {
    Entity world;
    world.Set("_farplanedist", "250o");
    VisOptions options;
    options.farPlane = FarPlaneOf(world);
    const std::string whole = Corridor(6, 2), head = "4 4 5 2 ";
    // The last portal in two halves, one with a sky.
    const std::string before = whole.substr(0, whole.find(head)), low = "(640 48 48 ) (640 80 48 ) ",
                      middleBack = "(640 80 64 ) (640 48 64 ) ", middle = "(640 48 64 ) (640 80 64 ) ",
                      high = "(640 80 80 ) (640 48 80 ) ";
    for (const bool skyFirst : {false, true}) {
        std::string halves = before + (skyFirst ? "4 4 5 2 " : "4 4 5 0 ") + low + middleBack + "\n" +
                             (skyFirst ? "4 4 5 0 " : "4 4 5 2 ") + middle + high + "\n";
        halves.replace(0, 9, "PRT1\n6\n6\n");
        options.mergePortals = true;
        const VisRun joined = RunVis(halves, options);
        EXPECT_TRUE(joined.Printed("     2 portals merged\n")) << "both directions";
        EXPECT_EQ(joined.rows, RunVis(whole, options).rows);
        EXPECT_NE(joined.rows, RunVis(Corridor(6, 0), options).rows);
    }
}

TEST(Vis, LeafsThatAreNotConvexTogetherStay) {
    // The wall around the window of the second portal bounds room 1: room 2 lies in front of it.
    const std::string text = "PRT1\n3\n2\n1\n"
                             "4 0 1 0 (128 0 0 ) (128 128 0 ) (128 128 128 ) (128 0 128 )\n"
                             "4 1 2 0 (256 0 0 ) (256 64 0 ) (256 64 128 ) (256 0 128 )\n"
                             "4 1 (256 64 0 ) (256 128 0 ) (256 128 128 ) (256 64 128 )\n";
    const std::string beyond = text + "4 2 (384 0 0 ) (384 0 128 ) (384 128 128 ) (384 128 0 )\n";
    std::string two = beyond;
    two.replace(two.find("\n1\n"), 3, "\n2\n");
    EXPECT_TRUE(RunVis(two, {.merge = true}).Printed("     1 leaf merged\n"));
}

TEST(Vis, ClusterWithoutPortalsSeesItself) {
    EXPECT_EQ(RunVis(PrtText(3, {"4 0 1 0 (8 0 0 ) (8 9 0 ) (8 9 9 ) (8 0 9 )"})).rows, "110 110 001");
}

TEST(Vis, LumpHasTheSizesInFront) {
    const auto lump = RunVis(Corridor(6)).visibility.Lump();
    ASSERT_EQ(lump.size(), 8u + 6 * 8);
    EXPECT_THAT(std::vector(lump.begin(), lump.begin() + 8), testing::ElementsAre(6, 0, 0, 0, 8, 0, 0, 0));
    for (std::size_t row = 0; row < 6; ++row)
        EXPECT_EQ(lump[8 + 8 * row], 63) << "and the bits after the last cluster are clear";
}

TEST(Vis, StatisticsCountEachClusterOnce) {
    const VisRun run = RunVis(kOffset);
    EXPECT_TRUE(run.Printed("Total clusters: 5\nTotal visible clusters: 19\n"));
    EXPECT_TRUE(run.Printed("   2 clusters have exactly    3 visible clusters\n"));
    EXPECT_TRUE(run.Printed("   1 cluster has exactly    5 visible clusters\n"));
    EXPECT_TRUE(run.Printed("  Standard deviation: 0.75 (14.967%/total)\n"));
    EXPECT_TRUE(run.Printed("  Minimum: 3 (60.000%/total)\n"));
    EXPECT_TRUE(run.Printed("  Maximum: 5 (100.000%/total)\n"));
}

/// Rooms that see each other along a random line are in each other's rows, in every mode.
TEST(VisRooms, NothingThatIsSeenIsHidden) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
        const RoomGrid grid(seed);
        std::vector<Visibility> found;
        for (const VisOptions &options : AllModes())
            found.push_back(RunVis(grid.Prt(), options).visibility);
        std::mt19937 random(seed);
        const auto coordinate = [&](int cells) { return double(random()) / 4294967296.0 * RoomGrid::kRoom * cells; };
        int clear = 0;
        for (int i = 0; i < 100000; ++i) {
            const Vec3d a(coordinate(RoomGrid::kSide), coordinate(RoomGrid::kSide), coordinate(RoomGrid::kFloors));
            const Vec3d b(coordinate(RoomGrid::kSide), coordinate(RoomGrid::kSide), coordinate(RoomGrid::kFloors));
            if (!grid.IsClear(a, b, 0.5))
                continue;
            clear++;
            for (std::size_t mode = 0; mode < found.size(); ++mode)
                ASSERT_TRUE(found[mode].Sees(RoomGrid::RoomAt(a), RoomGrid::RoomAt(b)))
                    << "mode " << mode << " hides " << RoomGrid::RoomAt(b) << " from " << RoomGrid::RoomAt(a);
        }
        EXPECT_GT(clear, 2000);
    }
}

/// Most of what is not seen along any of many lines is hidden: the result is not merely everything.
TEST(VisRooms, ModesAreAsTightAsTheyShould) {
    const RoomGrid grid(4);
    const Visibility full = RunVis(grid.Prt()).visibility;
    const Visibility plain = RunVis(grid.Prt(), {.plain = true}).visibility;
    const Visibility passage = RunVis(grid.Prt(), {.passageOnly = true}).visibility;
    const Visibility fast = RunVis(grid.Prt(), {.fast = true}).visibility;
    // Each looks at a pair of portals from one side, not always the same one, and near the limits of 0.1 units they
    // differ.
    int more = 0, seen = 0;
    for (int a = 0; a < RoomGrid::kRooms; ++a)
        for (int b = 0; b < RoomGrid::kRooms; ++b) {
            seen += full.Sees(a, b);
            more += full.Sees(a, b) && !plain.Sees(a, b) && !plain.Sees(b, a);
        }
    EXPECT_LT(200 * more, seen);
    EXPECT_TRUE(Contains(passage, full));
    EXPECT_TRUE(Contains(fast, passage));
    EXPECT_TRUE(Contains(fast, RunVis(grid.Prt(), {.noPassage = true}).visibility));
    EXPECT_TRUE(Contains(RunVis(grid.Prt(), {.fast = true, .plain = true}).visibility, plain));
    const auto total = [](const Visibility &visibility) {
        int sum = 0;
        for (int c = 0; c < visibility.clusters; ++c)
            sum += visibility.Count(c);
        return sum;
    };
    EXPECT_LT(total(full), total(plain));
    EXPECT_LT(total(full), total(passage));
    EXPECT_LT(total(passage), total(fast));
    EXPECT_LT(total(fast), RoomGrid::kRooms * RoomGrid::kRooms);
}

TEST(VisRooms, SightIsMutual) {
    const RoomGrid grid(5);
    for (const VisOptions &options : AllModes()) {
        if (options.plain)
            continue;
        const Visibility visibility = RunVis(grid.Prt(), options).visibility;
        for (int a = 0; a < visibility.clusters; ++a)
            for (int b = 0; b < a; ++b)
                ASSERT_EQ(visibility.Sees(a, b), visibility.Sees(b, a)) << a << " and " << b;
    }
}

TEST(VisRooms, ThreadsDoNotChangeTheBytes) {
    const RoomGrid grid(6);
    for (const VisOptions &options : AllModes()) {
        const Visibility one = RunVis(grid.Prt(), options, 1).visibility;
        EXPECT_EQ(one.rows, RunVis(grid.Prt(), options, 2).visibility.rows);
        EXPECT_EQ(one.rows, RunVis(grid.Prt(), options, 5).visibility.rows);
    }
}

/// Of eight threads only two can be started; nothing waits for the others.
TEST(VisRooms, ThreadsThatCannotBeStartedDoNotChangeTheBytes) {
    const RoomGrid grid(7);
    for (const VisOptions &options : AllModes())
        for (const int limit : {0, 2}) {
            int started = 0;
            const JobPool few(8, [&](std::function<void()> work) {
                if (started == limit)
                    throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
                ++started;
                return std::thread(std::move(work));
            });
            EXPECT_EQ(RunVis(grid.Prt(), options, few).visibility.rows, RunVis(grid.Prt(), options).visibility.rows);
        }
}

} // namespace

} // namespace q3::test
