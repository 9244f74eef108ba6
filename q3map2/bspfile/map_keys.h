// GPL-2.0-or-later. The keys of what the bsp stage compiles into a map, of surfaces, and of worldspawn for the bsp and
// vis stages. A new key goes here.
#pragma once

#include "q3map2/bspfile/light_keys.h"

namespace q3::keys {

// ---- Models, terrain, decals, sky boxes, flares and instances ----

inline constexpr EntityKey kAngle{{.name = "angle",
                                   .values = "F",
                                   .kind = Number,
                                   .unit = "degrees",
                                   .help = "Turns the entity around the vertical axis",
                                   .since = "q3map2",
                                   .example = "90"}};
inline constexpr EntityKey kAngles{{.name = "angles",
                                    .values = "PITCH YAW ROLL",
                                    .kind = Number,
                                    .unit = "degrees",
                                    .initial = "angle",
                                    .help = "Turns the entity around all axes, and overrides angle",
                                    .since = "q3map2",
                                    .example = "0 90 15"}};

/// The keys of misc_model entities.
inline constexpr EntityKey kModelKeys[] = {
    {{.name = "model",
      .values = "FILE",
      .kind = Text,
      .initial = "none",
      .help = "Names the model file, which is required",
      .details = "The file is looked for in the folders and archives of the game.",
      .since = "q3map2",
      .example = "models/mapobjects/lamp.md3"}},
    {{.name = "_target",
      .aliases = {"target"},
      .values = "NAME",
      .kind = Text,
      .initial = "the world",
      .help = "Makes the model part of the brush entity of that targetname",
      .since = "q3map2",
      .example = "door1"}},
    {{.name = "_skin",
      .aliases = {"skin"},
      .values = "NAME",
      .kind = Text,
      .initial = "none",
      .help = "Takes the shaders of the model from a skin file",
      .details = "For the model `x.md3`, the skin `red` is the file `x_red.skin` and the skin `1` is the file "
                 "`x.md3_1.skin`. Meshes whose shader the file does not name are left out.",
      .since = "q3map2",
      .example = "red"}},
    {{.name = "_remap*",
      .values = "FROM;TO",
      .kind = Text,
      .initial = "none",
      .help = "Replaces shaders of the model whose names end with FROM by TO, where FROM may be * for all",
      .details = "Every key that begins with `_remap` counts, so a model may have several, such as `_remap1` and "
                 "`_remap2`. If several fit a shader, the longest FROM counts.",
      .since = "q3map2",
      .example = "lamp/glass;textures/mymap/glass"}},
    {{.name = "modelscale",
      .values = "F",
      .kind = Number,
      .help = "Scales the model by this factor",
      .details = "A factor of 0 counts as 1.",
      .since = "q3map2",
      .example = "1.5"},
     1},
    {{.name = "modelscale_vec",
      .values = "X Y Z",
      .kind = Number,
      .initial = "modelscale",
      .help = "Scales the model by one factor per axis, and overrides modelscale",
      .since = "q3map2",
      .example = "1 1 2"}},
    kAngle,
    kAngles,
    {{.name = "_frame",
      .aliases = {"frame"},
      .values = "N",
      .kind = Integer,
      .range = {0, 1e9},
      .help = "Chooses the frame of an animated model",
      .since = "q3map2",
      .example = "4"}},
    {{.name = "_clipdepth",
      .values = "F",
      .kind = Number,
      .unit = "game units",
      .initial = "-clipdepth",
      .help = "Sets the thickness of the model's clip brushes",
      .since = "q3map2",
      .example = "8"}},
    {{.name = "spawnflags",
      .values = "N",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "Sets flags: the sum of 2 clip brushes, 4 surfaces with lightmaps, 32 alpha from vertex colors",
      .details = "With 2 the model gets clip brushes. With 4 it becomes triangle surfaces with lightmaps. With 32 the "
                 "gray of vertex colors becomes alpha. More flags say how clip brushes are made, whether 2 or the "
                 "shader asks for them. They extend the triangles along the normals of faces (8), as terrain (16), "
                 "along the normals of vertices (128), as pyramids (256), downward (512) or upward (1024). With 2048 "
                 "they reach through the full depth of the model, and with 4096 they have an axial back. With 1, "
                 "`-rename` appends `_RMG_BSP` instead of `_BSP`.",
      .since = "q3map2",
      .example = "6"}},
    {{.name = "_staticprop",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "With 1, keeps the entity in the .bsp as a static prop, and the model does not become part of the map",
      .details = "The page [Static props](../guide/static_props.md) explains how props are lit.",
      .since = "0.2.0",
      .example = "1"}}};
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

/// The keys of static props, which -staticproplighting lights, in addition to those of misc_model. Each is a flag or a
/// name.
inline constexpr EntityKey kPropKeys[] = {
    {{.name = "disableshadows",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "With 1, keeps the prop from casting shadows",
      .since = "VRAD",
      .example = "1"}},
    {{.name = "disableselfshadowing",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "With 1, keeps the prop from shadowing its own vertices",
      .since = "VRAD",
      .example = "1"}},
    {{.name = "disablevertexlighting",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "With 1, gives the prop no light at its vertices, so the game lights it as without this program",
      .details = "The prop still casts shadows.",
      .since = "VRAD",
      .example = "1"}},
    {{.name = "ignorenormals",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "With 1, multiplies light by 0.35 instead of the cosine to the normal, for foliage",
      .since = "VRAD",
      .example = "1"}},
    {{.name = "lightingorigin",
      .aliases = {"_lightingorigin"},
      .values = "NAME",
      .kind = Text,
      .initial = "center of the model",
      .help = "Names an entity by its targetname, from whose side vertices in walls are lit",
      .details = "It counts only if no vertex of the prop is in the open.",
      .since = "VRAD",
      .example = "prop1_light"}},
    {{.name = "generatelightmaps",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "Asks for lightmaps of the prop, which are not made, so 1 is a warning",
      .since = "VRAD",
      .example = "1"}}};
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
      .initial = "none",
      .help = "Names the picture of the layers, seen from above",
      .details = "It is a PCX, PNG or TGA file of at least 2 x 2 texels. The layer of a texel is its palette index or, "
                 "without a palette, its red times the number of layers, divided by 256.",
      .since = "q3map2",
      .example = "textures/mymap/layers.tga"}},
    {{.name = "_layers",
      .aliases = {"layers"},
      .values = "N",
      .kind = Integer,
      .initial = "none",
      .range = {1, 255},
      .help = "Sets the number of layers, which is required",
      .since = "q3map2",
      .example = "3"}},
    {{.name = "_shader",
      .aliases = {"shader"},
      .values = "NAME",
      .kind = Text,
      .initial = "none",
      .help = "Sets the base name of the shaders of the layers, which is required",
      .details = "Surfaces of layer A get the shader `textures/NAME_A`. Surfaces on which the layers A to B blend get "
                 "`textures/NAME_AtoB`.",
      .since = "q3map2",
      .example = "mymap/terrain"}},
    {{.name = "_offsets",
      .aliases = {"offsets"},
      .values = "Z0 Z1 ...",
      .kind = Text,
      .unit = "game units",
      .initial = "0",
      .help = "Sets the height that is added to the vertices of each layer",
      .since = "q3map2",
      .example = "0 8 24"}},
    {{.name = "min",
      .values = "X Y Z",
      .kind = Text,
      .unit = "game units",
      .initial = "of the entity",
      .help = "Sets the lowest corner of the box that the picture covers",
      .since = "q3map2",
      .example = "-1024 -1024 0"}},
    {{.name = "max",
      .values = "X Y Z",
      .kind = Text,
      .unit = "game units",
      .initial = "of the entity",
      .help = "Sets the highest corner of the box that the picture covers",
      .since = "q3map2",
      .example = "1024 1024 256"}}};
