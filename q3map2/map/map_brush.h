// GPL-2.0-or-later. Windings and contents of brushes.
#pragma once

#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

#include <memory>
#include <span>

namespace q3 {

/// Computes the windings of the sides and the bounds. False when the planes enclose no volume, or the brush extends
/// beyond the world.
bool MakeBrushWindings(Brush &brush, const PlaneTable &planes);
/// Whether the planes enclose a volume once each of them is flipped.
bool IsInsideOut(const Brush &brush, const PlaneTable &planes);
/// Derives flags, content shader, detail and opaque from the sides.
void SetBrushContents(Brush &brush, const BspContext &context);
/// A generated brush from planes; the first side has shader `firstShader`. Null when the planes enclose no volume, or
/// the brush extends beyond the world.
std::unique_ptr<Brush> BrushFromPlanes(std::span<const Plane> planes, const ShaderInfo *firstShader,
                                       const BspContext &context, PlaneTable &table);

} // namespace q3
