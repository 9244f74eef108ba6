// GPL-2.0-or-later. Luxels: which are mapped, where they are lit from, and their normals.
#include "tests/support/surface_case.h"

#include <algorithm>
#include <cmath>

namespace q3::test {

namespace {

class LuxelTest : public testing::Test {
  protected:
    GameFolder folder;
};

/// A picture of one color.
std::string Tga(int red, int green, int blue) {
    std::string file(18, '\0');
    file[2] = 2;
    file[12] = file[14] = 1;
    file[16] = 24;
    for (const int c : {blue, green, red})
        file += char(c);
    return file;
}

/// A triangle as a planar surface.
Bsp WithTriangle(const SceneBuilder &room, const std::array<Vec3f, 3> &corners) {
    SceneBuilder scene = room;
    scene.AddTriangles(corners, std::array{0, 1, 2}, Shaded(kA));
    Bsp bsp = scene.Build();
    for (bspDrawSurface_t &surface : bsp.drawSurfaces)
        if (surface.surfaceType == MST_TRIANGLE_SOUP) {
            surface.surfaceType = MST_PLANAR;
            surface.lightmapVecs[2] = bsp.drawVerts[std::size_t(surface.firstVert)].normal;
        }
    return bsp;
}

TEST_F(LuxelTest, OpenLuxelsStandAUnitOffTheirCenter) {
    for (const int super : {1, 3}) {
        SceneBuilder scene = EmptyRoom();
        scene.AddQuad(Rectangle(10, 20, 110, 90, -30), Shaded(kA));
        CaseSettings settings;
        settings.lightmap.super = super;
        SurfaceCase c(scene, folder, settings);
        const SurfaceLight surfaces = c.Mapped();
        const RawLightmap &raw = LightmapOf(c, surfaces, kA);
        int mapped = 0;
        for (int y = 0; y < raw.SuperHeight(); ++y)
            for (int x = 0; x < raw.SuperWidth(); ++x) {
                const std::size_t luxel = raw.SuperIndex(x, y);
                const auto center = [&](int k) { return (float(k) + 0.5f) * 16 / float(super) - 8; };
                const float side = 16 / float(super); // of a luxel
                const auto beyond = [&](float size, int k) { return std::max(-center(k), center(k) - size) / side; };
                // Luxels that the rectangle covers are mapped, and the ring around them at most.
                EXPECT_TRUE(raw.Mapped(luxel) || std::max(beyond(100, x), beyond(70, y)) > -0.5f) << x << ' ' << y;
                EXPECT_TRUE(!raw.Mapped(luxel) || std::max(beyond(100, x), beyond(70, y)) < 1.5f) << x << ' ' << y;
                if (!raw.Mapped(luxel))
                    continue;
                ++mapped;
                ExpectVector(raw.positions[luxel], {10 + center(x), 20 + center(y), -29});
                ExpectVector(raw.normals[luxel], {0, 0, 1});
                EXPECT_EQ(raw.luxelClusters[luxel], c.space.ClusterAt(raw.positions[luxel], 0));
            }
        EXPECT_GE(mapped, int(std::ceil(100.0 / 16 * super)) * int(std::ceil(70.0 / 16 * super)));
    }
}

TEST_F(LuxelTest, NoPlaceIsInSolid) {
    SceneBuilder scene = EmptyRoom({0, 0, 0}, {256, 192, 128});
    scene.AddBox({58, 59, 0}, {101, 102, 70}, Shaded(kB), BoxKind::Detail);
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Mapped();
    std::size_t mapped = 0, nudged = 0;
    for (const RawLightmap &raw : surfaces.lightmaps)
        for (int y = 0; y < raw.height; ++y)
            for (int x = 0; x < raw.width; ++x) {
                const std::size_t luxel = raw.SuperIndex(x, y);
                if (!raw.Mapped(luxel))
                    continue;
                ++mapped;
                EXPECT_GE(c.space.ClusterAt(raw.positions[luxel], 0.125f), 0);
                const Vec3f off = raw.positions[luxel] - (raw.origin + raw.step[0] * float(x) + raw.step[1] * float(y));
                EXPECT_NEAR(std::abs(Dot(off, raw.planeNormal)), 1, 1e-3);
                EXPECT_LT(Length(off), 12) << "at most half a luxel along both axes";
                nudged += Length(off) > 2 ? 1 : 0;
            }
    EXPECT_GT(mapped, 400u);
    EXPECT_GT(nudged, 7u) << "the box covers the centers of luxels that show beside it";
}

TEST_F(LuxelTest, CoveredLuxelsAreOccluded) {
    SceneBuilder scene = EmptyRoom({0, 0, 0}, {256, 256, 128});
    scene.AddQuad(Rectangle(0, 0, 256, 256, 0.25f), Shaded(kA));
    scene.AddBox({90, 90, 0}, {200, 200, 70}, Shaded(kB), BoxKind::Detail);
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Mapped();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    for (int y = 1; y < 16; ++y)
        for (int x = 1; x < 16; ++x) {
            const float px = float(x) * 16, py = float(y) * 16;
            const float inside = std::min(std::min(px - 90, 200 - px), std::min(py - 90, 200 - py));
            const int code = raw.luxelClusters[raw.SuperIndex(x, y)];
            if (inside > 9) {
                EXPECT_EQ(code, kOccluded) << x << ' ' << y;
            }
            if (inside < 0) {
                EXPECT_GE(code, 0) << x << ' ' << y;
            }
        }
}

TEST_F(LuxelTest, DarkDoesNotNudge) {
    for (const bool dark : {false, true}) {
        SceneBuilder scene = EmptyRoom({0, 0, 0}, {256, 256, 128});
        scene.AddQuad(Rectangle(16, 16, 240, 240, 0.25f), Shaded(kA));
        scene.AddBox({74, 0, 0}, {86, 256, 70}, Shaded(kB), BoxKind::Detail);
        CaseSettings settings;
        settings.lightmap.dark = dark;
        SurfaceCase c(scene, folder, settings);
        const SurfaceLight surfaces = c.Mapped();
        const RawLightmap &raw = LightmapOf(c, surfaces, kA);
        for (int y = 0; y < raw.height; ++y) {
            // The box stands on column 4, from 6 units to its left to 6 to its right.
            const std::size_t luxel = raw.SuperIndex(4, y);
            EXPECT_EQ(raw.luxelClusters[luxel] == kOccluded, dark);
            if (!dark) {
                EXPECT_EQ(std::abs(raw.positions[luxel].x - 80), 8);
            }
            EXPECT_EQ(raw.positions[raw.SuperIndex(3, y)].x, 64);
        }
    }
}

TEST_F(LuxelTest, TrianglesMapWhatTheyTouchAndARing) {
    const std::array<Vec3f, 3> corners{{{0, 0, 0}, {100, 420, 0}, {450, 60, 0}}};
    const auto inside = [&](double px, double py, double margin) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3f &a = corners[i], &b = corners[(i + 1) % 3];
            const double ex = b.x - a.x, ey = b.y - a.y;
            if ((ex * (py - a.y) - ey * (px - a.x)) / std::hypot(ex, ey) > margin)
                return false;
        }
        return true;
    };
    for (const float threshold : {1.0f, 0.25f}) {
        CaseSettings settings;
        settings.lightmap.threshold = threshold;
        SurfaceCase c(WithTriangle(EmptyRoom(), corners), folder, settings);
        const SurfaceLight surfaces = c.Mapped();
        const RawLightmap &raw = LightmapOf(c, surfaces, kA);
        for (int y = 0; y < raw.height; ++y)
            for (int x = 0; x < raw.width; ++x) {
                const std::size_t luxel = raw.SuperIndex(x, y);
                if (inside(16.0 * x, 16.0 * y, 0)) {
                    EXPECT_TRUE(raw.Mapped(luxel)) << x << ' ' << y;
                }
                // A luxel reaches 11.3 units from its center, and the ring is one luxel, 22.6 units diagonally.
                if (!inside(16.0 * x, 16.0 * y, 11.4 + 22.7)) {
                    EXPECT_EQ(raw.luxelClusters[luxel], kUnmapped) << x << ' ' << y;
                }
                if (raw.Mapped(luxel))
                    ExpectVector(raw.normals[luxel], {0, 0, 1});
            }
    }
}

