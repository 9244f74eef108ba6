// GPL-2.0-or-later. Light on surfaces: what the steps from luxel placement to storing hand on.
#pragma once

#include "common/jobs.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/light/transfer/light_contribution.h"
#include "q3map2/light/transfer/light_sample.h"
#include "q3map2/lightmap/options/lightmap_options.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace q3 {

/// Light styles that one surface can hold; style 0 comes first.
inline constexpr std::size_t kStyles = 4;
using Styles = std::array<std::uint8_t, kStyles>;
inline constexpr std::uint8_t kNoStyle = 255;

/// lightmapNum of surfaces that are lit at their vertices.
inline constexpr int kLightmapByVertex = -3;

/// Luxel luxelClusters that are no cluster.
enum LuxelCode : int {
    kUnmapped = -2, ///< no surface there
    kOccluded = -1, ///< a surface, but no open place to light it from
    kFlooded = -3   ///< was one of these, got light from its neighbours
};

/// A draw vertex as lighting sees it: in the world, with smoothed normal. The map's own record stays as it is until
/// storing.
struct SurfaceVertex {
    Vec3f xyz, normal;
    std::array<float, 2> st{};
    std::array<float, 2> luxel{}; ///< place in its raw lightmap's super grid; luxel k covers [k, k + 1)
};

/// The private lightmap of one or several draw surfaces, before packing. Super grid: width x height luxels times
/// `super` on both axes; arrays of it have superWidth * superHeight elements, row by row.
struct RawLightmap {
    // Set up once: lightmap_setup.cpp.
    std::vector<int> surfaces; ///< draw surface numbers, by shader name
    std::vector<int> clusters; ///< of all leafs that hold them; empty: no filtering by visibility
    int entity = 0, receiveShadows = 1;
    float sampleSize = 16;       ///< as asked for, game units a luxel
    float actualSampleSize = 16; ///< after growing to fit
    Vec3f ambient;               ///< byte scale
    float brightness = 1, filterRadius = 0;
    bool splotchFix = false, noDirt = false, twoSided = false;
    std::array<int, 2> pageSize{128, 128};
    Boundsf bounds;
    bool planar = false;
    Vec3f planeNormal; ///< if planar
    float planeDist = 0;
    Vec3f axis;                  ///< of projection; zero: a patch by its own parameters
    bool hasVectors = false;     ///< projected; else receivers come from the mesh
    Vec3f origin;                ///< world place of luxel (0, 0) of the super grid
    std::array<Vec3f, 2> step{}; ///< world step of one luxel of the super grid
    Vec3f storedOrigin;          ///< what the file's lightmapOrigin gets
    bool wrapS = false, wrapT = false;
    int width = 0, height = 0, super = 1;
    int SuperWidth() const { return width * super; }
    int SuperHeight() const { return height * super; }
    std::size_t SuperIndex(int x, int y) const { return std::size_t(y) * std::size_t(SuperWidth()) + std::size_t(x); }
    std::size_t Index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }

    // Super grid, placed once: luxel_map.cpp. A luxel is mapped if its code is a cluster, >= 0. Averaging the last pass
    // ends receivers, dirt, floodlight and what passes set.
    std::vector<Vec3f> positions, normals;
    std::vector<int> luxelClusters; ///< cluster or LuxelCode
    bool Mapped(std::size_t luxel) const { return luxelClusters[luxel] >= 0; }

    // Super grid, once: luxel_dirt.cpp, luxel_flood.cpp. Empty when off.
    std::vector<float> dirt;       ///< factor
    std::vector<Vec3f> floodlight; ///< byte scale
    float floodDirectionScale = 1;

    // Super grid, each pass: luxel_light.cpp. Byte scale; empty for styles that are not used.
    Styles styles{0, kNoStyle, kNoStyle, kNoStyle};
    std::array<std::vector<Vec3f>, kStyles> light;
    std::array<std::vector<std::uint8_t>, kStyles> filled; ///< whether the luxel holds a value
    std::vector<Vec3f> directions;                         ///< deluxe: sums towards the light; else empty

    // width x height: lightmap_average.cpp. A texel whose red is negative is not used.
    std::array<std::vector<Vec3f>, kStyles> result;    ///< added up over passes
    std::array<std::vector<Vec3f>, kStyles> radiosity; ///< of the latest pass only
    std::vector<Vec3f> resultDirections;
};

