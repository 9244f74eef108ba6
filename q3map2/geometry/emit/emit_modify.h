// GPL-2.0-or-later. Last changes to vertices before they are written.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"
#include "q3map2/map/bsp_context.h"

namespace q3 {

/// Sets texture coordinates and colours as the shader's directives say, and colour volumes.
void ModifySurface(DrawSurface &surface, const MapEntity &entity, const MapEntity &world, const PlaneTable &planes);
/// Whole repeats off texture coordinates, so that they are near 0.
void BiasTexture(DrawSurface &surface);
/// Every triangle one unit smaller, with vertices of its own (-debuginset).
void InsetTriangles(DrawSurface &surface);
/// Turns it around.
void ReverseSurface(DrawSurface &surface);
/// The vertex order that engines need to turn the quad around its long axis. A warning when it is no oblong quad.
void OrderSpriteQuad(DrawSurface &surface, const BspContext &context);

} // namespace q3
