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
    return {"Basics",
            "",
            {{{.name = "-meta",
               .aliases = {"-fastmeta"},
               .help = "Merge brush faces into large triangle surfaces; use it for every playable map",
               .details = "Without it each face is a surface of its own. The shader directive `q3map_forceMeta` merges "
                          "the faces of one shader in any case. Merging is quick, so `-fastmeta` of other compilers "
                          "means the same."},
              &BspOptions::meta},
             {{.name = "-patchmeta",
               .help = "Turn patches into triangle surfaces too; includes -meta",
               .details = "A solid patch stays in the file, undrawn, for collision. The entity keys `_patchMeta`, "
                          "`_patchSubdivide` and `_patchQuality` say the same for one entity."},
              &BspOptions::patchMeta},
             {{.name = "-leaktest",
               .help = "Stop when the map leaks",
               .details = "`x.lin` is written and no other file is replaced. The exit status is 1."},
              &BspOptions::leakTest},
             {{.name = "-onlyents",
               .help = "Replace the entities of an existing .bsp and nothing else",
               .details = "The record of commands and `gridsize` stay. Entities with brushes must keep their order."},
              &BspOptions::onlyEntities},
             {{.name = "-keeplights",
               .initial = "by game, usually off",
               .help = "Keep light entities in the .bsp",
               .details = "Noted for the light stage as the worldspawn key `_keepLights`."},
              &BspOptions::keepLights},
             {{.name = "-keepmodels",
               .help = "Keep misc_model entities in the .bsp",
               .details = "Noted as the worldspawn key `_keepModels`."},
              &BspOptions::keepModels}}};
}

Group LeaveOut() {
    return {"What to leave out",
            "For tests and for fast first compiles.",
            {{{.name = "-nodetail", .help = "Leave out detail brushes"}, &BspOptions::noDetail},
             {{.name = "-fulldetail", .help = "Treat detail brushes as structural"}, &BspOptions::fullDetail},
             {{.name = "-nowater", .help = "Leave out liquids"}, &BspOptions::noWater},
             {{.name = "-nohint", .help = "Leave out hint brushes"}, &BspOptions::noHint},
             {{.name = "-nocurves", .help = "Leave out patches"}, &BspOptions::noCurves},
             {{.name = "-nofog", .help = "Make no fog volumes"}, &BspOptions::noFog},
             {{.name = "-nosubdivide", .help = "Do not cut faces by the shader directive tessSize"},
              &BspOptions::noSubdivide},
             {{.name = "-notjunc", .help = "Do not repair T-junctions; thin cracks show between faces"},
              &BspOptions::noTJunctions}}};
}

Group Surfaces() {
    return {"Surfaces",
            "",
            {{{.name = "-samplesize",
               .values = "N",
               .unit = "game units",
               .range = kSampleSize,
               .help = "Size of a luxel, a texel of the lightmap, where nothing else sets it",
               .details = "Entity keys and shaders can set another size."},
              &BspOptions::sampleSize},
             {{.name = "-minsamplesize",
               .values = "N",
               .unit = "game units",
               .initial = "none",
               .range = kSampleSize,
               .help = "Smallest luxel of any surface"},
              &BspOptions::minSampleSize},
             {{.name = "-mv",
               .values = "N",
               .initial = "by game, usually 64",
               .range = kSurfaceSize,
               .help = "Most vertices of a surface with a lightmap",
               .details = "Other surfaces may have 999, or N if that is more."},
              &BspOptions::maxSurfaceVerts},
             {{.name = "-mi",
               .values = "N",
               .initial = "by game, usually 6000",
               .range = kSurfaceSize,
               .help = "Most indexes of a surface"},
              &BspOptions::maxSurfaceIndexes},
             {{.name = "-np",
               .values = "DEGREES",
               .unit = "degrees",
               .range = {0, 180},
               .help = "Merge faces of different planes, and smooth edges flatter than this",
               .details = "0 turns it off."},
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
           .help = "Score from which -meta merges a triangle into a surface; -1 is the default"},
          &BspOptions::metaAdequateScore},
         {{.name = "-metagoodscore",
           .values = "N",
           .initial = "120200",
           .range = kScore,
           .help = "Score at which -meta stops looking for a better surface; -1 is the default"},
          &BspOptions::metaGoodScore},
         {{.name = "-maxarea", .help = "Triangulate faces into large triangles instead of strips"},
          &BspOptions::maxArea},
         {{.name = "-nobrushsnap", .help = "Do not round vertices to 1/8 game unit"}, Off(&BspOptions::snapVertices)},
         {{.name = "-flares", .initial = "by game, usually off", .help = "Make flare surfaces for lights and shaders"},
          &BspOptions::flares},
         {{.name = "-noflares", .help = "Make no flare surfaces"}, Off(&BspOptions::flares)},
         {{.name = "-skyfix", .help = "Add invisible surfaces that make old drivers load sky images"},
          &BspOptions::skyFix},
         {{.name = "-celshader",
           .values = "NAME",
           .kind = SettingKind::Text,
           .initial = "none",
           .help = "Outline every surface by a copy with the shader textures/NAME",
           .details = "The key `_celshader` of an entity wins."},
          Do<BspOptions>([](BspOptions &o, const SettingValues &v) { o.celShader = "textures/" + v.words[0]; })},
         {{.name = "-flat", .help = "Give all vertices of a surface one texture coordinate"}, &BspOptions::flat}}};
}

