// GPL-2.0-or-later. Parsed shaders by name.
#pragma once

#include "common/log.h"
#include "q3map2/shader/shader_info.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace q3 {

/// A line below the suns of its shader, which do not use what it sets.
struct LateLine {
    std::string directive, location;
};

/// A shader and the names of the images that give its colors: without extension, empty if not given.
struct ParsedShader {
    ShaderInfo info;
    std::string editorImage, lightImage, implicitImage;
    std::optional<std::string> body; ///< source of info.scriptText, which is made at look-up; empty: already made
    std::string replacement;         ///< q3map_deprecateShader
    int linesRead = 0;               ///< directives so far that q3map_baseShader would replace
    std::vector<LateLine> lateLines; ///< below the last sun, for WarnOfLateLines
    bool lightImageGiven = false;    ///< lightImage is that of q3map_lightImage
    bool builtInImage = false;       ///< a stage draws an image of the engine, such as $whiteimage
    bool hasBspFlags = false;        ///< no script defines it; flags are those of a .bsp
    bool colorGiven = false;         ///< q3map_lightRGB: info.color is final
    bool lookedUp = false;           ///< returned by ShaderLibrary::Get
    bool imagesReady = false;        ///< light image and colors are in info
};

/// All shaders by name. References stay valid as long as the table.
class ShaderTable {
  public:
    ShaderTable(const Game &game, const ShaderOptions &options);

    const Game &GameRules() const { return game_; }
    const ShaderOptions &Options() const { return options_; }

    /// A shader with the defaults of the game and the command line.
    ParsedShader MakeDefault(std::string_view name) const;
    /// Adds a script's definition; a name that is there already keeps the first one.
    void Define(std::unique_ptr<ParsedShader> shader);
    /// The definition of that name (without extension, case-insensitive) or of what replaces it, or null.
    const ParsedShader *Find(std::string_view name, Log &log) const;
    /// The same; an unknown name is added as an implicit shader.
    ParsedShader &FindOrAdd(std::string_view name, Log &log);
    std::size_t DefinedCount() const { return definedCount_; }
    static constexpr std::size_t kMaxCustomParms = 256;
    /// One more surfaceparm, after those of the game; false: there are too many.
    bool AddCustomParm(std::string name, std::uint32_t contentFlags, std::uint32_t surfaceFlags);
    /// Flags that the command line gives to all shaders.
    void ApplyGlobalFlags(ShaderInfo &info) const;
    void ForEach(const std::function<void(ParsedShader &)> &visit);

  private:
    std::string FollowReplacements(std::string_view name, Log &log) const;

    Game game_;
    ShaderOptions options_;
    std::uint32_t globalFlags_ = 0;                                          ///< surface flags for all shaders
    std::deque<std::string> customNames_;                                    ///< parms refer to them
    std::unordered_map<std::string, std::unique_ptr<ParsedShader>> shaders_; ///< by lower-case name
    std::size_t definedCount_ = 0;
};

/// Copy up to the last '.' that follows the last slash.
std::string WithoutExtension(std::string_view name);

} // namespace q3
