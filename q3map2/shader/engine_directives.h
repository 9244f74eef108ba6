// GPL-2.0-or-later. Words of shader scripts that are for engines and editors only.
#pragma once

#include <string_view>

namespace q3 {

/// Whether an engine of this family or an editor knows a directive of that name outside of stages, and the compiler
/// does not. `lower`: the name in lower case.
bool IsEngineDirective(std::string_view lower);

} // namespace q3
