// GPL-2.0-or-later. Luxels and vertices under the curves and cones of light entities and under light_environment.
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "q3map2/lightmap/vertex/vertex_light.h"
#include "tests/support/light_fixture.h"
#include "tests/support/surface_case.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace q3::test {

namespace {

constexpr std::string_view kLitFloor = "textures/test/floor", kVertexFloor = "textures/test/vertices";
constexpr std::string_view kShaders = "textures/test/vertices\n{\nsurfaceparm pointlight\n}\n"
                                      "textures/test/sky\n{\nsurfaceparm sky\n}\n";
constexpr double kRadian = std::numbers::pi / 180;

/// Light of the entities of a map at luxels and vertices.
struct Baked {
    Baked(const SceneBuilder &scene, const GameFolder &folder, bool fastPoint)
        : map(scene, folder, {.script = std::string(kShaders)}), surfaces(map.Mapped()) {
        int culled = 0;
        lights = SetupEnvelopes(EntityLights(map.entities, map.settings.light, map.quiet.log), LightPass::Surfaces,
                                map.settings.light, map.space, SkySeenFrom(map.space, map.table), culled, fastPoint);
        ContributionCounts counts;
        LightLuxels(map.Inputs(), lights, {}, surfaces, counts);
        LightVertices(map.Inputs(), lights, {}, surfaces, counts);
    }
    const RawLightmap &Of(std::string_view shader) const { return LightmapOf(map, surfaces, shader); }

    SurfaceCase map;
    SurfaceLight surfaces;
    std::vector<Light> lights;
};

struct Place {
    Vec3d position, normal, light;
};

class SourceLightsTest : public testing::Test {
  protected:
    Baked Bake(const std::vector<Entity> &lights, bool fastPoint = false) { return Bake(Floors(), lights, fastPoint); }
    Baked Bake(SceneBuilder scene, const std::vector<Entity> &lights, bool fastPoint = false) {
        for (const Entity &light : lights)
            scene.AddEntity(light);
        return {scene, folder_, fastPoint};
    }
    /// A floor with a lightmap and one lit at its vertices.
    static SceneBuilder Floors() {
        SceneBuilder scene = EmptyRoom();
        scene.AddQuad(Rectangle(-128, -128, 128, 128, 0), Shaded(kLitFloor));
        scene.AddQuad(Rectangle(-200, 140, 180, 400, 0), Shaded(kVertexFloor));
        return scene;
    }
    /// Luxels of the one floor and vertices of the other.
    static std::vector<Place> Places(const Baked &baked) {
        std::vector<Place> places;
        const RawLightmap &floor = baked.Of(kLitFloor);
        for (std::size_t i = 0; i < floor.luxelClusters.size(); ++i)
            if (floor.Mapped(i))
                places.push_back({Vec3d(floor.positions[i]), Vec3d(floor.normals[i]), Vec3d(floor.light[0][i])});
        EXPECT_GE(places.size(), 200u);
        const int surface = SurfacesOf(baked.map, kVertexFloor).at(0);
        const bspDrawSurface_t &record = baked.map.bsp.drawSurfaces[std::size_t(surface)];
        for (int i = 0; i < record.numVerts; ++i) {
            const auto v = std::size_t(record.firstVert + i);
            places.push_back(
                {Vec3d(Vec3f(baked.map.bsp.drawVerts[v].xyz)), {0, 0, 1}, Vec3d(baked.surfaces.vertex.sum[0][v])});
        }
        return places;
    }
    /// Checks light from `lamp` that is `curve` of the distance and the cosine to straight down, on a surface that
    /// faces it.
    void Expect(const std::vector<Entity> &entities, const Vec3d &lamp,
                const std::function<double(double, double)> &curve) {
        for (const Place &place : Places(Bake(entities))) {
            const Vec3d way = lamp - place.position;
            const double d = Length(way), wanted = curve(d, way.z / d) * Dot(way, place.normal) / d;
            // Vertices are lit 1/8 over the surface.
            EXPECT_NEAR(place.light.x, wanted, 3e-3 * std::abs(wanted) + 1e-4)
                << place.position.x << " " << place.position.y;
        }
    }
    /// Lights of all kinds, brighter by a factor and elsewhere: turned by quarters around z, then moved.
    static std::vector<Entity> AllKinds(int factor, int quarters = 0, const Vec3f &moved = {}) {
        const std::string light = fmt::format("255 100 50 {}", 64 * factor);
        const auto place = [&](Vec3f p) {
            for (int i = 0; i < quarters; ++i)
                p = {-p.y, p.x, p.z};
            return fmt::format("{} {} {}", p.x + moved.x, p.y + moved.y, p.z + moved.z);
        };
        return {MakeEntity("light", {{"origin", place({20, 30, 90})}, {"_light", light}, {"_linear_attn", "1"}}),
                MakeEntity("light", {{"origin", place({-90, 30, 50})},
                                     {"_light", light},
                                     {"_fifty_percent_distance", "50"},
                                     {"_zero_percent_distance", "180"},
                                     {"_hardfalloff", "1"}}),
                MakeEntity("light", {{"origin", place({90, -70, 40})}, {"_light", light}, {"_radius", "200"}}),
                MakeEntity("light_spot", {{"origin", place({0, 50, 150})},
                                          {"_light", light},
                                          {"angles", fmt::format("-70 {} 0", 20 + 90 * quarters)},
                                          {"_inner_cone", "15"},
                                          {"_cone", "30"}})};
    }

