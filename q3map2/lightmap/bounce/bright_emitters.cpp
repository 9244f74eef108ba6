// GPL-2.0-or-later. Next event estimation of the brightest emitters of a bounce: small patches in a light tree.
#include "q3map2/lightmap/bounce/bright_emitters.h"

#include "libs/math/sampling.h"
#include "libs/math/vec.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace q3 {

// ---- A light tree over small patches ----

namespace {

/// A cut descends into a node if radius / distance is above kMaxOpening, or the cosine between its axis and one of its
/// normals is below kMinNodeCosine. Chosen.
constexpr float kMaxOpening = 0.25f, kMinNodeCosine = 0.8f;
/// A node is flat if all its normals are within 2.6 degrees of its axis, of which this is the cosine.
constexpr float kFlatNodeCosine = 0.999f;

std::size_t LargestComponent(const Vec3f &v) {
    return v.x >= v.y && v.x >= v.z ? 0 : v.y >= v.z ? 1 : 2;
}

/// Patches with the same facing share a root: the axis nearest to the normal (0 to 2), plus 3 if the normal points to
/// its negative side, plus 6 instead if the patch is two-sided.
int FacingOf(const BrightPatch &patch) {
    const std::size_t axis = LargestComponent(Max(patch.normal, -patch.normal));
    return int(axis) + (patch.twoSided ? 6 : patch.normal[axis] < 0 ? 3 : 0);
}

/// Whether no receiver can get light from the node: the node is behind them, they are behind the node, or no cluster of
/// theirs sees it.
bool IsHidden(const BrightTree::Node &node, const ReceiverGroup &receivers, const BspSpace &space) {
    const Vec3f offset = node.center - receivers.center;
    const float reach = node.radius + receivers.radius;
    if (receivers.normal != Vec3f{} && Dot(receivers.normal, offset) < -reach)
        return true;
    if (!node.twoSided && node.minCosine > kFlatNodeCosine && Dot(node.axis, offset) > reach)
        return true;
    return node.cluster != BrightPatch::kNoCluster && !receivers.clusters.empty() &&
           std::none_of(receivers.clusters.begin(), receivers.clusters.end(),
                        [&](int cluster) { return space.Visible(cluster, node.cluster); });
}

} // namespace

BrightTree::BrightTree(std::vector<BrightPatch> patches) : patches_(std::move(patches)) {
    std::stable_sort(patches_.begin(), patches_.end(),
                     [](const BrightPatch &a, const BrightPatch &b) { return FacingOf(a) < FacingOf(b); });
    nodes_.reserve(2 * patches_.size());
    for (std::size_t first = 0; first < patches_.size();) {
        std::size_t end = first;
        while (end < patches_.size() && FacingOf(patches_[end]) == FacingOf(patches_[first]))
            ++end;
        roots_.push_back(Build(std::uint32_t(first), std::uint32_t(end - first)));
        first = end;
    }
    powerBefore_.push_back(0);
    for (const BrightPatch &patch : patches_)
        powerBefore_.push_back(powerBefore_.back() + double(Luminance(patch.radiosity)) * double(patch.area));
}

BrightTree::Node BrightTree::Sum(std::uint32_t first, std::uint32_t count) const {
    const std::span<const BrightPatch> patches(patches_.data() + first, count);
    Node node;
    node.first = first, node.count = count;
    node.cluster = patches[0].cluster, node.twoSided = patches[0].twoSided;
    float weights = 0;
    for (const BrightPatch &patch : patches) {
        const float weight = Luminance(patch.radiosity) * patch.area;
        node.center += patch.center * weight;
        node.axis += patch.normal * weight;
        node.power += patch.radiosity * patch.area;
        node.area += patch.area;
        weights += weight;
        if (patch.cluster != node.cluster)
            node.cluster = BrightPatch::kNoCluster;
    }
    node.center = node.center / weights;
    node.axis = Normalize(node.axis);
    for (const BrightPatch &patch : patches) {
        node.radius = std::max(node.radius, Length(patch.center - node.center) + std::sqrt(patch.area) / 2);
        node.minCosine = std::min(node.minCosine, Dot(patch.normal, node.axis));
    }
    return node;
}

