// GPL-2.0-or-later. Case-insensitive comparison of text, and numbers in it.
#include "common/text/text.h"

#include <algorithm>
#include <charconv>
#include <climits>
#include <cmath>
#include <cstdlib>

namespace q3 {

namespace {

char Lower(char c) {
    return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
}

} // namespace

std::string LowerCase(std::string_view text) {
    std::string lower(text);
    std::ranges::transform(lower, lower.begin(), Lower);
    return lower;
}

bool EqualNoCase(std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, [](char x, char y) { return Lower(x) == Lower(y); });
}

bool StartsWithNoCase(std::string_view text, std::string_view prefix) {
    return EqualNoCase(text.substr(0, prefix.size()), prefix);
}

bool EndsWithNoCase(std::string_view text, std::string_view suffix) {
    return text.size() >= suffix.size() && EqualNoCase(text.substr(text.size() - suffix.size()), suffix);
}

std::optional<double> TakeNumber(std::string_view &text) {
    while (!text.empty() && IsBlank(text.front()))
        text.remove_prefix(1);
    std::string_view digits = text;
    if (digits.starts_with('+') && !digits.starts_with("+-"))
        digits.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || !std::isfinite(value))
        return std::nullopt;
    text = digits.substr(std::size_t(end - digits.data()));
    return value;
}

double NumberFromText(std::string_view text) {
    return TakeNumber(text).value_or(0);
}

int IntegerFromText(std::string_view text) {
    const long value = std::strtol(std::string(text).c_str(), nullptr, 10);
    return int(std::clamp<long>(value, INT_MIN, INT_MAX));
}

std::optional<double> WholeNumber(std::string_view text) {
    if (text.empty() || IsBlank(text.front()))
        return std::nullopt;
    const std::optional<double> number = TakeNumber(text);
    return text.empty() ? number : std::nullopt;
}

std::optional<int> WholeInteger(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-"))
        text.remove_prefix(1);
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

} // namespace q3
