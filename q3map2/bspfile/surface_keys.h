// GPL-2.0-or-later. The keys of entities with brushes, patches or models, and those of the world that the bsp and vis
// stages read. A new key goes here.
#pragma once

#include "q3map2/bspfile/light_keys.h"

namespace q3::keys {

inline constexpr int kMaxLuxel = 16384;

/// The keys that the surfaces of an entity share. Both the bsp stage and, without a .srf, the light stage read them.
inline constexpr EntityKey kSurfaceKeys[] = {
    {{.name = "_castShadows",
      .aliases = {"_cs"},
      .values = "N",
      .kind = Integer,
      .initial = "0; world and func_group 1",
      .range = kAnyInteger,
      .help = "Shadow group that the surfaces cast shadows for; 0: none"}},
    {{.name = "_receiveShadows",
      .aliases = {"_rs"},
      .values = "N",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "Shadow group that casts shadows on the surfaces; 0: none"},
     1},
    {{.name = "_lightmapsamplesize",
      .aliases = {"_samplesize", "_ss"},
      .values = "N",
      .kind = Integer,
      .unit = "game units",
      .initial = "-samplesize",
      .range = {0, kMaxLuxel},
      .help = "Size of a luxel; q3map_lightmapSampleSize of the shader wins"}},
    {{.name = "lightmapscale",
      .aliases = {"_lightmapscale", "_ls"},
      .values = "F",
      .kind = Number,
      .initial = "1",
      .range = {0, kMaxSetting},
      .help = "Factor of the size of a luxel"}},
    {{.name = "_shadeangle",
      .aliases = {"_smoothnormals", "_sn", "_sa", "_smooth"},
      .values = "F",
      .kind = Number,
      .unit = "degrees",
      .range = {0, 360},
      .help = "Smooths normals across edges flatter than this"}},
    {{.name = "_celshader",
      .values = "NAME",
      .kind = Text,
      .initial = "-celshader",
      .help = "Outlines the surfaces by a copy with the shader textures/NAME"}},
    {{.name = "_patchMeta",
      .aliases = {"patchMeta"},
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "1: patches become triangle surfaces, as with -patchmeta"}},
    {{.name = "_patchSubdivide",
      .aliases = {"patchSubdivide"},
      .values = "N",
      .kind = Integer,
      .initial = "-subdivisions",
      .range = kAnyInteger,
      .help = "Tolerance of these patches; smaller is finer"}},
    {{.name = "_patchQuality",
      .aliases = {"patchQuality"},
      .values = "N",
      .kind = Integer,
      .initial = "1",
      .range = kAnyInteger,
      .help = "Divisor of that tolerance"}}};
inline constexpr const EntityKey &kCastShadows = kSurfaceKeys[0], &kReceiveShadows = kSurfaceKeys[1],
                                 &kSampleSize = kSurfaceKeys[2], &kLightmapScale = kSurfaceKeys[3],
                                 &kShadeAngle = kSurfaceKeys[4], &kCelShader = kSurfaceKeys[5],
                                 &kPatchMeta = kSurfaceKeys[6], &kPatchSubdivide = kSurfaceKeys[7],
                                 &kPatchQuality = kSurfaceKeys[8];

/// The keys of misc_model entities.
inline constexpr EntityKey kModelKeys[] = {
    {{.name = "modelscale", .values = "F", .kind = Number, .help = "Size of the model; 0 means 1"}, 1},
    {{.name = "modelscale_vec", .values = "X Y Z", .kind = Number, .initial = "modelscale", .help = "Size along each axis"}},
    {{.name = "angle", .values = "F", .kind = Number, .unit = "degrees", .help = "Turn around the vertical axis"}},
    {{.name = "angles", .values = "PITCH YAW ROLL", .kind = Number, .unit = "degrees", .initial = "angle", .help = "Turns around all axes"}},
    {{.name = "_frame", .aliases = {"frame"}, .values = "N", .kind = Integer, .range = {0, 1e9}, .help = "Frame of an animated model"}},
    {{.name = "_clipdepth",
      .values = "F",
      .kind = Number,
      .unit = "game units",
      .initial = "-clipdepth",
      .help = "Thickness of the model's clip brushes"}}};
inline constexpr const EntityKey &kModelScale = kModelKeys[0], &kModelScaleVec = kModelKeys[1], &kAngle = kModelKeys[2],
                                 &kAngles = kModelKeys[3], &kFrame = kModelKeys[4], &kClipDepth = kModelKeys[5];

/// The keys of worldspawn that the bsp and vis stages read.
inline constexpr EntityKey kWorldKeys[] = {
    {{.name = "_ignoreleaks",
      .aliases = {"ignoreleaks"},
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "1: compile a map that leaks as if it did not"}},
    {{.name = "_blocksize",
      .aliases = {"blocksize", "chopsize"},
      .values = "X [Y] [Z]",
      .kind = Number,
      .unit = "game units",
      .initial = "1024",
      .range = {0, 4 * kMaxSetting},
      .help = "Size of the blocks into which the tree cuts the map first; 0: none"}},
    {{.name = "_fog", .aliases = {"fog"}, .values = "SHADER", .kind = Text, .initial = "none", .help = "Fog of the whole map"}},
    {{.name = "_foghull", .values = "SHADER", .kind = Text, .initial = "none", .help = "Sky shader drawn around a map in fog"}},
    {{.name = "_farplanedist",
      .aliases = {"fogclip", "distancecull"},
      .values = "N",
      .kind = Text,
      .unit = "game units",
      .initial = "none",
      .help = "Distance beyond which vis counts nothing as seen, but through sky portals",
      .details = "A letter after the number says how two portals with centers L apart and radii R₁ and R₂ are compared "
                 "with it: hidden if L − R₁ − R₂ is over the distance (no letter), L is (`o`), L + R₁ + R₂ is over "
                 "twice the distance (`e`), or R₁ + R₂ is over it (`r`)."}}};
inline constexpr const EntityKey &kIgnoreLeaks = kWorldKeys[0], &kBlockSize = kWorldKeys[1], &kFog = kWorldKeys[2],
                                 &kFogHull = kWorldKeys[3], &kFarPlaneDist = kWorldKeys[4];

} // namespace q3::keys
