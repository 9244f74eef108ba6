// GPL-2.0-or-later. Options of the bsp stage.
#include "q3map2/map/bsp_options.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr int kMinSurfaceVerts = 3, kMaxSurfaceVerts = 1 << 20, kMaxSampleSize = 16384;
constexpr int kMaxScore = 1 << 30, kMaxBevelSnap = 65536;

struct Switch {
    std::string_view name;
    bool BspOptions::*field;
    bool value = true;
};
constexpr Switch kSwitches[] = {{"-meta", &BspOptions::meta},
                                {"-patchmeta", &BspOptions::patchMeta},
                                {"-leaktest", &BspOptions::leakTest},
                                {"-onlyents", &BspOptions::onlyEntities},
                                {"-fulldetail", &BspOptions::fullDetail},
                                {"-nodetail", &BspOptions::noDetail},
                                {"-nowater", &BspOptions::noWater},
                                {"-nofog", &BspOptions::noFog},
                                {"-nohint", &BspOptions::noHint},
                                {"-nocurves", &BspOptions::noCurves},
                                {"-nosubdivide", &BspOptions::noSubdivide},
                                {"-notjunc", &BspOptions::noTJunctions},
                                {"-skyfix", &BspOptions::skyFix},
                                {"-flares", &BspOptions::flares},
                                {"-noflares", &BspOptions::flares, false},
                                {"-keeplights", &BspOptions::keepLights},
                                {"-keepmodels", &BspOptions::keepModels},
                                {"-maxarea", &BspOptions::maxArea},
                                {"-nobrushsnap", &BspOptions::snapVertices, false},
                                {"-altsplit", &BspOptions::altSplit},
                                {"-deep", &BspOptions::deep},
                                {"-flat", &BspOptions::flat},
                                {"-noob", &BspOptions::noOb},
                                {"-rename", &BspOptions::rename},
                                {"-custinfoparms", &BspOptions::customInfoParms},
                                {"-autocaulk", &BspOptions::autoCaulk},
                                {"-verboseentities", &BspOptions::verboseEntities},
                                {"-fakemap", &BspOptions::fakeMap},
                                {"-debugsurfaces", &BspOptions::debugSurfaces},
                                {"-debuginset", &BspOptions::debugInset},
                                {"-debugportals", &BspOptions::debugPortals},
                                {"-debugclip", &BspOptions::debugClip}};

void TakeInteger(Arguments &arguments, std::string_view name, int low, int high, int &field) {
    while (const auto value = arguments.TakeValue(name))
        field = std::clamp(IntegerFromText(*value), low, high);
}

void TakeEpsilon(Arguments &arguments, std::string_view name, double &field) {
    while (const auto value = arguments.TakeValue(name)) {
        const double epsilon = NumberFromText(*value);
        if (!(epsilon > 0 && epsilon < 1))
            throw Error("{} {}: expected a number above 0 and below 1", name, *value);
        field = epsilon;
    }
}

} // namespace

BspOptions ParseBspOptions(Arguments &arguments, const Game &game, Log &log) {
    BspOptions o;
    o.keepLights = game.keepLights;
    o.maxSurfaceVerts = game.maxSurfaceVerts;
    o.maxVertexLitVerts = game.maxVertexLitVerts;
    o.maxSurfaceIndexes = game.maxSurfaceIndexes;
    while (const auto name = arguments.TakeValue("-tempname"))
        o.tempName = *name;
    TakeInteger(arguments, "-samplesize", 1, kMaxSampleSize, o.sampleSize);
    TakeInteger(arguments, "-minsamplesize", 1, kMaxSampleSize, o.minSampleSize);
    TakeInteger(arguments, "-mv", kMinSurfaceVerts, kMaxSurfaceVerts, o.maxSurfaceVerts);
    o.maxVertexLitVerts = std::max(o.maxVertexLitVerts, o.maxSurfaceVerts);
    TakeInteger(arguments, "-mi", kMinSurfaceVerts, kMaxSurfaceVerts, o.maxSurfaceIndexes);
    TakeInteger(arguments, "-metaadequatescore", -1, kMaxScore, o.metaAdequateScore);
    TakeInteger(arguments, "-metagoodscore", -1, kMaxScore, o.metaGoodScore);
    TakeInteger(arguments, "-snap", 0, kMaxBevelSnap, o.bevelSnap);
    TakeEpsilon(arguments, "-ne", o.normalEpsilon);
    TakeEpsilon(arguments, "-de", o.distanceEpsilon);
    while (const auto value = arguments.TakeValue("-np"))
        o.nonPlanarAngle = float(std::clamp(NumberFromText(*value), 0.0, 180.0));
    while (const auto value = arguments.TakeValue("-clipdepth"))
        o.clipDepth = NumberFromText(*value);
    while (const auto name = arguments.TakeValue("-celshader"))
        o.celShader = "textures/" + *name;
    while (const auto name = arguments.TakeValue("-globalflag"))
        o.globalFlags.push_back(*name);
    o.sRgbColor = game.sRgbColor;
    if (arguments.TakeFlag("-sRGBcolor"))
        o.sRgbColor = true;
    if (arguments.TakeFlag({"-nosRGBcolor", "-nosRGB"}))
        o.sRgbColor = false;
    if (arguments.TakeFlag({"-sRGBtex", "-nosRGBtex"}))
        log.Warn("options without effect", "-sRGBtex and -nosRGBtex concern the light stage only");
    for (const Switch &one : kSwitches)
        if (arguments.TakeFlag(one.name))
            o.*one.field = one.value;
    o.meta |= o.patchMeta; // meshes of patches are drawn by the meta step alone
    return o;
}

} // namespace q3
