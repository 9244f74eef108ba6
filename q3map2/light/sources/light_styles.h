// GPL-2.0-or-later. Styles of lights that play a pattern or that the game switches, and the waves of shaders for them.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/entities.h"

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// Letters of a pattern that play in a second.
inline constexpr double kPatternRate = 10;
/// Most letters of a pattern; a limit of this program.
inline constexpr std::size_t kMaxPattern = 256;

/// Brightness by letter of a pattern, from a, 0, to z, 25/12; m is 1. Capital letters count as small ones. Errors:
/// Error, for other characters, an empty pattern and one over kMaxPattern.
std::vector<double> BrightnessOf(std::string_view pattern);

/// What an rgbGen of a shader plays: base + amplitude * form(phase + frequency * time), which engines limit to 0..1.
struct StyleWave {
    enum Form {
        Constant, ///< base alone
        Sine,
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
    std::string ShaderText() const;
};

/// The periodic wave with the least mean squared difference from the repeated pattern. Noise of the same mean and
/// variance where even that leaves more than half of the variance.
StyleWave FitWave(std::string_view pattern);

/// Lights that were left out somewhere, for one warning.
class DroppedLightCounts {
  public:
    /// Counts `count` more places of a light.
    void Add(std::string_view light, std::int64_t count = 1);
    /// Warns if there are any, those left out most often first. light: the kind of light, such as "bounced light".
    /// places: such as "lightmaps", plural.
    void Warn(std::string_view light, std::string_view places, Log &log) const;

  private:
    std::vector<std::pair<std::string, std::int64_t>> counts_; ///< in the order of Add
};

/// Numbers for the styles of lights that need one: all lights with one pattern share a style, and under -switchable
/// those of one targetname.
class LightStyles {
  public:
    LightStyles() = default;
    /// Styles in `taken`, those of keys of lights, and those with an rgbGen or alphaGen in `world` are not given to
    /// others. Conflicts between keys are warnings. Errors: Error, for a bad pattern and if all 254 styles are taken.
    LightStyles(std::span<const Entity> lights, const Entity &world, bool switchable, std::set<int> taken, Log &log);

    /// Sets the key style of a light that has a pattern or can be switched.
    void Set(Entity &light) const;
    /// Replaces the keys of worldspawn that an earlier run wrote, IsStyleKey.
    void Record(Entity &world) const;

  private:
    struct Group {
        int style = 0;
        std::string pattern;
        bool isSwitch = false, startsDark = false;
    };
    /// What lights of a group have in common, case folded; empty: the light is in none.
    std::string NameOf(const Entity &light) const;
    bool IsSwitch(const Entity &light) const;
    bool StartsDark(const Entity &light) const;
    void Add(const Entity &light, Log &log);
    void Number(std::set<int> taken);
    void WarnOfConflicts(Log &log) const;

    bool switchable_ = false;
    std::map<std::string, Group> groups_; ///< by NameOf
    std::vector<std::string> order_;      ///< names by first light
};

} // namespace q3
