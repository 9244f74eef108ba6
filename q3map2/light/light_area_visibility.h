// GPL-2.0-or-later. How much of an area light points see.
#pragma once

#include "libs/math/winding.h"
#include "libs/sh/polygon_moments.h"
#include "q3map2/light/light_contribution.h"

#include <vector>

namespace q3 {

/// One point's view of an area light.
struct AreaView {
    Vec3f point;
    Winding<float> corners; ///< clockwise as seen from the point
    PolygonMoments moments; ///< of the whole polygon
    double scale = 0;       ///< light per unit of cosine-weighted solid angle, byte scale
    std::uint64_t seed = 0;
    std::size_t lane = 0;
    bool reversed = false; ///< seen from behind, a two-sided light
    // Set by FindAreaVisibility.
    ShVector arriving{}; ///< projection of the visible part
    Vec3f tint;          ///< mean of what coloured surfaces on the way let through; 0: hidden
};
using AreaViews = std::vector<AreaView>;

/// Traces a few well-spread rays from every point of the packet. All clear: the closed form is the answer; all blocked: zero.
/// Where they disagree, among themselves or with a neighbour in the packet, many rays stratified in solid angle correct the
/// closed form. Patterns depend on the seeds alone.
void FindAreaVisibility(AreaViews &views, const LightScene &scene, ContributionCounts &counts);

} // namespace q3
