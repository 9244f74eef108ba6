// GPL-2.0-or-later. What a package leaves out because players have it.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace q3 {

/// Names in lower case, those of files without extension, those of scripts without folder too.
struct Exclusions {
    std::set<std::string> textures, shaders, shaderFiles, sounds, videos;

    bool HasTexture(std::string_view image) const;
    bool HasShader(std::string_view shader) const;
    bool HasShaderFile(std::string_view script) const;
    bool HasSound(std::string_view sound) const;
    bool HasVideo(std::string_view video) const;
    /// Whether it is a texture of the list and no shader of it: an image that the game has under a name for which a
    /// script must define nothing else.
    bool IsPureTexture(std::string_view name) const { return HasTexture(name) && !HasShader(name); }
    void Add(const Exclusions &other);
};

/// Blocks `textures { }`, `shaders { }`, `shaderfiles { }`, `sounds { }` and `videos { }` of names. `name` is for
/// messages. Errors: another block, a brace that is missing.
Exclusions ReadExclusions(std::string text, std::string_view name);

} // namespace q3
