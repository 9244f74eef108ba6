// GPL-2.0-or-later. Errors of encodings over normals.
#include "tools/measure/directional_error/measure.h"

#include "tools/measure/directional_error/encodings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3::directional {

namespace {

/// Normals within 60 degrees of `n`, uniform over solid angle.
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
        bool deluxe, rnm, sh;
    };
    const Kind kinds[] = {{"flat", false, false, false},
                          {"deluxe", true, false, false},
                          {"RNM", false, true, false},
                          {"L1 SH", false, false, true},
                          {"RNM and L1 SH", false, true, true}};
    constexpr int kRepeats = 3;
    std::vector<double> least(std::size(kinds), 1e30);
    for (int repeat = 0; repeat < kRepeats; ++repeat)
        for (std::size_t i = 0; i < std::size(kinds); ++i) {
            LightmapOptions own = options;
            own.deluxe = kinds[i].deluxe, own.rnm = kinds[i].rnm, own.lightmass = kinds[i].sh;
            least[i] = std::min(least[i], LuxelBake(setup, own, jobs, log).CpuSeconds());
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
    struct Sums {
        std::vector<double> over, atFlat;
        double reference = 0;
    };
    std::vector<Sums> sums(places.size());
    jobs.For(std::int64_t(places.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        const std::vector<Vec3f> around = NormalsAround(samples[i].normal, normals);
        const std::vector<Vec3f> truth = bake.LightOn(places[i], around, rays);
        const Vec3f own = bake.LightOn(places[i], {&samples[i].normal, 1}, rays)[0];
        sums[i].reference = SquaredDifference(samples[i].flat, own / 255);
        for (const Encoding &encoding : encodings) {
            double over = 0;
            for (std::size_t n = 0; n < around.size(); ++n)
                over += SquaredDifference(encoding.decode(samples[i], around[n]), truth[n] / 255);
            sums[i].over.push_back(over);
            sums[i].atFlat.push_back(
                SquaredDifference(encoding.decode(samples[i], samples[i].normal), samples[i].flat));
        }
    });
    MapErrors errors;
    errors.luxels = places.size();
    for (std::size_t e = 0; e < encodings.size(); ++e) {
        double over = 0, atFlat = 0;
        for (const Sums &one : sums)
            over += one.over[e], atFlat += one.atFlat[e];
        const double count = 3 * std::max(1.0, double(places.size()));
        errors.encodings.push_back({encodings[e].name, encodings[e].bytes, std::sqrt(over / (count * double(normals))),
                                    std::sqrt(atFlat / count)});
    }
    for (const Sums &one : sums)
        errors.reference += one.reference / (3 * std::max(1.0, double(places.size())));
    errors.reference = std::sqrt(errors.reference);
    errors.times = MeasureTimes(setup, given, jobs, log);
    return errors;
}

} // namespace q3::directional
