// GPL-2.0-or-later. Writes the .bsp and the .srf: models, brushes, surfaces, the tree.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/geometry/effects/surface_effects.h"
#include "q3map2/geometry/emit/emit_surfaces.h"
#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/tree/tree.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace q3 {

/// Collects the records of a .bsp, model by model: BeginModel, EmitBrushes, EmitSurfaces, EmitTree, EndModel for the
/// world and then each other model; EmitFogs, EmitPlanes and RemapShaders once at the end. Throws Error if a limit is
/// exceeded.
class BspWriter {
  public:
    BspWriter(Map &map, const BspContext &context);

    /// Index in the shaders lump of the entry with this name and these flags, appended if missing. Engines take flags
    /// from the entry, so one name may have several entries. An empty name means the shader of sides without one.
    int ShaderNumber(std::string_view name, std::uint32_t surfaceFlags, std::uint32_t contentFlags);
    /// With the flags of the shader. If it is appended, its damage shader follows it.
    int ShaderNumber(const ShaderInfo &shader);
    /// With the flags of the shader of that name.
    int ShaderNumber(std::string_view name);
    void BeginModel(const MapEntity &entity);
    /// Appends brushes and sides; sets Brush::bspBrush.
    void EmitBrushes(MapEntity &entity);
    /// The final pass over the surfaces from `first` on: modifies coordinates and colors, adds fur, foliage and
    /// flares, finds the leafs of each surface and writes the surfaces that are in a leaf.
    void EmitSurfaces(MapEntity &entity, Tree &tree, Geometry &geometry, std::size_t first);
    /// Appends nodes and leafs; a single leaf for models other than the world. Call after EmitSurfaces.
    void EmitTree(const MapEntity &entity, const Tree &tree);
    void EndModel();
    void EmitFogs(const Geometry &geometry);
    void EmitPlanes();
    /// Gives the entries of the shaders lump the names that q3map_remapShader asks for. To be called last.
    void RemapShaders();
    /// Appends flare surfaces that are in no leaf, so that engines load the images of skies (-skyfix).
    void EmitSkyImages();

    Bsp bsp;
    std::string surfaceFile; ///< text of the .srf

  private:
    void EmitBrushSide(const BrushSide &side);
    void EmitSurface(MapEntity &entity, Tree &tree, Geometry &geometry, std::size_t number);
    void EmitSkyBoxCopies(Tree &tree, Geometry &geometry);
    void WriteSurface(const DrawSurface &surface);
    void WriteVerts(const DrawSurface &surface);
    int SurfaceShader(const DrawSurface &surface);
    void FixSideShaders(const MapEntity &entity, const Geometry &geometry);
    void EmitNodes(const MapEntity &entity, const Tree &tree);
    int EmitLeaf(const MapEntity &entity, const TreeNode &leaf, const Boundsf &bounds);

    Map &map_;
    const BspContext &context_;
    SurfaceSettings worldSettings_;
    IndexRuns runs_;
    std::map<std::tuple<std::string, std::uint32_t, std::uint32_t>, int> shaderNumbers_; ///< by lower-case name, flags
    std::vector<const ShaderInfo *> skies_;                                              ///< of written surfaces
    std::optional<SkyBoxTransform> skyBox_;
    std::vector<DrawSurface> skyBoxCopies_;
};

/// The block with the defaults of all surfaces. `sampleSize` in game units.
std::string DefaultSurfaceBlock(const SurfaceSettings &world, int sampleSize);
/// The block of surface `number` of the .bsp: its shader, and what differs from the defaults.
std::string SurfaceBlock(const DrawSurface &surface, int number, std::string_view shader, const SurfaceSettings &world,
                         int sampleSize);

} // namespace q3
