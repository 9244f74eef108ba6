// GPL-2.0-or-later. Lightmaps to be packed: one per style, those that vertex colors can replace left out, similar ones
// in shared texels.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// One style of one raw lightmap. Texels are width x height, row by row, byte scale; red below 0: not used.
struct LightmapLayer {
    int lightmap = 0;
    std::size_t slot = 0; ///< style slot, 0 to 3
    int width = 0, height = 0;
    std::array<int, 2> pageSize{128, 128};
    float brightness = 1;
    std::vector<Vec3f> texels;
    std::vector<Vec3f> directions; ///< unit vectors to the light; empty without deluxe
    DirectionalChannels kinds;     ///< of `channels`
    ChannelImages channels;        ///< directional light; layers with it are not solid and have no twins
    bool solid = false;            ///< one color: needs one texel
    Vec3f color, direction;        ///< if solid
    int twin = -1;                 ///< layer whose texels it shares
    bool byVertex = false;         ///< vertex colors replace it: needs no texel

    // Set by PackLayers.
    int page = -1, x = 0, y = 0;

    bool Used(std::size_t texel) const { return texels[texel].x >= 0; }
    /// The light on a basis normal; kinds.basis.
    std::span<const Vec3f> OnBasis(std::size_t i) const { return channels[kinds.FirstBasis() + i]; }
};

/// The layers of all raw lightmaps.
struct LightmapLayers {
    std::vector<LightmapLayer> layers;             ///< by raw lightmap, then style
    std::vector<std::array<int, kStyles>> layerOf; ///< [raw lightmap][style slot]: index in layers, -1: none
};

/// Copies of all results; directional channels are moved out of `surfaces`. Texels at the seam of patches that close on
/// themselves are averaged, directions normalized (in tangent space with -deluxemode 1) and, unless -nocollapse or
/// light styles forbid it, solid lightmaps marked.
LightmapLayers MakeLayers(const SurfaceInputs &in, SurfaceLight &surfaces);

/// Makes layers with nearly equal texels share them: sets `twin` of the later ones; the first gets the mean.
void JoinTwins(std::vector<LightmapLayer> &layers);

/// Indices of layers that need texels, in packing order: by shader names, then styles (few first), then area (large
/// first).
std::vector<std::size_t> PackingOrder(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                      const LightmapLayers &layers);

/// Whether vertex colors replace a lightmap.
enum class VertexStandIn {
    No,
    Forced, ///< yes: the surfaces are at most 2 luxels large
    Close   ///< yes: interpolated vertex colors are within -approx of the lightmap, in bytes
};

/// By raw lightmap. All No without -approx.
std::vector<VertexStandIn> FindVertexStandIns(const SurfaceInputs &in, const SurfaceLight &surfaces);

} // namespace q3
