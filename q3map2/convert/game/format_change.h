// GPL-2.0-or-later. A map in the format of another game: IBSP with one light style, RBSP and FBSP with four.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <string_view>

namespace q3 {

/// Makes `bsp` a map of the format `ident`. What that format cannot hold is dropped, each with a warning: light of other
/// styles than 0, lightmap pages of another size, advertisements. Points of the legacy grid in walls are marked as
/// engines of the format know them.
void ChangeFormat(Bsp &bsp, std::string_view ident, Log &log);

} // namespace q3
