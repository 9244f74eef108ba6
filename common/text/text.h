// GPL-2.0-or-later. Bytes as text, comparison without case, numbers in text, and suggestions for misspelled names.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// The finite number that the text is as a whole, without blanks around it; std::nullopt if it is not one.
std::optional<double> StrictNumber(std::string_view text);
/// The same for integers that fit an int.
std::optional<int> StrictInteger(std::string_view text);

/// The phrase with its first plural noun in the singular: "draw surfaces written" gives "draw surface written".
std::string Singular(std::string_view plural);
/// "1 light", "2 lights": the number and the phrase, which is given in the plural.
std::string CountedText(long long number, std::string_view plural);
template <std::integral T> std::string Counted(T number, std::string_view plural) {
    return CountedText((long long)(number), plural);
}
/// A size for people: "900 bytes", "12.3 KB", "4.5 MB", with 1000 bytes to the KB.
std::string SizeText(std::uint64_t bytes);

/// Least number of insertions, deletions, replacements and swaps of adjacent letters that turn `a` into `b`, with no
/// letter edited twice (optimal string alignment).
std::size_t EditDistance(std::string_view a, std::string_view b);

/// The names at the least edit distance from a mistyped word, ignoring case and leading dashes: at most three, none
/// farther off than a third of the word's length.
std::vector<std::string> NearestNames(std::string_view word, std::span<const std::string> names);
/// "; did you mean -light?", or nothing.
std::string DidYouMean(std::string_view word, std::span<const std::string> names);

} // namespace q3
