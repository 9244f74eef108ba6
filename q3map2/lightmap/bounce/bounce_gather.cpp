// GPL-2.0-or-later. Bounced light at luxels, vertices and receivers, gathered by rays.
#include "q3map2/lightmap/bounce/bounce_gather.h"

#include "libs/math/color.h"
#include "libs/math/low_discrepancy.h"
#include "q3map2/light/batch/ray_batcher.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>

namespace q3 {

namespace {

/// Rays of a luxel; 16 neighbours have 16 times as many different ones.
constexpr int kRays = 24, kFewestRays = 4, kSets = 16;
constexpr int kVertexRays = 256, kPlaceRays = 96;
constexpr std::uint64_t kMostLinks = std::uint64_t(192) << 20;
constexpr float kEndless = 1e6f; ///< length of rays. Game units
/// Rays of vertices start this far off, or the second where a surface is that near. Game units.
constexpr float kLift = 1, kLeastLift = 1.0f / 16;
/// Receivers are clear of solids if nothing solid is so near. Game units.
constexpr float kMargin = 0.25f;
/// Luxels share what they found with those up to this many luxels away whose normals differ by less than its cosine.
constexpr int kWindow = 2;
constexpr float kAlike = 0.9f;
/// Weight of a flat plane against the neighbours' spread. Luxels squared.
constexpr double kStiffness = 0.7;
/// Weight of bounced light in deluxe directions; spec of deluxe.
constexpr float kBounceDirection = 0.25f;

/// Direction i of a cosine-weighted hemisphere around +z.
Vec3f CosineDirection(std::uint32_t i) {
    const Sample2 s = PlasticSample(i, 0);
    const double radius = std::sqrt(s.u), angle = 2 * std::numbers::pi * s.v;
    return {float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(std::sqrt(1 - s.u))};
}

/// A fraction for each number, as if by chance; neighbours are spread.
float Fraction(std::uint32_t number) {
    constexpr std::uint32_t kGolden = 2654435769u; // 2^32 over the golden ratio
    return float((number * kGolden) >> 8) * 0x1p-24f;
}

struct Frame {
    explicit Frame(const Vec3f &n) : normal(n) {
        const Vec3f axis = std::abs(n.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1};
        right = Normalize(Cross(axis, n));
        up = Cross(n, right);
    }
    Vec3f World(const Vec3f &d) const { return right * d.x + up * d.y + normal * d.z; }
    Vec3f normal, right, up;
};

/// Which of the sixteen sets of directions a luxel asks: neighbours ask sets that are far apart.
std::uint32_t SetOf(int x, int y) {
    constexpr std::uint32_t kOrder[4][4] = {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}};
    return kOrder[y & 3][x & 3];
}

/// Where rays of a luxel start: half a luxel aside if that is clear of solids and the place is not. Luxels at the edge
/// of a wall lie in the plane of the next, behind which their rays would get lost.
Vec3f ClearPlace(const BspSpace &space, const RawLightmap &raw, std::size_t luxel, const Frame &frame) {
    const Vec3f margin{kMargin, kMargin, kMargin}, place = raw.positions[luxel];
    const auto clear = [&](const Vec3f &p) { return !space.AnySolid(p - margin, p + margin); };
    if (clear(place))
        return place;
    const float half = raw.actualSampleSize / float(2 * raw.super);
    const Vec3f u = raw.hasVectors ? raw.step[0] * 0.5f : frame.right * half;
    const Vec3f v = raw.hasVectors ? raw.step[1] * 0.5f : frame.up * half;
    for (const auto &[x, y] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}) {
        const Vec3f aside = place + u * float(x) + v * float(y);
        if (clear(aside))
            return aside;
    }
    return place;
}

/// Rays in all directions, each with a tag: calls use(tag, emitter) with what a ray meets first.
template <typename Use> auto EmitterRays(const BounceScene &scene, Use use) {
    return MakeRayBatcher<std::size_t>([&scene, use](RayPacket &packet, std::span<const std::size_t> tags) {
        const auto found = scene.FirstEmitters(packet, false);
        for (std::size_t i = 0; i < tags.size(); ++i)
            use(tags[i], found[i]);
    });
}

