// GPL-2.0-or-later. Noise filter for gathered light.
#include "q3map2/lightmap/bounce/bounce_filter.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Luxels on each side of the center of a window. The outermost count half, so that weights add up to 4 on each axis
/// and each of the 4 x 4 sets of GatherDirections has weight 1.
constexpr int kReach = 2, kWindow = 2 * kReach + 1;
constexpr std::array<float, kWindow> kWeights{0.5f, 1, 1, 1, 0.5f};
/// Neighbors have normals within 18 degrees, of which kMinCosine is the cosine, and their height over each other's
/// plane is at most kMaxSlope times their distance.
constexpr float kMinCosine = 0.95f, kMaxSlope = 0.2f;

} // namespace

NoiseFilter::NoiseFilter(const RawLightmap &raw, std::span<const float> luminance, std::span<const float> deviation)
    : raw_(raw), neighbors_(luminance.size()), weights_(luminance.size()), fractions_(luminance.size()) {
    FindNeighbors();
    std::vector<float> noise(luminance.size()), difference(luminance.size());
    for (std::size_t i = 0; i < luminance.size(); ++i)
        if (raw.Mapped(i)) {
            const float d = Mean(i, luminance) - luminance[i];
            // The weight k of a luxel in its own mean is 1 / weights_.
            noise[i] = deviation[i] * deviation[i] * (1 - 1 / weights_[i]);
            difference[i] = d * d;
        }
    for (std::size_t i = 0; i < luminance.size(); ++i)
        if (raw.Mapped(i)) {
            const float meanNoise = Mean<float>(i, noise), meanDifference = Mean<float>(i, difference);
            fractions_[i] = meanNoise >= meanDifference ? 1 : meanNoise / meanDifference;
        }
}

/// Calls use(luxel, bit, weight) for each place of the window around a luxel.
template <typename Use> void NoiseFilter::ForWindow(std::size_t luxel, const Use &use) const {
    const int x = int(luxel % std::size_t(raw_.SuperWidth())), y = int(luxel / std::size_t(raw_.SuperWidth()));
    for (int j = std::max(-kReach, -y); j <= std::min(kReach, raw_.SuperHeight() - 1 - y); ++j)
        for (int i = std::max(-kReach, -x); i <= std::min(kReach, raw_.SuperWidth() - 1 - x); ++i)
            use(raw_.SuperIndex(x + i, y + j), (j + kReach) * kWindow + i + kReach,
                kWeights[std::size_t(i + kReach)] * kWeights[std::size_t(j + kReach)]);
}

void NoiseFilter::FindNeighbors() {
    for (std::size_t luxel = 0; luxel < neighbors_.size(); ++luxel) {
        if (!raw_.Mapped(luxel))
            continue;
        std::uint32_t found = 0, opposite = 0; // bit sets of places: of neighbors, and of those opposite to neighbors
        ForWindow(luxel, [&](std::size_t other, int bit, float) {
            if (AreNeighbors(luxel, other))
                found |= 1u << bit, opposite |= 1u << (kWindow * kWindow - 1 - bit);
        });
        neighbors_[luxel] = found & opposite;
        ForWindow(luxel, [&](std::size_t, int bit, float weight) {
            weights_[luxel] += (neighbors_[luxel] >> bit & 1) != 0 ? weight : 0;
        });
    }
}

bool NoiseFilter::AreNeighbors(std::size_t a, std::size_t b) const {
    if (!raw_.Mapped(b) || Dot(raw_.normals[a], raw_.normals[b]) < kMinCosine)
        return false;
    const Vec3f between = raw_.positions[b] - raw_.positions[a];
    const float most = kMaxSlope * Length(between);
    return std::abs(Dot(between, raw_.normals[a])) <= most && std::abs(Dot(between, raw_.normals[b])) <= most;
}

template <typename T> T NoiseFilter::Mean(std::size_t luxel, std::span<const T> values) const {
    T sum{};
    ForWindow(luxel, [&](std::size_t other, int bit, float weight) {
        if ((neighbors_[luxel] >> bit & 1) != 0)
            sum += values[other] * weight;
    });
    return sum / weights_[luxel];
}

void NoiseFilter::Apply(BounceEstimate &estimate) const {
    const auto filter = [&](std::vector<Vec3f> &values) {
        std::vector<Vec3f> filtered(values);
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (neighbors_[i] == 0)
                continue;
            Vec3f change;
            ForWindow(i, [&](std::size_t other, int bit, float weight) {
                if ((neighbors_[i] >> bit & 1) != 0)
                    change += (values[other] - values[i]) * (weight * std::min(fractions_[i], fractions_[other]));
            });
            filtered[i] += change / weights_[i];
        }
        values = std::move(filtered);
    };
    filter(estimate.irradiance);
    for (std::vector<Vec3f> &channel : estimate.channels)
        filter(channel);
    if (!estimate.directions.empty())
        filter(estimate.directions);
}

} // namespace q3
