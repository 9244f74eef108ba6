// GPL-2.0-or-later. Patterns of light styles, and the waves of shaders that come near them.
#include "q3map2/light/sources/style_wave.h"

#include "common/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Phases that are tried for each letter of the pattern; whole letters are among them.
constexpr std::size_t kPhasesPerLetter = 4;
/// Most periods of a wave in a pattern that are tried.
constexpr std::size_t kMostPeriods = 32;
/// Share of the variance that a wave must save to be taken before a simpler or slower one.
constexpr double kLeastGain = 1e-6;
/// Share of the variance that a periodic wave may leave before noise is taken.
constexpr double kNoiseShare = 0.5;
/// Root mean square of engines' noise: random numbers from -1 to 1, blended linearly.
constexpr double kNoiseDeviation = 0.4714;
constexpr double kWhole = 12; // steps from a to m

constexpr std::array kPeriodic = {StyleWave::Sin, StyleWave::Square, StyleWave::Triangle, StyleWave::Sawtooth,
                                  StyleWave::InverseSawtooth};

/// A form at x periods, 0 to 1.
double FormAt(StyleWave::Form form, double x) {
    switch (form) {
    case StyleWave::Sin:
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
    case StyleWave::Sin:
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

/// The same for any x of at least 0.
double IntegralTo(StyleWave::Form form, double periods, double mean) {
    const double whole = std::floor(periods);
    return whole * mean + IntegralTo(form, periods - whole);
}

/// Mean and variance of a form over a period.
double MeanOf(StyleWave::Form form) {
    return form == StyleWave::Sawtooth || form == StyleWave::InverseSawtooth ? 0.5 : 0;
}
double VarianceOf(StyleWave::Form form) {
    return form == StyleWave::Sin        ? 1.0 / 2
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

/// A wave and the variance that it takes off.
struct WaveFit {
    StyleWave wave;
    double saved = 0;
};

/// Base and amplitude by linear regression of the brightness of letters on the form, over whole periods.
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
        brightness.push_back((letter - 'a') / kWhole);
    }
    return brightness;
}

double StyleWave::At(double time) const {
    const double x = phase + frequency * time;
    return base + amplitude * FormAt(form, x - std::floor(x));
}

std::string StyleWave::Words() const {
    constexpr std::array<std::string_view, 7> kNames = {
        "", "sin", "square", "triangle", "sawtooth", "inversesawtooth", "noise"};
    const auto tidy = [](double value) { return std::abs(value) < 5e-5 ? 0 : value; };
    if (form == Constant) // engines do not limit it
        return fmt::format("const ( {0:.4g} {0:.4g} {0:.4g} )", tidy(std::clamp(base, 0.0, 1.0)));
    return fmt::format("wave {} {:.4g} {:.4g} {:.4g} {:.6g}", kNames[form], tidy(base), tidy(amplitude), tidy(phase),
                       frequency);
}

StyleWave FitWave(std::string_view pattern) {
    const std::vector<double> letters = BrightnessOf(pattern);
    const double mean = MeanOf(letters), all = VarianceOf(letters, mean);
    WaveFit best{.wave = {.form = StyleWave::Constant, .base = mean}};
    if (!(all > 0))
        return best.wave;
    const std::size_t phases = kPhasesPerLetter * letters.size();
    for (std::size_t periods = 1; periods <= std::clamp<std::size_t>(letters.size() / 2, 1, kMostPeriods); ++periods)
        for (const StyleWave::Form form : kPeriodic)
            for (std::size_t i = 0; i < phases; ++i) {
                const double perLetter = double(periods) / double(letters.size());
                const StyleWave wave{
                    .form = form, .phase = double(i) / double(phases), .frequency = perLetter * kPatternRate};
                const WaveFit fit = Regress(wave, perLetter, letters, mean);
                if (fit.saved > best.saved + kLeastGain * all && fit.wave.amplitude > 0)
                    best = fit;
            }
    if (best.saved < (1 - kNoiseShare) * all)
        return {.form = StyleWave::Noise,
                .base = mean,
                .amplitude = std::sqrt(all) / kNoiseDeviation,
                .frequency = kPatternRate};
    return best.wave;
}

} // namespace q3