std::uint32_t BrightTree::Build(std::uint32_t first, std::uint32_t count) {
    const auto number = std::uint32_t(nodes_.size());
    nodes_.push_back(Sum(first, count));
    if (count == 1)
        return number;
    Boundsf bounds;
    const auto begin = patches_.begin() + first;
    for (auto patch = begin; patch != begin + count; ++patch)
        bounds.Add(patch->center);
    const std::size_t axis = LargestComponent(bounds.maxs - bounds.mins);
    const std::uint32_t half = count / 2;
    std::nth_element(begin, begin + half, begin + count, [&](const BrightPatch &a, const BrightPatch &b) {
        return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.emitter < b.emitter;
    });
    Build(first, half);
    nodes_[number].right = Build(first + half, count - half);
    return number;
}

void BrightTree::Cut(const ReceiverGroup &receivers, const BspSpace &space, float faint,
                     std::vector<std::uint32_t> &cut) const {
    std::vector<std::uint32_t> pending(roots_.rbegin(), roots_.rend());
    while (!pending.empty()) {
        const std::uint32_t number = pending.back();
        pending.pop_back();
        const Node &node = nodes_[number];
        if (IsHidden(node, receivers, space))
            continue;
        const float distance = Length(node.center - receivers.center) - receivers.radius;
        if (node.right == 0 || MostLight(node, receivers) < faint ||
            (node.radius < kMaxOpening * distance && node.minCosine > kMinNodeCosine))
            cut.push_back(number);
        else
            pending.push_back(node.right), pending.push_back(number + 1);
    }
}

float BrightTree::MostLight(const Node &node, const ReceiverGroup &receivers) {
    const float nearest = std::max(Length(node.center - receivers.center) - receivers.radius - node.radius, 1.0f);
    return Luminance(node.power) / (std::numbers::pi_v<float> * nearest * nearest);
}

const BrightPatch &BrightTree::PatchAt(const Node &node, float u) const {
    const auto first = powerBefore_.begin() + node.first + 1, end = first + (node.count - 1);
    const double from = powerBefore_[node.first], to = powerBefore_[node.first + node.count];
    return patches_[std::size_t(std::upper_bound(first, end, from + double(u) * (to - from)) - first) + node.first];
}

// ---- Patches of the brightest emitters ----

namespace {

/// Texels are cut into this many pieces on each axis.
constexpr int kPieces = 2;
/// Triangles whose doubled area in the lightmap is smaller make no patches. In areas of a piece.
constexpr float kMinTwiceArea = 1e-6f;

float TwiceArea(const LuxelTriangle &t) {
    return (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[2][0] - t[0][0]) * (t[1][1] - t[0][1]);
}

/// The part of a triangle inside the square piece (x, y); in units of pieces.
Winding<float> ClippedToPiece(const LuxelTriangle &triangle, int x, int y) {
    Winding<float> clipped, rest;
    for (const auto &corner : triangle)
        clipped.push_back({corner[0], corner[1], 0});
    WindingCutter<float> cutter;
    const auto cut = [&](const Vec3f &normal, float dist) {
        if (clipped.empty())
            return;
        cutter.Classify(clipped, normal, dist, 0);
        cutter.Back(clipped, rest);
        clipped.swap(rest);
    };
    cut({1, 0, 0}, float(x + 1)), cut({-1, 0, 0}, float(-x));
    cut({0, 1, 0}, float(y + 1)), cut({0, -1, 0}, float(-y));
    return clipped;
}

/// Area and centroid of a polygon in the plane z = 0.
std::pair<float, Vec3f> AreaAndCentroid(const Winding<float> &w) {
    float area = 0;
    Vec3f sum;
    for (std::size_t i = 2; i < w.size(); ++i) {
        const float part = std::abs(Cross(w[i - 1] - w[0], w[i] - w[0]).z) / 2;
        area += part;
        sum += (w[0] + w[i - 1] + w[i]) * (part / 3);
    }
    return {area, area > 0 ? sum / area : sum};
}

/// A triangle of a face; `normal` points to the front.
struct EmittingTriangle {
    std::array<FaceCorner, 3> corners;
    Vec3f normal;   ///< unit
    float area = 0; ///< square game units
    Vec3f At(float u, float v) const { return corners[0].xyz * (1 - u - v) + corners[1].xyz * u + corners[2].xyz * v; }
};

template <typename Use> void ForTriangles(const Face &face, const Use &use) {
    Vec3f front;
    for (const FaceCorner &corner : face)
        front += corner.normal;
    for (std::size_t i = 2; i < face.size(); ++i) {
        EmittingTriangle triangle{{face[0], face[i - 1], face[i]}, {}, 0};
        const Vec3f cross = Cross(face[i].xyz - face[0].xyz, face[i - 1].xyz - face[0].xyz);
        triangle.area = Length(cross) / 2;
        if (!(triangle.area > 0))
            continue;
        triangle.normal = Normalize(Dot(cross, front) < 0 ? -cross : cross);
        use(triangle);
    }
}

/// Collects the pieces of the texels of a raw lightmap.
class LightmapPieces {
  public:
    LightmapPieces(const RawLightmap &raw, EmitterId first, std::span<const Vec3f> excess)
        : raw_(raw), first_(first), excess_(excess), width_(raw.width * kPieces), height_(raw.height * kPieces),
          pieces_(std::size_t(width_) * std::size_t(height_)) {}

