// GPL-2.0-or-later. The keys of what the bsp stage compiles into a map, of surfaces, and of worldspawn for the bsp and
// vis stages. A new key goes here.
#pragma once

#include "q3map2/bspfile/light_keys.h"

namespace q3::keys {

// ---- Models, terrain, decals, sky boxes, flares and instances ----

inline constexpr EntityKey kAngle{
    {.name = "angle", .values = "F", .kind = Number, .unit = "degrees", .help = "Turn around the vertical axis"}};
inline constexpr EntityKey kAngles{{.name = "angles",
                                    .values = "PITCH YAW ROLL",
                                    .kind = Number,
                                    .unit = "degrees",
                                    .initial = "angle",
                                    .help = "Turns around all axes"}};

/// The keys of misc_model entities.
inline constexpr EntityKey kModelKeys[] = {
    {{.name = "model", .values = "FILE", .kind = Text, .help = "The model"}},
    {{.name = "_target",
      .aliases = {"target"},
      .values = "NAME",
      .kind = Text,
      .initial = "the world",
      .help = "The brush entity of that targetname, which the model becomes a part of"}},
    {{.name = "_skin",
      .aliases = {"skin"},
      .values = "NAME",
      .kind = Text,
      .help = "Shaders and meshes as the file MODEL_NAME.skin says"}},
    {{.name = "_remap*",
      .values = "FROM;TO",
      .kind = Text,
      .help = "Shaders whose names end with FROM become TO, where * means all; any key that starts with _remap"}},
    {{.name = "modelscale", .values = "F", .kind = Number, .help = "Size of the model; 0 means 1"}, 1},
    {{.name = "modelscale_vec",
      .values = "X Y Z",
      .kind = Number,
      .initial = "modelscale",
      .help = "Size along each axis"}},
    kAngle,
    kAngles,
    {{.name = "_frame",
      .aliases = {"frame"},
      .values = "N",
      .kind = Integer,
      .range = {0, 1e9},
      .help = "Frame of an animated model"}},
    {{.name = "_clipdepth",
      .values = "F",
      .kind = Number,
      .unit = "game units",
      .initial = "-clipdepth",
      .help = "Thickness of the model's clip brushes"}},
    {{.name = "spawnflags",
      .values = "N",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "Sum of: 2 clip brushes, 4 triangle surfaces with lightmaps, 32 alpha from the grey of vertex colors",
      .details =
          "How clip brushes are made, with or without 2: 8 along the normals of faces, 16 as terrain, 128 along the "
          "normals of vertices, 256 as pyramids, 512 downward, 1024 upward, 2048 to the model's full depth, 4096 "
          "with an axial back. 1: -rename appends _RMG_BSP instead of _BSP."}},
    {{.name = "_staticprop",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "1: the entity stays in the .bsp as a static prop, and the model does not become part of the map"}}};
inline constexpr const EntityKey &kModel = Key(kModelKeys, "model");
inline constexpr const EntityKey &kModelTarget = Key(kModelKeys, "_target");
inline constexpr const EntityKey &kSkin = Key(kModelKeys, "_skin");
inline constexpr const EntityKey &kModelScale = Key(kModelKeys, "modelscale");
inline constexpr const EntityKey &kModelScaleVec = Key(kModelKeys, "modelscale_vec");
inline constexpr const EntityKey &kFrame = Key(kModelKeys, "_frame");
inline constexpr const EntityKey &kClipDepth = Key(kModelKeys, "_clipdepth");
inline constexpr const EntityKey &kModelFlags = Key(kModelKeys, "spawnflags");
inline constexpr const EntityKey &kStaticProp = Key(kModelKeys, "_staticprop");
/// Start of the names of remap keys.
inline constexpr std::string_view kRemapPrefix = "_remap";

/// The keys of static props, which -staticproplighting lights, beside those of misc_model. Each is a flag or a name.
inline constexpr EntityKey kPropKeys[] = {
    {{.name = "disableshadows", .values = "0|1", .kind = Flag, .initial = "0", .help = "1: casts no shadows"}},
    {{.name = "disableselfshadowing",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "1: does not shadow its own vertices"}},
    {{.name = "disablevertexlighting",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "1: gets no light at its vertices; the game lights it as before"}},
    {{.name = "ignorenormals",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "1: light is multiplied by 0.35 instead of the cosine to the normal; for foliage"}},
    {{.name = "lightingorigin",
      .aliases = {"_lightingorigin"},
      .values = "NAME",
      .kind = Text,
      .initial = "center of the model",
      .help = "Targetname of an entity; vertices in walls are lit from its side if no vertex is in the open"}},
    {{.name = "generatelightmaps",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "Lightmaps of props, which this program does not make: 1 is a warning"}}};
inline constexpr const EntityKey &kPropNoShadows = Key(kPropKeys, "disableshadows");
inline constexpr const EntityKey &kPropNoSelfShadows = Key(kPropKeys, "disableselfshadowing");
inline constexpr const EntityKey &kPropNoVertexLight = Key(kPropKeys, "disablevertexlighting");
inline constexpr const EntityKey &kPropIgnoreNormals = Key(kPropKeys, "ignorenormals");
inline constexpr const EntityKey &kPropLightingOrigin = Key(kPropKeys, "lightingorigin");
inline constexpr const EntityKey &kPropLightmaps = Key(kPropKeys, "generatelightmaps");

/// The keys that make the surfaces of an entity indexed terrain.
inline constexpr EntityKey kTerrainKeys[] = {
    {{.name = "_indexmap",
      .aliases = {"alphamap"},
      .values = "FILE",
      .kind = Text,
      .help = "Picture, seen from above, of the layers: palette index or red of each texel"}},
    {{.name = "_layers",
      .aliases = {"layers"},
      .values = "N",
      .kind = Integer,
      .initial = "none",
      .range = {1, 255},
      .help = "Number of layers; needed"}},
    {{.name = "_shader",
      .aliases = {"shader"},
      .values = "NAME",
      .kind = Text,
      .help = "Surfaces get the shader textures/NAME_A, or textures/NAME_AtoB where layers A to B blend; needed"}},
    {{.name = "_offsets",
      .aliases = {"offsets"},
      .values = "Z0 Z1 ...",
      .kind = Text,
      .unit = "game units",
      .initial = "0",
      .help = "Height added to vertices of each layer"}},
    {{.name = "min",
      .values = "X Y Z",
      .kind = Text,
      .unit = "game units",
      .initial = "of the entity",
      .help = "Corner of the box that the picture covers"}},
    {{.name = "max",
      .values = "X Y Z",
      .kind = Text,
      .unit = "game units",
      .initial = "of the entity",
      .help = "Opposite corner"}}};
inline constexpr const EntityKey &kIndexMap = Key(kTerrainKeys, "_indexmap");
inline constexpr const EntityKey &kLayers = Key(kTerrainKeys, "_layers");
inline constexpr const EntityKey &kLayerShader = Key(kTerrainKeys, "_shader");
inline constexpr const EntityKey &kLayerOffsets = Key(kTerrainKeys, "_offsets");
inline constexpr const EntityKey &kIndexMapMin = Key(kTerrainKeys, "min");
inline constexpr const EntityKey &kIndexMapMax = Key(kTerrainKeys, "max");

/// The keys of _skybox entities.
inline constexpr EntityKey kSkyBoxKeys[] = {{{.name = "_scale",
                                              .values = "F | X Y Z",
                                              .kind = Text,
                                              .initial = "64",
                                              .help = "How many times the sky box is enlarged"}},
                                            kAngle,
                                            kAngles};
inline constexpr const EntityKey &kSkyBoxScale = Key(kSkyBoxKeys, "_scale");

/// The keys of light entities that make flares.
inline constexpr EntityKey kFlareKeys[] = {{{.name = "_flare",
                                             .values = "0|1",
                                             .kind = Flag,
                                             .initial = "0",
                                             .help = "1: the light has a flare, with -flares"}},
                                           {{.name = "_flareshader",
                                             .values = "NAME",
                                             .kind = Text,
                                             .initial = "by game, usually flareshader",
                                             .help = "The light has a flare of that shader, with -flares"}}};
inline constexpr const EntityKey &kFlare = Key(kFlareKeys, "_flare");
inline constexpr const EntityKey &kFlareShader = Key(kFlareKeys, "_flareshader");

/// The keys of entities that are named, targeted or repeated.
inline constexpr EntityKey kNameKeys[] = {
    {{.name = "targetname",
      .aliases = {"_targetname"},
      .values = "NAME",
      .kind = Text,
      .help = "What a light, decal or model names as its target"}},
    {{.name = "_clonename", .values = "NAME", .kind = Text, .help = "What instances name as their original"}},
    {{.name = "_ins",
      .aliases = {"_instance", "_clone"},
      .values = "NAME",
      .kind = Text,
      .help = "The entity has the brush model of that _clonename instead of brushes of its own"}}};
inline constexpr const EntityKey &kTargetName = Key(kNameKeys, "targetname");
inline constexpr const EntityKey &kCloneName = Key(kNameKeys, "_clonename");
inline constexpr const EntityKey &kInstance = Key(kNameKeys, "_ins");

/// The key of _decal entities.
inline constexpr EntityKey kDecalKeys[] = {{{.name = "target",
                                             .values = "NAME",
                                             .kind = Text,
                                             .help = "Entity toward which the patches are projected; needed"}}};
inline constexpr const EntityKey &kDecalTarget = Key(kDecalKeys, "target");

// ---- All surfaces of an entity, and worldspawn for the bsp and vis stages ----

inline constexpr int kMaxLuxel = 16384; ///< largest size of a luxel, game units

/// The keys that apply to all surfaces of an entity. Both the bsp stage and, without a .srf, the light stage read them.
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
inline constexpr const EntityKey &kCastShadows = Key(kSurfaceKeys, "_castShadows");
inline constexpr const EntityKey &kReceiveShadows = Key(kSurfaceKeys, "_receiveShadows");
inline constexpr const EntityKey &kSampleSize = Key(kSurfaceKeys, "_lightmapsamplesize");
inline constexpr const EntityKey &kLightmapScale = Key(kSurfaceKeys, "lightmapscale");
inline constexpr const EntityKey &kShadeAngle = Key(kSurfaceKeys, "_shadeangle");
inline constexpr const EntityKey &kCelShader = Key(kSurfaceKeys, "_celshader");
inline constexpr const EntityKey &kPatchMeta = Key(kSurfaceKeys, "_patchMeta");
inline constexpr const EntityKey &kPatchSubdivide = Key(kSurfaceKeys, "_patchSubdivide");
inline constexpr const EntityKey &kPatchQuality = Key(kSurfaceKeys, "_patchQuality");

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
    {{.name = "_keepModels",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "1: misc_model entities stay in the .bsp, as with -keepmodels"}},
    {{.name = "_fog",
      .aliases = {"fog"},
      .values = "SHADER",
      .kind = Text,
      .initial = "none",
      .help = "Fog of the whole map"}},
    {{.name = "_foghull",
      .values = "SHADER",
      .kind = Text,
      .initial = "none",
      .help = "Sky shader drawn around a map in fog"}},
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
inline constexpr const EntityKey &kIgnoreLeaks = Key(kWorldKeys, "_ignoreleaks");
inline constexpr const EntityKey &kBlockSize = Key(kWorldKeys, "_blocksize");
inline constexpr const EntityKey &kKeepModels = Key(kWorldKeys, "_keepModels");
inline constexpr const EntityKey &kFog = Key(kWorldKeys, "_fog");
inline constexpr const EntityKey &kFogHull = Key(kWorldKeys, "_foghull");
inline constexpr const EntityKey &kFarPlaneDist = Key(kWorldKeys, "_farplanedist");

} // namespace q3::keys
