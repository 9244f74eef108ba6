// GPL-2.0-or-later. Styles of lights that play a pattern or that the game switches, and the waves of shaders for them.
#include "q3map2/light/sources/light_styles.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/light/sources/falloff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <utility>

namespace q3 {

// ---- Patterns, and the waves of shaders that come near them ----

namespace {

/// Phases that are tried for each letter of the pattern; whole letters are among them.
constexpr std::size_t kPhasesPerLetter = 4;
/// Most periods of a wave in a pattern that are tried.
constexpr std::size_t kMostPeriods = 32;
/// Fraction of the variance that a wave must save to be taken before a simpler or slower one.
constexpr double kLeastGain = 1e-6;
/// Fraction of the variance that a periodic wave may leave before noise is taken.
constexpr double kNoiseFraction = 0.5;
/// Root mean square of engines' noise: random numbers from -1 to 1, of variance 1/3, blended linearly, which reduces it
/// by the mean of (1 - t)^2 + t^2, 2/3: sqrt(2) / 3.
constexpr double kNoiseDeviation = 0.4714;
/// Letters from a, black, to m, full brightness.
constexpr double kStepsToFullLight = 12;
/// Numbers of a wave below this are written as 0: they are rounding.
constexpr double kTidyZero = 5e-5;

constexpr std::array kPeriodic = {StyleWave::Sine, StyleWave::Square, StyleWave::Triangle, StyleWave::Sawtooth,
                                  StyleWave::InverseSawtooth};

/// A form at x periods, 0 to 1.
double FormAt(StyleWave::Form form, double x) {
    switch (form) {
    case StyleWave::Sine:
        return std::sin(2 * std::numbers::pi * x);
    case StyleWave::Square:
        return x < 0.5 ? 1 : -1;
    case StyleWave::Triangle:
        return x < 0.25 ? 4 * x : x < 0.75 ? 2 - 4 * x : 4 * x - 4;
    case StyleWave::Sawtooth:
        return x;
    case StyleWave::InverseSawtooth:
        return 1 - x;
    default:
        return 0;
    }
}

/// The integral of a form from 0 to x periods, 0 to 1.
double IntegralTo(StyleWave::Form form, double x) {
    switch (form) {
    case StyleWave::Sine:
        return (1 - std::cos(2 * std::numbers::pi * x)) / (2 * std::numbers::pi);
    case StyleWave::Square:
        return x < 0.5 ? x : 1 - x;
    case StyleWave::Triangle:
        return x < 0.25 ? 2 * x * x : x < 0.75 ? 2 * x * (1 - x) - 0.25 : 2 * (1 - x) * (1 - x);
    case StyleWave::Sawtooth:
        return x * x / 2;
    case StyleWave::InverseSawtooth:
        return x - x * x / 2;
    default:
        return 0;
    }
}

/// The same for any number of periods of at least 0. mean: of the form over a period.
double IntegralTo(StyleWave::Form form, double periods, double mean) {
    const double whole = std::floor(periods);
    return whole * mean + IntegralTo(form, periods - whole);
}

/// Mean and variance of a form over a period.
double MeanOf(StyleWave::Form form) {
    return form == StyleWave::Sawtooth || form == StyleWave::InverseSawtooth ? 0.5 : 0;
}
double VarianceOf(StyleWave::Form form) {
    return form == StyleWave::Sine       ? 1.0 / 2
           : form == StyleWave::Square   ? 1.0
           : form == StyleWave::Triangle ? 1.0 / 3
                                         : 1.0 / 12;
}

double MeanOf(const std::vector<double> &values) {
    double sum = 0;
    for (const double value : values)
        sum += value;
    return sum / double(values.size());
}

double VarianceOf(const std::vector<double> &values, double mean) {
    double sum = 0;
    for (const double value : values)
        sum += (value - mean) * (value - mean);
    return sum / double(values.size());
}

/// A wave and by how much it reduces the variance of the letters.
struct WaveFit {
    StyleWave wave;
    double saved = 0;
};

/// Base and amplitude by linear regression of the brightness of letters on the form, over whole periods: amplitude =
/// covariance / variance of the form, saved = covariance^2 / variance of the form.
WaveFit Regress(StyleWave wave, double periodsPerLetter, const std::vector<double> &letters, double mean) {
    const double formMean = MeanOf(wave.form);
    double covariance = 0, before = IntegralTo(wave.form, wave.phase, formMean);
    for (std::size_t i = 0; i < letters.size(); ++i) {
        const double after = IntegralTo(wave.form, wave.phase + periodsPerLetter * double(i + 1), formMean);
        covariance += (letters[i] - mean) * (after - before);
        before = after;
    }
    covariance /= periodsPerLetter * double(letters.size());
    wave.amplitude = covariance / VarianceOf(wave.form);
    wave.base = mean - wave.amplitude * formMean;
    return {wave, covariance * covariance / VarianceOf(wave.form)};
}

} // namespace

std::vector<double> BrightnessOf(std::string_view pattern) {
    if (pattern.empty() || pattern.size() > kMaxPattern)
        throw Error("pattern \"{}\": expected 1 to {} letters", pattern, kMaxPattern);
    std::vector<double> brightness;
    for (const char c : pattern) {
        const char letter = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
        if (letter < 'a' || letter > 'z')
            throw Error("pattern \"{}\": expected letters from a to z", pattern);
        brightness.push_back((letter - 'a') / kStepsToFullLight);
    }
    return brightness;
}

double StyleWave::At(double time) const {
    const double x = phase + frequency * time;
    return base + amplitude * FormAt(form, x - std::floor(x));
}

std::string StyleWave::ShaderText() const {
    constexpr std::array<std::string_view, 7> kNames = {
        "", "sin", "square", "triangle", "sawtooth", "inversesawtooth", "noise"};
    const auto tidy = [](double value) { return std::abs(value) < kTidyZero ? 0 : value; };
    if (form == Constant) // engines do not limit it
        return fmt::format("const ( {0:.4g} {0:.4g} {0:.4g} )", tidy(std::clamp(base, 0.0, 1.0)));
    return fmt::format("wave {} {:.4g} {:.4g} {:.4g} {:.6g}", kNames[form], tidy(base), tidy(amplitude), tidy(phase),
                       frequency);
}

StyleWave FitWave(std::string_view pattern) {
    const std::vector<double> letters = BrightnessOf(pattern);
    const double mean = MeanOf(letters), variance = VarianceOf(letters, mean);
    WaveFit best{.wave = {.form = StyleWave::Constant, .base = mean}};
    if (!(variance > 0))
        return best.wave;
    const std::size_t phases = kPhasesPerLetter * letters.size();
    for (std::size_t periods = 1; periods <= std::clamp<std::size_t>(letters.size() / 2, 1, kMostPeriods); ++periods)
        for (const StyleWave::Form form : kPeriodic)
            for (std::size_t i = 0; i < phases; ++i) {
                const double perLetter = double(periods) / double(letters.size());
                const StyleWave wave{
                    .form = form, .phase = double(i) / double(phases), .frequency = perLetter * kPatternRate};
                const WaveFit fit = Regress(wave, perLetter, letters, mean);
                if (fit.saved > best.saved + kLeastGain * variance && fit.wave.amplitude > 0)
                    best = fit;
            }
    if (best.saved < (1 - kNoiseFraction) * variance)
        return {.form = StyleWave::Noise,
                .base = mean,
                .amplitude = std::sqrt(variance) / kNoiseDeviation,
                .frequency = kPatternRate};
    return best.wave;
}

// ---- Lights that were left out ----

void DroppedLightCounts::Add(std::string_view light, std::int64_t count) {
    const auto found = std::ranges::find(counts_, light, &std::pair<std::string, std::int64_t>::first);
    if (found != counts_.end())
        found->second += count;
    else
        counts_.emplace_back(light, count);
}

void DroppedLightCounts::Warn(std::string_view light, std::string_view places, Log &log) const {
    constexpr std::size_t kNamedLights = 12;
    if (counts_.empty())
        return;
    auto counts = counts_;
    std::ranges::stable_sort(counts, std::greater(), &std::pair<std::string, std::int64_t>::second);
    std::string names;
    for (std::size_t i = 0; i < std::min(counts.size(), kNamedLights); ++i)
        names += fmt::format("{}{} ({}: {})", i > 0 ? ", " : "", counts[i].first, places, counts[i].second);
    if (counts.size() > kNamedLights)
        names += fmt::format(" and {} more", counts.size() - kNamedLights);
    log.Warn(fmt::format("{} left out of {}", light, places), "{} left out where {} other styles come first: {}", light,
             kStyles - 1, names);
}

// ---- Numbers of styles ----

namespace {

/// Styles are numbers below this. 255 means no style in the records of surfaces.
constexpr int kEndOfStyles = 255;
/// Styles from the first to before the second.
using StyleRange = std::pair<int, int>;
/// Engines of Quake's family have fixed patterns for styles up to 11 and switch those from 32 to 62.
constexpr StyleRange kKnown{1, 12}, kBetween{12, 32}, kSwitches{32, 63}, kFree{63, kEndOfStyles};

/// The first style in the ranges that is not taken.
int FreeStyle(std::initializer_list<StyleRange> ranges, const std::set<int> &taken) {
    for (const auto &[first, end] : ranges)
        for (int style = first; style < end; ++style)
            if (!taken.contains(style))
                return style;
    throw Error("all {} light styles are taken; patterns and switchable lights need more", kEndOfStyles - 1);
}

/// Name of the group of a pattern; no targetname begins like this.
std::string PatternGroup(std::string_view pattern) {
    return "\n" + LowerCase(pattern);
}

} // namespace

LightStyles::LightStyles(std::span<const Entity> lights, const Entity &world, bool switchable, std::set<int> taken,
                         Log &log)
    : switchable_(switchable) {
    for (const auto &[key, value] : world.pairs)
        for (const std::string_view end : {"rgbgen", "alphagen"})
            taken.insert(StyleOfKey(key, "_style", end));
    for (const Entity &light : lights) {
        taken.insert(keys::kStyle.Integer(light));
        Add(light, log);
    }
    Number(std::move(taken));
    WarnOfConflicts(log);
}

bool LightStyles::IsSwitch(const Entity &light) const {
    return switchable_ && keys::kSwitchName.Given(light);
}

std::string LightStyles::NameOf(const Entity &light) const {
    if (IsSwitch(light))
        return std::string(keys::kSwitchName.Text(light));
    return keys::kPattern.Given(light) ? PatternGroup(keys::kPattern.Text(light)) : std::string();
}

bool LightStyles::StartsDark(const Entity &light) const {
    constexpr int kInitiallyDark = 1; // of Source's lights
    return IsSwitch(light) && CountsInBytes(light) && (keys::kSpawnFlags.Integer(light) & kInitiallyDark) != 0;
}

void LightStyles::Add(const Entity &light, Log &log) {
    const std::string name = NameOf(light), pattern = LowerCase(keys::kPattern.Text(light));
    if (name.empty())
        return;
    try {
        if (!pattern.empty())
            BrightnessOf(pattern);
    } catch (const Error &error) {
        throw Error("{}: {}", LightLabel(light), error.what());
    }
    const bool first = !groups_.contains(name);
    Group &group = groups_[name];
    if (first) {
        order_.push_back(name);
        group = {.pattern = pattern, .isSwitch = IsSwitch(light), .startsDark = StartsDark(light)};
    } else if (group.pattern != pattern || group.startsDark != StartsDark(light))
        log.Warn("lights of one targetname", "{}: other lights of targetname \"{}\" have another {}; the first counts",
                 LightLabel(light), name, group.pattern != pattern ? "pattern" : "spawnflag for dark at first");
    const int style = keys::kStyle.Integer(light);
    if (group.style != 0 && style != 0 && group.style != style)
        log.Warn("style of a group of lights", "{}: style {} is not used, lights of the same {} have style {}",
                 LightLabel(light), style, group.isSwitch ? "targetname" : "pattern", group.style);
    else if (group.style == 0)
        group.style = style;
}

void LightStyles::Number(std::set<int> taken) {
    for (const std::string &name : order_) {
        Group &group = groups_[name];
        if (group.style == 0)
            group.style = group.isSwitch ? FreeStyle({kSwitches, kFree, kBetween, kKnown}, taken)
                                         : FreeStyle({kBetween, kFree, kKnown, kSwitches}, taken);
        taken.insert(group.style);
    }
}

void LightStyles::WarnOfConflicts(Log &log) const {
    std::map<int, const Group *> byStyle;
    for (const std::string &name : order_) {
        const Group &group = groups_.at(name);
        const Group &first = *byStyle.try_emplace(group.style, &group).first->second;
        if (first.pattern != group.pattern)
            log.Warn("patterns of one style", "style {} has the patterns \"{}\" and \"{}\"; the first counts",
                     group.style, first.pattern, group.pattern);
    }
}

void LightStyles::Set(Entity &light) const {
    const std::string name = NameOf(light);
    const auto group = name.empty() ? groups_.end() : groups_.find(name);
    if (group == groups_.end())
        return;
    light.Erase("_style");
    light.Set("style", fmt::format("{}", group->second.style));
}

void LightStyles::Record(Entity &world) const {
    std::erase_if(world.pairs, [](const auto &pair) { return IsStyleKey(pair.first); });
    for (const std::string &name : order_) {
        const Group &group = groups_.at(name);
        if (!group.pattern.empty() && !world.Has(PatternKey(group.style)))
            world.Set(PatternKey(group.style), group.pattern);
        if (!group.isSwitch)
            continue;
        const std::string key = SwitchKey(group.style), before(world.Value(key));
        world.Set(key, before.empty() ? name : before + " " + name);
        if (group.startsDark)
            world.Set(DarkKey(group.style), "1");
    }
}

} // namespace q3
