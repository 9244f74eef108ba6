// GPL-2.0-or-later. Decals: patches of _decal entities projected onto surfaces.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"

#include <array>
#include <cstddef>
#include <vector>

namespace q3 {

/// A triangular prism: surfaces inside it get a decal.
struct DecalProjector {
    const ShaderInfo *shader = nullptr;
    SurfaceSettings settings;
    std::vector<Plane> planes;                      ///< front, back, three sides
    std::array<std::array<double, 4>, 2> texture{}; ///< s = texture[0] . (p, 1), t = texture[1] . (p, 1)
    Vec3f center;                                   ///< of the bounding sphere
    float radius = 0;
    int entity = 0, primitive = 0; ///< numbers of its patch in the map source
    bool hit = false;              ///< has made a decal; set by ApplyDecals
};

/// Projectors of all _decal entities, whose brushes and patches are removed from the map.
std::vector<DecalProjector> CollectDecals(Map &map, const BspContext &context);
/// Appends decals on the surfaces from `first` on. `origin`: origin of their entity, to which they are relative.
void ApplyDecals(std::vector<DecalProjector> &projectors, Geometry &geometry, std::size_t first,
                 const BspContext &context, const Vec3f &origin = {});
/// Warns of the patches that made no decal on any surface of the map.
void WarnOfLostDecals(const std::vector<DecalProjector> &projectors, const BspContext &context);

} // namespace q3
