// GPL-2.0-or-later. Fog volumes: cuts of faces and patches at their borders, fog numbers, and the fog hull.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"

#include <vector>

namespace q3 {

/// Result of cutting a patch by a plane.
struct PatchCut {
    enum Result { Inside, Outside, Cut, Impossible };
    Result result = Inside;
    DrawSurface inside, outside; ///< of a cut patch: behind and in front of the plane
};

/// Cuts the control grid of a patch at the plane. The plane must cross every row once and between the same two columns,
/// or every column between the same two rows; else the result is Impossible. Both parts have odd sizes, none larger
/// than the patch. Points within `epsilon` count as behind.
PatchCut CutPatchSurface(const DrawSurface &surface, const Plane &plane, double epsilon);

/// Fog volumes of the map. `defaultFog` becomes the index of the global fog, or -1 without one. Throws Error if the
/// world key _fog names a shader without fogparms. Warns of more fogs than engines draw.
std::vector<MapFog> CollectFogs(const Map &map, const BspContext &context, int &defaultFog);
/// Cuts faces and patches of the world at the borders of fog volumes and sets fogNum of the parts inside.
void FogWorldSurfaces(Map &map, Geometry &geometry, PlaneTable &planes, const BspContext &context);
/// Index of the fog volume that overlaps the bounds of the surface most, or the default fog. `origin`: origin of the
/// entity, to which the surface is relative.
int FogOfModelSurface(const DrawSurface &surface, const Vec3f &origin, const Map &map, const Geometry &geometry);

/// Appends the fog hull if the world key _foghull names its shader. To be called once the fogs are known.
void MakeFogHull(const Map &map, Geometry &geometry, const BspContext &context);

} // namespace q3
