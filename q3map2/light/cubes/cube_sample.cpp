// GPL-2.0-or-later. Ambient cubes at positions of a leaf, and which of them are kept.
#include "q3map2/light/cubes/cube_sample.h"

#include "q3map2/bspfile/bspfile_cubes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace q3 {

namespace {

constexpr float kScreenGamma = 2.2f;
constexpr float kNoDifference = 1e-4f;
constexpr float kFar = std::numeric_limits<float>::max();

float LargestDifference(const CubeSides &a, const CubeSides &b) {
    float largest = 0;
    for (std::size_t side = 0; side < a.size(); ++side) {
        const Vec3f difference = a[side] - b[side];
        largest = std::max(largest, MaxComponent(Max(difference, -difference)));
    }
    return largest;
}

/// Distance of two samples that are told apart by their light more than by their places.
float ColoredDistance(const CubeSample &a, const CubeSample &b) {
    const float m = LargestDifference(a.sides, b.sides);
    return Length(a.position - b.position) * (0.1f + 0.9f * (m < kNoDifference ? 0 : std::min(m, 1.0f)));
}

/// Distances to the nearest two neighbors.
struct Nearest {
    std::size_t sample = 0;
    float first = kFar, second = kFar;
    bool operator<(const Nearest &o) const { return first != o.first ? first < o.first : second < o.second; }
};

/// The largest error with which the samples marked `kept` reproduce the others.
float LargestError(const std::vector<CubeSample> &samples, const std::vector<bool> &kept) {
    std::vector<CubeSample> left;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (kept[i])
            left.push_back(samples[i]);
    float largest = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (!kept[i])
            largest = std::max(largest, ScreenDifference(BlendCubes(left, samples[i].position), samples[i].sides));
    return largest;
}

} // namespace

CubeSample MakeCubeSample(const bspLeaf_t &leaf, const std::array<std::uint8_t, 3> &position, const CubeSides &sides) {
    CubeSample sample;
    sample.stored.position = position;
    sample.position = CubePosition(leaf, sample.stored);
    for (std::size_t side = 0; side < sides.size(); ++side) {
        sample.stored.sides[side] = EncodeRgbExp32(sides[side]);
        sample.sides[side] = DecodeRgbExp32(sample.stored.sides[side]);
    }
    return sample;
}

CubeSides BlendCubes(std::span<const CubeSample> samples, const Vec3f &position) {
    CubeSides sum{};
    float weights = 0;
    for (const CubeSample &sample : samples) {
        const Vec3f way = sample.position - position;
        const float weight = 1 / (Dot(way, way) + 1);
        weights += weight;
        for (std::size_t side = 0; side < sum.size(); ++side)
            sum[side] += sample.sides[side] * weight;
    }
    for (Vec3f &side : sum)
        side = side / weights;
    return sum;
}

float ScreenDifference(const CubeSides &a, const CubeSides &b) {
    const auto shown = [](float light) { return 255 * std::pow(std::max(light, 0.0f), 1 / kScreenGamma); };
    float largest = 0;
    for (std::size_t side = 0; side < a.size(); ++side)
        for (std::size_t channel = 0; channel < 3; ++channel)
            largest = std::max(largest, std::abs(shown(a[side][channel]) - shown(b[side][channel])));
    return largest;
}

void KeepMostDifferent(std::size_t most, std::vector<CubeSample> &samples) {
    const std::size_t count = samples.size();
    if (count <= most)
        return;
    std::vector<float> distance(count * count);
    for (std::size_t a = 0; a < count; ++a)
        for (std::size_t b = a + 1; b < count; ++b)
            distance[a * count + b] = distance[b * count + a] = ColoredDistance(samples[a], samples[b]);
    std::vector<std::size_t> left(count);
    for (std::size_t i = 0; i < count; ++i)
        left[i] = i;
    while (left.size() > most) {
        Nearest nearest;
        for (const std::size_t a : left) {
            Nearest mine{a, kFar, kFar};
            for (const std::size_t b : left)
                if (a != b) {
                    const float d = distance[a * count + b];
                    mine.second = std::min(mine.second, std::max(mine.first, d));
                    mine.first = std::min(mine.first, d);
                }
            nearest = std::min(nearest, mine);
        }
        std::erase(left, nearest.sample);
    }
    std::vector<CubeSample> kept;
    for (const std::size_t i : left)
        kept.push_back(samples[i]);
    samples = std::move(kept);
}

void ThinOutCubes(float tolerance, std::vector<CubeSample> &samples) {
    std::vector<bool> kept(samples.size(), true);
    for (std::size_t left = samples.size(); left > 1; --left) {
        std::size_t best = samples.size();
        float bestError = tolerance;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (!kept[i])
                continue;
            kept[i] = false;
            if (const float error = LargestError(samples, kept);
                error < bestError || (best == samples.size() && error <= tolerance))
                best = i, bestError = error;
            kept[i] = true;
        }
        if (best == samples.size())
            break;
        kept[best] = false;
    }
    std::vector<CubeSample> result;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (kept[i])
            result.push_back(samples[i]);
    samples = std::move(result);
}

} // namespace q3
