// GPL-2.0-or-later. Settings declared once: parsing, ranges, help and documentation come from one table.
#include "common/settings.h"

#include "common/error.h"
#include "common/text/text.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- What is declared about a setting ----

namespace {

/// Which of the values that SettingInfo::values names are counted.
enum class Counting { RequiredValues, AllValues };

std::size_t CountValues(std::string_view values, Counting counting) {
    std::size_t count = 0;
    for (std::size_t at = 0; at < values.size();) {
        const std::size_t end = std::min(values.find(' ', at), values.size());
        count += end > at && (counting == Counting::AllValues || values[at] != '[');
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
    return EqualNoCase(name, word) || std::ranges::any_of(aliases, [&](std::string_view alias) {
               return !alias.empty() && EqualNoCase(alias, word);
           });
}

std::size_t SettingInfo::MinValues() const {
    return CountValues(values, Counting::RequiredValues);
}

std::size_t SettingInfo::MaxValues() const {
    return CountValues(values, Counting::AllValues);
}

// ---- Values of the command line, checked against what is declared ----

namespace {

bool IsNumber(std::string_view word, SettingKind kind) {
    return kind == SettingKind::Integer ? StrictInteger(word).has_value() : StrictNumber(word).has_value();
}

/// The expected value in words, for messages about a bad one: "a whole number from 1 to 8 (luxels)".
std::string ExpectedValue(const SettingInfo &info, SettingKind kind) {
    std::string text = kind == SettingKind::Integer ? "a whole number" : "a number";
    if (info.MinValues() > 1)
        text = fmt::format("{} numbers", info.MinValues());
    text += " " + info.range.Text();
    if (!info.unit.empty())
        text += fmt::format(" ({})", info.unit);
    if (!info.limitReason.empty())
        text += fmt::format("; {}", info.limitReason);
    return text;
}

double CheckedNumber(const SettingInfo &info, SettingKind kind, std::string_view name, std::string_view word,
                     Log &log) {
    if (!IsNumber(word, kind))
        throw Error("{} {}: expected {}", name, word, ExpectedValue(info, kind));
    const double number = *StrictNumber(word);
    if (info.range.Contains(number)) {
        if (number < info.floor)
            log.Warn("value under the minimum", "{} {}: the minimum is {:g}; {:g} is used", name, word, info.floor,
                     info.floor);
        return std::max(number, info.floor);
    }
    if (info.outside == OutOfRange::Refuse)
        throw Error("{} {}: expected {}", name, word, ExpectedValue(info, kind));
    const double used = info.outside == OutOfRange::Clamp ? info.range.Clamp(number) : info.outsideValue;
    log.Warn("value out of range", "{} {}: expected {}; {:g} is used", name, word, ExpectedValue(info, kind), used);
    return used;
}

/// Gives the word the spelling of the choice that it equals but for case.
void CheckChoice(const SettingInfo &info, std::string_view name, std::string &word, Log &log) {
    for (std::size_t at = 0; at <= info.values.size();) {
        const std::size_t end = std::min(info.values.find('|', at), info.values.size());
        if (const std::string_view choice = info.values.substr(at, end - at); EqualNoCase(choice, word)) {
            word = choice;
            return;
        }
        at = end + 1;
    }
    if (info.outside == OutOfRange::Refuse)
        throw Error("{} {}: expected {}", name, word, info.values);
    const std::string used = fmt::format("{:g}", info.outsideValue);
    log.Warn("value out of range", "{} {}: expected {}; {} is used", name, word, info.values, used);
    word = used;
}

} // namespace

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
        log.Warn("options without effect", "without effect: {}", fmt::join(given, ", "));
}

/// Name of a value that is options of something else in one word, so a dash may begin it.
constexpr std::string_view kOptionsInOneWord = "OPTIONS";

SettingValues TakeOccurrence(const SettingInfo &info, SettingKind kind, Arguments &arguments, std::size_t at,
                             Log &log) {
    const std::string name = arguments.TakeAt(at);
    const bool isText = kind == SettingKind::Text || kind == SettingKind::Choice;
    SettingValues values;
    while (values.words.size() < info.MaxValues()) {
        const bool required = values.words.size() < info.MinValues();
        if (at >= arguments.Rest().size()) {
            if (!required)
                break;
            throw Error("{} needs {}: {} {}; the command line ends too early", name,
                        info.MinValues() == 1 ? "a value" : fmt::format("{} values", info.MinValues()), info.name,
                        info.values);
        }
        const std::string &next = arguments.Rest()[at];
        if (!required && !isText && !IsNumber(next, kind))
            break;
        if (isText && required && info.values != kOptionsInOneWord && next.size() > 1 && next.front() == '-' && !StrictNumber(next))
            throw Error("{} needs a value: {} {}; found {}", name, info.name, info.values, next);
        values.words.push_back(arguments.TakeAt(at));
        if (!isText) {
            const double used = CheckedNumber(info, kind, name, values.words.back(), log);
            if (used != *StrictNumber(values.words.back()))
                values.words.back() = SettingText(used);
            values.numbers.push_back(used);
        } else if (kind == SettingKind::Choice)
            CheckChoice(info, name, values.words.back(), log);
    }
    return values;
}

void WarnOfUnknown(const Arguments &arguments, Log &log) {
    for (const std::string &word : arguments.Rest())
        log.Warn("unknown argument", "Unknown argument \"{}\"", word);
}

} // namespace q3
