// GPL-2.0-or-later. Texlights: .rad files, which say what light the materials of surfaces emit.
#pragma once

#include "common/log.h"
#include "q3map2/light/scene/surface_table.h"

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// The light that a line gives a material.
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

    /// Null: none.
    const TexLight *Find(std::string_view shader) const;
    /// noshadow: part of the name of a shader that casts no shadow.
    bool NoShadow(std::string_view shader) const;
    /// forcetextureshadow: whether images of the model ("models/x/y.mdl") cast shadows by their alpha channel.
    bool TextureShadow(std::string_view model) const;
    const std::map<std::string, TexLight> &All() const { return lights_; }

  private:
    struct Line;
    void ReadLine(const Line &line, bool hdr, Log &log);
    void ReadLight(const Line &line, std::string_view name, bool hdr, Log &log);

    std::map<std::string, TexLight> lights_; ///< by lower-case name without "textures/"
    std::vector<std::string> noShadow_;      ///< parts of names, likewise, without extension
    std::set<std::string> textureShadow_;    ///< lower case, with '/', without extension
};

/// Sets texLight of the surfaces whose shader has one, and castShadows of those that cast no shadow to 0. Prints which
/// shaders have a q3map_surfaceLight that no longer counts.
void ApplyTexLights(const TexLights &lights, SurfaceTable &table, Log &log);

} // namespace q3
