// GPL-2.0-or-later. The lights of a light_environment.
#include "q3map2/light/sources/light_environment.h"

#include "q3map2/light/sources/light_suns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr double kPi = std::numbers::pi;
/// Rings of directions from the horizon to the zenith; the sky below the horizon has as many.
constexpr int kSkyRings = 6;

/// Directions of equal solid angle over a cone around the axis, on a spiral of golden angles: any number of them is
/// well stratified. Turns with the axis around z.
std::vector<Vec3f> ConeDirections(const Vec3f &axis, double halfAngle, int count) {
    if (count == 1)
        return {axis};
    const Vec3d w(axis), aside = std::abs(w.z) < 0.9999 ? Normalize(Cross(Vec3d{0, 0, 1}, w)) : Vec3d{1, 0, 0};
    const Vec3d above = Cross(w, aside);
    const double golden = kPi * (3 - std::sqrt(5.0));
    std::vector<Vec3f> directions;
    for (int i = 0; i < count; ++i) {
        const double cosine = 1 - (1 - std::cos(halfAngle)) * (i + 0.5) / count;
        const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), turn = golden * i;
        directions.push_back(
            Vec3f(Normalize(w * cosine + aside * (sine * std::cos(turn)) + above * (sine * std::sin(turn)))));
    }
    return directions;
}

/// A direction of the sky and the light from there on a surface that faces it.
struct SkyDirection {
    Vec3f direction;
    double light;
};

/// A sky of the same radiance everywhere, whose upper half gives a floor exactly the light 1. A ring is a band of the
/// sphere; its directions are at the middle height of the band, where its mean cosine is exact.
std::vector<SkyDirection> UniformSky() {
    std::vector<SkyDirection> sky;
    for (int ring = 0; ring < kSkyRings; ++ring) {
        const double from = std::sin(kPi / 2 * ring / kSkyRings), to = std::sin(kPi / 2 * (ring + 1) / kSkyRings);
        const double z = (from + to) / 2, aside = std::sqrt(1 - z * z);
        const int count = 4 * std::max(1, int(std::lround(kSkyRings * aside))); // the same light from all four sides
        for (int i = 0; i < count; ++i) {
            const double turn = 2 * kPi * (i + 0.5 * (ring % 2)) / count;
            const double light = 2 * (to - from) / count;
            for (const double side : {1.0, -1.0})
                sky.push_back({Vec3f(Vec3d{aside * std::cos(turn), aside * std::sin(turn), side * z}), light});
        }
    }
    return sky;
}

} // namespace

std::vector<Light> EnvironmentLights(const Environment &environment, const Light &common, const LightOptions &options) {
    std::vector<Light> lights;
    const auto add = [&](const Vec3f &toSky, const Vec3f &color, float photons) {
        const SunDirective sun{.direction = toSky,
                               .color = color,
                               .photons = photons,
                               .filterRadius = common.filterRadius,
                               .style = common.style};
        for (Light &one : MakeSuns(sun, -1, options)) {
            one.name = common.name, one.label = common.label;
            one.grid = common.grid, one.surfaces = common.surfaces;
            lights.push_back(std::move(one));
        }
    };
    if (environment.photons != 0) {
        const int count = environment.spread > 0 ? environment.samples : 1;
        const double halfAngle = double(environment.spread) * kPi / 360;
        for (const Vec3f &toSun : ConeDirections(-environment.direction, halfAngle, count))
            add(toSun, environment.color, environment.photons / float(count));
    }
    if (environment.ambient != 0)
        for (const SkyDirection &one : UniformSky())
            add(one.direction, environment.ambientColor, environment.ambient * float(one.light));
    return lights;
}

} // namespace q3