/// Light at draw vertices, [style slot][vertex], byte scale; empty for styles that are not used.
struct VertexLight {
    std::array<std::vector<Vec3f>, kStyles> sum;       ///< over passes
    std::array<std::vector<Vec3f>, kStyles> radiosity; ///< of the latest pass
    std::vector<Styles> styles;                        ///< by draw surface
};

/// Everything about the surfaces of a map that lighting them changes.
struct SurfaceLight {
    std::vector<SurfaceVertex> verts;       ///< by draw vertex
    std::vector<Boundsf> bounds;            ///< by draw surface
    std::vector<std::vector<int>> clusters; ///< by draw surface: of the leafs that hold it
    std::vector<int> lightmapOf;            ///< by draw surface: number of its raw lightmap, -1: lit at vertices
    std::vector<RawLightmap> lightmaps;
    VertexLight vertex;
    bool styled = false; ///< some light has a style: nothing is collapsed
};

/// What all steps read. Const while workers run.
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

/// Which pass lights the surfaces.
struct SurfacePass {
    bool bounce = false; ///< bounced light only: no ambient, no floodlight, vertices without dirt
};

// In the order of the stage. Each is safe to call from one thread and uses the workers of `in.jobs`; results do not
// depend on their number.

/// Vertices, clusters, raw lightmaps: which surfaces share one, their sizes and projections. lightmap_setup.cpp.
SurfaceLight SetupSurfaceLight(const SurfaceInputs &in);
/// -shade: normals of vertices that meet at less than their shading angle become one. lightmap_shade.cpp.
void SmoothNormals(const SurfaceInputs &in, SurfaceLight &surfaces);
/// Where each luxel is lit from. luxel_map.cpp.
void MapLuxels(const SurfaceInputs &in, SurfaceLight &surfaces);
/// -dirty: how open the surroundings of each luxel are. luxel_dirt.cpp.
void DirtLuxels(const SurfaceInputs &in, SurfaceLight &surfaces);
/// Floodlight on each luxel. luxel_flood.cpp.
void FloodLuxels(const SurfaceInputs &in, SurfaceLight &surfaces);
/// Direct or bounced light on all luxels; `lights` by SetupEnvelopes for surfaces. luxel_light.cpp.
void LightLuxels(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                 SurfaceLight &surfaces, ContributionCounts &counts);
/// Fills in luxels without light of their own from their neighbours, after dirt and floodlight were applied: the last
/// step of a pass. luxel_fill.cpp.
void FinishLuxels(const SurfaceInputs &in, const SurfacePass &pass, SurfaceLight &surfaces);
/// Light at the vertices of all surfaces: of its own where there is no lightmap, else read from it. vertex_light.cpp.
void LightVertices(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                   SurfaceLight &surfaces, ContributionCounts &counts);
/// Averages super luxels into results and radiosity. `last`: no bounce follows. lightmap_average.cpp.
void AverageLuxels(const SurfaceInputs &in, const SurfacePass &pass, bool last, SurfaceLight &surfaces);

/// A lightmap page: RGB rows.
struct LightmapPage {
    int width = 128, height = 128;
    int number = -1;       ///< that surfaces name; -1: only shaders made for them name its image
    int file = 0;          ///< number of its image; deluxe: that of the directions is the next
    bool external = false; ///< the image is needed
    std::vector<std::uint8_t> colors;
    std::vector<std::uint8_t> directions; ///< deluxe: the page after it; else empty
};

/// What storing makes beyond the Bsp.
struct StoredLightmaps {
    std::vector<LightmapPage> pages;
    struct Script {
        std::string shader, text;
    };
    std::vector<Script> scripts; ///< generated shaders, each once
};

/// Packs results into pages and writes them, coordinates, numbers and vertex colours into `bsp`. mapName: without path
/// and extension. lightmap_store.cpp.
StoredLightmaps StoreLightmaps(const SurfaceInputs &in, const SurfaceLight &surfaces, std::string_view mapName,
                               Bsp &bsp);

} // namespace q3
