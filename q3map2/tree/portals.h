// GPL-2.0-or-later. Portals between the leafs of the tree, and the .prt file.
#pragma once

#include "q3map2/tree/tree.h"

#include <string>

namespace q3 {

/// Makes the portals between leafs, and sets bounds of nodes to the bounds of their portals.
void MakePortals(Tree &tree, const PlaneTable &planes, const BspContext &context);
/// Whether the portal joins two open leafs. False at the border of the world and for antiportals.
bool IsPassable(const Tree &tree, const TreePortal &portal);

/// Text of the portal file, the input of the vis stage.
std::string PortalFileText(const Tree &tree, int clusters);

} // namespace q3
