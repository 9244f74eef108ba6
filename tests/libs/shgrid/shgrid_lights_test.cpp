// GPL-2.0-or-later. What the engine-side reader makes of lights that a grid names, against the program's own formulas.
#include "libs/sh/polygon_moments.h"
#include "libs/shgrid/shgrid.h"
#include "q3map2/light/sources/falloff.h"
#include "tests/support/named_grid.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

using namespace q3;
using namespace q3::test;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kY0 = 0.282094791773878, kY1 = 0.488602511902920; ///< factors of the SH basis

/// A table of lights alone, as the reader sees it.
struct TableView {
    GridLights table;
    shgrid_grid grid{};
    explicit TableView(GridLights lights) : table(std::move(lights)) {
        grid.lights = reinterpret_cast<const unsigned char *>(table.lights.data());
        grid.polygons = reinterpret_cast<const unsigned char *>(table.polygons.data());
        grid.vertices = reinterpret_cast<const unsigned char *>(table.vertices.data());
        grid.lightCount = std::int32_t(table.lights.size());
    }
    TableView(const TableView &) = delete;
    TableView &operator=(const TableView &) = delete;
    shgrid_beam_ Beam(const Vec3f &position, std::uint32_t number = 0) const {
        const float at[3] = {position.x, position.y, position.z};
        shgrid_beam_ beam;
        shgrid_beam_at_(&grid, number, at, &beam);
        return beam;
    }
    shgrid_moments_ Moments(const Vec3f &position) const {
        const float at[3] = {position.x, position.y, position.z};
        shgrid_moments_ moments;
        shgrid_polygon_moments_(&grid, grid.lights, at, 1, &moments);
        return moments;
    }
};

// ---- Points and spots ----

/// A record of a light, and the light itself.
struct LightPair {
    Light light;
    TableView view;
    explicit LightPair(const Light &from) : light(from), view(TableOf(from)) {}

    static GridLights TableOf(const Light &light) {
        GridLights table;
        const bool isSpot = light.type == LightType::Spot;
        GridLight &record = AddLight(table, "", isSpot ? SHGRID_SPOT : SHGRID_POINT);
        const Attenuation &k = light.attenuation;
        record.curve = std::uint8_t(light.curve == FalloffCurve::Linear       ? SHGRID_LINEAR
                                    : light.curve == FalloffCurve::Windowed   ? SHGRID_WINDOWED
                                    : light.curve == FalloffCurve::Polynomial ? SHGRID_POLYNOMIAL
                                                                              : SHGRID_INVERSE_SQUARE);
        record.nearest = light.curve == FalloffCurve::Polynomial ? kNearestPolynomial : kNearest;
        record.origin = light.origin.Array(), record.normal = light.normal.Array();
        record.intensity = light.photons, record.extraDist = light.extraDist, record.fade = light.fade;
        record.end = k.end, record.fadeFrom = k.fadeFrom, record.flatFrom = k.flatFrom;
        record.constant = k.constant, record.linear = k.linear, record.quadratic = k.quadratic;
        if (light.cone.byAngles)
            record.flags = SHGRID_CONE_BY_ANGLES;
        record.cosInner = light.cone.cosInner, record.cosOuter = light.cone.cosOuter;
        record.exponent = light.cone.exponent;
        record.coneRadius = light.radiusByDist, record.coneFade = kConeFade;
        return table;
    }
};

Light LightOfCurve(FalloffCurve curve) {
    Light light;
    light.curve = curve;
    light.photons = curve == FalloffCurve::Polynomial ? 200.0f : 30000.0f;
    light.fade = 0.004f;
    light.extraDist = 12;
    light.origin = {10, -20, 30};
    light.normal = {0.6f, 0, -0.8f};
    light.attenuation = {
        .constant = 0.5f, .linear = 0.01f, .quadratic = 2e-4f, .flatFrom = 300, .fadeFrom = 200, .end = 400};
    return light;
}

constexpr FalloffCurve kCurves[] = {FalloffCurve::InverseSquare, FalloffCurve::Linear, FalloffCurve::Windowed,
                                    FalloffCurve::Polynomial};

