// GPL-2.0-or-later. Mapped luxels in blocks, and which lights reach them.
#include "q3map2/lightmap/direct/luxel_blocks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Side of the tiles in which luxels are taken.
constexpr int kTile = 4;
/// Form factors of area lights are taken from up to this much nearer to their plane, see kAreaPush. Game units.
constexpr float kPushReach = 16, kPushHeight = 8;
/// Rounding of spheres. Game units.
constexpr float kSlack = 0.05f;

/// What Reached needs of a light, the same for all blocks.
struct LightReach {
    Vec3f origin, normal, center;
    float dist = 0, envelope = 0;
    bool area = false, oneSided = false, bounded = false;
    float areaRadius = 0, strength = 0, least = 0;

    LightReach(const Light &light, bool pointAreas)
        : origin(light.origin), normal(light.normal), center(light.shape.center), dist(light.dist),
          envelope(light.envelope), area(light.type == LightType::Area), oneSided(!light.twoSided),
          bounded(area && light.fast && !pointAreas), areaRadius(light.shape.radius + kPushReach),
          strength(light.add * light.shape.area / std::numbers::pi_v<float>), least(light.tolerance) {
        // A two-sided light is also seen from 2 units behind.
        envelope += area && light.twoSided ? 2 : 0;
    }
};

struct BlockBalls {
    const float *x, *y, *z, *radius, *nx, *ny, *nz, *thickness;
};

/// keep[i]: -1 if some place of ball i may get light. Of area lights at most strength * cosine / distance^2 arrives.
Q3_VECTOR void KeepBalls(const LightReach &light, bool twoSided, const BlockBalls &balls, std::size_t count,
                         std::int32_t *__restrict keep) {
    const float aside = twoSided ? 1e30f : 0, behind = light.area && light.oneSided ? 1 : 1e30f;
    const float strong = light.bounded ? 0 : 1e30f;
    for (std::size_t i = 0; i < count; ++i) {
        const float r = balls.radius[i];
        const float x = light.origin.x - balls.x[i], y = light.origin.y - balls.y[i], z = light.origin.z - balls.z[i];
        const float d = std::sqrt(x * x + y * y + z * z);
        const float facing = x * balls.nx[i] + y * balls.ny[i] + z * balls.nz[i];
        const float s =
            balls.x[i] * light.normal.x + balls.y[i] * light.normal.y + balls.z[i] * light.normal.z - light.dist;
        const float cx = light.center.x - balls.x[i], cy = light.center.y - balls.y[i],
                    cz = light.center.z - balls.z[i];
        const float near = std::sqrt(cx * cx + cy * cy + cz * cz) - r - light.areaRadius;
        const float height = std::max(std::abs(s) + r + 1, kPushHeight);
        const float most = light.strength * std::min(height, std::max(near, 0.0f)) + strong;
        const std::int32_t faint = Sign(1 - near) & Sign(most - light.least * near * near * near);
        keep[i] = ~(Sign(light.envelope - (d - r)) | Sign(facing + balls.thickness[i] + aside) | Sign(s + r + behind) |
                    faint) >>
                  31;
    }
}

} // namespace

int LuxelBlocks::ClusterSlot(int cluster) {
    const auto found = std::find(clusters_.begin() + 1, clusters_.end(), cluster);
    if (found != clusters_.end())
        return int(found - clusters_.begin());
    clusters_.push_back(cluster);
    return int(clusters_.size()) - 1;
}

void LuxelBlocks::AddLuxel(const RawLightmap &lightmap, std::size_t luxel) {
    if (samples_.empty() || samples_.back().count == kPacketSize) {
        FinishBlock();
        samples_.emplace_back();
        samples_.back().twoSided = lightmap.twoSided;
        luxels_.emplace_back();
    }
    SurfaceReceiverBatch &block = samples_.back();
    luxels_.back()[block.count] = std::uint32_t(luxel);
    slots_[luxel] = std::int32_t((samples_.size() - 1) * kPacketSize + block.count);
    block.Add(lightmap.positions[luxel], lightmap.normals[luxel], lightmap.luxelClusters[luxel]);
}

void LuxelBlocks::FinishBlock() {
    if (samples_.empty())
        return;
    const SurfaceReceiverBatch &block = samples_.back();
    Boundsf box;
    Vec3f normal = block.normal[0];
    for (std::size_t i = 0; i < block.count; ++i) {
        box.Add(block.position[i]);
        if (!(block.normal[i] == block.normal[0]))
            normal = {};
    }
    const Vec3f center = box.Center();
    float radius2 = 0, thickness = 0;
    for (std::size_t i = 0; i < block.count; ++i) {
        const Vec3f out = block.position[i] - center;
        radius2 = std::max(radius2, Dot(out, out));
        thickness = std::max(thickness, std::abs(Dot(out, normal)));
    }
    x_.push_back(center.x), y_.push_back(center.y), z_.push_back(center.z);
    radius_.push_back(std::sqrt(radius2) + kSlack), thickness_.push_back(thickness + kSlack);
    nx_.push_back(normal.x), ny_.push_back(normal.y), nz_.push_back(normal.z);
    clusterSlot_.push_back(block.clusters.count == 1 ? ClusterSlot(block.clusters.number[0]) : 0);
}

void LuxelBlocks::Build(const RawLightmap &lightmap) {
    const int width = lightmap.SuperWidth(), height = lightmap.SuperHeight();
    samples_.clear(), luxels_.clear();
    slots_.assign(std::size_t(width) * std::size_t(height), -1);
    for (auto *row : {&x_, &y_, &z_, &radius_, &nx_, &ny_, &nz_, &thickness_})
        row->clear();
    clusterSlot_.clear();
    clusters_.assign(1, -1);
    for (int tileY = 0; tileY < height; tileY += kTile)
        for (int tileX = 0; tileX < width; tileX += kTile)
            for (int y = tileY; y < std::min(tileY + kTile, height); ++y)
                for (int x = tileX; x < std::min(tileX + kTile, width); ++x)
                    if (lightmap.Mapped(lightmap.SuperIndex(x, y)))
                        AddLuxel(lightmap, lightmap.SuperIndex(x, y));
    FinishBlock();
    const std::size_t padded = (Count() + kPacketSize - 1) / kPacketSize * kPacketSize;
    for (auto *row : {&x_, &y_, &z_, &radius_, &nx_, &ny_, &nz_, &thickness_})
        row->resize(padded);
    keep_.resize(padded);
}

void LuxelBlocks::Reached(const Light &light, const SurfaceLightSettings &settings,
                          std::vector<std::uint32_t> &reached) {
    const bool everywhere = light.type == LightType::Sun && !settings.Occludes(light);
    seen_.assign(clusters_.size(), -1);
    for (std::size_t i = 1; i < clusters_.size(); ++i)
        seen_[i] = everywhere || light.SeenFrom(clusters_[i]) ? -1 : 0;
    if (light.type == LightType::Sun)
        std::fill(keep_.begin(), keep_.end(), -1);
    else
        KeepBalls(
            LightReach(light, settings.pointAreas), Count() > 0 && samples_[0].twoSided,
            {x_.data(), y_.data(), z_.data(), radius_.data(), nx_.data(), ny_.data(), nz_.data(), thickness_.data()},
            keep_.size(), keep_.data());
    for (std::size_t i = 0; i < Count(); ++i)
        if ((keep_[i] & seen_[std::size_t(clusterSlot_[i])]) != 0)
            reached.push_back(std::uint32_t(i));
}

} // namespace q3
