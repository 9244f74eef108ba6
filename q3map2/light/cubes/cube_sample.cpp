// GPL-2.0-or-later. Ambient cubes at positions in a leaf, and the choice of those to keep.
#include "q3map2/light/cubes/cube_sample.h"

#include "q3map2/bspfile/bspfile_cubes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace q3 {

namespace {

constexpr float kScreenGamma = 2.2f;

/// The 18 values of a sample: 6 sides times RGB.
using CubeNumbers = std::array<float, 18>;

CubeNumbers NumbersOf(const CubeSides &sides) {
    CubeNumbers numbers;
    for (std::size_t side = 0; side < sides.size(); ++side)
        for (std::size_t channel = 0; channel < 3; ++channel)
            numbers[3 * side + channel] = sides[side][channel];
    return numbers;
}

/// Approximation of displayed light: gamma 2, clamped to 1.
float Shown(float light) {
    return std::sqrt(std::min(light, 1.0f));
}

float BlendWeight(const Vec3f &a, const Vec3f &b) {
    const Vec3f way = a - b;
    return 1 / (Dot(way, way) + 1);
}

/// Error of the blend of a growing set of chosen samples at the positions of all samples.
class CubeChoice {
  public:
    explicit CubeChoice(const std::vector<CubeSample> &samples)
        : samples_(samples), sums_(samples.size()), weights_(samples.size()) {
        for (const CubeSample &sample : samples) {
            light_.push_back(NumbersOf(sample.sides));
            CubeNumbers &shown = shown_.emplace_back();
            std::transform(light_.back().begin(), light_.back().end(), shown.begin(), Shown);
        }
    }
    /// Sum of squared differences of shown light if sample k were also chosen; stops summing above `limit`.
    double ErrorWith(std::size_t k, double limit) const {
        double sum = 0;
        for (std::size_t j = 0; j < samples_.size() && sum < limit; ++j) {
            const float weight = BlendWeight(samples_[j].position, samples_[k].position);
            const float scale = 1 / (weights_[j] + weight);
            float squares = 0;
            for (std::size_t i = 0; i < light_[j].size(); ++i) {
                const float difference = Shown((sums_[j][i] + weight * light_[k][i]) * scale) - shown_[j][i];
                squares += difference * difference;
            }
            sum += double(squares);
        }
        return sum;
    }
    void Choose(std::size_t k) {
        for (std::size_t j = 0; j < samples_.size(); ++j) {
            const float weight = BlendWeight(samples_[j].position, samples_[k].position);
            weights_[j] += weight;
            for (std::size_t i = 0; i < light_[j].size(); ++i)
                sums_[j][i] += weight * light_[k][i];
        }
    }

  private:
    const std::vector<CubeSample> &samples_;
    std::vector<CubeNumbers> light_, shown_, sums_; // sums_: at each sample, weighted sum of chosen ones
    std::vector<float> weights_;
};

/// Removes the samples that `kept` does not mark.
void Keep(const std::vector<bool> &kept, std::vector<CubeSample> &samples) {
    std::vector<CubeSample> result;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (kept[i])
            result.push_back(samples[i]);
    samples = std::move(result);
}

/// The largest ScreenDifference between a sample not in `kept` and the blend of the kept ones at its position.
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
        const float weight = BlendWeight(sample.position, position);
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

void KeepBestCubes(std::size_t most, std::vector<CubeSample> &samples) {
    if (samples.size() <= most)
        return;
    CubeChoice choice(samples);
    std::vector<bool> chosen(samples.size());
    double error = std::numeric_limits<double>::infinity();
    for (std::size_t step = 0; step < most; ++step) {
        std::size_t best = samples.size();
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (!chosen[k])
                if (const double with = choice.ErrorWith(k, error); with < error)
                    best = k, error = with;
        if (best == samples.size())
            break;
        choice.Choose(best);
        chosen[best] = true;
    }
    Keep(chosen, samples);
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
    Keep(kept, samples);
}

} // namespace q3
