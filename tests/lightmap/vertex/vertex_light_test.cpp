// GPL-2.0-or-later. Light at vertices.
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/sources/light_surfaces.h"
#include "q3map2/lightmap/vertex/vertex_light.h"
#include "tests/support/surface_case.h"

#include <algorithm>
#include <cmath>

namespace q3::test {

namespace {

constexpr std::string_view kVertexLitFloor = "textures/test/floor", kLit = "textures/test/lightmapped";
constexpr std::string_view kVertexLit = "textures/test/floor\n{\nsurfaceparm pointlight\n}\n";

Entity PointLightEntity(const Vec3f &at, int intensity, std::string_view style = "0") {
    Entity entity;
    entity.Set("classname", "light");
    entity.Set("origin", fmt::format("{} {} {}", at.x, at.y, at.z));
    entity.Set("light", fmt::format("{}", intensity));
    entity.Set("_style", style);
    return entity;
}

/// What a point light gives to a place by its formula. Byte scale.
double FromPoint(const Vec3f &at, const Vec3f &normal, const Vec3f &light, double intensity) {
    const Vec3d way = Vec3d(light) - Vec3d(at);
    const double d = Length(way);
    return std::max(0.0, 7500 * intensity / (d * d) * Dot(way, Vec3d(normal)) / d);
}

class VertexTest : public testing::Test {
  protected:
    /// A floor that is lit at its vertices, and one with a lightmap beside it.
    SceneBuilder Floors() const {
        SceneBuilder scene = EmptyRoom({-300, -300, -100}, {300, 300, 400});
        scene.AddQuad(Rectangle(-120, -100, 110, 90, 0), Shaded(kVertexLitFloor));
        scene.AddQuad(Rectangle(-120, 110, 110, 190, 0), Shaded(kLit));
        return scene;
    }
    CaseSettings Settings(std::string_view more = "") const {
        CaseSettings settings;
        settings.script = std::string(kVertexLit) + std::string(more);
        return settings;
    }
    std::vector<Light> LightsOf(SurfaceCase &c) const {
        std::vector<Light> lights = EntityLights(c.entities, c.settings.light, c.quiet.log);
        SurfaceLightCounts counts;
        const auto ofSurfaces =
            SurfaceLights(c.space, c.table, c.settings.light, c.world, c.library, counts, c.quiet.log);
        lights.insert(lights.end(), ofSurfaces.begin(), ofSurfaces.end());
        int culled = 0;
        return SetupEnvelopes(lights, LightPass::Surfaces, c.settings.light, c.space, SkySeenFrom(c.space, c.table),
                              culled);
    }
    void AddPass(SurfaceCase &c, SurfaceLight &surfaces, const SurfacePass &pass = {}) const {
        ContributionCounts counts;
        LightVertices(c.Inputs(), LightsOf(c), pass, surfaces, counts);
    }
    SurfaceLight Lit(SurfaceCase &c) const {
        SurfaceLight surfaces = c.Mapped();
        AddPass(c, surfaces);
        return surfaces;
    }
    /// Draw vertices of the only surface of that shader.
    static std::vector<std::size_t> VerticesOf(const SurfaceCase &c, std::string_view shader) {
        const std::vector<int> numbers = SurfacesOf(c, shader);
        if (numbers.size() != 1)
            throw Error("{} surfaces of {}", numbers.size(), shader);
        const bspDrawSurface_t &surface = c.bsp.drawSurfaces[std::size_t(numbers[0])];
        std::vector<std::size_t> vertices;
        for (int v = 0; v < surface.numVerts; ++v)
            vertices.push_back(std::size_t(surface.firstVert + v));
        return vertices;
    }
    static const Styles &StylesOf(const SurfaceCase &c, const SurfaceLight &surfaces, std::string_view shader) {
        return surfaces.vertex.styles[std::size_t(SurfacesOf(c, shader).at(0))];
    }

