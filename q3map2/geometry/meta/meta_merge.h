// GPL-2.0-or-later. Merging of meta triangles into draw surfaces.
#pragma once

#include "q3map2/geometry/meta/meta_mesh.h"

namespace q3 {

/// Appends surfaces grown from triangles that agree in their MetaKey and share vertices.
void MergeTriangles(const MetaMesh &mesh, Geometry &geometry, PlaneTable &planes, const BspContext &context);

} // namespace q3
