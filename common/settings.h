// GPL-2.0-or-later. Settings declared once: parsing, ranges, help and documentation come from one table.
#pragma once

#include "common/arguments.h"
#include "common/log.h"

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
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

/// The numbers that a setting may have.
struct SettingRange {
    double low = -kMaxSetting, high = kMaxSetting;
    bool aboveLow = false, belowHigh = false; ///< the limit itself is not allowed

    bool Contains(double number) const {
        return (aboveLow ? number > low : number >= low) && (belowHigh ? number < high : number <= high);
    }
    /// The nearest number of the range, whose limits count as allowed.
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
    SettingKind kind = SettingKind::Flag;      ///< may be left out for options whose field is a number or text
    std::string_view unit{};                   ///< "game units", "degrees"
    std::string_view initial{};                ///< the default in words; empty for options: the value of the field
    SettingRange range{};
    std::string_view limitReason{}; ///< why the range ends where it does, for the error, if it may surprise
    OutOfRange outside = OutOfRange::Refuse;
    double outsideValue = 0;     ///< for OutOfRange::UseDefault
    double floor = -kMaxSetting; ///< numbers in range but below this become this, with a warning
    bool withoutEffect = false;  ///< accepted for compatibility; not listed among the settings of a run
    bool firstOnly = false;      ///< only the first occurrence is taken; another table takes the others
    std::string_view help{};     ///< one line, a sentence without its full stop
    std::string_view details{};  ///< more for the documentation page
    std::string_view since{};    ///< who introduced it: a version of this program, "q3map2" (NetRadiant's), "VRAD" ...
    std::string_view example{};  ///< values for an example in the documentation; needed where there are values