Group Tree() {
    return {
        "Planes and tree",
        "",
        {{{.name = "-ne", .values = "F", .range = kEpsilon, .help = "Difference up to which plane normals are equal"},
          &BspOptions::normalEpsilon},
         {{.name = "-de",
           .values = "F",
           .unit = "game units",
           .range = kEpsilon,
           .help = "Difference up to which plane distances are equal"},
          &BspOptions::distanceEpsilon},
         {{.name = "-snap",
           .values = "N",
           .unit = "game units",
           .range = {0, kMaxBevelSnap},
           .help = "Snap the bevel planes of brushes to multiples of N; 0 turns it off"},
          &BspOptions::bevelSnap},
         {{.name = "-deep",
           .help = "Let detail brushes split the tree too, after everything else",
           .details = "Visibility does not change."},
          &BspOptions::deep},
         {{.name = "-altsplit", .help = "Choose splitting planes by other weights"}, &BspOptions::altSplit}}};
}

Group Shaders() {
    return {"Models and shaders",
            "",
            {{{.name = "-clipdepth",
               .values = "F",
               .unit = "game units",
               .help = "Thickness of the clip brushes made for models",
               .details = "The key `_clipdepth` of a model wins. If F is negative, clip brushes with an "
                          "axis-aligned back end -F behind the nearest corner of their triangle, or 1 behind the "
                          "farthest if that is less; other kinds use -F."},
              &BspOptions::clipDepth},
             {{.name = "-rename", .help = "Append _BSP to shader names of models"}, &BspOptions::rename},
             {{.name = "-custinfoparms", .help = "Read more surfaceparms from custinfoparms.txt, beside the shader scripts"},
              &BspOptions::customInfoParms},
             {{.name = "-noob", .help = "Give the surfaceparm noob to every shader without ob"}, &BspOptions::noOb},
             {{.name = "-globalflag",
               .values = "PARM",
               .initial = "none",
               .help = "Give the surface flags of this surfaceparm to every shader; repeatable"},
              &BspOptions::globalFlags},
             {{.name = "-sRGBcolor",
               .initial = "by game, usually off",
               .help = "Colors in shaders (q3map_rgbMod set) are sRGB"},
              &BspOptions::sRgbColor},
             {{.name = "-nosRGBcolor", .aliases = {"-nosRGB"}, .help = "Colors in shaders are linear"},
              Off(&BspOptions::sRgbColor)}}};
}

Group Editors() {
    return {
        "For editors",
        "",
        {{{.name = "-tempname",
           .values = "FILE",
           .initial = "none",
           .help = "Read the map from FILE and delete FILE at the end",
           .details = "Results are named after the map on the command line."},
          &BspOptions::tempName},
         {{.name = "-autocaulk",
           .help = "Write x.caulk, a list of the brush sides that nobody sees, and stop",
           .details = "One line for each brush of the world: its number and a letter for each side that others do not "
                      "cut off: `-` leave, `c` caulk, `w` `s` `l` caulk of water, slime and lava, `n` nodraw, `N` "
                      "solid nodraw."},
          &BspOptions::autoCaulk}}};
}

Group Debugging() {
    return {
        "For debugging",
        "",
        {{{.name = "-debugsurfaces", .help = "Color each surface differently"}, &BspOptions::debugSurfaces},
         {{.name = "-debuginset", .help = "Shrink triangles, so that gaps show between them"}, &BspOptions::debugInset},
         {{.name = "-debugportals", .help = "Draw the portals as surfaces"}, &BspOptions::debugPortals},
         {{.name = "-debugclip",
           .help = "Draw the clip brushes made for models",
           .details = "The sides on the model have the shader `debugclip`, the others `debugclip2`."},
          &BspOptions::debugClip},
         {{.name = "-fakemap", .help = "Write the brushes of the world to fakemap.map in the current folder"},
          &BspOptions::fakeMap},
         {{.name = "-verboseentities", .help = "With -v: print details of brush entities too"},
          &BspOptions::verboseEntities}}};
}

Group Ignored() {
    return {"Accepted without effect",
            "A warning names them.",
            {WithoutEffect(&BspOptions::withoutEffect, "-sRGBtex", "Concerns the light stage only", "-nosRGBtex")}};
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
