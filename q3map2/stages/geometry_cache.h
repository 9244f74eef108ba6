// GPL-2.0-or-later. -cache for bsp: the geometry of an earlier run, if only entities without geometry have changed.
#pragma once

#include "q3map2/geometry/compile_map.h"
#include "q3map2/stages/stage_cache.h"

#include <optional>
#include <string_view>

namespace q3 {

class RunEvents;

/// Compiles maps, or takes all but the entities from an earlier run. What was kept is used if the source has the same
/// text but for its loose entities, if the files of the game answer the same, and if the loose entities, which may
/// stand elsewhere, flood the same regions. Loose are point entities that only the game and the light stage use.
class GeometryCache {
  public:
    /// cache: of the stage; without -cache every map is compiled.
    GeometryCache(const StageCache &cache, VirtualFileSystem &vfs, const BspFormat &format)
        : cache_(cache.Folder()), settings_(cache.Settings()), vfs_(vfs), format_(format) {}

    /// CompileMap. text: the source of the map.
    CompiledMap Compile(Map &map, std::string_view text, const BspContext &context);

  private:
    struct Source;
    std::optional<CompiledMap> Find(const Source &source, const BspContext &context);
    void Keep(const Source &source, const CompiledMap &compiled, RunEvents &events) const;

    std::optional<Cache> cache_;
    Hash128 settings_;
    VirtualFileSystem &vfs_;
    const BspFormat &format_;
};

} // namespace q3
