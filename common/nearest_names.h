// GPL-2.0-or-later. Names like a misspelt one.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Edit distance of Levenshtein without case: insertions, deletions and replacements that make `a` into `b`.
std::size_t EditDistance(std::string_view a, std::string_view b);

/// Up to `count` of the names, by increasing edit distance from `word`; equally near ones in their order.
std::vector<std::string> NearestNames(std::string_view word, std::vector<std::string> names, std::size_t count);

} // namespace q3