TEST(NamedLights, FalloffIsThatOfTheProgram) {
    for (const FalloffCurve curve : kCurves)
        for (const float extra : {0.0f, 12.0f}) {
            Light light = LightOfCurve(curve);
            light.extraDist = extra;
            const LightPair pair(light);
            const Falloff falloff(light);
            for (float distance = 0; distance < 1500; distance = distance * 1.1f + 0.5f) {
                const shgrid_beam_ beam = pair.view.Beam(light.origin + Vec3f{0.48f, -0.6f, 0.64f} * distance);
                const float expected = std::max(0.0f, falloff.At(distance));
                EXPECT_NEAR(beam.strength, expected, 2e-5f * (light.photons / 8000 + expected)) << distance;
                EXPECT_EQ(beam.spread, 0);
                EXPECT_FALSE(beam.hasSH);
                EXPECT_NEAR(beam.direction[1], distance > 1 ? 0.6f : beam.direction[1], 1e-4f);
            }
        }
}

TEST(NamedLights, ConesAreThoseOfTheProgram) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(-1, 1);
    for (const FalloffCurve curve : kCurves)
        for (int kind = 0; kind < 3; ++kind) {
            Light light = LightOfCurve(curve);
            light.type = LightType::Spot;
            light.radiusByDist = 0.7f;
            light.cone = {kind > 0, 0.9f, 0.5f, kind == 1 ? 1.0f : 2.5f};
            const LightPair pair(light);
            const Falloff falloff(light);
            int lit = 0, dark = 0;
            for (int round = 0; round < 2000; ++round) {
                const Vec3f to = Vec3f{unit(random), unit(random), unit(random)} * 150 - light.normal * 60;
                const float fraction = ConeFraction(light, to), distance = Length(to);
                const float expected = std::max(0.0f, falloff.At(distance) * fraction);
                EXPECT_NEAR(pair.view.Beam(light.origin - to).strength, expected, 1e-4f * (1 + falloff.At(distance)));
                lit += expected > 0, dark += expected == 0;
            }
            EXPECT_GT(lit, 300);
            EXPECT_GT(dark, 300);
        }
}

TEST(NamedLights, LightIsFiniteRightAtALight) {
    for (const FalloffCurve curve : kCurves) {
        LightPair pair(LightOfCurve(curve));
        GridLight &record = pair.view.table.lights[0];
        record.nearest = record.extraDist = record.constant = 0;
        const shgrid_beam_ beam = pair.view.Beam(pair.light.origin);
        EXPECT_TRUE(std::isfinite(beam.strength));
        for (const float component : beam.direction)
            EXPECT_EQ(component, 0);
    }
    GridLights table;
    AddPolygonLight(table, "", {{0, 0, 0}, {0, 8, 0}, {8, 8, 0}, {8, 0, 0}});
    const TableView view(table);
    for (const Float3 &vertex : table.vertices)
        EXPECT_TRUE(std::isfinite(view.Beam(Vec3f(vertex)).strength));
    EXPECT_NEAR(view.Beam({4, 4, 1e-3f}).sh[0], 0.282094792 * 2 * kPi, 1e-2) << "half of all directions";
}

// ---- Polygons ----

std::vector<Vec3f> Corners(const GridLights &table) {
    std::vector<Vec3f> corners;
    for (const Float3 &vertex : table.vertices)
        corners.emplace_back(vertex);
    return corners;
}

/// A pentagon in the plane z = 0 whose front is toward +z.
GridLights Pentagon() {
    GridLights table;
    AddPolygonLight(table, "", {{-10, -10, 0}, {-12, 6, 0}, {0, 14, 0}, {16, 4, 0}, {8, -12, 0}});
    return table;
}

void ExpectMoments(const shgrid_moments_ &a, const PolygonMoments &b, double error) {
    const double numbers[10] = {a.solidAngle, a.first[0], a.first[1], a.first[2], a.xx, a.yy, a.zz, a.xy, a.yz, a.xz};
    const double expected[10] = {b.solidAngle, b.first.x, b.first.y, b.first.z, b.xx, b.yy, b.zz, b.xy, b.yz, b.xz};
    for (std::size_t i = 0; i < 10; ++i)
        EXPECT_NEAR(numbers[i], expected[i], error) << i;
}

Vec3f RandomDirection(std::mt19937 &random) {
    std::normal_distribution<float> normal;
    return Normalize(Vec3f{normal(random), normal(random), normal(random)});
}

