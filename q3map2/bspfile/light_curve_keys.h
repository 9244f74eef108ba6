// GPL-2.0-or-later. The keys of lights for other curves of falloff, for cones and for light_environment, most of them
// as in Source. A new key of that kind goes here.
#pragma once

#include "q3map2/bspfile/light_keys.h"

namespace q3::keys {

inline constexpr SettingRange kNotNegative{0, kMaxIntensity};

/// How a light falls off.
inline constexpr EntityKey kFalloffKeys[] = {
    {{.name = "_constant_attn",
      .values = "C",
      .kind = Number,
      .range = kNotNegative,
      .help = "With the next two: light falls off as 1 / (C + L d + Q d²)",
      .details = "The light at distance 100 is the intensity, in byte values. All three 0: C is 1."}},
    {{.name = "_linear_attn", .values = "L", .kind = Number, .range = kNotNegative, .help = "See _constant_attn"}},
    {{.name = "_quadratic_attn", .values = "Q", .kind = Number, .range = kNotNegative, .help = "See _constant_attn"}},
    {{.name = "_fifty_percent_distance",
      .values = "D",
      .kind = Number,
      .unit = "game units",
      .initial = "off",
      .range = {.low = 0},
      .help = "Distance at which the light is half the intensity, in byte values",
      .details = "Replaces the three keys above."}},
    {{.name = "_zero_percent_distance",
      .values = "D",
      .kind = Number,
      .unit = "game units",
      .initial = "2 × _fifty_percent_distance",
      .range = {.low = 0},
      .help = "Distance at which the curve of _fifty_percent_distance is nearly dark",
      .details = "Not quite: 12.7 % is left at twice that distance, without `_hardfalloff`. The same distance for both "
                 "is an error; a smaller one is not used."}},
    {{.name = "_hardfalloff",
      .values = "0|1",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "1: the light of _fifty_percent_distance fades to nothing at _zero_percent_distance"}},
    {{.name = "_radius",
      .values = "R",
      .kind = Number,
      .unit = "game units",
      .initial = "off",
      .range = {.low = 0},
      .help = "The light ends at this distance: inverse square times (1 − (d/R)⁴)²",
      .details = "Nearby it is as bright as without the key."}},
    {{.name = "delay",
      .values = "N",
      .kind = Integer,
      .initial = "off",
      .range = kAnyInteger,
      .help =
          "Curves of ericw-tools: 1 inverse, 2 inverse square, 3 no falloff, 5 inverse square without a bright core",
      .details = "Intensity I at distance d with W from `wait`: 128 I / (W d), 128² I / (W d)², I, 128² I / (W d + "
                 "128)², in byte values. 0 and 4 have no counterpart and are warnings."}},
    {{.name = "wait",
      .values = "W",
      .kind = Number,
      .help = "Factor on the distance under delay 1, 2 and 5; 0 or less means 1"},
     1}};
inline constexpr const EntityKey &kConstantAttn = kFalloffKeys[0], &kLinearAttn = kFalloffKeys[1],
                                 &kQuadraticAttn = kFalloffKeys[2], &kFiftyPercent = kFalloffKeys[3],
                                 &kZeroPercent = kFalloffKeys[4], &kHardFalloff = kFalloffKeys[5],
                                 &kEndRadius = kFalloffKeys[6], &kDelay = kFalloffKeys[7], &kWait = kFalloffKeys[8];

/// Cones by angles, of light_spot and of lights with one of the first three.
inline constexpr EntityKey kConeKeys[] = {
    {{.name = "_inner_cone",
      .values = "A",
      .kind = Number,
      .unit = "degrees",
      .range = {0, 180},
      .help = "Half angle of the full light",
      .details = "Both angles 180: a point light."},
     10},
    {{.name = "_cone",
      .values = "A",
      .kind = Number,
      .unit = "degrees",
      .initial = "_inner_cone",
      .range = {0, 180},
      .help = "Half angle at which the light ends, at least _inner_cone"}},
    {{.name = "_exponent",
      .values = "F",
      .kind = Number,
      .range = {.low = 0},
      .help = "Exponent of the fringe between the two angles; 0 means 1"},
     1},
    {{.name = "pitch",
      .values = "A",
      .kind = Number,
      .unit = "degrees",
      .initial = "angles",
      .help = "Replaces the pitch of angles unless it is 0; -90 is straight down"}},
    {{.name = "angles",
      .values = "PITCH YAW ROLL",
      .kind = Number,
      .unit = "degrees",
      .initial = "0 0 0",
      .help = "Where the light shines; a pitch of -90 is straight down. A target counts instead"}},
    {{.name = "angle",
      .values = "A",
      .kind = Number,
      .unit = "degrees",
      .initial = "angles",
      .help = "Replaces the yaw of angles unless it is 0; -1 is straight up, -2 straight down"}}};
inline constexpr const EntityKey &kInnerCone = kConeKeys[0], &kCone = kConeKeys[1], &kExponent = kConeKeys[2],
                                 &kPitch = kConeKeys[3], &kLightAngles = kConeKeys[4], &kLightAngle = kConeKeys[5];

/// The sun and the sky light of a map.
inline constexpr EntityKey kEnvironmentKeys[] = {
    {{.name = "_ambient",
      .values = "N [G] [B] [I]",
      .kind = Number,
      .range = {-kMaxIntensity, kMaxIntensity},
      .help = "Sky light, written as _light: what an open floor gets from the sky"}},
    {{.name = "SunSpreadAngle",
      .values = "A",
      .kind = Number,
      .unit = "degrees",
      .range = {0, 180},
      .help = "Angle that the sun's disc spans, for soft shadows",
      .details = "The sun is then 32 directions, or as many as `_samples` says."}}};
inline constexpr const EntityKey &kSkyAmbient = kEnvironmentKeys[0], &kSunSpread = kEnvironmentKeys[1];

/// Keys that Source reads for HDR light alone. One result serves all ranges here.
inline constexpr EntityKey kHdrLightKeys[] = {
    {{.name = "_lightHDR",
      .values = "R G B I",
      .kind = Number,
      .initial = "_light",
      .range = {-kMaxIntensity, kMaxIntensity},
      .help = "Not used; a warning if it differs from _light. Negative numbers mean the same as _light"}},
    {{.name = "_ambientHDR",
      .values = "R G B I",
      .kind = Number,
      .initial = "_ambient",
      .range = {-kMaxIntensity, kMaxIntensity},
      .help = "The same for _ambient"}},
    {{.name = "_lightscaleHDR", .values = "F", .kind = Number, .help = "Not used; a warning if it is not 1"}, 1},
    {{.name = "_AmbientScaleHDR", .values = "F", .kind = Number, .help = "Not used; a warning if it is not 1"}, 1}};
inline constexpr const EntityKey &kLightHdr = kHdrLightKeys[0], &kAmbientHdr = kHdrLightKeys[1],
                                 &kLightScaleHdr = kHdrLightKeys[2], &kAmbientScaleHdr = kHdrLightKeys[3];

} // namespace q3::keys
