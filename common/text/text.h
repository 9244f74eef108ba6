// GPL-2.0-or-later. Bytes as text, case-insensitive comparison, and numbers in text.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace q3 {

/// The bytes as characters, not copied: valid as long as `bytes`.
inline std::string_view AsText(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char *>(bytes.data()), bytes.size()};
}

/// Whether the character separates words: a space or a control character.
constexpr bool IsBlank(char c) {
    return static_cast<unsigned char>(c) <= ' ';
}
/// Copy with A-Z in lower case.
std::string LowerCase(std::string_view text);
/// Equal but for the case of A-Z.
bool EqualNoCase(std::string_view a, std::string_view b);
bool StartsWithNoCase(std::string_view text, std::string_view prefix);
bool EndsWithNoCase(std::string_view text, std::string_view suffix);

/// Takes a number off the front of `text`, by C rules: leading blanks, sign, stops at the first character that is not
/// part of it. If there is no finite number: std::nullopt, and only blanks are taken off.
std::optional<double> TakeNumber(std::string_view &text);
/// The number at the front of the text; garbage and non-finite values are 0.
double NumberFromText(std::string_view text);
/// The same for integers; numbers out of range are clamped.
int IntegerFromText(std::string_view text);

/// The finite number that the whole text spells: no blanks around it; std::nullopt if it is not one.
std::optional<double> WholeNumber(std::string_view text);
/// The same for integers that fit an int.
std::optional<int> WholeInteger(std::string_view text);

} // namespace q3
