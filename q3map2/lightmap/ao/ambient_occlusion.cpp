// GPL-2.0-or-later. How open the surroundings of receivers on surfaces are: dirt and floodlight.
#include "q3map2/lightmap/ao/ambient_occlusion.h"

#include "q3map2/light/batch/hemisphere_rings.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr int kCone = 88; // degrees from the normal
constexpr int kDirtElevations = 3;
/// Dirt of luxels: touching surfaces do not count, nor those that the luxel is on when nearer than the second. Dirt of
/// vertices and floodlight: none does that is nearer than the last. Game units.
constexpr float kTouching = 1.0f / 64, kDirtOwn = 0.5f, kClose = 1.5f;
/// How far behind a hit a solid is looked for. Game units.
constexpr float kBehind = 2;
/// Rays start this far behind their place, so that what touches it is met. Game units.
constexpr float kBack = 0.1f;
/// Triangles count as near when they are no farther off than rays are long and this. Game units.
constexpr float kReachSlack = 1;
/// Rays go on this far behind what does not count, past so many such hits. Game units.
constexpr float kStep = 1.0f / 64;
constexpr int kMostPassed = 8;
constexpr std::size_t kRandomRays = 48;
/// With more triangles nearby, rays go through the scene.
constexpr std::size_t kMostNear = 512;
/// Luxels that one task lights: tiles of this many on a side, in order along rows of tiles.
constexpr int kTile = 4;
constexpr std::size_t kTaskBlocks = 64;
constexpr std::uint32_t kSeedStep = 0x9e3779b9u; // spreads seeds of one lightmap from those of others

/// Axes around each normal.
struct Frames {
    Lanes3 right, up;
};

Q3_VECTOR void SetFrames(const Lanes3 &normal, Frames &frames) {
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float nx = normal.x[i], ny = normal.y[i], nz = normal.z[i];
        // normal x z, or +-x where that is zero
        const bool vertical = (nx == 0) & (ny == 0);
        const float length = std::sqrt(nx * nx + ny * ny), divisor = vertical ? 1 : length;
        const float rx = vertical ? (nz < 0 ? -1.0f : 1.0f) : ny / divisor, ry = vertical ? 0 : -nx / divisor;
        // right x normal, or y
        const float ux = ry * nz, uy = -rx * nz, uz = rx * ny - ry * nx;
        const float upLength = std::sqrt(ux * ux + uy * uy + uz * uz), upDivisor = upLength > 0 ? upLength : 1;
        frames.right.x[i] = rx, frames.right.y[i] = ry, frames.right.z[i] = 0;
        frames.up.x[i] = vertical ? 0 : ux / upDivisor;
        frames.up.y[i] = vertical ? 1 : uy / upDivisor;
        frames.up.z[i] = vertical ? 0 : uz / upDivisor;
    }
}

/// Rays along right x + up y + normal z, from a little behind the receivers.
Q3_VECTOR void SetDirections(const Frames &frames, const OpenReceivers &receivers, const Lanes3 &local,
                             RayPacket &rays) {
    const Lanes3 &normal = receivers.normal;
    Lanes3 &direction = rays.direction;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = local.x[i], y = local.y[i], z = local.z[i];
        direction.x[i] = frames.right.x[i] * x + frames.up.x[i] * y + normal.x[i] * z;
        direction.y[i] = frames.right.y[i] * x + frames.up.y[i] * y + normal.y[i] * z;
        direction.z[i] = frames.right.z[i] * x + frames.up.z[i] * y + normal.z[i] * z;
        rays.origin.x[i] = receivers.position.x[i] - direction.x[i] * kBack;
        rays.origin.y[i] = receivers.position.y[i] - direction.y[i] * kBack;
        rays.origin.z[i] = receivers.position.z[i] - direction.z[i] * kBack;
    }
}

/// The same where all receivers face the same way and take the same direction.
Q3_VECTOR void SetOneDirection(const Frames &frames, const OpenReceivers &receivers, const Vec3f &local,
                               RayPacket &rays) {
    const Vec3f direction = frames.right[0] * local.x + frames.up[0] * local.y + receivers.normal[0] * local.z;
    const Vec3f back = direction * kBack;
    rays.direction.Fill(direction);
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        rays.origin.x[i] = receivers.position.x[i] - back.x;
        rays.origin.y[i] = receivers.position.y[i] - back.y;
        rays.origin.z[i] = receivers.position.z[i] - back.z;
    }
}

