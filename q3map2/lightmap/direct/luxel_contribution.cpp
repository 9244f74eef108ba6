// GPL-2.0-or-later. The light of one source on blocks of 16 luxels, its directional channels, and sums of such light.
#include "q3map2/lightmap/direct/luxel_contribution.h"
#include "libs/math/elementary.h"

#include "q3map2/light/transfer/light_kernel.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

// ---- Mapped luxels of a raw lightmap in blocks of 16 neighbors ----

namespace {

/// Luxels are visited in tiles of kTile x kTile, so that luxels of a block are near each other.
constexpr int kTile = 4;
/// AreaHeights moves receivers up to kAreaPush over or behind the plane of an area light to the height kAreaPush: by at
/// most this. Game units.
constexpr float kMaxPush = 2 * kAreaPush;
/// Added to bounds for rounding. Game units.
constexpr float kSlack = 0.05f;
/// Stands for no limit.
constexpr float kUnlimited = 1e30f;

/// What bounds the light of a source: its envelope, its lit side, and for area lights its strength.
struct LightReach {
    Vec3f origin, normal;
    Vec3f center; ///< of an area light
    float dist = 0, envelope = 0;
    bool area = false, oneSided = false;
    bool endsAtTolerance = false; ///< an area light that leaves out light up to its tolerance
    float areaRadius = 0;         ///< of a sphere around center that holds an area light, plus kMaxPush
    float reachOfPolygon = 0;     ///< how far parts of it that light surfaces may be above the origin. Game units
    float strength = 0;           ///< of an area light: its light at form factor 1, times its area / pi
    float tolerance = 0;

    LightReach(const Light &light, const SurfaceLightSettings &settings)
        : origin(light.origin), normal(light.normal), center(light.shape.center), dist(light.dist),
          envelope(light.envelope), area(light.type == LightType::Area), oneSided(!light.twoSided),
          endsAtTolerance(area && light.endsAtTolerance && !settings.pointAreas),
          areaRadius(light.shape.radius + kMaxPush),
          reachOfPolygon(area && settings.HasSoftShadows() ? ReachOfPolygon(light) : 0),
          strength(light.radiosity * light.shape.area / std::numbers::pi_v<float>), tolerance(light.tolerance) {
        // Rays to the back of a two-sided light end 2 units behind `origin`: both ends are 1 unit off the polygon.
        envelope += area && light.twoSided ? 2 : 0;
    }
};

struct BlockSpheres {
    const float *x, *y, *z, *radius, *nx, *ny, *nz, *thickness;
};

/// mayReach[i]: -1 if a receiver in sphere i may get light: within the envelope, facing it, on its lit side, and for
/// area lights not faint: strength * height / distance^3 >= tolerance, the form factor of a differential area.
void CullBlocks(const LightReach &light, bool twoSided, const BlockSpheres &spheres, std::size_t count,
                std::int32_t *__restrict mayReach) {
    Vectorize([&, twoSided, count]() Q3_INLINE {
        // How far the light may be behind receivers, and receivers behind the light; what is added to its strength.
        const float behindReceiver = twoSided ? kUnlimited : light.reachOfPolygon;
        const float behindLight = light.area && light.oneSided ? kAreaBehind : kUnlimited;
        const float extraStrength = light.endsAtTolerance ? 0 : kUnlimited;
        for (std::size_t i = 0; i < count; ++i) {
            const float r = spheres.radius[i];
            const float x = light.origin.x - spheres.x[i], y = light.origin.y - spheres.y[i],
                        z = light.origin.z - spheres.z[i];
            const float distance = std::sqrt(x * x + y * y + z * z);
            const float facing = x * spheres.nx[i] + y * spheres.ny[i] + z * spheres.nz[i];
            const float signedHeight = // of the sphere's center over the plane of the light
                spheres.x[i] * light.normal.x + spheres.y[i] * light.normal.y + spheres.z[i] * light.normal.z -
                light.dist;
            const float cx = light.center.x - spheres.x[i], cy = light.center.y - spheres.y[i],
                        cz = light.center.z - spheres.z[i];
            const float near = std::sqrt(cx * cx + cy * cy + cz * cz) - r - light.areaRadius;
            // + 1: the polygon is 1 unit behind the plane through the origin.
            const float height = std::max(std::abs(signedHeight) + r + 1, kAreaPush);
            const float most = light.strength * std::min(height, std::max(near, 0.0f)) + extraStrength;
            const std::int32_t faint = SignBits(1 - near) & SignBits(most - light.tolerance * near * near * near);
            mayReach[i] =
                ~(SignBits(light.envelope - (distance - r)) | SignBits(facing + spheres.thickness[i] + behindReceiver) |
                  SignBits(signedHeight + r + behindLight) | faint) >>
                31;
        }
    });
}

} // namespace

