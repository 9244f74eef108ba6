// GPL-2.0-or-later. Polygons to triangles: all of the polygon, once, facing as it does.
#include "common/error.h"
#include "q3map2/geometry/faces/face_surfaces.h"
#include "tests/geometry/faces/face_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include <gmock/gmock.h>

namespace q3::test {
namespace {

/// A convex polygon on an ellipse of the plane z = 0, some edges with further points on them.
Polygon RandomPolygon(std::mt19937 &random, bool extraPoints) {
    std::uniform_real_distribution<double> uniform(0, 1);
    const int n = 3 + int(random() % 8);
    std::vector<double> angles;
    for (int i = 0; i < n; ++i)
        angles.push_back(-2 * std::numbers::pi * (i + 0.8 * uniform(random)) / n);
    Polygon w;
    for (std::size_t i = 0; i < angles.size(); ++i) {
        const auto at = [&](double a) { return Vec3d{200 * std::cos(a), 120 * std::sin(a), 0}; };
        const Vec3d a = at(angles[i]), b = at(angles[(i + 1) % angles.size()]);
        const int extra = extraPoints ? int(random() % 4) : 0;
        for (int k = 0; k <= extra; ++k)
            w.push_back(Vec3f(a + (b - a) * (double(k) / (extra + 1))));
    }
    return w;
}

class TriangulateTest : public FaceTest {
  protected:
    DrawSurface Triangulated(const Polygon &w) {
        DrawSurface surface = AddFace(w);
        TriangulateFace(surface, context);
        return surface;
    }
    /// Exactly the polygon's area, and no triangle that faces away.
    static void ExpectCovered(const DrawSurface &surface, const Polygon &w) {
        EXPECT_NEAR(AreaVector(surface).z, -WindingAreaVector(w).z, 1e-3 * WindingArea(w));
        for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3) {
            const auto at = [&](std::size_t k) {
                return Vec3d(surface.verts[std::size_t(surface.indexes[i + k])].xyz);
            };
            EXPECT_GT(Cross(at(2) - at(0), at(1) - at(0)).z, 0);
        }
    }
};

TEST_F(TriangulateTest, QuadIsAStripOfTwo) {
    const DrawSurface s = Triangulated({{0, 0, 0}, {0, 64, 0}, {64, 64, 0}, {64, 0, 0}});
    EXPECT_EQ(s.verts.size(), 4u);
    EXPECT_EQ(s.indexes, (std::vector<int>{0, 2, 3, 1, 2, 0}));
}

TEST_F(TriangulateTest, StripBeginsAtTheLeastVertex) {
    const DrawSurface s = Triangulated({{64, 64, 0}, {64, 0, 0}, {0, 0, 0}, {0, 64, 0}});
    EXPECT_EQ(s.indexes, (std::vector<int>{2, 0, 1, 3, 0, 2}));
}

TEST_F(TriangulateTest, RandomPolygonsAreCovered) {
    std::mt19937 random(3);
    for (int i = 0; i < 400; ++i) {
        const Polygon w = RandomPolygon(random, i % 2 == 1);
        options.maxArea = i % 4 >= 2;
        const DrawSurface s = Triangulated(w);
        ExpectCovered(s, w);
        const bool fan = s.verts.size() == w.size() + 1;
        EXPECT_EQ(s.indexes.size(), 3 * (fan ? w.size() : w.size() - 2));
    }
}

TEST_F(TriangulateTest, FanAroundTheMiddleWhereNoStripWorks) {
    // Points in a line on all sides of a triangle: a strip from a corner ends with flat triangles on the far side.
    const std::array<Vec3d, 3> corners{Vec3d{0, 0, 0}, Vec3d{0, 128, 0}, Vec3d{128, 128, 0}};
    Polygon w;
    for (std::size_t i = 0; i < 3; ++i)
        for (int k = 0; k < 8; ++k)
            w.push_back(Vec3f(corners[i] + (corners[(i + 1) % 3] - corners[i]) * (k / 8.)));
    DrawSurface s = Triangulated(w);
    ASSERT_EQ(s.verts.size(), w.size() + 1);
    ExpectCovered(s, w);
    Vec3d mean;
    for (const Vec3f &p : w)
        mean += Vec3d(p) / double(w.size());
    EXPECT_NEAR(Length(Vec3d(s.verts[0].xyz) - mean), 0, 1e-4);
    EXPECT_NEAR(s.verts[0].st[0], float(mean.x / 64), 1e-5);
    EXPECT_EQ(std::ranges::count(s.indexes, 0), int(w.size()));
}

TEST_F(TriangulateTest, LargestTriangleComesFirstWithMaxArea) {
    options.maxArea = true;
    const Polygon w{{0, 0, 0}, {-20, 50, 0}, {0, 100, 0}, {120, 100, 0}, {100, 0, 0}};
    const DrawSurface s = Triangulated(w);
    ExpectCovered(s, w);
    // The largest of all ten triangles has its corners at 1, 3 and 4.
    const auto at = [&](std::size_t k) { return Vec3d(s.verts[std::size_t(s.indexes[k])].xyz); };
    EXPECT_DOUBLE_EQ(Length(Cross(at(1) - at(0), at(2) - at(0))) / 2, 6500);
}

TEST_F(TriangulateTest, AnyNumberOfCornersIsCutIntoTriangles) {
    Polygon w;
    for (int i = 0; i < 400; ++i)
        w.push_back(Vec3f(Vec3d{std::cos(i * -0.0157), std::sin(i * -0.0157), 0} * 1000));
    for (const bool maxArea : {false, true}) {
        options.maxArea = maxArea;
        EXPECT_NEAR(Area({Triangulated(w)}), WindingArea(w), 1e-4 * WindingArea(w));
    }
}

TEST_F(TriangulateTest, SpritesOfTooManyCornersAreAnErrorWithTheirPlace) {
    shader.autosprite = true;
    context.places->Set(2, 5, "maps/a.map:77");
    DrawSurface sprite;
    sprite.shader = &shader;
    sprite.settings.entity = 2, sprite.primitive = 5;
    sprite.verts.resize(1000);
    try {
        TriangulateFace(sprite, context);
        FAIL() << "no error";
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), testing::StartsWith("Entity 2, Brush 5: maps/a.map:77: a face of the sprite shader"));
    }
}

} // namespace
} // namespace q3::test
