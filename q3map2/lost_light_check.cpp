// GPL-2.0-or-later. Light that relighting a map loses.
#include "q3map2/lost_light_check.h"

#include "common/error.h"
#include "common/text/counted.h"
#include "q3map2/bspfile/bspx.h"
#include "q3map2/bspfile/prop_light.h"

#include <algorithm>

namespace q3 {

namespace {

/// Mean over the points of the legacy grid of ambient plus directed light, summed over channels; 8-bit levels.
double MeanLight(const Bsp &bsp) {
    std::uint64_t sum = 0;
    for (const bspGridPoint_t &point : bsp.gridPoints)
        for (std::size_t channel = 0; channel < 3; ++channel)
            sum += point.ambient[channel] + unsigned(point.directed[channel]);
    return bsp.gridPoints.empty() ? 0 : double(sum) / double(bsp.gridPoints.size());
}

std::uint64_t BytesOfLump(const Bsp &bsp, std::string_view name) {
    const auto found = std::ranges::find(bsp.bspx, name, &BspxLump::name);
    return found == bsp.bspx.end() ? 0 : found->data.size();
}

/// A lump of light in a .bsp.
struct LightLump {
    std::string_view kind;   ///< of the warning
    std::string_view what;   ///< for messages
    std::uint64_t bytes = 0; ///< 0: the map does not have it
    bool stays = false;      ///< this run keeps it or makes it again
    std::string_view option; ///< makes it again
};

} // namespace

LostLightCheck::LostLightCheck(const Bsp &bsp) : before_(MeanLight(bsp)) {}

void LostLightCheck::Report(const Bsp &bsp, bool force, Log &log) const {
    const double after = MeanLight(bsp);
    if (log.WarningTotals().count("no light entities") == 0 || after * 3 >= before_ * 2)
        return;
    const std::string text = fmt::format(
        "the light grid has {:.0f} % of the light that it had: the map was lit by light entities, which its .bsp "
        "does not have; put its .map beside it, or keep the map as it was",
        after * 100 / before_);
    if (after * 2 < before_ && !force)
        throw Error("{}. Nothing is written; -force writes the map anyway", text);
    log.Warn("light entities lost", "{}", text);
    log.Repeat(text);
}

void WarnOfDroppedLight(const Bsp &bsp, const LightOptions &options, const LightmapOptions &lightmap,
                        const GridFormats &formats, Log &log) {
    const bool isInLump = bsp.gridSHContainer == GridSHContainer::Lump;
    const bool keepsFull = formats.empty() ? options.sh : HasPlace(formats, GridPlace::Full);
    const bool keepsVertices = lightmap.onlyGrid || lightmap.hdr, keepsRnm = lightmap.onlyGrid || lightmap.rnm;
    const bool keepsPages = lightmap.onlyGrid || (lightmap.hdr && !lightmap.external);
    const bool keepsProps = lightmap.onlyGrid || options.staticPropLighting;
    const LightLump lumps[] = {
        {"SH grid dropped", "SH light grid",
         bsp.gridSH ? sizeof bsp.gridSH->header + BytesOfRecords(bsp.gridSH->points) : 0, keepsFull,
         isInLump ? "-sh" : "-shbspx"},
        {"sparse SH grid dropped", "sparse SH light grid",
         bsp.sparseGridSH ? std::uint64_t(EncodeSparseGrid(*bsp.sparseGridSH).size()) : 0, options.shAdaptive,
         "-shadaptive"},
        {"octree grid dropped", kBspxGridOctree, BytesOfLump(bsp, kBspxGridOctree),
         HasPlace(formats, GridPlace::OctreeLump), "-gridformats octree"},
        {"light grids dropped", kBspxGrids, BytesOfLump(bsp, kBspxGrids), HasPlace(formats, GridPlace::GridsLump),
         "-gridformats grids"},
        {"ambient cubes dropped", kBspxAmbientCubes,
         bsp.ambientCubes ? BytesOfRecords(bsp.ambientCubes->leafs) + BytesOfRecords(bsp.ambientCubes->samples) : 0,
         options.ambientCubes, "-ambientcubes"},
        {"HDR lightmaps dropped", kBspxLightmapsE5bgr9, BytesOfRecords(bsp.lightmapsE5bgr9), keepsPages, "-both"},
        {"HDR vertex light dropped", kBspxVertexE5bgr9, BytesOfRecords(bsp.vertexE5bgr9), keepsVertices, "-both"},
        {"basis maps dropped", kBspxRnm, bsp.rnm ? BytesOfRnm(*bsp.rnm) : 0, keepsRnm, "-rnm"},
        {"prop light dropped", kBspxPropLight, BytesOfLump(bsp, kBspxPropLight), keepsProps, "-staticproplighting"},
    };
    for (const LightLump &lump : lumps)
        if (lump.bytes > 0 && !lump.stays)
            log.Warn(lump.kind,
                     "the {} of the map ({}) will be dropped: this run does not make a new one, and the old one would "
                     "not match the new light; {} makes one",
                     lump.what, SizeText(lump.bytes), lump.option);
}

} // namespace q3
