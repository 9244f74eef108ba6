// GPL-2.0-or-later. Windings, contents and bevel planes of brushes.
#pragma once

#include "q3map2/map/bsp_options.h"
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

/// Appends the bevel planes that boxes of any size need to collide with the brush exactly: axial planes, and planes
/// through slanted edges. To be called once, after MakeBrushWindings. `snap`: axial bevels are rounded to multiples of
/// it, game units; 0: off. `inheritedFlags`: surface flags that bevels take over from the sides that they touch.
void AddBrushBevels(Brush &brush, PlaneTable &planes, int snap, std::uint32_t inheritedFlags);

} // namespace q3
