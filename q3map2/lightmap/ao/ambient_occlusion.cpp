// GPL-2.0-or-later. Ambient occlusion at receivers on surfaces: dirt, the sky visibility of floodlight, the open sky.
#include "q3map2/lightmap/ao/ambient_occlusion.h"

#include "libs/math/elementary.h"
#include "libs/math/vec.h"
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Rings of dirt rays by elevation, see HemisphereRings.
constexpr int kDirtElevations = 3;
/// Hits that do not count. Dirt of luxels: nearer than kTouching, and on the luxel's own surfaces nearer than
/// kOwnSurface. Dirt of vertices, and floodlight: nearer than kNearHit. Game units.
constexpr float kTouching = 1.0f / 64, kOwnSurface = 0.5f, kNearHit = 1.5f;
/// A ray enters a solid if the point this far behind its hit is in a solid leaf. Game units.
constexpr float kSolidDepth = 2;
/// Rays start this far behind the receiver, so that they hit surfaces that touch it. Game units.
constexpr float kRayBackoff = 0.1f;
/// Triangles are near if they are within the ray length plus this. Game units.
constexpr float kReachSlack = 1;
/// After a hit that does not count, a ray continues kStep game units behind it. It ends after kMaxPassedHits such hits.
constexpr float kStep = 1.0f / 64;
constexpr int kMaxPassedHits = 8;
/// -dirtmode 1: rays of each receiver besides the normal.
constexpr std::size_t kRandomRays = 48;
/// With more triangles nearby, rays are traced in the scene.
constexpr std::size_t kMaxNearby = 512;
/// Luxels are visited in tiles of kTile x kTile; a task is kTaskBlocks blocks of 16 luxels.
constexpr int kTile = 4;
constexpr std::size_t kTaskBlocks = 64;
/// 2^32 / golden ratio, as in Knuth's multiplicative hashing: keeps the seeds of different lightmaps apart.
constexpr std::uint32_t kSeedStep = 0x9e3779b9u;

/// Tangent frame of each receiver; the normal is the third axis.
struct ReceiverFrames {
    Lanes3 right, up;
};

void SetReceiverFrames(const Lanes3 &normal, ReceiverFrames &frames) {
    Vectorize([&]() Q3_INLINE {
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const float nx = normal.x[i], ny = normal.y[i], nz = normal.z[i];
            // right = normal x z / |normal x z|; where that is 0 / 0, +x, or -x for a normal that points down
            const bool vertical = (nx == 0) & (ny == 0);
            const float length = std::sqrt(nx * nx + ny * ny), divisor = vertical ? 1 : length;
            const float rx = vertical ? (nz < 0 ? -1.0f : 1.0f) : ny / divisor, ry = vertical ? 0 : -nx / divisor;
            // up = right x normal / |right x normal|; +y where the normal is vertical
            const float ux = ry * nz, uy = -rx * nz, uz = rx * ny - ry * nx;
            const float upLength = std::sqrt(ux * ux + uy * uy + uz * uz), upDivisor = upLength > 0 ? upLength : 1;
            frames.right.x[i] = rx, frames.right.y[i] = ry, frames.right.z[i] = 0;
            frames.up.x[i] = vertical ? 0 : ux / upDivisor;
            frames.up.y[i] = vertical ? 1 : uy / upDivisor;
            frames.up.z[i] = vertical ? 0 : uz / upDivisor;
        }
    });
}

/// Rays along right x + up y + normal z, starting kRayBackoff behind the receivers.
void SetDirections(const ReceiverFrames &frames, const OcclusionReceivers &receivers, const Lanes3 &local,
                   RayPacket &rays) {
    Vectorize([&]() Q3_INLINE {
        const Lanes3 &normal = receivers.normal;
        Lanes3 &direction = rays.direction;
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const float x = local.x[i], y = local.y[i], z = local.z[i];
            direction.x[i] = frames.right.x[i] * x + frames.up.x[i] * y + normal.x[i] * z;
            direction.y[i] = frames.right.y[i] * x + frames.up.y[i] * y + normal.y[i] * z;
            direction.z[i] = frames.right.z[i] * x + frames.up.z[i] * y + normal.z[i] * z;
            rays.origin.x[i] = receivers.position.x[i] - direction.x[i] * kRayBackoff;
            rays.origin.y[i] = receivers.position.y[i] - direction.y[i] * kRayBackoff;
            rays.origin.z[i] = receivers.position.z[i] - direction.z[i] * kRayBackoff;
        }
    });
}