    GameFolder folder;
};

TEST_F(VertexTest, PointLightByItsFormula) {
    const Vec3f lamp{30, -20, 150};
    SceneBuilder scene = Floors();
    scene.AddEntity(PointLightEntity(lamp, 100));
    SurfaceCase c(scene, folder, Settings());
    const SurfaceLight surfaces = Lit(c);
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
        const double expected = FromPoint(surfaces.verts[v].xyz, surfaces.verts[v].normal, lamp, 100);
        EXPECT_NEAR(surfaces.vertex.sum[0][v].x, expected, 0.005 * expected);
        EXPECT_EQ(surfaces.vertex.radiosity[0][v], surfaces.vertex.sum[0][v]);
    }
    EXPECT_EQ(StylesOf(c, surfaces, kVertexLitFloor), (Styles{0, kNoStyle, kNoStyle, kNoStyle}));
}

TEST_F(VertexTest, VerticesThatTouchWallsAreLit) {
    SceneBuilder scene = EmptyRoom({-256, -192, 0}, {256, 192, 256});
    scene.AddQuad(Rectangle(-256, -192, 256, 192, 0), Shaded(kVertexLitFloor));
    const Vec3f lamp{40, -24, 150};
    scene.AddEntity(PointLightEntity(lamp, 100));
    SurfaceCase c(scene, folder, Settings());
    const SurfaceLight surfaces = Lit(c);
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
        const double expected = FromPoint(surfaces.verts[v].xyz, {0, 0, 1}, lamp, 100);
        EXPECT_NEAR(surfaces.vertex.sum[0][v].y, expected, 0.005 * expected) << v;
    }
}

TEST_F(VertexTest, ShadowsAndAmbient) {
    SceneBuilder scene = Floors();
    scene.AddBox({-200, -200, 60}, {200, 200, 80}, Shaded("textures/test/roof"));
    scene.AddEntity(PointLightEntity({0, 0, 150}, 300));
    scene.SetWorldKey("_ambient", "7");
    SurfaceCase c(scene, folder, Settings());
    SurfaceLight surfaces = Lit(c);
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor))
        EXPECT_EQ(surfaces.vertex.sum[0][v], (Vec3f{7, 7, 7}));
    AddPass(c, surfaces, {.bounce = true});
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
        EXPECT_EQ(surfaces.vertex.sum[0][v], (Vec3f{7, 7, 7}));
        EXPECT_EQ(surfaces.vertex.radiosity[0][v], Vec3f{});
    }
}

TEST_F(VertexTest, VerticesInTheShadowOfASmallPlateAreDark) {
    // A plate covers each vertex, but not what is 8 units from it.
    SceneBuilder scene = EmptyRoom({-300, -300, -100}, {300, 300, 400});
    scene.AddQuad(Rectangle(-96, -96, 96, 96, 0), Shaded(kVertexLitFloor));
    for (const float x : {-96.0f, 96.0f})
        for (const float y : {-96.0f, 96.0f})
            scene.AddBox({x - 5, y - 5, 10}, {x + 5, y + 5, 12}, Shaded("textures/test/plate"), BoxKind::Detail);
    scene.AddEntity(PointLightEntity({0, 0, 380}, 300));
    SurfaceCase c(scene, folder, Settings());
    const SurfaceLight surfaces = Lit(c);
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor))
        EXPECT_EQ(surfaces.vertex.sum[0][v], Vec3f{}) << v;
}

TEST_F(VertexTest, VerticesInAThinWallAreLitFromTheSideOfTheirSurface) {
    for (const BoxKind kind : {BoxKind::Structural, BoxKind::Detail})
        for (const float side : {-1.0f, 1.0f}) {
            SceneBuilder scene = EmptyRoom({-300, -300, -100}, {300, 300, 400});
            scene.AddBox({0, -300, -100}, {8, 300, 400}, Shaded("textures/test/wall"), kind);
            scene.AddQuad(Rectangle(2, -60, 120, 60, 0), Shaded(kVertexLitFloor));
            const Vec3f lamp{4 + side * 100, 0, 150};
            scene.AddEntity(PointLightEntity(lamp, 300));
            SurfaceCase c(scene, folder, Settings());
            const SurfaceLight surfaces = Lit(c);
            for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
                const double expected = side < 0 ? 0 : FromPoint(surfaces.verts[v].xyz, {0, 0, 1}, lamp, 300);
                EXPECT_NEAR(surfaces.vertex.sum[0][v].x, expected, 0.1 * expected) << v << ' ' << side;
            }
        }
}

TEST_F(VertexTest, VerticesOfACeilingAreLitFromBelowIt) {
    SceneBuilder scene = EmptyRoom({-256, -192, 0}, {256, 192, 256});
    scene.AddQuad({{{-256, -192, 256}, {256, -192, 256}, {256, 192, 256}, {-256, 192, 256}}}, Shaded(kVertexLitFloor));
    const Vec3f lamp{40, -24, 50};
    scene.AddEntity(PointLightEntity(lamp, 100));
    SurfaceCase c(scene, folder, Settings());
    const SurfaceLight surfaces = Lit(c);
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
        const double expected = FromPoint(surfaces.verts[v].xyz, {0, 0, -1}, lamp, 100);
        EXPECT_NEAR(surfaces.vertex.sum[0][v].x, expected, 0.005 * expected) << v;
    }
}