    GameFolder folder_;
};

TEST_F(SourceLightsTest, CurvesByTheirFormulas) {
    const Vec3d lamp{30, 60, 120};
    Entity light = MakeEntity("light", {{"origin", "30 60 120"}, {"_light", "90"}});
    const auto with = [&](std::initializer_list<std::pair<std::string, std::string>> keys) {
        Entity one = light;
        for (const auto &[key, value] : keys)
            one.Set(key, value);
        return std::vector<Entity>{one};
    };
    Expect(with({{"_constant_attn", "4"}, {"_linear_attn", "0.25"}}), lamp,
           [](double d, double) { return 90 * 29 / (4 + 0.25 * d); });
    Expect(with({{"_light", "255 255 255 90"}}), lamp, [](double d, double) { return 90e4 / (d * d); });
    Expect(with({{"_radius", "180"}}), lamp,
           [](double d, double) { return d < 180 ? 90 * 7500 / (d * d) * std::pow(1 - std::pow(d / 180, 4), 2) : 0; });
    Expect(with({{"_fifty_percent_distance", "64"}, {"_zero_percent_distance", "128"}}), lamp,
           [](double d, double) { return 90 / (4.7331547e-4 * d * d + 4.7892720e-4 * d + 0.030651341); });
}

TEST_F(SourceLightsTest, ConesByAngles) {
    const double inner = std::cos(30 * kRadian), outer = std::cos(50 * kRadian);
    Expect({MakeEntity("light_spot", {{"origin", "30 60 120"},
                                      {"_light", "255 255 255 90"},
                                      {"pitch", "-90"},
                                      {"_inner_cone", "30"},
                                      {"_cone", "50"}})},
           {30, 60, 120}, [&](double d, double cosine) {
               return 90e4 / (d * d) * cosine * std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
           });
}

TEST_F(SourceLightsTest, LightEndsAtTheToleranceOfItsCurve) {
    const std::vector<Entity> lamp = {MakeEntity(
        "light", {{"origin", "0 0 100"}, {"_light", "4"}, {"_linear_attn", "1"}, {"_quadratic_attn", "0.1"}})};
    const std::vector<Place> whole = Places(Bake(lamp)), fast = Places(Bake(lamp, true));
    int ended = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        EXPECT_EQ(fast[i].light.x, whole[i].light.x > 1 ? whole[i].light.x : 0);
        ended += whole[i].light.x <= 1;
    }
    EXPECT_GT(ended, 10);
    EXPECT_LT(std::size_t(ended), whole.size());
}

TEST_F(SourceLightsTest, DoubleIntensitiesAreExactlyDoubleLightAndLightsAddUp) {
    const std::vector<Place> once = Places(Bake(AllKinds(1))), twice = Places(Bake(AllKinds(2)));
    std::vector<Vec3d> sum(once.size());
    for (const Entity &one : AllKinds(1)) {
        const std::vector<Place> part = Places(Bake({one}));
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += part[i].light;
    }
    for (std::size_t i = 0; i < once.size(); ++i) {
        EXPECT_EQ(once[i].light * 2.0, twice[i].light);
        EXPECT_LE(Length(once[i].light - sum[i]), 1e-5 * (1 + Length(sum[i])));
    }
}

