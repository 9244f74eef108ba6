// GPL-2.0-or-later. Context of every step of the bsp stage: options, game files, log.
#pragma once

#include "q3map2/map/bsp_options.h"
#include "q3map2/shader/shader_library.h"

#include <string>
#include <string_view>

namespace q3 {

/// Options, game files and log of a compile.
struct BspContext {
    const BspOptions &options;
    const Game &game;
    ShaderLibrary &shaders;
    Log &log;
    const VirtualFileSystem *vfs = nullptr; ///< for models, skins and index maps; null: none are found
    std::string leakFile{};                 ///< where the stage writes the line of a leak, for messages; empty: nowhere

    /// Warns "Entity E, Brush B: text". A connected editor selects the primitive.
    void WarnAt(std::string_view kind, int entity, int primitive, std::string_view text) const;
    [[noreturn]] void FailAt(int entity, int primitive, std::string_view text) const;
};

} // namespace q3
