// GPL-2.0-or-later. The record that a map keeps of how it was made.
#pragma once

#include "q3map2/bspfile/bspfile.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Appends a stage, such as "-light", and its options to the worldspawn key `_q3map2_cmdline`, and sets
/// `_q3map2_version`. `name` is for messages. Errors: entity text that does not parse.
void RecordCommand(Bsp &bsp, std::string_view stage, std::string_view name, const std::vector<std::string> &words);

} // namespace q3
