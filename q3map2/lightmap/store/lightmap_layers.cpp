// GPL-2.0-or-later. Lightmaps to be packed: one per style, those that vertex colors can replace left out, similar ones
// in shared texels.
#include "q3map2/lightmap/store/lightmap_layers.h"

#include "q3map2/light/options/light_tone.h"
#include "q3map2/lightmap/raw/luxel_raster.h"
#include "q3map2/lightmap/store/lightmap_store.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

namespace q3 {

// ---- Lightmaps to be packed ----

namespace {

/// Greatest channel difference within a solid lightmap, and between two solid ones that share a texel. Byte scale.
constexpr float kSolidDifference = 0.0625f;
/// Channel differences of texels that twins share are less than this. Byte scale.
constexpr float kTwinDifference = 3;
/// Bound of twins on the running mean over texels of (|dr| + |dg| + |db|) / 768: three channels of 256 values.
constexpr float kTwinMean = 0.0025f, kAllChannels = 3 * 256;
/// Greatest difference of direction components within a solid lightmap: one step of their bytes.
constexpr float kSolidDirection = 1.0f / 127;

float MaxDifference(const Vec3f &a, const Vec3f &b) {
    const Vec3f d = a - b;
    return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
}

// ---- Seams of closed patches ----

/// Whether red below 0 marks an unused texel.
enum class UnusedTexels { None, RedBelowZero };

/// Averages the two texels; an unused one takes the other's value.
void JoinTexels(Vec3f &a, Vec3f &b, UnusedTexels unused) {
    if (unused == UnusedTexels::RedBelowZero && (a.x < 0 || b.x < 0)) {
        (a.x < 0 ? a : b) = a.x < 0 ? b : a;
        return;
    }
    a = b = (a + b) * 0.5f;
}

void JoinSeams(const RawLightmap &lightmap, std::vector<Vec3f> &texels, UnusedTexels unused) {
    if (texels.empty())
        return;
    if (lightmap.wrapS)
        for (int y = 0; y < lightmap.height; ++y)
            JoinTexels(texels[lightmap.Index(0, y)], texels[lightmap.Index(lightmap.width - 1, y)], unused);
    if (lightmap.wrapT)
        for (int x = 0; x < lightmap.width; ++x)
            JoinTexels(texels[lightmap.Index(x, 0)], texels[lightmap.Index(x, lightmap.height - 1)], unused);
}

// ---- Directions of the mean light ----

/// Components of d along the tangent, the bitangent and the normal n. The tangent is horizontal; which way it points
/// depends on the signs of n.
Vec3f InTangentSpace(const Vec3f &d, const Vec3f &n) {
    Vec3f tangent{n.z < 0 ? -1.0f : 1.0f, 0, 0}, bitangent{0, 1, 0};
    if (n.x != 0 || n.y != 0) {
        tangent = Normalize(Cross(n, Vec3f{0, 0, 1}));
        bitangent = Normalize(Cross(tangent, n));
    }
    if (n.x > 0 || n.y < 0 || n.z < 0)
        tangent = -tangent;
    return {Dot(d, tangent), Dot(d, bitangent), Dot(d, n)};
}

void FinishDirections(const RawLightmap &lightmap, bool tangentSpace, std::vector<Vec3f> &directions) {
    for (Vec3f &d : directions)
        d = Normalize(d);
    if (!tangentSpace || directions.empty())
        return;
    for (int y = 0; y < lightmap.height; ++y)
        for (int x = 0; x < lightmap.width; ++x) {
            Vec3f &d = directions[lightmap.Index(x, y)];
            d = InTangentSpace(d, MeanNormal(lightmap, x, y));
        }
}

// ---- Solid lightmaps: of one color ----

bool DirectionsAgree(const LightmapLayer &layer) {
    return std::all_of(layer.directions.begin(), layer.directions.end(),
                       [&](const Vec3f &d) { return MaxDifference(d, layer.directions.front()) <= kSolidDirection; });
}

/// Marks lightmaps of at most 2 x 2 luxels or one color as solid.
void FindSolid(LightmapLayer &layer) {
    Vec3f least = layer.texels.front(), most = least;
    for (const Vec3f &texel : layer.texels)
        least = Min(least, texel), most = Max(most, texel);
    const bool tiny = layer.width <= 2 && layer.height <= 2;
    if (!tiny && (least.x < 0 || MaxDifference(least, most) > kSolidDifference || !DirectionsAgree(layer)))
        return;
    layer.solid = true;
    layer.color = Max(least, Vec3f{});
    for (const Vec3f &d : layer.directions)
        layer.direction += d;
    layer.direction = Normalize(layer.direction);
}

// ---- Twins: lightmaps whose texels are nearly equal ----

/// A few texels of a layer: most pairs of layers already differ in one of them.
struct TwinKey {
    std::array<Vec3f, 4> texels;
    bool Differs(const TwinKey &other) const {
        for (std::size_t i = 0; i < texels.size(); ++i)
            if (texels[i].x >= 0 && other.texels[i].x >= 0 &&
                MaxDifference(texels[i], other.texels[i]) >= kTwinDifference)
                return true;
        return false;
    }
};

TwinKey KeyOf(const LightmapLayer &layer) {
    TwinKey key;
    if (layer.solid) {
        key.texels.fill(layer.color);
        return key;
    }
    // The middles of four equal parts of the rows.
    for (std::size_t i = 0; i < key.texels.size(); ++i)
        key.texels[i] = layer.texels[(2 * i + 1) * layer.texels.size() / (2 * key.texels.size())];
    return key;
}

bool Alike(const LightmapLayer &a, const LightmapLayer &b) {
    if (a.solid)
        return MaxDifference(a.color, b.color) <= kSolidDifference;
    float sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < a.texels.size(); ++i) {
        if (!a.Used(i) || !b.Used(i))
            continue;
        const Vec3f d = a.texels[i] - b.texels[i];
        if (MaxDifference(a.texels[i], b.texels[i]) >= kTwinDifference)
            return false;
        sum += (std::abs(d.x) + std::abs(d.y) + std::abs(d.z)) / kAllChannels;
        if (sum > kTwinMean * float(++count))
            return false;
    }
    return true;
}

/// Adds b to the running mean a of `count` layers, b included.
void Join(LightmapLayer &a, const LightmapLayer &b, int count) {
    const float fraction = 1 / float(count);
    a.color += (b.color - a.color) * fraction;
    for (std::size_t i = 0; i < a.texels.size() && !a.solid; ++i)
        if (!a.Used(i))
            a.texels[i] = b.texels[i];
        else if (b.Used(i))
            a.texels[i] += (b.texels[i] - a.texels[i]) * fraction;
}

/// Finds twins among layers of one size, in order.
void JoinGroup(const std::vector<std::size_t> &group, std::vector<LightmapLayer> &layers) {
    std::vector<TwinKey> keys;
    for (const std::size_t i : group)
        keys.push_back(KeyOf(layers[i]));
    for (std::size_t i = 0; i < group.size(); ++i) {
        LightmapLayer &first = layers[group[i]];
        int count = 1;
        for (std::size_t j = i + 1; j < group.size() && first.twin < 0; ++j) {
            LightmapLayer &second = layers[group[j]];
            if (keys[i].Differs(keys[j]) || second.twin >= 0 || !Alike(first, second))
                continue;
            Join(first, second, ++count);
            second.twin = int(group[i]);
            keys[i] = KeyOf(first);
        }
    }
}

/// Whether all bytes of a style would be 0 and nothing but bytes is stored. Engines would draw a stage for nothing.
bool ShowsNothing(const SurfaceInputs &in, const RawLightmap &lightmap, std::size_t slot) {
    if (in.lightmap.hdr || in.lightmap.lightmass || !lightmap.resultChannels[slot].empty())
        return false;
    const ToneOptions tone = StoredTone(in);
    const ToneMapper mapper(1, lightmap.brightness, tone);
    constexpr std::array<std::uint8_t, 3> kBlack{};
    return std::all_of(lightmap.result[slot].begin(), lightmap.result[slot].end(),
                       [&](const Vec3f &texel) { return texel.x < 0 || mapper.Bytes(texel) == kBlack; });
}

} // namespace

