// GPL-2.0-or-later. Lightmaps to be packed.
#include "q3map2/lightmap/store/lightmap_layers.h"

#include "q3map2/lightmap/store/luxel_normals.h"
#include "q3map2/lightmap/store/stored_light.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

namespace q3 {

namespace {

/// Greatest channel difference within a solid lightmap, and between two solid ones that share a texel. Byte scale.
constexpr float kSolidDifference = 0.0625f;
/// Channel differences of texels that twins share are less than this. Byte scale.
constexpr float kTwinDifference = 3;
/// Bound of twins on the running mean over texels of (|dr| + |dg| + |db|) / 768.
constexpr float kTwinMean = 0.0025f;
/// Greatest difference of direction components within a solid lightmap: one step of their bytes.
constexpr float kSolidDirection = 1.0f / 127;

float MaxDifference(const Vec3f &a, const Vec3f &b) {
    const Vec3f d = a - b;
    return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
}

// ---- seams of closed patches -----------------------------------------------------------------------------------

/// Averages the two texels. `colors`: red below 0 marks an unused texel, which takes the other's value.
void JoinTexels(Vec3f &a, Vec3f &b, bool colors) {
    if (colors && (a.x < 0 || b.x < 0)) {
        (a.x < 0 ? a : b) = a.x < 0 ? b : a;
        return;
    }
    a = b = (a + b) * 0.5f;
}

void JoinSeams(const RawLightmap &lightmap, std::vector<Vec3f> &texels, bool colors) {
    if (texels.empty())
        return;
    if (lightmap.wrapS)
        for (int y = 0; y < lightmap.height; ++y)
            JoinTexels(texels[lightmap.Index(0, y)], texels[lightmap.Index(lightmap.width - 1, y)], colors);
    if (lightmap.wrapT)
        for (int x = 0; x < lightmap.width; ++x)
            JoinTexels(texels[lightmap.Index(x, 0)], texels[lightmap.Index(x, lightmap.height - 1)], colors);
}

// ---- directions ------------------------------------------------------------------------------------------------

/// Components of d along the tangent, the bitangent and the normal n.
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

// ---- solid lightmaps -------------------------------------------------------------------------------------------

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

// ---- twins -----------------------------------------------------------------------------------------------------

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
        sum += (std::abs(d.x) + std::abs(d.y) + std::abs(d.z)) / 768;
        if (sum > kTwinMean * float(++count))
            return false;
    }
    return true;
}

/// Adds b to the running mean a of `count` layers, b included.
void Join(LightmapLayer &a, const LightmapLayer &b, int count) {
    const float share = 1 / float(count);
    a.color += (b.color - a.color) * share;
    for (std::size_t i = 0; i < a.texels.size() && !a.solid; ++i)
        if (!a.Used(i))
            a.texels[i] = b.texels[i];
        else if (b.Used(i))
            a.texels[i] += (b.texels[i] - a.texels[i]) * share;
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
bool ShowsNothing(const SurfaceInputs &in, const RawLightmap &lightmap, std::size_t style) {
    if (in.lightmap.hdr || in.lightmap.lightmass || !lightmap.resultChannels[style].empty())
        return false;
    const ToneOptions tone = StoredTone(in);
    const ToneMapper mapper(1, lightmap.brightness, tone);
    constexpr std::array<std::uint8_t, 3> kBlack{};
    return std::all_of(lightmap.result[style].begin(), lightmap.result[style].end(),
                       [&](const Vec3f &texel) { return texel.x < 0 || mapper.Bytes(texel) == kBlack; });
}

} // namespace