/// Their rays go together only if not a bit differs.
TEST_F(LuxelTest, LuxelsBesideATiltedSurfaceHaveItsVeryNormal) {
    const std::array<Vec3f, 3> corners{{{30, 20, 10}, {120, 420, 170}, {450, 60, 230}}};
    SurfaceCase c(WithTriangle(EmptyRoom(), corners), folder);
    const SurfaceLight surfaces = c.Mapped();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    const auto first =
        std::find_if(raw.luxelClusters.begin(), raw.luxelClusters.end(), [](int code) { return code >= 0; });
    const Vec3f normal = raw.normals[std::size_t(first - raw.luxelClusters.begin())];
    EXPECT_GT(std::abs(normal.x), 0.1f);
    int mapped = 0;
    for (std::size_t i = 0; i < raw.luxelClusters.size(); ++i)
        if (raw.Mapped(i)) {
            EXPECT_EQ(raw.normals[i], normal) << i;
            ++mapped;
        }
    EXPECT_GT(mapped, 100);
}

TEST_F(LuxelTest, PlacesStayOnTheirSideOfAThinWall) {
    SceneBuilder scene = EmptyRoom({0, 0, 0}, {512, 256, 128});
    scene.AddBox({254, 0, 0}, {258, 256, 128}, Shaded("textures/test/wall"));
    scene.AddQuad(Rectangle(256, 16, 500, 240, 1), Shaded(kA));
    SceneVisibility visibility;
    visibility.writeLump = true;
    visibility.sees = [](const Boundsf &, const Boundsf &) { return false; };
    scene.SetVisibility(visibility);
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Mapped();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    for (int y = 0; y < raw.height; ++y) {
        const std::size_t luxel = raw.SuperIndex(0, y);
        ASSERT_TRUE(raw.Mapped(luxel));
        EXPECT_GT(raw.positions[luxel].x, 258) << "half a luxel to the left is the other room";
    }
}

