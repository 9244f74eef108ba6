// GPL-2.0-or-later. Suns, sky light, and the lights of a light_environment.
#include "q3map2/light/sources/light_suns.h"

#include "libs/math/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace q3 {

// ---- Suns and sky light ----

namespace {

constexpr std::uint64_t kSeedSun = 0x53756Eull; ///< "Sun" in ASCII
constexpr int kMaxSunSamples = 4096;
constexpr double kRadians = std::numbers::pi / 180; ///< per degree

/// Angles in radians.
Vec3f DirectionFromAngles(double azimuth, double elevation) {
    return {float(std::cos(azimuth) * std::cos(elevation)), float(std::sin(azimuth) * std::cos(elevation)),
            float(std::sin(elevation))};
}

/// Offset of sample i, uniform in the disc of that radius.
Sample2 DiscOffset(int i, double radius) {
    const Sample2 s = PlasticSample(std::uint32_t(i), kSeedSun);
    const double r = radius * std::sqrt(s.u), angle = 2 * std::numbers::pi * s.v;
    return {r * std::cos(angle), r * std::sin(angle)};
}

/// Direction through a cell of one of the six sky images, and the cell's mean color.
struct SkyProbe {
    Vec3f direction, color;
};

constexpr int kSkyCells = 64; ///< per side of a sky image

/// Unit-cube vector of a face at a = 1 - 2u, b = 1 - 2v, u and v the fractions along image columns and rows.
Vec3f FaceVector(std::size_t face, float a, float b) {
    switch (face) {
    case 0: // lf
        return {-1, -a, b};
    case 1: // rt
        return {1, a, b};
    case 2: // ft
        return {a, -1, b};
    case 3: // bk
        return {-a, 1, b};
    case 4: // up
        return {-b, a, 1};
    default: // dn
        return {b, a, -1};
    }
}

/// Mean color of cell u, v of a sky image, 0 to 1.
Vec3f CellMean(const Image &image, int u, int v) {
    const auto range = [](int size, int cell) {
        const int first = size * cell / kSkyCells;
        return std::pair(first, std::max(first + 1, size * (cell + 1) / kSkyCells));
    };
    const auto [x0, x1] = range(image.width, u);
    const auto [y0, y1] = range(image.height, v);
    Vec3d sum;
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            const auto texel = image.Texel(x, y);
            sum += Vec3d{double(texel[0]), double(texel[1]), double(texel[2])};
        }
    return Vec3f(sum / (255.0 * (x1 - x0) * (y1 - y0)));
}

/// Probes of all six images, or none when one is missing.
std::vector<SkyProbe> SkyProbes(const std::string &base, ShaderLibrary &library, Log &log) {
    std::vector<SkyProbe> probes;
    for (std::size_t face = 0; face < kSkyImageSides.size(); ++face) {
        const auto image = library.LoadImage(base + kSkyImageSides[face]);
        if (!image) {
            log.Warn("sky image", "{}{}: sky image not found, the sky light uses the shader's color", base,
                     kSkyImageSides[face]);
            return {};
        }
        for (int v = 0; v < kSkyCells; ++v)
            for (int u = 0; u < kSkyCells; ++u) {
                const Vec3f onCube = FaceVector(face, 1 - 2 * float(u) / kSkyCells, 1 - 2 * float(v) / kSkyCells);
                const float length = Length(onCube);
                probes.push_back({onCube / length, CellMean(*image, u, v) / length}); // dimmer towards the corners
            }
    }
    return probes;
}

/// Mean color of the sky around a direction, weighted by the cosine to it.
Vec3f SampleSky(const std::vector<SkyProbe> &probes, const Vec3f &direction) {
    Vec3d sum;
    double weight = 0;
    for (const SkyProbe &probe : probes) {
        const float cosine = Dot(probe.direction, direction);
        if (cosine <= 0)
            continue;
        sum += Vec3d(probe.color) * double(cosine);
        weight += cosine;
    }
    return weight > 0 ? Vec3f(sum / weight) : Vec3f{};
}

