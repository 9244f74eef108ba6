// GPL-2.0-or-later. Gather rays: their origins at luxels, and their directions.
#pragma once

#include "libs/math/sampling.h"
#include "libs/math/vec.h"
#include "q3map2/lightmap/bounce/bounce_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace q3 {

/// Tangent frame of a receiver.
struct GatherFrame {
    explicit GatherFrame(const Vec3f &n) : normal(n) {
        const Vec3f axis = std::abs(n.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1}; // far from parallel to n
        right = Normalize(Cross(axis, n));
        up = Cross(n, right);
    }
    Vec3f World(const Vec3f &d) const { return right * d.x + up * d.y + normal * d.z; }
    Vec3f Local(const Vec3f &d) const { return {Dot(right, d), Dot(up, d), Dot(normal, d)}; }
    Vec3f normal, right, up;
};

/// Ray origins of a lightmap's mapped luxels, by luxel of the super grid: the luxel's position if it is clear, else a
/// clear place at most half a luxel aside. A place is clear if no solid touches it and few rays from it hit the backs
/// of surfaces. The position of a luxel at the edge of a wall may lie in the plane of the adjacent wall, or behind a
/// curve, though a part of the luxel can be seen.
std::vector<Vec3f> RayOrigins(const BspSpace &space, const BounceScene &scene, const RawLightmap &raw);

/// Maps a point of the unit square to a direction around +z with density cosine / pi.
inline Vec3f CosineDirection(const Sample2 &s) {
    const double radius = std::sqrt(s.u), angle = 2 * std::numbers::pi * s.v;
    return {float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(std::sqrt(1 - s.u))};
}

/// Cosine-weighted directions for the 16 luxels of a 4 x 4 block, `rays` each. Ray i of each luxel points in about the
/// same direction, so that 16 of them make a coherent packet; the directions of all 16 sets together are evenly
/// distributed. If all blocks had the same few directions, these would hit some walls too often and others too rarely,
/// so there are several patterns, shifted against each other, which blocks use in turn.
class GatherDirections {
  public:
    static constexpr int kSets = 16;
    /// Which directions a luxel has.
    struct Choice {
        int pattern = 0, set = 0;
    };

    explicit GatherDirections(int rays) : rays_(rays), patterns_(std::max(1, kPatternRays / rays)) {
        directions_.reserve(std::size_t(patterns_) * kSets * std::size_t(rays));
        for (int pattern = 0; pattern < patterns_; ++pattern)
            for (int set = 0; set < kSets; ++set)
                AddSet({kShiftU * pattern, kShiftV * pattern}, set);
    }
    int Rays() const { return rays_; }
    /// The choice for luxel (x, y) of a lightmap that is `width` luxels wide.
    Choice Of(std::size_t lightmap, int x, int y, int width) const {
        const std::uint64_t blocks = std::uint64_t(y / 4) * std::uint64_t((width + 3) / 4) + std::uint64_t(x / 4);
        return {int((HashIndex(lightmap) + blocks) % std::uint64_t(patterns_)), (y & 3) * 4 + (x & 3)};
    }

    const Vec3f &At(const Choice &choice, int ray) const { return directions_[First(choice) + std::size_t(ray)]; }
    /// The cosine-weighted mean of 1 / z over the hemisphere, which is 2, divided by the mean over the set.
    float FluenceScale(const Choice &choice) const { return fluenceScales_[First(choice) / std::size_t(rays_)]; }

  private:
    /// Rays of all patterns of a set together. With so many rays in one pattern its error is small, so one is enough.
    static constexpr int kPatternRays = 4096;
    /// Shift from pattern to pattern. With the shift of PlasticSample a pattern would repeat points of the last one.
    static constexpr double kShiftU = std::numbers::phi - 1, kShiftV = std::numbers::sqrt2 - 1;

    std::size_t First(const Choice &choice) const {
        return std::size_t(choice.pattern * kSets + choice.set) * std::size_t(rays_);
    }
    void AddSet(const Sample2 &shift, int set) {
        // Set (i, j) of 4 x 4 is shifted to the center of its part of the square cell of a ray, whose area is 1 / rays.
        const double cell = 1 / std::sqrt(double(rays_));
        const double u = shift.u + ((set & 3) - 1.5) / 4 * cell, v = shift.v + ((set >> 2) - 1.5) / 4 * cell;
        double sum = 0;
        for (int ray = 0; ray < rays_; ++ray) {
            const Sample2 s = PlasticSample(std::uint32_t(ray), 0);
            directions_.push_back(CosineDirection({s.u + u - std::floor(s.u + u), s.v + v - std::floor(s.v + v)}));
            sum += 1 / double(directions_.back().z);
        }
        fluenceScales_.push_back(float(2 * rays_ / sum));
    }

    int rays_, patterns_;
    std::vector<Vec3f> directions_;    // [pattern][set][ray]
    std::vector<float> fluenceScales_; // [pattern][set]
};

} // namespace q3
