// GPL-2.0-or-later. Rooms: counts known by hand, leaks, areas, clusters, the portal file.
#include "common/error.h"
#include "q3map2/bspfile/prtfile.h"
#include "q3map2/tree/flood.h"
#include "tests/tree/tree_fixture.h"

#include <filesystem>
#include <fstream>
#include <random>

#include <gmock/gmock.h>

namespace q3 {
namespace {

using test::Compiled;
using test::World;
using ::testing::HasSubstr;

/// The inside is 256 256 128 and its middle lies over the corner of four blocks.
void AddEmptyRoom(World &world) {
    world.AddRoom({-128, -128, 0}, {128, 128, 128});
    world.AddEntity("info_player_start", {0, 0, 32});
}

/// Two rooms with a doorway 64 wide and 64 high in the wall between them, x from -8 to 8.
void AddTwoRooms(World &world) {
    const Vec3d mins{-256, -128, 0}, maxs{256, 128, 128};
    world.AddRoom(mins, maxs);
    world.AddBox({-8, -128, 0}, {8, -32, 128});
    world.AddBox({-8, 32, 0}, {8, 128, 128});
    world.AddBox({-8, -32, 64}, {8, 32, 128});
    world.AddEntity("info_player_start", {-128, 0, 32});
}

TEST(EmptyRoom, CountsOfBothTrees) {
    World world;
    AddEmptyRoom(world);
    EXPECT_EQ(world.map.planes.Count(), 24);
    const Compiled made = world.Compile();
    EXPECT_EQ(made.sealing, Sealing::Sealed);
    EXPECT_EQ(made.firstFaces.size(), 36u);
    EXPECT_EQ(test::Leafs(made.first).size(), 68u);
    EXPECT_THAT(world.text, HasSubstr("       40 leafs filled\n"));
    EXPECT_THAT(world.text, HasSubstr("       12 hidden faces culled\n"));
    EXPECT_EQ(made.secondFaces.size(), 6u);
    EXPECT_EQ(made.second.nodes.size(), 19u + 20u + 1u);
    EXPECT_EQ(test::Leafs(made.second).size(), 20u);
    EXPECT_EQ(made.clusters, 4);
    EXPECT_EQ(made.visiblePortals, 4);
    EXPECT_EQ(made.solidFaces, 16);
    EXPECT_EQ(made.areas, 1);
    EXPECT_EQ(world.map.planes.Count(), 28);
    std::size_t brushes = 0;
    for (const int leaf : test::Leafs(made.second))
        brushes += made.second.nodes[std::size_t(leaf)].brushes.size();
    EXPECT_EQ(brushes, 20u);
    EXPECT_EQ(made.second.nodes[0].bounds.mins, Vec3f(-136, -136, -8));
    EXPECT_EQ(made.second.nodes[0].bounds.maxs, Vec3f(136, 136, 136));
}

TEST(EmptyRoom, PortalFile) {
    World world;
    AddEmptyRoom(world);
    const Compiled made = world.Compile();
    EXPECT_TRUE(made.portalFile.starts_with("PRT1\n4\n4\n16\n4 0 2 0 (0 0 0 ) (0 0 128 ) (0 128 128 ) (0 128 0 ) \n"));
    EXPECT_EQ(std::count(made.portalFile.begin(), made.portalFile.end(), '\n'), 4 + 4 + 16);
}

TEST(EmptyRoom, CoordinatesOffTheIntegersHaveSixPlaces) {
    World world;
    world.AddRoom({-128, -128, 0}, {128, 128, 100.25});
    world.AddEntity("info_player_start", {0, 0, 32});
    EXPECT_THAT(world.Compile().portalFile, HasSubstr("(0 0 100.250000 )"));
}

TEST(EmptyRoom, WithoutBlocksItIsOneCluster) {
    World world;
    AddEmptyRoom(world);
    world.map.blockSize = {0, 0, 0};
    const Compiled made = world.Compile();
    EXPECT_EQ(made.clusters, 1);
    EXPECT_EQ(made.visiblePortals, 0);
    EXPECT_EQ(made.solidFaces, 6);
}

TEST(EmptyRoom, BlocksCutIt) {
    World world;
    AddEmptyRoom(world);
    world.map.blockSize = {64, 0, 128};
    const Compiled made = world.Compile();
    EXPECT_EQ(made.clusters, 4); // x from -128 in steps of 64, z not
    EXPECT_EQ(made.visiblePortals, 3);
}

TEST(EmptyRoom, BlocksBeyondAllMeasureAreRefused) {
    World world;
    world.AddRoom({-4096, -4096, 0}, {4096, 4096, 128});
    world.AddEntity("info_player_start", {0, 0, 32});
    world.map.blockSize = {1, 1, 1};
    EXPECT_THROW((void)world.Compile(), std::runtime_error);
}

TEST(Leak, DetailWallsDoNotSeal) {
    World world;
    AddEmptyRoom(world);
    world.Brushes()[0].detail = true;
    EXPECT_EQ(world.Compile().sealing, Sealing::Leaked);
    world.SetKey("_ignoreleaks", "1");
    EXPECT_EQ(world.Compile().sealing, Sealing::Sealed);
}

TEST(Leak, OnlyEntitiesInTheOpenCount) {
    World world;
    world.AddRoom({-128, -128, 0}, {128, 128, 128});
    EXPECT_EQ(world.Compile().sealing, Sealing::Empty);
    world.AddEntity("light", {0, 0, -8}); // in the floor
    world.AddEntity("_decal", {0, 0, 500});
    EXPECT_EQ(world.Compile().sealing, Sealing::Empty);
    EXPECT_THAT(world.text, HasSubstr("Entity 1: the light stands in solid"));
    world.AddEntity("light", {0, 0, 64});
    EXPECT_EQ(world.Compile().sealing, Sealing::Sealed);
    world.AddEntity("light", {0, 0, 500}); // in the void
    EXPECT_EQ(world.Compile().sealing, Sealing::Leaked);
}

TEST(Leak, EntitiesOfBrushesMayBeAnywhere) {
    World world;
    AddEmptyRoom(world);
    world.AddEntity("func_door", {0, 0, 500});
    world.map.entities.back().pairs.Set("model", "*1");
    EXPECT_EQ(world.Compile().sealing, Sealing::Sealed);
}

/// A chain of rooms along x with doorways. Each wall is of its own boxes, so a hole can be cut anywhere.
struct RoomChain {
    std::vector<Boundsd> rooms;
    Vec3d hole; ///< middle of it, in the floor of one of the rooms
};

RoomChain AddRoomChain(World &world, std::mt19937 &random, bool pierced) {
    const auto pick = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random) * 8; };
    RoomChain chain;
    const int count = std::uniform_int_distribution<int>(1, 5)(random);
    const int holed = std::uniform_int_distribution<int>(0, count - 1)(random);
    double x = pick(-100, 0);
    for (int i = 0; i < count; i++) {
        const Vec3d mins{x, double(pick(-40, -12)), double(pick(-20, -4))};
        const Vec3d maxs{x + pick(8, 40), double(pick(12, 40)), double(pick(12, 40))};
        chain.rooms.push_back({mins, maxs});
        const Vec3d outerMins = mins - Vec3d(0, 16, 16), outerMaxs = maxs + Vec3d(0, 16, 16);
        const bool hole = pierced && i == holed;
        const Vec3d at{(mins.x + maxs.x) / 2, 0, mins.z - 8};
        world.AddBox({mins.x, outerMins.y, maxs.z}, {maxs.x, outerMaxs.y, outerMaxs.z});
        world.AddBox({mins.x, outerMins.y, outerMins.z}, {maxs.x, mins.y, maxs.z});
        world.AddBox({mins.x, maxs.y, outerMins.z}, {maxs.x, outerMaxs.y, maxs.z});
        if (!hole)
            world.AddBox({mins.x, mins.y, outerMins.z}, {maxs.x, maxs.y, mins.z});
        else {
            chain.hole = at;
            world.AddBox({mins.x, mins.y, outerMins.z}, {at.x - 4, maxs.y, mins.z});
            world.AddBox({at.x + 4, mins.y, outerMins.z}, {maxs.x, maxs.y, mins.z});
            world.AddBox({at.x - 4, mins.y, outerMins.z}, {at.x + 4, -4, mins.z});
            world.AddBox({at.x - 4, 4, outerMins.z}, {at.x + 4, maxs.y, mins.z});
        }
        // The wall towards the next room, with a doorway but for the last; the first has a whole one.
        constexpr double kFar = 400;
        const auto wall = [&](double from, bool door) {
            if (!door) {
                world.AddBox({from, -kFar, -kFar}, {from + 16, kFar, kFar});
                return;
            }
            world.AddBox({from, -kFar, -kFar}, {from + 16, -32, kFar});
            world.AddBox({from, 32, -kFar}, {from + 16, kFar, kFar});
            world.AddBox({from, -32, -kFar}, {from + 16, 32, 0});
            world.AddBox({from, -32, 64}, {from + 16, 32, kFar});
        };
        if (i == 0)
            wall(x - 16, false);
        wall(maxs.x, i + 1 < count);
        x = maxs.x + 16;
    }
    world.AddEntity("info_player_start", Vec3f(chain.rooms.front().Center()));
    return chain;
}

