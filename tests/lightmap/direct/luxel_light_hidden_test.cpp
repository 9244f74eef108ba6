// GPL-2.0-or-later. Surface lights that solids cut or cover, their backsplash, and many skies: light at luxels.
#include "q3map2/light/sources/hidden_lights.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/sources/light_surfaces.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "tests/support/surface_case.h"

#include <algorithm>
#include <memory>
#include <numbers>
#include <set>
#include <span>

namespace q3::test {

namespace {

constexpr std::string_view kWest = "textures/test/west", kEast = "textures/test/east", kPanel = "textures/test/panel";
constexpr char kLamps[] = R"(textures/test/lamp
{
	q3map_surfacelight 400
	q3map_backsplash 0 0
}
textures/test/two
{
	q3map_surfacelight 400
	q3map_backsplash 0 0
	cull none
}
textures/test/dim
{
	q3map_surfacelight 20
	q3map_backsplash 0 0
}
textures/test/splash
{
	q3map_surfacelight 400
}
)";
/// Light of a hemisphere full of such a lamp. Byte scale.
constexpr double kAdd = 400 * 0.75;

/// A rectangle at height z.
struct Area {
    double x0, y0, x1, y1, z;
};

/// Light of an area at a place, by the midpoint rule: the sum of cosine times cosine over pi r^2.
double FromArea(const Vec3f &at, const Vec3f &normal, const Area &area, double facing) {
    constexpr int kSteps = 100;
    const double width = (area.x1 - area.x0) / kSteps, depth = (area.y1 - area.y0) / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const Vec3d way =
            Vec3d{area.x0 + (i % kSteps + 0.5) * width, area.y0 + (i / kSteps + 0.5) * depth, area.z} - Vec3d(at);
        const double squared = Dot(way, way);
        sum += std::max(0.0, Dot(way, Vec3d(normal))) * std::max(0.0, -facing * way.z) / (squared * squared);
    }
    return kAdd * sum * width * depth / std::numbers::pi;
}

/// Light of a triangle, clockwise seen from the front, likewise: at the centroids of small triangles.
double FromTriangle(const Vec3f &at, const Vec3f &normal, std::span<const Vec3f, 3> corners) {
    constexpr int kSteps = 100;
    const Vec3d u = Vec3d(corners[1] - corners[0]) / kSteps, v = Vec3d(corners[2] - corners[0]) / kSteps;
    const Vec3d facing = Cross(v, u) * 0.5; // as long as the area of a small triangle
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; i + j < kSteps; ++j)
            for (const double third : {1.0, 2.0}) { // the small triangle, and the one that completes a parallelogram
                if (third > 1 && i + j + 1 >= kSteps)
                    continue;
                const Vec3d way = Vec3d(corners[0]) + u * (i + third / 3) + v * (j + third / 3) - Vec3d(at);
                const double squared = Dot(way, way);
                sum += std::max(0.0, Dot(way, Vec3d(normal))) * std::max(0.0, -Dot(way, facing)) / (squared * squared);
            }
    return kAdd * sum / std::numbers::pi;
}

std::array<Vec3f, 4> FacingDown(float x0, float y0, float x1, float y1, float z) {
    auto corners = Rectangle(x0, y0, x1, y1, z);
    std::reverse(corners.begin(), corners.end());
    return corners;
}

/// A room of 512 x 512 x 256 with the origin in the middle of its floor.
class HiddenLampTest : public testing::Test {
  protected:
    void Light() {
        case_ = std::make_unique<SurfaceCase>(scene_, folder_, CaseSettings{.script = kLamps});
        case_->settings.light.fast = fast_;
        SurfaceLightCounts counts;
        created_ = SurfaceLights(case_->space, case_->table, case_->settings.light, case_->world, case_->library,
                                 counts, case_->quiet.log);
        int culled = 0;
        const auto lights = SetupEnvelopes(created_, LightPass::Surfaces, case_->settings.light, case_->space,
                                           SkySeenFrom(case_->space, case_->table), culled);
        surfaces_ = std::make_unique<SurfaceLight>(case_->Mapped());
        ContributionCounts rays;
        LightLuxels(case_->Inputs(), lights, {}, *surfaces_, rays);
    }
    /// Checks every luxel of a surface: expected(place, normal) within half a percent, or darker by up to
    /// `mayLack`. Byte scale.
    template <typename Expected>
    void ExpectLuxels(std::string_view shader, const Expected &expected, double mayLack = 0) const {
        const RawLightmap &raw = LightmapOf(*case_, *surfaces_, shader);
        int luxels = 0;
        for (std::size_t i = 0; i < raw.luxelClusters.size(); ++i) {
            if (!raw.Mapped(i))
                continue;
            const double right = expected(raw.positions[i], raw.normals[i]);
            const Vec3f &p = raw.positions[i];
            const double slack = 0.005 * right + 0.01;
            ASSERT_LE(raw.light[0][i].x, right + slack) << p.x << ' ' << p.y << ' ' << p.z;
            ASSERT_GE(raw.light[0][i].x, right - mayLack - slack) << p.x << ' ' << p.y << ' ' << p.z;
            ++luxels;
        }
        EXPECT_GE(luxels, 50);
    }

