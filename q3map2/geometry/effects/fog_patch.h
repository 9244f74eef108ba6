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

/// Cuts the control points of a patch where they cross the plane, which must be between the same two columns, or rows,
/// everywhere. Both parts keep odd sizes. Points within epsilon count as behind. Errors: Error, when a part would pass
/// 31 rows or columns.
PatchCut CutPatchSurface(const DrawSurface &surface, const Plane &plane, double epsilon);

} // namespace q3
