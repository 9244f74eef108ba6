// GPL-2.0-or-later. Bytes as text, comparison without case, numbers in text, and suggestions for misspelled names.
#include "common/text/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace q3 {

// ---- Case-insensitive comparison of text, and numbers in it ----

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

std::optional<double> StrictNumber(std::string_view text) {
    if (text.empty() || IsBlank(text.front()))
        return std::nullopt;
    const std::optional<double> number = TakeNumber(text);
    return text.empty() ? number : std::nullopt;
}

std::optional<int> StrictInteger(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-"))
        text.remove_prefix(1);
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

// ---- Numbers of things, and sizes, as text ----

namespace {

/// Plurals that do not just end in -s. Another word whose end is one of these, such as "submeshes", counts too.
constexpr std::pair<std::string_view, std::string_view> kPlurals[] = {
    {"vertices", "vertex"}, {"vertexes", "vertex"}, {"indices", "index"},  {"indexes", "index"},
    {"leaves", "leaf"},     {"boxes", "box"},       {"brushes", "brush"},  {"meshes", "mesh"},
    {"patches", "patch"},   {"passes", "pass"},     {"searches", "search"}};

/// The noun in the singular; empty: the word is no plural.
std::string SingularWord(std::string_view word) {
    for (const auto &[plural, singular] : kPlurals)
        if (word.ends_with(plural))
            return std::string(word.substr(0, word.size() - plural.size())).append(singular);
    if (word.size() > 4 && word.ends_with("ies"))
        return std::string(word.substr(0, word.size() - 3)) + 'y';
    if (word.size() > 2 && word.ends_with('s') && !word.ends_with("ss") && !word.ends_with("us"))
        return std::string(word.substr(0, word.size() - 1));
    return {};
}

} // namespace

std::string Singular(std::string_view plural) {
    for (std::size_t at = 0; at < plural.size();) {
        const std::size_t end = std::min(plural.find_first_of(" ,:;", at), plural.size());
        if (const std::string noun = SingularWord(plural.substr(at, end - at)); !noun.empty())
            return std::string(plural.substr(0, at)).append(noun).append(plural.substr(end));
        at = end + 1;
    }
    return std::string(plural);
}

std::string CountedText(long long number, std::string_view plural) {
    return fmt::format("{} {}", number, number == 1 ? Singular(plural) : std::string(plural));
}

std::string SizeText(std::uint64_t bytes) {
    constexpr std::uint64_t kKilobyte = 1000, kMegabyte = 1000000;
    if (bytes < kKilobyte)
        return Counted(bytes, "bytes");
    if (bytes < kMegabyte)
        return fmt::format("{:.1f} KB", double(bytes) / double(kKilobyte));
    return fmt::format("{:.1f} MB", double(bytes) / double(kMegabyte));
}

// ---- Suggestions for misspelled names ----

std::size_t EditDistance(std::string_view a, std::string_view b) {
    // Row i has at j the distance between the first i letters of a and the first j of b. Only the last three are kept.
    std::vector<std::size_t> row(b.size() + 1), before(row), twoBefore(row);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::swap(twoBefore, before);
        std::swap(before, row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({before[j] + 1, row[j - 1] + 1, before[j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) // swapped
                row[j] = std::min(row[j], twoBefore[j - 2] + 1);
        }
    }
    return row.back();
}

std::vector<std::string> NearestNames(std::string_view word, std::span<const std::string> names) {
    const auto bare = [](std::string_view name) {
        while (name.starts_with('-'))
            name.remove_prefix(1);
        return LowerCase(name);
    };
    const std::string wanted = bare(word);
    constexpr std::size_t kMostNames = 3;
    const std::size_t most = std::max<std::size_t>(1, wanted.size() / 3);
    std::vector<std::pair<std::size_t, std::string>> near;
    for (const std::string &name : names) {
        const std::string other = bare(name);
        const std::size_t longer = std::max(wanted.size(), other.size()),
                          shorter = std::min(wanted.size(), other.size());
        if (longer - shorter > most) // the distance is at least that; saves time where a file has many unknown words
            continue;
        if (const std::size_t distance = EditDistance(wanted, other); distance <= most)
            near.emplace_back(distance, name);
    }
    std::ranges::sort(near);
    near.erase(std::unique(near.begin(), near.end()), near.end());
    std::vector<std::string> result;
    for (std::size_t i = 0; i < near.size() && i < kMostNames; ++i)
        if (near[i].first == near.front().first)
            result.push_back(near[i].second);
    return result;
}

std::string DidYouMean(std::string_view word, std::span<const std::string> names) {
    const std::vector<std::string> near = NearestNames(word, names);
    return near.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(near, " or "));
}

} // namespace q3
