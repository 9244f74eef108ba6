// GPL-2.0-or-later. Smoothed normals of meta triangles.
#pragma once

#include "q3map2/geometry/meta/meta_mesh.h"

namespace q3 {

/// Gives the corners of triangles that meet at a point a common normal, where their normals differ by less than the
/// shade angle of both.
void SmoothNormals(MetaMesh &mesh, const Geometry &geometry, const BspContext &context);

} // namespace q3