    void Add(const EmittingTriangle &triangle, bool twoSided) {
        LuxelTriangle inPieces;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t axis = 0; axis < 2; ++axis)
                inPieces[i][axis] = triangle.corners[i].luxel[axis] * float(kPieces) / float(raw_.super);
        const float twiceArea = TwiceArea(inPieces);
        if (std::abs(twiceArea) < kMinTwiceArea)
            return;
        ForCoveredLuxels(inPieces, width_, height_, [&](int x, int y) {
            if (Excess(x, y) == Vec3f{})
                return;
            const auto [area, center] = AreaAndCentroid(ClippedToPiece(inPieces, x, y));
            if (!(area > 0))
                return;
            const std::array<float, 2> at{center.x, center.y};
            const float u = TwiceArea({inPieces[0], at, inPieces[2]}) / twiceArea,
                        v = TwiceArea({inPieces[0], inPieces[1], at}) / twiceArea;
            Piece &piece = pieces_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
            const float worldArea = area * triangle.area / (std::abs(twiceArea) / 2);
            piece.area += worldArea;
            piece.center += triangle.At(u, v) * worldArea;
            piece.normal += triangle.normal * worldArea;
            piece.twoSided = piece.twoSided || twoSided;
        });
    }
    void Append(std::vector<BrightPatch> &patches) const {
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                const Piece &piece = pieces_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
                const Vec3f normal = Normalize(piece.normal);
                if (!(piece.area > 0) || normal == Vec3f{})
                    continue;
                const int half = raw_.super / 2, tx = x / kPieces, ty = y / kPieces;
                const int cluster = raw_.luxelClusters[raw_.SuperIndex(tx * raw_.super + half, ty * raw_.super + half)];
                patches.push_back({piece.center / piece.area, normal, piece.area, Excess(x, y),
                                   first_ + EmitterId(raw_.Index(tx, ty)),
                                   cluster >= 0 ? cluster : BrightPatch::kNoCluster, piece.twoSided});
            }
    }

  private:
    struct Piece {
        Vec3f center, normal; // times area
        float area = 0;
        bool twoSided = false;
    };
    const Vec3f &Excess(int x, int y) const { return excess_[first_ + raw_.Index(x / kPieces, y / kPieces)]; }

    const RawLightmap &raw_;
    EmitterId first_;
    std::span<const Vec3f> excess_;
    int width_, height_;
    std::vector<Piece> pieces_;
};

