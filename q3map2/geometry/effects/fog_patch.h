// GPL-2.0-or-later. Patches cut by a plane.
#pragma once

#include "q3map2/geometry/surface/draw_surface.h"

namespace q3 {

/// Result of cutting a patch by a plane.
struct PatchCut {
    enum Result { Inside, Outside, Cut, Impossible };
    Result result = Inside;
    DrawSurface inside, outside; ///< of a cut patch: behind and in front of the plane
};

/// Cuts the control grid of a patch at the plane. The plane must cross every row once and between the same two columns,
/// or every column between the same two rows; else the result is Impossible. Both parts keep odd sizes. Points within
/// epsilon count as behind. Throws Error if a part would have more than 31 rows or columns.
PatchCut CutPatchSurface(const DrawSurface &surface, const Plane &plane, double epsilon);

} // namespace q3