std::uint32_t Hash(std::uint32_t x) {
    x ^= x >> 16, x *= 0x7feb352du;
    x ^= x >> 15, x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

/// Direction number `ray` of a place: a low-discrepancy sequence, shifted by the place's seed.
Vec3f RandomDirection(std::uint32_t seed, std::size_t ray) {
    constexpr double kUnit = 1.0 / 4294967296.0, kGolden = 0.6180339887498949; // golden ratio
    double azimuth = (double(ray) + 0.5) / double(kRandomRays) + Hash(seed) * kUnit;
    double elevation = double(ray) * kGolden + Hash(seed ^ kSeedStep) * kUnit;
    azimuth = (azimuth - std::floor(azimuth)) * 2 * std::numbers::pi;
    elevation = (elevation - std::floor(elevation)) * kCone * std::numbers::pi / 180;
    return {float(std::sin(elevation) * std::cos(azimuth)), float(std::sin(elevation) * std::sin(azimuth)),
            float(std::cos(elevation))};
}

/// Share of a ray, from its place on, that lies behind what blocks it.
float ShareBehind(float distance, float length) {
    return 1 - std::max(0.0f, distance - kBack) / std::max(kStep, length - kBack);
}

/// Ends rays that are blocked farther than `sure`; `close`: those that are before.
Q3_VECTOR void CullDistant(const LightScene::Blockers &blockers, float sure, const Lanes &length, LaneMask &live,
                           Lanes &missing, LaneMask &close) {
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const std::int32_t hit = blockers.hit[i], far = hit & (Sign(sure - blockers.distance[i]) >> 31);
        missing[i] += far != 0 ? ShareBehind(blockers.distance[i], length[i]) : 0;
        live[i] &= ~far;
        close[i] = hit & ~far;
    }
}

bool IsOwn(const OpenReceivers &receivers, int surface) {
    return std::find(receivers.surfaces.begin(), receivers.surfaces.end(), surface) != receivers.surfaces.end();
}

/// Whether a ray goes into a solid right behind what it hit.
bool EntersSolid(const BspRegion &space, const RayPacket &rays, std::size_t ray, float distance) {
    return space.InSolidLeaf(rays.origin[ray] + rays.direction[ray] * (distance + kBehind));
}

Boundsf BoundsOf(const OpenReceivers &receivers) {
    Boundsf box;
    for (std::size_t i = 0; i < receivers.count; ++i)
        box.Add(receivers.position[i]);
    return box;
}

/// What EntersSolid asks about where a place touches a wall.
BspRegion TouchedSpace(const BspSpace &space, const OpenReceivers &receivers) {
    constexpr Vec3f kReach = Vec3f{1, 1, 1} * (2 * kBack + kBehind);
    const Boundsf box = BoundsOf(receivers);
    return space.Whole().Around({box.mins - kReach, box.maxs + kReach});
}

/// Beams of rays from receivers that face the same way, in one direction after the other: cheaper than BeamOf.
class FlatBeams {
  public:
    explicit FlatBeams(const OpenReceivers &receivers) {
        for (std::size_t i = 0; i < receivers.count; ++i) {
            starts_.Add(receivers.position[i]);
            flat_ = flat_ && receivers.normal[i] == receivers.normal[0];
        }
    }
    bool Flat() const { return flat_; }
    /// Of rays by SetDirections.
    void Set(const RayPacket &rays, bool oneDirection, RayBeam &beam) const {
        if (!flat_ || !oneDirection) {
            beam = BeamOf(rays);
            return;
        }
        const Vec3f direction = rays.direction[0], back = direction * kBack;
        beam = {starts_.mins - back, starts_.maxs - back, true, direction, rays.distance[0]};
    }

  private:
    Boundsf starts_;
    bool flat_ = true;
};

/// Triangles that rays from the receivers can meet.
void SelectNear(const OpenReceivers &receivers, float reach, const NearTriangles &from, NearTriangles &nearby) {
    const Vec3f normal = receivers.normal[0];
    float lowest = Dot(normal, receivers.position[0]);
    for (std::size_t i = 1; i < receivers.count; ++i) {
        if (!(receivers.normal[i] == normal))
            return nearby.Select(from, BoundsOf(receivers), reach);
        lowest = std::min(lowest, Dot(normal, receivers.position[i]));
    }
    nearby.Select(from, BoundsOf(receivers), reach, normal, lowest - kBack);
}

} // namespace

/// Rays that look for blockers of one kind, past those that do not count.
struct AmbientOcclusion::Walk {
    const LightScene &scene;
    const OpenReceivers &receivers;
    const RayPacket &rays;
    LightScene::BlockerKind kind;
    NearTriangles *nearby;
    const RayBeam *beam;
    float nearest;
    float sure; ///< what is farther than this counts

