// GPL-2.0-or-later. Bakes of a map, to compare with the reference.
#include "tools/measure/bounce_error/map_bakes.h"

#include "common/error.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "q3map2/lightmap/light_stage.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "tools/measure/directional_error/luxel_bake.h"

#include <sstream>

namespace q3::bounce {

namespace {

std::unique_ptr<ShaderLibrary> LibraryOf(const MeasuredMap &map, const LightOptions &options) {
    auto library = std::make_unique<ShaderLibrary>(map.files, map.game, options.shader, map.log);
    for (const bspShader_t &shader : map.bsp.shaders)
        library->SetDefaultFlags(FieldName(shader.shader), shader.surfaceFlags, shader.contentFlags);
    return library;
}

const bench::LightmapSettings &Checked(const bench::LightmapSettings &settings, MeasuredLight measured) {
    const LightmapOptions &lightmap = settings.lightmap;
    if (lightmap.dirty || lightmap.shade || lightmap.halfLambert || settings.light.floodlight || settings.light.sunOnly)
        throw Error("-dirty, -shade, -lightanglehl, -floodlight and -sunonly: expected none of them, the reference is "
                    "light without");
    if (measured == MeasuredLight::Bounced &&
        (lightmap.super > 1 || lightmap.samples > 1 || lightmap.filter || lightmap.faster))
        throw Error("-super, -samples, -filter and -faster: expected none of them, the reference is light without");
    return settings;
}

} // namespace

MapSetup::MapSetup(const MeasuredMap &map, const bench::LightmapSettings &given, MeasuredLight measured)
    : settings(Checked(given, measured)), library_(LibraryOf(map, given.light)),
      light(map.bsp, map.inputs, given.light, SurfaceDefaultsOf(given.lightmap), *library_, map.log) {
    library_->ReleaseImages(KeptImages::OfReflectors);
}

std::string OptionsWithoutBounces(std::string_view options) {
    std::istringstream words{std::string(options)};
    std::string rest, bounces;
    for (std::string word; words >> word;)
        if (EqualNoCase(word, "-bounce"))
            words >> bounces;
        else
            rest += word + ' ';
    return rest;
}

BakedLuxels BakeLuxels(const MapSetup &map, int bounces, const JobPool &jobs, Log &log, SurfaceLight *surfaces) {
    LightmapOptions options = map.settings.lightmap;
    options.bounces = bounces;
    const directional::LuxelBake bake(map.light, options, jobs, log);
    BakedLuxels baked;
    baked.cpuSeconds = bake.CpuSeconds();
    for (const RawLightmap &raw : bake.Surfaces().lightmaps)
        baked.light.push_back(raw.result[0]);
    if (surfaces)
        *surfaces = bake.Surfaces();
    return baked;
}

BakedGrid BakeGrid(const MeasuredMap &map, bench::LightmapSettings settings, int bounces, const JobPool &jobs) {
    settings.light.sh = settings.light.noGrid = true;
    settings.lightmap.onlyGrid = settings.lightmap.bounceGrid = true;
    settings.lightmap.bounces = bounces;
    BakedGrid baked{map.bsp};
    double start = CpuSeconds(); // of the grid: when its heading is logged
    Log log([&](LogLevel, std::string_view text) {
        if (text.find("--- TraceGridSH ---") != std::string_view::npos)
            start = CpuSeconds();
    });
    const auto library = LibraryOf(map, settings.light);
    LightWorld(baked.bsp, map.inputs, settings.light, settings.lightmap, *library, jobs, log);
    baked.cpuSeconds = CpuSeconds() - start;
    return baked;
}

} // namespace q3::bounce
