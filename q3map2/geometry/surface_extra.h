// GPL-2.0-or-later. Surfaces that others bring about: meshes of patches, fur, foliage, flares, sky box copies, terrain.
#pragma once

#include "q3map2/geometry/surface.h"

#include <array>
#include <cstddef>
#include <optional>

namespace q3 {

/// patch_mesh.cpp. For patches that are to be drawn as triangles (-patchmeta, the key, a shader that forces it, never
/// without the meta step): a surface of forced meta with the mesh. The patch stays for collision where its shader is
/// solid (collisionOnly), else it becomes empty. Before MakeMetaSurfaces.
void MakePatchMeshes(const MapEntity &entity, Geometry &geometry, std::size_t first, const BspContext &context);

// For the final pass, which appends to the list of surfaces while it walks over it.
/// surface_fur.cpp. Moves the surface and appends the other layers of its shader's fur. Nothing for copies.
void MakeFur(std::size_t surface, Geometry &geometry);
/// foliage.cpp. Appends foliage surfaces for what its shader scatters over the surface.
void MakeFoliage(std::size_t surface, Geometry &geometry, const BspContext &context);
/// Appends the flare of the surface's shader; `origin` is the entity's.
void MakeShaderFlare(std::size_t surface, const Vec3f &origin, Geometry &geometry, const BspContext &context);

/// From the space of the _skybox entity to the space that the engine draws around everything.
struct SkyBoxTransform {
    std::array<std::array<double, 4>, 3> rows{}; ///< point' = rows . (point, 1)
    std::array<Vec3d, 3> rotation{};             ///< rows, for normals
};
/// skybox.cpp. Of the last _skybox entity; nothing without one.
std::optional<SkyBoxTransform> ReadSkyBox(const Map &map);
/// The copy of a surface that stands in the sky box; `number` is the original's in the .bsp.
DrawSurface SkyBoxCopy(const DrawSurface &surface, int number, const SkyBoxTransform &transform);

/// terrain.cpp. Heights, alpha and shaders of faces and patches (from `first` on) whose shader is indexed, after the
/// index maps of their brushes' entities.
void ApplyIndexedTerrain(const MapEntity &entity, Geometry &geometry, std::size_t first, const BspContext &context);

} // namespace q3
