// GPL-2.0-or-later. The table of words that shader scripts may hold; the parser and the documentation use it.
#pragma once

#include "common/log.h"
#include "common/settings.h"
#include "common/text/text_scan.h"
#include "q3map2/shader/shader_table.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Numbers in scripts are clamped to plus or minus this, so that products of a few stay finite.
inline constexpr double kMaxNumber = 1e9;

/// The number at the front of the word, clamped; 0 if there is none.
float Number(std::string_view word);

/// The shader that a directive changes, and what it may need for that.
struct DirectiveContext {
    ParsedShader &shader;
    const ShaderTable &table;
    const TextLocation &location; ///< of the directive
    Log &log;

    /// Sets the flags of a surfaceparm; false if the game has none of that name.
    bool ApplyParm(std::string_view name) const;
    /// Three numbers as a light color.
    Vec3f Color(std::span<const std::string_view> words) const;
};

using DirectiveWords = std::span<const std::string_view>;
/// Changes the shader; returns what is wrong with the words, or nothing.
using ApplyDirective = std::string (*)(DirectiveContext &context, DirectiveWords words);

/// An ApplyDirective: the first word, without extension, is the name of another shader.
template <std::string GeometryDirectives::*name>
std::string SetShaderName(DirectiveContext &context, DirectiveWords words) {
    context.shader.info.geometry.*name = WithoutExtension(words[0]);
    return {};
}

/// What follows the values of a directive on its line.
enum class RestOfLine { Ignored, Directives };

/// A directive. SettingInfo::values says how many words follow it; parentheses around them are not counted.
struct ShaderDirective {
    SettingInfo info;
    std::string_view stage; ///< that it has an effect on: "bsp", "light", "both" or "none"
    ApplyDirective apply{}; ///< null: nothing to set; other code may look for the word in the script text
    RestOfLine rest = RestOfLine::Ignored;
};

/// Directives under one heading.
struct DirectiveGroup {
    std::string_view title, intro;
    std::span<const ShaderDirective> directives;
};

/// All directives, as the documentation shows them.
std::vector<DirectiveGroup> DirectiveGroups();
/// The directive of that name, whatever its case, or null.
const ShaderDirective *FindDirective(std::string_view word);
/// "; did you mean q3map_sun?", or nothing.
std::string NearestDirective(std::string_view word, const Game &game);

/// What the parser makes of a word inside a stage.
enum class StageWord {
    Other,
    Image,    ///< the next word is an image
    Frames,   ///< a rate follows, then images
    NormalMap ///< the stage has a normal map
};
/// Declaration of a word inside a stage, for the documentation.
struct StageWordEntry {
    SettingInfo info;
    StageWord use = StageWord::Other;
};
/// All of them.
std::span<const StageWordEntry> StageWords();
/// What a word inside a stage means, whatever its case.
StageWord FindStageWord(std::string_view word);

/// Warns of lines of a complete shader that have no effect where they stand.
void WarnOfLateLines(const ParsedShader &shader, Log &log);

// The groups, each in the source that has its directives.
DirectiveGroup SurfaceDirectives();
DirectiveGroup ReplacementDirectives();
DirectiveGroup SkyDirectives();
DirectiveGroup EmissionDirectives();
DirectiveGroup LightmapDirectiveGroup();
DirectiveGroup VertexLightDirectives();
DirectiveGroup GeometryDirectiveGroup();
DirectiveGroup TextureDirectives();
DirectiveGroup ExtraSurfaceDirectives();

/// Whether an engine of this family or an editor knows a directive of that name outside of stages, and the compiler
/// does not. `lower`: the name in lower case.
bool IsEngineDirective(std::string_view lower);

} // namespace q3
