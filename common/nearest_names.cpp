// GPL-2.0-or-later. Names like a misspelt one.
#include "common/nearest_names.h"

#include "common/text/text.h"

#include <algorithm>
#include <numeric>

namespace q3 {

std::size_t EditDistance(std::string_view a, std::string_view b) {
    // row[j]: distance of the first i characters of a from the first j of b.
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t(0));
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (EqualNoCase(a.substr(i, 1), b.substr(j, 1)) ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
        }
    }
    return row.back();
}

std::vector<std::string> NearestNames(std::string_view word, std::vector<std::string> names, std::size_t count) {
    std::stable_sort(names.begin(), names.end(), [&](const std::string &a, const std::string &b) {
        return EditDistance(word, a) < EditDistance(word, b);
    });
    names.resize(std::min(names.size(), count));
    return names;
}

} // namespace q3