    SceneBuilder scene_ = EmptyRoom({-256, -256, 0}, {256, 256, 256});
    GameFolder folder_;
    bool fast_ = false; ///< as with -fast
    std::unique_ptr<SurfaceCase> case_;
    std::vector<q3::Light> created_;
    std::unique_ptr<SurfaceLight> surfaces_;
};

TEST_F(HiddenLampTest, WallThroughALampLeavesEachSideItsPart) {
    for (const BoxKind kind : {BoxKind::Structural, BoxKind::Detail}) {
        SCOPED_TRACE(int(kind));
        scene_ = EmptyRoom({-256, -256, 0}, {256, 256, 256});
        scene_.AddQuad(Rectangle(-200, -100, 200, 100, 8), Shaded("textures/test/lamp"));
        scene_.AddBox({-20, -256, 0}, {-12, 256, 256}, Shaded("textures/test/wall"), kind);
        scene_.AddQuad(FacingDown(-250, -120, -30, 120, 240), Shaded(kWest));
        scene_.AddQuad(FacingDown(0, -120, 250, 120, 240), Shaded(kEast));
        Light();
        ExpectLuxels(kWest, [](const Vec3f &p, const Vec3f &n) {
            return FromArea(p, n, {-200, -100, -20, 100, 8}, 1);
        });
        ExpectLuxels(kEast, [](const Vec3f &p, const Vec3f &n) { return FromArea(p, n, {-12, -100, 200, 100, 8}, 1); });
    }
}

TEST_F(HiddenLampTest, PillarOnTheMiddleHidesWhatItCovers) {
    for (const BoxKind kind : {BoxKind::Structural, BoxKind::Detail}) {
        SCOPED_TRACE(int(kind));
        scene_ = EmptyRoom({-256, -256, 0}, {256, 256, 256});
        scene_.AddQuad(Rectangle(-200, -200, 200, 200, 8), Shaded("textures/test/lamp"));
        scene_.AddBox({-48, -48, 0}, {48, 48, 12}, Shaded("textures/test/wall"), kind);
        scene_.AddQuad(FacingDown(-100, -100, 100, 100, 240), Shaded(kPanel));
        Light();
        ExpectLuxels(kPanel, [](const Vec3f &p, const Vec3f &n) {
            return FromArea(p, n, {-200, -200, 200, 200, 8}, 1) - FromArea(p, n, {-48, -48, 48, 48, 8}, 1);
        });
    }
}

TEST_F(HiddenLampTest, PartsOfALampReachAsFarAsItWouldUnderFast) {
    scene_.AddQuad(Rectangle(-200, -200, 200, 200, 8), Shaded("textures/test/dim"));
    scene_.AddBox({-48, -48, 0}, {48, 48, 12}, Shaded("textures/test/wall"));
    scene_.AddQuad(FacingDown(-100, -100, 100, 100, 240), Shaded(kPanel));
    // The quad is two lights, triangles, that end at about 600 units. With the tolerance of the whole, their smallest
    // part would end at 230, before it reaches the panel.
    fast_ = true;
    Light();
    constexpr double kLeftOut = 0.7; // by -fast, at most one byte a light; most far beside the lamp. Byte scale
    ExpectLuxels(
        kPanel,
        [](const Vec3f &p, const Vec3f &n) {
            const Area lamp{-200, -200, 200, 200, 8}, pillar{-48, -48, 48, 48, 8};
            return (FromArea(p, n, lamp, 1) - FromArea(p, n, pillar, 1)) * 20 / 400;
        },
        kLeftOut);
}

TEST_F(HiddenLampTest, TwoSidedLampShinesFromItsBackWhereItsFrontIsCovered) {
    scene_.AddQuad(Rectangle(-100, -100, 100, 100, 120), Shaded("textures/test/two"));
    scene_.AddBox({0, -120, 120}, {120, 120, 140}, Shaded("textures/test/wall"), BoxKind::Detail);
    scene_.AddQuad(FacingDown(-250, -120, -110, 120, 240), Shaded(kWest));
    scene_.AddQuad(Rectangle(-120, -120, 120, 120, 4), Shaded(kPanel));
    Light();
    ExpectLuxels(kWest, [](const Vec3f &p, const Vec3f &n) { return FromArea(p, n, {-100, -100, 0, 100, 120}, 1); });
    ExpectLuxels(kPanel, [](const Vec3f &p, const Vec3f &n) {
        return FromArea(p, n, {-100, -100, 100, 100, 120}, -1);
    });
}

