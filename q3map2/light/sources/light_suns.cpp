// GPL-2.0-or-later. Suns and sky light.
#include "q3map2/light/sources/light_suns.h"

#include "libs/math/low_discrepancy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr std::uint64_t kSeedSun = 0x53756Eull;
constexpr int kMaxSunSamples = 4096;
constexpr double kRadians = std::numbers::pi / 180;

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
    static constexpr std::array<const char *, 6> kSuffixes = {"_lf", "_rt", "_ft", "_bk", "_up", "_dn"};
    std::vector<SkyProbe> probes;
    for (std::size_t face = 0; face < kSuffixes.size(); ++face) {
        const auto image = library.LoadImage(base + kSuffixes[face]);
        if (!image) {
            log.Warn("sky image", "{}{}: sky image not found, the sky light uses the shader's color", base,
                     kSuffixes[face]);
            return {};
        }
        for (int v = 0; v < kSkyCells; ++v)
            for (int u = 0; u < kSkyCells; ++u) {
                const Vec3f face3 = FaceVector(face, 1 - 2 * float(u) / kSkyCells, 1 - 2 * float(v) / kSkyCells);
                const float length = Length(face3);
                probes.push_back({face3 / length, CellMean(*image, u, v) / length});
            }
    }
    return probes;
}

Vec3f SampleSky(const std::vector<SkyProbe> &probes, const Vec3f &direction, float upperOrLower) {
    Vec3d sum;
    double weight = 0;
    for (const SkyProbe &probe : probes) {
        const float q = Dot(probe.direction, direction);
        if (q <= 0 || probe.direction.z * upperOrLower < 0)
            continue;
        sum += Vec3d(probe.color) * double(q);
        weight += q;
    }
    return weight > 0 ? Vec3f(sum / weight) : Vec3f{};
}

std::vector<Vec3f> SkyDirections(const SkyLightDirective &sky) {
    const double step = 90.0 / sky.iterations;
    const int azimuths = 4 * (sky.iterations - 1);
    const double azimuthStep = 360.0 / azimuths;
    const bool bottom = sky.horizonMin == -90, top = sky.horizonMax == 90;
    const double first = std::min(bottom ? -90 + 1.5 * step : sky.horizonMin + 0.5 * step, double(sky.horizonMax));
    const double last = top ? 90 - 1.5 * step : sky.horizonMax - 0.5 * step;
    const double unclampedFirst = bottom ? -90 + 1.5 * step : sky.horizonMin + 0.5 * step;
    const int rings = int(std::floor(1 + std::max(0.0, (last - unclampedFirst) / step) + 0.5));

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

} // namespace

std::vector<Light> MakeSuns(const SunDirective &sun, int skyIndex, const LightOptions &options) {
    const int samples = std::clamp(sun.samples, 1, kMaxSunSamples);
    const double azimuth = std::atan2(sun.direction.y, sun.direction.x);
    const double elevation = std::asin(std::clamp(double(sun.direction.z), -1.0, 1.0));
    std::vector<Light> lights;
    for (int i = 0; i < samples; ++i) {
        Light light;
        light.type = LightType::Sun;
        light.photons = sun.photons / float(samples) * options.skyScale;
        light.color = sun.color;
        light.style = options.noStyles ? 0 : sun.style;
        light.filterRadius = std::max(0.0f, sun.filterRadius) / float(samples);
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

std::vector<SunDirective> SkyLightSuns(const SkyLightDirective &sky, const ShaderInfo &shader, ShaderLibrary &library,
                                       Log &log) {
    if (sky.value <= 0 || sky.iterations < 2 || sky.horizonMin > sky.horizonMax)
        return {};
    const std::vector<Vec3f> directions = SkyDirections(sky);
    const float photons =
        sky.value / float(directions.size()) * std::max(0.25f, float(sky.horizonMax - sky.horizonMin) / 90);
    std::vector<SkyProbe> probes;
    if (sky.sampleColor && !shader.skyImageBase.empty())
        probes = SkyProbes(shader.skyImageBase, library, log);
    const float half = sky.horizonMin >= 0 ? 1.0f : sky.horizonMax <= 0 ? -1.0f : 0.0f;

    std::vector<SunDirective> suns;
    float brightest = 0;
    for (const Vec3f &direction : directions) {
        const Vec3f color = probes.empty() ? shader.color : SampleSky(probes, direction, half);
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

} // namespace q3
