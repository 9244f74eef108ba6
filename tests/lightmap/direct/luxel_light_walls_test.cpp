// GPL-2.0-or-later. Light beside thin walls: none comes through, and the lit side stays lit up to the wall.
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/lightmap/direct/lightmap_average.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "q3map2/lightmap/raw/luxel_raster.h"
#include "tests/support/surface_case.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace q3::test {

namespace {

constexpr Vec3f kLamp{-100, 0, 128};
constexpr float kIntensity = 300;

/// 7500 I cos / d^2.
double FromLamp(const Vec3f &at, const Vec3f &normal) {
    const Vec3d way = Vec3d(kLamp) - Vec3d(at);
    const double d = Length(way);
    return 7500 * double(kIntensity) / (d * d) * Dot(way, Vec3d(normal)) / d;
}

/// A room of 512 x 512 x 256 with a lamp on its left.
class WallTest : public testing::Test {
  protected:
    WallTest() { scene.SetInterior({-256, -256, 0}, {256, 256, 256}, Shaded("textures/test/wall")); }

    void Light(CaseSettings settings = {}) {
        LightCase(std::make_unique<SurfaceCase>(scene, folder, std::move(settings)));
    }
    void LightCase(std::unique_ptr<SurfaceCase> of) {
        lit = std::move(of);
        surfaces = lit->Mapped();
        q3::Light lamp;
        lamp.origin = kLamp, lamp.photons = kIntensity * 7500;
        int culled = 0;
        const auto lights = SetupEnvelopes({lamp}, LightPass::Surfaces, lit->settings.light, lit->space,
                                           SkySeenFrom(lit->space, lit->table), culled);
        ContributionCounts counts;
        LightLuxels(lit->Inputs(), lights, {}, surfaces, counts);
        FinishLuxels(lit->Inputs(), {}, surfaces);
    }

    /// What the texture filter shows of the surface with that normal at a place on it.
    float Shown(const Vec3f &at, const Vec3f &normal) const {
        std::optional<float> shown;
        for (std::size_t s = 0; s < surfaces.lightmapOf.size(); ++s) {
            const bspDrawSurface_t &surface = lit->bsp.drawSurfaces[s];
            Boundsf box = surfaces.bounds[s];
            box.mins -= Vec3f{0.1f, 0.1f, 0.1f}, box.maxs += Vec3f{0.1f, 0.1f, 0.1f};
            if (surfaces.lightmapOf[s] < 0 || !box.Contains(at) ||
                surfaces.verts[std::size_t(surface.firstVert)].normal != normal || !Covers(surface, at, normal))
                continue;
            shown = Filtered(surfaces.lightmaps[std::size_t(surfaces.lightmapOf[s])], at);
        }
        EXPECT_TRUE(shown) << at.x << ' ' << at.y << ' ' << at.z;
        return shown.value_or(-1);
    }
    bool Covers(const bspDrawSurface_t &surface, const Vec3f &at, const Vec3f &normal) const {
        for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
            bool inside = true;
            for (int k = 0; k < 3; ++k) {
                const auto corner = [&](int c) {
                    return surfaces
                        .verts[std::size_t(surface.firstVert +
                                           lit->bsp.drawIndexes[std::size_t(surface.firstIndex + i + c % 3)])]
                        .xyz;
                };
                inside = inside && Dot(Cross(normal, corner(k + 1) - corner(k)), at - corner(k)) <= 1;
            }
            if (inside)
                return true;
        }
        return false;
    }
    static float Filtered(const RawLightmap &raw, const Vec3f &at) {
        const LuxelAxes axes = AxesOf(raw.axis);
        const float u = (at[axes.u] - raw.origin[axes.u]) / raw.step[0][axes.u];
        const float v = (at[axes.v] - raw.origin[axes.v]) / raw.step[1][axes.v];
        const int x = std::clamp(int(std::floor(u)), 0, raw.SuperWidth() - 2);
        const int y = std::clamp(int(std::floor(v)), 0, raw.SuperHeight() - 2);
        const auto light = [&](int i, int j) { return raw.light[0][raw.SuperIndex(x + i, y + j)].x; };
        return std::lerp(std::lerp(light(0, 0), light(1, 0), u - float(x)),
                         std::lerp(light(0, 1), light(1, 1), u - float(x)), v - float(y));
    }
    void ExpectLight(const Vec3f &at, const Vec3f &normal) const {
        const double expected = FromLamp(at, normal);
        EXPECT_NEAR(Shown(at, normal), expected, 0.15 * expected) << at.x << ' ' << at.y << ' ' << at.z;
    }

    SceneBuilder scene;
    GameFolder folder;
    std::unique_ptr<SurfaceCase> lit;
    SurfaceLight surfaces;
};

struct Wall {
    float from, thickness;
    BoxKind kind = BoxKind::Structural;
    int sampleSize = 16;
    int super = 1, samples = 1;
};

class ThinWallTest : public WallTest, public testing::WithParamInterface<Wall> {};

