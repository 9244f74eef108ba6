// GPL-2.0-or-later. Packages of the Dæmon engine, NAME_VERSION.dpk and folders NAME_VERSION.dpkdir: their names,
// versions, and the file DEPS that names the packages that one needs.
#include "common/files/dependencies.h"

#include "common/log.h"

#include <algorithm>

namespace q3 {

namespace {

bool IsDigit(char c) {
    return c >= '0' && c <= '9';
}

/// Rank of what stands at `at` outside a number; that of the end, and of a digit, is 0.
int RankAt(std::string_view text, std::size_t at) {
    if (at >= text.size() || IsDigit(text[at]))
        return 0;
    const char c = text[at];
    if (c == '~')
        return -1;
    constexpr int kAfterLetters = 256;
    const bool isLetter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    return isLetter ? c : static_cast<unsigned char>(c) + kAfterLetters;
}

/// The number that begins at `at`, without leading zeros; `at` moves behind it.
std::string_view TakeDigits(std::string_view text, std::size_t &at) {
    while (at < text.size() && text[at] == '0')
        ++at;
    const std::size_t begin = at;
    while (at < text.size() && IsDigit(text[at]))
        ++at;
    return text.substr(begin, at - begin);
}

/// The next word of a line, which is taken off; empty: none.
std::string_view TakeWord(std::string_view &line) {
    constexpr std::string_view kBlanks = " \t\r\v\f";
    line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
    line.remove_prefix(word.size());
    return word;
}

} // namespace

PackageName ParsePackageName(std::string_view stem) {
    const std::size_t first = std::min(stem.find('_'), stem.size());
    const std::string_view rest = stem.substr(std::min(first + 1, stem.size()));
    return {std::string(stem.substr(0, first)), std::string(rest.substr(0, rest.find('_')))};
}

int CompareVersions(std::string_view a, std::string_view b) {
    for (std::size_t i = 0, k = 0; i < a.size() || k < b.size();) {
        while ((i < a.size() && !IsDigit(a[i])) || (k < b.size() && !IsDigit(b[k]))) {
            if (const int difference = RankAt(a, i) - RankAt(b, k); difference != 0)
                return difference;
            ++i, ++k;
        }
        const std::string_view numberA = TakeDigits(a, i), numberB = TakeDigits(b, k);
        if (numberA.size() != numberB.size())
            return numberA.size() < numberB.size() ? -1 : 1;
        if (const int difference = numberA.compare(numberB); difference != 0)
            return difference;
    }
    return 0;
}

std::vector<PackageName> ParseDependencies(std::string_view text, std::string_view name, Log &log) {
    std::vector<PackageName> packages;
    for (int number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string_view package = TakeWord(line), version = TakeWord(line);
        if (!TakeWord(line).empty())
            log.Warn("package dependencies", "{}: line {}: expected a package, and its version or nothing", name,
                     number);
        else if (!package.empty())
            packages.push_back({std::string(package), std::string(version)});
    }
    return packages;
}

} // namespace q3