LightmapLayers MakeLayers(const SurfaceInputs &in, SurfaceLight &surfaces) {
    LightmapLayers layers;
    layers.layerOf.resize(surfaces.lightmaps.size());
    for (std::size_t i = 0; i < surfaces.lightmaps.size(); ++i)
        for (std::size_t slot = 0; slot < kStyles; ++slot) {
            const RawLightmap &lightmap = surfaces.lightmaps[i];
            const bool used = lightmap.styles[slot] != kNoStyle && !lightmap.result[slot].empty() &&
                              (slot == 0 || (layers.layerOf[i][0] >= 0 && !ShowsNothing(in, lightmap, slot)));
            layers.layerOf[i][slot] = used ? int(layers.layers.size()) : -1;
            if (!used)
                continue;
            LightmapLayer &layer = layers.layers.emplace_back();
            layer.lightmap = int(i), layer.slot = slot;
            layer.width = lightmap.width, layer.height = lightmap.height, layer.pageSize = lightmap.pageSize;
            layer.brightness = lightmap.brightness;
            layer.kinds = lightmap.channels;
        }
    const bool collapse = in.lightmap.collapse && !surfaces.styled;
    in.jobs.For(std::int64_t(layers.layers.size()), [&](std::int64_t i, int) {
        LightmapLayer &layer = layers.layers[std::size_t(i)];
        RawLightmap &lightmap = surfaces.lightmaps[std::size_t(layer.lightmap)];
        layer.texels = lightmap.result[layer.slot];
        layer.channels = std::move(lightmap.resultChannels[layer.slot]);
        layer.directions = lightmap.resultDirections;
        JoinSeams(lightmap, layer.texels, UnusedTexels::RedBelowZero);
        JoinSeams(lightmap, layer.directions, UnusedTexels::None);
        for (std::vector<Vec3f> &channel : layer.channels)
            JoinSeams(lightmap, channel, UnusedTexels::None);
        FinishDirections(lightmap, in.lightmap.deluxeTangent, layer.directions);
        if (collapse && layer.channels.empty())
            FindSolid(layer);
    });
    return layers;
}

