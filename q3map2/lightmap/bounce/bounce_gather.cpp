// GPL-2.0-or-later. Final gathering of bounced light at luxels, vertices and light grid points.
#include "q3map2/lightmap/bounce/bounce_gather.h"

#include "libs/math/color.h"
#include "libs/math/low_discrepancy.h"
#include "q3map2/light/batch/ray_batcher.h"
#include "q3map2/lightmap/raw/deluxe.h"
#include "q3map2/lightmap/raw/luxel_tiles.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>

namespace q3 {

namespace {

/// Rays per luxel, and sets of directions: the luxels of a 4 x 4 block have one each, 384 directions together.
constexpr int kRays = 24, kMinRays = 4, kDirectionSets = 16;
constexpr int kVertexRays = 256, kProbeRays = 96;
/// With more hits (768 MiB) rays are traced anew in each bounce.
constexpr std::uint64_t kMaxKeptHits = std::uint64_t(192) << 20;
/// Longer than any map. Game units.
constexpr float kRayLength = 1e6f;
/// Rays of vertices start this far off their surface; kMinRayLift where another surface is nearer. Game units.
constexpr float kRayLift = 1, kMinRayLift = 1.0f / 16;
/// Ray origins with a solid this near are moved aside. Game units.
constexpr float kSolidMargin = 0.25f;
/// The denoising window reaches this many luxels to each side, over luxels whose normals are within this cosine of
/// the center's.
constexpr int kWindowReach = 2;
constexpr float kMinNormalCosine = 0.9f;
/// Ridge regression: added to the variance of x and y, so that slopes of small windows stay small. Luxels squared.
constexpr double kSlopePenalty = 0.7;

/// Direction i of a cosine-weighted hemisphere around +z.
Vec3f CosineDirection(std::uint32_t i) {
    const Sample2 s = PlasticSample(i, 0);
    const double radius = std::sqrt(s.u), angle = 2 * std::numbers::pi * s.v;
    return {float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(std::sqrt(1 - s.u))};
}

/// Dither threshold in [0, 1) of the additive golden ratio sequence.
float DitherThreshold(std::uint32_t number) {
    constexpr std::uint32_t kGolden = 2654435769u; // 2^32 over the golden ratio
    return float((number * kGolden) >> 8) * 0x1p-24f;
}

/// Tangent frame of a receiver.
struct GatherFrame {
    explicit GatherFrame(const Vec3f &n) : normal(n) {
        const Vec3f axis = std::abs(n.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1};
        right = Normalize(Cross(axis, n));
        up = Cross(n, right);
    }
    Vec3f World(const Vec3f &d) const { return right * d.x + up * d.y + normal * d.z; }
    Vec3f Local(const Vec3f &d) const { return {Dot(right, d), Dot(up, d), Dot(normal, d)}; }
    Vec3f normal, right, up;
};

/// The set of directions of a luxel, 0 to 15: the 4 x 4 Bayer matrix, so neighbors have sets that are far apart.
std::uint32_t DirectionSetOf(int x, int y) {
    constexpr std::uint32_t kOrder[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
    return kOrder[y & 3][x & 3];
}

/// Origin of the rays of a luxel: its position, or half a luxel aside if only that is clear of solids. Luxels at the
/// edge of a wall lie in the plane of the adjacent wall, and their rays would start behind it.
Vec3f ClearOrigin(const BspSpace &space, const RawLightmap &raw, std::size_t luxel, const GatherFrame &frame) {
    const Vec3f margin{kSolidMargin, kSolidMargin, kSolidMargin}, position = raw.positions[luxel];
    const auto clear = [&](const Vec3f &p) { return !space.AnySolid(p - margin, p + margin); };
    if (clear(position))
        return position;
    const float half = raw.actualSampleSize / float(2 * raw.super);
    const Vec3f u = raw.hasVectors ? raw.step[0] * 0.5f : frame.right * half;
    const Vec3f v = raw.hasVectors ? raw.step[1] * 0.5f : frame.up * half;
    for (const auto &[x, y] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}) {
        const Vec3f aside = position + u * float(x) + v * float(y);
        if (clear(aside))
            return aside;
    }
    return position;
}

/// Incoherent rays, each with a tag: calls use(tag, emitter) with the first hit of each.
template <typename Use> auto EmitterRays(const BounceScene &scene, Use use) {
    return MakeRayBatcher<std::size_t>([&scene, use](RayPacket &packet, std::span<const std::size_t> tags) {
        const auto found = scene.FirstEmitters(packet, false);
        for (std::size_t i = 0; i < tags.size(); ++i)
            use(tags[i], found[i]);
    });
}

/// Luxels in the window around a luxel that are connected to it over mapped luxels with similar normals (flood fill).
class LuxelWindow {
  public:
    struct Neighbor {
        std::size_t luxel;
        float dx, dy;
    };
    const std::vector<Neighbor> &Around(const RawLightmap &raw, int x, int y, int reach) {
        list_.clear();
        const int side = 2 * reach + 1;
        seen_.assign(std::size_t(side * side), 0);
        const std::size_t center = raw.SuperIndex(x, y);
        Visit(center, 0, 0, reach);
        for (std::size_t next = 0; next < list_.size(); ++next) {
            const int dx = int(list_[next].dx), dy = int(list_[next].dy);
            for (const auto &[sx, sy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                const int ox = dx + sx, oy = dy + sy;
                if (std::abs(ox) > reach || std::abs(oy) > reach || x + ox < 0 || y + oy < 0 ||
                    x + ox >= raw.SuperWidth() || y + oy >= raw.SuperHeight() ||
                    seen_[std::size_t((oy + reach) * side + ox + reach)] != 0)
                    continue;
                const std::size_t luxel = raw.SuperIndex(x + ox, y + oy);
                if (raw.Mapped(luxel) && Dot(raw.normals[luxel], raw.normals[center]) > kMinNormalCosine)
                    Visit(luxel, ox, oy, reach);
            }
        }
        return list_;
    }

  private:
    void Visit(std::size_t luxel, int dx, int dy, int reach) {
        seen_[std::size_t((dy + reach) * (2 * reach + 1) + dx + reach)] = 1;
        list_.push_back({luxel, float(dx), float(dy)});
    }
    std::vector<Neighbor> list_;
    std::vector<std::uint8_t> seen_;
};

struct WindowSample {
    Vec3f value;
    float dx, dy; ///< luxels from the center
};

/// Value at (0, 0) of the plane a + b x + c y fitted to the samples by least squares, with kSlopePenalty on b and c: at
/// the rim of a lightmap, with samples on one side only, free slopes would turn noise into a seam.
Vec3f FittedPlaneAtCenter(const std::vector<WindowSample> &around) {
    double mx = 0, my = 0;
    Vec3d mean;
    const auto n = double(around.size());
    for (const auto &[value, dx, dy] : around)
        mx += double(dx) / n, my += double(dy) / n, mean += Vec3d(value) * (1 / n);
    double xx = kSlopePenalty * n, xy = 0, yy = kSlopePenalty * n;
    Vec3d xv, yv;
    for (const auto &[sampled, dx, dy] : around) {
        const double x = double(dx) - mx, y = double(dy) - my;
        const Vec3d value = Vec3d(sampled) - mean;
        xx += x * x, xy += x * y, yy += y * y;
        xv += value * x, yv += value * y;
    }
    const double det = xx * yy - xy * xy;
    const Vec3d slopeX = (xv * yy - yv * xy) * (1 / det), slopeY = (yv * xx - xv * xy) * (1 / det);
    return Vec3f(mean - slopeX * mx - slopeY * my);
}

/// Whether all luxels of the window are mapped and have normals like that of the center.
bool WindowIsComplete(const RawLightmap &raw, int x, int y, int reach) {
    if (x < reach || y < reach || x + reach >= raw.SuperWidth() || y + reach >= raw.SuperHeight())
        return false;
    const Vec3f normal = raw.normals[raw.SuperIndex(x, y)];
    for (int row = y - reach; row <= y + reach; ++row)
        for (std::size_t i = raw.SuperIndex(x - reach, row); i <= raw.SuperIndex(x + reach, row); ++i)
            if (!raw.Mapped(i) || !(Dot(raw.normals[i], normal) > kMinNormalCosine))
                return false;
    return true;
}

/// Mean over a complete window, which equals its FittedPlaneAtCenter.
Vec3f MeanOverWindow(const RawLightmap &raw, const std::vector<Vec3f> &values, int x, int y, int reach) {
    Vec3f mean;
    for (int row = y - reach; row <= y + reach; ++row)
        for (std::size_t i = raw.SuperIndex(x - reach, row); i <= raw.SuperIndex(x + reach, row); ++i)
            mean += values[i];
    const int side = 2 * reach + 1;
    return mean / float(side * side);
}

} // namespace

BounceGather::BounceGather(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                           const RadiosityPatches *patches)
    : space_(in.space), scene_(scene), patches_(patches), seams_(in, surfaces, kWindowReach, kMinNormalCosine),
      emitterHits_(surfaces.lightmaps.size()) {
    for (std::uint32_t i = 0; i < std::uint32_t(std::max(kDirectionSets * kRays, kVertexRays)); ++i)
        directions_.push_back(CosineDirection(i));
    for (const RawLightmap &raw : surfaces.lightmaps)
        rays_ += std::uint64_t(std::count_if(raw.luxelClusters.begin(), raw.luxelClusters.end(),
                                             [](int code) { return code >= 0; })) *
                 std::uint64_t(RaysPerLuxel(raw));
    keepHits_ = rays_ <= kMaxKeptHits;
    if (!keepHits_)
        return;
    in.jobs.For(std::int64_t(emitterHits_.size()), [&](std::int64_t i, int) {
        emitterHits_[std::size_t(i)] = TraceEmitterHits(surfaces.lightmaps[std::size_t(i)]);
    });
}

int BounceGather::RaysPerLuxel(const RawLightmap &raw) const {
    return std::max(kMinRays, kRays / (raw.super * raw.super));
}

struct BounceGather::GatherBatch {
    std::uint32_t set = 0;
    std::size_t count = 0;
    std::array<std::size_t, kPacketSize> luxels{}, firstHits{};