/// Appends a patch for each corner of a triangle whose vertex has excess: the part of the triangle nearest to it.
void AppendVertexPatches(const EmittingTriangle &triangle, bool twoSided, const EmitterIndex &emitters,
                         std::span<const Vec3f> excess, std::vector<BrightPatch> &patches) {
    // Barycentric coordinates of the centroid of such a part, the quad of the corner, the middles of its two edges and
    // the center: (1 + 1/2 + 1/3) / 3 for the corner, and half of the rest for each other.
    constexpr float kOwn = 11.0f / 18, kOther = 7.0f / 36;
    for (std::size_t i = 0; i < 3; ++i) {
        const EmitterId emitter = emitters.Vertex(triangle.corners[i].vertex);
        if (excess[emitter] == Vec3f{})
            continue;
        const Vec3f center = triangle.corners[i].xyz * kOwn + triangle.corners[(i + 1) % 3].xyz * kOther +
                             triangle.corners[(i + 2) % 3].xyz * kOther;
        patches.push_back(
            {center, triangle.normal, triangle.area / 3, excess[emitter], emitter, BrightPatch::kNoCluster, twoSided});
    }
}

} // namespace

std::vector<BrightPatch> MakeBrightPatches(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                           const EmitterIndex &emitters, std::span<const Vec3f> excess) {
    const auto anyIn = [&](EmitterId first, std::size_t count) {
        return std::any_of(excess.begin() + first, excess.begin() + first + std::ptrdiff_t(count),
                           [](const Vec3f &one) { return one != Vec3f{}; });
    };
    std::vector<BrightPatch> patches;
    for (std::size_t i = 0; i < surfaces.lightmaps.size(); ++i) {
        const RawLightmap &raw = surfaces.lightmaps[i];
        const EmitterId first = emitters.FirstOf(i);
        if (!anyIn(first, std::size_t(raw.width) * std::size_t(raw.height)))
            continue;
        LightmapPieces pieces(raw, first, excess);
        for (const int surface : raw.surfaces)
            if (IsInBounceScene(in, std::size_t(surface)))
                for (const Face &face : FacesOf(in, surfaces, std::size_t(surface)))
                    ForTriangles(face, [&](const EmittingTriangle &triangle) {
                        pieces.Add(triangle, in.table[std::size_t(surface)].shader->twoSided);
                    });
        pieces.Append(patches);
    }
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i) {
        const bspDrawSurface_t &surface = in.bsp.drawSurfaces[i];
        if (surfaces.lightmapOf[i] >= 0 || surface.numVerts == 0 || !IsInBounceScene(in, i) ||
            !anyIn(emitters.Vertex(surface.firstVert), std::size_t(surface.numVerts)))
            continue;
        for (const Face &face : FacesOf(in, surfaces, i))
            ForTriangles(face, [&](const EmittingTriangle &triangle) {
                AppendVertexPatches(triangle, in.table[i].shader->twoSided, emitters, excess, patches);
            });
    }
    return patches;
}

// ---- Shadow rays to the nodes of a cut ----

namespace {

/// Russian roulette: a node that gives less light than this to a receiver (on a surface, or a point in the open) is
/// sampled with a probability proportional to its light. Byte scale.
constexpr float kSurfaceRoulette = 0.1f, kPointRoulette = 0.5f;
/// Shadow rays end kPatchGap (game units) in front of the patch, but at least at the fraction kPatchFraction of the
/// distance to it.
constexpr float kPatchGap = 0.25f, kPatchFraction = 0.99f;
/// "Roulette" and "Stride" in ASCII: keep the two random choices independent.
constexpr std::uint64_t kRouletteSeed = 0x526F756C65747465u, kStrideSeed = 0x537472696465u;
/// A node whose most light is 1 / s of the roulette limit is tried at every s-th receiver only, with s at most this.
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

/// Up to kPacketSize receivers close together.
struct BrightEmitters::Receivers {
    ReceiverGroup group;
    std::size_t count = 0;
    std::array<Vec3f, kPacketSize> position, origin, normal; // zero normal: a point in the open
    std::array<std::size_t, kPacketSize> tag{};              // luxel, or a hash for other receivers; seeds the sampling
    bool twoSided = false;
    float rouletteLimit = kSurfaceRoulette; // nodes that give less light are sampled by Russian roulette