TEST(NamedLights, PolygonsAreThoseOfTheProgram) {
    std::mt19937 random(9);
    for (const bool isTwoSided : {false, true}) {
        GridLights table = Pentagon();
        table.lights[0].flags = isTwoSided ? SHGRID_TWO_SIDED : 0;
        const TableView view(table);
        const GridPolygon &polygon = table.polygons[0];
        const std::vector<Vec3f> front = Corners(table), back(front.rbegin(), front.rend());
        const Vec3f center(polygon.center);
        for (int round = 0; round < 3000; ++round) {
            const float radii = 0.05f * std::pow(800.0f, float(round) / 3000); // up to 40
            const Vec3f place = center + RandomDirection(random) * (radii * polygon.radius);
            PolygonMoments expected = MomentsOfPolygon(front, Vec3d(place));
            if (isTwoSided && place.z < 0)
                expected = MomentsOfPolygon(back, Vec3d(place));
            const shgrid_moments_ moments = view.Moments(place);
            if (radii <= 6)
                ExpectMoments(moments, expected, 1e-6);
            else // of a point instead: the error falls with the square of the distance
                ExpectMoments(moments, expected, 1.5 * expected.solidAngle / double(radii * radii) + 1e-9);
            EXPECT_EQ(moments.solidAngle > 0, place.z > 0 || isTwoSided);
        }
    }
}

TEST(NamedLights, ExactPolygonsBlendIntoPoints) {
    const GridLights table = Pentagon();
    const TableView view(table);
    const GridPolygon &polygon = table.polygons[0];
    const Vec3f way{0.48f, 0.6f, 0.64f};
    const auto solidAngle = [&](float radii, bool isPoint) {
        const Vec3f place = Vec3f(polygon.center) + way * (radii * polygon.radius);
        const double distance = double(radii) * double(polygon.radius);
        return isPoint ? double(polygon.area) * double(place.z) / (distance * distance * distance)
                       : MomentsOfPolygon(Corners(table), Vec3d(place)).solidAngle;
    };
    for (const float radii : {5.0f, 6.0f, 6.5f, 7.0f, 7.9f, 8.0f, 8.1f, 20.0f}) {
        const double exact = std::clamp((8 - double(radii)) / 2, 0.0, 1.0);
        const double expected = exact * solidAngle(radii, false) + (1 - exact) * solidAngle(radii, true);
        EXPECT_NEAR(view.Moments(Vec3f(polygon.center) + way * (radii * polygon.radius)).solidAngle, expected,
                    2e-6 * expected)
            << radii;
    }
}

TEST(NamedLights, AllPolygonsOfALightCount) {
    GridLights table = Pentagon();
    AddPolygonLight(table, "", {{30, 0, 0}, {30, 10, 0}, {40, 10, 0}, {40, 0, 0}});
    table.lights[0].polygonCount = 2;
    const TableView view(table);
    const Vec3f place{12, 3, 9};
    const std::vector<Vec3f> corners = Corners(table);
    PolygonMoments expected = MomentsOfPolygon(std::span(corners).first(5), Vec3d(place));
    const PolygonMoments second = MomentsOfPolygon(std::span(corners).subspan(5), Vec3d(place));
    EXPECT_NEAR(view.Moments(place).solidAngle, expected.solidAngle + second.solidAngle, 1e-6);
    EXPECT_NEAR(view.Moments(place).xy, expected.xy + second.xy, 1e-6);
}

/// A regular polygon of 64 corners in the plane z = 0, nearly a disc of radius 10, and of light 1.
GridLights Disc() {
    GridLights table = Pentagon();
    table.vertices.clear();
    for (int i = 0; i < 64; ++i)
        table.vertices.push_back({float(10 * std::sin(2 * kPi * i / 64)), float(10 * std::cos(2 * kPi * i / 64)), 0});
    GridPolygon &disc = table.polygons[0];
    disc.vertexCount = 64, disc.center = {}, disc.radius = 10, disc.area = float(100 * kPi);
    return table;
}

/// Coefficients of all that a light gives, color 1.
std::array<double, 9> Coefficients(const shgrid_beam_ &beam) {
    shgrid_coeffs sum{};
    const float color[3] = {beam.strength, 0, 0};
    if (beam.strength > 0)
        shgrid_add_direct_(beam.direction, beam.spread, color, &sum);
    std::array<double, 9> c{};
    for (std::size_t k = 0; k < 9; ++k)
        c[k] = double(sum.c[k][0]) + double(beam.hasSH ? beam.sh[k] : 0);
    return c;
}

