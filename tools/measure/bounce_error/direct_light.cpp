// GPL-2.0-or-later. Direct light of a map at any point of a surface, by the rules of the light stage.
#include "tools/measure/bounce_error/direct_light.h"

#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/transfer/light_kernel.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <shared_mutex>
#include <unordered_map>

namespace q3::bounce {

namespace {

/// Bounds of IsOnEmitter: distance in game units, and cosine.
constexpr float kOwnSide = 3, kOwnCosine = 0.9f;
/// Shadow rays to the back of a two-sided area light end this far behind its origin, which is 1 unit in front of it: 1
/// unit behind the polygon. Game units.
constexpr float kOriginToBack = 2;

/// Light `add` along the way to `target`, times the light's color; none if it is too faint.
UnshadowedLight Colored(const Light &light, const SurfacePoint &at, float add, const Vec3f &target) {
    const float least = light.endsAtTolerance && light.type != LightType::Sun ? light.tolerance : 0;
    if (!(add > least))
        return {};
    const Vec3f way = target - at.position;
    const float distance = Length(way);
    return {light.color * (light.negative ? -add : add), distance > 0 ? way / distance : Vec3f{}, distance, &light};
}

UnshadowedLight SunAt(const Light &light, const SurfacePoint &at) {
    const float cosine = -Dot(light.normal, at.normal), add = light.photons * (at.twoSided ? std::abs(cosine) : cosine);
    if (!(add > 0))
        return {};
    return {light.color * (light.negative ? -add : add), -light.normal, kSunDistance, &light};
}

UnshadowedLight AreaAt(const Light &light, const SurfacePoint &at) {
    const float height = Dot(at.position, light.normal) - light.dist;
    if ((!light.twoSided && height < -kAreaBehind) || IsOnEmitter(light, at))
        return {};
    const Vec3f pushed = std::abs(height) < kAreaPush ? at.position + light.normal * (kAreaPush - height) : at.position;
    const double factor = FormFactor(Vec3d(pushed), Vec3d(at.normal), light.polygon);
    if (factor >= 0)
        return Colored(light, at, float(factor) * light.radiosity, light.origin);
    if (!at.twoSided && !light.twoSided)
        return {};
    UnshadowedLight back = Colored(light, at, float(-factor) * light.radiosity, OriginToward(light, true));
    return back.distance < light.envelope ? back : UnshadowedLight{};
}

} // namespace

bool IsOnEmitter(const Light &light, const SurfacePoint &at) {
    const float height = Dot(at.position, light.normal) - light.dist;
    return std::abs(height) < kOwnSide && Dot(at.normal, light.normal) > kOwnCosine;
}

Vec3f OriginToward(const Light &light, bool behind) {
    return behind ? light.origin - light.normal * kOriginToBack : light.origin;
}

UnshadowedLight LightWithoutShadow(const Light &light, const SurfacePoint &at) {
    if (at.cluster >= 0 && !light.SeenFrom(at.cluster))
        return {};
    if (light.type == LightType::Sun)
        return SunAt(light, at);
    const Vec3f way = light.origin - at.position;
    const float distance = Length(way), cosine = distance > 0 ? Dot(way, at.normal) / distance : 0;
    if (distance >= light.envelope || (cosine < 0 && !at.twoSided))
        return {};
    if (light.type == LightType::Area)
        return AreaAt(light, at);
    float angle = light.angleAttenuation ? std::abs(cosine) : 1;
    if (light.angleScale != 0)
        angle = std::min(1.0f, angle / light.angleScale);
    float add = Falloff(light).At(distance, angle);
    if (light.type == LightType::Spot)
        add *= ConeFraction(light, way);
    return Colored(light, at, add, light.origin);
}

Vec3f ArrivingLight(const LightScene &scene, const UnshadowedLight &one, const SurfacePoint &at, RayCounts &counts) {
    RayPacket rays;
    rays.Set(0, at.position, one.direction, one.distance);
    if (one.light->type == LightType::Sun)
        scene.TraceSurfaceToSky(rays, one.light->skyIndex, at.receiveShadows, counts);
    else
        scene.TraceSurfaceToLight(rays, at.receiveShadows, counts);
    if (rays.live[0] == 0)
        return {};
    return rays.tinted ? one.color * rays.tint[0] : one.color;
}

namespace {

/// Side of the cells that share a list of lights. Game units.
constexpr float kCellSide = 32;
/// Radius of a cell's bounding sphere, half its diagonal: sqrt(3) / 2 times the side, rounded up.
constexpr float kCellRadius = 0.87f * kCellSide;
/// Facings of receivers, which have lists of their own: by the axis nearest to the normal and its sign, or two-sided.
constexpr int kFacings = 7, kTwoSidedFacing = 6;
/// The largest angle between a normal and the nearest axis: acos(1 / sqrt(3)).
constexpr float kFacingAngle = 0.9553166f;
/// Share of the uniform density in the density of candidates.
constexpr double kUniformShare = 0.05;
/// Candidates of a sample.
constexpr int kCandidates = 12;

int FacingOf(const SurfacePoint &at) {
    if (at.twoSided)
        return kTwoSidedFacing;
    int best = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (std::abs(at.normal[std::size_t(axis)]) > std::abs(at.normal[std::size_t(best)]))
            best = axis;
    return 2 * best + (at.normal[std::size_t(best)] < 0);
}

/// Upper bound of the cosine of incidence over the normals of a facing and directions within `spread` radians of u
/// (unit, to the light).
float BoundOfCosine(int facing, const Vec3f &u, float spread) {
    if (facing == kTwoSidedFacing)
        return 1;
    const float cosine = u[std::size_t(facing / 2)] * (facing % 2 == 0 ? 1.0f : -1.0f);
    const float angle = std::acos(std::clamp(cosine, -1.0f, 1.0f)) - kFacingAngle - spread;
    constexpr float kRightAngle = 1.5707964f; // pi / 2
    return angle <= 0 ? 1 : std::max(0.0f, std::cos(std::min(angle, kRightAngle)));
}

/// Approximate upper bound of the light that receivers in the cell around `center` get, summed over channels. Byte
/// scale.
double BoundAt(const Light &light, const Vec3f &center, int facing) {
    const double color =
        double(std::abs(light.color.x)) + double(std::abs(light.color.y)) + double(std::abs(light.color.z));
    if (light.type == LightType::Sun)
        return color * double(light.photons * BoundOfCosine(facing, -light.normal, 0));
    constexpr float kLeastDistance = 0.3f * kCellRadius; // chosen: keeps the bound finite for lights within the cell
    constexpr float kAllDirections = 1.6f;               // radians, over pi / 2: the light may lie on any side
    const bool area = light.type == LightType::Area;
    const float reach = kCellRadius + (area ? light.shape.radius : 0);
    const Vec3f way = light.origin - center;
    const float distance = Length(way), near = std::max(distance - kCellRadius, kLeastDistance);
    if (distance - kCellRadius > light.envelope)
        return 0;
    const float spread = distance > reach ? std::asin(reach / distance) : kAllDirections;
    const float cosine = distance > 0 ? BoundOfCosine(facing, way / distance, spread) : 1;
    if (!area)
        return color * double(std::max(0.0f, Falloff(light).At(
                                                 near, light.angleAttenuation && light.angleScale == 0 ? cosine : 1)));
    const float height = Dot(center, light.normal) - light.dist;
    if (!light.twoSided && height < -kCellRadius)
        return 0;
    // Form factor of a small light: area times its own cosine over pi r^2, with the cosine height / r.
    const float facingLight = std::min(1.0f, (std::max(std::abs(height), kAreaPush) + kCellRadius) / near);
    const float share = std::min(1.0f, light.shape.area * facingLight / (std::numbers::pi_v<float> * near * near));
    return color * double(light.radiosity * share * cosine);
}

/// The lights of a cell with their cumulative distribution.
struct LightList {
    std::vector<std::uint32_t> lights;
    std::vector<double> cumulative;
};

/// Key of the list of a cell, and the cell's coordinates in steps of kCellSide; 14 bits of each are in the key.
std::uint64_t CellKey(const SurfacePoint &at, std::array<int, 3> &cell, int facing) {
    constexpr int kCoordinateBits = 14;
    std::uint64_t key = std::uint64_t(at.cluster + 1) * kFacings + std::uint64_t(facing);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        cell[axis] = int(std::floor(at.position[axis] / kCellSide));
        key = key << kCoordinateBits | std::uint64_t(cell[axis] & ((1 << kCoordinateBits) - 1));
    }
    return key;
}

/// Sum of the absolute channels.
double Amount(const UnshadowedLight &one) {
    return double(std::abs(one.color.x)) + double(std::abs(one.color.y)) + double(std::abs(one.color.z));
}

} // namespace

