// GPL-2.0-or-later. Directives of shader scripts that shape surfaces.
#pragma once

#include "q3map2/shader/shader_info.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Numbers in scripts are clamped to +- this, so that products of a few stay finite.
inline constexpr double kMaxNumber = 1e9;

/// The number at the front of the word, clamped; 0 if there is none.
float Number(std::string_view word);

/// A directive and how many words follow it, parentheses not counted.
struct GeometryDirective {
    using Words = std::span<const std::string_view>;
    std::string_view name; ///< lower case
    std::size_t required, optional;
    /// Changes the shader; returns what is wrong with the words, or nothing.
    std::string (*apply)(ShaderInfo &shader, Words words, const ShaderOptions &options, const Game &game);
};

/// The directive of that name in lower case, or null.
const GeometryDirective *FindGeometryDirective(std::string_view name);

/// deformVertexes with its words: sprites and movement.
void ApplyDeform(ShaderInfo &shader, std::span<const std::string_view> words);
/// q3map_terrain.
void ApplyTerrain(ShaderInfo &shader);

} // namespace q3
