// GPL-2.0-or-later. Patterns of light styles, and the waves of shaders that come near them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Letters of a pattern that play in a second.
inline constexpr double kPatternRate = 10;
/// Most letters of a pattern.
inline constexpr std::size_t kMaxPattern = 256;

/// Brightness by letter of a pattern, from a, 0, to z, 25/12; m is 1. Capital letters count as small ones. Errors:
/// Error, for other characters, an empty pattern and one over kMaxPattern.
std::vector<double> BrightnessOf(std::string_view pattern);

/// What an rgbGen of a shader plays: base + amplitude * form(phase + frequency * time), which engines limit to 0..1.
struct StyleWave {
    enum Form {
        Constant, ///< base alone
        Sin,
        Square,   ///< 1 for half of the period, then -1
        Triangle, ///< 0, 1, 0, -1
        Sawtooth, ///< rises from 0 to 1
        InverseSawtooth,
        Noise ///< random, -1 to 1
    };
    Form form = Constant;
    double base = 0, amplitude = 0;
    double phase = 0;     ///< periods, 0 to 1
    double frequency = 0; ///< periods a second; noise: its speed

    /// Brightness at a time in seconds; noise: its mean.
    double At(double time) const;
    /// As an rgbGen has it: "wave sin 1 0.5 0 1", "const ( 1 1 1 )".
    std::string Words() const;
};

/// The periodic wave with the least mean squared difference from the repeated pattern. Noise of the same mean and
/// variance where even that leaves more than half of the variance.
StyleWave FitWave(std::string_view pattern);

} // namespace q3
