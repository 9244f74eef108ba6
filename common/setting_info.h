// GPL-2.0-or-later. What is declared about a setting: an option of the command line or a key of an entity.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Default limit of settings: products of a few larger numbers could overflow float.
inline constexpr double kMaxSetting = 1e6;

enum class SettingKind {
    Flag,    ///< no value
    Integer, ///< whole numbers
    Number,  ///< numbers, possibly with a fraction
    Text,    ///< a word: a name or a path
    Choice   ///< one of the words of `values`, separated by "|"
};

/// What happens to a number outside the range of its setting. Text that is no number is always an error.
enum class OutOfRange {
    Refuse,    ///< an error
    Clamp,     ///< a warning that names both values; the nearest value of the range is used
    UseDefault ///< a warning; SettingInfo::outsideValue is used
};

struct SettingRange {
    double low = -kMaxSetting, high = kMaxSetting;
    bool aboveLow = false, belowHigh = false; ///< the limit itself is not allowed

    bool Contains(double number) const {
        return (aboveLow ? number > low : number >= low) && (belowHigh ? number < high : number <= high);
    }
    double Clamp(double number) const { return number < low ? low : number > high ? high : number; }
    /// Whether it is the range of settings that declare none.
    bool IsDefault() const { return low == -kMaxSetting && high == kMaxSetting; }
    /// "from 1 to 8", "over 0 up to 1000000".
    std::string Text() const;
};

/// The declaration of an option of the command line or of a key of an entity.
struct SettingInfo {
    std::string_view name{};                   ///< with its dash, if it is an option
    std::array<std::string_view, 4> aliases{}; ///< unused entries are empty and last
    std::string_view values{};                 ///< names of the values: "N", "X Y Z", "W [H]" with H optional, "0|1"
    SettingKind kind = SettingKind::Flag;      ///< for options, follows from the field if it is a number or text
    std::string_view unit{};                   ///< "game units", "degrees"
    std::string_view initial{};                ///< the default in words; for options, empty: that of the field
    SettingRange range{};
    std::string_view limitReason{}; ///< why the range ends where it does, for the error, if it may surprise
    OutOfRange outside = OutOfRange::Refuse;
    double outsideValue = 0;     ///< for OutOfRange::UseDefault
    double floor = -kMaxSetting; ///< numbers in range but below this become this, with a warning
    bool withoutEffect = false;  ///< accepted for compatibility; not listed among the settings of a run
    bool firstOnly = false;      ///< repetitions are left for another table of settings
    std::string_view help{};     ///< one line, a sentence without its full stop
    std::string_view details{};  ///< more for the documentation page

    bool Names(std::string_view word) const;
    /// Least and greatest number of values that follow.
    std::size_t MinValues() const, MaxValues() const;
};

/// Everything printed about a setting.
struct SettingEntry {
    SettingInfo info;
    std::string initial; ///< the default as text; empty: none
    /// For shader directives: the stage that they have an effect on, "bsp", "light", "both" or "none".
    std::string_view stage{};
};

/// Settings under one heading of the help.
struct SettingSection {
    std::string_view title, intro;
    std::vector<SettingEntry> entries;
    std::string_view topic{}; ///< of -help, if the section is printed there and not with its stage
};

} // namespace q3