TEST_F(VertexTest, VerticesInSolidGetTheMeanOfThoseTheyShareEdgesWith) {
    SceneBuilder scene = EmptyRoom({-300, -300, -100}, {300, 300, 400});
    scene.AddQuad(Rectangle(-120, -100, 110, 90, 0), Shaded(kVertexLitFloor));
    scene.AddBox({80, 60, -60}, {140, 120, 60}, Shaded("textures/test/block"));
    scene.AddEntity(PointLightEntity({-60, -60, 150}, 300));
    SurfaceCase c(scene, folder, Settings());
    const SurfaceLight surfaces = Lit(c);
    Vec3f sum;
    std::vector<Vec3f> inside;
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor))
        if (surfaces.verts[v].xyz == Vec3f{110, 90, 0})
            inside.push_back(surfaces.vertex.sum[0][v]);
        else if (surfaces.verts[v].xyz != Vec3f{-120, -100, 0}) // that one is across the diagonal
            sum += surfaces.vertex.sum[0][v];
    ASSERT_EQ(inside.size(), 1u);
    EXPECT_GT(inside[0].x, 1);
    EXPECT_NEAR(inside[0].x, sum.x / 2, 1e-3f);
}

TEST_F(VertexTest, StylesTakeSlots) {
    SceneBuilder scene = Floors();
    scene.AddEntity(PointLightEntity({0, 0, 150}, 100));
    scene.AddEntity(PointLightEntity({0, 0, 100}, 50, "5"));
    SurfaceCase c(scene, folder, Settings());
    const SurfaceLight surfaces = Lit(c);
    EXPECT_EQ(StylesOf(c, surfaces, kVertexLitFloor), (Styles{0, 5, kNoStyle, kNoStyle}));
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
        const double expected = FromPoint(surfaces.verts[v].xyz, {0, 0, 1}, {0, 0, 100}, 50);
        EXPECT_NEAR(surfaces.vertex.sum[1][v].x, expected, 0.005 * expected);
    }
}

TEST_F(VertexTest, StylesThatFindNoSlotAreNamedOnlyIfTheyArrive) {
    for (const bool arrives : {false, true}) {
        SceneBuilder scene = Floors();
        for (const std::string_view style : {"3", "5", "7", "9"}) // of equal lights the last goes
            scene.AddEntity(PointLightEntity({0, 0, style == "9" && !arrives ? -50.0f : 100.0f}, 50, style));
        SurfaceCase c(scene, folder, Settings());
        Lit(c);
        EXPECT_EQ(c.quiet.text.find(" (surfaces lit at vertices: ") != std::string::npos, arrives) << c.quiet.text;
    }
}

TEST_F(VertexTest, NegativeLightSubtracts) {
    SceneBuilder scene = Floors();
    scene.AddEntity(PointLightEntity({0, 0, 150}, 200));
    scene.AddEntity(PointLightEntity({0, 0, 150}, -150));
    SurfaceCase c(scene, folder, Settings());
    const SurfaceLight surfaces = Lit(c);
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
        const double expected = FromPoint(surfaces.verts[v].xyz, {0, 0, 1}, {0, 0, 150}, 50);
        EXPECT_NEAR(surfaces.vertex.sum[0][v].x, expected, 0.02 * expected);
    }
}

TEST_F(VertexTest, CheapStopsAtWhite) {
    SceneBuilder scene = Floors();
    for (int i = 0; i < 5; ++i)
        scene.AddEntity(PointLightEntity({0, 0, 60}, 2000));
    CaseSettings settings = Settings();
    SurfaceCase whole(scene, folder, settings);
    settings.lightmap.cheap = true;
    SurfaceCase cheap(scene, folder, settings);
    const SurfaceLight a = Lit(whole), b = Lit(cheap);
    for (const std::size_t v : VerticesOf(whole, kVertexLitFloor)) {
        const float one = a.vertex.sum[0][v].x / 5, needed = std::ceil(255 / one);
        ASSERT_LT(needed, 5);
        EXPECT_NEAR(b.vertex.sum[0][v].x, one * needed, 0.01f * one);
    }
}

