// GPL-2.0-or-later. Options of the bsp stage, and the context of its steps: options, game files, log.
#include "q3map2/map/bsp_options.h"

#include "common/error.h"
#include "q3map2/map/map.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace q3 {

// ---- Options taken off the command line ----

BspOptions ParseBspOptions(Arguments &arguments, const Game &game, Log &log) {
    BspOptions o;
    o.keepLights = game.keepLights;
    o.flares = game.flares;
    o.maxSurfaceVerts = game.maxSurfaceVerts;
    o.maxVertexLitVerts = game.maxVertexLitVerts;
    o.maxSurfaceIndexes = game.maxSurfaceIndexes;
    o.sRgbColor = game.sRgbColor;
    TakeSettings(BspSettings(), o, arguments, log);
    o.maxVertexLitVerts = std::max(o.maxVertexLitVerts, o.maxSurfaceVerts);
    o.meta |= o.patchMeta; // only the meta step draws meshes of patches
    WarnWithoutEffect(o.withoutEffect, log);
    return o;
}

// ---- Options declared: name, range, default, help ----

namespace {

using Group = SettingGroup<BspOptions>;

constexpr int kMinSurfaceVerts = 3, kMaxScore = 1 << 30;
constexpr int kMaxBevelSnap = 65536; ///< game units
constexpr SettingRange kSurfaceSize{kMinSurfaceVerts, std::numeric_limits<int>::max()}, kSampleSize{1, kMaxSampleSize};
constexpr SettingRange kScore{-1, kMaxScore};
constexpr SettingRange kEpsilon{.low = 0, .high = 1, .aboveLow = true, .belowHigh = true};

Group Basics() {
    return {
        "Basics",
        "",
        {{{.name = "-meta",
           .aliases = {"-fastmeta"},
           .help = "Merges brush faces into large triangle surfaces",
           .details = "Use it for every playable map. Without it, each face is a surface of its own. The shader "
                      "directive `q3map_forceMeta` merges the faces of one shader in any case. The name `-fastmeta` "
                      "of other compilers means the same, because merging is always quick.",
           .since = "q3map2"},
          &BspOptions::meta},
         {{.name = "-patchmeta",
           .help = "Turns patches into triangle surfaces",
           .details = "Implies `-meta`. A solid patch stays in the file for collision, but is not drawn. The entity "
                      "keys `_patchMeta`, `_patchSubdivide` and `_patchQuality` do the same for one entity.",
           .since = "q3map2"},
          &BspOptions::patchMeta},
         {{.name = "-leaktest",
           .help = "Stops when the map leaks, with exit status 1",
           .details = "The file `x.lin` is written, and no other file is replaced.",
           .since = "q3map2"},
          &BspOptions::leakTest},
         {{.name = "-onlyents",
           .help = "Replaces the entities of an existing .bsp and nothing else",
           .details = "The record of commands and the key `gridsize` stay as they are. Entities with brushes must "
                      "keep their order.",
           .since = "q3map2"},
          &BspOptions::onlyEntities},
         {{.name = "-keeplights",
           .initial = "by game, usually off",
           .help = "Keeps light entities in the .bsp",
           .details = "Writes the worldspawn key `_keepLights` for the light stage.",
           .since = "q3map2"},
          &BspOptions::keepLights},
         {{.name = "-keepmodels",
           .help = "Keeps misc_model entities in the .bsp",
           .details = "Writes the worldspawn key `_keepModels`.",
           .since = "q3map2"},
          &BspOptions::keepModels}}};
}

Group LeaveOut() {
    return {"What to leave out",
            "These options are for tests and for quick first builds.",
            {{{.name = "-nodetail", .help = "Leaves out detail brushes", .since = "q3map2"}, &BspOptions::noDetail},
             {{.name = "-fulldetail", .help = "Treats detail brushes as structural brushes", .since = "q3map2"},
              &BspOptions::fullDetail},
             {{.name = "-nowater", .help = "Leaves out brushes of liquids", .since = "q3map2"}, &BspOptions::noWater},
             {{.name = "-nohint", .help = "Leaves out hint brushes", .since = "q3map2"}, &BspOptions::noHint},
             {{.name = "-nocurves", .help = "Leaves out patches", .since = "q3map2"}, &BspOptions::noCurves},
             {{.name = "-nofog", .help = "Makes no fog volumes", .since = "q3map2"}, &BspOptions::noFog},
             {{.name = "-nosubdivide",
               .help = "Ignores the shader directive tessSize, which cuts faces",
               .since = "q3map2"},
              &BspOptions::noSubdivide},
             {{.name = "-notjunc",
               .help = "Leaves T-junctions as they are, so that thin cracks show between faces",
               .since = "q3map2"},
              &BspOptions::noTJunctions}}};
}

Group Surfaces() {
    return {"Surfaces",
            "",
            {{{.name = "-samplesize",
               .values = "N",
               .unit = "game units",
               .range = kSampleSize,
               .help = "Sets the size of luxels (texels of the lightmap) of surfaces without a size of their own",
               .details = "Entity keys and shaders can give a surface another size. Halving the size quadruples the "
                          "lightmaps.",
               .since = "q3map2",
               .example = "8"},
              &BspOptions::sampleSize},
             {{.name = "-minsamplesize",
               .values = "N",
               .unit = "game units",
               .initial = "none",
               .range = kSampleSize,
               .help = "Sets the smallest luxel size of any surface",
               .since = "q3map2",
               .example = "4"},
              &BspOptions::minSampleSize},
             {{.name = "-mv",
               .values = "N",
               .initial = "by game, usually 64",
               .range = kSurfaceSize,
               .help = "Limits the number of vertices of a surface with a lightmap",
               .details = "Other surfaces can have 999 vertices, or N if that is more.",
               .since = "q3map2",
               .example = "1000"},
              &BspOptions::maxSurfaceVerts},
             {{.name = "-mi",
               .values = "N",
               .initial = "by game, usually 6000",
               .range = kSurfaceSize,
               .help = "Limits the number of indexes of a surface",
               .since = "q3map2",
               .example = "10000"},
              &BspOptions::maxSurfaceIndexes},
             {{.name = "-np",
               .values = "DEGREES",
               .unit = "degrees",
               .range = {0, 180},
               .help = "Merges faces of different planes, and smooths edges that are flatter than this angle",
               .details = "A value of 0 turns it off.",
               .since = "q3map2",
               .example = "60"},
              &BspOptions::nonPlanarAngle}}};
}

Group Merging() {
    return {
        "Merging and special surfaces",
        "",
        {{{.name = "-metaadequatescore",
           .values = "N",
           .initial = "110000",
           .range = kScore,
           .help = "Sets the score from which -meta merges a triangle into a surface",
           .details = "A value of -1 stands for the default.",
           .since = "q3map2",
           .example = "100000"},
          &BspOptions::metaAdequateScore},
         {{.name = "-metagoodscore",
           .values = "N",
           .initial = "120200",
           .range = kScore,
           .help = "Sets the score at which -meta stops looking for a better surface",
           .details = "A value of -1 stands for the default.",
           .since = "q3map2",
           .example = "130000"},
          &BspOptions::metaGoodScore},
         {{.name = "-maxarea",
           .help = "Divides faces into triangles that are as large as possible, instead of strips",
           .since = "q3map2"},
          &BspOptions::maxArea},
         {{.name = "-nobrushsnap", .help = "Does not round vertices to 1/8 game unit", .since = "q3map2"},
          Off(&BspOptions::snapVertices)},
         {{.name = "-flares",
           .initial = "by game, usually off",
           .help = "Makes flare surfaces for lights and shaders",
           .since = "q3map2"},
          &BspOptions::flares},
         {{.name = "-noflares", .help = "Makes no flare surfaces", .since = "q3map2"}, Off(&BspOptions::flares)},
         {{.name = "-skyfix",
           .help = "Adds invisible surfaces that make old drivers load the images of skies",
           .since = "q3map2"},
          &BspOptions::skyFix},
         {{.name = "-celshader",
           .values = "NAME",
           .kind = SettingKind::Text,
           .initial = "none",
           .help = "Outlines every opaque surface by a copy of it with the shader textures/NAME",
           .details = "Skies are left out. The key `_celshader` of an entity overrides it.",
           .since = "q3map2",
           .example = "cel/outline"},
          Do<BspOptions>([](BspOptions &o, const SettingValues &v) { o.celShader = "textures/" + v.words[0]; })},
         {{.name = "-flat", .help = "Gives all vertices of a surface the same texture coordinate", .since = "q3map2"},
          &BspOptions::flat}}};
}

Group Tree() {
    return {"Planes and tree",
            "",
            {{{.name = "-ne",
               .values = "F",
               .range = kEpsilon,
               .help = "Sets the difference up to which the normals of planes count as equal",
               .since = "q3map2",
               .example = "0.0001"},
              &BspOptions::normalEpsilon},
             {{.name = "-de",
               .values = "F",
               .unit = "game units",
               .range = kEpsilon,
               .help = "Sets the difference up to which the distances of planes count as equal",
               .since = "q3map2",
               .example = "0.01"},
              &BspOptions::distanceEpsilon},
             {{.name = "-snap",
               .values = "N",
               .unit = "game units",
               .range = {0, kMaxBevelSnap},
               .help = "Snaps the bevel planes of brushes to multiples of N",
               .details = "A value of 0 turns it off.",
               .since = "q3map2",
               .example = "1"},
              &BspOptions::bevelSnap},
             {{.name = "-deep",
               .help = "Lets detail brushes split the BSP tree too, after all other brushes",
               .details = "Visibility does not change.",
               .since = "q3map2"},
              &BspOptions::deep},
             {{.name = "-altsplit",
               .help = "Chooses the splitting planes of the BSP tree by other weights",
               .since = "q3map2"},
              &BspOptions::altSplit}}};
}

Group Shaders() {
    return {"Models and shaders",
            "",
            {{{.name = "-clipdepth",
               .values = "F",
               .unit = "game units",
               .help = "Sets the thickness of the clip brushes that are made for models",
               .details = "The key `_clipdepth` of a model overrides it. If F is negative, clip brushes with an "
                          "axis-aligned back end -F behind the nearest corner of their triangle, or 1 behind the "
                          "farthest corner if that is less. Clip brushes of other kinds then use -F.",
               .since = "q3map2",
               .example = "4"},
              &BspOptions::clipDepth},
             {{.name = "-rename", .help = "Appends _BSP to the shader names of models", .since = "q3map2"},
              &BspOptions::rename},
             {{.name = "-custinfoparms",
               .help = "Reads more surfaceparms from custinfoparms.txt in the folder of the shader scripts",
               .since = "q3map2"},
              &BspOptions::customInfoParms},
             {{.name = "-noob",
               .help = "Gives the surfaceparm noob to every shader without the surfaceparm ob",
               .since = "q3map2"},
              &BspOptions::noOb},
             {{.name = "-globalflag",
               .values = "PARM",
               .initial = "none",
               .help = "Gives the surface flags of this surfaceparm to every shader",
               .details = "Repeat the option for more surfaceparms.",
               .since = "q3map2",
               .example = "nodamage"},
              &BspOptions::globalFlags},
             {{.name = "-sRGBcolor",
               .initial = "by game, usually off",
               .help = "Takes the colors in shaders (q3map_rgbMod set) as sRGB",
               .since = "q3map2"},
              &BspOptions::sRgbColor},
             {{.name = "-nosRGBcolor",
               .aliases = {"-nosRGB"},
               .help = "Takes the colors in shaders (q3map_rgbMod set) as linear",
               .since = "q3map2"},
              Off(&BspOptions::sRgbColor)}}};
}

Group Editors() {
    return {
        "For editors",
        "",
        {{{.name = "-tempname",
           .values = "FILE",
           .initial = "none",
           .help = "Reads the map from FILE, and deletes FILE at the end",
           .details = "The files that are written have the name of the map on the command line.",
           .since = "q3map2",
           .example = "maps/mymap.tmp"},
          &BspOptions::tempName},
         {{.name = "-autocaulk",
           .help = "Writes x.caulk, a list of the brush sides that nobody sees, and stops",
           .details =
               "The list has one line per brush of the world, with the number of the brush and a letter for each "
               "side that other sides do not cut off. The letters mean leave (`-`), caulk (`c`), water caulk (`w`), "
               "slime caulk (`s`), lava caulk (`l`), nodraw (`n`) and solid nodraw (`N`).",
           .since = "q3map2"},
          &BspOptions::autoCaulk}}};
}

Group Debugging() {
    return {"For debugging",
            "",
            {{{.name = "-debugsurfaces", .help = "Gives each surface a color of its own", .since = "q3map2"},
              &BspOptions::debugSurfaces},
             {{.name = "-debuginset", .help = "Shrinks triangles, so that gaps show between them", .since = "q3map2"},
              &BspOptions::debugInset},
             {{.name = "-debugportals", .help = "Draws the portals as surfaces", .since = "q3map2"},
              &BspOptions::debugPortals},
             {{.name = "-debugclip",
               .help = "Draws the clip brushes that are made for models",
               .details = "Sides on the model have the shader `debugclip`, other sides the shader `debugclip2`.",
               .since = "q3map2"},
              &BspOptions::debugClip},
             {{.name = "-fakemap",
               .help = "Writes the brushes of the world to fakemap.map in the current folder",
               .since = "q3map2"},
              &BspOptions::fakeMap},
             {{.name = "-verboseentities",
               .help = "Prints details of brush entities too, if -v is given",
               .since = "q3map2"},
              &BspOptions::verboseEntities}}};
}

Group Ignored() {
    Setting<BspOptions> textures =
        WithoutEffect(&BspOptions::withoutEffect, "-sRGBtex", "Concerns the light stage only", "-nosRGBtex");
    textures.info.since = "q3map2";
    return {"Accepted without effect", "A warning names these options.", {textures}};
}

} // namespace