/// Directions of a q3map_skyLight, as NetRadiant's q3map2 places them: on rings of equal elevation `step` degrees
/// apart, half a step inside the horizons, each ring turned a little against the last; and a pole where the horizon is
/// one, whose next ring is 1.5 steps away.
std::vector<Vec3f> SkyDirections(const SkyLightDirective &sky) {
    const double step = 90.0 / sky.iterations;
    const int azimuths = 4 * (sky.iterations - 1);
    const double azimuthStep = 360.0 / azimuths;
    const bool bottom = sky.horizonMin == -90, top = sky.horizonMax == 90;
    const double lowest = bottom ? -90 + 1.5 * step : sky.horizonMin + 0.5 * step;
    const double first = std::min(lowest, double(sky.horizonMax));
    const double last = top ? 90 - 1.5 * step : sky.horizonMax - 0.5 * step;
    const int rings = int(std::floor(1 + std::max(0.0, (last - lowest) / step) + 0.5));

    std::vector<Vec3f> directions;
    double elevation = first, azimuth = 0;
    for (int ring = 0; ring < rings; ++ring) {
        for (int i = 0; i < azimuths; ++i, azimuth += azimuthStep)
            directions.push_back(DirectionFromAngles(azimuth * kRadians, elevation * kRadians));
        elevation += step;
        azimuth += azimuthStep / rings;
    }
    if (bottom)
        directions.push_back({0, 0, -1});
    if (top)
        directions.push_back({0, 0, 1});
    return directions;
}

int SampleCount(const SunDirective &sun) {
    return std::clamp(sun.samples, 1, kMaxSunSamples);
}

/// `count` samples of a sun.
std::vector<Light> SunSamples(const SunDirective &sun, int count, int skyIndex, const LightOptions &options) {
    const double azimuth = std::atan2(sun.direction.y, sun.direction.x);
    const double elevation = std::asin(std::clamp(double(sun.direction.z), -1.0, 1.0));
    std::vector<Light> lights;
    for (int i = 0; i < count; ++i) {
        Light light;
        light.type = LightType::Sun;
        light.sample = i;
        light.photons = sun.photons / float(count) * options.skyScale;
        light.color = sun.color;
        light.style = options.noStyles ? 0 : sun.style;
        light.filterRadius = std::max(0.0f, sun.filterRadius) / float(SampleCount(sun));
        light.skyIndex = skyIndex;
        Vec3f direction = sun.direction;
        if (i > 0) {
            const Sample2 offset = DiscOffset(i, sun.deviance);
            direction = DirectionFromAngles(azimuth + offset.u, elevation + offset.v);
        }
        light.origin = direction * kSunDistance;
        light.normal = -direction;
        lights.push_back(light);
    }
    return lights;
}

} // namespace

std::vector<Light> MakeSuns(const SunDirective &sun, int skyIndex, const LightOptions &options) {
    return WithSurfaceSamples(SampleCount(sun), options,
                              [&](int count) { return SunSamples(sun, count, skyIndex, options); });
}

void AddSunOfEntity(const SunDirective &sun, const Light &common, const LightOptions &options,
                    std::vector<Light> &lights) {
    constexpr int kAnySky = -1; // as Light::skyIndex
    for (Light &one : MakeSuns(sun, kAnySky, options)) {
        one.name = common.name, one.label = common.label;
        one.lightsGrid &= common.lightsGrid, one.lightsSurfaces &= common.lightsSurfaces;
        lights.push_back(std::move(one));
    }
}

