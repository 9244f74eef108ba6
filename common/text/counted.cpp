// GPL-2.0-or-later. Numbers of things, and sizes, as text.
#include "common/text/counted.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace q3 {

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

std::string Counted(long long number, std::string_view plural) {
    return fmt::format("{} {}", number, number == 1 ? Singular(plural) : std::string(plural));
}

std::string SizeText(std::uint64_t bytes) {
    constexpr std::uint64_t kKilobyte = 1000, kMegabyte = 1000000;
    if (bytes < kKilobyte)
        return Counted((long long)(bytes), "bytes");
    if (bytes < kMegabyte)
        return fmt::format("{:.1f} KB", double(bytes) / double(kKilobyte));
    return fmt::format("{:.1f} MB", double(bytes) / double(kMegabyte));
}

} // namespace q3