void LuxelBlocks::AddLuxel(const RawLightmap &lightmap, const Vec3f &position, std::size_t luxel) {
    if (receivers_.empty() || receivers_.back().count == kPacketSize) {
        FinishBlock();
        receivers_.emplace_back();
        receivers_.back().twoSided = lightmap.twoSided;
        luxels_.emplace_back();
        if (lightmap.channels.basis)
            basis_.emplace_back();
    }
    SurfaceReceiverBatch &block = receivers_.back();
    luxels_.back()[block.count] = std::uint32_t(luxel);
    laneIndices_[luxel] = std::int32_t((receivers_.size() - 1) * kPacketSize + block.count);
    if (lightmap.channels.basis)
        SetLane(block.count, lightmap.BasisOf(luxel), basis_.back());
    block.Add(position, lightmap.normals[luxel], lightmap.luxelClusters[luxel]);
}

void LuxelBlocks::FinishBlock() {
    if (receivers_.empty())
        return;
    const SurfaceReceiverBatch &block = receivers_.back();
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
}

namespace {

/// The place of a luxel, or the nearest one on its surface that clears walls by kClear and is in the same cluster.
Vec3f PlaceOffWalls(const RawLightmap &lightmap, std::size_t luxel, const BspSpace &space) {
    constexpr float kClear = 0.5f, kTries[] = {1, LuxelBlocks::kMostOff}; // game units
    constexpr int kDirections = 8;
    const Vec3f position = lightmap.positions[luxel], normal = lightmap.normals[luxel];
    const Vec3f margin{kClear, kClear, kClear};
    const auto isClear = [&](const Vec3f &p) { return !space.AnySolid(p - margin, p + margin); };
    if (isClear(position))
        return position;
    const Vec3f u = Normalize(Cross(std::abs(normal.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1}, normal));
    const Vec3f v = Cross(normal, u);
    for (const float distance : kTries)
        for (int i = 0; i < kDirections; ++i) {
            const float turn = 2 * std::numbers::pi_v<float> * float(i) / kDirections;
            const Vec3f place = position + (u * Cos(turn) + v * Sin(turn)) * distance;
            if (isClear(place) && space.ClusterAt(place, 0) == lightmap.luxelClusters[luxel])
                return place;
        }
    return position;
}

} // namespace

void LuxelBlocks::Build(const RawLightmap &lightmap) {
    Build(lightmap, nullptr);
}

void LuxelBlocks::BuildOffWalls(const RawLightmap &lightmap, const BspSpace &space) {
    Build(lightmap, &space);
}

void LuxelBlocks::Build(const RawLightmap &lightmap, const BspSpace *space) {
    receivers_.clear(), luxels_.clear(), basis_.clear();
    laneIndices_.assign(lightmap.luxelClusters.size(), -1);
    for (auto *row : {&x_, &y_, &z_, &radius_, &nx_, &ny_, &nz_, &thickness_})
        row->clear();
    ForMappedLuxelsByTile(lightmap, kTile, [&](std::size_t luxel, int, int) {
        AddLuxel(lightmap, space ? PlaceOffWalls(lightmap, luxel, *space) : lightmap.positions[luxel], luxel);
    });
    FinishBlock();
    const std::size_t padded = (Count() + kPacketSize - 1) / kPacketSize * kPacketSize;
    for (auto *row : {&x_, &y_, &z_, &radius_, &nx_, &ny_, &nz_, &thickness_})
        row->resize(padded);
    mayReach_.resize(padded);
}