TEST_F(VertexTest, ForcedSunlightNeedsNoSky) {
    for (const bool forced : {false, true}) {
        SceneBuilder scene = Floors();
        scene.SetWallShader(BoxFace::PlusZ, Shaded("textures/test/sky"));
        scene.AddBox({-200, -200, 60}, {200, 200, 80}, Shaded("textures/test/roof"));
        SurfaceCase c(scene, folder,
                      Settings(fmt::format("textures/test/sky\n{{\nsurfaceparm sky\nq3map_sun 1 1 1 80 0 90\n}}\n"
                                           "textures/test/second\n{{\nsurfaceparm pointlight\n{}\n}}\n",
                                           forced ? "q3map_forceSunlight" : "")));
        for (SurfaceEntry &entry : c.table)
            if (entry.shader->name == kVertexLitFloor)
                entry.shader = &c.library.Get("textures/test/second");
        SurfaceLight surfaces = c.Mapped();
        AddPass(c, surfaces);
        const std::vector<int> floors = SurfacesOf(c, "textures/test/second");
        ASSERT_EQ(floors.size(), 1u);
        const int first = c.bsp.drawSurfaces[std::size_t(floors[0])].firstVert;
        EXPECT_NEAR(surfaces.vertex.sum[0][std::size_t(first)].x, forced ? 80 : 0, 1e-2);
    }
}

TEST_F(VertexTest, DirtAndFloodlight) {
    SceneBuilder scene = EmptyRoom();
    scene.AddQuad(Rectangle(-100, -100, 100, 100, 0), Shaded(kVertexLitFloor));
    scene.SetWorldKey("_ambient", "50");
    scene.SetWorldKey("_floodlight", "1 1 1 150 60");
    for (const bool dirty : {false, true}) {
        CaseSettings settings = Settings();
        settings.lightmap.dirty = dirty;
        SceneBuilder walled = scene;
        walled.AddBox({-200, -400, -400}, {-100, 400, 400}, Shaded("textures/test/wall2"));
        SurfaceCase c(walled, folder, settings);
        SurfaceLight surfaces = Lit(c);
        for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
            // 7 of 16 azimuths go towards the wall, which is close; two go along it.
            const bool atWall = surfaces.verts[v].xyz.x < 0;
            const double dirt = dirty && atWall ? 1 - 3 * 7 / 49.0 : 1;
            const double open = atWall ? 1 - 7 / 16.0 : 1;
            EXPECT_NEAR(surfaces.vertex.sum[0][v].x, 50 * dirt + 60 * open, 0.5) << dirty << atWall;
        }
        AddPass(c, surfaces, {.bounce = true});
        for (const std::size_t v : VerticesOf(c, kVertexLitFloor))
            EXPECT_EQ(surfaces.vertex.radiosity[0][v], Vec3f{});
    }
}

TEST_F(VertexTest, ConstantsAreStoredOnce) {
    SceneBuilder scene = Floors();
    scene.AddEntity(PointLightEntity({0, 0, 150}, 100));
    CaseSettings constant = Settings(), none = Settings();
    constant.lightmap.noVertex = 0.5f;
    none.script = "textures/test/floor\n{\nsurfaceparm pointlight\nq3map_noVertexLight\n}\n";
    for (const auto &[settings, expected] : {std::pair(constant, 63.75f), std::pair(none, 127.5f)}) {
        SurfaceCase c(scene, folder, settings);
        SurfaceLight surfaces = Lit(c);
        for (int pass = 0; pass < 2; ++pass) {
            for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
                EXPECT_EQ(surfaces.vertex.sum[0][v].x, expected);
                EXPECT_EQ(surfaces.vertex.radiosity[0][v].x, pass == 0 ? expected : 0);
            }
            AddPass(c, surfaces, {.bounce = true});
        }
    }
}

TEST_F(VertexTest, BounceOnlyKeepsDirectLightForTheBounces) {
    SceneBuilder scene = Floors();
    scene.AddEntity(PointLightEntity({0, 0, 150}, 100));
    CaseSettings settings = Settings();
    settings.lightmap.bounceOnly = true;
    settings.lightmap.bounces = 1;
    SurfaceCase c(scene, folder, settings);
    const SurfaceLight surfaces = Lit(c);
    for (const std::size_t v : VerticesOf(c, kVertexLitFloor)) {
        EXPECT_EQ(surfaces.vertex.sum[0][v], Vec3f{});
        EXPECT_GT(surfaces.vertex.radiosity[0][v].x, 1);
    }
}

