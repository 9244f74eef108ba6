// GPL-2.0-or-later. What is declared about a setting.
#include "common/setting_info.h"

#include "common/nearest_names.h"
#include "common/text/text.h"

#include <algorithm>

#include <fmt/ranges.h>

namespace q3 {

namespace {

std::size_t CountValues(std::string_view values, bool withOptional) {
    std::size_t count = 0;
    for (std::size_t at = 0; at < values.size();) {
        const std::size_t end = std::min(values.find(' ', at), values.size());
        count += end > at && (withOptional || values[at] != '[');
        at = end + 1;
    }
    return count;
}

} // namespace

std::string SettingRange::Text() const {
    return fmt::format("{} {:.12g} {} {:.12g}", aboveLow ? "over" : "from", low,
                       belowHigh  ? "and below"
                       : aboveLow ? "up to"
                                  : "to",
                       high);
}

bool SettingInfo::Names(std::string_view word) const {
    return EqualNoCase(name, word) ||
           std::ranges::any_of(aliases, [&](std::string_view a) { return !a.empty() && EqualNoCase(a, word); });
}

std::size_t SettingInfo::MinValues() const {
    return CountValues(values, false);
}

std::size_t SettingInfo::MaxValues() const {
    return CountValues(values, true);
}

} // namespace q3
