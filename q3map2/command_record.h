// GPL-2.0-or-later. The record that a map keeps of how it was made.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Appends a stage, such as "-light", and its options to the world's key `_q3map2_cmdline`, and sets `_q3map2_version`.
void RecordCommand(Entity &world, std::string_view stage, const std::vector<std::string> &words);
/// The same in the entities of a map. `name` is for messages. Errors: entity text that does not parse.
void RecordCommand(Bsp &bsp, std::string_view stage, std::string_view name, const std::vector<std::string> &words);

} // namespace q3
