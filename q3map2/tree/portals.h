// GPL-2.0-or-later. Portals between the leafs of the tree.
#pragma once

#include "q3map2/tree/tree.h"

namespace q3 {

/// Makes the portals between leafs, and from them the bounds of nodes.
void MakePortals(Tree &tree, const PlaneTable &planes, const BspContext &context);
/// Whether both sides of the portal are open.
bool IsPassable(const Tree &tree, const TreePortal &portal);

} // namespace q3
