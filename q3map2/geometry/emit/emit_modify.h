// GPL-2.0-or-later. Last changes to vertices before they are written.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

namespace q3 {

/// Applies tcMod, tcGen, rgbMod and alphaMod directives of the shader, and color volumes.
void ModifySurface(DrawSurface &surface, const MapEntity &entity, const MapEntity &world, const PlaneTable &planes);
/// Subtracts a whole number from s and from t of all vertices, to bring them near 0.
void BiasTexture(DrawSurface &surface);
/// Gives each triangle vertices of its own and moves them one game unit toward its center (-debuginset).
void InsetTriangles(DrawSurface &surface);
/// Reverses orientation: normals and winding order.
void ReverseSurface(DrawSurface &surface);
/// Puts the vertices of an autosprite2 quad into the order by which engines find its long axis. Warns if the surface is
/// not an oblong quad.
void OrderSpriteQuad(DrawSurface &surface, const BspContext &context);

} // namespace q3
