// GPL-2.0-or-later. What shaders and entities make of surfaces: flares, foliage, fur, copies, terrain, sky boxes,
// portals.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/tree/tree.h"

#include <array>
#include <cstddef>
#include <optional>

namespace q3 {

/// Appends the copies that shaders and cel shader settings demand of the surfaces from `first` on.
void MakeDerivedSurfaces(Geometry &geometry, std::size_t first, const BspContext &context);

/// Appends the flares of light entities.
void MakeFlares(const Map &map, Geometry &geometry, const BspContext &context);
/// Appends the flare of the surface's shader. `origin`: origin of the entity, to which the surface is relative.
void MakeShaderFlare(std::size_t surface, const Vec3f &origin, Geometry &geometry, const BspContext &context);

/// Appends foliage surfaces for the models that the shader of the surface scatters over it.
void MakeFoliage(std::size_t surface, Geometry &geometry, const BspContext &context);

/// Moves the surface to the lowest layer of its shader's fur and appends the other layers. No-op for fur layers.
void MakeFur(std::size_t surface, Geometry &geometry);

/// From the room around the _skybox entity to its enlarged copy: the entity maps to the origin of the world.
struct SkyBoxTransform {
    std::array<std::array<double, 4>, 3> rows{}; ///< point' = rows . (point, 1)
    std::array<Vec3d, 3> rotation{};             ///< rows, for normals
};

/// The transform of the last _skybox entity; empty without one.
std::optional<SkyBoxTransform> ReadSkyBox(const Map &map);
/// The enlarged copy of a surface in the sky box. `number`: number of the original surface in the .bsp.
DrawSurface SkyBoxCopy(const DrawSurface &surface, int number, const SkyBoxTransform &transform);

/// Appends a translucent polygon for each passable portal, each in another color.
void MakePortalSurfaces(const Tree &tree, Geometry &geometry, const BspContext &context);

/// For faces and patches (from `first` on) with an indexed shader: sets heights, vertex alpha and shader by the index
/// map of their entity.
void ApplyIndexedTerrain(Geometry &geometry, std::size_t first, const BspContext &context);

} // namespace q3