TEST_F(VertexTest, LightmappedSurfacesReadTheNearestLuxels) {
    SurfaceCase c(Floors(), folder, Settings());
    SurfaceLight surfaces = c.Mapped();
    RawLightmap &raw = surfaces.lightmaps[std::size_t(surfaces.lightmapOf[std::size_t(SurfacesOf(c, kLit)[0])])];
    const std::vector<std::size_t> vertices = VerticesOf(c, kLit);
    const auto at = [&](std::size_t v) {
        return raw.SuperIndex(std::min(raw.SuperWidth() - 1, int(surfaces.verts[v].luxel[0])),
                              std::min(raw.SuperHeight() - 1, int(surfaces.verts[v].luxel[1])));
    };
    raw.styles = {0, 9, kNoStyle, kNoStyle};
    for (std::size_t slot = 0; slot < 2; ++slot) {
        raw.light[slot].resize(raw.luxelClusters.size());
        for (std::size_t i = 0; i < raw.luxelClusters.size(); ++i)
            raw.light[slot][i] = Vec3f{float(i), float(slot), 1};
    }
    std::fill(raw.luxelClusters.begin(), raw.luxelClusters.end(), 0);
    AddPass(c, surfaces);
    EXPECT_EQ(StylesOf(c, surfaces, kLit), raw.styles);
    for (const std::size_t v : vertices)
        for (std::size_t slot = 0; slot < 2; ++slot)
            EXPECT_EQ(surfaces.vertex.radiosity[slot][v], raw.light[slot][at(v)]);

    // The luxel below is not mapped: the mean of its neighbors; then nothing is.
    const std::size_t v = vertices[0];
    raw.luxelClusters[at(v)] = kOccluded;
    const int x = int(at(v)) % raw.SuperWidth(), y = int(at(v)) / raw.SuperWidth();
    Vec3f sum;
    float count = 0;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            if ((dx != 0 || dy != 0) && x + dx >= 0 && y + dy >= 0 && x + dx < raw.SuperWidth() &&
                y + dy < raw.SuperHeight())
                sum += raw.light[0][raw.SuperIndex(x + dx, y + dy)], count += 1;
    AddPass(c, surfaces, {.bounce = true});
    EXPECT_EQ(surfaces.vertex.radiosity[0][v], sum / count);
    std::fill(raw.luxelClusters.begin(), raw.luxelClusters.end(), int(kUnmapped));
    AddPass(c, surfaces, {.bounce = true});
    EXPECT_EQ(surfaces.vertex.radiosity[0][v], Vec3f{});
}

TEST_F(VertexTest, CpmaLightsLightmappedSurfacesWithoutShadows) {
    SceneBuilder scene = Floors();
    scene.AddBox({-200, 80, 60}, {200, 250, 80}, Shaded("textures/test/roof"));
    const Vec3f lamp{0, 150, 150};
    scene.AddEntity(PointLightEntity(lamp, 100));
    CaseSettings settings = Settings();
    settings.lightmap.cpma = true;
    SurfaceCase c(scene, folder, settings);
    const SurfaceLight surfaces = Lit(c);
    for (const std::size_t v : VerticesOf(c, kLit)) {
        const double expected = FromPoint(surfaces.verts[v].xyz, {0, 0, 1}, lamp, 100);
        EXPECT_NEAR(surfaces.vertex.sum[0][v].x, expected, 0.005 * expected);
    }
}

TEST_F(VertexTest, ShownInsteadOfLight) {
    SceneBuilder scene = Floors();
    CaseSettings settings = Settings();
    settings.lightmap.show = DebugView::NormalMap;
    SurfaceCase normals(scene, folder, settings);
    settings.lightmap.show = DebugView::Origin;
    SurfaceCase origins(scene, folder, settings);
    const SurfaceLight a = Lit(normals), b = Lit(origins);
    for (const std::size_t v : VerticesOf(normals, kVertexLitFloor)) {
        EXPECT_EQ(a.vertex.sum[0][v], (Vec3f{127.5f, 127.5f, 255}));
        EXPECT_EQ(b.vertex.sum[0][v], (Vec3f{b.verts[v].xyz.x > 0 ? 255.0f : 0, b.verts[v].xyz.y > 0 ? 255.0f : 0, 0}));
    }
}

TEST_F(VertexTest, ThreadsMakeNoDifference) {
    SceneBuilder scene = Floors();
    for (int i = 0; i < 7; ++i)
        scene.AddEntity(
            PointLightEntity({float(30 * i - 90), float(20 * i), 150}, 20 + 10 * i, i % 2 == 0 ? "0" : "3"));
    CaseSettings settings = Settings();
    settings.lightmap.dirty = true;
    SurfaceCase one(scene, folder, settings);
    settings.threads = 4;
    SurfaceCase four(scene, folder, settings);
    const SurfaceLight a = Lit(one), b = Lit(four);
    EXPECT_EQ(a.vertex.sum, b.vertex.sum);
    EXPECT_EQ(a.vertex.radiosity, b.vertex.radiosity);
    EXPECT_EQ(a.vertex.styles, b.vertex.styles);
}

} // namespace

} // namespace q3::test
