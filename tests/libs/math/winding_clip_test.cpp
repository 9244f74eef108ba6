// GPL-2.0-or-later. Polygons cut by planes.
#include "libs/math/winding.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {

namespace {

const Polygon kSquare{{0, 0, 0}, {0, 64, 0}, {64, 64, 0}, {64, 0, 0}}; // clockwise from above

Plane RandomPlane(std::mt19937 &random) {
    std::uniform_real_distribution<double> component(-1, 1), place(0, 64);
    const Vec3d normal = Normalize(Vec3d{component(random), component(random), component(random)});
    return {normal, Dot(normal, Vec3d{place(random), place(random), 0})};
}

} // namespace

TEST(ClipPolygon, PartsHaveTheAreaOfTheWhole) {
    std::mt19937 random(1);
    for (int i = 0; i < 200; ++i) {
        Polygon front, back;
        ClipPolygon(kSquare, RandomPlane(random), 0.001, front, back);
        EXPECT_NEAR(WindingArea(front) + WindingArea(back), 64 * 64, 1);
    }
}

TEST(ClipPolygon, PartsLieOnTheirSidesAndFaceTheSameWay) {
    std::mt19937 random(2);
    for (int i = 0; i < 200; ++i) {
        const Plane plane = RandomPlane(random);
        Polygon front, back;
        ClipPolygon(kSquare, plane, 0.1, front, back);
        for (const Vec3f &p : front)
            EXPECT_GE(plane.Distance(Vec3d(p)), -0.11);
        for (const Vec3f &p : back)
            EXPECT_LE(plane.Distance(Vec3d(p)), 0.11);
        for (const Polygon &part : {front, back}) {
            if (WindingArea(part) > 1) {
                EXPECT_GT(PlaneOf(part).normal.z, 0.999);
            }
        }
    }
}

TEST(ClipPolygon, CutsAtExactlyThePlaneOfAnAxis) {
    const double dist = double(21.3f);
    for (const double sign : {1.0, -1.0}) {
        Polygon front, back;
        ClipPolygon(kSquare, {{sign, 0, 0}, sign * dist}, 0.001, front, back);
        int onPlane = 0;
        for (const Vec3f &p : front)
            onPlane += p.x == 21.3f;
        EXPECT_EQ(onPlane, 2);
        EXPECT_EQ(front.size(), 4u);
        EXPECT_EQ(back.size(), 4u);
    }
}

TEST(ClipPolygon, WholeOnOneSideStaysWhole) {
    Polygon front, back;
    ClipPolygon(kSquare, {{1, 0, 0}, -1}, 0.1, front, back);
    EXPECT_EQ(front, kSquare);
    EXPECT_TRUE(back.empty());
    ClipPolygon(kSquare, {{1, 0, 0}, 64.05}, 0.1, front, back); // touches within epsilon
    EXPECT_EQ(back, kSquare);
    EXPECT_TRUE(front.empty());
}

TEST(ClipPolygon, OnThePlaneIsNowhereOrBack) {
    const Plane plane{{0, 0, 1}, 0.05};
    Polygon front, back;
    ClipPolygon(kSquare, plane, 0.1, front, back);
    EXPECT_TRUE(front.empty());
    EXPECT_TRUE(back.empty());
    ClipPolygonKeepOn(kSquare, plane, 0.1, front, back);
    EXPECT_TRUE(front.empty());
    EXPECT_EQ(back, kSquare);
}

TEST(ClipPolygon, MayCutInPlace) {
    Polygon w = kSquare, front, back, expected;
    ClipPolygon(kSquare, {{1, 0, 0}, 16}, 0.1, expected, back);
    ClipPolygon(w, {{1, 0, 0}, 16}, 0.1, w, back);
    EXPECT_EQ(w, expected);
}

TEST(ChopPolygon, KeepsTheFront) {
    Polygon w = kSquare;
    EXPECT_TRUE(ChopPolygon(w, {{1, 0, 0}, 16}, 0.1));
    EXPECT_NEAR(WindingArea(w), 48 * 64, 1e-3);
    EXPECT_TRUE(ChopPolygon(w, {{1, 0, 0}, 0}, 0.1));
    EXPECT_NEAR(WindingArea(w), 48 * 64, 1e-3);
    EXPECT_FALSE(ChopPolygon(w, {{1, 0, 0}, 64}, 0.1));
    EXPECT_TRUE(w.empty());
    w = kSquare;
    EXPECT_FALSE(ChopPolygon(w, {{0, 0, 1}, 0}, 0.1)) << "a polygon on the plane is nothing";
}

TEST(ChopPolygon, ManyPlanesMakeACircle) {
    constexpr int sides = 400;
    Winding<double> w{{-9, -9, 0}, {-9, 9, 0}, {9, 9, 0}, {9, -9, 0}};
    for (int i = 0; i < sides; ++i) {
        const double angle = 2 * 3.14159265358979 * i / sides;
        ASSERT_TRUE(ChopPolygon(w, {{std::cos(angle), std::sin(angle), 0}, -4}, 0x1p-24));
    }
    EXPECT_NEAR(WindingArea(w), 3.14159265358979 * 16, 0.01);
    EXPECT_EQ(w.size(), std::size_t(sides));
}

TEST(SideOf, TellsByATenthOfAUnit) {
    EXPECT_EQ(SideOf(kSquare, {{0, 0, 1}, -0.11}), PolygonSide::Front);
    EXPECT_EQ(SideOf(kSquare, {{0, 0, 1}, 0.11}), PolygonSide::Back);
    EXPECT_EQ(SideOf(kSquare, {{0, 0, 1}, 0.09}), PolygonSide::On);
    EXPECT_EQ(SideOf(kSquare, {{1, 0, 0}, 32}), PolygonSide::Cross);
}

TEST(IsTiny, NeedsThreeLongEdges) {
    EXPECT_FALSE(IsTiny(kSquare));
    EXPECT_FALSE(IsTiny({{0, 0, 0}, {0, 0.21f, 0}, {0.21f, 0, 0}}));
    EXPECT_TRUE(IsTiny({{0, 0, 0}, {0, 64, 0}, {0.1f, 64, 0}, {0.1f, 0, 0}})) << "a sliver has two";
    EXPECT_TRUE(IsTiny({}));
}

TEST(BasePolygon, CoversTheWorldInItsPlane) {
    std::mt19937 random(3);
    for (int i = 0; i < 100; ++i) {
        const Plane plane = RandomPlane(random);
        const Polygon w = BasePolygon(plane);
        ASSERT_EQ(w.size(), 4u);
        for (const Vec3f &p : w)
            EXPECT_NEAR(plane.Distance(Vec3d(p)), 0, 0.05);
        EXPECT_NEAR(WindingArea(w) / (262144.0 * 262144.0), 1, 1e-4);
        EXPECT_GT(Dot(PlaneOf(w).normal, plane.normal), 0.99999);
    }
}

TEST(PlaneOf, SkipsPointsInALine) {
    const Polygon w{{0, 0, 8}, {0, 32, 8}, {0, 64, 8}, {64, 64, 8}, {64, 0, 8}};
    const Plane plane = PlaneOf(w);
    EXPECT_EQ(plane.normal, (Vec3d{0, 0, 1}));
    EXPECT_EQ(plane.dist, 8);
    EXPECT_EQ(PlaneOf(Reversed(w)).normal, (Vec3d{0, 0, -1}));
    EXPECT_EQ(PlaneOf({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}).normal, Vec3d{});
    EXPECT_EQ(PlaneOf({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}}).normal, Vec3d{});
}

} // namespace q3::test
