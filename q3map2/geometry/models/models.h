// GPL-2.0-or-later. Models in the map: placed by entities, and scattered by shaders over their surfaces.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"
#include "q3map2/model/model_load.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace q3 {

/// Spawnflags of misc_model; their numbers are those in maps. What each does: help of the key, keys::kModelFlags.
enum ModelFlags : unsigned {
    kModelRenameRmg = 1,
    kModelClip = 2,
    kModelForceMeta = 4,
    kModelClipFaceNormals = 8,
    kModelClipTerrain = 16,
    kModelColorToAlpha = 32,
    kModelClipVertexNormals = 128,
    kModelClipPyramid = 256,
    kModelClipDown = 512,
    kModelClipUp = 1024,
    kModelClipFull = 2048,
    kModelClipAxialBack = 4096
};
/// Flags that select the shape of clip brushes.
inline constexpr unsigned kModelClipShapes = kModelClipFaceNormals | kModelClipTerrain | kModelClipVertexNormals |
                                             kModelClipPyramid | kModelClipDown | kModelClipUp | kModelClipFull |
                                             kModelClipAxialBack;

/// A model with its transform and settings.
struct ModelPlacement {
    std::string name;
    std::string messagePrefix; ///< MapEntity::MessagePrefix of its entity
    int frame = 0;
    ModelTransform transform;
    SurfaceSettings settings;
    unsigned flags = 0;
    double clipDepth = 2; ///< of clip brushes behind the triangles, game units
    ShaderRemap shaders;  ///< new names of the model's shaders
    int fogNum = -1;
};

// ---- Models scattered over surfaces; foliage uses the triangles and random numbers too ----

using SurfaceTriangle = std::array<DrawVert, 3>;

/// Triangles of a surface: faces and decals as a fan around their centroid, patches tessellated. Clockwise.
std::vector<SurfaceTriangle> TrianglesOf(const DrawSurface &surface, const BspContext &context);
/// Bisects triangles at their longest edge until no edge is longer than `maxEdge` game units, or than 1. False if it
/// stopped early, at 2^18 triangles.
bool Bisect(std::vector<SurfaceTriangle> &triangles, float maxEdge);

/// Uniform random numbers in 0..1, the same on every machine.
class ScatterRandom {
  public:
    explicit ScatterRandom(std::uint32_t seed) : engine_(seed) {}
    double Next() { return double(engine_()) / 0x1p32; }
    double Between(double low, double high) { return low + (high - low) * Next(); }

  private:
    std::mt19937 engine_;
};

/// Places the models that q3map_surfaceModel scatters over the surfaces from `first` on. Throws Error for more
/// surfaces than -maxmapdrawsurfs allows.
void AddShaderModels(MapEntity &entity, Geometry &geometry, std::size_t first, PlaneTable &planes,
                     const BspContext &context);

/// Appends the surfaces of a model, and clip brushes where flags or shaders ask for them. The brushes go to the end of
/// `target`, so indexes of its other brushes stay valid. False: the model cannot be read; a warning names it and the
/// entity.
bool PlaceModel(const ModelPlacement &placement, MapEntity &target, Geometry &geometry, PlaneTable &planes,
                const BspContext &context);

/// Places the models of all misc_model entities whose target is `target`; for the world, of those without a target.
void AddEntityModels(Map &map, MapEntity &target, Geometry &geometry, const BspContext &context);

} // namespace q3