/// A luxel's neighbours in a window, each reached over mapped ones that face the same way.
class Neighbourhood {
  public:
    struct Neighbour {
        std::size_t luxel;
        float dx, dy;
    };
    const std::vector<Neighbour> &Around(const RawLightmap &raw, int x, int y, int reach) {
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
                if (raw.Mapped(luxel) && Dot(raw.normals[luxel], raw.normals[center]) > kAlike)
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
    std::vector<Neighbour> list_;
    std::vector<std::uint8_t> seen_;
};

struct Sample {
    Vec3f found;
    float dx, dy; ///< luxels from the centre
};

/// Height at the centre of the plane that fits the neighbours' values best, with slopes held back: at the rim of a
/// lightmap, with neighbours on one side only, free slopes would make noise of neighbours a seam.
Vec3f PlaneAtCenter(const std::vector<Sample> &around) {
    double mx = 0, my = 0;
    Vec3d mean;
    const auto n = double(around.size());
    for (const auto &[value, dx, dy] : around)
        mx += double(dx) / n, my += double(dy) / n, mean += Vec3d(value) * (1 / n);
    double xx = kStiffness * n, xy = 0, yy = kStiffness * n;
    Vec3d xv, yv;
    for (const auto &[found, dx, dy] : around) {
        const double x = double(dx) - mx, y = double(dy) - my;
        const Vec3d value = Vec3d(found) - mean;
        xx += x * x, xy += x * y, yy += y * y;
        xv += value * x, yv += value * y;
    }
    const double det = xx * yy - xy * xy;
    const Vec3d slopeX = (xv * yy - yv * xy) * (1 / det), slopeY = (yv * xx - xv * xy) * (1 / det);
    return Max(Vec3f(mean - slopeX * mx - slopeY * my), Vec3f{});
}

/// Mean of the whole window around a luxel, which is its plane's height there; false if part of it is missing or faces
/// another way.
bool MeanOfWindow(const RawLightmap &raw, const std::vector<Vec3f> &values, int x, int y, int reach, Vec3f &mean) {
    if (x < reach || y < reach || x + reach >= raw.SuperWidth() || y + reach >= raw.SuperHeight())
        return false;
    const Vec3f normal = raw.normals[raw.SuperIndex(x, y)];
    mean = {};
    for (int row = y - reach; row <= y + reach; ++row)
        for (std::size_t i = raw.SuperIndex(x - reach, row); i <= raw.SuperIndex(x + reach, row); ++i) {
            if (!raw.Mapped(i) || !(Dot(raw.normals[i], normal) > kAlike))
                return false;
            mean += values[i];
        }
    const int side = 2 * reach + 1;
    mean = mean / float(side * side);
    return true;
}

} // namespace

BounceGather::BounceGather(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                           const RadiosityPatches *pieces)
    : space_(in.space), scene_(scene), pieces_(pieces), joints_(in, surfaces, kWindow, kAlike),
      links_(surfaces.lightmaps.size()) {
    for (std::uint32_t i = 0; i < std::uint32_t(std::max(kSets * kRays, kVertexRays)); ++i)
        directions_.push_back(CosineDirection(i));
    for (const RawLightmap &raw : surfaces.lightmaps)
        rays_ += std::uint64_t(std::count_if(raw.luxelClusters.begin(), raw.luxelClusters.end(),
                                             [](int code) { return code >= 0; })) *
                 std::uint64_t(RaysALuxel(raw));
    keep_ = rays_ <= kMostLinks;
    if (!keep_)
        return;
    in.jobs.For(std::int64_t(links_.size()), [&](std::int64_t i, int) {
        links_[std::size_t(i)] = TransportLinks(surfaces.lightmaps[std::size_t(i)]);
    });
}

int BounceGather::RaysALuxel(const RawLightmap &raw) const {
    return std::max(kFewestRays, kRays / (raw.super * raw.super));
}