TEST_F(HiddenLampTest, LampWhollyInSolidIsNamed) {
    scene_.AddQuad(Rectangle(-64, -64, 64, 64, 8), Shaded("textures/test/lamp"));
    scene_.AddBox({-80, -80, 0}, {80, 80, 40}, Shaded("textures/test/wall"), BoxKind::Detail);
    scene_.AddQuad(FacingDown(-100, -100, 100, 100, 240), Shaded(kPanel));
    Light();
    ExpectLuxels(kPanel, [](const Vec3f &, const Vec3f &) { return 0; });
    EXPECT_EQ(case_->quiet.log.WarningCount("surface light in solid"), 2); // two triangles
    EXPECT_NE(case_->quiet.text.find("textures/test/lamp: the surface light at"), std::string::npos)
        << case_->quiet.text;
}

TEST_F(HiddenLampTest, SolidAtTheMiddleOfATiltedLampsBoxDoesNotMatter) {
    // The middle of the triangle's box is 37 units behind its plane, in a brush that does not touch the triangle.
    const Vec3f corners[] = {{0, 0, 40}, {128, 0, 168}, {128, 128, 40}};
    const std::int32_t indexes[] = {0, 1, 2};
    scene_.AddTriangles(corners, indexes, Shaded("textures/test/lamp"));
    scene_.AddBox({56, 56, 96}, {72, 72, 112}, Shaded("textures/test/wall"), BoxKind::Detail);
    scene_.AddQuad(Rectangle(0, -250, 250, -60, 4), Shaded(kPanel));
    Light();
    ExpectLuxels(kPanel, [&](const Vec3f &p, const Vec3f &n) { return FromTriangle(p, n, corners); });
}

TEST_F(HiddenLampTest, LampInTheOpenStaysAsItIs) {
    scene_.AddQuad(Rectangle(-256, -100, 200, 100, 8), Shaded("textures/test/lamp")); // touches a wall
    scene_.AddBox({-20, -256, 40}, {-12, 256, 256}, Shaded("textures/test/wall"));
    scene_.AddBox({-40, -40, 0}, {40, 40, 8}, Shaded("textures/test/wall"), BoxKind::Detail); // below
    scene_.AddQuad(FacingDown(0, -120, 250, 120, 240), Shaded(kPanel));
    Light();
    ASSERT_EQ(created_.size(), 2u);
    for (const q3::Light &light : created_) {
        ASSERT_EQ(light.polygon.size(), 3u);
        EXPECT_EQ(light.origin, (Vec3f{-28, 0, 9}));
    }
}

TEST_F(HiddenLampTest, BacksplashStaysOnTheLampsSideOfASolid) {
    for (const BoxKind kind : {BoxKind::Structural, BoxKind::Detail}) {
        SCOPED_TRACE(int(kind));
        scene_ = EmptyRoom({-256, -256, 0}, {256, 256, 256});
        scene_.AddQuad(Rectangle(-64, -64, 64, 64, 8), Shaded("textures/test/splash"));
        scene_.AddBox({-256, -256, 16}, {256, 256, 24}, Shaded("textures/test/wall"), kind);
        scene_.AddQuad(Rectangle(-100, -100, 100, 100, 26), Shaded(kPanel));
        Light();
        ExpectLuxels(kPanel, [](const Vec3f &, const Vec3f &) { return 0; });
        ASSERT_EQ(created_.size(), 4u);
        for (const q3::Light &light : created_) {
            EXPECT_GT(light.origin.z, 8);
            EXPECT_LT(light.origin.z, 16);
        }
    }
}

TEST_F(HiddenLampTest, EverySkyHasItsOwnSun) {
    constexpr int kSkies = 40;
    std::string script;
    for (int i = 0; i < kSkies; ++i) {
        script += fmt::format("textures/sky/s{}\n{{\nsurfaceparm sky\nq3map_sun 1 1 1 100 0 90\n}}\n", i);
        const float x = -240 + 12 * float(i);
        scene_.AddQuad(FacingDown(x, -10, x + 10, 10, 250), Shaded(fmt::format("textures/sky/s{}", i)));
    }
    case_ = std::make_unique<SurfaceCase>(scene_, folder_, CaseSettings{.script = script});
    SurfaceLightCounts counts;
    const auto suns = SurfaceLights(case_->space, case_->table, case_->settings.light, case_->world, case_->library,
                                    counts, case_->quiet.log);
    std::set<int> ofSuns, ofSurfaces;
    for (const q3::Light &sun : suns)
        ofSuns.insert(sun.skyIndex);
    for (const SurfaceEntry &entry : case_->table)
        if (!entry.shader->suns.empty())
            ofSurfaces.insert(entry.skyIndex);
    EXPECT_EQ(ofSuns.size(), std::size_t(kSkies));
    EXPECT_EQ(ofSuns.count(-1), 0u);
    EXPECT_EQ(ofSuns, ofSurfaces);
}

} // namespace

} // namespace q3::test
