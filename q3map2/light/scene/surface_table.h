// GPL-2.0-or-later. Properties of draw surfaces that lighting needs beyond their .bsp records, and patches as meshes.
#pragma once

#include "common/log.h"
#include "libs/math/patch_mesh.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/shader/shader_library.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// The mesh of a patch; longestCurve (game units) determines how finely it is tessellated.
Mesh TessellatePatch(const Bsp &bsp, const bspDrawSurface_t &surface, float longestCurve);

/// Longest curve of the patch from its control points, for a map without a .srf file. Game units.
float LargestHalvingMeasure(const Bsp &bsp, const bspDrawSurface_t &surface);

/// The normal map of a surface's shader.
struct NormalImage {
    std::shared_ptr<const Image> image{}; ///< null: none
    bool ssbump = false;                  ///< q3map_ssbumpImage, a self-shadowed bump map; else q3map_normalImage
};

/// A draw surface, or a static prop's triangles with one shader, as lighting sees it.
struct SurfaceEntry {
    const ShaderInfo *shader = nullptr;
    Vec3f origin;            ///< of the entity that owns its model; vertices are relative to it
    int entity = 0;          ///< number in the map source
    int castShadows = 1;     ///< shadow group; 0 casts none
    int receiveShadows = 1;  ///< shadow group; 0: nothing shadows it
    int sampleSize = 0;      ///< game units a luxel; 0: lit at its vertices
    Vec3f ambient;           ///< byte scale
    Vec3f axis;              ///< of lightmap projection; zero: none
    int parent = -1;         ///< draw surface whose light it copies
    float longestCurve = 0;  ///< patches: decides the tessellation. Game units
    bool skyBoxCopy = false; ///< lit by its parent surface; never casts shadows
    int skyIndex = -1;       ///< number among the skies that emit light, -1: none; set later, by SurfaceLights
    NormalImage normals;
    bool normalMapped = false;                 ///< see SurfaceDefaults::normalMaps
    std::shared_ptr<const Image> macroImage{}; ///< its macro texture; null: none
    /// Light that it emits in place of q3map_surfaceLight, on a receiver whose hemisphere it fills; set by
    /// ApplyTexLights. Byte scale.
    std::optional<Vec3f> texLight{};
    float lightScale = 1; ///< factor of the light that its shader emits, of skies too; set by ApplyTexLights
};

/// One entry per draw surface.
using SurfaceTable = std::vector<SurfaceEntry>;

/// Which surfaces count as normal mapped.
enum class NormalMaps {
    None,
    OfShaders, ///< by ShaderLibrary::HasNormalMap
    All
};

/// Used without a surface file: sample size where shader and entity set none, its minimum, and ambient light.
struct SurfaceDefaults {
    int sampleSize = 16, minSampleSize = 0;   ///< game units a luxel
    bool noLightmaps = false;                 ///< all are lit at their vertices
    Vec3f ambient;                            ///< byte scale
    NormalMaps normalMaps = NormalMaps::None; ///< with a surface file too
    std::string macroTexture{};               ///< image of surfaces whose shader names none, likewise; empty: none
};

/// Major axis of a normal with its sign: of equal components z wins, then x.
Vec3f MajorAxis(const Vec3f &normal);

/// The properties of all draw surfaces. `srfText` is the surface file that the bsp stage wrote beside the map, empty
/// when there is none: then everything is derived from the surfaces, their shaders and entities, and `defaults`.
/// Errors: a malformed surface file, no image `macroTexture`.
SurfaceTable MakeSurfaceTable(const Bsp &bsp, const std::vector<Entity> &entities, std::string_view srfText,
                              std::string_view srfName, ShaderLibrary &library, Log &log,
                              const SurfaceDefaults &defaults = {});

} // namespace q3