inline constexpr const EntityKey &kIndexMap = Key(kTerrainKeys, "_indexmap");
inline constexpr const EntityKey &kLayers = Key(kTerrainKeys, "_layers");
inline constexpr const EntityKey &kLayerShader = Key(kTerrainKeys, "_shader");
inline constexpr const EntityKey &kLayerOffsets = Key(kTerrainKeys, "_offsets");
inline constexpr const EntityKey &kIndexMapMin = Key(kTerrainKeys, "min");
inline constexpr const EntityKey &kIndexMapMax = Key(kTerrainKeys, "max");

/// The keys of _skybox entities.
inline constexpr EntityKey kSkyBoxKeys[] = {
    {{.name = "_scale",
      .values = "F | X Y Z",
      .kind = Text,
      .initial = "64",
      .help = "Sets how many times the sky box is enlarged, or one factor per axis",
      .since = "q3map2",
      .example = "32"}},
    kAngle,
    kAngles};
inline constexpr const EntityKey &kSkyBoxScale = Key(kSkyBoxKeys, "_scale");

/// The keys of light entities that make flares.
inline constexpr EntityKey kFlareKeys[] = {{{.name = "_flare",
                                             .values = "0|1",
                                             .kind = Flag,
                                             .initial = "0",
                                             .help = "With 1, gives the light a flare, under -flares",
                                             .since = "q3map2",
                                             .example = "1"}},
                                           {{.name = "_flareshader",
                                             .values = "NAME",
                                             .kind = Text,
                                             .initial = "by game, usually flareshader",
                                             .help = "Gives the light a flare of that shader, under -flares",
                                             .since = "q3map2",
                                             .example = "textures/mymap/flare"}}};
