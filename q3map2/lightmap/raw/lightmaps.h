// GPL-2.0-or-later. Records of light on surfaces that the passes from luxel mapping to storing share, and the choice of
// their light styles.
#pragma once

#include "common/jobs.h"
#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/transfer/light_contribution.h"
#include "q3map2/light/transfer/light_sample.h"
#include "q3map2/lightmap/options/lightmap_options.h"
#include "q3map2/units/unit_store.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// The slot that holds the style; kStyles if none does.
inline std::size_t FindStyleSlot(const Styles &styles, int style) {
    return std::size_t(std::find(styles.begin(), styles.end(), style) - styles.begin());
}

/// The slot that holds the style, else the first free one; kStyles if other styles hold all.
inline std::size_t StyleSlotFor(const Styles &styles, int style) {
    const std::size_t known = FindStyleSlot(styles, style);
    return known < kStyles ? known : FindStyleSlot(styles, kNoStyle);
}

/// Names of the lights that were left out, by surface.
using DroppedLights = std::vector<std::vector<std::string>>;

/// Chooses the styles that give a surface most light.
class StyleChoice {
  public:
    /// Whether the lights and style 0 make more styles than a surface can hold.
    static bool IsNeeded(std::span<const Light *const> lights);

    /// energy: sum of the light that `light` gives the surface; lights with 0 are ignored.
    void Add(const Light &light, double energy);
    /// Keeps style 0 and the three others that give most light; on a tie, those with lower numbers.
    void Choose();
    bool Drops(int style) const { return dropped_.contains(style); }
    /// Names of lights whose style is dropped, each once, in the order of Add.
    std::vector<std::string> DroppedLightNames() const;

  private:
    std::map<int, double> energies_; ///< by style
    std::vector<const Light *> lights_;
    std::set<int> dropped_;
};

/// Warns of lights that were left out of some surfaces, those left out most often first. light: the kind of light, such
/// as "bounced light". what: plural of the kind of surface, such as "lightmaps".
void WarnOfDroppedLights(const DroppedLights &dropped, std::string_view light, std::string_view what, Log &log);

/// Weight of the direction from which light of this color, byte scale, arrives: 1 for white.
inline float DeluxeWeight(const Vec3f &color) {
    return std::max(0.0f, Luminance(color)) / 255;
}

/// Least weight of the normal in the direction of ambient light and floodlight, so that a luxel without other light has
/// the direction of its normal.
inline constexpr float kLeastDeluxeWeight = 1.0f / 256;

/// Bounced light counts by this fraction of its weight: it comes from the whole hemisphere, so its mean direction
/// says little.
inline constexpr float kDeluxeBounceFraction = 0.25f;

/// RGB values kept per luxel and style, byte scale like the light itself, and linear in it:
///
///     sh:    four channels, the bands 0 and 1 of the SH projection of incident light in the order 1, y, z, x of sh.h,
///            world space. Light c from the unit vector w adds pi k0 c to the first and pi k1 c w to the others, so
///            k0 c0 + 2/3 k1 (c1 . n) approximates the light on normal n
///     basis: three channels, the light on the RNM basis normals: c max(0, b_i . w)
///
/// Uniform light c, the same on all normals, adds c / k0 to the first channel of sh and c to those of basis.
struct DirectionalChannels {
    bool sh = false, basis = false;

    static constexpr std::size_t kSH = 4, kBasis = 3;
    std::size_t Count() const { return (sh ? kSH : 0) + (basis ? kBasis : 0); }
    std::size_t FirstBasis() const { return sh ? kSH : 0; }
    bool Any() const { return sh || basis; }
    bool IsSH(std::size_t channel) const { return sh && channel < kSH; }
};
inline constexpr std::size_t kMaxChannels = DirectionalChannels::kSH + DirectionalChannels::kBasis;

/// Constants of the SH basis: k0 = sqrt(1 / pi) / 2 and k1 = sqrt(3 / pi) / 2.
inline constexpr float kSH0 = 0.28209479f, kSH1 = 0.48860251f;
/// Channel values per unit of light: the two bands of directed light, and uniform light.
inline constexpr float kDirectedSH0 = std::numbers::pi_v<float> * kSH0, kDirectedSH1 = std::numbers::pi_v<float> * kSH1,
                       kUniformSH0 = 1 / kSH0;

