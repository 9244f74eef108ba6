// GPL-2.0-or-later. Context of every step of the bsp stage: options, game files, log.
#pragma once

#include "q3map2/map/bsp_options.h"
#include "q3map2/shader/shader_library.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Where the entities and primitives of a map source begin, for messages.
class MapPlaces {
  public:
    /// `primitive`: -1 for the entity itself. `location`: FILE:LINE.
    void Set(int entity, int primitive, std::string location);
    /// Of the primitive, else of its entity; empty: unknown.
    std::string_view Of(int entity, int primitive) const;

  private:
    std::vector<std::vector<std::string>> places_; ///< by entity; of itself first, then of its primitives
};

/// Options, game files and log of a compile.
struct BspContext {
    const BspOptions &options;
    const Game &game;
    ShaderLibrary &shaders;
    Log &log;
    const VirtualFileSystem *vfs = nullptr; ///< for models, skins and index maps; null: none are found
    std::shared_ptr<MapPlaces> places = std::make_shared<MapPlaces>(); ///< set by the reader of the map source
    std::string leakFile{}; ///< path of the .lin that shows a leak, for messages; empty: none is written

    /// Warns "Entity E, Brush B: FILE:LINE: text"; `primitive` -1: about the entity, without a brush. `location`
    /// replaces the line where the primitive begins; "": none is printed. A connected editor selects the primitive.
    void WarnAt(std::string_view kind, int entity, int primitive, std::string_view text,
                std::optional<std::string_view> location = {}) const;
    /// Throws Error with such a text.
    [[noreturn]] void FailAt(int entity, int primitive, std::string_view text,
                             std::optional<std::string_view> location = {}) const;

  private:
    std::string Located(int entity, int primitive, std::string_view text,
                        std::optional<std::string_view> location) const;
};

} // namespace q3