std::vector<SettingGroup<BspOptions>> BspSettings() {
    return {Basics(), LeaveOut(), Surfaces(), Merging(), Tree(), Shaders(), Editors(), Debugging(), Ignored()};
}

// ---- Messages of the bsp stage about entities and primitives ----

std::string MapEntity::MessagePrefix() const {
    return location.empty() ? fmt::format("Entity {}", number) : fmt::format("Entity {}: {}", number, location);
}

void MapPlaces::Set(int entity, int primitive, std::string location) {
    const auto e = std::size_t(std::max(entity, 0)), p = std::size_t(std::max(primitive, -1) + 1);
    if (places_.size() <= e)
        places_.resize(e + 1);
    if (places_[e].size() <= p)
        places_[e].resize(p + 1);
    places_[e][p] = std::move(location);
}

std::string_view MapPlaces::Of(int entity, int primitive) const {
    if (entity < 0 || std::size_t(entity) >= places_.size())
        return {};
    const std::vector<std::string> &places = places_[std::size_t(entity)];
    const auto p = std::size_t(std::max(primitive, -1) + 1);
    if (p < places.size() && !places[p].empty())
        return places[p];
    return places.empty() ? std::string_view() : std::string_view(places.front());
}

std::string BspContext::Located(int entity, int primitive, std::string_view text,
                                std::optional<std::string_view> location) const {
    const std::string_view place = location ? *location : places->Of(entity, primitive);
    return fmt::format("Entity {}{}: {}{}{}", entity, primitive < 0 ? "" : fmt::format(", Brush {}", primitive), place,
                       place.empty() ? "" : ": ", text);
}

void BspContext::WarnAt(std::string_view kind, int entity, int primitive, std::string_view text,
                        std::optional<std::string_view> location) const {
    log.WarnAt(kind, {.entity = entity, .primitive = std::max(primitive, 0), .line = {}},
               Located(entity, primitive, text, location));
}

void BspContext::FailAt(int entity, int primitive, std::string_view text,
                        std::optional<std::string_view> location) const {
    const std::string located = Located(entity, primitive, text, location);
    log.Mark(LogLevel::Error, located, {.entity = entity, .primitive = std::max(primitive, 0), .line = {}});
    throw Error("{}", located);
}

} // namespace q3
