// GPL-2.0-or-later. Final gathering of bounced light at luxels, vertices and points of the light grids.
#include "q3map2/lightmap/bounce/bounce_gather.h"

#include "libs/math/sampling.h"
#include "libs/math/vec.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/lightmap/bounce/gather_rays.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

// ---- Final gathering of bounced light at luxels and vertices ----

namespace {

/// Rays per luxel without -bouncerays: by default, under -fast, and the minimum for luxels of a super grid.
constexpr int kRays = 64, kFastRays = 24, kMinRays = 4;
/// Rays per vertex, as a multiple of the rays per luxel.
constexpr int kVertexRayFactor = 4;
/// Above this number of hits, which take 768 MiB, only some are kept.
constexpr std::uint64_t kMaxKeptHits = std::uint64_t(192) << 20;
/// Rays of vertices start this far off their surface, or kMinRayLift where another surface is nearer. Game units.
constexpr float kRayLift = 1, kMinRayLift = 1.0f / 16;

} // namespace

std::uint64_t VertexSeed(const Vec3f &vertex) {
    constexpr float kCell = 1.0f / 8; // game units: more than rounding moves vertices apart
    std::uint64_t seed = 0;
    for (const float x : {vertex.x, vertex.y, vertex.z})
        seed = HashIndex(seed + std::uint64_t(std::int64_t(std::clamp(std::round(x / kCell), -1e9f, 1e9f))));
    return seed;
}

BounceGather::BounceGather(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                           const FaintPatches *patches)
    : scene_(scene), patches_(patches),
      luxelRays_(in.lightmap.bounceRays.value_or(in.options.fast ? kFastRays : kRays)),
      vertexRays_(kVertexRayFactor * in.lightmap.bounceRays.value_or(kRays)), origins_(surfaces.lightmaps.size()),
      rows_(surfaces.lightmaps.size()) {
    std::uint64_t texels = 0;
    for (const RawLightmap &raw : surfaces.lightmaps) {
        const auto isMapped = [](int cluster) { return cluster >= 0; };
        rays_ += std::uint64_t(std::count_if(raw.luxelClusters.begin(), raw.luxelClusters.end(), isMapped)) *
                 std::uint64_t(RaysPerLuxel(raw));
        texels += std::uint64_t(raw.width) * std::uint64_t(raw.height);
    }
    keepAll_ = rays_ <= kMaxKeptHits;
    const auto fewerRays = int(std::clamp(kMaxKeptHits / std::max(texels, std::uint64_t(1)), std::uint64_t(kMinRays),
                                          std::uint64_t(luxelRays_)));
    for (const RawLightmap &raw : surfaces.lightmaps)
        directions_.try_emplace(RaysPerLuxel(raw), RaysPerLuxel(raw));
    if (!keepAll_)
        directions_.try_emplace(fewerRays, fewerRays);
    in.jobs.For(std::int64_t(rows_.size()), [&](std::int64_t i, int) {
        const RawLightmap &raw = surfaces.lightmaps[std::size_t(i)];
        const auto number = std::size_t(i);
        origins_[number] = RayOrigins(in.space, scene, raw);
        rows_[number] = keepAll_ ? TraceRows(number, raw, 1, DirectionsOf(raw))
                                 : TraceRows(number, raw, raw.super, directions_.at(fewerRays));
    });
}

int BounceGather::RaysPerLuxel(const RawLightmap &raw) const {
    return std::max(kMinRays, luxelRays_ / (raw.super * raw.super));
}

struct BounceGather::GatherBatch {
    std::size_t count = 0;
    std::array<std::size_t, kPacketSize> luxels{}, firstHits{};
    std::array<GatherDirections::Choice, kPacketSize> choices{};

    void Add(std::size_t luxel, const GatherDirections::Choice &choice, std::size_t firstHit) {
        luxels[count] = luxel, choices[count] = choice, firstHits[count++] = firstHit;
    }
};

/// A packet holds one ray of each luxel of a block of 4 x 4.
BounceGather::HitRows BounceGather::TraceRows(std::size_t lightmap, const RawLightmap &raw, int stride,
                                              const GatherDirections &directions) const {
    const int rays = directions.Rays(), width = (raw.SuperWidth() + stride - 1) / stride;
    HitRows rows{stride, rays, {}};
    std::vector<std::size_t> first(raw.luxelClusters.size());
    std::size_t used = 0;
    for (int y = 0; y < raw.SuperHeight(); ++y)
        for (int x = 0; x < raw.SuperWidth(); ++x) {
            const std::size_t luxel = raw.SuperIndex(x, y);
            first[luxel] = used;
            used += rows.Has(raw, luxel, x, y) ? std::size_t(rays) : 0;
        }
    rows.hits.resize(used);
    const int side = 4 * stride;
    for (int top = 0; top < raw.SuperHeight(); top += side)
        for (int left = 0; left < raw.SuperWidth(); left += side) {
            GatherBatch batch;
            for (int y = top; y < std::min(top + side, raw.SuperHeight()); ++y)
                for (int x = left; x < std::min(left + side, raw.SuperWidth()); ++x)
                    if (const std::size_t luxel = raw.SuperIndex(x, y); rows.Has(raw, luxel, x, y))
                        batch.Add(luxel, directions.Of(lightmap, x / stride, y / stride, width), first[luxel]);
            if (batch.count > 0)
                TraceBatch(raw, origins_[lightmap], directions, batch, rows);
        }
    return rows;
}