TEST(Leak, SealedRoomsNeverLeakAndPiercedOnesAlwaysDo) {
    for (unsigned seed = 0; seed < 60; seed++) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        World sealed, pierced;
        AddRoomChain(sealed, random, false);
        const Compiled made = sealed.Compile();
        EXPECT_EQ(made.sealing, Sealing::Sealed);
        EXPECT_EQ(made.areas, 1);
        EXPECT_TRUE(LeakLine(made.second, sealed.map).empty());
        EXPECT_EQ(LeakedEntity(made.second), -1);

        const RoomChain chain = AddRoomChain(pierced, random, true);
        const Compiled open = pierced.Compile();
        EXPECT_EQ(open.sealing, Sealing::Leaked);
        EXPECT_EQ(LeakedEntity(open.first), 1);
        const std::vector<Vec3f> line = LeakLine(open.first, pierced.map);
        ASSERT_GE(line.size(), 2u);
        EXPECT_EQ(line.back(), pierced.map.entities[1].origin);
        // Its points are middles of portals: one of them lies in the hole or at one of its ends.
        EXPECT_TRUE(std::any_of(line.begin(), line.end(), [&](const Vec3f &p) {
            const Vec3d away = Vec3d(p) - chain.hole;
            return std::abs(away.x) <= 4.01 && std::abs(away.y) <= 4.01 && std::abs(away.z) <= 8.01;
        }));
    }
}

