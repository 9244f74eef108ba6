// GPL-2.0-or-later. Shader replacements of placed models.
#pragma once

#include "common/files/vfs.h"
#include "common/log.h"
#include "q3map2/bspfile/entities.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// The shader replacements of one placed model; by default none.
class ShaderRemap {
  public:
    struct Replacement {
        std::string from, to;
    };

    ShaderRemap() = default;
    /// `skin`: the lines of a skin file, if there is one. `remaps`: _remap keys in the order in which they are tried.
    ShaderRemap(std::optional<std::vector<Replacement>> skin, std::vector<Replacement> remaps)
        : skin_(std::move(skin)), remaps_(std::move(remaps)) {}

    /// The replacement for the shader of a mesh. Empty: the mesh is omitted.
    std::string operator()(std::string_view shader) const;
    /// Warns of each _remap key that matches none of the shaders of the model.
    void WarnOfUnmatched(std::span<const std::string> shaders, std::string_view who, Log &log) const;

  private:
    std::string Skinned(std::string_view shader) const;

    std::optional<std::vector<Replacement>> skin_;
    std::vector<Replacement> remaps_;
};

/// The shader replacements defined by the skin file and the _remap keys of an entity with this model. who: the entity,
/// for messages. Without `vfs` no skin is found.
ShaderRemap ShaderRemapOf(const Entity &entity, std::string_view who, std::string_view model,
                          const VirtualFileSystem *vfs, Log &log);

} // namespace q3