/// Heights of a terrain of 2 x 2 cells, 32 units wide each, from kTerrainCorner on.
constexpr std::array<std::array<float, 3>, 3> kHeights{{{57, 25, 10}, {15, 33, 17}, {12, 43, 27}}};
constexpr Vec3f kTerrainCorner{-52, -56, 0};

Vec3f TerrainPoint(int x, int y) {
    return kTerrainCorner + Vec3f{32 * float(x), 32 * float(y), kHeights[std::size_t(y)][std::size_t(x)]};
}

/// A brush from the floor up to a triangle, clockwise seen from above, as a map source.
std::string TerrainBrush(const std::array<Vec3f, 3> &top) {
    const auto point = [](const Vec3f &p, float z) { return fmt::format("( {} {} {} ) ", p.x, p.y, z); };
    const auto side = [](const std::string &points, std::string_view shader) {
        return fmt::format("{}{} 0 0 0 1 1 0 0 0\n", points, shader);
    };
    const auto &[a, b, c] = top;
    std::string text = "{\n" + side(point(a, a.z) + point(b, b.z) + point(c, c.z), "test/a");
    text += side(point(a, 0) + point(c, 0) + point(b, 0), "test/wall");
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3f &p = top[i], &q = top[(i + 1) % 3];
        text += side(point(p, 0) + point(q, 0) + point(q, q.z + 1), "test/wall");
    }
    return text + "}\n";
}

