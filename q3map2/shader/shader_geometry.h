// GPL-2.0-or-later. Directives of shader scripts that shape surfaces and do more than set a field.
#pragma once

#include "q3map2/shader/shader_table.h"

#include <span>
#include <string_view>

namespace q3 {

/// deformVertexes with its words: sprites and movement.
void ApplyDeform(ShaderInfo &shader, std::span<const std::string_view> words);
/// q3map_terrain.
void ApplyTerrain(ShaderInfo &shader);

} // namespace q3