TEST(Leak, FileHasAPointALine) {
    EXPECT_EQ(LeakFileText({{1, -2.5f, 3}, {0, 0, 1000}}),
              "1.000000 -2.500000 3.000000\n0.000000 0.000000 1000.000000\n");
}

constexpr std::uint32_t kHelper = C_STRUCTURAL | C_TRANSLUCENT | C_NODRAW;

/// A box that seals nothing, with the property on its side towards +x.
void AddDoor(World &world, const Vec3d &mins, const Vec3d &maxs, std::uint32_t property) {
    const int number = world.AddBox(mins, maxs, kHelper);
    Brush &brush = world.Brushes()[std::size_t(world.IndexOf(number))];
    brush.sides[1].compileFlags |= property;
    brush.compileFlags |= property;
}

TEST(Areas, AreaPortalInADoorwayMakesTwo) {
    for (const double half : {8.0, 2.0}) { // fills the doorway; is thinner
        World world;
        AddTwoRooms(world);
        AddDoor(world, {-half, -32, 0}, {half, 32, 64}, C_AREAPORTAL);
        const Compiled made = world.Compile();
        EXPECT_EQ(made.sealing, Sealing::Sealed);
        EXPECT_EQ(made.areas, 2);
        EXPECT_TRUE(IdleAreaPortals(made.second, world.map.World()).empty());
    }
}

TEST(Areas, WithoutAnAreaPortalItIsOne) {
    World world;
    AddTwoRooms(world);
    EXPECT_EQ(world.Compile().areas, 1);
    AddDoor(world, {-2, -32, 0}, {2, 32, 64}, 0);
    EXPECT_EQ(world.Compile().areas, 1);
}

TEST(Areas, AreaPortalThatLeavesTheDoorwayAjarMakesNone) {
    for (const double half : {8.0, 2.0}) {
        World world;
        AddTwoRooms(world);
        AddDoor(world, {-half, -32, 0}, {half, 16, 64}, C_AREAPORTAL);
        const Compiled made = world.Compile();
        EXPECT_EQ(made.areas, 1);
        const std::vector<int> idle = IdleAreaPortals(made.second, world.map.World());
        ASSERT_EQ(idle.size(), 1u);
        EXPECT_TRUE(world.Brushes()[std::size_t(idle[0])].compileFlags & C_AREAPORTAL);
    }
}

