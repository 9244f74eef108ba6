// GPL-2.0-or-later. Shader scripts as engines read them: which script defines a shader, which files it names, and who
// wants them.
#pragma once

#include "common/log.h"
#include "common/text/text.h"

#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// PlainName: how files of packages are named.
std::string NameInPackage(std::string_view name);

/// Whether a package without a file is incomplete.
enum class Need { Required, Optional };

/// A file or shader, and who wants it.
struct Wanted {
    std::string name, why; ///< why: for messages, such as "shader textures/x"
    Need need = Need::Required;
};

/// Names in the order in which they were added, each once; case does not matter.
class WantedList {
  public:
    /// False: it is there already (and is required if either is), or empty.
    bool Add(std::string_view name, std::string_view why, Need need = Need::Required);
    bool Has(std::string_view name) const { return known_.contains(LowerCase(name)); }
    const std::vector<Wanted> &All() const { return all_; }

  private:
    std::vector<Wanted> all_;
    std::set<std::string> known_; ///< lower case
};

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