TEST_F(SourceLightsTest, LightDoesNotDependOnWhereTheMapIs) {
    using Key = std::pair<int, int>;
    const auto bake = [&](int quarters, const Vec3f &moved) {
        SceneBuilder scene = EmptyRoom(Vec3f{-1024, -1024, -1024} + moved, Vec3f{1024, 1024, 1024} + moved);
        scene.AddQuad(Rectangle(moved.x - 128, moved.y - 128, moved.x + 128, moved.y + 128, moved.z),
                      Shaded(kLitFloor));
        const Baked baked = Bake(scene, AllKinds(1, quarters, moved));
        const RawLightmap &floor = baked.Of(kLitFloor);
        std::map<Key, Vec3f> light;
        for (std::size_t i = 0; i < floor.luxelClusters.size(); ++i)
            if (floor.Mapped(i)) {
                const Vec3f p = floor.positions[i] - moved;
                light[{int(std::lround(p.x)), int(std::lround(p.y))}] = floor.light[0][i];
            }
        return light;
    };
    const auto here = bake(0, {}), moved = bake(0, {4096, -4096, 4096}), turned = bake(1, {});
    ASSERT_GE(here.size(), 200u);
    const auto inside = [](int at) { return std::abs(at) < 120; }; // luxels at the rim are moved inward
    for (const auto &[at, light] : here) {
        if (!inside(at.first) || !inside(at.second))
            continue;
        EXPECT_LE(Length(moved.at(at) - light), 1e-4f * (1 + Length(light)));
        EXPECT_LE(Length(turned.at({-at.second, at.first}) - light), 1e-4f * (1 + Length(light)));
    }
}

/// A floor with sky on all other sides.
SceneBuilder OpenPlain() {
    SceneBuilder scene;
    scene.SetInterior({-1024, -1024, 0}, {1024, 1024, 1024}, Shaded("textures/test/sky"));
    scene.SetWallShader(BoxFace::MinusZ, Shaded("textures/test/ground"));
    return scene;
}

TEST_F(SourceLightsTest, AnOpenFloorGetsTheAmbientColorAndAWallHalfOfIt) {
    const std::vector<Entity> sky = {
        MakeEntity("light_environment", {{"_light", "0 0 0 0"}, {"_ambient", "255 128 64 80"}})};
    const double green = std::pow(128 / 255.0, 2.2);
    {
        SceneBuilder scene = OpenPlain();
        scene.AddQuad(Rectangle(-128, -128, 128, 128, 8), Shaded(kLitFloor));
        scene.AddQuad(Rectangle(200, -128, 400, 128, 8), Shaded(kVertexFloor));
        for (const Place &place : Places(Bake(scene, sky))) {
            EXPECT_NEAR(place.light.x, 80, 80e-5);
            EXPECT_NEAR(place.light.y, 80 * green, 80e-5);
        }
    }
    SceneBuilder scene = OpenPlain();
    scene.AddQuad({{{0, -128, 88}, {0, 128, 88}, {0, 128, 8}, {0, -128, 8}}}, Shaded("textures/test/standing"));
    const Baked baked = Bake(scene, sky);
    const RawLightmap &wall = baked.Of("textures/test/standing");
    int looked = 0;
    for (std::size_t i = 0; i < wall.luxelClusters.size(); ++i)
        if (wall.Mapped(i)) {
            ++looked;
            EXPECT_NEAR(wall.light[0][i].x, 40, 0.1) << wall.positions[i].z;
        }
    EXPECT_GT(looked, 60);
}

TEST_F(SourceLightsTest, ThePenumbraIsAsWideAsTheDiscOfTheSun) {
    // A slab over half of the floor; its lower edge is 900 units up.
    constexpr double kHeight = 900, kEdge = 3.3;
    SceneBuilder scene = OpenPlain();
    scene.AddQuad(Rectangle(-128, -128, 128, 128, 1), Shaded(kLitFloor));
    scene.AddQuad(Rectangle(200, -128, 400, 128, 1), Shaded(kVertexFloor));
    scene.AddBox({float(kEdge), -900, float(kHeight) + 1}, {900, 900, float(kHeight) + 9}, Shaded("textures/test/slab"),
                 BoxKind::Detail);
    const Baked baked = Bake(
        scene,
        {MakeEntity("light_environment",
                    {{"_light", "255 255 255 100"}, {"SunSpreadAngle", "5"}, {"_samples", "256"}, {"pitch", "-90"}})});
    const double halfWidth = kHeight * std::tan(2.5 * kRadian);
    const RawLightmap &floor = baked.Of(kLitFloor);
    std::array<int, 3> seen{};
    for (std::size_t i = 0; i < floor.luxelClusters.size(); ++i) {
        if (!floor.Mapped(i))
            continue;
        // The share of a disc on one side of a line.
        const double t = std::clamp((kEdge - double(floor.positions[i].x)) / halfWidth, -1.0, 1.0);
        const double share = 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
        EXPECT_NEAR(double(floor.light[0][i].x), 100 * share, t == 1 || t == -1 ? 0.1 : 3) << floor.positions[i].x;
        ++seen[t == 1 ? 0 : t == -1 ? 1 : 2];
    }
    EXPECT_GT(std::min({seen[0], seen[1], seen[2]}), 40);
}

} // namespace

} // namespace q3::test
