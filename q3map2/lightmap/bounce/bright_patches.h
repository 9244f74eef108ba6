// GPL-2.0-or-later. The brightest emitters as patches of a light tree.
#pragma once

#include "q3map2/lightmap/bounce/bright_tree.h"

namespace q3 {

/// Patches for the emitters with a nonzero radiosity `excess` (by emitter, byte scale): texels of raw lightmaps cut
/// into 2 x 2 pieces and clipped to their surfaces; on surfaces lit at vertices, the part of each triangle nearest to
/// the vertex.
std::vector<BrightPatch> MakeBrightPatches(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                           const EmitterIndex &emitters, std::span<const Vec3f> excess);

} // namespace q3
