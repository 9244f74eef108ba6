// GPL-2.0-or-later. Bounced light at points of the light grids.
#include "q3map2/lightmap/bounce/point_gather.h"

#include "libs/math/low_discrepancy.h"
#include "q3map2/light/batch/ray_batcher.h"

#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Sum of IndirectRay::light over all rays at uniform radiance 1: light is the integral of radiance * cosine / pi, and
/// a ray's light is that on a surface facing it (cosine 1), so the sum is 4 pi / pi.
constexpr float kFacingSum = 4;

} // namespace

void PointGather::Gather(const Vec3f &position, std::uint64_t seed, std::vector<IndirectRay> &rays) const {
    rays.clear();
    auto queue = MakeRayBatcher<Vec3f>([&](RayPacket &packet, std::span<const Vec3f> directions) {
        const auto found = scene_.FirstEmitters(packet, false);
        for (std::size_t i = 0; i < directions.size(); ++i)
            if (Emits(found[i]))
                rays.push_back({directions[i], emission_[found[i]] * (kFacingSum / float(rays_))});
    });
    for (std::uint32_t i = 0; i < std::uint32_t(rays_); ++i) {
        const Sample2 s = PlasticSample(i, seed);
        const double z = 1 - 2 * s.u, radius = std::sqrt(std::max(0.0, 1 - z * z)), angle = 2 * std::numbers::pi * s.v;
        const Vec3f direction{float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(z)};
        queue.Add(direction, position, direction, kRayLength);
    }
    queue.Flush();
    bright_.Gather(position, seed, rays);
}

} // namespace q3
