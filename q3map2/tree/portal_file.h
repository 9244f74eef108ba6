// GPL-2.0-or-later. The .prt file.
#pragma once

#include "q3map2/tree/tree.h"

#include <string>

namespace q3 {

/// Text of the portal file, the input of the vis stage.
std::string PortalFileText(const Tree &tree, int clusters);

} // namespace q3
