// GPL-2.0-or-later. Errors of encodings over normals.
#include "tools/measure/directional_error/measure.h"

#include "tools/measure/directional_error/encodings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3::directional {

namespace {

/// Normals within 60 degrees of `n`, uniform over solid angle: a Fibonacci spiral with z from 1 to cos 60 degrees =
/// 0.5.
std::vector<Vec3f> NormalsAround(const Vec3f &n, int count) {
    const Vec3f right = Normalize(Cross(n, std::abs(n.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1}));
    const Vec3f up = Cross(n, right);
    std::vector<Vec3f> normals;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - 0.5 * (i + 0.5) / count, radius = std::sqrt(1 - z * z);
        const double angle = 2 * std::numbers::pi * i / std::numbers::phi;
        normals.push_back(right * float(radius * std::cos(angle)) + up * float(radius * std::sin(angle)) +
                          n * float(z));
    }
    return normals;
}

/// Unit-scale light clamped as on a screen, in units of a byte.
Vec3f Displayed(const Vec3f &light) {
    return Min(Max(light, Vec3f{}), Vec3f{1, 1, 1}) * 255;
}

double SquaredDifference(const Vec3f &a, const Vec3f &b) {
    const Vec3f d = Displayed(a) - Displayed(b);
    return double(Dot(d, d));
}

std::vector<BakeTime> MeasureTimes(const LightSetup &setup, const LightmapOptions &options, const JobPool &jobs,
                                   Log &log) {
    struct Kind {
        std::string name;
        bool deluxe = false, rnm = false, sh = false;
    };
    const Kind kinds[] = {{.name = "flat"},
                          {.name = "deluxe", .deluxe = true},
                          {.name = "RNM", .rnm = true},
                          {.name = "L1 SH", .sh = true},
                          {.name = "RNM and L1 SH", .rnm = true, .sh = true}};
    constexpr int kRepeats = 3; // of which the least time counts
    std::vector<double> least(std::size(kinds), 1e30);
    for (int repeat = 0; repeat < kRepeats; ++repeat)
        for (std::size_t i = 0; i < std::size(kinds); ++i) {
            LightmapOptions measured = options;
            measured.deluxe = kinds[i].deluxe, measured.rnm = kinds[i].rnm, measured.lightmass = kinds[i].sh;
            least[i] = std::min(least[i], LuxelBake(setup, measured, jobs, log).CpuSeconds());
        }
    std::vector<BakeTime> times;
    for (std::size_t i = 0; i < std::size(kinds); ++i)
        times.push_back({kinds[i].name, least[i] / least[0]});
    return times;
}

} // namespace

MapErrors Measure(const LightSetup &setup, const LightmapOptions &given, std::size_t luxels, int normals, int rays,
                  const JobPool &jobs, Log &log) {
    LightmapOptions options = given;
    options.deluxe = options.rnm = options.lightmass = true;
    const LuxelBake bake(setup, options, jobs, log);
    const std::vector<LuxelPlace> places = bake.Sample(luxels);
    std::map<std::size_t, lightmass::Lightmap> encoded;
    const std::vector<LuxelSample> samples = MakeSamples(bake, places, encoded);
    const std::vector<Encoding> encodings = AllEncodings();
    /// Squared differences of displayed light at a luxel.
    struct Sums {
        std::vector<double> overNormals; ///< by encoding: against traced light, summed over normals
        std::vector<double> atOwnNormal; ///< by encoding: against the flat light, at the luxel's normal
        double flatAgainstTraced = 0;
    };
    std::vector<Sums> sums(places.size());
    jobs.For(std::int64_t(places.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        const std::vector<Vec3f> around = NormalsAround(samples[i].normal, normals);
        const std::vector<Vec3f> truth = bake.LightOn(places[i], around, rays);
        const Vec3f traced = bake.LightOn(places[i], {&samples[i].normal, 1}, rays)[0];
        sums[i].flatAgainstTraced = SquaredDifference(samples[i].flat, traced / 255);
        for (const Encoding &encoding : encodings) {
            double overNormals = 0;
            for (std::size_t n = 0; n < around.size(); ++n)
                overNormals += SquaredDifference(encoding.decode(samples[i], around[n]), truth[n] / 255);
            sums[i].overNormals.push_back(overNormals);
            sums[i].atOwnNormal.push_back(
                SquaredDifference(encoding.decode(samples[i], samples[i].normal), samples[i].flat));
        }
    });
    MapErrors errors;
    errors.luxels = places.size();
    for (std::size_t e = 0; e < encodings.size(); ++e) {
        double overNormals = 0, atOwnNormal = 0;
        for (const Sums &one : sums)
            overNormals += one.overNormals[e], atOwnNormal += one.atOwnNormal[e];
        const double count = 3 * std::max(1.0, double(places.size()));
        errors.encodings.push_back({encodings[e].name, encodings[e].bytes,
                                    std::sqrt(overNormals / (count * double(normals))),
                                    std::sqrt(atOwnNormal / count)});
    }
    for (const Sums &one : sums)
        errors.flatAgainstTraced += one.flatAgainstTraced / (3 * std::max(1.0, double(places.size())));
    errors.flatAgainstTraced = std::sqrt(errors.flatAgainstTraced);
    errors.times = MeasureTimes(setup, given, jobs, log);
    return errors;
}

} // namespace q3::directional
