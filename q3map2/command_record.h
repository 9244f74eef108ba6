// GPL-2.0-or-later. The record that a map keeps of how it was made.
#pragma once

#include "q3map2/bspfile/entities.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Appends a stage, such as "-light", and its options to the keys of the world.
void RecordCommand(Entity &world, std::string_view stage, const std::vector<std::string> &words);

} // namespace q3
