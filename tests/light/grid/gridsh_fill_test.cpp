// GPL-2.0-or-later. SH grid: points in solids, and what interpolation shows beside walls.
#include "tests/support/light_fixture.h"

#include <algorithm>

namespace q3::test {

namespace {

using FillTest = LightTest;

double Mean(const Coefficients &c) {
    return (c[0].x + c[0].y + c[0].z) / 3;
}

/// Mean of an eighth of a byte from everywhere: no screen shows it.
constexpr double kUnseen = 3.545 / 8 / 255;

/// A wall across the room; cells of 32 put points at multiples of 32.
struct DividedRoom {
    float low, high; ///< of the wall along x
    SceneBuilder Scene() const {
        SceneBuilder scene = Room({-250, -186, -60}, {250, 186, 196});
        scene.AddBox({low, -186, -60}, {high, 186, 196}, TestShader("textures/test/wall"));
        return scene;
    }
};

constexpr Vec3d kLight{120, 10, 70};
SceneBuilder HalfLit(const DividedRoom &room, int litSide = 1) {
    SceneBuilder scene = room.Scene();
    scene.AddEntity(MakeEntity("light", {{"origin", fmt::format("{} 10 70", 120 * litSide)}, {"light", "300"}}));
    return scene;
}

/// Light shown in the dark room, at 1 to 16 units from the wall, against that on the lit side of it.
void ExpectDarkSideDark(const GridView &grid, const DividedRoom &room, int litSide) {
    const double litFace = double(litSide > 0 ? room.high : room.low),
                 darkFace = double(litSide > 0 ? room.low : room.high);
    const Vec3d light{120.0 * litSide, 10, 70};
    for (int t = 1; t <= 16; t++)
        for (const double y : {-140.0, 0.0, 20.0, 150.0}) {
            const double lit = Mean(FromPoint({litFace + litSide * t, y, 70}, light, 300));
            const double shown = Mean(grid.Sample({darkFace - litSide * t, y, 70}));
            EXPECT_LT(shown, 0.01 * lit + kUnseen) << "wall " << room.low << ".." << room.high << ", light on side "
                                                   << litSide << ", " << t << " units from it, y " << y;
        }
}

TEST_F(FillTest, WallsThinnerThanACellKeepTheDarkSideDark) {
    for (const int litSide : {-1, 1})
        for (const DividedRoom room :
             {DividedRoom{-4, 4}, {-1, 7}, {-7, 1}, {-8, 8}, {-2, 14}, {-14, 2}, {28, 44}, {-1, 1}, {-1.5f, 1.5f}})
            ExpectDarkSideDark(LitGrid(HalfLit(room, litSide)), room, litSide);
}

TEST_F(FillTest, WallsWithAFaceInThePlaneOfPointsKeepTheDarkSideDark) {
    for (const int litSide : {-1, 1})
        for (const DividedRoom room : {DividedRoom{-8, 0}, {0, 8}, {-16, 0}, {0, 16}})
            ExpectDarkSideDark(LitGrid(HalfLit(room, litSide)), room, litSide);
}

TEST_F(FillTest, WallsBetweenPointsLeakNoFartherThanTheNextPoint) {
    for (const DividedRoom room : {DividedRoom{4, 20}, {12, 20}, {8, 16}, {36, 44}}) {
        const GridView grid = LitGrid(HalfLit(room));
        const double next = 32 * std::floor(double(room.low) / 32);
        for (int t = 0; t <= 64; t += 4)
            EXPECT_EQ(Largest(grid.Sample({next - t, 20, 70})), 0) << t << " units before the point at " << next;
    }
}

TEST_F(FillTest, LitSideOfAThinWallStaysLit) {
    for (const DividedRoom room : {DividedRoom{-4, 4}, {-8, 8}}) {
        const GridView grid = LitGrid(HalfLit(room));
        for (int t = 1; t <= 32; t++) {
            const Vec3d p{double(room.high) + t, 20, 70};
            const double share = Mean(grid.Sample(p)) / Mean(FromPoint(p, kLight, 300));
            EXPECT_LT(share, 1.25) << t;
            EXPECT_GT(share, t < 8 ? 0.2 : 0.4) << t; // it falls to the dark side's light within the wall
        }
    }
}

TEST_F(FillTest, WallsBetweenLitRoomsDoNotDarkenThem) {
    SceneBuilder scene = HalfLit({-4, 4});
    scene.AddEntity(MakeEntity("light", {{"origin", "-120 10 70"}, {"light", "300"}}));
    const GridView grid = LitGrid(scene);
    for (const int side : {-1, 1})
        for (int t = 1; t <= 32; t++) {
            const Vec3d p{double(4 + t), 20, 70};
            const double share = Mean(grid.Sample({side * p.x, p.y, p.z})) / Mean(FromPoint(p, kLight, 300));
            EXPECT_LT(share, 1.5) << t;
            EXPECT_GT(share, 0.75) << t;
        }
}

/// Light beside the walls of a room with one light at 0 0 128, from this far on.
void ExpectNoDarkWalls(const GridView &grid, const Boundsf &room) {
    int checked = 0;
    for (int i = 0; i <= 16; i++)
        for (int j = 0; j <= 16; j++)
            for (const float height : {1.0f, 30.0f, 100.0f, 160.0f, 240.0f}) {
                const Vec3f inner = room.maxs - room.mins - Vec3f{2, 2, 0};
                const Vec3d p(room.mins + Vec3f{1 + inner.x * float(i) / 16, 1 + inner.y * float(j) / 16, height});
                const double distance = Length(p - Vec3d{0, 0, 128});
                if (distance < 250)
                    continue;
                checked++;
                const double share = Mean(grid.Sample(p)) / Mean(FromPoint(p, {0, 0, 128}, 300));
                EXPECT_GT(share, 0.6) << p.x << ' ' << p.y << ' ' << p.z;
                EXPECT_LT(share, 1.7) << p.x << ' ' << p.y << ' ' << p.z;
            }
    EXPECT_GT(checked, 200);
}

TEST_F(FillTest, OuterWallsDoNotDarkenTheRoom) {
    SceneBuilder scene = Room();
    scene.AddEntity(MakeEntity("light", {{"origin", "0 0 128"}, {"light", "300"}}));
    ExpectNoDarkWalls(LitGrid(scene), RoomBounds());
}

TEST_F(FillTest, OuterWallsInThePlanesOfPointsDoNotDarkenTheRoom) {
    const Boundsf room{{-256, -192, 0}, {256, 192, 256}};
    SceneBuilder scene = Room(room.mins, room.maxs);
    scene.AddEntity(MakeEntity("light", {{"origin", "0 0 128"}, {"light", "300"}}));
    ExpectNoDarkWalls(LitGrid(scene), room);
}

TEST_F(FillTest, CorridorsLowerThanACellGetLight) {
    // Between the points at 0 and 64.
    SceneBuilder scene = Room({-250, -60, 10}, {250, 60, 50});
    const Vec3d light{-200, 10, 30};
    scene.AddEntity(MakeEntity("light", {{"origin", "-200 10 30"}, {"light", "300"}}));
    const GridView grid = LitGrid(scene);
    EXPECT_GT(result.gridSH.moved, 0);
    for (double x = -100; x <= 240; x += 20)
        for (const double y : {-50.0, 0.0, 40.0})
            for (const double z : {12.0, 30.0, 48.0}) {
                const Vec3d p{x, y, z};
                const double share = Mean(grid.Sample(p)) / Mean(FromPoint(p, light, 300));
                EXPECT_GT(share, 0.7) << x << ' ' << y << ' ' << z;
                EXPECT_LT(share, 1.4) << x << ' ' << y << ' ' << z;
            }
}

TEST_F(FillTest, ShaftsNarrowerThanACellGetLight) {
    SceneBuilder scene = Room({5, 5, 0}, {25, 27, 500});
    const Vec3d light{15, 15, 450};
    scene.AddEntity(MakeEntity("light", {{"origin", "15 15 450"}, {"light", "300"}}));
    const GridView grid = LitGrid(scene);
    for (double z = 20; z <= 300; z += 20) {
        const Vec3d p{15, 20, z};
        const double share = Mean(grid.Sample(p)) / Mean(FromPoint(p, light, 300));
        EXPECT_GT(share, 0.7) << z;
        EXPECT_LT(share, 1.4) << z;
    }
}

TEST_F(FillTest, PointsInTheVoidAreZero) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", "20");
    scene.SetWorldKey("_mingridlight", "30");
    const Boundsf rock{{-20, -186, 4}, {250, 186, 252}};
    scene.AddBox(rock.mins, rock.maxs, TestShader("textures/test/wall"));
    scene.AddEntity(MakeEntity("light", {{"origin", "-120 10 100"}, {"light", "300"}}));
    const GridView grid = LitGrid(scene);
    int zero = 0, lit = 0;
    for (std::size_t i = 0; i < grid.Count(); i++) {
        const Vec3d p = grid.Position(i);
        if (p.x > -20 + 32) {
            EXPECT_EQ(Largest(grid.At(i)), 0) << p.x << ' ' << p.y << ' ' << p.z;
            zero++;
        } else if (p.x < -21 && Inside(p, RoomBounds())) {
            EXPECT_GT(Mean(grid.At(i)), 0);
            lit++;
        }
    }
    EXPECT_GT(zero, 300);
    EXPECT_GT(lit, 150);
    EXPECT_EQ(result.gridSH.points, std::int64_t(grid.Count()));
    EXPECT_LT(result.gridSH.open + result.gridSH.filled + result.gridSH.moved, result.gridSH.points - zero + 1);
}

} // namespace

} // namespace q3::test