TEST_P(ThinWallTest, PartsLightFromDark) {
    const Wall wall = GetParam();
    const float to = wall.from + wall.thickness;
    scene.AddBox({wall.from, -256, 0}, {to, 256, 256}, Shaded("textures/test/wall"), wall.kind);
    CaseSettings settings;
    settings.lightmap.sampleSize = wall.sampleSize;
    settings.lightmap.super = wall.super, settings.lightmap.samples = wall.samples;
    Light(settings);
    for (const float y : {-50.0f, 3.0f})
        for (const float off : {0.5f, 4.0f, 12.0f}) {
            EXPECT_LT(Shown({to + off, y, 0}, {0, 0, 1}), 0.5f) << off;
            EXPECT_LT(Shown({to + off, y, 256}, {0, 0, -1}), 0.5f) << off;
            ExpectLight({wall.from - off, y, 0}, {0, 0, 1});
            ExpectLight({wall.from - off, y, 256}, {0, 0, -1});
        }
}

INSTANTIATE_TEST_SUITE_P(Walls, ThinWallTest,
                         testing::Values(Wall{0, 8}, Wall{0, 4}, Wall{6, 4}, Wall{5, 12}, Wall{-9, 8, BoxKind::Detail},
                                         Wall{3, 8, BoxKind::Detail}, Wall{2, 4, BoxKind::Structural, 8},
                                         Wall{3, 8, BoxKind::Structural, 16, 2},
                                         Wall{0, 4, BoxKind::Structural, 16, 1, 3}));

TEST_F(WallTest, ADiagonalWallPartsLightFromDark) {
    // 8 units thick, at 45 degrees; as a group, which is structural too.
    std::string text = scene.MapText() + "{\n\"classname\" \"func_group\"\n{\n";
    const auto side = [&](std::string_view points) { text += fmt::format("{} test/wall 0 0 0 1 1 0 0 0\n", points); };
    const float a = 17, b = a + 8 * std::sqrt(2.0f);
    side(fmt::format("( {0} 0 0 ) ( {0} 0 64 ) ( 0 {0} 0 )", b));
    side(fmt::format("( {0} 0 0 ) ( 0 {0} 0 ) ( {0} 0 64 )", a));
    side("( 256 0 0 ) ( 256 0 64 ) ( 256 64 0 )");
    side("( 0 256 0 ) ( 64 256 0 ) ( 0 256 64 )");
    side("( 0 0 256 ) ( 0 64 256 ) ( 64 0 256 )");
    side("( 0 0 0 ) ( 64 0 0 ) ( 0 64 0 )");
    text += "}\n}\n{\n\"classname\" \"info_null\"\n\"origin\" \"200 200 32\"\n}\n";
    folder.Write("scripts/shaderlist.txt", "test\n");
    folder.Write("scripts/test.shader", "");
    KeptLog quiet;
    VirtualFileSystem files(quiet.log);
    files.Mount(folder.Root(), "pk3");
    LightCase(std::make_unique<SurfaceCase>(CompiledText(text, files), folder));
    const float s = std::sqrt(0.5f);
    for (const float along : {-30.0f, 3.0f, 40.0f})
        for (const float off : {0.5f, 4.0f, 12.0f}) {
            const auto at = [&](float across, float z) { return Vec3f{s * (across - along), s * (across + along), z}; };
            EXPECT_LT(Shown(at(s * b + off, 0), {0, 0, 1}), 0.5f) << along << ' ' << off;
            EXPECT_LT(Shown(at(s * b + off, 256), {0, 0, -1}), 0.5f) << along << ' ' << off;
            ExpectLight(at(s * a - off, 0), {0, 0, 1});
            ExpectLight(at(s * a - off, 256), {0, 0, -1});
        }
}

TEST_F(WallTest, ALuxelInAWallWithADoorShowsNoLightOnTheDarkSide) {
    scene.AddBox({0, -256, 0}, {8, 80, 256}, Shaded("textures/test/wall"), BoxKind::Detail);
    Light();
    for (const float y : {-100.0f, -50.0f, 3.0f})
        for (const float off : {0.5f, 4.0f, 12.0f}) {
            EXPECT_LT(Shown({8 + off, y, 0}, {0, 0, 1}), 0.5f) << off;
            EXPECT_LT(Shown({8 + off, y, 256}, {0, 0, -1}), 0.5f) << off;
        }
    ExpectLight({-20, 3, 0}, {0, 0, 1});
    ExpectLight({4, 100, 0}, {0, 0, 1});
}

TEST_F(WallTest, APillarLeavesTheLightAroundIt) {
    scene.AddBox({-4, -4, 0}, {4, 4, 256}, Shaded("textures/test/wall"), BoxKind::Detail);
    Light();
    ExpectLight({-8, 0, 0}, {0, 0, 1});
    ExpectLight({-5, 2, 0}, {0, 0, 1});
}

TEST_F(WallTest, AStripBetweenAThinFloorAndALedgeIsLit) {
    // Centers of luxels are on the lower face of the floor and in the ledge.
    scene.AddBox({-256, -256, 0}, {256, 256, 0.5f}, Shaded("textures/test/wall"), BoxKind::Detail);
    scene.AddBox({254.5f, -256, 9}, {256, 256, 256}, Shaded("textures/test/wall"));
    Light();
    for (const float y : {-203.0f, -100.0f, 3.0f, 100.0f, 203.0f})
        for (const float z : {1.0f, 4.0f, 8.0f})
            ExpectLight({256, y, z}, {-1, 0, 0});
}

} // namespace

} // namespace q3::test