void JoinTwins(std::vector<LightmapLayer> &layers) {
    std::map<std::tuple<int, int, std::array<int, 2>, float, int>, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const LightmapLayer &layer = layers[i];
        if (layer.byVertex || !layer.channels.empty())
            continue;
        // Solid layers are compared only within a bucket of red, for speed: twins mostly have exactly equal colors.
        const int redBucket = layer.solid ? int(std::clamp(layer.color.x / kSolidDifference, 0.0f, 1e6f)) : 0;
        const std::array<int, 2> size = layer.solid ? std::array{-1, -1} : std::array{layer.width, layer.height};
        groups[{size[0], size[1], layer.pageSize, layer.brightness, redBucket}].push_back(i);
    }
    for (const auto &[key, group] : groups)
        JoinGroup(group, layers);
}

std::vector<std::size_t> PackingOrder(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                      const LightmapLayers &layers) {
    std::map<std::string_view, int> rankOf;
    for (const SurfaceEntry &entry : in.table)
        rankOf[entry.shader->name] = 0;
    int rank = 0;
    for (auto &[name, number] : rankOf)
        number = rank++;
    struct Key {
        std::vector<int> shaders; ///< ranks, each once
        int minusStyles = 0;      ///< minus the sum of styles, 255 for a free slot: few styles come first
        int minusArea = 0;        ///< large ones come first
    };
    std::vector<Key> keys(surfaces.lightmaps.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const RawLightmap &lightmap = surfaces.lightmaps[i];
        for (const int surface : lightmap.surfaces)
            keys[i].shaders.push_back(rankOf[in.table[std::size_t(surface)].shader->name]);
        std::sort(keys[i].shaders.begin(), keys[i].shaders.end());
        keys[i].shaders.erase(std::unique(keys[i].shaders.begin(), keys[i].shaders.end()), keys[i].shaders.end());
        for (const std::uint8_t style : lightmap.styles)
            keys[i].minusStyles -= style;
        keys[i].minusArea = -lightmap.width * lightmap.height;
    }
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < layers.layers.size(); ++i)
        if (layers.layers[i].twin < 0 && !layers.layers[i].byVertex)
            order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const Key &x = keys[std::size_t(layers.layers[a].lightmap)], &y = keys[std::size_t(layers.layers[b].lightmap)];
        return std::tie(x.shaders, x.minusStyles, x.minusArea) < std::tie(y.shaders, y.minusStyles, y.minusArea);
    });
    return order;
}

// ---- -approx: lightmaps that vertex colors can replace ----

