// GPL-2.0-or-later. Suggestions for misspelled names.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Least number of insertions, deletions, replacements and swaps of adjacent letters that turn `a` into `b`, with no
/// letter edited twice (optimal string alignment).
std::size_t EditDistance(std::string_view a, std::string_view b);

/// The names at the least edit distance from a mistyped word, ignoring case and leading dashes: at most three, none
/// farther off than a third of the word's length.
std::vector<std::string> NearestNames(std::string_view word, std::span<const std::string> names);
/// "; did you mean -light?", or nothing.
std::string DidYouMean(std::string_view word, std::span<const std::string> names);

} // namespace q3