/// A value per channel, SH channels first.
using ChannelWeights = std::array<float, kMaxChannels>;
/// [channel][luxel].
using ChannelImages = std::vector<std::vector<Vec3f>>;

/// The three RNM basis normals of a luxel in world space.
using BasisNormals = std::array<Vec3f, DirectionalChannels::kBasis>;

/// Tangent of a luxel: along growing texture coordinate s, not exactly perpendicular to its normal.
struct LuxelTangent {
    Vec3f s;
    float side = 1; ///< 1, or -1 where the texture is mirrored: t grows against normal x s
};

/// kRnmBasis in the frame of s, t and the normal. A tangent along the normal gives an arbitrary frame.
BasisNormals BasisNormalsOf(const Vec3f &normal, const LuxelTangent &tangent);

/// Channel values per unit of light from the unit vector `w`. basis: null without basis channels.
ChannelWeights WeightsOf(const Vec3f &w, const DirectionalChannels &channels, const BasisNormals *basis);
/// Channel values per unit of uniform light.
ChannelWeights UniformWeights(const DirectionalChannels &channels);

/// A byte for each luxel of a lightmap, row by row; not 0: set.
using LuxelMask = std::vector<std::uint8_t>;

/// Dilation by 3 x 3: not 0 where the mask is set for the luxel or one of its up to 8 neighbors. `mask` has
/// width * height bytes.
LuxelMask Dilate(const LuxelMask &mask, int width, int height);

/// Calls use(nx, ny), row by row, for the up to 3 x 3 cells of a grid of width x height around (x, y) and for (x, y).
template <typename Use> void ForNeighborhood(int x, int y, int width, int height, const Use &use) {
    for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, height - 1); ++ny)
        for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, width - 1); ++nx)
            use(nx, ny);
}

/// Mean of `values`, width x height, over the known ones in the neighborhood of (x, y); there is at least one.
template <typename T>
T NeighborMean(int x, int y, int width, int height, const LuxelMask &known, const std::vector<T> &values) {
    T sum{};
    int count = 0;
    ForNeighborhood(x, y, width, height, [&](int nx, int ny) {
        if (const std::size_t at = std::size_t(ny) * std::size_t(width) + std::size_t(nx); known[at] != 0)
            sum += values[at], ++count;
    });
    return sum / float(count);
}

/// Values of RawLightmap::luxelClusters that are no cluster.
enum NoCluster : int {
    kUnmapped = -2, ///< no surface passes through the luxel
    kOccluded = -1, ///< a surface does, but every candidate position is in a solid or an unseen cluster
    kFlooded = -3   ///< was unmapped or occluded, and took the mean light of its neighbors
};

/// A draw vertex in world space, with smoothed normal. The draw vertex of the Bsp stays as it is until storing.
struct SurfaceVertex {
    Vec3f xyz, normal;
    std::array<float, 2> st{};
    std::array<float, 2> luxel{}; ///< coordinates in the super grid of its raw lightmap; luxel k covers [k, k + 1)
};

