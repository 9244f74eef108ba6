// GPL-2.0-or-later. Lightmaps on their way to pages: copies of the results, one per style, the alike ones joined.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <array>
#include <vector>

namespace q3 {

/// One style of one raw lightmap. Texels are width x height, row by row, byte scale; red below 0: not used.
struct StoredSlot {
    int lightmap = 0;
    std::size_t style = 0; ///< slot of the style, 0 to 3
    int width = 0, height = 0;
    std::array<int, 2> pageSize{128, 128};
    float brightness = 1;
    std::vector<Vec3f> texels, directions; ///< directions: empty without deluxe
    bool solid = false;                    ///< one colour: takes one texel
    Vec3f color, direction;                ///< if solid
    int twin = -1;                         ///< slot whose texels it shares
    bool byVertex = false;                 ///< its surfaces take their light from their vertices: takes no texel

    // Set by PackSlots; those of twins by the slot that they share.
    int page = -1, x = 0, y = 0;

    bool Used(std::size_t texel) const { return texels[texel].x >= 0; }
};

struct StoredSlots {
    std::vector<StoredSlot> slots;                ///< by raw lightmap, then style
    std::vector<std::array<int, kStyles>> slotOf; ///< [raw lightmap][style slot]: number, -1: none
};

/// Copies of all results: seams of surfaces that wrap closed, directions of length 1 (in tangent space if asked for),
/// and, if lightmaps are to be collapsed, solid ones found.
StoredSlots MakeSlots(const SurfaceInputs &in, const SurfaceLight &surfaces);

/// Joins slots whose texels are nearly alike: `twin` of the later, means in the earlier.
void JoinTwins(std::vector<StoredSlot> &slots);

/// Slots that need texels, in the order in which they are packed: by shader names, then first styles, then large ones.
std::vector<std::size_t> PackingOrder(const SurfaceInputs &in, const SurfaceLight &surfaces, const StoredSlots &stored);

} // namespace q3