namespace {

/// Surfaces with bounds up to this on each axis need no lightmap. Luxels.
constexpr float kTinyLuxels = 2;
/// Compared points are -thresh apart, but at least this. Luxels.
constexpr float kLeastSpacing = 0.125f;
/// Largest number of samples along a curve of a patch.
constexpr int kMaxSteps = 64;
/// Largest number of halvings of a triangle: bounds the recursion for any threshold.
constexpr int kMaxDepth = 20;

/// Interpolated vertex color at a point of a surface, and where it is in the lightmap.
struct SurfaceSample {
    std::array<float, 2> luxel{}; ///< of the lightmap, not of the super grid
    Vec3f color;                  ///< as stored, and blended as engines do; byte scale
};

SurfaceSample Blend(const SurfaceSample &a, const SurfaceSample &b, float fraction) {
    SurfaceSample result;
    for (std::size_t i = 0; i < 2; ++i)
        result.luxel[i] = a.luxel[i] + (b.luxel[i] - a.luxel[i]) * fraction;
    result.color = a.color + (b.color - a.color) * fraction;
    return result;
}

/// The sample at t of the quadratic curve with these control points.
SurfaceSample OnCurve(const SurfaceSample &a, const SurfaceSample &b, const SurfaceSample &c, float t) {
    return Blend(Blend(a, b, t), Blend(b, c, t), t);
}

float SquaredDistance(const SurfaceSample &a, const SurfaceSample &b) {
    const float s = a.luxel[0] - b.luxel[0], t = a.luxel[1] - b.luxel[1];
    return s * s + t * t;
}

std::array<std::uint8_t, 3> FirstThree(const std::array<std::uint8_t, 4> &color) {
    return {color[0], color[1], color[2]};
}

class Approximation {
  public:
    Approximation(const SurfaceInputs &in, const SurfaceLight &surfaces, const RawLightmap &lightmap)
        : in_(in), surfaces_(surfaces), lightmap_(lightmap),
          spacing_(std::max(std::abs(in.lightmap.threshold), kLeastSpacing)), tone_(StoredTone(in)) {}

    bool Matches(int surface) const {
        const bspDrawSurface_t &record = in_.bsp.drawSurfaces[std::size_t(surface)];
        const ShaderInfo &shader = *in_.table[std::size_t(surface)].shader;
        if (shader.lightmap.noVertexLight)
            return false;
        if (record.surfaceType == MST_PATCH)
            return PatchMatches(record, shader);
        for (int i = record.firstIndex; i < record.firstIndex + record.numIndexes; i += 3) {
            std::array<SurfaceSample, 3> corners;
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = AtVertex(record.firstVert + in_.bsp.drawIndexes[std::size_t(i) + k], shader);
            if (!std::all_of(corners.begin(), corners.end(), [&](const SurfaceSample &s) { return IsClose(s); }) ||
                !TriangleMatches(corners, 0))
                return false;
        }
        return true;
    }

  private:
    SurfaceSample AtVertex(int vertex, const ShaderInfo &shader) const {
        SurfaceSample sample;
        const auto v = std::size_t(vertex);
        for (std::size_t i = 0; i < 2; ++i)
            sample.luxel[i] = surfaces_.verts[v].luxel[i] / float(lightmap_.super);
        const auto color = surfaces_.vertex.sum[0].empty()
                               ? FirstThree(in_.bsp.drawVerts[v].color[0])
                               : VertexBytes(in_, shader, surfaces_.vertex.sum[0][v], tone_);
        sample.color = {float(color[0]), float(color[1]), float(color[2])};
        return sample;
    }

    bool IsClose(const SurfaceSample &sample) const {
        const std::size_t at =
            lightmap_.Index(LuxelOf(sample.luxel[0], lightmap_.width), LuxelOf(sample.luxel[1], lightmap_.height));
        for (std::size_t slot = 0; slot < kStyles; ++slot) {
            if (lightmap_.styles[slot] == kNoStyle || lightmap_.result[slot].empty())
                continue;
            const Vec3f &luxel = lightmap_.result[slot][at];
            if (luxel.x < 0)
                continue;
            const Vec3f least = slot == 0 ? in_.world.minLight : Vec3f{};
            const auto wanted = ColorToBytes(Max(luxel, least), 1, lightmap_.brightness, tone_);
            const Vec3f got = slot == 0 ? sample.color : Vec3f{}; // vertices have no light of other styles
            for (std::size_t i = 0; i < 3; ++i)
                if (std::abs(float(wanted[i]) - got[i]) > in_.lightmap.approximate)
                    return false;
        }
        return true;
    }

