// GPL-2.0-or-later. Next event estimation of the brightest emitters of a bounce.
#include "q3map2/lightmap/bounce/bright_emitters.h"

#include "libs/math/sampling.h"
#include "libs/math/vec.h"
#include "q3map2/light/batch/ray_packet.h"
#include "q3map2/lightmap/bounce/bright_tree.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Russian roulette: a node that gives less light than this to a receiver (on a surface, or a point in the open) is
/// sampled with a probability proportional to its light. Byte scale.
constexpr float kSurfaceRoulette = 0.1f, kPointRoulette = 0.5f;
/// Shadow rays end kPatchGap (game units) in front of the patch, but at least at the fraction kPatchFraction of the
/// distance to it.
constexpr float kPatchGap = 0.25f, kPatchFraction = 0.99f;
constexpr std::uint64_t kRouletteSeed = 0x526F756C65747465u, kStrideSeed = 0x537472696465u;
/// A faint node is tried at every stride-th receiver, and the stride is at most this.
constexpr float kMaxStride = 64;

/// Scales each emission down to a largest channel of at most `limit`, and returns what was removed.
std::vector<Vec3f> TakeExcess(float limit, std::vector<Vec3f> &emission) {
    std::vector<Vec3f> excess(emission.size());
    for (std::size_t i = 0; i < emission.size(); ++i)
        if (const float most = MaxComponent(emission[i]); most > limit) {
            const Vec3f kept = emission[i] * (limit / most);
            excess[i] = emission[i] - kept;
            emission[i] = kept;
        }
    return excess;
}

} // namespace

/// Up to 16 receivers close together.
struct BrightEmitters::Receivers {
    TreeView view;
    std::size_t count = 0;
    std::array<Vec3f, kPacketSize> position, origin, normal; // zero normal: a point in the open
    std::array<std::size_t, kPacketSize> tag{};              // luxel, or a hash for other receivers; seeds the sampling
    bool twoSided = false;
    float rouletteLimit = kSurfaceRoulette; // nodes that give less light are sampled by Russian roulette

    void Add(const Vec3f &at, const Vec3f &rayOrigin, const Vec3f &facing, std::size_t number, int cluster) {
        position[count] = at, origin[count] = rayOrigin, normal[count] = facing, tag[count++] = number;
        auto &clusters = view.clusters;
        if (cluster >= 0 && std::find(clusters.begin(), clusters.end(), cluster) == clusters.end())
            clusters.push_back(cluster);
    }
    /// Call after the last Add.
    void SetView() {
        Boundsf bounds;
        for (std::size_t i = 0; i < count; ++i)
            bounds.Add(origin[i]);
        view.center = bounds.Center();
        view.radius = 0;
        view.normal = normal[0];
        for (std::size_t i = 0; i < count; ++i) {
            view.radius = std::max(view.radius, Length(origin[i] - view.center));
            if (normal[i] != normal[0])
                view.normal = {};
        }
    }
};

BrightEmitters::BrightEmitters(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                               const EmitterIndex &emitters, const FaintPatches *patches, float limit,
                               std::vector<Vec3f> &emission)
    : space_(in.space), scene_(scene), patches_(patches), tree_([&] {
          auto bright = MakeBrightPatches(in, surfaces, emitters, TakeExcess(limit, emission));
          count_ = bright.size();
          return bright;
      }()) {}

/// Samples the light of a node on receiver i before visibility; target: the end of the shadow ray. False: no light, or
/// rejected by roulette.
bool BrightEmitters::SampleNode(const Receivers &receivers, std::size_t i, std::uint32_t number, std::uint32_t stride,
                                Sample &sample, Vec3f &target) const {
    const BrightTree::Node &node = tree_.At(number);
    const Vec3f offset = node.center - receivers.origin[i];
    const float distance2 = std::max(Dot(offset, offset), 1e-6f);
    const Vec3f direction = offset / std::sqrt(distance2);
    const bool oriented = receivers.normal[i] != Vec3f{};
    const float cosine = oriented ? Dot(direction, receivers.normal[i]) : 1;
    const float emitted = node.twoSided ? std::abs(Dot(direction, node.axis)) : -Dot(direction, node.axis);
    if (!(cosine > 0) || !(emitted > 0))
        return false;
    // Form factor of a disk instead of a point: it stays below 1 at small distances.
    float fraction = emitted / (std::numbers::pi_v<float> * distance2 + node.area * emitted);
    const std::uint64_t hash = HashIndex(kRouletteSeed + (std::uint64_t(receivers.tag[i]) << 24) + number);
    // The caller tries this receiver with probability 1 / stride.
    const float strength = Luminance(node.power) * fraction * cosine,
                rouletteLimit = receivers.rouletteLimit / float(stride);
    if (strength < rouletteLimit) {
        const auto u = float(hash >> 40) * 0x1p-24f;
        if (u * rouletteLimit >= strength)
            return false;
        fraction *= rouletteLimit / strength;
    }
    fraction *= float(stride);
    const BrightPatch &patch = tree_.PatchAt(node, float(hash & 0xFFFFFF) * 0x1p-24f);
    if (patches_ && oriented)
        fraction *= patches_->ContributionFraction(patch.emitter, receivers.position[i], receivers.normal[i],
                                                   receivers.twoSided);
    sample = {i, direction, node.power * fraction};
    target = patch.center;
    return fraction > 0;
}