std::vector<SunDirective> SkyLightSuns(const SkyLightDirective &sky, const ShaderInfo &shader, ShaderLibrary &library,
                                       Log &log) {
    if (sky.value <= 0 || sky.iterations < 2 || sky.horizonMin > sky.horizonMax)
        return {};
    // Light grows with the height of the band of sky that shines, as in NetRadiant's q3map2: `value` for 90
    // degrees.
    constexpr float kLeastBand = 0.25f;
    const std::vector<Vec3f> directions = SkyDirections(sky);
    const float photons =
        sky.value / float(directions.size()) * std::max(kLeastBand, float(sky.horizonMax - sky.horizonMin) / 90);
    std::vector<SkyProbe> probes;
    if (sky.sampleColor && !shader.skyImageBase.empty())
        probes = SkyProbes(shader.skyImageBase, library, log);
    // Suns of one half of the sky take their color from that half alone.
    const float half = sky.horizonMin >= 0 ? 1.0f : sky.horizonMax <= 0 ? -1.0f : 0.0f;
    std::erase_if(probes, [half](const SkyProbe &probe) { return probe.direction.z * half < 0; });

    std::vector<SunDirective> suns;
    float brightest = 0;
    for (const Vec3f &direction : directions) {
        const Vec3f color = probes.empty() ? shader.color : SampleSky(probes, direction);
        brightest = std::max(brightest, MaxComponent(color));
        suns.push_back({.direction = direction,
                        .color = color,
                        .photons = photons,
                        .filterRadius = shader.lightFilterRadius,
                        .style = shader.lightStyle});
    }
    if (!probes.empty() && brightest > 0)
        for (SunDirective &sun : suns)
            sun.color = sun.color / brightest;
    return suns;
}

// ---- The lights of a light_environment ----

namespace {

constexpr double kPi = std::numbers::pi;

/// Rings of directions from the horizon to the zenith; the sky below the horizon has as many.
constexpr int kSkyRings = 6;

/// Directions of equal solid angle over a cone around the axis, turned by the golden angle from one to the next (a
/// Fibonacci lattice): any number of them is well stratified. Turns with the axis around z.
std::vector<Vec3f> ConeDirections(const Vec3f &axis, double halfAngle, int count) {
    if (count == 1)
        return {axis};
    constexpr double kVertical = 0.9999; // cosine to the vertical from which on an axis has no direction aside
    const Vec3d w(axis), aside = std::abs(w.z) < kVertical ? Normalize(Cross(Vec3d{0, 0, 1}, w)) : Vec3d{1, 0, 0};
    const Vec3d above = Cross(w, aside);
    const double goldenAngle = kPi * (3 - std::sqrt(5.0));
    std::vector<Vec3f> directions;
    for (int i = 0; i < count; ++i) {
        const double cosine = 1 - (1 - std::cos(halfAngle)) * (i + 0.5) / count;
        const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), turn = goldenAngle * i;
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

/// A sky of the same radiance everywhere, whose upper half gives a floor exactly the light 1. A ring is the band of the
/// sphere with z in [a, b]; its directions are at z = (a + b) / 2 with the light 2 (b - a), so that it gives a floor
/// b^2 - a^2, the integral of 2 z.
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
    const auto add = [&](const Vec3f &toSky, const Vec3f &color, float photons, int sample, std::vector<Light> &to) {
        const SunDirective sun{.direction = toSky,
                               .color = color,
                               .photons = photons,
                               .filterRadius = common.filterRadius,
                               .style = common.style};
        AddSunOfEntity(sun, common, options, to);
        to.back().sample = sample;
    };
    if (environment.photons != 0) {
        const double halfAngle = double(environment.spread) * kPi / 360; // half of `spread`, radians
        lights = WithSurfaceSamples(environment.spread > 0 ? environment.samples : 1, options, [&](int count) {
            std::vector<Light> samples;
            for (const Vec3f &toSun : ConeDirections(-environment.direction, halfAngle, count))
                add(toSun, environment.color, environment.photons / float(count), int(samples.size()), samples);
            return samples;
        });
    }
    int sample = 0;
    if (environment.ambient != 0)
        for (const SkyDirection &one : UniformSky())
            add(one.direction, environment.ambientColor, environment.ambient * float(one.light), sample++, lights);
    return lights;
}

} // namespace q3