TEST(NamedLights, DirectionsBecomeCoefficientsStepByStep) {
    const GridLights table = Disc();
    const TableView view(table);
    std::array<double, 9> before{};
    float strength = 0;
    for (double angle = 20; angle <= 80; angle += 0.05) {
        const double height = 10 / std::tan(angle * kPi / 180), sine = std::sin(angle * kPi / 180);
        const shgrid_beam_ beam = view.Beam({0, 0, float(height)});
        const std::array<double, 9> c = Coefficients(beam);
        const double irradiance = sine * sine; // of light 1, on a surface that faces the disc
        if (angle < 39.5) {
            EXPECT_FALSE(beam.hasSH) << angle;
            EXPECT_NEAR(double(beam.strength), irradiance, 3e-3 * irradiance);
            EXPECT_NEAR(double(beam.spread), sine, 3e-3);
            EXPECT_NEAR(beam.direction[2], -1, 1e-5f);
        } else if (angle > 40.5 && angle < 49.5) {
            EXPECT_TRUE(beam.hasSH && beam.strength > 0) << angle;
        } else if (angle > 50.5) {
            EXPECT_TRUE(beam.hasSH && beam.strength == 0) << angle;
        }
        if (before[0] > 0) {
            EXPECT_LT(std::abs(beam.strength - strength), 0.02f) << angle;
            for (std::size_t k = 0; k < 9; ++k)
                EXPECT_NEAR(c[k], before[k], 3e-3) << angle;
        }
        // Of the light on a surface that faces the disc, against the exact projection.
        const double mean = 2 * kPi * (1 - std::cos(angle * kPi / 180)) * kY0, slope = -2 * kPi / 3 * irradiance * kY1;
        EXPECT_NEAR(kY0 * c[0], kY0 * mean, 5e-3 * irradiance) << angle;
        EXPECT_NEAR(kY1 * c[2], kY1 * slope, 5e-3 * irradiance) << angle;
        before = c, strength = beam.strength;
    }
}

/// Light on a surface from a strip of 200 x 14 in the plane z = 0 around the origin, of light 1: the sum over small
/// pieces of it.
double FromStrip(const Vec3d &place, const Vec3d &normal) {
    double sum = 0;
    for (double x = -99.5; x < 100; ++x)
        for (double y = -6.5; y < 7; ++y) {
            const Vec3d to = Vec3d{x, y, 0} - place;
            const double square = Dot(to, to);
            sum += std::max(0.0, Dot(to, normal)) * place.z / (square * square * kPi);
        }
    return sum;
}

TEST(NamedLights, LongLampsAreNoDirectionNearby) {
    GridLights table;
    AddPolygonLight(table, "", {{-100, -7, 0}, {-100, 7, 0}, {100, 7, 0}, {100, -7, 0}});
    const TableView view(table);
    std::mt19937 random(4);
    for (const float height : {8.0f, 16.0f, 32.0f, 64.0f, 96.0f, 128.0f, 192.0f, 384.0f})
        for (const float side : {0.0f, 60.0f, 110.0f}) {
            const Vec3f place{side, 0, height};
            const shgrid_beam_ beam = view.Beam(place);
            shgrid_lighting lighting{};
            for (std::size_t k = 0; beam.hasSH && k < 9; ++k)
                lighting.rest.c[k][0] = beam.sh[k];
            lighting.count = 1;
            std::ranges::copy(beam.direction, lighting.direct[0].direction);
            lighting.direct[0].color[0] = beam.strength, lighting.direct[0].spread = beam.spread;
            double squares = 0, sum = 0;
            for (int i = 0; i < 200; ++i) {
                const Vec3f normal = RandomDirection(random);
                const float n[3] = {normal.x, normal.y, normal.z};
                float rgb[3];
                shgrid_shade(&lighting, n, rgb);
                const double exact = FromStrip(Vec3d(place), Vec3d(normal));
                squares += std::pow(double(rgb[0]) - exact, 2), sum += exact * exact;
            }
            EXPECT_LT(std::sqrt(squares / sum), 0.052) << height << ' ' << side;
        }
}

// ---- Surfaces ----

