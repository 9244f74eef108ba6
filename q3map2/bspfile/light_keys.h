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
      .help = "Sets the position of the light",
      .since = "q3map2",
      .example = "128 -64 96"}},
    {{.name = "_light",
      .aliases = {"light"},
      .values = "N [G] [B] [I]",
      .kind = Number,
      .range = {-kMaxIntensity, kMaxIntensity},
      .help = "Sets the intensity of the light, or its color and brightness as in Source",
      .details = "One number is an intensity, where 0 means 300 and a negative number darkens. Three or four numbers R "
                 "G B I are a color and a brightness in 8-bit levels, where a missing I is 255. Each channel c then "
                 "gives I (c/255)^2.2 at distance 100, and `_color` has no effect. The falloff is inverse square "
                 "unless other keys say otherwise.",
      .since = "q3map2",
      .example = "500"},
     300},
    {{.name = "scale",
      .values = "F",
      .kind = Number,
      .help = "Multiplies the intensity of the light",
      .details = "A factor of 0 counts as 1.",
      .since = "q3map2",
      .example = "2"},
     1},
    {{.name = "_color",
      .values = "R G B",
      .kind = Number,
      .initial = "1 1 1",
      .range = {-kMaxIntensity, kMaxIntensity},
      .help = "Sets the color of the light, which is divided by its largest component unless spawnflags has 32",
      .since = "q3map2",
      .example = "1 0.85 0.6"}},
    {{.name = "fade",
      .values = "F",
      .kind = Number,
      .help = "Sets how much light a linear light loses per game unit",
      .details = "A linear light of intensity I gives 0.9375 I − d `fade` at distance d. A value of 0 counts as 1. "
                 "Lights with another falloff ignore this key.",
      .since = "q3map2",
      .example = "0.5"},
     1},
    {{.name = "_extradist",
      .values = "F",
      .kind = Number,
      .unit = "game units",
      .initial = "-extradist",
      .range = {.low = 0, .high = kMaxIntensity},
      .help = "Softens the light nearby: a distance d counts as √(d² + F²)",
      .since = "q3map2",
      .example = "32"}},
    {{.name = "_samples",
      .values = "N",
      .kind = Integer,
      .range = {1, kMaxLightSamples},
      .help = "Splits the light into N lights, for soft shadows",
      .details =
          "Each of them has the intensity divided by N. The key `_deviance` sets how far apart they are. For a "
          "light_environment, N is the number of directions over the disc of the sun, which is 32 without this key.",
      .since = "q3map2",
      .example = "16"},
     1},
    {{.name = "_deviance",
      .aliases = {"_deviation", "_jitter"},
      .values = "F",
      .kind = Number,
      .unit = "game units, or degrees for a sun",
      .range = {0, kMaxSetting},
      .help = "Sets how far the lights of _samples are spread",
      .details =
          "The first of them stays at the origin. The others are moved by at most this distance along each axis.",
      .since = "q3map2",
      .example = "12"}},
    {{.name = "_style",
      .aliases = {"style"},
      .values = "N",
      .kind = Integer,
      .range = {0, 254},
      .help = "Puts the light into a light style, whose brightness the game changes",
      .details = "Style 0 is constant light. A surface holds style 0 and up to three others.",
      .since = "q3map2",
      .example = "3"}},
    {{.name = "target",
      .values = "NAME",
      .kind = Text,
      .initial = "none",
      .help = "Makes a spotlight that aims at the entity of that targetname",
      .details =
          "With `_sun` it makes a sun instead. A name that no entity has is a warning, and the light has no direction.",
      .since = "q3map2",
      .example = "spot_target"}},
    {{.name = "radius",
      .values = "F",
      .kind = Number,
      .unit = "game units",
      .help = "Sets the radius of the spotlight's cone at the distance of its target",
      .details = "At that distance the cone ends 16 game units outside of the radius. The light fades over the "
                 "outermost 32 units of the cone. A radius of 0 counts as 64.",
      .since = "q3map2",
      .example = "96"},
     64},
    {{.name = "_sun",
      .values = "0|1",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "With 1, turns a light with a target into a sun that lights from here toward the target",
      .details =
          "Intensity 255 gives 255 to a surface that faces the sun. With `_samples` N the intensity is divided "
          "by N twice. Without a target the key has no effect and is a warning. Every number other than 0 counts as 1.",
      .since = "q3map2",
      .example = "1"}},
    {{.name = "_anglescale",
      .values = "F",
      .kind = Number,
      .initial = "off",
      .help = "Softens light that arrives at an angle: its cosine is divided by F, up to 1",
      .details = "The light then depends on the angle even where spawnflags turn that off. Grids ignore this key.",
      .since = "q3map2",
      .example = "0.5"}},
    {{.name = "_filterradius",
      .aliases = {"_filteradius", "_filter"},
      .values = "F",
      .kind = Number,
      .unit = "game units",
      .range = {0, kMaxFilterRadius},
      .help = "Blurs this light in lightmaps over the given radius",
      .details = "Grids ignore this key.",
      .since = "q3map2",
      .example = "16"}},
    {{.name = "spawnflags",
      .values = "N",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "Sets flags: the sum of 1 linear falloff, 2 no dependence on the angle, 16 not for the grids, 32 color "
              "not normalized",
      .details =
          "With 1 or 2, light on a surface does not depend on its angle. In games of the Wolfenstein family 1 means "
          "inverse square falloff, and light depends on the angle only with 1 or 2. Spotlights always have inverse "
          "square falloff and depend on the angle. For lights in 8-bit levels, 1 means dark at first under "
          "`-switchable`, and only 2 turns off the dependence on the angle. Flags 4, 8 and 64 do nothing.",
      .since = "q3map2",
      .example = "1"}}};
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
      .help = "Sets the size of a cell of the legacy light grid, in whole numbers",
      .details = "Fractions are cut off. The light stage enlarges the cells until the grid has at most 1048576 points, "
                 "and writes a changed size back to the key.",
      .since = "q3map2",
      .example = "32 32 64"}},
    {{.name = "_color",
      .values = "R G B",
      .kind = Number,
      .initial = "1 1 1",
      .help = "Sets the color of _ambient, _minlight, _mingridlight and _minvertexlight",
      .details = "It multiplies these values and is not normalized. The color 0 0 0 counts as 1 1 1.",
      .since = "q3map2",
      .example = "1 0.9 0.8"}},
    {{.name = "_ambient",
      .aliases = {"ambient"},
      .values = "F",
      .kind = Number,
      .unit = "8-bit levels",
      .help = "Adds constant light everywhere",
      .details =
          "With a `.srf`, surfaces get the value that the bsp stage wrote there. The bsp stage also reads `_ambient` "
          "and `_color` of entities with brushes, and uses them for their surfaces instead of those of the world.",
      .since = "q3map2",
      .example = "5"}},
    {{.name = "_minlight",
      .values = "F",
      .kind = Number,
      .unit = "8-bit levels",
      .help = "Sets the least light of lightmaps",
      .details = "It applies to vertices and grid points too, unless they have a key for it.",
      .since = "q3map2",
      .example = "8"}},
    {{.name = "_mingridlight",
      .values = "F",
      .kind = Number,
      .unit = "8-bit levels",
      .initial = "_minlight",
      .help = "Sets the least light of grid points, in both grids",
      .since = "q3map2",
      .example = "16"}},
    {{.name = "_minvertexlight",
      .values = "F",
      .kind = Number,
      .unit = "8-bit levels",
      .initial = "_minlight",
      .help = "Sets the least light of vertices",
      .since = "q3map2",
      .example = "16"}},
    {{.name = "_maxlight",
      .values = "F",
      .kind = Number,
      .unit = "8-bit levels",
      .range = {0, 255},
      .help = "Limits the light of lightmaps, vertices and the legacy grid",
      .since = "q3map2",
      .example = "200"},
     255},
    {{.name = "_noshadersun",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "With 1, ignores the suns of shaders",
      .details = "Sky light stays.",
      .since = "q3map2",
      .example = "1"}},
    {{.name = "_floodlight",
      .values = "R G B [DISTANCE] [INTENSITY] [SCALE]",
      .kind = Number,
      .initial = "off",
      .help = "Adds soft light wherever there is open space, as -floodlight does, with these values",
      .details =
          "DISTANCE is in game units and defaults to 1024. INTENSITY is in 8-bit levels and defaults to 128. SCALE is "
          "a factor of its weight in deluxe pages and defaults to 1. The color 0 0 0 counts as 0.94 0.94 1.",
      .since = "q3map2",
      .example = "0.9 0.95 1 512 96"}},
    {{.name = "_keepLights",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "With 1, keeps light entities in the .bsp, and the light stage reads them there and not in the .map",
      .details = "The bsp stage writes this key under `-keeplights`.",
      .since = "q3map2",
      .example = "1"}},
    {{.name = "_styleNrgbgen",
      .values = "WORDS",
      .kind = Text,
      .initial = "wave noise 0.5 1 0 5.37",
      .help = "Sets how light of style N changes over time, in the words of rgbGen in a shader",
      .details = "N is the number of the style, as in `_style3rgbgen`. Generated shaders get these words.",
      .since = "q3map2",
      .example = "wave sin 0.5 0.5 0 1"}},
    {{.name = "_styleNalphagen",
      .values = "WORDS",
      .kind = Text,
      .initial = "none",
      .help = "Sets how the alpha of style N changes over time, in the words of alphaGen in a shader",
      .details = "N is the number of the style, as in `_style3alphagen`. Generated shaders get these words.",
      .since = "q3map2",
      .example = "wave sin 0.5 0.5 0 1"}}};
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
      .help = "Sets C of the falloff 1 / (C + L d + Q d²) at distance d",
      .details = "The next two keys set L and Q. The light at distance 100 is the intensity, in 8-bit levels. If all "
                 "three are 0, C is 1.",
      .since = "VRAD",
      .example = "1"}},
    {{.name = "_linear_attn",
      .values = "L",
      .kind = Number,
      .range = kNotNegative,
      .help = "Sets L of the falloff 1 / (C + L d + Q d²) at distance d",
      .details = "The key `_constant_attn` has the details.",
      .since = "VRAD",
      .example = "1"}},
    {{.name = "_quadratic_attn",
      .values = "Q",
      .kind = Number,
      .range = kNotNegative,
      .help = "Sets Q of the falloff 1 / (C + L d + Q d²) at distance d",
      .details = "The key `_constant_attn` has the details.",
      .since = "VRAD",
      .example = "1"}},
    {{.name = "_fifty_percent_distance",
      .values = "D",
      .kind = Number,
      .unit = "game units",
      .initial = "off",
      .range = {.low = 0},
      .help = "Sets the distance at which the light is half the intensity, in 8-bit levels",
      .details = "The three keys for attenuation have no effect with it. The page [From Source or "
                 "ericw-tools](../guide/from_source_engine.md#falloff) has the formula of the curve.",
      .since = "VRAD",
      .example = "128"}},
    {{.name = "_zero_percent_distance",
      .values = "D",
      .kind = Number,
      .unit = "game units",
      .initial = "2 × _fifty_percent_distance",
      .range = {.low = 0},
      .help = "Sets the distance at which the curve of _fifty_percent_distance is nearly dark",
      .details =
          "With the default, 12.7 % of the light is left there unless `_hardfalloff` is 1. The same distance for both "
          "keys is an error. A distance smaller than `_fifty_percent_distance` is replaced by the default.",
      .since = "VRAD",
      .example = "512"}},
    {{.name = "_hardfalloff",
      .values = "0|1",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "With 1, fades the light of _fifty_percent_distance to nothing at _zero_percent_distance",
      .details = "Every number other than 0 counts as 1.",
      .since = "VRAD",
      .example = "1"}},
    {{.name = "_radius",
      .values = "R",
      .kind = Number,
      .unit = "game units",
      .initial = "off",
      .range = {.low = 0},
      .help = "Ends the light at distance R: inverse square falloff times (1 − (d/R)⁴)²",
      .details = "Nearby the light is as bright as without this key. Beyond R it costs no time.",
      .since = "0.2.0",
      .example = "384"}},
    {{.name = "delay",
      .values = "N",
      .kind = Integer,
      .initial = "off",
      .range = kAnyInteger,
      .help = "Chooses a falloff of ericw-tools: 1 inverse, 2 inverse square, 3 none, 5 inverse square without a "
              "bright core",
      .details = "With intensity I, and W from `wait`, the light at distance d is in 8-bit levels: 128 I / (W d) for "
                 "1, 128² I / (W d)² for 2, I for 3 and 128² I / (W d + 128)² for 5. The numbers 0 and 4 have no "
                 "counterpart and are warnings.",
      .since = "ericw-tools",
      .example = "2"}},
    {{.name = "wait",
      .values = "W",
      .kind = Number,
      .help = "Multiplies the distance in the falloff of delay 1, 2 and 5",
      .details = "A factor of 0 or less counts as 1.",
      .since = "ericw-tools",
      .example = "0.5"},
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
      .help = "Sets the half angle of the part of the cone that gets the full light",
      .details = "An angle of 180 makes a point light. Other angles over 90 count as 90, with a warning.",
      .since = "VRAD",
      .example = "20"},
     10},
    {{.name = "_cone",
      .values = "A",
      .kind = Number,
      .unit = "degrees",
      .initial = "_inner_cone",
      .range = {0, 180},
      .help = "Sets the half angle at which the light ends, which is at least _inner_cone",
      .since = "VRAD",
      .example = "30"}},
    {{.name = "_exponent",
      .values = "F",
      .kind = Number,
      .range = {.low = 0},
      .help = "Sets the exponent of the fade between _inner_cone and _cone",
      .details = "An exponent of 0 counts as 1.",
      .since = "VRAD",
      .example = "2"},
     1},
    {{.name = "pitch",
      .values = "A",
      .kind = Number,
      .unit = "degrees",
      .initial = "angles",
      .help = "Sets the pitch of the light instead of the one in angles, where -90 is straight down",
      .details = "A pitch of 0 leaves that of `angles`.",
      .since = "VRAD",
      .example = "-90"}},
    {{.name = "angles",
      .values = "PITCH YAW ROLL",
      .kind = Number,
      .unit = "degrees",
      .initial = "0 0 0",
      .help = "Sets the direction in which the light points, unless it has a target",
      .details = "A pitch of -90 is straight down. A light_environment has no target, so its direction is always that "
                 "of the angles.",
      .since = "VRAD",
      .example = "-60 45 0"}},
    {{.name = "angle",
      .values = "A",
      .kind = Number,
      .unit = "degrees",
      .initial = "angles",
      .help = "Sets the yaw of the light, where -1 is straight up and -2 straight down",
      .details = "A yaw of 0 leaves that of `angles`.",
      .since = "VRAD",
      .example = "90"}}};
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
      .help = "Sets the sky light that an open floor gets, written as _light",
      .details = "A wall in the open gets half of that.",
      .since = "VRAD",
      .example = "140 170 255 60"}},
    {{.name = "SunSpreadAngle",
      .values = "A",
      .kind = Number,
      .unit = "degrees",
      .range = {0, 180},
      .help = "Sets the angle that the disc of the sun spans, for soft shadows",
      .details = "The sun then has 32 directions, or as many as `_samples` says.",
      .since = "VRAD",
      .example = "2"}}};
