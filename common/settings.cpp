// GPL-2.0-or-later. Settings declared once.
#include "common/settings.h"

#include "common/error.h"
#include "common/text.h"

#include <algorithm>
#include <cmath>

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

bool IsNumber(std::string_view word, SettingKind kind) {
    return kind == SettingKind::Integer ? WholeInteger(word).has_value() : WholeNumber(word).has_value();
}

/// What a message about a bad value expects.
std::string Expected(const SettingInfo &info, SettingKind kind) {
    const std::string range = info.range.Text();
    std::string text = kind == SettingKind::Integer ? "a whole number" : "a number";
    if (info.Required() > 1)
        text = fmt::format("{} numbers", info.Required());
    if (!range.empty())
        text += " " + range;
    if (!info.unit.empty())
        text += fmt::format(" ({})", info.unit);
    return text;
}

double CheckedNumber(const SettingInfo &info, SettingKind kind, std::string_view name, std::string_view word, Log &log) {
    if (!IsNumber(word, kind))
        throw Error("{} {}: expected {}", name, word, Expected(info, kind));
    const double number = *WholeNumber(word);
    if (info.range.Contains(number)) {
        if (number < info.floor)
            log.Warn("value under the minimum", "{} {}: the minimum is {:g}; {:g} is used", name, word, info.floor,
                     info.floor);
        return std::max(number, info.floor);
    }
    const double used = info.outside == OutOfRange::Clamp ? info.range.Clamp(number) : info.outsideValue;
    if (info.outside == OutOfRange::Refuse)
        throw Error("{} {}: expected {}", name, word, Expected(info, kind));
    log.Warn("value out of range", "{} {}: expected {}; {:g} is used", name, word, Expected(info, kind), used);
    return used;
}

void CheckChoice(const SettingInfo &info, std::string_view name, std::string &word, Log &log) {
    for (std::size_t at = 0; at <= info.values.size();) {
        const std::size_t end = std::min(info.values.find('|', at), info.values.size());
        if (EqualNoCase(info.values.substr(at, end - at), word))
            return;
        at = end + 1;
    }
    if (info.outside == OutOfRange::Refuse)
        throw Error("{} {}: expected {}", name, word, info.values);
    const std::string used = fmt::format("{:g}", info.outsideValue);
    log.Warn("value out of range", "{} {}: expected {}; {} is used", name, word, info.values, used);
    word = used;
}

/// Edits that turn one word into the other, where swapping two letters is one edit.
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

std::string SettingText(bool value) {
    return value ? "on" : "off";
}

std::string SettingText(double value) {
    return fmt::format("{:.7g}", value);
}

std::string SettingText(int value) {
    return fmt::format("{}", value);
}

std::string SettingText(const std::string &value) {
    return value;
}

std::string SettingText(const std::vector<std::string> &values) {
    return fmt::format("{}", fmt::join(values, " "));
}

void WarnWithoutEffect(const std::vector<std::string> &given, Log &log) {
    if (!given.empty())
        log.Warn("options without effect", "without effect: {}", fmt::join(given, " "));
}

SettingValues TakeOccurrence(const SettingInfo &info, SettingKind kind, Arguments &arguments, std::size_t at,
                             Log &log) {
    const std::string name = arguments.TakeAt(at);
    const bool isText = kind == SettingKind::Text || kind == SettingKind::Choice;
    SettingValues values;
    while (values.words.size() < info.Most()) {
        const bool required = values.words.size() < info.Required();
        if (at >= arguments.Rest().size()) {
            if (!required)
                break;
            throw Error("{} needs {}: {} {}; the command line ends before", name,
                        info.Required() == 1 ? "a value" : fmt::format("{} values", info.Required()), info.name,
                        info.values);
        }
        const std::string &next = arguments.Rest()[at];
        if (!required && !isText && !IsNumber(next, kind))
            break;
        if (isText && required && next.size() > 1 && next.front() == '-' && !WholeNumber(next))
            throw Error("{} needs a value: {} {}; found {}", name, info.name, info.values, next);
        values.words.push_back(arguments.TakeAt(at));
        if (!isText)
            values.numbers.push_back(CheckedNumber(info, kind, name, values.words.back(), log));
        else if (kind == SettingKind::Choice)
            CheckChoice(info, name, values.words.back(), log);
    }
    return values;
}

void WarnOfUnknown(const Arguments &arguments, Log &log) {
    for (const std::string &word : arguments.Rest())
        log.Warn("unknown argument", "Unknown argument \"{}\"", word);
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