/// The private lightmap of one or several draw surfaces, before packing. Super grid: width x height luxels times
/// `super` on both axes; arrays of it have superWidth * superHeight elements, row by row.
struct RawLightmap {
    // Set up once: lightmap_setup.cpp.
    std::vector<int> surfaces;          ///< draw surface numbers, sorted by shader name
    std::vector<int> clusters;          ///< of all leafs that hold the surfaces; empty: visibility is not tested
    int entity = 0, receiveShadows = 1; ///< of the surfaces; shadow group
    float sampleSize = 16;              ///< requested by map or options, game units per luxel
    float actualSampleSize = 16;        ///< after growing to fit
    Vec3f ambient;                      ///< byte scale
    float brightness = 1, filterRadius = 0;
    bool splotchFix = false, noDirt = false, twoSided = false;
    std::array<int, 2> pageSize{128, 128};
    Boundsf bounds;
    bool planar = false;
    Vec3f planeNormal; ///< if planar
    float planeDist = 0;
    Vec3f axis;                  ///< of projection; zero: a patch, which is parameterized by its rows and columns
    bool hasVectors = false;     ///< projected; else positions come from the mesh of the patch
    Vec3f origin;                ///< world position of luxel (0, 0) of the super grid
    std::array<Vec3f, 2> step{}; ///< world step of one luxel of the super grid
    Vec3f storedOrigin;          ///< lightmapOrigin of the draw surfaces
    bool wrapS = false, wrapT = false;
    DirectionalChannels channels;
    int width = 0, height = 0, super = 1;
    int SuperWidth() const { return width * super; }
    int SuperHeight() const { return height * super; }
    std::size_t SuperIndex(int x, int y) const { return std::size_t(y) * std::size_t(SuperWidth()) + std::size_t(x); }
    std::size_t Index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }

    // Super grid, once: luxel_map.cpp. A luxel is mapped if it has a cluster, >= 0. Averaging the last pass frees
    // positions, tangents, dirt, floodlight, light, filled and directions.
    std::vector<Vec3f> positions, normals; ///< of the receiver that stands for the luxel
    std::vector<int> luxelClusters;        ///< cluster of the position, or NoCluster
    bool Mapped(std::size_t luxel) const { return luxelClusters[luxel] >= 0; }
    std::vector<LuxelTangent> tangents; ///< luxel_normal.cpp; empty unless channels.basis
    BasisNormals BasisOf(std::size_t luxel) const { return BasisNormalsOf(normals[luxel], tangents[luxel]); }

    // Super grid, once: luxel_occlusion.cpp. Empty when off.
    std::vector<float> dirt;       ///< factor of the light, 0 to 1
    std::vector<Vec3f> floodlight; ///< byte scale
    ChannelImages floodChannels;   ///< `channels` of floodlight
    float floodDirectionScale = 1; ///< factor of the directions of floodlight, as in WorldLight

    // Super grid, each pass: luxel_light.cpp. Byte scale; empty for styles that are not used.
    Styles styles = kOnlyStyle0;
    std::array<std::vector<Vec3f>, kStyles> light;
    std::array<ChannelImages, kStyles> directional;        ///< `channels` of `light`
    std::array<std::vector<std::uint8_t>, kStyles> filled; ///< whether the luxel holds a value
    std::vector<Vec3f> directions; ///< deluxe: sum of unit vector towards the light times luminance; else empty

    // width x height: lightmap_average.cpp. A texel whose red is negative is not used.
    std::array<std::vector<Vec3f>, kStyles> result;    ///< added up over passes
    std::array<std::vector<Vec3f>, kStyles> radiosity; ///< of the latest pass only
    std::array<ChannelImages, kStyles> resultChannels; ///< `channels` of `result`; zero where it is not used
    std::vector<Vec3f> resultDirections;
    std::vector<Vec3f> tint; ///< factor of `result` and `resultChannels` by a macro texture; empty: none

    // width x height, for -lightmass: luxel_occlusion.cpp, luxel_light.cpp. Empty when off.
    std::vector<float> unoccluded;              ///< factor of dirt, 1 in the open
    std::vector<Vec3f> skyOcclusion;            ///< mean direction of visible sky; its length is the visible fraction
    std::vector<std::vector<float>> visibility; ///< [LightmapOptions::shadowMaps][luxel], 0 to 1; -1: unknown
};

/// Light at draw vertices, [style slot][vertex], byte scale; empty for styles that are not used.
struct VertexLight {
    std::array<std::vector<Vec3f>, kStyles> sum;       ///< over passes
    std::array<std::vector<Vec3f>, kStyles> radiosity; ///< of the latest pass
    std::vector<Styles> styles;                        ///< by draw surface
};

/// What the passes compute for the surfaces of a map.
struct SurfaceLight {
    std::vector<SurfaceVertex> verts;       ///< by draw vertex
    std::vector<Boundsf> bounds;            ///< by draw surface
    std::vector<std::vector<int>> clusters; ///< by draw surface: clusters of the leafs that hold it
    std::vector<int> lightmapOf;            ///< by draw surface: number of its raw lightmap, -1: lit at vertices
    std::vector<RawLightmap> lightmaps;
    VertexLight vertex;
    bool styled = false; ///< some light has a style: nothing is collapsed
};