inline constexpr const EntityKey &kSkyAmbient = Key(kEnvironmentKeys, "_ambient");
inline constexpr const EntityKey &kSunSpread = Key(kEnvironmentKeys, "SunSpreadAngle");

/// Keys that Source reads for HDR light only. One result serves all ranges here.
inline constexpr EntityKey kHdrLightKeys[] = {
    {{.name = "_lightHDR",
      .values = "R G B I",
      .kind = Number,
      .initial = "_light",
      .range = {-kMaxIntensity, kMaxIntensity},
      .help = "Is the light for HDR in Source, and is not used",
      .details = "One bake serves HDR and 8-bit lightmaps, so a value that differs from `_light` is a warning. A "
                 "negative number means the same as `_light`.",
      .since = "VRAD",
      .example = "-1 -1 -1 1"}},
    {{.name = "_ambientHDR",
      .values = "R G B I",
      .kind = Number,
      .initial = "_ambient",
      .range = {-kMaxIntensity, kMaxIntensity},
      .help = "Is the sky light for HDR in Source, and is not used",
      .details = "A value that differs from `_ambient` is a warning. A negative number means the same as `_ambient`.",
      .since = "VRAD",
      .example = "-1 -1 -1 1"}},
    {{.name = "_lightscaleHDR",
      .values = "F",
      .kind = Number,
      .help = "Is the factor of the light for HDR in Source, and is not used",
      .details = "A factor other than 1 is a warning.",
      .since = "VRAD",
      .example = "0.5"},
     1},
    {{.name = "_AmbientScaleHDR",
      .values = "F",
      .kind = Number,
      .help = "Is the factor of the sky light for HDR in Source, and is not used",
      .details = "A factor other than 1 is a warning.",
      .since = "VRAD",
      .example = "0.5"},
     1}};