struct BounceGather::GatherBatch {
    std::uint32_t set = 0;
    std::size_t count = 0;
    std::array<std::size_t, kPacketSize> luxels{}, links{};

    void Add(std::size_t luxel, std::size_t link) { luxels[count] = luxel, links[count++] = link; }
};

/// Sixteen luxels that ask the same set ask a direction together: their rays go the same way.
std::vector<EmitterId> BounceGather::TransportLinks(const RawLightmap &raw) const {
    const auto count = std::size_t(RaysALuxel(raw));
    std::vector<std::size_t> first(raw.luxelClusters.size());
    std::size_t used = 0;
    for (std::size_t luxel = 0; luxel < first.size(); ++luxel) {
        first[luxel] = used;
        used += raw.Mapped(luxel) ? count : 0;
    }
    std::vector<EmitterId> links(used);
    std::array<GatherBatch, kSets> askers;
    for (std::uint32_t set = 0; set < kSets; ++set)
        askers[set].set = set;
    const auto ask = [&](GatherBatch &some) {
        Ask(raw, some, links);
        some.count = 0;
    };
    constexpr int kTile = 16; // each set has a packet of luxels in it
    for (int top = 0; top < raw.SuperHeight(); top += kTile)
        for (int left = 0; left < raw.SuperWidth(); left += kTile)
            for (int y = top; y < std::min(top + kTile, raw.SuperHeight()); ++y)
                for (int x = left; x < std::min(left + kTile, raw.SuperWidth()); ++x) {
                    const std::size_t luxel = raw.SuperIndex(x, y);
                    if (!raw.Mapped(luxel))
                        continue;
                    GatherBatch &some = askers[SetOf(x, y)];
                    some.Add(luxel, first[luxel]);
                    if (some.count == kPacketSize)
                        ask(some);
                }
    for (GatherBatch &some : askers)
        if (some.count > 0)
            ask(some);
    return links;
}

void BounceGather::Ask(const RawLightmap &raw, const GatherBatch &askers, std::vector<EmitterId> &links) const {
    const auto count = std::uint32_t(RaysALuxel(raw));
    std::vector<Frame> frames;
    RayPacket rays;
    rays.distance.fill(kEndless);
    for (std::size_t i = 0; i < askers.count; ++i) {
        const std::size_t luxel = askers.luxels[i];
        frames.emplace_back(raw.normals[luxel]);
        rays.origin.Set(i, ClearPlace(space_, raw, luxel, frames.back()));
        rays.live[i] = -1;
    }
    for (std::uint32_t ray = 0; ray < count; ++ray) {
        for (std::size_t i = 0; i < askers.count; ++i)
            rays.direction.Set(i, frames[i].World(directions_[askers.set * count + ray]));
        const auto found = scene_.FirstEmitters(rays, true);
        for (std::size_t i = 0; i < askers.count; ++i) {
            const std::size_t luxel = askers.luxels[i], at = askers.links[i] + ray;
            const float share = found[i] == kNoEmitter ? 0
                                : pieces_
                                    ? pieces_->Share(found[i], raw.positions[luxel], raw.normals[luxel], raw.twoSided)
                                    : 1;
            // TransportLinks have no weight: of those that count in part, that part is kept.
            links[at] = share > Fraction(std::uint32_t(at)) ? found[i] : kNoEmitter;
        }
    }
}

std::vector<Vec3f> BounceGather::GatheredIrradiance(const Emission &emission, std::size_t lightmap, std::size_t slot,
                                                    RawLightmap &raw) const {
    const int count = RaysALuxel(raw);
    const std::vector<EmitterId> anew = keep_ ? std::vector<EmitterId>{} : TransportLinks(raw);
    const std::vector<EmitterId> &links = keep_ ? links_[lightmap] : anew;
    std::vector<Vec3f> found(raw.luxelClusters.size());
    const bool directed = !raw.directions.empty() && slot == 0;
    std::size_t next = 0;
    for (std::size_t luxel = 0; luxel < raw.luxelClusters.size(); ++luxel) {
        if (!raw.Mapped(luxel))
            continue;
        const auto x = int(luxel % std::size_t(raw.SuperWidth())), y = int(luxel / std::size_t(raw.SuperWidth()));
        const std::uint32_t first = SetOf(x, y) * std::uint32_t(count);
        const Frame frame(raw.normals[luxel]);
        Vec3f sum, direction;
        for (int i = 0; i < count; ++i) {
            const EmitterId link = links[next++];
            if (link == kNoEmitter)
                continue;
            sum += emission[link];
            if (directed)
                direction += frame.World(directions_[first + std::uint32_t(i)]) * Luminance(emission[link]);
        }
        found[luxel] = sum / float(count);
        if (directed)
            raw.directions[luxel] += direction * (kBounceDirection / 255 / float(count));
    }
    return found;
}

