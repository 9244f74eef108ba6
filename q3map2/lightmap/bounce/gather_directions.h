// GPL-2.0-or-later. Directions of gather rays.
#pragma once

#include "libs/math/low_discrepancy.h"
#include "libs/math/vec.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace q3 {

/// Maps a point of the unit square to a direction around +z with density cosine / pi.
inline Vec3f CosineDirection(const Sample2 &s) {
    const double radius = std::sqrt(s.u), angle = 2 * std::numbers::pi * s.v;
    return {float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(std::sqrt(1 - s.u))};
}

/// Cosine-weighted directions for the 16 luxels of a 4 x 4 block, `rays` each. Ray i of each luxel points in
/// about the same direction, so that 16 of them make a coherent packet; the directions of all 16 sets are together
/// evenly distributed.
class GatherDirections {
  public:
    static constexpr int kSets = 16;

    explicit GatherDirections(int rays) : rays_(rays) {
        const double cell = 1 / std::sqrt(double(rays));
        for (int set = 0; set < kSets; ++set) {
            const double u = ((set & 3) - 1.5) / 4 * cell, v = ((set >> 2) - 1.5) / 4 * cell;
            double sum = 0;
            for (int ray = 0; ray < rays; ++ray) {
                const Sample2 s = PlasticSample(std::uint32_t(ray), 0);
                directions_.push_back(CosineDirection({s.u + u - std::floor(s.u + u), s.v + v - std::floor(s.v + v)}));
                sum += 1 / double(directions_.back().z);
            }
            fluenceScales_[std::size_t(set)] = float(2 * rays / sum);
        }
    }
    /// The set of directions of the luxel (x, y).
    static int SetOf(int x, int y) { return (y & 3) * 4 + (x & 3); }

    const Vec3f &At(int set, int ray) const { return directions_[std::size_t(set * rays_ + ray)]; }
    /// The cosine-weighted mean of 1 / z over the hemisphere, which is 2, divided by the mean over the set.
    float FluenceScale(int set) const { return fluenceScales_[std::size_t(set)]; }

  private:
    int rays_;
    std::vector<Vec3f> directions_; // [set][ray]
    std::array<float, kSets> fluenceScales_{};
};

} // namespace q3