inline constexpr const EntityKey &kFlare = Key(kFlareKeys, "_flare");
inline constexpr const EntityKey &kFlareShader = Key(kFlareKeys, "_flareshader");

/// The keys of entities that are named, targeted or repeated.
inline constexpr EntityKey kNameKeys[] = {
    {{.name = "targetname",
      .aliases = {"_targetname"},
      .values = "NAME",
      .kind = Text,
      .initial = "none",
      .help = "Names the entity, so that a light, decal or model can have it as its target",
      .since = "q3map2",
      .example = "spot_target"}},
    {{.name = "_clonename",
      .values = "NAME",
      .kind = Text,
      .initial = "none",
      .help = "Names the brush model of the entity, so that other entities can repeat it with _ins",
      .since = "q3map2",
      .example = "pillar"}},
    {{.name = "_ins",
      .aliases = {"_instance", "_clone"},
      .values = "NAME",
      .kind = Text,
      .initial = "none",
      .help = "Gives the entity the brush model of that _clonename instead of its own brushes",
      .since = "q3map2",
      .example = "pillar"}}};
inline constexpr const EntityKey &kTargetName = Key(kNameKeys, "targetname");
inline constexpr const EntityKey &kCloneName = Key(kNameKeys, "_clonename");
inline constexpr const EntityKey &kInstance = Key(kNameKeys, "_ins");