TEST_F(LuxelTest, PlacesOnTerrainStayOverIt) {
    std::string text = EmptyRoom({-256, -256, 0}, {256, 256, 384}).MapText() + "{\n\"classname\" \"func_group\"\n";
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 2; ++x) {
            const Vec3f a = TerrainPoint(x, y), b = TerrainPoint(x, y + 1), c = TerrainPoint(x + 1, y + 1),
                        d = TerrainPoint(x + 1, y);
            text += TerrainBrush({a, b, d}) + TerrainBrush({d, b, c});
        }
    text += "}\n";
    CaseSettings settings;
    settings.script = "textures/test/a\n{\nq3map_nonplanar\nq3map_lightmapAxis z\nq3map_lightmapMergable\n}\n";
    folder.Write("scripts/shaderlist.txt", "test\n");
    folder.Write("scripts/test.shader", settings.script);
    KeptLog quiet;
    VirtualFileSystem files(quiet.log);
    files.Mount(folder.Root(), "pk3");
    SurfaceCase c(CompiledText(text, files), folder, settings);
    const SurfaceLight surfaces = c.Mapped();
    const auto &raw = surfaces.lightmaps[std::size_t(surfaces.lightmapOf[std::size_t(SurfacesOf(c, kA).at(0))])];
    ASSERT_FALSE(raw.planar);
    int moved = 0, over = 0;
    for (std::size_t luxel = 0; luxel < raw.luxelClusters.size(); ++luxel) {
        if (!raw.Mapped(luxel))
            continue;
        const Vec3f &p = raw.positions[luxel];
        const Vec3f corner = raw.origin - Vec3f{8, 8, 0};
        const auto offCenter = [&](float at, float from) { return std::abs(std::fmod(at - from, 16.0f) - 8) > 0.01f; };
        const bool isMoved = offCenter(p.x, corner.x) || offCenter(p.y, corner.y);
        const float u = (p.x - kTerrainCorner.x) / 32, v = (p.y - kTerrainCorner.y) / 32;
        const bool inside = u >= 0 && v >= 0 && u <= 2 && v <= 2;
        moved += isMoved, over += inside;
        EXPECT_TRUE(inside || !isMoved) << p.x << ' ' << p.y << " is beside the terrain";
        if (inside) {
            EXPECT_GE(c.space.ClusterAt(p, 0), 0) << p.x << ' ' << p.y;
            const int x = std::min(int(u), 1), y = std::min(int(v), 1);
            const float s = u - float(x), t = v - float(y);
            const auto z = [&](int i, int j) { return TerrainPoint(x + i, y + j).z; };
            const float height = s + t < 1 ? z(0, 0) + s * (z(1, 0) - z(0, 0)) + t * (z(0, 1) - z(0, 0))
                                           : z(1, 1) + (1 - s) * (z(0, 1) - z(1, 1)) + (1 - t) * (z(1, 0) - z(1, 1));
            EXPECT_GT(p.z, height) << p.x << ' ' << p.y;
        }
    }
    EXPECT_GT(moved, 0);
    EXPECT_GE(over, 16);
}

TEST_F(LuxelTest, ShadedEdgesShareTheMeanNormal) {
    for (const float angle : {40.0f, 70.0f}) {
        SceneBuilder scene = EmptyRoom();
        // A roof: the slopes are 26.57 degrees, so their normals are 53.13 degrees apart.
        scene.AddQuad({{{0, 64, 0}, {64, 64, 32}, {64, 0, 32}, {0, 0, 0}}}, Shaded(kA));
        scene.AddQuad({{{64, 64, 32}, {128, 64, 0}, {128, 0, 0}, {64, 0, 32}}}, Shaded(kB));
        CaseSettings settings;
        settings.lightmap.shade = true;
        settings.script = fmt::format("{}\n{{\nq3map_shadeAngle 90\n}}\n", kB);
        settings.lightmap.shadeAngle = angle;
        SurfaceCase c(scene, folder, settings);
        SurfaceLight surfaces = c.Setup();
        SmoothNormals(c.Inputs(), surfaces);
        int ridge = 0;
        for (const std::string_view shader : {kA, kB}) {
            const bspDrawSurface_t &surface = c.bsp.drawSurfaces[std::size_t(SurfacesOf(c, shader)[0])];
            for (int k = 0; k < surface.numVerts; ++k) {
                const auto vert = std::size_t(surface.firstVert + k);
                const bool smooth = angle > 53.2f && surfaces.verts[vert].xyz.x == 64;
                ridge += surfaces.verts[vert].xyz.x == 64 ? 1 : 0;
                const Vec3f own(c.bsp.drawVerts[vert].normal);
                EXPECT_GT(std::abs(own.x), 0.4f) << "the map's own stay";
                ExpectVector(surfaces.verts[vert].normal, smooth ? Vec3f{0, 0, 1} : own);
            }
        }
        EXPECT_EQ(ridge, 4);
        MapLuxels(c.Inputs(), surfaces);
        // On the way to the ridge normals turn towards the mean.
        const RawLightmap &raw = LightmapOf(c, surfaces, kA);
        const float bottom = raw.normals[raw.SuperIndex(0, 2)].z, top = raw.normals[raw.SuperIndex(4, 2)].z;
        EXPECT_NEAR(bottom, std::cos(std::atan(0.5f)), 0.02f);
        EXPECT_EQ(top > bottom + 0.02f, angle > 53.2f);
        for (const Vec3f &normal : raw.normals)
            EXPECT_TRUE(normal == Vec3f{} || std::abs(Length(normal) - 1) < 1e-4f);
    }
}