    void Add(const Vec3f &at, const Vec3f &rayOrigin, const Vec3f &facing, std::size_t number, int cluster) {
        position[count] = at, origin[count] = rayOrigin, normal[count] = facing, tag[count++] = number;
        auto &clusters = group.clusters;
        if (cluster >= 0 && std::find(clusters.begin(), clusters.end(), cluster) == clusters.end())
            clusters.push_back(cluster);
    }
    /// Call after the last Add.
    void SetGroup() {
        Boundsf bounds;
        for (std::size_t i = 0; i < count; ++i)
            bounds.Add(origin[i]);
        group.center = bounds.Center();
        group.radius = 0;
        group.normal = normal[0];
        for (std::size_t i = 0; i < count; ++i) {
            group.radius = std::max(group.radius, Length(origin[i] - group.center));
            if (normal[i] != normal[0])
                group.normal = {};
        }
    }
};

BrightEmitters::BrightEmitters(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                               const EmitterIndex &emitters, const FaintPatches *patches, float limit,
                               std::vector<Vec3f> &emission)
    : space_(in.space), scene_(scene), patches_(patches), tree_([&] {
          auto bright = MakeBrightPatches(in, surfaces, emitters, TakeExcess(limit, emission));
          patchCount_ = bright.size();
          return bright;
      }()) {}

/// Samples the light of a node on receiver i before visibility; target: the end of the shadow ray. False: no light, or
/// rejected by roulette.
bool BrightEmitters::SampleNode(const Receivers &receivers, std::size_t i, std::uint32_t number, std::uint32_t stride,
                                Sample &sample, Vec3f &target) const {
    const BrightTree::Node &node = tree_.At(number);
    const Vec3f offset = node.center - receivers.origin[i];
    const float distance2 = std::max(Dot(offset, offset), 1e-6f); // not 0
    const Vec3f direction = offset / std::sqrt(distance2);
    const bool oriented = receivers.normal[i] != Vec3f{};
    const float cosine = oriented ? Dot(direction, receivers.normal[i]) : 1;
    const float emitted = node.twoSided ? std::abs(Dot(direction, node.axis)) : -Dot(direction, node.axis);
    if (!(cosine > 0) || !(emitted > 0))
        return false;
    // Irradiance over power on a receiver that faces the node. The node counts as a disk of its projected area
    // A = area * emitted: emitted / (pi d^2 + A), finite at small distances (Wallace et al., A Ray Tracing Algorithm
    // for Progressive Radiosity, 1989).
    float fraction = emitted / (std::numbers::pi_v<float> * distance2 + node.area * emitted);
    const std::uint64_t hash = HashIndex(kRouletteSeed + (std::uint64_t(receivers.tag[i]) << 24) + number);
    // The caller tries this receiver with probability 1 / stride.
    const float strength = Luminance(node.power) * fraction * cosine,
                rouletteLimit = receivers.rouletteLimit / float(stride);
    if (strength < rouletteLimit) {
        if (UnitFloatFromHash(hash) * rouletteLimit >= strength)
            return false;
        fraction *= rouletteLimit / strength;
    }
    fraction *= float(stride);
    // The lower 24 bits of the hash; roulette takes the upper ones.
    const BrightPatch &patch = tree_.PatchAt(node, UnitFloatFromHash(hash << 40));
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
    // Nodes that give less than a quarter of the roulette limit are not split (chosen).
    tree_.Cut(receivers.group, space_, receivers.rouletteLimit / 4, cut);
    auto rays = MakeRayBatcher<Sample>([&](RayPacket &packet, std::span<const Sample> waiting) {
        scene_.TraceOccluded(packet);
        for (std::size_t ray = 0; ray < waiting.size(); ++ray)
            if (packet.live[ray] != 0)
                samples.push_back(waiting[ray]);
    });
    for (const std::uint32_t node : cut) {
        // A faint node is tried at every stride-th receiver only, starting at a random one.
        const float most = BrightTree::MostLight(tree_.At(node), receivers.group);
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
    constexpr int kBlock = 4; // luxels on a side: kPacketSize receivers
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
            receivers.SetGroup();
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
    receivers.SetGroup();
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
    receivers.SetGroup();
    std::vector<Sample> samples;
    SampleTree(receivers, samples);
    for (const Sample &sample : samples)
        rays.push_back({sample.direction, sample.light});
}

} // namespace q3