/// Wellons' integer hash lowbias32.
std::uint32_t Hash(std::uint32_t x) {
    x ^= x >> 16, x *= 0x7feb352du;
    x ^= x >> 15, x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

/// Direction number `ray`: azimuths are equally spaced, elevations a golden ratio sequence; both are shifted by hashes
/// of the receiver's seed.
Vec3f RandomDirection(std::uint32_t seed, std::size_t ray) {
    constexpr double kUnit = 0x1p-32, kGolden = 0.6180339887498949; // golden ratio - 1
    double azimuth = (double(ray) + 0.5) / double(kRandomRays) + Hash(seed) * kUnit;
    double elevation = double(ray) * kGolden + Hash(seed ^ kSeedStep) * kUnit;
    azimuth = (azimuth - std::floor(azimuth)) * 2 * std::numbers::pi;
    elevation = (elevation - std::floor(elevation)) * kConeDegrees * std::numbers::pi / 180;
    return {float(std::sin(elevation) * std::cos(azimuth)), float(std::sin(elevation) * std::sin(azimuth)),
            float(std::cos(elevation))};
}

/// Fraction of a ray, from the receiver on, that lies behind a hit: 1 - (distance - b) / (length - b), b = kRayBackoff.
/// The divisor is at least kStep, so that it is not 0.
float OccludedFraction(float distance, float length) {
    return 1 - std::max(0.0f, distance - kRayBackoff) / std::max(kStep, length - kRayBackoff);
}

/// Adds the occlusion of hits beyond `certain` and removes their rays from `live`. close: rays with nearer hits, about
/// which the caller decides.
void CullDistant(const LightScene::Blockers &blockers, float certain, const Lanes &length, LaneMask &live,
                 Lanes &occlusion, LaneMask &close) {
    Vectorize([&, certain]() Q3_INLINE {
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const std::int32_t hit = blockers.hit[i], far = hit & (SignBits(certain - blockers.distance[i]) >> 31);
            occlusion[i] += far != 0 ? OccludedFraction(blockers.distance[i], length[i]) : 0;
            live[i] &= ~far;
            close[i] = hit & ~far;
        }
    });
}

bool IsOwnSurface(const OcclusionReceivers &receivers, int surface) {
    return std::find(receivers.surfaces.begin(), receivers.surfaces.end(), surface) != receivers.surfaces.end();
}

/// Whether the ray enters a solid at its hit; false if it leaves one.
bool EntersSolid(const BspSpace &space, const RayPacket &rays, std::size_t ray, float distance) {
    return space.InSolidLeaf(rays.origin[ray] + rays.direction[ray] * (distance + kSolidDepth));
}

Boundsf BoundsOf(const OcclusionReceivers &receivers) {
    Boundsf box;
    for (std::size_t i = 0; i < receivers.count; ++i)
        box.Add(receivers.position[i]);
    return box;
}

/// Selects the triangles that rays of length `reach` from the receivers can hit.
void SelectNear(const OcclusionReceivers &receivers, float reach, const NearTriangles &from, NearTriangles &nearby) {
    const Vec3f normal = receivers.normal[0];
    float lowest = Dot(normal, receivers.position[0]);
    for (std::size_t i = 1; i < receivers.count; ++i) {
        if (!(receivers.normal[i] == normal))
            return nearby.Select(from, BoundsOf(receivers), reach);
        lowest = std::min(lowest, Dot(normal, receivers.position[i]));
    }
    nearby.Select(from, BoundsOf(receivers), reach, normal, lowest - kRayBackoff);
}

} // namespace

/// Traces rays to the first blocker of a kind that counts.
struct AmbientOcclusion::BlockerTracer {
    const LightScene &scene;
    const OcclusionReceivers &receivers;
    const RayPacket &rays;
    LightScene::BlockerKind kind;
    NearTriangles *nearby;
    const Boundsf *bounds; ///< of the rays; null without `nearby`
    float tnear;           ///< hits nearer than this do not count
    float certain;         ///< every hit beyond this distance counts