void BounceGather::TraceBatch(const RawLightmap &raw, const std::vector<Vec3f> &origins,
                              const GatherDirections &directions, const GatherBatch &batch, HitRows &rows) const {
    std::vector<GatherFrame> frames;
    RayPacket rays;
    rays.distance.fill(kRayLength);
    for (std::size_t i = 0; i < batch.count; ++i) {
        const std::size_t luxel = batch.luxels[i];
        frames.emplace_back(raw.normals[luxel]);
        rays.origin.Set(i, origins[luxel]);
        rays.live[i] = -1;
    }
    for (int ray = 0; ray < rows.rays; ++ray) {
        for (std::size_t i = 0; i < batch.count; ++i)
            rays.direction.Set(i, frames[i].World(directions.At(batch.choices[i], ray)));
        const auto emitters = scene_.FirstEmitters(rays, RayCoherence::Coherent);
        for (std::size_t i = 0; i < batch.count; ++i) {
            const std::size_t luxel = batch.luxels[i], at = batch.firstHits[i] + std::size_t(ray);
            rows.hits[at] = Dithered(emitters[i], raw.positions[luxel], raw.normals[luxel], raw.twoSided, at);
        }
    }
}

/// The hit, or kNoEmitter if it is dropped. Hits carry no weight, so under -fast one is kept with the probability
/// ContributionFraction. `number` of the hit seeds that choice.
EmitterId BounceGather::Dithered(EmitterId emitter, const Vec3f &position, const Vec3f &normal, bool twoSided,
                                 std::size_t number) const {
    if (!Emits(emitter) || !patches_)
        return emitter;
    const float fraction = patches_->ContributionFraction(emitter, position, normal, twoSided);
    return fraction > UnitFloatFromHash(HashIndex(number)) ? emitter : kNoEmitter;
}

/// Directional channels of one luxel, summed over its rays. Rays are cosine-weighted, so each is a directional light of
/// strength radiosity / cosine: on the luxel's normal it gives the emitter's radiosity.
class BounceGather::ChannelSum {
  public:
    ChannelSum(const RawLightmap &raw, std::size_t luxel, const GatherFrame &frame)
        : raw_(raw), luxel_(luxel), frame_(frame) {
        if (!raw.channels.basis)
            return;
        basis_ = raw.BasisOf(luxel);
        for (Vec3f &normal : basis_)
            normal = frame.Local(normal);
    }
    /// w: direction of the ray in the luxel's frame. light: radiosity of its hit.
    void Add(const Vec3f &w, const Vec3f &light) {
        const Vec3f facing = light / w.z;
        if (raw_.channels.sh) {
            fluence_ += facing;
            for (std::size_t axis = 0; axis < 3; ++axis)
                vector_[axis] += facing * w[axis];
        }
        for (std::size_t i = 0; raw_.channels.basis && i < basis_.size(); ++i)
            onBasis_[i] += facing * std::max(0.0f, Dot(basis_[i], w));
    }
    /// Adds the sums times `scale` to the channels. fluenceScale: as GatherDirections::FluenceScale.
    void AddTo(ChannelImages &channels, float scale, float fluenceScale) const {
        if (raw_.channels.sh) {
            channels[0][luxel_] += fluence_ * (kDirectedSH0 * scale * fluenceScale);
            for (std::size_t c = 0; c < 3; ++c) {
                constexpr std::size_t kAxes[3] = {1, 2, 0}; // the channels of band 1 are y, z, x
                const std::size_t axis = kAxes[c];
                const Vec3f sum =
                    vector_[0] * frame_.right[axis] + vector_[1] * frame_.up[axis] + vector_[2] * frame_.normal[axis];
                channels[1 + c][luxel_] += sum * (kDirectedSH1 * scale);
            }
        }
        for (std::size_t i = 0; raw_.channels.basis && i < onBasis_.size(); ++i)
            channels[raw_.channels.FirstBasis() + i][luxel_] += onBasis_[i] * scale;
    }

  private:
    const RawLightmap &raw_;
    const std::size_t luxel_;
    const GatherFrame &frame_;
    BasisNormals basis_{}; // local
    Vec3f fluence_;
    std::array<Vec3f, 3> vector_{}; // by local axis
    BasisNormals onBasis_{};        // light on each basis normal
};

