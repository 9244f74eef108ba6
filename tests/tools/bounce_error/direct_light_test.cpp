// GPL-2.0-or-later. Direct light of the path tracer against the light stage's own.
#include "tests/tools/bounce_error/bounce_fixture.h"

#include "q3map2/light/transfer/light_sample.h"

#include <cmath>

namespace q3::test {

namespace {

using bounce::PathRandom;
using bounce::SurfacePoint;

Entity LightEntity(std::initializer_list<std::pair<std::string, std::string>> keys) {
    Entity entity{{{"classname", "light"}}};
    for (const auto &[key, value] : keys)
        entity.Set(key, value);
    return entity;
}

/// A room with lights of all types and a pillar that shadows some.
SceneBuilder LitRoom() {
    SceneBuilder scene;
    scene.SetInterior({-256, -256, -256}, {256, 256, 256}, {"textures/test/wall"});
    scene.SetWorldKey("_keepLights", "1");
    scene.SetWallShader(BoxFace::PlusZ, {"textures/test/sky", 4});
    const int pillar = scene.AddBox({-40, -40, -256}, {40, 40, 60}, {"textures/test/wall"});
    scene.SetFaceShader(pillar, BoxFace::PlusX, {"textures/test/lamp"});
    const std::array<Vec3f, 4> panel{Vec3f{-200, -200, 0}, {-200, -100, 0}, {-100, -100, 0}, {-100, -200, 0}};
    scene.AddQuad(panel, {"textures/test/glow"});
    scene.AddEntity(LightEntity({{"origin", "100 0 100"}, {"light", "200"}, {"_color", "1 0.5 0.2"}}));
    scene.AddEntity(LightEntity({{"origin", "-100 90 100"}, {"light", "300"}, {"spawnflags", "1"}}));
    scene.AddEntity(LightEntity({{"origin", "100 150 -100"}, {"light", "150"}, {"_anglescale", "0.5"}}));
    scene.AddEntity(LightEntity({{"origin", "0 150 -200"}, {"light", "100"}, {"spawnflags", "2"}}));
    scene.AddEntity(LightEntity({{"origin", "0 0 200"}, {"light", "900"}, {"target", "spot"}, {"radius", "90"}}));
    scene.AddEntity(LightEntity({{"origin", "190 190 0"}, {"light", "-60"}}));
    scene.AddEntity({{{"classname", "info_null"}, {"targetname", "spot"}, {"origin", "60 60 -256"}}});
    return scene;
}

constexpr const char *kLitShaders = R"(textures/test/lamp
{
	q3map_surfacelight 500
	q3map_lightSubdivide 64
	q3map_lightRGB 1 0.9 0.6
}
textures/test/glow
{
	cull disable
	q3map_surfacelight 300
	q3map_lightRGB 0.3 0.9 0.6
}
textures/test/sky
{
	surfaceparm sky
	surfaceparm nolightmap
	q3map_sun 1 0.9 0.7 100 40 60
	q3map_lightRGB 0.5 0.6 1
	q3map_skyLight 60 3
}
)";

/// A place in the open of the lit room and a normal.
SurfacePoint RandomPoint(const TracedScene &scene, PathRandom &random, bool twoSided) {
    SurfacePoint at;
    do
        at.position = {float(500 * random.Unit() - 250), float(500 * random.Unit() - 250),
                       float(500 * random.Unit() - 250)};
    while ((at.cluster = scene.setup.space.ClusterAt(at.position, 1)) < 0);
    at.normal = bounce::SphereDirection(random.Unit2());
    at.twoSided = twoSided;
    return at;
}

TEST_F(PathTest, DirectLightIsThatOfTheLightStage) {
    Script(kLitShaders);
    const auto scene = Make(LitRoom(), 0.5f);
    scene->Prepare();
    PathRandom random(1);
    std::array<int, 4> lit{};
    for (int i = 0; i < 8000; ++i) {
        const SurfacePoint at = RandomPoint(*scene, random, i % 3 == 0);
        for (const Light &light : scene->lights->Lights()) {
            SurfaceReceiverBatch batch;
            batch.twoSided = at.twoSided;
            batch.Add(at.position, at.normal, at.cluster);
            SurfaceIncidentLight incident;
            ContributionCounts counts;
            LightContributionToSample(light, {.shadows = false, .sunShadows = false}, scene->setup.scene, batch,
                                      incident, counts);
            const float add = incident.live[0] != 0 ? incident.strength[0] : 0;
            const Vec3f expected = light.color * (light.negative ? -add : add);
            const bounce::UnshadowedLight found = LightWithoutShadow(light, at);
            ASSERT_LT(Length(found.color - expected), 1e-3f + 1e-3f * Length(expected)) << i;
            if (add > 0.01f) {
                EXPECT_LT(Length(found.direction - incident.direction[0]), 1e-3f);
                EXPECT_NEAR(found.distance, incident.distance[0], 0.01f);
                ++lit[std::size_t(light.type)];
            }
        }
    }
    for (const int count : lit)
        EXPECT_GT(count, 100);
}

TEST_F(PathTest, SampledLightsHaveTheMeanOfAllLights) {
    Script(kLitShaders);
    const auto scene = Make(LitRoom(), 0.5f);
    scene->Prepare();
    ASSERT_GT(scene->lights->Lights().size(), 40u); // else all are evaluated
    PathRandom random(2);
    for (int i = 0; i < 12; ++i) {
        const SurfacePoint at = RandomPoint(*scene, random, i % 4 == 0);
        Vec3d all, sum, squares;
        for (const Light &light : scene->lights->Lights())
            all += Vec3d(LightWithoutShadow(light, at).color);
        constexpr int kSamples = 40000;
        for (int k = 0; k < kSamples; ++k) {
            const Vec3d one(scene->lights->Sample(at, random).color);
            sum += one, squares += one * one;
        }
        for (std::size_t c = 0; c < 3; ++c) {
            const double mean = sum[c] / kSamples;
            const double error = std::sqrt(std::max(0.0, squares[c] / kSamples - mean * mean) / kSamples);
            EXPECT_NEAR(mean, all[c], 4.5 * error + 1e-3 * std::abs(all[c]) + 1e-6) << i;
        }
    }
}

} // namespace

} // namespace q3::test