inline constexpr const EntityKey &kLightHdr = Key(kHdrLightKeys, "_lightHDR");
inline constexpr const EntityKey &kAmbientHdr = Key(kHdrLightKeys, "_ambientHDR");
inline constexpr const EntityKey &kLightScaleHdr = Key(kHdrLightKeys, "_lightscaleHDR");
inline constexpr const EntityKey &kAmbientScaleHdr = Key(kHdrLightKeys, "_AmbientScaleHDR");

/// The keys of light entities for styles, in addition to kStyle.
inline constexpr EntityKey kStyleLightKeys[] = {
    {{.name = "pattern",
      .values = "LETTERS",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Sets the brightness over time by letters, ten per second: a is dark, m is 1, z is 2",
      .details = "Lights of one pattern share a style that nothing else uses, unless `style` names another one.",
      .since = "0.2.0",
      .example = "mmamammmmammamamaaamammma"}},
    {{.name = "targetname",
      .values = "NAME",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names a light that the game can switch, under -switchable",
      .details =
          "Lights of one name share a style. The page [From Source or "
          "ericw-tools](../guide/from_source_engine.md#switchable-and-animated-lights) explains how engines switch it.",
      .since = "VRAD",
      .example = "hall_lights"}}};
inline constexpr const EntityKey &kPattern = Key(kStyleLightKeys, "pattern");
inline constexpr const EntityKey &kSwitchName = Key(kStyleLightKeys, "targetname");