void LuxelBlocks::FindReached(const Light &light, const SurfaceLightSettings &settings,
                              std::vector<std::uint32_t> &reached) {
    if (light.type == LightType::Sun)
        std::fill(mayReach_.begin(), mayReach_.end(), -1);
    else
        CullBlocks(
            LightReach(light, settings), Count() > 0 && receivers_[0].twoSided,
            {x_.data(), y_.data(), z_.data(), radius_.data(), nx_.data(), ny_.data(), nz_.data(), thickness_.data()},
            mayReach_.size(), mayReach_.data());
    for (std::size_t i = 0; i < Count(); ++i)
        if (mayReach_[i] != 0)
            reached.push_back(std::uint32_t(i));
}

// ---- Directional channels of the light of one source on a block of luxels ----

namespace {

/// amounts = SH channels for a light of color 1 1 1, before the tint.
void ProjectOnSH(const SurfaceIncidentLight &incident, std::array<Lanes, DirectionalChannels::kSH> &amounts) {
    Vectorize([&]() Q3_INLINE {
        const LightDirections &from = incident.directions;
        for (const std::size_t i : kEachLane) {
            const float strength = incident.strength[i];
            const float x = from.vector.x[i], y = from.vector.y[i], z = from.vector.z[i];
            const float fluence = std::sqrt(x * x + y * y + z * z) * from.spread[i];
            amounts[0][i] = strength * (kDirectedSH0 * fluence + kUniformSH0 * from.uniform[i]);
            amounts[1][i] = strength * (kDirectedSH1 * y);
            amounts[2][i] = strength * (kDirectedSH1 * z);
            amounts[3][i] = strength * (kDirectedSH1 * x);
        }
    });
}

/// Irradiance from a sphere that crosses the horizon, divided by its irradiance on a receiver that faces it. sine2:
/// squared sine of its angular radius; cosine: of the angle from the normal to its center, |cosine| < sqrt(sine2).
/// Snyder, Area Light Sources for Real-Time Graphics, 1996.
float SphereAtHorizon(float cosine, float sine2) {
    const float sine = std::sqrt(std::max(1e-12f, 1 - cosine * cosine)), x = std::sqrt(1 / sine2 - 1);
    const float y = std::clamp(-x * cosine / sine, -1.0f, 1.0f), root = sine * std::sqrt(1 - y * y);
    const float sum = (cosine * Acos(y) - x * root) * sine2 + Atan2(root, x);
    return std::max(0.0f, sum / (sine2 * std::numbers::pi_v<float>));
}

/// amount = light on receivers with the given normals for a light of color 1 1 1, before the tint; live lanes only. An
/// area light that crosses the horizon of a receiver counts as a sphere.
void LightOn(const Lanes3 &normal, const SurfaceIncidentLight &incident, Lanes &amount) {
    constexpr float kPointlike = 1e-4f; // squared sine of the angular radius below which a light counts as a point
    const LightDirections &from = incident.directions;
    for (const std::size_t i : kEachLane) {
        if (incident.live[i] == 0)
            continue;
        const float facing = Dot(from.vector[i], normal[i]);
        // A uniform spherical light of angular radius a has spread = 2 pi (1 - cos a) / (pi sin^2 a) = 2 / (1 + cos a).
        const float cosineOfRadius = 2 / from.spread[i] - 1, sine2 = 1 - cosineOfRadius * cosineOfRadius;
        const float length2 = Dot(from.vector[i], from.vector[i]);
        float light = std::max(0.0f, facing);
        if (sine2 > kPointlike && facing * facing < sine2 * length2) {
            const float length = std::sqrt(length2);
            light = length * SphereAtHorizon(facing / length, sine2);
        }
        amount[i] = incident.strength[i] * (light + from.uniform[i]);
    }
}

} // namespace