void BrightEmitters::SampleTree(const Receivers &receivers, std::vector<Sample> &samples) const {
    samples.clear();
    std::vector<std::uint32_t> cut;
    tree_.Cut(receivers.view, space_, receivers.rouletteLimit / 4, cut);
    auto rays = MakeRayBatcher<Sample>([&](RayPacket &packet, std::span<const Sample> waiting) {
        scene_.TraceOccluded(packet);
        for (std::size_t ray = 0; ray < waiting.size(); ++ray)
            if (packet.live[ray] != 0)
                samples.push_back(waiting[ray]);
    });
    for (const std::uint32_t node : cut) {
        // A faint node is tried at every stride-th receiver only, starting at a random one.
        const float most = BrightTree::MostLight(tree_.At(node), receivers.view);
        const auto stride = std::uint32_t(std::clamp(receivers.rouletteLimit / most, 1.0f, kMaxStride));
        const std::uint64_t hash = HashIndex(kStrideSeed + (std::uint64_t(receivers.tag[0]) << 24) + node);
        for (std::size_t i = stride > 1 ? hash % stride : 0; i < receivers.count; i += stride) {
            Sample sample;
            Vec3f target;
            if (!SampleNode(receivers, i, node, stride, sample, target))
                continue;
            const Vec3f offset = target - receivers.origin[i];
            const float length = Length(offset);
            if (length > 0)
                rays.Add(sample, receivers.origin[i], offset / length,
                         std::max(length - kPatchGap, length * kPatchFraction));
        }
    }
    rays.Flush();
}

void BrightEmitters::AddToLuxels(const RawLightmap &raw, const std::vector<Vec3f> &origins,
                                 BounceEstimate &estimate) const {
    constexpr int kBlock = 4;
    std::vector<Sample> samples;
    for (int top = 0; top < raw.SuperHeight(); top += kBlock)
        for (int left = 0; left < raw.SuperWidth(); left += kBlock) {
            Receivers receivers;
            receivers.twoSided = raw.twoSided;
            for (int y = top; y < std::min(top + kBlock, raw.SuperHeight()); ++y)
                for (int x = left; x < std::min(left + kBlock, raw.SuperWidth()); ++x)
                    if (const std::size_t luxel = raw.SuperIndex(x, y); raw.Mapped(luxel))
                        receivers.Add(raw.positions[luxel], origins[luxel], raw.normals[luxel], luxel,
                                      raw.luxelClusters[luxel]);
            if (receivers.count == 0)
                continue;
            receivers.SetView();
            SampleTree(receivers, samples);
            for (const Sample &sample : samples) {
                const std::size_t luxel = receivers.tag[sample.receiver];
                const Vec3f light = sample.light * Dot(sample.direction, raw.normals[luxel]);
                estimate.irradiance[luxel] += light;
                if (!estimate.directions.empty())
                    estimate.directions[luxel] += sample.direction * (Luminance(light) * kDeluxeBounceFraction / 255);
                if (!raw.channels.Any())
                    continue;
                const BasisNormals basis = raw.channels.basis ? raw.BasisOf(luxel) : BasisNormals{};
                const ChannelWeights weights = WeightsOf(sample.direction, raw.channels, &basis);
                for (std::size_t c = 0; c < raw.channels.Count(); ++c)
                    estimate.channels[c][luxel] += sample.light * weights[c];
            }
        }
}

Vec3f BrightEmitters::IrradianceAt(const Vec3f &position, const Vec3f &origin, const Vec3f &normal,
                                   bool twoSided) const {
    Receivers receivers;
    receivers.twoSided = twoSided;
    const auto bits = [](float x) { return std::uint64_t(std::bit_cast<std::uint32_t>(x)); };
    const std::uint64_t seed = HashIndex(bits(position.x) ^ bits(position.y) << 16 ^ bits(position.z) << 32);
    receivers.Add(position, origin, normal, std::size_t(seed), space_.ClusterAt(origin, 0));
    receivers.SetView();
    std::vector<Sample> samples;
    SampleTree(receivers, samples);
    Vec3f sum;
    for (const Sample &sample : samples)
        sum += sample.light * Dot(sample.direction, normal);
    return sum;
}

void BrightEmitters::Gather(const Vec3f &point, std::uint64_t seed, std::vector<IndirectRay> &rays) const {
    Receivers receivers;
    receivers.rouletteLimit = kPointRoulette;
    receivers.Add(point, point, {}, std::size_t(seed), space_.ClusterAt(point, 0));
    receivers.SetView();
    std::vector<Sample> samples;
    SampleTree(receivers, samples);
    for (const Sample &sample : samples)
        rays.push_back({sample.direction, sample.light});
}

} // namespace q3