/// Lists by cell, cluster and facing, made on first use.
struct DirectLights::Cells {
    static constexpr std::size_t kShards = 64; // with locks of their own, so that threads rarely wait
    struct Shard {
        std::shared_mutex lock;
        std::unordered_map<std::uint64_t, std::unique_ptr<LightList>> lists;
    };
    std::array<Shard, kShards> shards;

    const LightList &ListAt(const std::vector<Light> &lights, const SurfacePoint &at);
    static std::unique_ptr<LightList> MakeList(const std::vector<Light> &lights, int cluster, const Vec3f &center,
                                               int facing);
};

std::unique_ptr<LightList> DirectLights::Cells::MakeList(const std::vector<Light> &lights, int cluster,
                                                         const Vec3f &center, int facing) {
    auto list = std::make_unique<LightList>();
    double sum = 0;
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (cluster < 0 || lights[i].SeenFrom(cluster)) {
            list->lights.push_back(std::uint32_t(i));
            list->cumulative.push_back(sum += BoundAt(lights[i], center, facing));
        }
    const double count = double(list->lights.size()), bounded = sum > 0 ? 1 - kUniformShare : 0;
    for (std::size_t i = 0; i < list->lights.size(); ++i)
        list->cumulative[i] =
            (sum > 0 ? list->cumulative[i] / sum * bounded : 0) + (1 - bounded) * double(i + 1) / count;
    return list;
}