/// World directions along which the texture coordinates of a surface grow. Quads are textured along the world's axes:
/// s grows with x or y, by its sign.
struct TextureAxes {
    Vec3f s, t;
};

TextureAxes AxesOf(const SurfaceCase &c, int number) {
    const bspDrawSurface_t &surface = c.bsp.drawSurfaces[std::size_t(number)];
    TextureAxes axes;
    for (int i = 0; i < surface.numVerts; ++i)
        for (int k = 0; k < surface.numVerts; ++k) {
            const bspDrawVert_t &p = c.bsp.drawVerts[std::size_t(surface.firstVert + i)];
            const bspDrawVert_t &q = c.bsp.drawVerts[std::size_t(surface.firstVert + k)];
            const Vec3f way = Normalize(Vec3f(q.xyz) - Vec3f(p.xyz));
            if (q.st[0] > p.st[0] && q.st[1] == p.st[1])
                axes.s = way;
            if (q.st[1] > p.st[1] && q.st[0] == p.st[0])
                axes.t = way;
        }
    return axes;
}

/// Expects the normals of a square of 5 x 5 luxels to be toward, in s, t and off the surface. The directive of its
/// shader names textures/test/bump.tga, which is of one color.
void ExpectBentNormals(const GameFolder &folder, std::string_view directive, const std::string &image,
                       const Vec3f &toward) {
    SceneBuilder scene = EmptyRoom();
    scene.AddQuad(Rectangle(0, 0, 64, 64, 0), Shaded(kA));
    CaseSettings settings;
    settings.script = fmt::format("{}\n{{\n{}\n}}\n", kA, directive);
    folder.Write("textures/test/bump.tga", image);
    SurfaceCase c(scene, folder, settings);
    const SurfaceLight surfaces = c.Mapped();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    const auto [s, t] = AxesOf(c, raw.surfaces[0]);
    ASSERT_NE(s, Vec3f{});
    ASSERT_NE(t, Vec3f{});
    int mapped = 0;
    for (std::size_t i = 0; i < raw.luxelClusters.size(); ++i)
        if (raw.Mapped(i)) {
            ++mapped;
            ExpectVector(raw.normals[i], s * toward.x + t * toward.y + Vec3f{0, 0, 1} * toward.z);
        }
    EXPECT_EQ(mapped, 25);
}

TEST_F(LuxelTest, NormalImagesBendNormals) {
    constexpr float kFull = 128 / 127.5f, kNone = -127 / 127.5f; // of bytes 255 and 0 beside byte 127
    const auto expect = [&](int red, int green, const Vec3f &toward) {
        ExpectBentNormals(folder, "q3map_normalImage textures/test/bump.tga", Tga(red, green, 255), Normalize(toward));
    };
    expect(127, 127, {0, 0, 1 + kFull});
    expect(255, 127, {kFull, 0, 1 + kFull});
    expect(127, 0, {0, kNone, 1 + kFull});
}