    /// Removes blocked rays from `live` and adds their OccludedFraction. hitCounts(ray, distance, surface): whether a
    /// hit nearer than `certain` counts. Distances are from ray origins.
    template <typename HitCounts>
    void Run(LaneMask &live, Lanes &occlusion, RayCounts &counts, const HitCounts &hitCounts) const {
        Lanes from; // where each ray continues
        from.fill(tnear);
        LaneMask going = live;
        LightScene::Blockers blockers;
        Outcome outcome = nearby ? nearby->Trace(rays, going, *bounds, tnear, blockers) : Outcome::Undecided;
        for (int hit = 0; hit < kMaxPassedHits; ++hit) {
            if (outcome == Outcome::Undecided)
                TraceInScene(going, from, blockers, counts);
            else
                counts.rays += std::uint64_t(going.Count());
            if (outcome == Outcome::Missed)
                return;
            LaneMask close;
            CullDistant(blockers, certain, rays.distance, live, occlusion, close);
            going = {};
            for (unsigned lanes = close.Bits(); lanes != 0; lanes &= lanes - 1) {
                const auto i = std::size_t(std::countr_zero(lanes));
                const float distance = blockers.distance[i];
                if (hitCounts(i, distance, blockers.surface[i])) {
                    occlusion[i] += OccludedFraction(distance, rays.distance[i]);
                    live[i] = 0;
                } else {
                    from[i] = distance + kStep;
                    going[i] = -1;
                }
            }
            if (!going.Any())
                return;
            if (outcome == Outcome::Traced)
                outcome = nearby->TraceNextHit(rays, going, from, blockers);
        }
    }

  private:
    using Outcome = NearTriangles::Outcome;
    void TraceInScene(const LaneMask &going, const Lanes &from, LightScene::Blockers &blockers,
                      RayCounts &counts) const {
        RayPacket some = rays;
        some.live = going;
        scene.TraceBlockers(some, kind, receivers.receiveShadows, from, blockers, counts);
    }
};

void AmbientOcclusion::AccumulateOcclusion(const OcclusionReceivers &receivers, const RayPacket &rays,
                                           const NearHitRules &rules, Nearby *nearby, Lanes &occlusion,
                                           RayCounts &counts) const {
    LaneMask live = rays.live;
    const Boundsf *const bounds = nearby ? &nearby->rayBounds : nullptr;
    const BlockerTracer solids{scene_, receivers, rays,           rules.solids, nearby ? &nearby->solids : nullptr,
                               bounds, 0,         2 * kRayBackoff};
    solids.Run(live, occlusion, counts, [&](std::size_t ray, float distance, int) {
        // A ray that leaves a solid at the hit started in a wall that the receiver touches.
        return EntersSolid(space_, rays, ray, distance);
    });
    if (!live.Any())
        return;
    const BlockerTracer surfaces{scene_,
                                 receivers,
                                 rays,
                                 LightScene::BlockerKind::Surfaces,
                                 nearby ? &nearby->surfaces : nullptr,
                                 bounds,
                                 rules.minDistance + kRayBackoff,
                                 rules.ownSurface + kRayBackoff};
    surfaces.Run(live, occlusion, counts,
                 [&](std::size_t, float, int surface) { return !IsOwnSurface(receivers, surface); });
}

AmbientOcclusion::AmbientOcclusion(const SurfaceInputs &in)
    : scene_(in.scene), space_(in.space), depth_(in.lightmap.dirtDepth), scale_(in.lightmap.dirtScale),
      gain_(in.lightmap.dirtGain), random_(in.lightmap.dirtRandom),
      dirtDirections_(HemisphereRings(kDirtElevations, kRingAzimuths)),
      floodDirections_(HemisphereRings(kFloodElevations, in.options.lowQuality ? kRingAzimuths / 2 : kRingAzimuths)) {
    if (random_)
        dirtDirections_.assign(kRandomRays, {});
    dirtDirections_.push_back({0, 0, 1});
}