    void Add(std::size_t luxel, std::size_t firstHit) { luxels[count] = luxel, firstHits[count++] = firstHit; }
};

/// Luxels with the same direction set are traced in packets of 16, one direction at a time, so that rays are coherent.
std::vector<EmitterId> BounceGather::TraceEmitterHits(const RawLightmap &raw) const {
    const auto count = std::size_t(RaysPerLuxel(raw));
    std::vector<std::size_t> first(raw.luxelClusters.size());
    std::size_t used = 0;
    for (std::size_t luxel = 0; luxel < first.size(); ++luxel) {
        first[luxel] = used;
        used += raw.Mapped(luxel) ? count : 0;
    }
    std::vector<EmitterId> hits(used);
    std::array<GatherBatch, kDirectionSets> batches;
    for (std::uint32_t set = 0; set < kDirectionSets; ++set)
        batches[set].set = set;
    const auto flush = [&](GatherBatch &batch) {
        TraceBatch(raw, batch, hits);
        batch.count = 0;
    };
    constexpr int kTile = 16; // each direction set has 16 luxels in a tile: one packet
    ForMappedLuxelsByTile(raw, kTile, [&](std::size_t luxel, int x, int y) {
        GatherBatch &batch = batches[DirectionSetOf(x, y)];
        batch.Add(luxel, first[luxel]);
        if (batch.count == kPacketSize)
            flush(batch);
    });
    for (GatherBatch &batch : batches)
        if (batch.count > 0)
            flush(batch);
    return hits;
}

void BounceGather::TraceBatch(const RawLightmap &raw, const GatherBatch &batch, std::vector<EmitterId> &hits) const {
    const auto count = std::uint32_t(RaysPerLuxel(raw));
    std::vector<GatherFrame> frames;
    RayPacket rays;
    rays.distance.fill(kRayLength);
    for (std::size_t i = 0; i < batch.count; ++i) {
        const std::size_t luxel = batch.luxels[i];
        frames.emplace_back(raw.normals[luxel]);
        rays.origin.Set(i, ClearOrigin(space_, raw, luxel, frames.back()));
        rays.live[i] = -1;
    }
    for (std::uint32_t ray = 0; ray < count; ++ray) {
        for (std::size_t i = 0; i < batch.count; ++i)
            rays.direction.Set(i, frames[i].World(directions_[batch.set * count + ray]));
        const auto emitters = scene_.FirstEmitters(rays, true);
        for (std::size_t i = 0; i < batch.count; ++i) {
            const std::size_t luxel = batch.luxels[i], at = batch.firstHits[i] + ray;
            const float share = emitters[i] == kNoEmitter ? 0
                                : patches_ ? patches_->ContributionShare(emitters[i], raw.positions[luxel],
                                                                         raw.normals[luxel], raw.twoSided)
                                           : 1;
            // Hits have no weight: of hits with share s, a fraction s is kept.
            hits[at] = share > DitherThreshold(std::uint32_t(at)) ? emitters[i] : kNoEmitter;
        }
    }
}

/// By direction set: the cosine-weighted mean of 1 / (n . w) over the hemisphere, which is 2, divided by the mean over
/// the directions of the set.
std::vector<float> BounceGather::FluenceScales(int count) const {
    std::vector<float> scales;
    for (int set = 0; set < kDirectionSets; ++set) {
        float sum = 0;
        for (int i = 0; i < count; ++i)
            sum += 1 / directions_[std::size_t(set * count + i)].z;
        scales.push_back(2 * float(count) / sum);
    }
    return scales;
}

/// Directional channels of one luxel, summed over its rays. The light of a ray is its emitter's radiosity / cosine, so
/// that it gives the radiosity on the luxel's normal.
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
    /// w: a cosine-weighted direction, local. light: radiosity of its hit.
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
    /// Stores the sums times `scale`, the fluence also times fluenceScale.
    void Store(float scale, float fluenceScale, ChannelImages &channels) const {
        if (raw_.channels.sh) {
            channels[0][luxel_] = fluence_ * (kDirectedSh0 * scale * fluenceScale);
            for (std::size_t c = 0; c < 3; ++c) {
                constexpr std::size_t kAxes[3] = {1, 2, 0};
                const std::size_t axis = kAxes[c];
                const Vec3f sum =
                    vector_[0] * frame_.right[axis] + vector_[1] * frame_.up[axis] + vector_[2] * frame_.normal[axis];
                channels[1 + c][luxel_] = sum * (kDirectedSh1 * scale);
            }
        }
        for (std::size_t i = 0; raw_.channels.basis && i < onBasis_.size(); ++i)
            channels[raw_.channels.FirstBasis() + i][luxel_] = onBasis_[i] * scale;
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

BounceEstimate BounceGather::Gather(const Emission &emission, std::size_t lightmap, std::size_t slot,
                                    RawLightmap &raw) const {
    const int count = RaysPerLuxel(raw);
    const std::vector<EmitterId> traced = keepHits_ ? std::vector<EmitterId>{} : TraceEmitterHits(raw);
    const std::vector<EmitterId> &hits = keepHits_ ? emitterHits_[lightmap] : traced;
    BounceEstimate gathered;
    gathered.irradiance.resize(raw.luxelClusters.size());
    gathered.channels.assign(raw.channels.Count(), std::vector<Vec3f>(raw.luxelClusters.size()));
    const bool deluxe = !raw.directions.empty() && slot == 0, directional = raw.channels.Any();
    const std::vector<float> fluenceScales = directional ? FluenceScales(count) : std::vector<float>{};
    std::size_t next = 0;
    for (std::size_t luxel = 0; luxel < raw.luxelClusters.size(); ++luxel) {
        if (!raw.Mapped(luxel))
            continue;
        const auto x = int(luxel % std::size_t(raw.SuperWidth())), y = int(luxel / std::size_t(raw.SuperWidth()));
        const std::uint32_t set = DirectionSetOf(x, y), first = set * std::uint32_t(count);
        const GatherFrame frame(raw.normals[luxel]);
        ChannelSum channels(raw, luxel, frame);
        Vec3f sum, direction;
        for (int i = 0; i < count; ++i) {
            const EmitterId hit = hits[next++];
            if (hit == kNoEmitter)
                continue;
            const Vec3f &from = directions_[first + std::uint32_t(i)];
            sum += emission[hit];
            if (deluxe)
                direction += frame.World(from) * Luminance(emission[hit]);
            if (directional)
                channels.Add(from, emission[hit]);
        }
        gathered.irradiance[luxel] = sum / float(count);
        if (directional)
            channels.Store(1 / float(count), fluenceScales[set], gathered.channels);
        if (deluxe)
            raw.directions[luxel] += direction * (kDeluxeBounceShare / 255 / float(count));
    }
    return gathered;
}

namespace {

/// Luxels over which the estimate at a luxel is denoised: a complete window, or some in its lightmap and across seams.
struct DenoiseWindow {
    bool complete = false;
    std::span<const LuxelWindow::Neighbor> own;
    std::span<const LightmapSeams::Neighbor> across;
};

/// Denoised estimate. imageOf(i): the estimates of raw lightmap i, null if it has none.
template <typename ImageOf>
Vec3f Denoised(const RawLightmap &raw, std::size_t lightmap, int x, int y, int reach, const DenoiseWindow &window,
               std::vector<WindowSample> &samples, const ImageOf &imageOf) {
    const std::vector<Vec3f> &own = *imageOf(lightmap);
    if (window.complete)
        return MeanOverWindow(raw, own, x, y, reach);
    samples.clear();
    for (const auto &[near, dx, dy] : window.own)
        samples.push_back({own[near], dx, dy});
    for (const auto &[other, near, dx, dy] : window.across)
        if (const std::vector<Vec3f> *image = imageOf(other))
            samples.push_back({(*image)[near], dx, dy});
    return FittedPlaneAtCenter(samples);
}

} // namespace

void BounceGather::AddToLuxels(const std::vector<BounceEstimate> &all, std::size_t lightmap, std::size_t slot,
                               RawLightmap &raw) const {
    const int reach = kWindowReach * std::min(raw.super, 2);
    std::vector<WindowSample> samples;
    LuxelWindow around;
    for (int y = 0; y < raw.SuperHeight(); ++y)
        for (int x = 0; x < raw.SuperWidth(); ++x) {
            const std::size_t luxel = raw.SuperIndex(x, y);
            if (!raw.Mapped(luxel))
                continue;
            DenoiseWindow window;
            window.complete = WindowIsComplete(raw, x, y, reach);
            if (!window.complete) {
                window.own = around.Around(raw, x, y, reach);
                window.across = seams_.NeighborsAcross(lightmap, luxel);
            }
            const auto light = [&](std::size_t i) { return all[i].Empty() ? nullptr : &all[i].irradiance; };
            raw.light[slot][luxel] += Max(Denoised(raw, lightmap, x, y, reach, window, samples, light), Vec3f{});
            for (std::size_t c = 0; c < raw.channels.Count(); ++c) {
                // Basis normals of another lightmap may have other tangents.
                const bool isSh = raw.channels.IsSh(c);
                const auto channel = [&](std::size_t i) {
                    return all[i].Empty() || (i != lightmap && !isSh) ? nullptr : &all[i].channels[c];
                };
                const Vec3f value = Denoised(raw, lightmap, x, y, reach, window, samples, channel);
                raw.directional[slot][c][luxel] += isSh ? value : Max(value, Vec3f{});
            }
        }
}

/// kRayLift, or kMinRayLift if another surface, such as a decal over a floor, faces this one from nearer than kRayLift.
float BounceGather::RayLiftAt(const Vec3f &position, const Vec3f &normal) const {
    RayPacket ahead;
    ahead.Aim(0, position + normal * kMinRayLift, position + normal * kRayLift);
    return scene_.FirstEmitters(ahead, false)[0] == kNoEmitter ? kRayLift : kMinRayLift;
}

Vec3f BounceGather::IrradianceAt(const Vec3f &position, const Vec3f &normal, bool twoSided,
                                 const Emission &emission) const {
    const GatherFrame frame(normal);
    Vec3f sum;
    const auto add = [&](std::size_t, EmitterId emitter) {
        if (emitter != kNoEmitter)
            sum +=
                emission[emitter] * (patches_ ? patches_->ContributionShare(emitter, position, normal, twoSided) : 1);
    };
    const Vec3f start = position + normal * RayLiftAt(position, normal);
    auto rays = EmitterRays(scene_, add);
    for (std::uint32_t i = 0; i < std::uint32_t(kVertexRays); ++i)
        rays.Add(i, start, frame.World(directions_[i]), kRayLength);
    rays.Flush();
    return sum / float(kVertexRays);
}

void BouncedLight::Gather(const Vec3f &position, std::uint64_t seed, std::vector<IndirectRay> &rays) const {
    rays.clear();
    std::array<Vec3f, kProbeRays> directions;
    for (std::uint32_t i = 0; i < std::uint32_t(kProbeRays); ++i) {
        const Sample2 s = PlasticSample(i, seed);
        const double z = 1 - 2 * s.u, radius = std::sqrt(std::max(0.0, 1 - z * z)), angle = 2 * std::numbers::pi * s.v;
        directions[i] = {float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(z)};
    }
    const auto add = [&](std::size_t i, EmitterId emitter) {
        rays.push_back({directions[i], emitter == kNoEmitter ? Vec3f{} : emission_[emitter]});
    };
    auto queue = EmitterRays(scene_, add);
    for (std::size_t i = 0; i < directions.size(); ++i)
        queue.Add(i, position, directions[i], kRayLength);
    queue.Flush();
}

} // namespace q3
