// GPL-2.0-or-later. The triangles and quads that a surface is drawn as.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <vector>

namespace q3 {

/// A corner of a triangle or quad of a draw surface.
struct FaceCorner {
    Vec3f xyz, normal;
    std::array<float, 2> st{}, luxel{};
    int vertex = 0; ///< the nearest draw vertex
};
using Face = std::vector<FaceCorner>;

/// Triangles of a surface, quads of a curve; clockwise seen from the front.
std::vector<Face> FacesOf(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t surface);

} // namespace q3
