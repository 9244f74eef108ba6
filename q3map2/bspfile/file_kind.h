// GPL-2.0-or-later. Names files that are neither a map source nor a .bsp of this family, for messages.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace q3 {

/// How many bytes KindOfFile looks at.
inline constexpr std::size_t kKindBytes = 4096;

/// What KindOfFile returns for files that may be map sources.
inline constexpr std::string_view kKindEmpty = "empty", kKindText = "text",
                                  kKindMapSource = "a map source: compile it with -bsp";

/// What a file is by its first bytes: "a map of Quake II (IBSP 38)", "a zip archive", "text". Empty: IBSP 46 or 47, or
/// unknown.
std::string KindOfFile(std::span<const std::byte> begin);

/// What a map source of another game family is: "a map source of Doom 3 (Version 2)". Empty: none of these.
std::string KindOfSource(std::string_view text);

} // namespace q3