void BounceGather::GatherLuxels(const Emission &emission, std::size_t lightmap, const RawLightmap &raw,
                                BounceEstimate &estimate, std::span<float> difference) const {
    const HitRows traced = keepAll_ ? HitRows{} : TraceRows(lightmap, raw, 1, DirectionsOf(raw));
    const HitRows &rows = keepAll_ ? rows_[lightmap] : traced;
    const bool deluxe = !estimate.directions.empty(), directional = raw.channels.Any();
    const GatherDirections &directions = DirectionsOf(raw);
    const float fraction = 1 / float(rows.rays);
    const float evenRays = float((rows.rays + 1) / 2), oddRays = float(std::max(1, rows.rays / 2));
    std::size_t next = 0;
    for (std::size_t luxel = 0; luxel < raw.luxelClusters.size(); ++luxel) {
        if (!raw.Mapped(luxel))
            continue;
        const auto x = int(luxel % std::size_t(raw.SuperWidth())), y = int(luxel / std::size_t(raw.SuperWidth()));
        const GatherDirections::Choice choice = directions.Of(lightmap, x, y, raw.SuperWidth());
        const GatherFrame frame(raw.normals[luxel]);
        ChannelSum channels(raw, luxel, frame);
        Vec3f sum, even, direction;
        for (int i = 0; i < rows.rays; ++i) {
            const EmitterId hit = rows.hits[next++];
            if (!Emits(hit))
                continue;
            const Vec3f &from = directions.At(choice, i);
            sum += emission[hit];
            if (i % 2 == 0)
                even += emission[hit];
            if (deluxe)
                direction += frame.World(from) * Luminance(emission[hit]);
            if (directional)
                channels.Add(from, emission[hit]);
        }
        estimate.irradiance[luxel] = sum * fraction;
        difference[luxel] += (Luminance(even) / evenRays - Luminance(sum - even) / oddRays) / 2;
        if (directional)
            channels.AddTo(estimate.channels, fraction, directions.FluenceScale(choice));
        if (deluxe)
            estimate.directions[luxel] = direction * (kDeluxeBounceFraction / 255 * fraction);
    }
}

void BounceGather::GatherTexels(const Emission &emission, std::size_t lightmap, const RawLightmap &raw,
                                std::span<Vec3f> texels) const {
    const HitRows &rows = rows_[lightmap];
    std::vector<float> count(texels.size());
    std::fill(texels.begin(), texels.end(), Vec3f{});
    std::size_t next = 0;
    for (int y = 0; y < raw.SuperHeight(); ++y)
        for (int x = 0; x < raw.SuperWidth(); ++x) {
            const std::size_t luxel = raw.SuperIndex(x, y), texel = raw.Index(x / raw.super, y / raw.super);
            if (!rows.Has(raw, luxel, x, y))
                continue;
            Vec3f sum;
            for (int i = 0; i < rows.rays; ++i)
                if (const EmitterId hit = rows.hits[next++]; Emits(hit))
                    sum += emission[hit];
            texels[texel] += sum;
            count[texel] += float(rows.rays);
        }
    for (std::size_t i = 0; i < texels.size(); ++i)
        if (count[i] > 0)
            texels[i] = texels[i] / count[i];
}

Vec3f BounceGather::VertexRayOrigin(const Vec3f &position, const Vec3f &normal) const {
    RayPacket ahead;
    ahead.Aim(0, position + normal * kMinRayLift, position + normal * kRayLift);
    return position +
           normal * (!Emits(scene_.FirstEmitters(ahead, RayCoherence::Incoherent)[0]) ? kRayLift : kMinRayLift);
}

std::vector<EmitterId> BounceGather::VertexHits(const Vec3f &position, const Vec3f &normal, bool twoSided, int count,
                                                std::uint64_t seed) const {
    const GatherFrame frame(normal);
    const Vec3f start = VertexRayOrigin(position, normal);
    std::vector<EmitterId> hits(std::size_t(count), kNoEmitter);
    auto rays = MakeRayBatcher<std::size_t>([&](RayPacket &packet, std::span<const std::size_t> numbers) {
        const auto found = scene_.FirstEmitters(packet, RayCoherence::Incoherent);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            hits[numbers[i]] = Dithered(found[i], position, normal, twoSided, numbers[i]);
    });
    for (std::size_t i = 0; i < hits.size(); ++i)
        rays.Add(i, start, frame.World(CosineDirection(PlasticSample(std::uint32_t(i), seed))), kRayLength);
    rays.Flush();
    return hits;
}

Vec3f BounceGather::IrradianceAt(const Vec3f &position, const Vec3f &normal, bool twoSided, const Emission &emission,
                                 std::uint64_t seed) const {
    Vec3f sum;
    for (const EmitterId hit : VertexHits(position, normal, twoSided, vertexRays_, seed))
        if (Emits(hit))
            sum += emission[hit];
    return sum / float(vertexRays_);
}

// ---- Bounced light at points of the light grids ----

namespace {

/// Sum of IndirectRay::light over all rays at uniform radiance 1: light is the integral of radiance * cosine / pi, and
/// a ray's light is that on a surface facing it (cosine 1), so the sum is 4 pi / pi.
constexpr float kFacingSum = 4;

} // namespace

void PointGather::Gather(const Vec3f &position, std::uint64_t seed, std::vector<IndirectRay> &rays) const {
    rays.clear();
    auto queue = MakeRayBatcher<Vec3f>([&](RayPacket &packet, std::span<const Vec3f> directions) {
        const auto found = scene_.FirstEmitters(packet, RayCoherence::Incoherent);
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