const AmbientOcclusion::Nearby &AmbientOcclusion::AllBlockers() const {
    std::call_once(allBlockersMade_, [&] {
        for (const LightScene::BlockerTriangle &triangle : scene_.BlockerTriangles())
            (triangle.surface < 0 ? allBlockers_.solids : allBlockers_.surfaces).Add(triangle);
    });
    return allBlockers_;
}

void AmbientOcclusion::Dirt(std::span<const OcclusionReceivers> blocks, std::vector<Lanes> &dirt,
                            RayCounts &counts) const {
    // BlockerTriangles are those of shadow group 1.
    const auto mayUseNearby = [](const OcclusionReceivers &receivers) {
        return receivers.receiveShadows == 1 && !receivers.atVertices;
    };
    dirt.resize(blocks.size());
    Boundsf box;
    for (const OcclusionReceivers &receivers : blocks)
        if (mayUseNearby(receivers))
            box.Add(BoundsOf(receivers));
    const float reach = depth_ + kReachSlack;
    Nearby around, nearby;
    if (!box.Empty()) {
        around.solids.Select(AllBlockers().solids, box, reach);
        around.surfaces.Select(AllBlockers().surfaces, box, reach);
    }
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        bool fewNearby = false;
        if (mayUseNearby(blocks[i])) {
            SelectNear(blocks[i], reach, around.solids, nearby.solids);
            SelectNear(blocks[i], reach, around.surfaces, nearby.surfaces);
            fewNearby = nearby.solids.Count() + nearby.surfaces.Count() <= kMaxNearby;
        }
        Dirt(blocks[i], fewNearby ? &nearby : nullptr, dirt[i], counts);
    }
}

void AmbientOcclusion::Dirt(const OcclusionReceivers &receivers, Nearby *nearby, Lanes &dirt, RayCounts &counts) const {
    constexpr auto kSolids = LightScene::BlockerKind::LegacySolids;
    const NearHitRules rules =
        receivers.atVertices ? NearHitRules{kSolids, kNearHit, 0} : NearHitRules{kSolids, kTouching, kOwnSurface};
    ReceiverFrames frames;
    SetReceiverFrames(receivers.normal, frames);
    RayPacket rays;
    rays.distance.fill(depth_ + kRayBackoff);
    for (std::size_t i = 0; i < receivers.count; ++i)
        rays.live[i] = -1;
    if (nearby && nearby->solids.Count() + nearby->surfaces.Count() == 0) {
        dirt.fill(1);
        // As traced: each ray once for solids and once for surfaces.
        counts.rays += 2 * receivers.count * dirtDirections_.size();
        return;
    }
    Lanes occlusion{};
    Lanes3 local{};
    for (std::size_t ray = 0; ray < dirtDirections_.size(); ++ray) {
        if (random_ && ray < kRandomRays)
            for (std::size_t i = 0; i < receivers.count; ++i)
                local.Set(i, RandomDirection(receivers.seed[i], ray));
        else
            local.Fill(dirtDirections_[ray]);
        SetDirections(frames, receivers, local, rays);
        if (nearby)
            nearby->rayBounds = RayBounds(rays);
        AccumulateOcclusion(receivers, rays, rules, nearby, occlusion, counts);
    }
    for (std::size_t i = 0; i < receivers.count; ++i) {
        const float fraction = occlusion[i] / float(dirtDirections_.size());
        const float darkening =
            fraction > 0 ? std::min(1.0f, gain_ == 1 ? fraction : Pow(fraction, gain_)) * scale_ : 0;
        dirt[i] = 1 - std::min(1.0f, darkening);
    }
}

