// GPL-2.0-or-later. Numbers of things, and sizes, as text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace q3 {

/// The phrase with its first plural noun in the singular: "draw surfaces written" gives "draw surface written".
std::string Singular(std::string_view plural);
/// "1 light", "2 lights": the number and the phrase, which is given in the plural.
std::string Counted(long long number, std::string_view plural);
/// A size for people: "900 bytes", "12.3 KB", "4.5 MB", with 1000 bytes to the KB.
std::string SizeText(std::uint64_t bytes);

} // namespace q3