    /// Ends in `live` the rays that are blocked. counts(ray, distance, what it is) is asked about what is nearer than
    /// `sure`; distances are from where rays start.
    template <typename Counts> void Run(LaneMask &live, Lanes &missing, RayCounts &work, const Counts &counts) const {
        Lanes from;
        from.fill(nearest);
        LaneMask going = live;
        LightScene::Blockers blockers;
        Outcome outcome = nearby ? nearby->Trace(rays, going, *beam, nearest, blockers) : Outcome::Undecided;
        for (int hit = 0; hit < kMostPassed; ++hit) {
            if (outcome == Outcome::Undecided)
                TraceInScene(going, from, blockers, work);
            else
                work.rays += std::uint64_t(going.Count());
            if (outcome == Outcome::Missed)
                return;
            LaneMask close;
            CullDistant(blockers, sure, rays.distance, live, missing, close);
            going = {};
            for (unsigned lanes = close.Bits(); lanes != 0; lanes &= lanes - 1) {
                const auto i = std::size_t(std::countr_zero(lanes));
                const float distance = blockers.distance[i];
                if (counts(i, distance, blockers.surface[i])) {
                    missing[i] += ShareBehind(distance, rays.distance[i]);
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
    void TraceInScene(const LaneMask &going, const Lanes &from, LightScene::Blockers &blockers, RayCounts &work) const {
        RayPacket some = rays;
        some.live = going;
        scene.TraceBlockers(some, kind, receivers.receiveShadows, from, blockers, work);
    }
};

void AmbientOcclusion::Gather(const OpenReceivers &receivers, const RayPacket &rays, const CloseRules &rules,
                              const BspRegion &space, Nearby *nearby, Lanes &missing, RayCounts &counts) const {
    LaneMask live = rays.live;
    const RayBeam *const beam = nearby ? &nearby->beam : nullptr;
    const Walk solids{scene_, receivers, rays, rules.solids, nearby ? &nearby->solids : nullptr, beam, 0, 2 * kBack};
    solids.Run(live, missing, counts, [&](std::size_t ray, float distance, int) {
        // Rays that leave a wall which the place touches are free.
        return EntersSolid(space, rays, ray, distance);
    });
    if (!live.Any())
        return;
    const Walk surfaces{scene_,
                        receivers,
                        rays,
                        LightScene::BlockerKind::Surfaces,
                        nearby ? &nearby->surfaces : nullptr,
                        beam,
                        rules.nearest + kBack,
                        rules.ownSurface + kBack};
    surfaces.Run(live, missing, counts, [&](std::size_t, float, int surface) { return !IsOwn(receivers, surface); });
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

const AmbientOcclusion::Nearby &AmbientOcclusion::All() const {
    std::call_once(allMade_, [&] {
        for (const LightScene::BlockerTriangle &triangle : scene_.BlockerTriangles())
            (triangle.surface < 0 ? all_.solids : all_.surfaces).Add(triangle);
    });
    return all_;
}

void AmbientOcclusion::Dirt(std::span<const OpenReceivers> blocks, std::vector<Lanes> &dirt, RayCounts &counts) const {
    const auto fits = [](const OpenReceivers &receivers) {
        return receivers.receiveShadows == 1 && !receivers.vertices;
    };
    dirt.resize(blocks.size());
    Boundsf box;
    for (const OpenReceivers &receivers : blocks)
        if (fits(receivers))
            box.Add(BoundsOf(receivers));
    const float reach = depth_ + kReachSlack;
    Nearby around, nearby;
    if (!box.Empty()) {
        around.solids.Select(All().solids, box, reach);
        around.surfaces.Select(All().surfaces, box, reach);
    }
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        bool few = false;
        if (fits(blocks[i])) {
            SelectNear(blocks[i], reach, around.solids, nearby.solids);
            SelectNear(blocks[i], reach, around.surfaces, nearby.surfaces);
            few = nearby.solids.Count() + nearby.surfaces.Count() <= kMostNear;
        }
        Dirt(blocks[i], few ? &nearby : nullptr, dirt[i], counts);
    }
}

void AmbientOcclusion::Dirt(const OpenReceivers &receivers, Nearby *nearby, Lanes &dirt, RayCounts &counts) const {
    constexpr auto kSolids = LightScene::BlockerKind::LegacySolids;
    const CloseRules rules =
        receivers.vertices ? CloseRules{kSolids, kClose, 0} : CloseRules{kSolids, kTouching, kDirtOwn};
    Frames frames;
    SetFrames(receivers.normal, frames);
    RayPacket rays;
    rays.distance.fill(depth_ + kBack);
    for (std::size_t i = 0; i < receivers.count; ++i)
        rays.live[i] = -1;
    if (nearby && nearby->solids.Count() + nearby->surfaces.Count() == 0) {
        dirt.fill(1);
        counts.rays += 2 * receivers.count * dirtDirections_.size();
        return;
    }
    const BspRegion space = TouchedSpace(space_, receivers);
    const FlatBeams beams(receivers);
    Lanes gathered{};
    Lanes3 local{};
    for (std::size_t ray = 0; ray < dirtDirections_.size(); ++ray) {
        const bool differ = random_ && ray < kRandomRays;
        if (!differ && beams.Flat())
            SetOneDirection(frames, receivers, dirtDirections_[ray], rays);
        else {
            if (differ)
                for (std::size_t i = 0; i < receivers.count; ++i)
                    local.Set(i, RandomDirection(receivers.seed[i], ray));
            else
                local.Fill(dirtDirections_[ray]);
            SetDirections(frames, receivers, local, rays);
        }
        if (nearby)
            beams.Set(rays, !differ, nearby->beam);
        Gather(receivers, rays, rules, space, nearby, gathered, counts);
    }
    for (std::size_t i = 0; i < receivers.count; ++i) {
        const float share = gathered[i] / float(dirtDirections_.size());
        const float shut = share > 0 ? std::min(1.0f, gain_ == 1 ? share : std::pow(share, gain_)) * scale_ : 0;
        dirt[i] = 1 - std::min(1.0f, shut);
    }
}

void AmbientOcclusion::SkyVisibility(const OpenReceivers &receivers, float distance, Lanes &open,
                                     RayCounts &counts) const {
    Frames frames;
    SetFrames(receivers.normal, frames);
    RayPacket rays;
    rays.distance.fill(distance + kBack);
    for (std::size_t i = 0; i < receivers.count; ++i)
        rays.live[i] = -1;
    const CloseRules rules{receivers.vertices ? LightScene::BlockerKind::Solids : LightScene::BlockerKind::LegacySolids,
                           kClose, 0};
    const BspRegion space = TouchedSpace(space_, receivers);
    Lanes gathered{};
    Lanes3 local{};
    for (const Vec3f &direction : floodDirections_) {
        local.Fill(direction);
        SetDirections(frames, receivers, local, rays);
        Gather(receivers, rays, rules, space, nullptr, gathered, counts);
    }
    for (std::size_t i = 0; i < receivers.count; ++i)
        open[i] = std::clamp(1 - gathered[i] / float(floodDirections_.size()), 0.0f, 1.0f);
}

FloodSource WorldFlood(const SurfaceInputs &in) {
    if (!in.options.floodlight && !in.world.hasFloodlight)
        return {};
    return {in.world.floodColor * in.world.floodIntensity, in.world.floodDistance};
}

namespace {

/// Mapped luxels in order of tiles, so that neighbours are next to each other.
std::vector<std::uint32_t> MappedLuxels(const RawLightmap &raw) {
    std::vector<std::uint32_t> luxels;
    const int width = raw.SuperWidth(), height = raw.SuperHeight();
    for (int top = 0; top < height; top += kTile)
        for (int left = 0; left < width; left += kTile)
            for (int y = top; y < std::min(top + kTile, height); ++y)
                for (int x = left; x < std::min(left + kTile, width); ++x)
                    if (const std::size_t luxel = raw.SuperIndex(x, y); raw.Mapped(luxel))
                        luxels.push_back(std::uint32_t(luxel));
    return luxels;
}

} // namespace

void ForMappedLuxels(const SurfaceInputs &in, SurfaceLight &surfaces,
                     const std::function<bool(const RawLightmap &)> &wants, const LookAtLuxels &look) {
    struct Task {
        std::size_t lightmap, first;
    };
    std::vector<std::vector<std::uint32_t>> luxels(surfaces.lightmaps.size());
    std::vector<Task> tasks;
    for (std::size_t i = 0; i < luxels.size(); ++i) {
        if (!wants(surfaces.lightmaps[i]))
            continue;
        luxels[i] = MappedLuxels(surfaces.lightmaps[i]);
        for (std::size_t first = 0; first < luxels[i].size(); first += kTaskBlocks * kPacketSize)
            tasks.push_back({i, first});
    }
    in.jobs.For(std::int64_t(tasks.size()), [&](std::int64_t number, int worker) {
        const Task &task = tasks[std::size_t(number)];
        RawLightmap &raw = surfaces.lightmaps[task.lightmap];
        const std::vector<std::uint32_t> &all = luxels[task.lightmap];
        const std::size_t end = std::min(all.size(), task.first + kTaskBlocks * kPacketSize);
        std::vector<OpenReceivers> blocks;
        std::vector<LuxelNumbers> numbers;
        for (std::size_t i = task.first; i < end; ++i) {
            if (blocks.empty() || blocks.back().count == kPacketSize) {
                blocks.emplace_back();
                blocks.back().receiveShadows = raw.receiveShadows;
                blocks.back().surfaces = raw.surfaces;
                numbers.emplace_back();
            }
            numbers.back()[blocks.back().count] = all[i];
            blocks.back().Add(raw.positions[all[i]], raw.normals[all[i]],
                              std::uint32_t(task.lightmap) * kSeedStep + all[i]);
        }
        look(raw, blocks, numbers, std::size_t(worker));
    });
}

} // namespace q3