/// What all passes read. Const while workers run.
struct SurfaceInputs {
    const Bsp &bsp;
    const BspSpace &space;
    const LightScene &scene;
    const SurfaceTable &table;
    const LightOptions &options;
    const LightmapOptions &lightmap;
    const WorldLight &world;
    const JobPool &jobs;
    Log &log;
    /// All lightmaps go into pages of the game's size. Others need a generated shader, which shows style 0 alone where
    /// records hold the styles.
    bool gamePagesOnly = false;
    UnitStore *units = nullptr; ///< results that need not be computed; null: none
};

/// The kind of pass over surfaces. Functions of passes are called from one thread and use the workers of
/// SurfaceInputs::jobs; results do not depend on the number of workers.
struct SurfacePass {
    bool bounce = false; ///< bounced light only: no ambient, no floodlight, vertices without dirt
};

/// Calls use(luxel, x, y) for all mapped luxels of the super grid, in tiles of `side` x `side` luxels, row by row of
/// tiles.
template <typename Use> void ForMappedLuxelsByTile(const RawLightmap &raw, int side, const Use &use) {
    const int width = raw.SuperWidth(), height = raw.SuperHeight();
    for (int top = 0; top < height; top += side)
        for (int left = 0; left < width; left += side)
            for (int y = top; y < std::min(top + side, height); ++y)
                for (int x = left; x < std::min(left + side, width); ++x)
                    if (const std::size_t luxel = raw.SuperIndex(x, y); raw.Mapped(luxel))
                        use(luxel, x, y);
}

/// Calls use(luxel) for the luxels up to `reach` away from one, without it and without those outside the lightmap.
/// Returns their number.
template <typename Use> int ForLuxelsAround(const RawLightmap &raw, std::size_t luxel, int reach, const Use &use) {
    const int x = int(luxel) % raw.SuperWidth(), y = int(luxel) / raw.SuperWidth();
    int count = 0;
    for (int ny = std::max(0, y - reach); ny <= std::min(y + reach, raw.SuperHeight() - 1); ++ny)
        for (int nx = std::max(0, x - reach); nx <= std::min(x + reach, raw.SuperWidth() - 1); ++nx)
            if (nx != x || ny != y)
                use(raw.SuperIndex(nx, ny)), ++count;
    return count;
}

/// Gives luxels next to known ones the mean of their known neighbors, ring by ring, until all are known. Without a
/// known luxel nothing changes. values, known: width x height.
template <typename T> void FillFromNeighbors(int width, int height, LuxelMask &known, std::vector<T> &values) {
    const auto index = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
    for (bool grown = true; grown;) {
        const LuxelMask ring = Dilate(known, width, height);
        grown = false;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (const std::size_t at = index(x, y); ring[at] != 0 && known[at] == 0)
                    values[at] = NeighborMean(x, y, width, height, known, values), grown = true;
        for (std::size_t at = 0; at < known.size(); ++at)
            known[at] |= ring[at];
    }
}

/// By luxel, width x height: the mean of value(super luxel) over its mapped super luxels. Luxels without mapped
/// super luxels take the mean of their neighbors, as light does; `otherwise` if nothing is mapped.
template <typename T, typename Value>
std::vector<T> LuxelMeans(const RawLightmap &raw, const T &otherwise, const Value &value) {
    std::vector<T> means(std::size_t(raw.width) * std::size_t(raw.height), otherwise);
    LuxelMask known(means.size());
    for (int y = 0; y < raw.height; ++y)
        for (int x = 0; x < raw.width; ++x) {
            T sum{};
            int count = 0;
            for (int sy = y * raw.super; sy < (y + 1) * raw.super; ++sy)
                for (int sx = x * raw.super; sx < (x + 1) * raw.super; ++sx)
                    if (const std::size_t at = raw.SuperIndex(sx, sy); raw.Mapped(at))
                        sum += value(at), ++count;
            if (count > 0)
                means[raw.Index(x, y)] = sum / float(count), known[raw.Index(x, y)] = 1;
        }
    FillFromNeighbors(raw.width, raw.height, known, means);
    return means;
}

} // namespace q3