TEST(Areas, AntiportalSeparatesToo) {
    World world;
    AddTwoRooms(world);
    const Compiled open = world.Compile();
    AddDoor(world, {-2, -32, 0}, {2, 32, 64}, C_ANTIPORTAL);
    const Compiled made = world.Compile();
    EXPECT_EQ(made.areas, 2);
    EXPECT_GT(made.solidFaces, open.solidFaces);
}

TEST(Areas, SkyBoxIsWhatItsEntitySees) {
    World world;
    AddEmptyRoom(world);
    world.AddRoom({600, -128, 0}, {700, 128, 128});
    world.AddEntity("_skybox", {650, 0, 32});
    const Compiled made = world.Compile();
    EXPECT_EQ(made.areas, 2);
    for (const int leaf : test::Leafs(made.second)) {
        const TreeNode &node = made.second.nodes[std::size_t(leaf)];
        if (!node.opaque) {
            EXPECT_EQ(node.skyBox, node.bounds.mins.x >= 600);
        }
    }
}

TEST(Clusters, OpaqueLeafsHaveNeitherClusterNorArea) {
    World world;
    AddTwoRooms(world);
    const Compiled made = world.Compile();
    std::vector<int> used(std::size_t(made.clusters), 0);
    for (const int leaf : test::Leafs(made.second)) {
        const TreeNode &node = made.second.nodes[std::size_t(leaf)];
        if (node.opaque) {
            EXPECT_EQ(node.cluster, -1);
            EXPECT_EQ(node.area, -1);
        } else {
            EXPECT_EQ(node.area, 0);
            used.at(std::size_t(node.cluster))++;
        }
    }
    EXPECT_THAT(used, ::testing::Each(1));
}

TEST(Clusters, HintCutsAndIsMarkedWhileSkipDoesNot) {
    for (const bool hint : {true, false}) {
        World world;
        world.AddRoom({0, 0, 0}, {512, 256, 128});
        world.AddEntity("info_player_start", {64, 64, 32});
        world.map.blockSize = {0, 0, 0};
        const int number = world.AddBox({248, 0, 0}, {256, 256, 128}, kHelper | C_SKIP);
        Brush &brush = world.Brushes()[std::size_t(world.IndexOf(number))];
        if (hint)
            brush.sides[1].compileFlags = kHelper | C_HINT;
        const Compiled made = world.Compile();
        EXPECT_EQ(made.clusters, hint ? 2 : 1);
        if (hint) {
            EXPECT_THAT(made.portalFile, HasSubstr("\n4 0 1 1 ("));
        }
    }
}

TEST(Clusters, DetailCutsOnlyWhenDeepAndThenKeepsItsCluster) {
    World world;
    world.AddRoom({0, 0, 0}, {512, 256, 128});
    world.AddEntity("info_player_start", {64, 64, 32});
    world.map.blockSize = {0, 0, 0};
    world.AddBox({200, 100, 0}, {216, 116, 64}, C_DETAIL);
    const Compiled flat = world.Compile();
    EXPECT_EQ(flat.clusters, 1);
    EXPECT_EQ(test::CountLeafs(flat.second, [](const TreeNode &node) { return !node.opaque; }), 1);
    world.options.deep = true;
    const Compiled deep = world.Compile();
    EXPECT_EQ(deep.clusters, 1);
    EXPECT_EQ(deep.visiblePortals, 0);
    EXPECT_GT(test::CountLeafs(deep.second, [](const TreeNode &node) { return node.cluster == 0; }), 4);
}

TEST(Clusters, MoreThanFilesMayHoldAreAnError) {
    constexpr int kLeafs = 131073;
    Tree tree; // each node has a leaf in front and the next node behind
    tree.nodes.resize(2 * kLeafs - 1);
    for (int i = 0; i + 1 < kLeafs; ++i) {
        tree.nodes[std::size_t(2 * i)].planeNum = 0;
        tree.nodes[std::size_t(2 * i)].children = {2 * i + 1, 2 * i + 2};
    }
    try {
        NumberClusters(tree, false);
        FAIL() << "numbered";
    } catch (const Error &error) {
        EXPECT_STREQ(error.what(), "the map has 131073 clusters, expected at most 131072: larger blocks (world key "
                                   "_blocksize) and more detail brushes make fewer");
    }
    tree.nodes[1].opaque = true;
    EXPECT_EQ(NumberClusters(tree, false), 131072);
}

} // namespace
} // namespace q3