    /// Compares at the midpoint of the longest edge, and so on for both halves until all edges are short.
    bool TriangleMatches(const std::array<SurfaceSample, 3> &corners, int depth) const {
        std::size_t longest = 0;
        float length = 0;
        for (std::size_t i = 0; i < 3; ++i)
            if (const float d = SquaredDistance(corners[i], corners[(i + 1) % 3]); d > length)
                longest = i, length = d;
        if (length <= spacing_ * spacing_ || depth >= kMaxDepth)
            return true;
        const SurfaceSample middle = Blend(corners[longest], corners[(longest + 1) % 3], 0.5f);
        if (!IsClose(middle))
            return false;
        std::array<SurfaceSample, 3> one = corners, other = corners;
        one[(longest + 1) % 3] = other[longest] = middle;
        return TriangleMatches(one, depth + 1) && TriangleMatches(other, depth + 1);
    }

    int Steps(const SurfaceSample &a, const SurfaceSample &b, const SurfaceSample &c) const {
        const float length = std::sqrt(SquaredDistance(a, b)) + std::sqrt(SquaredDistance(b, c));
        return int(std::max(1.0f, std::min(float(kMaxSteps), std::ceil(length / spacing_)))); // no int may hold it
    }

    /// Compares on a grid over each biquadratic patch of 3 x 3 control points, as engines tessellate it.
    bool PatchMatches(const bspDrawSurface_t &record, const ShaderInfo &shader) const {
        for (int y = 0; y + 2 < record.patchHeight; y += 2)
            for (int x = 0; x + 2 < record.patchWidth; x += 2) {
                std::array<std::array<SurfaceSample, 3>, 3> points;
                for (int row = 0; row < 3; ++row)
                    for (int column = 0; column < 3; ++column)
                        points[std::size_t(row)][std::size_t(column)] =
                            AtVertex(record.firstVert + (y + row) * record.patchWidth + x + column, shader);
                if (!SubPatchMatches(points))
                    return false;
            }
        return true;
    }

    bool SubPatchMatches(const std::array<std::array<SurfaceSample, 3>, 3> &p) const {
        int across = 1, down = 1;
        for (std::size_t i = 0; i < 3; ++i) {
            across = std::max(across, Steps(p[i][0], p[i][1], p[i][2]));
            down = std::max(down, Steps(p[0][i], p[1][i], p[2][i]));
        }
        for (int x = 0; x <= across; ++x) {
            std::array<SurfaceSample, 3> column;
            for (std::size_t row = 0; row < 3; ++row)
                column[row] = OnCurve(p[row][0], p[row][1], p[row][2], float(x) / float(across));
            for (int y = 0; y <= down; ++y)
                if (!IsClose(OnCurve(column[0], column[1], column[2], float(y) / float(down))))
                    return false;
        }
        return true;
    }

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    const RawLightmap &lightmap_;
    float spacing_; ///< largest distance between compared points, luxels
    ToneOptions tone_;
};

VertexStandIn StandInFor(const SurfaceInputs &in, const SurfaceLight &surfaces, const RawLightmap &lightmap) {
    const auto usesVertexLight = [&](int surface) {
        return !in.table[std::size_t(surface)].shader->lightmap.noVertexLight;
    };
    const Vec3f size = lightmap.bounds.maxs - lightmap.bounds.mins;
    if (MaxComponent(size) <= kTinyLuxels * lightmap.sampleSize &&
        std::all_of(lightmap.surfaces.begin(), lightmap.surfaces.end(), usesVertexLight))
        return VertexStandIn::Forced;
    const Approximation approximation(in, surfaces, lightmap);
    const bool close = std::all_of(lightmap.surfaces.begin(), lightmap.surfaces.end(),
                                   [&](int surface) { return approximation.Matches(surface); });
    return close ? VertexStandIn::Close : VertexStandIn::No;
}

} // namespace

std::vector<VertexStandIn> FindVertexStandIns(const SurfaceInputs &in, const SurfaceLight &surfaces) {
    std::vector<VertexStandIn> standIns(surfaces.lightmaps.size(), VertexStandIn::No);
    if (in.lightmap.approximate > 0)
        in.jobs.For(std::int64_t(standIns.size()), [&](std::int64_t i, int) {
            const RawLightmap &lightmap = surfaces.lightmaps[std::size_t(i)];
            if (!lightmap.result[0].empty())
                standIns[std::size_t(i)] = StandInFor(in, surfaces, lightmap);
        });
    return standIns;
}

} // namespace q3
