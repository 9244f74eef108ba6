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
    const bool hasLow = low > -kMaxSetting, hasHigh = high < kMaxSetting;
    const std::string bottom = fmt::format("{} {:g}", aboveLow ? "over" : "from", low);
    if (hasLow && hasHigh)
        return fmt::format("{} {} {:g}", bottom, belowHigh ? "and below" : aboveLow ? "up to" : "to", high);
    if (hasLow)
        return aboveLow ? bottom : fmt::format("of at least {:g}", low);
    if (hasHigh)
        return fmt::format("of at most {:g}", high);
    return {};
}

bool SettingInfo::Names(std::string_view word) const {
    return EqualNoCase(name, word) ||
           std::ranges::any_of(aliases, [&](std::string_view a) { return !a.empty() && EqualNoCase(a, word); });
}

std::size_t SettingInfo::Required() const {
    return CountValues(values, false);
}

std::size_t SettingInfo::Most() const {
    return CountValues(values, true);
}

std::vector<std::string> CloseNames(std::string_view word, std::span<const std::string> names) {
    const auto bare = [](std::string_view name) {
        while (name.starts_with('-'))
            name.remove_prefix(1);
        return LowerCase(name);
    };
    const std::string wanted = bare(word);
    const std::size_t most = wanted.size() <= 3 ? 1 : std::max<std::size_t>(2, wanted.size() / 3);
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
    const std::vector<std::string> near = CloseNames(word, names);
    return near.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(near, " or "));
}

} // namespace q3
