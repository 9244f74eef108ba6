// GPL-2.0-or-later. Light of one source at a place by brute force: falloff, cones, random rays to areas. It is summed
// for each normal, and as the exact SH projection, than which no grid is better.
#pragma once

#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/sources/light_sources.h"

#include <array>
#include <cstdint>
#include <random>
#include <vector>

namespace q3::bench {

inline constexpr std::size_t kNormals = 26;
using NormalLight = std::array<Vec3f, kNormals>; ///< light on each of Normals(), 1.0 = byte 255

/// Unit vectors from the center cell of a 3 x 3 x 3 cube to its other cells.
const std::array<Vec3d, kNormals> &Normals();

/// Light from single directions, summed for every normal and as an L2 projection convolved with the cosine.
struct DirectionSum {
    bool forNormals = true; ///< false: the projection only
    std::array<std::array<double, kNormals>, 3> light{};
    std::array<std::array<double, 9>, 3> projection{};
    /// `color` arrives from unit direction `d`, or evenly from everywhere when d is zero.
    void Add(const Vec3d &d, const Vec3d &color);
    DirectionSum &operator+=(const DirectionSum &o);
};

/// Rays end this far in front of an emitter, or half way to its plane. Game units.
inline constexpr double kEmitterGap = 0.125;

/// Falloff and cone of a point light or spotlight at p, byte scale for color 1 1 1.
double PointLightAt(const Light &light, const Vec3d &p);

using Random = std::mt19937_64;
/// Uniform in 0 <= x < 1, the same on every platform.
inline double Unit(Random &random) {
    return double(random() >> 11) * 0x1p-53;
}

/// A triangle of an area light that is small against its distance from the place.
struct AreaPiece {
    const Light *light = nullptr;
    std::array<Vec3d, 3> corners;
    double area = 0;
    Vec3d lift;       ///< offset of ray ends from the emitter
    double bound = 0; ///< estimate of its light on a surface that faces it, byte scale
};

/// Cuts the light into pieces as seen from p. None if p is behind the emitter.
void CutAreaLight(const Light &light, const Vec3d &p, std::vector<AreaPiece> &pieces);

/// Traces rays from one point in packets.
class PointRays {
  public:
    PointRays(const LightScene &scene, const Vec3d &p) : scene_(scene), p_(p) {}
    /// If the way to `target` is clear, adds `color` from `direction` to `sum` and 1 to `clear`; both may be null.
    void Cast(const Vec3d &target, const Vec3d &direction, const Vec3d &color, DirectionSum *sum, int *clear);
    /// Adds the light of a sun to `sum` if its sky is in sight.
    void CastToSky(const Light &sun, DirectionSum &sum);
    /// Traces the rays that wait for a full packet.
    void Flush();
    /// Rays traced so far.
    std::uint64_t Count() const { return counts_.rays; }

  private:
    struct Pending {
        Vec3f target;
        Vec3d direction, color;
        DirectionSum *sum;
        int *clear;
    };
    const LightScene &scene_;
    Vec3d p_;
    std::size_t count_ = 0;
    std::array<Pending, kPacketSize> pending_;
    RayCounts counts_;
};

/// Casts about n stratified random rays to the piece, each with an equal share of its area. Returns their number.
int SamplePiece(const AreaPiece &piece, const Vec3d &p, int n, Random &random, PointRays &rays, DirectionSum *sum,
                int *clear);

} // namespace q3::bench
