// GPL-2.0-or-later. Shader scripts as engines read them: which script defines a shader, and which files it names.
#pragma once

#include "common/log.h"
#include "q3map2/pk3/wanted_list.h"

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A definition that engines use. Names of images have no extension.
struct EngineShader {
    std::string name;
    std::size_t script = 0;               ///< number in EngineScripts::Scripts()
    std::vector<std::string> images;      ///< that it draws
    std::vector<std::string> extraImages; ///< that some engines draw: normal maps and the like, inner sky boxes
    std::vector<std::string> videos;      ///< with the folder video/ and the extension .roq if they had none
    bool drawsWithoutImage = false;       ///< lightmap or white, fog, sky, or nodraw
    std::string body;                     ///< what follows its opening brace, to the closing one

    bool HasImages() const { return !images.empty() || !videos.empty(); }
};

/// All definitions of some scripts. A definition for compilers alone (`name:q3map`) has another name for engines and is
/// found under that only.
class EngineScripts {
  public:
    struct Script {
        std::string name; ///< with folder
        std::vector<std::string> shaders;
        std::string fault; ///< why ioquake3 and engines derived from it ignore the whole script; empty: they do not
    };

    /// Reads a script as compilers do, and checks it as engines do (Script::fault). What follows a damage is left out
    /// with a warning.
    void Read(std::string_view name, std::string text, Log &log);
    /// All definitions, in the order in which they were read. Which one an engine takes depends on the engine.
    std::span<const EngineShader> Find(std::string_view shader) const;
    const std::vector<Script> &Scripts() const { return scripts_; }

  private:
    std::vector<Script> scripts_;
    std::map<std::string, std::vector<EngineShader>> shaders_; ///< by lower-case name
};

/// The definition as a script: tidied, with `.tga` as the extension of all images of map, clampMap, animMap and
/// clampAnimMap.
std::string StrippedText(const EngineShader &shader);

/// Name of an image without the extension of one.
std::string ImageName(std::string_view name);

} // namespace q3
