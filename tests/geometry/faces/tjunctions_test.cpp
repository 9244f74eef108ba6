// GPL-2.0-or-later. T-junction repair: no vertex of a face is left alone on the edge of another.
#include "q3map2/geometry/faces/tjunctions.h"
#include "tests/geometry/faces/face_scene.h"

#include <algorithm>
#include <random>

namespace q3::test {
namespace {

using Rectangle = std::array<float, 4>; ///< x0 y0 x1 y1

/// Cuts the rectangle into `count` pieces at random whole coordinates.
std::vector<Rectangle> RandomTiles(std::mt19937 &random, int count) {
    std::vector<Rectangle> tiles{{0, 0, 1024, 768}};
    while (int(tiles.size()) < count) {
        const std::size_t i = random() % tiles.size();
        Rectangle a = tiles[i], b = a;
        const std::size_t axis = random() % 2;
        const int size = int(a[2 + axis] - a[axis]);
        if (size < 16)
            continue;
        a[2 + axis] = b[axis] = a[axis] + float(4 + int(random() % unsigned(size - 8)));
        tiles[i] = a;
        tiles.push_back(b);
    }
    return tiles;
}

/// Vertices farther than `margin` from both ends of an edge of another face, nearer than that to its line.
int Cracks(const std::vector<DrawSurface> &surfaces, double margin) {
    int cracks = 0;
    for (const DrawSurface &s : surfaces)
        for (std::size_t i = 0; i < s.verts.size(); ++i) {
            const Vec3d a(s.verts[i].xyz), b(s.verts[(i + 1) % s.verts.size()].xyz);
            const Vec3d direction = Normalize(b - a);
            for (const DrawSurface &other : surfaces)
                for (const DrawVert &v : other.verts) {
                    const Vec3d p = Vec3d(v.xyz) - a;
                    const double along = Dot(p, direction);
                    cracks +=
                        along > margin && along < Length(b - a) - margin && Length(p - direction * along) < margin;
                }
        }
    return cracks;
}

class TJunctionTest : public FaceTest {
  protected:
    void Fix() { FixTJunctions(geometry, 0, context); }
    DrawSurface &Surface(std::size_t i) { return geometry.surfaces[i]; }
};

TEST_F(TJunctionTest, VertexOfANeighborIsInserted) {
    AddFloor(0, 0, 128, 64);
    AddFloor(0, 64, 40, 128);
    AddFloor(40, 64, 128, 128);
    Fix();
    ASSERT_EQ(Surface(0).verts.size(), 5u);
    const auto v = std::ranges::find(Surface(0).verts, Vec3f{40, 64, 0}, &DrawVert::xyz);
    ASSERT_NE(v, Surface(0).verts.end());
    EXPECT_TRUE(v->inserted);
    EXPECT_FLOAT_EQ(v->st[0], 40.f / 64);
    EXPECT_FLOAT_EQ(v->st[1], 1);
    EXPECT_EQ(v->normal, (Vec3f{0, 0, 1}));
    EXPECT_EQ(Surface(1).verts.size(), 4u);
}

TEST_F(TJunctionTest, OrderOfVerticesGoesOnAroundTheFace) {
    AddFloor(0, 0, 128, 64);
    for (float x = 0; x < 128; x += 16)
        AddFloor(x, 64, x + 16, 96);
    Fix();
    EXPECT_EQ(Surface(0).verts.size(), 11u);
    Polygon w;
    for (const DrawVert &v : Surface(0).verts)
        w.push_back(v.xyz);
    EXPECT_DOUBLE_EQ(WindingAreaVector(w).z, -128 * 64);
    double around = 0;
    for (std::size_t i = 0; i < w.size(); ++i)
        around += Length(Vec3d(w[(i + 1) % w.size()]) - Vec3d(w[i]));
    EXPECT_DOUBLE_EQ(around, 2 * (128 + 64));
}

TEST_F(TJunctionTest, RandomTilesHaveNoCracks) {
    std::mt19937 random(5);
    for (int round = 0; round < 8; ++round) {
        geometry.surfaces.clear();
        for (const Rectangle &r : RandomTiles(random, 60))
            AddFloor(r[0], r[1], r[2], r[3]);
        ASSERT_GT(Cracks(geometry.surfaces, 0.2), 0);
        Fix();
        EXPECT_EQ(Cracks(geometry.surfaces, 0.2), 0);
    }
}

TEST_F(TJunctionTest, TiltedTilesHaveNoCracks) {
    std::mt19937 random(9);
    const Vec3d u = Normalize(Vec3d{3, 1, 0.5}), v = Normalize(Cross(Vec3d{0.2, -0.3, 1}, u));
    for (const Rectangle &r : RandomTiles(random, 60)) {
        const auto at = [&](std::size_t x, std::size_t y) {
            return Vec3f(u * double(r[x]) + v * double(r[y]) + Vec3d{100, 200, 300});
        };
        AddFace({at(0, 1), at(0, 3), at(2, 3), at(2, 1)});
    }
    ASSERT_GT(Cracks(geometry.surfaces, 0.2), 0);
    Fix();
    EXPECT_EQ(Cracks(geometry.surfaces, 0.2), 0);
}

TEST_F(TJunctionTest, BorderOfAPatchGivesVerticesAndGetsNone) {
    AddFloor(0, 0, 128, 64);
    DrawSurface patch;
    patch.kind = SurfaceKind::Patch;
    patch.shader = &shader;
    patch.width = 5, patch.height = 3;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x) {
            DrawVert v;
            v.xyz = {float(x * 32), 64 + float(y * 32), y == 0 ? 0.f : 8.f * float(x * y)};
            patch.verts.push_back(v);
        }
    geometry.surfaces.push_back(patch);
    Fix();
    // Ends of its curves, at x = 0, 64 and 128: not the control points between.
    ASSERT_EQ(Surface(0).verts.size(), 5u);
    EXPECT_EQ(std::ranges::count(Surface(0).verts, Vec3f{64, 64, 0}, &DrawVert::xyz), 1);
    EXPECT_EQ(Surface(1).verts.size(), 15u);
}

TEST_F(TJunctionTest, SomeShadersTakeNoPart) {
    ShaderInfo apart = shader, invisible = shader, sprite = shader;
    apart.geometry.noTJunctions = true;
    invisible.compileFlags |= C_NODRAW;
    sprite.autosprite = true;
    AddFloor(0, 0, 128, 64);
    for (const ShaderInfo *s : {&apart, &invisible, &sprite})
        AddFace({{0, 64, 0}, {0, 128, 0}, {40, 128, 0}, {40, 64, 0}}, *s);
    Fix();
    EXPECT_EQ(Surface(0).verts.size(), 4u);
    options.noTJunctions = true;
    AddFloor(0, 64, 40, 128);
    Fix();
    EXPECT_EQ(Surface(0).verts.size(), 4u);
    options.noTJunctions = false;
    Fix();
    EXPECT_EQ(Surface(0).verts.size(), 5u);
}

TEST_F(TJunctionTest, NearVerticesBecomeOneAtTheWholeCoordinate) {
    AddFace({{0, 0, 0}, {0, 64, 0}, {64, 64, 0}, {64, 0, 0}, {63.95f, 0.02f, 0}});
    Fix();
    ASSERT_EQ(Surface(0).verts.size(), 4u);
    EXPECT_EQ(std::ranges::count(Surface(0).verts, Vec3f{64, 0, 0}, &DrawVert::xyz), 1);
}

// A strip 0.2 high: whether a vertex 0.2 below it is on its line depends on which of its edges made the line.
TEST_F(TJunctionTest, ClosingEdgeOfAFaceComesFirst) {
    AddFace({{0, 0, 0}, {64, 0, 0}, {64, 0.2f, 0}, {0, 0.2f, 0}}); // closes by a short edge: the lower one is next
    AddFace({{32, -64, 0}, {32, -0.2f, 0}, {96, -0.2f, 0}, {96, -64, 0}});
    AddFace({{64, 100.2f, 0}, {0, 100.2f, 0}, {0, 100, 0}, {64, 100, 0}}); // likewise, the upper one
    AddFace({{32, 36, 0}, {32, 99.8f, 0}, {96, 99.8f, 0}, {96, 36, 0}});
    AddFace({{64, 200, 0}, {64, 200.2f, 0}, {0, 200.2f, 0}, {0, 200, 0}}); // closes by the lower one
    AddFace({{32, 136, 0}, {32, 199.8f, 0}, {96, 199.8f, 0}, {96, 136, 0}});
    AddFace({{0, 300.2f, 0}, {0, 300, 0}, {64, 300, 0}, {64, 300.2f, 0}}); // closes by the upper one
    AddFace({{32, 236, 0}, {32, 299.8f, 0}, {96, 299.8f, 0}, {96, 236, 0}});
    Fix();
    const auto gained = [&](std::size_t strip) { return Surface(strip).verts.size() > 4; };
    EXPECT_TRUE(gained(0));
    EXPECT_FALSE(gained(2));
    EXPECT_TRUE(gained(4));
    EXPECT_FALSE(gained(6));
}

TEST_F(TJunctionTest, FaceOfOneSpotVanishes) {
    AddFace({{0, 0, 0}, {0, 0.05f, 0}, {0.05f, 0.05f, 0}, {0.05f, 0, 0}});
    AddFace({{0, 0, 0}, {0, 64, 0}, {0.04f, 64, 0}});
    Fix();
    EXPECT_TRUE(Surface(0).Empty());
    EXPECT_TRUE(Surface(1).Empty());
}

TEST_F(TJunctionTest, AnEdgeTakesAsManyVerticesAsLieOnIt) {
    AddFloor(0, 0, 1024, 64);
    for (float x = 0; x < 1024; x += 2)
        AddFloor(x, 64, x + 2, 96);
    Fix();
    EXPECT_EQ(Surface(0).verts.size(), 4u + 511);
}

} // namespace
} // namespace q3::test
