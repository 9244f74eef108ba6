// GPL-2.0-or-later. The meta step: which triangles share vertices, normals and surfaces.
#include "q3map2/geometry/faces/tjunctions.h"
#include "tests/geometry/faces/face_scene.h"

#include <algorithm>
#include <numbers>
#include <random>
#include <set>

#include <gmock/gmock.h>

namespace q3::test {
namespace {

class MetaTest : public FaceTest {
  protected:
    /// columns x rows squares of that size on the floor.
    void AddTiles(int columns, int rows, float size) {
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x)
                AddFloor(float(x) * size, float(y) * size, float(x + 1) * size, float(y + 1) * size);
    }
    /// The top and the right side of a box, which meet at a right angle.
    void AddEdgeOfBox() {
        AddFloor(0, 0, 64, 64, 64);
        AddFace({{64, 0, 64}, {64, 64, 64}, {64, 64, 0}, {64, 0, 0}});
    }
    /// Normals at the common edge of AddEdgeOfBox.
    static std::vector<Vec3f> EdgeNormals(const std::vector<DrawSurface> &surfaces) {
        std::vector<Vec3f> normals;
        for (const DrawSurface &s : surfaces)
            for (const DrawVert &v : s.verts)
                if (v.xyz.x == 64 && v.xyz.z == 64)
                    normals.push_back(v.normal);
        return normals;
    }
    static Boundsf BoundsOf(const DrawSurface &s) {
        Boundsf b;
        for (const DrawVert &v : s.verts)
            b.Add(v.xyz);
        return b;
    }
};

TEST_F(MetaTest, FourSquaresBecomeOneSurface) {
    AddTiles(2, 2, 64);
    const std::vector<DrawSurface> made = Meta();
    ASSERT_EQ(made.size(), 1u);
    EXPECT_EQ(made[0].kind, SurfaceKind::Meta);
    EXPECT_EQ(made[0].verts.size(), 9u);
    EXPECT_EQ(made[0].indexes.size(), 24u);
    EXPECT_TRUE(made[0].planar);
    EXPECT_EQ(made[0].lightmapAxis, (Vec3f{0, 0, 1}));
    EXPECT_EQ(made[0].sampleSize, 16);
    EXPECT_EQ(made[0].lightmapVecs[2], (Vec3f{0, 0, 1}));
    EXPECT_DOUBLE_EQ(AreaVector(made[0]).z, 128 * 128);
}

TEST_F(MetaTest, AMergedSurfaceKnowsTheSidesThatItShows) {
    AddTiles(2, 2, 64);
    for (int i = 0; i < 4; ++i)
        geometry.surfaces[std::size_t(i)].brush = 7 - i / 2, geometry.surfaces[std::size_t(i)].side = 4 + i % 2;
    geometry.surfaces.push_back(geometry.surfaces[0]); // by q3map_cloneShader
    geometry.surfaces.back().isCopy = true;
    EXPECT_THAT(SidesOf(geometry.surfaces[1]), testing::ElementsAre(SideNumber{7, 5}));
    EXPECT_TRUE(SidesOf(geometry.surfaces[4]).empty());
    geometry.surfaces.pop_back();
    const std::vector<DrawSurface> made = Meta();
    ASSERT_EQ(made.size(), 1u);
    EXPECT_THAT(SidesOf(made[0]),
                testing::ElementsAre(SideNumber{6, 4}, SideNumber{6, 5}, SideNumber{7, 4}, SideNumber{7, 5}));
}

TEST_F(MetaTest, VerticesStandInOrderOfFirstUse) {
    AddTiles(3, 3, 64);
    for (const DrawSurface &s : Meta()) {
        int next = 0;
        for (const int i : s.indexes) {
            EXPECT_LE(i, next);
            next = std::max(next, i + 1);
        }
        EXPECT_EQ(next, int(s.verts.size()));
    }
}

TEST_F(MetaTest, WithoutMetaFacesStay) {
    options.meta = false;
    AddTiles(2, 2, 64);
    for (const DrawSurface &s : Meta())
        EXPECT_EQ(s.kind, SurfaceKind::Face);
    shader.geometry.forceMeta = true;
    EXPECT_EQ(Meta().size(), 1u);
}

TEST_F(MetaTest, AutospritesStayApart) {
    shader.autosprite = true;
    AddTiles(2, 2, 64);
    EXPECT_EQ(Meta().size(), 4u);
}

TEST_F(MetaTest, WhatDiffersIsNotMerged) {
    AddTiles(2, 2, 64);
    ShaderInfo other = shader;
    geometry.surfaces[0].shader = &other;
    geometry.surfaces[1].settings.entity = 7;
    geometry.surfaces[2].fogNum = 0;
    const std::vector<DrawSurface> made = Meta();
    ASSERT_EQ(made.size(), 4u);
    for (const DrawSurface &s : made)
        EXPECT_EQ(s.verts.size(), 4u);
}

TEST_F(MetaTest, OtherPlanesAreMergedOnlyOnRequest) {
    AddEdgeOfBox();
    const Geometry flat = geometry;
    EXPECT_EQ(Meta().size(), 2u);
    geometry = flat;
    // Normals differ: no vertex is shared, so nothing speaks for merging at a right angle.
    options.nonPlanarAngle = 30;
    EXPECT_EQ(Meta().size(), 2u);
    geometry = flat;
    options.nonPlanarAngle = 179;
    shader.lightmap.axis = {0, 0, 1};
    const std::vector<DrawSurface> made = Meta();
    ASSERT_EQ(made.size(), 1u);
    EXPECT_EQ(made[0].verts.size(), 6u);
    EXPECT_FALSE(made[0].planar);
}

TEST_F(MetaTest, TrianglesOfCurvesAndModelsShareSurfacesAcrossTheirPlanes) {
    // A barrel vault of 90 degrees, whose normals are smooth: the quads of a curve or of a model.
    constexpr int kQuads = 12;
    const auto at = [](int i, float y) {
        const double angle = std::numbers::pi / 4 + std::numbers::pi / 2 * i / kQuads;
        DrawVert v;
        v.normal = Vec3f(Vec3d{-std::cos(angle), 0, std::sin(angle)});
        v.xyz = v.normal * 256 + Vec3f{0, y, 0};
        return v;
    };
    for (int i = 0; i < kQuads; ++i) {
        DrawSurface quad;
        quad.kind = SurfaceKind::ForcedMeta;
        quad.shader = &shader;
        quad.verts = {at(i, 0), at(i, 64), at(i + 1, 64), at(i + 1, 0)};
        quad.indexes = {0, 1, 2, 0, 2, 3};
        geometry.surfaces.push_back(quad);
    }
    AddEdgeOfBox(); // faces of brushes stay in their planes
    const std::vector<DrawSurface> made = Meta();
    ASSERT_EQ(made.size(), 3u);
    EXPECT_EQ(made[2].verts.size() + made[1].verts.size() + made[0].verts.size(), 2u * (kQuads + 1) + 8);
    int curved = 0;
    for (const DrawSurface &s : made)
        if (!s.planar) {
            ++curved;
            EXPECT_EQ(s.verts.size(), 2u * (kQuads + 1));
            EXPECT_EQ(s.lightmapAxis, (Vec3f{0, 0, 1}));
        }
    EXPECT_EQ(curved, 1);
}

TEST_F(MetaTest, FacesTooLargeForEnginesAreCutUpWithoutMetaToo) {
    options.meta = false;
    Polygon disc;
    constexpr int kCorners = 1200;
    for (int i = 0; i < kCorners; ++i) {
        const double angle = -2 * std::numbers::pi * i / kCorners;
        disc.push_back(Vec3f(Vec3d{std::cos(angle), std::sin(angle), 0} * 8192));
    }
    AddFace(disc);
    const std::vector<DrawSurface> made = Meta();
    for (const DrawSurface &s : made)
        EXPECT_LE(int(s.verts.size()), options.maxVertexLitVerts);
    const double exact = kCorners / 2. * 8192. * 8192 * std::sin(2 * std::numbers::pi / kCorners);
    EXPECT_NEAR(Area(made), exact, 1e-4 * exact);
}

TEST_F(MetaTest, NormalsAreSmoothedBelowTheShadeAngle) {
    for (const float angle : {89.f, 91.f}) {
        for (const bool ofShader : {false, true}) {
            geometry.surfaces.clear();
            AddEdgeOfBox();
            shader.lightmap.shadeAngle = ofShader ? angle : 0;
            for (DrawSurface &s : geometry.surfaces)
                s.settings.shadeAngle = ofShader ? 0 : angle;
            const std::vector<Vec3f> normals = EdgeNormals(Meta());
            ASSERT_EQ(normals.size(), 4u);
            const bool smooth = angle > 90;
            const float half = std::sqrt(0.5f);
            for (const Vec3f &n : normals) {
                EXPECT_FLOAT_EQ(std::max(n.x, n.z), smooth ? half : 1);
                EXPECT_FLOAT_EQ(std::min(n.x, n.z), smooth ? half : 0);
            }
        }
    }
}

TEST_F(MetaTest, ShadeAngleOfTheShaderWins) {
    AddEdgeOfBox();
    shader.lightmap.shadeAngle = 45;
    options.nonPlanarAngle = 120;
    for (const Vec3f &n : EdgeNormals(Meta()))
        EXPECT_FLOAT_EQ(std::max(n.x, n.z), 1);
}

TEST_F(MetaTest, SmoothingCountsADirectionOnce) {
    // Eight triangles face up and two to the side: the mean direction is halfway all the same.
    AddFloor(0, 0, 64, 32, 64);
    AddFloor(0, 32, 64, 64, 64);
    AddFloor(0, 64, 64, 96, 64);
    AddFace({{64, 0, 64}, {64, 32, 64}, {64, 32, 0}, {64, 0, 0}});
    options.nonPlanarAngle = 100;
    for (const Vec3f &n : EdgeNormals(Meta()))
        if (n != Vec3f{0, 0, 1}) {
            EXPECT_FLOAT_EQ(n.x, std::sqrt(0.5f));
        }
}

TEST_F(MetaTest, VertexLimitHolds) {
    AddTiles(24, 24, 16);
    const std::vector<DrawSurface> made = Meta();
    EXPECT_DOUBLE_EQ(Area(made), 24 * 16 * 24 * 16);
    // 576 squares, at least 9 of them in a surface of 64 vertices on average.
    EXPECT_LT(made.size(), 64u);
    std::size_t triangles = 0;
    for (const DrawSurface &s : made) {
        EXPECT_LE(s.verts.size(), 64u);
        triangles += s.indexes.size() / 3;
    }
    EXPECT_EQ(triangles, 2u * 24 * 24);
}

TEST_F(MetaTest, VertexLimitIsAnOption) {
    options.maxSurfaceVerts = 12;
    AddTiles(8, 8, 16);
    for (const DrawSurface &s : Meta())
        EXPECT_LE(s.verts.size(), 12u);
}

TEST_F(MetaTest, VertexLitSurfacesMayBeLarger) {
    shader.compileFlags |= C_VERTEXLIT;
    AddTiles(24, 24, 16);
    const std::vector<DrawSurface> made = Meta();
    ASSERT_EQ(made.size(), 1u);
    EXPECT_EQ(made[0].verts.size(), 625u);
    EXPECT_EQ(made[0].sampleSize, 0);
    EXPECT_EQ(made[0].lightmapAxis, Vec3f{});
}

TEST_F(MetaTest, IndexLimitHolds) {
    options.maxSurfaceIndexes = 30;
    AddTiles(8, 8, 16);
    for (const DrawSurface &s : Meta())
        EXPECT_LE(s.indexes.size(), 30u);
}

TEST_F(MetaTest, SurfacesFitTheLightmapPage) {
    AddTiles(16, 2, 512);
    const std::vector<DrawSurface> made = Meta();
    EXPECT_DOUBLE_EQ(Area(made), 16. * 2 * 512 * 512);
    for (const DrawSurface &s : made) {
        const Boundsf b = BoundsOf(s);
        EXPECT_LE(MaxComponent(b.maxs - b.mins), 16.f * 127);
    }
    // Three squares fit along the page.
    EXPECT_LE(made.size(), 12u);
}

TEST_F(MetaTest, CoarserSamplesAllowLargerSurfaces) {
    shader.lightmap.sampleSize = 64;
    AddTiles(8, 1, 512);
    EXPECT_EQ(Meta().size(), 1u);
}

TEST_F(MetaTest, TextureSeamSplitsVertices) {
    AddTiles(2, 1, 64);
    for (DrawVert &v : geometry.surfaces[1].verts)
        v.st[0] += 0.25f;
    std::size_t verts = 0;
    for (const DrawSurface &s : Meta())
        verts += s.verts.size();
    EXPECT_EQ(verts, 8u);
}

TEST_F(MetaTest, BackSidesStayBackSides) {
    AddTiles(2, 1, 64);
    geometry.surfaces[1].backSide = true;
    const std::vector<DrawSurface> made = Meta();
    ASSERT_EQ(made.size(), 2u);
    EXPECT_FALSE(made[0].backSide);
    EXPECT_TRUE(made[1].backSide);
}

TEST_F(MetaTest, RepeatedTriangleIsLeftOut) {
    AddFloor(0, 0, 64, 64);
    AddFloor(0, 0, 64, 64);
    EXPECT_DOUBLE_EQ(Area(Meta()), 64 * 64);
    EXPECT_GT(out.log.WarningCount("duplicate triangle"), 0);
}

TEST_F(MetaTest, TrianglesWithTinyEdgesAreDropped) {
    DrawSurface &s = AddFloor(0, 0, 64, 64);
    s.kind = SurfaceKind::ForcedMeta;
    s.indexes = {0, 1, 2, 0, 2, 3};
    s.verts[3].xyz = {0.1f, 0, 0};
    EXPECT_DOUBLE_EQ(Area(Meta()), 64 * 32);
}

TEST_F(MetaTest, RandomFloorsKeepTheirAreaAndOrder) {
    std::mt19937 random(11);
    for (int round = 0; round < 5; ++round) {
        geometry.surfaces.clear();
        double area = 0;
        float x = 0;
        for (int i = 0; i < 60; ++i) {
            const float width = float(8 + random() % 64), depth = float(8 * (1 + random() % 8));
            AddFloor(x, 0, x + width, depth);
            x += width, area += double(width * depth);
        }
        FixTJunctions(geometry, 0, context);
        const Geometry before = geometry;
        const std::vector<DrawSurface> made = Meta();
        EXPECT_NEAR(Area(made), area, 1e-6 * area);
        geometry = before;
        const std::vector<DrawSurface> again = Meta();
        ASSERT_EQ(made.size(), again.size());
        for (std::size_t i = 0; i < made.size(); ++i)
            EXPECT_EQ(made[i].indexes, again[i].indexes);
    }
}

} // namespace
} // namespace q3::test