    /// Whether the word is the name or an alias, whatever its case.
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

/// The values of one occurrence of an option, checked.
struct SettingValues {
    std::vector<std::string> words;
    std::vector<double> numbers; ///< of the kinds Integer and Number
};

// A value as the documentation and logs show it: "on" and "off", numbers of 7 digits, words with blanks between them;
// empty: none.
std::string SettingText(bool value);
std::string SettingText(double value);
std::string SettingText(int value);
std::string SettingText(const std::string &value);
std::string SettingText(const std::vector<std::string> &values);
template <typename T> std::string SettingText(const std::optional<T> &value) {
    return value ? SettingText(*value) : std::string();
}

/// Where the values of an option go: a field of `Options`, or a function.
template <typename Options> class SettingTarget {
  public:
    /// A field: a pointer to a member, or a generic function from Options & to a reference.
    template <typename Field> SettingTarget(Field field) {
        using T = std::remove_cvref_t<std::invoke_result_t<Field, Options &>>;
        apply = [field](Options &o, const SettingValues &values) { Assign(std::invoke(field, o), values); };
        text = [field](const Options &o) { return SettingText(std::invoke(field, o)); };
        kind = KindOf(static_cast<const T *>(nullptr));
    }

    std::function<void(Options &, const SettingValues &)> apply;
    std::function<std::string(const Options &)> text; ///< formats the field's current value; null for Off and Do
    SettingKind kind = SettingKind::Flag;             ///< by the type of the field

    /// For Off and Do.
    SettingTarget() = default;

  private:
    static SettingKind KindOf(const bool *) { return SettingKind::Flag; }
    static SettingKind KindOf(const int *) { return SettingKind::Integer; }
    static SettingKind KindOf(const float *) { return SettingKind::Number; }
    static SettingKind KindOf(const double *) { return SettingKind::Number; }
    static SettingKind KindOf(const std::string *) { return SettingKind::Text; }
    static SettingKind KindOf(const std::vector<std::string> *) { return SettingKind::Text; }
    template <typename T> static SettingKind KindOf(const std::optional<T> *) {
        return KindOf(static_cast<const T *>(nullptr));
    }

    static void Assign(bool &field, const SettingValues &) { field = true; }
    static void Assign(int &field, const SettingValues &values) { field = int(values.numbers.front()); }
    static void Assign(float &field, const SettingValues &values) { field = float(values.numbers.front()); }
    static void Assign(double &field, const SettingValues &values) { field = values.numbers.front(); }
    static void Assign(std::string &field, const SettingValues &values) { field = values.words.front(); }
    static void Assign(std::vector<std::string> &field, const SettingValues &values) {
        field.push_back(values.words.front());
    }
    template <typename T> static void Assign(std::optional<T> &field, const SettingValues &values) {
        Assign(field.emplace(), values);
    }
};

/// One option of a stage. The field's value in default options is its documented default.
template <typename Options> struct Setting {
    SettingInfo info;
    SettingTarget<Options> target;

    SettingKind Kind() const { return info.kind != SettingKind::Flag ? info.kind : target.kind; }
};

/// Settings of a stage under one heading.
template <typename Options> struct SettingGroup {
    std::string_view title, intro;
    std::vector<Setting<Options>> settings;
};

/// A flag that turns a field off.
template <typename Options> SettingTarget<Options> Off(bool Options::*field) {
    SettingTarget<Options> target;
    target.apply = [field](Options &o, const SettingValues &) { o.*field = false; };
    return target;
}

/// A target that calls `apply`. The kind and the default, if any, must be given in SettingInfo.
template <typename Options> SettingTarget<Options> Do(std::function<void(Options &, const SettingValues &)> apply) {
    SettingTarget<Options> target;
    target.apply = std::move(apply);
    return target;
}

/// An option of other compilers that has no effect here: its name and help are added to `given`, for
/// WarnWithoutEffect.
template <typename Options>
Setting<Options> WithoutEffect(std::vector<std::string> Options::*given, std::string_view name, std::string_view help,
                               std::string_view alias = {}) {
    const auto note = [given, name, help](Options &o, const SettingValues &) {
        (o.*given).push_back(fmt::format("{} ({})", name, help));
    };
    return {{.name = name, .aliases = {alias}, .withoutEffect = true, .help = help, .since = "q3map2"},
            Do<Options>(note)};
}
/// One warning that names these options; none if there are none.
void WarnWithoutEffect(const std::vector<std::string> &given, Log &log);

/// Takes one occurrence, the word at `at` and its values, off `arguments`. Errors: Error, for missing values, text that
/// is no number, and numbers out of range that the setting refuses.
SettingValues TakeOccurrence(const SettingInfo &info, SettingKind kind, Arguments &arguments, std::size_t at, Log &log);

/// Takes all settings of the table off `arguments`, which notes those whose value changes. Different settings act in
/// the order of the table, repeated ones in the order of the command line. Errors: those of TakeOccurrence.
template <typename Options>
void TakeSettings(const std::vector<SettingGroup<Options>> &table, Options &options, Arguments &arguments, Log &log) {
    std::vector<const Setting<Options> *> settings;
    for (const SettingGroup<Options> &group : table)
        for (const Setting<Options> &setting : group.settings)
            settings.push_back(&setting);
    std::vector<std::vector<SettingValues>> found(settings.size());
    for (std::size_t at = 0; at < arguments.Rest().size();) {
        const auto takesWord = [&](std::size_t i) {
            const SettingInfo &info = settings[i]->info;
            const bool isTakenAlready = info.firstOnly && !found[i].empty();
            return info.Names(arguments.Rest()[at]) && !isTakenAlready;
        };
        std::size_t which = 0;
        while (which < settings.size() && !takesWord(which))
            ++which;
        if (which == settings.size())
            ++at;
        else
            found[which].push_back(TakeOccurrence(settings[which]->info, settings[which]->Kind(), arguments, at, log));
    }
    for (std::size_t i = 0; i < settings.size(); ++i) {
        const auto &target = settings[i]->target;
        const std::string before = target.text ? target.text(options) : std::string();
        for (const SettingValues &values : found[i])
            target.apply(options, values);
        if (!found[i].empty() && !settings[i]->info.withoutEffect && (!target.text || target.text(options) != before))
            arguments.NoteChange(settings[i]->info.name, found[i].back().words,
                                 settings[i]->info.initial.empty() ? before : std::string(settings[i]->info.initial));
    }
}

/// What is printed about the settings of a table.
template <typename Options>
std::vector<SettingSection> Describe(const std::vector<SettingGroup<Options>> &table, const Options &initial = {}) {
    std::vector<SettingSection> sections;
    for (const SettingGroup<Options> &group : table) {
        SettingSection &section = sections.emplace_back(SettingSection{group.title, group.intro, {}});
        for (const Setting<Options> &setting : group.settings) {
            SettingEntry entry{setting.info, std::string(setting.info.initial)};
            entry.info.kind = setting.Kind();
            if (entry.initial.empty() && setting.target.text)
                entry.initial = setting.target.text(initial);
            section.entries.push_back(std::move(entry));
        }
    }
    return sections;
}

/// Names every word that is left over, in one warning each. After all tables have taken theirs.
void WarnOfUnknown(const Arguments &arguments, Log &log);

} // namespace q3