const LightList &DirectLights::Cells::ListAt(const std::vector<Light> &lights, const SurfacePoint &at) {
    const int facing = FacingOf(at);
    std::array<int, 3> cell{};
    const std::uint64_t key = CellKey(at, cell, facing);
    Shard &shard = shards[HashIndex(key) % kShards];
    {
        const std::shared_lock reading(shard.lock);
        if (const auto found = shard.lists.find(key); found != shard.lists.end())
            return *found->second;
    }
    const Vec3f center{(float(cell[0]) + 0.5f) * kCellSide, (float(cell[1]) + 0.5f) * kCellSide,
                       (float(cell[2]) + 0.5f) * kCellSide};
    auto list = MakeList(lights, at.cluster, center, facing);
    const std::unique_lock writing(shard.lock);
    return *shard.lists.try_emplace(key, std::move(list)).first->second;
}

DirectLights::DirectLights(const SurfaceInputs &in, std::vector<Light> lights)
    : in_(in), lights_([&] {
          std::erase_if(lights, [](const Light &light) { return light.style != 0 || !light.lightsSurfaces; });
          return std::move(lights);
      }()),
      cells_(std::make_unique<Cells>()) {}

DirectLights::~DirectLights() = default;

Vec3f DirectLights::At(const SurfacePoint &at, RayCounts &counts) const {
    Vec3f sum;
    for (const Light &light : lights_)
        if (const UnshadowedLight one = LightWithoutShadow(light, at); one.light)
            sum += ArrivingLight(in_.scene, one, at, counts);
    return sum;
}

UnshadowedLight DirectLights::Sample(const SurfacePoint &at, PathRandom &random) const {
    const LightList &list = cells_->ListAt(lights_, at);
    const std::size_t count = list.lights.size();
    if (count == 0)
        return {};
    const bool all = count <= std::size_t(kCandidates);
    UnshadowedLight chosen;
    double total = 0;
    for (std::size_t i = 0; i < (all ? count : std::size_t(kCandidates)); ++i) {
        std::size_t index = i;
        double weight = 1;
        if (!all) {
            // Stratified over the cumulative distribution.
            const double quantile = (double(i) + random.Unit()) / kCandidates;
            index = std::size_t(std::upper_bound(list.cumulative.begin(), list.cumulative.end(), quantile) -
                                list.cumulative.begin());
            index = std::min(index, count - 1);
            weight = 1 / (kCandidates * (list.cumulative[index] - (index > 0 ? list.cumulative[index - 1] : 0)));
        }
        const UnshadowedLight one = LightWithoutShadow(lights_[list.lights[index]], at);
        const double amount = Amount(one) * weight;
        if (!(amount > 0))
            continue;
        total += amount; // weighted reservoir sampling of one candidate
        if (random.Unit() * total < amount)
            chosen = one;
    }
    if (chosen.light)
        chosen.color *= float(total / Amount(chosen));
    return chosen;
}

} // namespace q3::bounce
