// GPL-2.0-or-later. Suggestions for misspelled names.
#include "common/nearest_names.h"

#include "common/text/text.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace q3 {

std::size_t EditDistance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                d[i][j] = i + j;
                continue;
            }
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

std::vector<std::string> NearestNames(std::string_view word, std::span<const std::string> names) {
    const auto bare = [](std::string_view name) {
        while (name.starts_with('-'))
            name.remove_prefix(1);
        return LowerCase(name);
    };
    const std::string wanted = bare(word);
    const std::size_t most = std::max<std::size_t>(1, wanted.size() / 3);
    std::vector<std::pair<std::size_t, std::string>> near;
    for (const std::string &name : names)
        if (const std::size_t distance = EditDistance(wanted, bare(name)); distance <= most)
            near.emplace_back(distance, name);
    std::ranges::sort(near);
    near.erase(std::unique(near.begin(), near.end()), near.end());
    std::vector<std::string> result;
    for (std::size_t i = 0; i < near.size() && i < 3; ++i)
        if (near[i].first == near.front().first)
            result.push_back(near[i].second);
    return result;
}

std::string DidYouMean(std::string_view word, std::span<const std::string> names) {
    const std::vector<std::string> near = NearestNames(word, names);
    return near.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(near, " or "));
}

} // namespace q3
