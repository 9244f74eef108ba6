// GPL-2.0-or-later. The outline of a map source: entities with their pairs, brushes and patches.
#pragma once

#include "common/log.h"
#include "q3map2/map/map_scanner.h"

#include <string>
#include <string_view>

namespace q3 {

/// Receives what ReadMapEntities finds, in the order of the text. Entities are numbered from 0 in the map, primitives
/// (brushes and patches) from 0 in their entity.
class MapEntityHandler {
  public:
    virtual ~MapEntityHandler() = default;
    virtual void BeginEntity(int entity) = 0;
    virtual void OnPair(const std::string &key, const std::string &value) = 0;
    /// Must read the brush up to its "}". `first`: the token after its "{", already read.
    virtual void OnBrush(int primitive, const std::string &first) = 0;
    /// Must read the patch after its keyword: patchDef3 if it `hasTolerances`, else patchDef2.
    virtual void OnPatch(int primitive, bool hasTolerances) = 0;
    virtual void EndEntity() = 0;
};

/// Reads a whole map source. `name`: of the file, for messages. Warns of text between entities, of missing braces and
/// of terrainDef, which it skips. Errors: no entity, and what is neither a brush nor a patch.
void ReadMapEntities(MapScanner &scanner, std::string_view name, Log &log, MapEntityHandler &handler);

} // namespace q3