/// The same of worldspawn.
inline constexpr EntityKey kStyleWorldKeys[] = {
    {{.name = "_switchable",
      .values = "0|1",
      .kind = SettingKind::Flag,
      .initial = "0",
      .help = "With 1, makes lights with a targetname switchable, as -switchable does",
      .since = "0.2.0",
      .example = "1"}}};
inline constexpr const EntityKey &kSwitchable = Key(kStyleWorldKeys, "_switchable");

/// The macro texture of the world.
inline constexpr EntityKey kMacroKeys[] = {
    {{.name = "_macrotexture",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names an image over the whole world, seen from above, that tints lightmaps and vertex light",
      .details = "The option `-macrotexture` overrides it. The page [From Source or "
                 "ericw-tools](../guide/from_source_engine.md#macro-textures) has the rules.",
      .since = "0.2.0",
      .example = "textures/macro/city"}},
    {{.name = "world_mins",
      .values = "X Y Z",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "bounds of the world",
      .help = "Sets where the left and the lower edge of the macro texture are",
      .since = "VRAD",
      .example = "-4096 -4096 -512"}},
    {{.name = "world_maxs",
      .values = "X Y Z",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "bounds of the world",
      .help = "Sets where the right and the upper edge of the macro texture are",
      .since = "VRAD",
      .example = "4096 4096 1024"}}};
inline constexpr const EntityKey &kMacroTexture = Key(kMacroKeys, "_macrotexture");
inline constexpr const EntityKey &kWorldMins = Key(kMacroKeys, "world_mins");
inline constexpr const EntityKey &kWorldMaxs = Key(kMacroKeys, "world_maxs");

} // namespace q3::keys
