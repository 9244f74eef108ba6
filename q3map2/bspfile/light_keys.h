// GPL-2.0-or-later. The keys of light entities, and those of the world that concern light. A new key goes here.
#pragma once

#include "q3map2/bspfile/entity_key.h"

namespace q3::keys {

using enum SettingKind;

/// Keeps products of intensity, color and the scales of options within float.
inline constexpr double kMaxIntensity = 1e9;
inline constexpr int kMaxLightSamples = 4096;     ///< of one entity; limit of this program, chosen
inline constexpr double kMaxFilterRadius = 65536; ///< game units; limit of this program, chosen
/// For whole numbers that are only compared or tested bit by bit; an int holds them.
inline constexpr SettingRange kAnyInteger{-1e9, 1e9};

/// The keys of entities whose class name starts with "light".
inline constexpr EntityKey kLightKeys[] = {
    {{.name = "origin",
      .values = "X Y Z",
      .kind = Number,
      .unit = "game units",
      .initial = "0 0 0",
      .help = "Position"}},
    {{.name = "_light",
      .aliases = {"light"},
      .values = "N [G] [B] [I]",
      .kind = Number,
      .range = {-kMaxIntensity, kMaxIntensity},
      .help = "Intensity, or color and brightness as in Source",
      .details =
          "One number: 0 means 300; a negative light darkens. Three or four, R G B I, are light in byte values at "
          "distance 100, for each channel 255 (c/255)^2.2 I/255, with I 255 if it is missing; the falloff is "
          "inverse square unless keys say otherwise."},
     300},
    {{.name = "scale", .values = "F", .kind = Number, .help = "Factor of the intensity"}, 1},
    {{.name = "_color",
      .values = "R G B",
      .kind = Number,
      .initial = "1 1 1",
      .range = {-kMaxIntensity, kMaxIntensity},
      .help = "Color; divided by its largest component, unless spawnflags has 32"}},
    {{.name = "fade", .values = "F", .kind = Number, .help = "Linear lights: loss of light per game unit"}, 1},
    {{.name = "_extradist",
      .values = "F",
      .kind = Number,
      .unit = "game units",
      .initial = "-extradist",
      .range = {.low = 0, .high = kMaxIntensity},
      .help = "Softens the light nearby: distance d becomes √(d² + F²)"}},
    {{.name = "_samples",
      .values = "N",
      .kind = Integer,
      .range = {1, kMaxLightSamples},
      .help = "Splits the light into N, for soft shadows"},
     1},
    {{.name = "_deviance",
      .aliases = {"_deviation", "_jitter"},
      .values = "F",
      .kind = Number,
      .range = {0, kMaxSetting},
      .help = "How far the lights of _samples are spread: game units, or degrees for a sun"}},
    {{.name = "_style",
      .aliases = {"style"},
      .values = "N",
      .kind = Integer,
      .range = {0, 254},
      .help = "Light style"}},
    {{.name = "target",
      .values = "NAME",
      .kind = Text,
      .help = "Makes a spotlight that aims at the entity of that targetname"}},
    {{.name = "radius",
      .values = "F",
      .kind = Number,
      .unit = "game units",
      .help = "Radius of the spotlight's cone at the target"},
     64},
    {{.name = "_sun",
      .values = "0|1",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "With a target: a sun that shines from here toward it; intensity 255 is full light"}},
    {{.name = "_anglescale",
      .values = "F",
      .kind = Number,
      .initial = "off",
      .help = "Softens light at an angle: its cosine is divided by F, up to 1"}},
    {{.name = "_filterradius",
      .aliases = {"_filteradius", "_filter"},
      .values = "F",
      .kind = Number,
      .unit = "game units",
      .range = {0, kMaxFilterRadius},
      .help = "Blurs the light in lightmaps"}},
    {{.name = "spawnflags",
      .values = "N",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "Sum of: 1 linear falloff, 2 light does not depend on the angle, 16 not for the grids, 32 color as it is",
      .details = "1 or 2: light on a surface does not depend on its angle. In the Wolfenstein family 1 is squared "
                 "falloff, and light does not depend on the angle without flags. Flags 4, 8 and 64 do nothing."}}};
inline constexpr const EntityKey &kOrigin = Key(kLightKeys, "origin");
inline constexpr const EntityKey &kLight = Key(kLightKeys, "_light");
inline constexpr const EntityKey &kScale = Key(kLightKeys, "scale");
inline constexpr const EntityKey &kColor = Key(kLightKeys, "_color");
inline constexpr const EntityKey &kFade = Key(kLightKeys, "fade");
inline constexpr const EntityKey &kExtraDist = Key(kLightKeys, "_extradist");
inline constexpr const EntityKey &kSamples = Key(kLightKeys, "_samples");
inline constexpr const EntityKey &kDeviance = Key(kLightKeys, "_deviance");
inline constexpr const EntityKey &kStyle = Key(kLightKeys, "_style");
inline constexpr const EntityKey &kTarget = Key(kLightKeys, "target");
inline constexpr const EntityKey &kRadius = Key(kLightKeys, "radius");
inline constexpr const EntityKey &kSun = Key(kLightKeys, "_sun");
inline constexpr const EntityKey &kAngleScale = Key(kLightKeys, "_anglescale");
inline constexpr const EntityKey &kFilterRadius = Key(kLightKeys, "_filterradius");
inline constexpr const EntityKey &kSpawnFlags = Key(kLightKeys, "spawnflags");

/// The keys of worldspawn that the light stage reads.
inline constexpr EntityKey kWorldLightKeys[] = {
    {{.name = "gridsize",
      .values = "X Y Z",
      .kind = Number,
      .unit = "game units",
      .initial = "64 64 128",
      .range = {8, kMaxSetting},
      .help = "Cell of the legacy light grid, whole numbers",
      .details = "Enlarged until the grid has at most 1048576 points, and then written back."}},
    {{.name = "_color",
      .values = "R G B",
      .kind = Number,
      .initial = "1 1 1",
      .help = "Color of _ambient and of the three keys for the least light"}},
    {{.name = "_ambient",
      .aliases = {"ambient"},
      .values = "F",
      .kind = Number,
      .unit = "byte values",
      .help = "Light everywhere",
      .details = "Surfaces take it from the `.srf` if there is one."}},
    {{.name = "_minlight", .values = "F", .kind = Number, .unit = "byte values", .help = "Least light of lightmaps"}},
    {{.name = "_mingridlight",
      .values = "F",
      .kind = Number,
      .unit = "byte values",
      .initial = "_minlight",
      .help = "Least light of grid points, in both grids"}},
    {{.name = "_minvertexlight",
      .values = "F",
      .kind = Number,
      .unit = "byte values",
      .initial = "_minlight",
      .help = "Least light of vertices"}},
    {{.name = "_maxlight",
      .values = "F",
      .kind = Number,
      .unit = "byte values",
      .range = {0, 255},
      .help = "Most light of lightmaps, vertices and the legacy grid"},
     255},
    {{.name = "_noshadersun",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "1: no suns of shaders; sky light stays"}},
    {{.name = "_floodlight",
      .values = "R G B [DISTANCE] [INTENSITY] [SCALE]",
      .kind = Number,
      .initial = "off",
      .help = "Adds soft light wherever there is open space, as -floodlight does, with these values",
      .details = "Distance (1024) in game units; intensity (128): 255 is full light; scale (1): factor on its "
                 "weight in deluxe pages."}},
    {{.name = "_keepLights",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "1: the light entities of the .bsp count, not those of the .map"}},
    {{.name = "_styleNrgbgen",
      .values = "WORDS",
      .kind = Text,
      .initial = "wave noise 0.5 1 0 5.37",
      .help = "How light of style N flickers, as in a shader"}},
    {{.name = "_styleNalphagen",
      .values = "WORDS",
      .kind = Text,
      .initial = "none",
      .help = "The same for its alpha"}}};
inline constexpr const EntityKey &kGridSize = Key(kWorldLightKeys, "gridsize");
inline constexpr const EntityKey &kWorldColor = Key(kWorldLightKeys, "_color");
inline constexpr const EntityKey &kAmbient = Key(kWorldLightKeys, "_ambient");
inline constexpr const EntityKey &kMinLight = Key(kWorldLightKeys, "_minlight");
inline constexpr const EntityKey &kMinGridLight = Key(kWorldLightKeys, "_mingridlight");
inline constexpr const EntityKey &kMinVertexLight = Key(kWorldLightKeys, "_minvertexlight");
inline constexpr const EntityKey &kMaxLight = Key(kWorldLightKeys, "_maxlight");
inline constexpr const EntityKey &kNoShaderSun = Key(kWorldLightKeys, "_noshadersun");
inline constexpr const EntityKey &kFloodlight = Key(kWorldLightKeys, "_floodlight");
inline constexpr const EntityKey &kKeepLights = Key(kWorldLightKeys, "_keepLights");

// ---- Keys of falloff, cones and light_environment, most of them as in Source ----

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
inline constexpr const EntityKey &kConstantAttn = Key(kFalloffKeys, "_constant_attn");
inline constexpr const EntityKey &kLinearAttn = Key(kFalloffKeys, "_linear_attn");
inline constexpr const EntityKey &kQuadraticAttn = Key(kFalloffKeys, "_quadratic_attn");
inline constexpr const EntityKey &kFiftyPercent = Key(kFalloffKeys, "_fifty_percent_distance");
inline constexpr const EntityKey &kZeroPercent = Key(kFalloffKeys, "_zero_percent_distance");
inline constexpr const EntityKey &kHardFalloff = Key(kFalloffKeys, "_hardfalloff");
inline constexpr const EntityKey &kEndRadius = Key(kFalloffKeys, "_radius");
inline constexpr const EntityKey &kDelay = Key(kFalloffKeys, "delay");
inline constexpr const EntityKey &kWait = Key(kFalloffKeys, "wait");

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
inline constexpr const EntityKey &kInnerCone = Key(kConeKeys, "_inner_cone");
inline constexpr const EntityKey &kCone = Key(kConeKeys, "_cone");
inline constexpr const EntityKey &kExponent = Key(kConeKeys, "_exponent");
inline constexpr const EntityKey &kPitch = Key(kConeKeys, "pitch");
inline constexpr const EntityKey &kLightAngles = Key(kConeKeys, "angles");
inline constexpr const EntityKey &kLightAngle = Key(kConeKeys, "angle");

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
inline constexpr const EntityKey &kSkyAmbient = Key(kEnvironmentKeys, "_ambient");
inline constexpr const EntityKey &kSunSpread = Key(kEnvironmentKeys, "SunSpreadAngle");

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
inline constexpr const EntityKey &kLightHdr = Key(kHdrLightKeys, "_lightHDR");
inline constexpr const EntityKey &kAmbientHdr = Key(kHdrLightKeys, "_ambientHDR");
inline constexpr const EntityKey &kLightScaleHdr = Key(kHdrLightKeys, "_lightscaleHDR");
inline constexpr const EntityKey &kAmbientScaleHdr = Key(kHdrLightKeys, "_AmbientScaleHDR");

/// The keys of light entities for styles, beside kStyle.
inline constexpr EntityKey kStyleLightKeys[] = {
    {{.name = "pattern",
      .values = "LETTERS",
      .kind = SettingKind::Text,
      .help = "Brightness over time, ten letters a second: a is dark, m is 1, z is 2",
      .details = "Lights of one pattern share a style that nothing else uses, unless `style` says which."}},
    {{.name = "targetname",
      .values = "NAME",
      .kind = SettingKind::Text,
      .help = "Under -switchable: lights of one name share a style, which the game can switch",
      .details = "[from_source.md](from_source.md#switchable-and-animated-lights) tells how."}}};
inline constexpr const EntityKey &kPattern = Key(kStyleLightKeys, "pattern");
inline constexpr const EntityKey &kSwitchName = Key(kStyleLightKeys, "targetname");

/// The same of worldspawn.
inline constexpr EntityKey kStyleWorldKeys[] = {{{.name = "_switchable",
                                                  .values = "0|1",
                                                  .kind = SettingKind::Flag,
                                                  .initial = "0",
                                                  .help = "1: lights with a targetname can be switched, as under "
                                                          "-switchable"}}};
inline constexpr const EntityKey &kSwitchable = Key(kStyleWorldKeys, "_switchable");

/// The macro texture of the world.
inline constexpr EntityKey kMacroKeys[] = {
    {{.name = "_macrotexture",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Image over the whole world, seen from above, that tints lightmaps and vertex light",
      .details = "[from_source.md](from_source.md#macro-textures) tells how. The option `-macrotexture` wins."}},
    {{.name = "world_mins",
      .values = "X Y Z",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "bounds of the world",
      .help = "Where the left and the lower edge of that image are"}},
    {{.name = "world_maxs",
      .values = "X Y Z",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "bounds of the world",
      .help = "Where its right and its upper edge are"}}};
inline constexpr const EntityKey &kMacroTexture = Key(kMacroKeys, "_macrotexture");
inline constexpr const EntityKey &kWorldMins = Key(kMacroKeys, "world_mins");
inline constexpr const EntityKey &kWorldMaxs = Key(kMacroKeys, "world_maxs");

} // namespace q3::keys