/// The key of _decal entities.
inline constexpr EntityKey kDecalKeys[] = {
    {{.name = "target",
      .values = "NAME",
      .kind = Text,
      .initial = "none",
      .help = "Names the entity toward which the patches are projected, which is required",
      .since = "q3map2",
      .example = "decal_target"}}};
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
      .help = "Sets the shadow group for which the surfaces cast shadows, where 0 casts none",
      .details = "The key `_receiveShadows` says which groups a surface receives.",
      .since = "q3map2",
      .example = "2"}},
    {{.name = "_receiveShadows",
      .aliases = {"_rs"},
      .values = "N",
      .kind = Integer,
      .range = kAnyInteger,
      .help = "Sets the shadow group that casts shadows on the surfaces, where 0 receives none",
      .details = "With 1 the surfaces receive the shadows of all groups above 0. With a larger N they receive those of "
                 "1, N and −N. With a negative N they receive those of N and −N only.",
      .since = "q3map2",
      .example = "2"},
     1},
    {{.name = "_lightmapsamplesize",
      .aliases = {"_samplesize", "_ss"},
      .values = "N",
      .kind = Integer,
      .unit = "game units",
      .initial = "-samplesize",
      .range = {0, kMaxLuxel},
      .help = "Sets the size of a luxel, unless the shader has q3map_lightmapSampleSize",
      .since = "q3map2",
      .example = "8"}},
    {{.name = "lightmapscale",
      .aliases = {"_lightmapscale", "_ls"},
      .values = "F",
      .kind = Number,
      .initial = "1",
      .range = {0, kMaxSetting},
      .help = "Multiplies the size of a luxel",
      .details = "It also multiplies the size that a shader sets.",
      .since = "q3map2",
      .example = "0.5"}},
    {{.name = "_shadeangle",
      .aliases = {"_smoothnormals", "_sn", "_sa", "_smooth"},
      .values = "F",
      .kind = Number,
      .unit = "degrees",
      .range = {0, 360},
      .help = "Smooths normals across edges that are flatter than this angle",
      .details = "The directive `q3map_shadeAngle` of a shader overrides it.",
      .since = "q3map2",
      .example = "60"}},
    {{.name = "_celshader",
      .values = "NAME",
      .kind = Text,
      .initial = "-celshader",
      .help = "Outlines the surfaces by a copy with the shader textures/NAME",
      .since = "q3map2",
      .example = "cel/black"}},
    {{.name = "_patchMeta",
      .aliases = {"patchMeta"},
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "With 1, turns patches into triangle surfaces, as -patchmeta does",
      .since = "q3map2",
      .example = "1"}},
    {{.name = "_patchSubdivide",
      .aliases = {"patchSubdivide"},
      .values = "N",
      .kind = Integer,
      .initial = "-subdivisions",
      .range = kAnyInteger,
      .help = "Sets the tolerance with which these patches become triangles, where smaller is finer",
      .since = "q3map2",
      .example = "4"}},
    {{.name = "_patchQuality",
      .aliases = {"patchQuality"},
      .values = "N",
      .kind = Integer,
      .initial = "1",
      .range = kAnyInteger,
      .help = "Divides the tolerance of _patchSubdivide or -subdivisions, so a larger number is finer",
      .since = "q3map2",
      .example = "2"}}};
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
      .help = "With 1, compiles a map that leaks as if it did not",
      .details = "Writes `x.prt` and no `x.lin`.",
      .since = "q3map2",
      .example = "1"}},
    {{.name = "_blocksize",
      .aliases = {"blocksize", "chopsize"},
      .values = "X [Y] [Z]",
      .kind = Number,
      .unit = "game units",
      .initial = "1024",
      .range = {0, 4 * kMaxSetting},
      .help = "Sets the size of the blocks into which the tree cuts the map first, where 0 cuts none",
      .details = "With fewer than three numbers, the first counts for all axes.",
      .since = "q3map2",
      .example = "2048"}},
    {{.name = "_keepModels",
      .values = "0|1",
      .kind = Flag,
      .initial = "0",
      .help = "With 1, keeps misc_model entities in the .bsp, as -keepmodels does",
      .since = "q3map2",
      .example = "1"}},
    {{.name = "_fog",
      .aliases = {"fog"},
      .values = "SHADER",
      .kind = Text,
      .initial = "none",
      .help = "Fills the whole map with the fog of that shader",
      .since = "q3map2",
      .example = "textures/mymap/fog"}},
    {{.name = "_foghull",
      .values = "SHADER",
      .kind = Text,
      .initial = "none",
      .help = "Draws the sky shader textures/SHADER around a map in fog",
      .since = "q3map2",
      .example = "mymap/fogsky"}},
    {{.name = "_farplanedist",
      .aliases = {"fogclip", "distancecull"},
      .values = "N",
      .kind = Text,
      .unit = "game units",
      .initial = "none",
      .help = "Sets the distance beyond which vis hides everything, except through sky portals",
      .details = "A letter after the number chooses how two portals are compared with it. L is the distance of their "
                 "centers, and R₁ and R₂ are their radii. Without a letter they are hidden from each other if L − R₁ − "
                 "R₂ is over the distance. With `o` they are hidden if L is over it, with `e` if L + R₁ + R₂ is over "
                 "twice the distance, and with `r` if R₁ + R₂ is over it.",
      .since = "q3map2",
      .example = "4096"}}};
inline constexpr const EntityKey &kIgnoreLeaks = Key(kWorldKeys, "_ignoreleaks");
inline constexpr const EntityKey &kBlockSize = Key(kWorldKeys, "_blocksize");
inline constexpr const EntityKey &kKeepModels = Key(kWorldKeys, "_keepModels");
inline constexpr const EntityKey &kFog = Key(kWorldKeys, "_fog");
inline constexpr const EntityKey &kFogHull = Key(kWorldKeys, "_foghull");
inline constexpr const EntityKey &kFarPlaneDist = Key(kWorldKeys, "_farplanedist");

} // namespace q3::keys
