// GPL-2.0-or-later. Records of light on surfaces that the passes from luxel mapping to storing share.
#pragma once

#include "common/jobs.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/light/transfer/light_contribution.h"
#include "q3map2/light/transfer/light_sample.h"
#include "q3map2/lightmap/options/lightmap_options.h"
#include "q3map2/lightmap/raw/directional_channels.h"
#include "q3map2/lightmap/raw/style_slots.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// lightmapNum of surfaces that are lit at their vertices.
inline constexpr int kLightmapByVertex = -3;

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
    std::vector<int> surfaces; ///< draw surface numbers, by shader name
    std::vector<int> clusters; ///< of all leafs that hold the surfaces; empty: visibility is not tested
    int entity = 0, receiveShadows = 1;
    float sampleSize = 16;       ///< requested by map or options, game units per luxel
    float actualSampleSize = 16; ///< after growing to fit
    Vec3f ambient;               ///< byte scale
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
    std::vector<LuxelTangent> tangents; ///< luxel_tangents.cpp; empty unless channels.basis
    BasisNormals BasisOf(std::size_t luxel) const { return BasisNormalsOf(normals[luxel], tangents[luxel]); }

    // Super grid, once: luxel_dirt.cpp, luxel_flood.cpp. Empty when off.
    std::vector<float> dirt;       ///< factor of the light, 0 to 1
    std::vector<Vec3f> floodlight; ///< byte scale
    ChannelImages floodChannels;
    float floodDirectionScale = 1;

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

    // width x height, for -lightmass: luxel_occlusion.cpp, luxel_visibility.cpp. Empty when off.
    std::vector<float> unoccluded;              ///< factor of dirt, 1 in the open
    std::vector<Vec3f> skyOcclusion;            ///< mean direction of visible sky; its length is the visible share
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
};

/// The kind of pass over surfaces. Functions of passes are called from one thread and use the workers of
/// SurfaceInputs::jobs; results do not depend on the number of workers.
struct SurfacePass {
    bool bounce = false; ///< bounced light only: no ambient, no floodlight, vertices without dirt
};

} // namespace q3
