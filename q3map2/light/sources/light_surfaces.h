// GPL-2.0-or-later. Lights that shaders make of surfaces, and texlights of .rad files.
#pragma once

#include "common/log.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/shader/shader_library.h"

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// The light that a line of a .rad file gives a material.
struct TexLight {
    Vec3f radiance;    ///< light on a receiver whose hemisphere the material fills. Byte scale
    std::string where; ///< "file:line"
};

/// What .rad files say. Names of materials match without case, with or without "textures/" in front.
class TexLights {
  public:
    /// Adds the lines of one file; they override what was read before, with a warning. `hdr`: lines with "hdr:" count,
    /// those with "ldr:" do not, and of eight numbers the second four do. Lines that cannot be read are warnings.
    void Read(std::string_view text, std::string_view file, bool hdr, Log &log);

    /// The light of a shader; null: none.
    const TexLight *Find(std::string_view shader) const;
    /// Whether a line "noshadow" names the shader or a part of its name: it casts no shadow.
    bool CastsNoShadow(std::string_view shader) const;
    /// Factor of the light that a shader emits, from a line "lightscale"; 1 without one.
    float ScaleOf(std::string_view shader) const;
    void SetScale(std::string_view shader, float scale);
    /// By lower-case name without "textures/".
    const std::map<std::string, float> &Scales() const { return scales_; }
    /// Whether a line "forcetextureshadow" names the model ("models/x/y.mdl"): its images cast shadows by their alpha.
    bool CastsTextureShadow(std::string_view model) const;
    const std::map<std::string, TexLight> &All() const { return lights_; }

  private:
    struct Line;
    void ReadLine(const Line &line, bool hdr, Log &log);
    void ReadLight(const Line &line, std::string_view name, bool hdr, Log &log);
    void ReadScale(const Line &line, Log &log);

    std::map<std::string, TexLight> lights_; ///< by lower-case name without "textures/"
    std::vector<std::string> noShadow_;      ///< parts of names, likewise, without extension
    std::map<std::string, float> scales_;    ///< by name as in lights_
    std::set<std::string> textureShadow_;    ///< lower case, with '/', without extension
};

/// Sets texLight and lightScale of the surfaces whose shader has one, and castShadows of those that cast no shadow to
/// 0. Prints which shaders have a q3map_surfaceLight that no longer counts.
void ApplyTexLights(const TexLights &lights, SurfaceTable &table, Log &log);

/// Whether a curve is there for collision only, beside the triangles that -patchmeta made from it: its shader record
/// has one of the flags `noDraw` of the game, and the shader itself has not. Engines draw no such curve; it emits no
/// light and has no lightmap.
bool IsCollisionOnly(const Bsp &bsp, const SurfaceTable &table, std::size_t surface, std::uint32_t noDraw);

/// How many lights of each kind SurfaceLights made.
struct SurfaceLightCounts {
    int areaLights = 0, skyLights = 0;
};
/// Makes the lights of shaders, in draw surface order: suns, sky lights, area lights. Gives each sky that emits light
/// its number in `table`. Area lights are cut where solids cover them; warns of those that are covered as a whole.
std::vector<Light> SurfaceLights(const BspSpace &space, SurfaceTable &table, const LightOptions &options,
                                 const WorldLight &world, ShaderLibrary &library, SurfaceLightCounts &counts, Log &log);

} // namespace q3
