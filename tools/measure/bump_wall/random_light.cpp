// GPL-2.0-or-later. Errors of the encodings on random lights.
#include "tools/measure/bump_wall/random_light.h"

#include "tools/measure/bump_wall/encodings.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

namespace q3::bump_wall {

namespace {

constexpr std::size_t kLuxels = 20000;
constexpr float kLeastNormalZ = 0.70710678f; // cosine of 45 degrees

/// A kind of light: a number of lamps anywhere above the surface, and the share of the sky in all light.
struct LightKind {
    const char *name;
    int lamps;
    float skyShare;
};
constexpr LightKind kKinds[] = {
    {"one lamp", 1, 0}, {"four lamps", 4, 0}, {"four lamps and sky", 4, 0.5f}, {"sky", 0, 1}};

class RandomLight {
  public:
    float Unit() { return float(random_()) * 0x1p-32f; }
    Vec3f Color() { return {Unit(), Unit(), Unit()}; }
    /// Unit vector with z of `least` to 1, evenly over that cap of the sphere.
    Vec3f Direction(float least) {
        const float z = least + (1 - least) * Unit(), r = std::sqrt(1 - z * z);
        const float turn = 2 * std::numbers::pi_v<float> * Unit();
        return {r * std::cos(turn), r * std::sin(turn), z};
    }
    LocalLight Lights(const LightKind &kind) {
        LocalLight light;
        for (int i = 0; i < kind.lamps; i++)
            light.rays.push_back({Color() * (1 - kind.skyShare), Direction(0)});
        // A lamp gives the flat normal half of its color on average, over directions of the hemisphere. Without lamps
        // the factor is 1.
        light.sky = Color() * (kind.skyShare * 0.5f * float(std::max(kind.lamps, 2)));
        return light;
    }

  private:
    std::mt19937 random_{1};
};

/// Lights and bump normals of all luxels.
struct Sample {
    std::vector<LocalLight> lights;
    std::vector<Vec3f> normals;
};

double RelativeError(const Sample &sample, const EncodedLuxels &luxels, Encoding encoding) {
    double wrong = 0, all = 0;
    for (std::size_t i = 0; i < kLuxels; i++) {
        const Vec3f want = Received(sample.lights[i], sample.normals[i]);
        const Vec3f off = luxels.Decoded(encoding, {{i, i, i, i}, {1, 0, 0, 0}}, sample.normals[i], {}) - want;
        wrong += Dot(off, off);
        all += Dot(want, want);
    }
    return std::sqrt(wrong / all);
}

} // namespace

void PrintErrors() {
    std::vector<Sample> samples;
    std::vector<EncodedLuxels> luxels;
    std::printf("| encoding | bytes");
    for (const LightKind &kind : kKinds) {
        RandomLight random;
        Sample sample;
        for (std::size_t i = 0; i < kLuxels; i++) {
            sample.lights.push_back(random.Lights(kind));
            sample.normals.push_back(random.Direction(kLeastNormalZ));
        }
        luxels.emplace_back(sample.lights);
        samples.push_back(std::move(sample));
        std::printf(" | %s", kind.name);
    }
    std::printf(" |\n|---|---|---|---|---|---|\n");
    for (const EncodingInfo &info : Encodings()) {
        if (info.encoding == Encoding::Ssbump || info.encoding == Encoding::SsbumpRescaled)
            continue;
        std::printf("| %s | %d", info.name, info.bytes);
        for (std::size_t i = 0; i < samples.size(); i++)
            std::printf(" | %.1f %%", 100 * RelativeError(samples[i], luxels[i], info.encoding));
        std::printf(" |\n");
    }
}

} // namespace q3::bump_wall
