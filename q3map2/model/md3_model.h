// GPL-2.0-or-later. MD3 models with the vertices of the file, in its order.
#pragma once

#include "q3map2/model/model_load.h"

#include <cstddef>
#include <span>
#include <string_view>

namespace q3 {

/// Whether the file begins as an MD3 model does.
bool IsMd3(std::span<const std::byte> file);
/// The meshes and vertices of an MD3 model as an engine has them: nothing is joined, split or left out. modelName: for
/// shader names, see ShaderOfMaterial. Errors: a version other than 15, no such frame, parts outside the file.
Model ReadMd3(std::span<const std::byte> file, std::string_view modelName, int frame);

} // namespace q3
