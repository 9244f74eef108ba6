// GPL-2.0-or-later. Last changes to vertices before they are written.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

namespace q3 {

/// Applies tcMod, tcGen, rgbMod and alphaMod directives of the shader, and color volumes.
void ModifySurface(DrawSurface &surface, const MapEntity &entity, const MapEntity &world, const PlaneTable &planes);
/// Subtracts whole repeats from texture coordinates, so that they are near 0.
void BiasTexture(DrawSurface &surface);
/// Shrinks each triangle by one game unit and gives it vertices of its own (-debuginset).
void InsetTriangles(DrawSurface &surface);
/// Reverses orientation: normals and winding order.
void ReverseSurface(DrawSurface &surface);
/// Puts vertices into the order in which engines rotate the quad about its long axis. Warns if it is no oblong quad.
void OrderSpriteQuad(DrawSurface &surface, const BspContext &context);

} // namespace q3