void SetIncidentColor(const Vec3f &color, const SurfaceIncidentLight &incident, const Lanes &amount, Lanes3 &out) {
    Vectorize([&]() Q3_INLINE {
        const Vec3f c = color;
        for (const std::size_t i : kEachLane) {
            const float light = incident.live[i] != 0 ? amount[i] : 0;
            out.x[i] = light * c.x, out.y[i] = light * c.y, out.z[i] = light * c.z;
        }
        if (!incident.tinted)
            return;
        for (const std::size_t i : kEachLane)
            if (incident.live[i] != 0)
                out.x[i] *= incident.tint.x[i], out.y[i] *= incident.tint.y[i], out.z[i] *= incident.tint.z[i];
    });
}

void SetChannels(const Vec3f &color, const SurfaceIncidentLight &incident, const DirectionalChannels &channels,
                 const BasisLanes *basis, ChannelLanes &out) {
    if (channels.sh) {
        std::array<Lanes, DirectionalChannels::kSH> amounts;
        ProjectOnSH(incident, amounts);
        for (std::size_t c = 0; c < amounts.size(); ++c)
            SetIncidentColor(color, incident, amounts[c], out[c]);
    }
    for (std::size_t i = 0; basis && i < basis->size(); ++i) {
        Lanes amount;
        LightOn((*basis)[i], incident, amount);
        SetIncidentColor(color, incident, amount, out[channels.FirstBasis() + i]);
    }
}

// ---- The light of one source on a block of luxels, and sums of such light ----

namespace {

/// Sets color and direction of incident light. directionScale: length of a direction per unit of light; 0: no
/// directions.
void SetIncidentLight(const Vec3f &color, const SurfaceIncidentLight &from, float directionScale,
                      LuxelIncidentLight &out) {
    Vectorize([&, directionScale]() Q3_INLINE {
        SetIncidentColor(color, from, from.strength, out.color);
        const std::int32_t colored = color.x + color.y + color.z > 0 ? -1 : 0;
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            out.lit[i] = from.live[i] & colored;
            out.filtered[i] = from.strength[i] > 1 ? from.filtered[i] : 0;
        }
        if (directionScale > 0)
            for (std::size_t i = 0; i < kPacketSize; ++i) {
                const float weight =
                    from.live[i] != 0 && from.undirected[i] == 0 ? from.strength[i] * directionScale : 0;
                out.direction.x[i] = weight > 0 ? from.direction.x[i] * weight : 0;
                out.direction.y[i] = weight > 0 ? from.direction.y[i] * weight : 0;
                out.direction.z[i] = weight > 0 ? from.direction.z[i] * weight : 0;
            }
    });
}

} // namespace

LuxelSum &LuxelSums::FindOrAdd(std::size_t slot, float filterRadius, std::size_t blocks) {
    for (std::size_t i = 0; i < used; ++i)
        if (sums[i].slot == slot && sums[i].filterRadius == filterRadius)
            return sums[i];
    if (used == sums.size())
        sums.emplace_back();
    LuxelSum &sum = sums[used++];
    sum.slot = slot, sum.filterRadius = filterRadius;
    sum.color.assign(blocks, {});
    sum.direction.assign(deluxe ? blocks : 0, {});
    sum.channels.assign(directional ? blocks : 0, {});
    return sum;
}

void SetLuxelLight(const LightGroup &group, const LuxelPass &pass, const BasisLanes *basis,
                   const SurfaceIncidentLight &incident, LuxelIncidentLight &out, ChannelLanes &channels) {
    const float scale = pass.deluxe ? DeluxeWeight(group.Color()) * (pass.bounce ? kDeluxeBounceFraction : 1) : 0;
    SetIncidentLight(group.Color(), incident, scale, out);
    if (pass.channels.Any())
        SetChannels(group.Color(), incident, pass.channels, basis, channels);
}

bool LuxelContribution(const LightGroup &group, const LuxelPass &pass, const LightScene &scene,
                       const LuxelReceivers &receivers, LuxelIncidentLight &out, ChannelLanes &channels,
                       ContributionCounts &counts) {
    SurfaceIncidentLight incident;
    GroupContributionToSample(group, pass.settings, scene, receivers.batch, incident, counts);
    if (!incident.live.Any() && !incident.filtered.Any())
        return false;
    SetLuxelLight(group, pass, receivers.basis, incident, out, channels);
    return true;
}

} // namespace q3