TEST(NamedLights, CoefficientsAreTheIntegralOfWhatSurfacesShow) {
    const float direction[3] = {0.48f, -0.6f, 0.64f};
    for (const float spread : {0.0f, 0.3f, 0.7f}) {
        shgrid_lighting lighting{};
        lighting.count = 1;
        lighting.direct[0].spread = spread;
        std::copy(direction, direction + 3, lighting.direct[0].direction);
        const float color[3] = {1, 0.5f, 0.25f};
        std::copy(color, color + 3, lighting.direct[0].color);
        std::array<double, 9> integral{};
        constexpr int kRings = 400;
        for (int ring = 0; ring < kRings; ++ring)
            for (int i = 0; i < 2 * kRings; ++i) {
                const double z = (ring + 0.5) * 2 / kRings - 1, side = std::sqrt(1 - z * z), angle = kPi * i / kRings;
                const float normal[3] = {float(side * std::cos(angle)), float(side * std::sin(angle)), float(z)};
                float rgb[3];
                shgrid_shade(&lighting, normal, rgb);
                EXPECT_NEAR(rgb[2], rgb[0] / 4, 1e-6f);
                const SHVector basis = SHBasis(Vec3d{double(normal[0]), double(normal[1]), double(normal[2])});
                for (std::size_t k = 0; k < 9; ++k)
                    integral[k] += basis[k] * double(rgb[0]) * (4 * kPi / (2 * kRings * kRings));
            }
        shgrid_coeffs sum{};
        shgrid_add_direct_(direction, spread, color, &sum);
        for (std::size_t k = 0; k < 9; ++k)
            EXPECT_NEAR(double(sum.c[k][0]), integral[k], 3e-3) << k << ' ' << spread;
    }
}

TEST(NamedLights, LightsOfAnEntityAndItsCoefficientsAreTheSameLight) {
    const NamedGridSH grid = SmallNamedGrid(3);
    const std::vector<std::byte> lump = EncodeNamedGrid(grid);
    shgrid_grid reader;
    ASSERT_EQ(shgrid_parse(lump.data(), lump.size(), &reader), SHGRID_OK);
    std::mt19937 random(2);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int round = 0; round < 100; ++round) {
        const float place[3] = {-64 + 32 * unit(random), 8 + 32 * unit(random), 64 * unit(random)};
        shgrid_coeffs whole;
        shgrid_sample(&reader, place, &whole);
        shgrid_lighting lighting;
        shgrid_lights(&reader, place, nullptr, &lighting);
        EXPECT_GE(lighting.count, 5);
        for (int i = 0; i < lighting.count; ++i) {
            const shgrid_direct &direct = lighting.direct[i];
            shgrid_add_direct_(direct.direction, direct.spread, direct.color, &lighting.rest);
            EXPECT_EQ(direct.style, grid.table.lights[std::size_t(direct.light)].style);
        }
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(lighting.rest.c[k][channel], whole.c[k][channel], 1e-4f);
        float styles[64] = {};
        shgrid_lights(&reader, place, styles, &lighting);
        for (int i = 0; i < lighting.count; ++i)
            EXPECT_EQ(lighting.direct[i].color[0], 0);
    }
    EXPECT_STREQ(shgrid_light_name(&reader, 7), "panel");
    EXPECT_STREQ(shgrid_light_name(&reader, 9), "");
}

TEST(NamedLights, SharesBlendWithZeroWhereAPointDoesNotName) {
    NamedGridSH grid = SmallNamedGrid(0);
    grid.roots = {2, 1, 1}; // the second root names the sun no longer
    grid.nodes.push_back({0, 0, 0, 255, 0, 1, 0, 0});
    for (int i = 0; i < 8; ++i)
        grid.points.emplace_back(), grid.shares.push_back(255);
    grid.names.push_back(0);
    for (std::size_t i = 0; i < 8; ++i)
        grid.shares[9 * i + 6] = 255;
    NumberNamedNodes(grid);
    const std::vector<std::byte> lump = EncodeNamedGrid(grid);
    shgrid_grid reader;
    ASSERT_EQ(shgrid_parse(lump.data(), lump.size(), &reader), SHGRID_OK);
    for (const float fraction : {0.0f, 0.25f, 0.75f, 1.0f}) { // between the last point of root 0 and the first of 1
        const float place[3] = {-48 + 16 * fraction, 8, 0};
        shgrid_lighting lighting;
        shgrid_lights(&reader, place, nullptr, &lighting);
        float sun = 0;
        for (int i = 0; i < lighting.count; ++i)
            if (lighting.direct[i].light == 6)
                sun = lighting.direct[i].color[0];
        EXPECT_NEAR(sun, 1 - fraction, 1e-5f);
    }
}

} // namespace