void BounceGather::AddToLuxels(const std::vector<std::vector<Vec3f>> &all, std::size_t lightmap, std::size_t slot,
                               RawLightmap &raw) const {
    const std::vector<Vec3f> &found = all[lightmap];
    const int reach = kWindow * std::min(raw.super, 2);
    std::vector<Sample> samples;
    Neighbourhood neighbourhood;
    for (int y = 0; y < raw.SuperHeight(); ++y)
        for (int x = 0; x < raw.SuperWidth(); ++x) {
            const std::size_t luxel = raw.SuperIndex(x, y);
            if (!raw.Mapped(luxel))
                continue;
            Vec3f light;
            if (!MeanOfWindow(raw, found, x, y, reach, light)) {
                samples.clear();
                for (const auto &[near, dx, dy] : neighbourhood.Around(raw, x, y, reach))
                    samples.push_back({found[near], dx, dy});
                for (const auto &[other, near, dx, dy] : joints_.NeighborsAcross(lightmap, luxel))
                    if (!all[other].empty())
                        samples.push_back({all[other][near], dx, dy});
                light = PlaneAtCenter(samples);
            }
            raw.light[slot][luxel] += light;
        }
}

/// Decals and other surfaces a hair over a floor face it from nearer than the lift, which would take them through.
float BounceGather::LiftAt(const Vec3f &place, const Vec3f &normal) const {
    RayPacket ahead;
    ahead.Aim(0, place + normal * kLeastLift, place + normal * kLift);
    return scene_.FirstEmitters(ahead, false)[0] == kNoEmitter ? kLift : kLeastLift;
}

Vec3f BounceGather::At(const Vec3f &place, const Vec3f &normal, bool twoSided, const Emission &emission) const {
    const Frame frame(normal);
    Vec3f sum;
    const auto add = [&](std::size_t, EmitterId emitter) {
        if (emitter != kNoEmitter)
            sum += emission[emitter] * (pieces_ ? pieces_->Share(emitter, place, normal, twoSided) : 1);
    };
    const Vec3f start = place + normal * LiftAt(place, normal);
    auto rays = EmitterRays(scene_, add);
    for (std::uint32_t i = 0; i < std::uint32_t(kVertexRays); ++i)
        rays.Add(i, start, frame.World(directions_[i]), kEndless);
    rays.Flush();
    return sum / float(kVertexRays);
}

void BouncedLight::Gather(const Vec3f &place, std::uint64_t seed, std::vector<IndirectRay> &rays) const {
    rays.clear();
    std::array<Vec3f, kPlaceRays> directions;
    for (std::uint32_t i = 0; i < std::uint32_t(kPlaceRays); ++i) {
        const Sample2 s = PlasticSample(i, seed);
        const double z = 1 - 2 * s.u, radius = std::sqrt(std::max(0.0, 1 - z * z)), angle = 2 * std::numbers::pi * s.v;
        directions[i] = {float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(z)};
    }
    const auto add = [&](std::size_t i, EmitterId emitter) {
        rays.push_back({directions[i], emitter == kNoEmitter ? Vec3f{} : emission_[emitter]});
    };
    auto queue = EmitterRays(scene_, add);
    for (std::size_t i = 0; i < directions.size(); ++i)
        queue.Add(i, place, directions[i], kEndless);
    queue.Flush();
}

} // namespace q3