TEST_F(LuxelTest, BumpMapsBendNormals) {
    const auto expect = [&](int red, int green, int blue, const Vec3f &toward) {
        ExpectBentNormals(folder, "q3map_ssbumpImage textures/test/bump", Tga(red, green, blue), toward);
    };
    const float side = std::sqrt(0.5f), back = std::sqrt(1 / 6.0f), up = std::sqrt(1 / 3.0f);
    expect(147, 147, 147, {0, 0, 1});
    expect(0, 0, 0, {0, 0, 1});
    expect(200, 0, 0, {std::sqrt(2 / 3.0f), 0, up});
    expect(0, 30, 0, {-back, side, up});
    expect(0, 0, 255, {-back, -side, up});
    expect(0, 90, 90, Normalize(Vec3f{-back, 0, up}));
}

TEST_F(LuxelTest, NormalImagesWinOverBumpMaps) {
    SceneBuilder scene = EmptyRoom();
    scene.AddQuad(Rectangle(0, 0, 64, 64, 0), Shaded(kA));
    CaseSettings settings;
    settings.script = "textures/test/a\n{\nq3map_ssbumpImage textures/test/bump\n"
                      "q3map_normalImage textures/test/flat\n}\n";
    folder.Write("textures/test/bump.tga", Tga(255, 0, 0));
    folder.Write("textures/test/flat.tga", Tga(127, 127, 255));
    SurfaceCase c(scene, folder, settings);
    const SurfaceLight surfaces = c.Mapped();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    for (std::size_t i = 0; i < raw.luxelClusters.size(); ++i)
        if (raw.Mapped(i))
            ExpectVector(raw.normals[i], {0, 0, 1});
}

/// The inside of a tube around the z axis.
void AddTube(float radius, float height, SceneBuilder &scene) {
    constexpr std::array<std::array<float, 2>, 9> kRing{
        {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}}};
    std::vector<Vec3f> points;
    for (int row = 2; row >= 0; --row)
        for (const auto &p : kRing)
            points.push_back({p[0] * radius, p[1] * radius, 0.5f * height * float(row)});
    scene.AddPatch(9, 3, points, Shaded(kA));
}

SceneBuilder TubeRoom(float radius) {
    SceneBuilder scene = EmptyRoom();
    AddTube(radius, 320, scene);
    return scene;
}

TEST_F(LuxelTest, CurvesAreLiftedAlongTheirNormals) {
    for (const float offset : {1.0f, 20.0f}) {
        CaseSettings settings;
        settings.script = fmt::format("{}\n{{\nq3map_lightmapSampleOffset {}\n}}\n", kA, offset);
        SurfaceCase c(TubeRoom(200), folder, settings);
        const SurfaceLight surfaces = c.Mapped();
        const RawLightmap &raw = LightmapOf(c, surfaces, kA);
        float side = 0;
        for (int y = 0; y < raw.height; ++y)
            for (int x = 0; x < raw.width; ++x) {
                const std::size_t luxel = raw.SuperIndex(x, y);
                ASSERT_TRUE(raw.Mapped(luxel)) << x << ' ' << y;
                const Vec3f &p = raw.positions[luxel];
                const float radius = std::hypot(p.x, p.y);
                side = Dot(raw.normals[luxel], {p.x / radius, p.y / radius, 0}) > 0 ? 1.0f : -1.0f;
                // Parabolas bulge up to 12 units beyond the circle; chords cut up to 5 off.
                EXPECT_NEAR(radius, 203 + side * offset, 10) << x << ' ' << y;
                EXPECT_GT(std::abs(Dot(raw.normals[luxel], {p.x / radius, p.y / radius, 0})), 0.85f);
            }
    }
}

