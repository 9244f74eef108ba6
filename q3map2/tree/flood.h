// GPL-2.0-or-later. Flood fill from entities: finds leaks, makes leafs outside opaque.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

#include <string>
#include <vector>

namespace q3 {

enum class Sealing {
    Sealed,
    Leaked, ///< the flood from an entity reaches the outside
    Empty   ///< no entity stands in the open
};

/// Floods from all point entities in open leafs. `warn`: about entities in solid and lights in detail brushes; once per
/// map is enough.
Sealing FloodEntities(Tree &tree, const Map &map, const BspContext &context, bool warn = true);
/// Makes all leafs opaque that no flood reached.
void FillOutside(Tree &tree, const BspContext &context);
/// The shortest line from outside to an entity: centers of portals, then the entity's origin. Empty: sealed.
std::vector<Vec3f> LeakLine(const Tree &tree, const Map &map);
/// The entity at the end of the leak line (index in the map); -1: sealed.
int LeakedEntity(const Tree &tree);
/// The leak line as text of a .lin file: one point per text line.
std::string LeakFileText(const std::vector<Vec3f> &line);

} // namespace q3
