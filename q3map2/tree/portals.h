// GPL-2.0-or-later. Portals between the leafs of the tree.
#pragma once

#include "q3map2/tree/tree.h"

namespace q3 {

/// Makes the portals between leafs, and sets bounds of nodes to the bounds of their portals.
void MakePortals(Tree &tree, const PlaneTable &planes, const BspContext &context);
/// Whether the portal joins two open leafs. False at the border of the world and for antiportals.
bool IsPassable(const Tree &tree, const TreePortal &portal);

} // namespace q3