// The upper row lies in the plane of a solid. Half a luxel of 16 units is more than the rows are apart.
TEST_F(LuxelTest, CurvesWithDenseRowsAreLitFromBetweenThem) {
    constexpr float kHeight = 7;
    SceneBuilder scene = EmptyRoom({-300, -300, 0}, {300, 300, 128});
    scene.AddBox({-290, -290, kHeight}, {290, 290, 60}, Shaded(kB), BoxKind::Detail);
    AddTube(200, kHeight, scene);
    SurfaceCase c(scene, folder);
    const SurfaceLight surfaces = c.Mapped();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    ASSERT_EQ(raw.height, 3) << "a row of luxels for each row of points";
    for (int y = 0; y < raw.height; ++y)
        for (int x = 0; x < raw.width; ++x) {
            const std::size_t luxel = raw.SuperIndex(x, y);
            ASSERT_TRUE(raw.Mapped(luxel)) << x << ' ' << y;
            const Vec3f &p = raw.positions[luxel];
            EXPECT_GE(p.z, 0);
            EXPECT_LT(p.z, kHeight - 0.125f);
            EXPECT_NEAR(std::hypot(p.x, p.y), 203, 11) << x << ' ' << y;
        }
}

TEST_F(LuxelTest, ThreadsDoNotMatter) {
    SceneBuilder scene = TubeRoom(200);
    for (int i = 0; i < 20; ++i)
        scene.AddBox({float(i) * 40, 300, -100}, {float(i) * 40 + 33, 340, 77}, Shaded(kB), BoxKind::Detail);
    CaseSettings settings;
    SurfaceCase one(scene, folder, settings);
    settings.threads = 4;
    SurfaceCase four(scene, folder, settings);
    const SurfaceLight a = one.Mapped(), b = four.Mapped();
    ASSERT_EQ(a.lightmaps.size(), b.lightmaps.size());
    for (std::size_t i = 0; i < a.lightmaps.size(); ++i) {
        EXPECT_EQ(a.lightmaps[i].surfaces, b.lightmaps[i].surfaces);
        EXPECT_EQ(a.lightmaps[i].luxelClusters, b.lightmaps[i].luxelClusters);
        EXPECT_TRUE(a.lightmaps[i].positions == b.lightmaps[i].positions);
        EXPECT_TRUE(a.lightmaps[i].normals == b.lightmaps[i].normals);
    }
}

TEST_F(LuxelTest, VerticesOfAnotherLightmapMapNothing) {
    SceneBuilder scene = EmptyRoom();
    scene.AddQuad(Rectangle(0, 0, 1000, 1000, 0), Shaded(kA));
    scene.AddQuad(Rectangle(0, 0, 1000, 1000, 64), Shaded(kB));
    Bsp bsp = scene.Build();
    // Both surfaces of a damaged map have the vertices of the first, in lightmaps of unlike scale.
    const std::size_t second = bsp.drawSurfaces.size() - 1;
    bsp.drawSurfaces[second].firstVert = bsp.drawSurfaces[second - 1].firstVert;
    CaseSettings settings;
    settings.script = "textures/test/b\n{\nq3map_lightmapSampleSize 500\n}\n";
    SurfaceCase c(bsp, folder, settings);
    const SurfaceLight surfaces = c.Mapped();
    const auto mapped = [&](std::string_view shader) {
        const std::vector<int> &luxelClusters = LightmapOf(c, surfaces, shader).luxelClusters;
        return std::count_if(luxelClusters.begin(), luxelClusters.end(), [](int code) { return code >= 0; });
    };
    EXPECT_EQ(mapped(kA), 64 * 64);
    EXPECT_EQ(mapped(kB), 0);
}

TEST_F(LuxelTest, TriangleCheckPullsPlacesInside) {
    const std::array<Vec3f, 3> corners{{{0, 0, 0}, {0, 300, 0}, {300, 0, 0}}};
    CaseSettings settings;
    settings.lightmap.triangleCheck = true;
    SurfaceCase c(WithTriangle(EmptyRoom(), corners), folder, settings);
    const SurfaceLight surfaces = c.Mapped();
    const RawLightmap &raw = LightmapOf(c, surfaces, kA);
    const Vec3f &corner = raw.positions[raw.SuperIndex(0, 0)], &edge = raw.positions[raw.SuperIndex(0, 5)];
    ExpectVector(corner, {1, 1, 1});
    ExpectVector(edge, {1, 80, 1});
    ExpectVector(raw.positions[raw.SuperIndex(4, 4)], {64, 64, 1});
}

} // namespace

} // namespace q3::test