void AmbientOcclusion::SkyVisibility(const OcclusionReceivers &receivers, float distance, Lanes &visibility,
                                     RayCounts &counts, const UseSkyRay &useRay) const {
    ReceiverFrames frames;
    SetReceiverFrames(receivers.normal, frames);
    RayPacket rays;
    rays.distance.fill(distance + kRayBackoff);
    for (std::size_t i = 0; i < receivers.count; ++i)
        rays.live[i] = -1;
    const NearHitRules rules{
        receivers.atVertices ? LightScene::BlockerKind::Solids : LightScene::BlockerKind::LegacySolids, kNearHit, 0};
    Lanes occlusion{};
    Lanes3 local{};
    for (const Vec3f &direction : floodDirections_) {
        local.Fill(direction);
        SetDirections(frames, receivers, local, rays);
        const Lanes before = occlusion;
        AccumulateOcclusion(receivers, rays, rules, nullptr, occlusion, counts);
        if (!useRay)
            continue;
        Lanes fraction;
        for (const std::size_t i : kEachLane)
            fraction[i] = (1 - (occlusion[i] - before[i])) / float(floodDirections_.size());
        useRay(rays.direction, fraction);
    }
    for (std::size_t i = 0; i < receivers.count; ++i)
        visibility[i] = std::clamp(1 - occlusion[i] / float(floodDirections_.size()), 0.0f, 1.0f);
}

void AmbientOcclusion::OpenSky(const OcclusionReceivers &receivers, Lanes3 &sky, RayCounts &counts) const {
    ReceiverFrames frames;
    SetReceiverFrames(receivers.normal, frames);
    std::array<Vec3f, kPacketSize> directions{}; // sums over rays that reach a sky
    Lanes open{};                                // sum of their transmittances
    Lanes3 local{};
    for (const Vec3f &direction : floodDirections_) {
        local.Fill(direction);
        RayPacket rays;
        rays.distance.fill(kSunDistance);
        for (std::size_t i = 0; i < receivers.count; ++i)
            rays.live[i] = -1;
        SetDirections(frames, receivers, local, rays);
        scene_.TraceSurfaceToSky(rays, -1, receivers.receiveShadows, counts);
        for (std::size_t i = 0; i < receivers.count; ++i) {
            if (rays.live[i] == 0)
                continue;
            const float transmittance = rays.tinted ? Luminance(rays.tint[i]) / Luminance({1, 1, 1}) : 1;
            directions[i] += rays.direction[i] * transmittance, open[i] += transmittance;
        }
    }
    for (std::size_t i = 0; i < receivers.count; ++i)
        sky.Set(i, Normalize(directions[i]) * (open[i] / float(floodDirections_.size())));
}

void ForMappedLuxelBatches(const SurfaceInputs &in, SurfaceLight &surfaces,
                           const std::function<bool(const RawLightmap &)> &wants, const LuxelBatchFunction &batch) {
    struct Task {
        std::size_t lightmap, first;
    };
    std::vector<std::vector<std::uint32_t>> luxels(surfaces.lightmaps.size());
    std::vector<Task> tasks;
    for (std::size_t i = 0; i < luxels.size(); ++i) {
        if (!wants(surfaces.lightmaps[i]))
            continue;
        ForMappedLuxelsByTile(surfaces.lightmaps[i], kTile,
                              [&](std::size_t luxel, int, int) { luxels[i].push_back(std::uint32_t(luxel)); });
        for (std::size_t first = 0; first < luxels[i].size(); first += kTaskBlocks * kPacketSize)
            tasks.push_back({i, first});
    }
    in.jobs.For(std::int64_t(tasks.size()), [&](std::int64_t number, int worker) {
        const Task &task = tasks[std::size_t(number)];
        RawLightmap &raw = surfaces.lightmaps[task.lightmap];
        const std::vector<std::uint32_t> &mapped = luxels[task.lightmap];
        const std::size_t end = std::min(mapped.size(), task.first + kTaskBlocks * kPacketSize);
        std::vector<OcclusionReceivers> blocks;
        std::vector<LuxelIndices> numbers;
        for (std::size_t i = task.first; i < end; ++i) {
            if (blocks.empty() || blocks.back().count == kPacketSize) {
                blocks.emplace_back();
                blocks.back().receiveShadows = raw.receiveShadows;
                blocks.back().surfaces = raw.surfaces;
                numbers.emplace_back();
            }
            numbers.back()[blocks.back().count] = mapped[i];
            blocks.back().Add(raw.positions[mapped[i]], raw.normals[mapped[i]],
                              std::uint32_t(task.lightmap) * kSeedStep + mapped[i]);
        }
        batch(raw, blocks, numbers, std::size_t(worker));
    });
}

} // namespace q3
