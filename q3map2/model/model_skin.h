// GPL-2.0-or-later. Shader replacements of placed models.
#pragma once

#include "common/files/vfs.h"
#include "common/log.h"
#include "q3map2/bspfile/entities.h"

#include <functional>
#include <string>
#include <string_view>

namespace q3 {

/// Returns the replacement for the shader of a mesh. If it returns an empty string, the mesh is omitted.
using ShaderRemap = std::function<std::string(std::string_view)>;

/// The shader replacements defined by the skin file and the _remap keys of an entity with this model. who: the entity,
/// for messages. Without `vfs` no skin is found.
ShaderRemap ShaderRemapOf(const Entity &entity, std::string_view who, std::string_view model,
                          const VirtualFileSystem *vfs, Log &log);

} // namespace q3
