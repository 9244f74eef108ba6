// GPL-2.0-or-later. Draw surfaces while they are made: from brush sides, patches and models to the .bsp.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace q3 {

enum class SurfaceKind { Bad, Face, Patch, Triangles, ForcedMeta, Meta, FogHull, Decal, Flare, Foliage, Shader };

/// One draw surface. Indexes count from its first vertex; faces are polygons until they are triangulated.
struct DrawSurface {
    SurfaceKind kind = SurfaceKind::Bad;
    const ShaderInfo *shader = nullptr;
    SurfaceSettings settings;
    int brush = -1, side = -1; ///< of the entity; -1: not from a brush
    int patch = -1;
    int primitive = -1; ///< number in its entity of the map source, for messages
    int planeNum = -1;
    bool planar = false;
    int fogNum = -1;
    Vec3f lightmapAxis; ///< zero: none
    int sampleSize = 0; ///< 0: lit at vertices
    std::array<Vec3f, 3> lightmapVecs{};
    Vec3f lightmapOrigin;
    float longestCurve = 0;
    Boundsf bounds;
    std::vector<DrawVert> verts;
    std::vector<int> indexes;
    int width = 0, height = 0; ///< patches; foliage: instances, model vertices
    bool backSide = false;     ///< written reversed
    bool skyBoxCopy = false;
    int parent = -1; ///< sky box copies: number of the surface in the .bsp
    bool furred = false, isCopy = false;
    bool collisionOnly = false; ///< patches that triangles draw: written with the nodraw and pointlight flags
    bool Empty() const { return verts.empty(); }
};

/// Fog volume of the map.
struct MapFog {
    const ShaderInfo *shader = nullptr;
    int entity = -1, brush = -1; ///< indexes in the map; -1: the global fog
    int visibleSide = -1;        ///< -1: decided when it is written
};

class ModelLibrary;

/// Everything that is gathered on the way to the .bsp.
struct Geometry {
    std::vector<DrawSurface> surfaces; ///< of all entities, in the order of making
    std::vector<MapFog> fogs;
    int defaultFog = -1;
    std::shared_ptr<ModelLibrary> models; ///< read so far; see models.h
    std::deque<ShaderInfo> ownShaders;    ///< that take something from the shader they replace
};

// surface_face.cpp: brush faces and patches to surfaces, classification, subdivision.
void MakePatchSurfaces(MapEntity &entity, Geometry &geometry, PlaneTable &planes, const BspContext &context);
void MakeFaceSurfaces(MapEntity &entity, Geometry &geometry, const PlaneTable &planes, const BspContext &context);
/// A face of `side` with polygon `w`; its number.
int MakeFaceSurface(const MapEntity &entity, int brush, int side, const Polygon &w, Geometry &geometry,
                    const PlaneTable &planes, const BspContext &context);
/// Plane, lightmap axis and sample size of a surface.
void ClassifySurface(DrawSurface &surface, PlaneTable &planes, const BspContext &context);
void ClassifySurfaces(Geometry &geometry, std::size_t first, PlaneTable &planes, const BspContext &context);
void SubdivideFaces(MapEntity &entity, Geometry &geometry, std::size_t first, const PlaneTable &planes,
                    const BspContext &context);
// tjunctions.cpp
void FixTJunctions(Geometry &geometry, std::size_t first, const BspContext &context);
// surface_meta.cpp: triangulates, smooths, merges.
void MakeMetaSurfaces(Geometry &geometry, std::size_t first, PlaneTable &planes, const BspContext &context);
/// Polygon to triangles: zigzag strip, else a fan around an inserted middle. May insert a vertex.
void TriangulateFace(DrawSurface &surface, const BspContext &context);
// surface_fog.cpp
std::vector<MapFog> CollectFogs(const Map &map, const BspContext &context, int &defaultFog);
void FogWorldSurfaces(Map &map, Geometry &geometry, PlaneTable &planes, const BspContext &context);
int FogOfModelSurface(const DrawSurface &surface, const Vec3f &origin, const Map &map, const Geometry &geometry);
// surface_decals.cpp
struct DecalProjector {
    const ShaderInfo *shader = nullptr;
    SurfaceSettings settings;
    std::vector<Plane> planes; ///< front, back, three sides
    std::array<std::array<double, 4>, 2> texture{};
    Vec3f center;
    float radius = 0;
};
std::vector<DecalProjector> CollectDecals(Map &map, const BspContext &context);
/// `origin` is the entity's: its surfaces stand so far from where projectors see them.
void ApplyDecals(const std::vector<DecalProjector> &projectors, Geometry &geometry, std::size_t first,
                 const BspContext &context, const Vec3f &origin = {});
// models.cpp: placed models (through assimp), models that shaders scatter, clip brushes of models.
void AddEntityModels(Map &map, MapEntity &target, Geometry &geometry, const BspContext &context);
void AddShaderModels(MapEntity &entity, Geometry &geometry, std::size_t first, PlaneTable &planes,
                     const BspContext &context);
// surface_extra.cpp: copies by cel, clone and back shaders, fog hull, portals and flares to look at, indexed terrain.
void MakeDerivedSurfaces(Geometry &geometry, std::size_t first, const BspContext &context);
void MakeFogHull(const Map &map, Geometry &geometry, const BspContext &context);
void MakePortalSurfaces(const Tree &tree, Geometry &geometry, const BspContext &context);
void MakeFlares(const Map &map, Geometry &geometry, const BspContext &context);

} // namespace q3
