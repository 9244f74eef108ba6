// GPL-2.0-or-later. The brightest emitters as patches of a light tree.
#pragma once

#include "q3map2/lightmap/bounce/bright_tree.h"

namespace q3 {

/// Patches for the emitters whose radiosity `excess` is above zero in a channel: texels of raw lightmaps in 2 x 2
/// pieces, clipped to the surfaces that they lie on, and the parts of triangles nearest to a vertex. excess: by
/// emitter.
std::vector<BrightPatch> MakeBrightPatches(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                           const EmitterIndex &emitters, std::span<const Vec3f> excess);

} // namespace q3