LightmapLayers MakeLayers(const SurfaceInputs &in, SurfaceLight &surfaces) {
    LightmapLayers stored;
    stored.layerOf.resize(surfaces.lightmaps.size());
    for (std::size_t i = 0; i < surfaces.lightmaps.size(); ++i)
        for (std::size_t style = 0; style < kStyles; ++style) {
            const RawLightmap &lightmap = surfaces.lightmaps[i];
            const bool used = lightmap.styles[style] != kNoStyle && !lightmap.result[style].empty() &&
                              (style == 0 || (stored.layerOf[i][0] >= 0 && !ShowsNothing(in, lightmap, style)));
            stored.layerOf[i][style] = used ? int(stored.layers.size()) : -1;
            if (!used)
                continue;
            LightmapLayer &layer = stored.layers.emplace_back();
            layer.lightmap = int(i), layer.style = style;
            layer.width = lightmap.width, layer.height = lightmap.height, layer.pageSize = lightmap.pageSize;
            layer.brightness = lightmap.brightness;
            layer.kinds = lightmap.channels;
        }
    const bool collapse = in.lightmap.collapse && !surfaces.styled;
    in.jobs.For(std::int64_t(stored.layers.size()), [&](std::int64_t i, int) {
        LightmapLayer &layer = stored.layers[std::size_t(i)];
        RawLightmap &lightmap = surfaces.lightmaps[std::size_t(layer.lightmap)];
        layer.texels = lightmap.result[layer.style];
        layer.channels = std::move(lightmap.resultChannels[layer.style]);
        layer.directions = lightmap.resultDirections;
        JoinSeams(lightmap, layer.texels, true);
        JoinSeams(lightmap, layer.directions, false);
        for (std::vector<Vec3f> &channel : layer.channels)
            JoinSeams(lightmap, channel, false);
        FinishDirections(lightmap, in.lightmap.deluxeTangent, layer.directions);
        if (collapse && layer.channels.empty())
            FindSolid(layer);
    });
    return stored;
}

void JoinTwins(std::vector<LightmapLayer> &layers) {
    std::map<std::tuple<int, int, std::array<int, 2>, float, int>, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const LightmapLayer &layer = layers[i];
        if (layer.byVertex || !layer.channels.empty())
            continue;
        // Solid layers are compared only within a bucket of red, for speed: twins mostly have exactly equal colors.
        const int step = layer.solid ? int(std::clamp(layer.color.x / kSolidDifference, 0.0f, 1e6f)) : 0;
        const std::array<int, 2> size = layer.solid ? std::array{-1, -1} : std::array{layer.width, layer.height};
        groups[{size[0], size[1], layer.pageSize, layer.brightness, step}].push_back(i);
    }
    for (const auto &[key, group] : groups)
        JoinGroup(group, layers);
}

std::vector<std::size_t> PackingOrder(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                      const LightmapLayers &stored) {
    std::map<std::string_view, int> rankOf;
    for (const SurfaceEntry &entry : in.table)
        rankOf[entry.shader->name] = 0;
    int rank = 0;
    for (auto &[name, number] : rankOf)
        number = rank++;
    struct Key {
        std::vector<int> shaders; ///< ranks, each once
        int styles = 0;           ///< minus the sum of styles, 255 for a free slot: few styles come first
        int area = 0;             ///< negative: large ones come first
    };
    std::vector<Key> keys(surfaces.lightmaps.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const RawLightmap &lightmap = surfaces.lightmaps[i];
        for (const int surface : lightmap.surfaces)
            keys[i].shaders.push_back(rankOf[in.table[std::size_t(surface)].shader->name]);
        std::sort(keys[i].shaders.begin(), keys[i].shaders.end());
        keys[i].shaders.erase(std::unique(keys[i].shaders.begin(), keys[i].shaders.end()), keys[i].shaders.end());
        for (const std::uint8_t style : lightmap.styles)
            keys[i].styles -= style;
        keys[i].area = -lightmap.width * lightmap.height;
    }
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < stored.layers.size(); ++i)
        if (stored.layers[i].twin < 0 && !stored.layers[i].byVertex)
            order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const Key &x = keys[std::size_t(stored.layers[a].lightmap)], &y = keys[std::size_t(stored.layers[b].lightmap)];
        return std::tie(x.shaders, x.styles, x.area) < std::tie(y.shaders, y.styles, y.area);
    });
    return order;
}

} // namespace q3
