// GPL-2.0-or-later. Options of the stages -export and -import.
#include "q3map2/lightmap/store/export_options.h"

namespace q3 {

std::vector<SettingGroup<ExportOptions>> ExportSettings() {
    return {{"HDR light",
             "Of maps with the BSPX lumps `LIGHTING_E5BGR9` or `LIGHTING_RNM` ([bsp_format.md](bsp_format.md)).",
             {{{.name = "-hdrformat",
                .values = "exr|pfm|hdr|exp32|rend2|ioquake3",
                .kind = SettingKind::Choice,
                .initial = "-export: exr, or pfm if built without OpenEXR; -import: each that is there",
                .help = "Format of the images of HDR lightmaps",
                .details = "`exr` and `pfm` hold the values of a map exactly, `hdr` (Radiance) to 1/256 of the largest "
                           "channel. `exp32` is JSON for tools of Source: `width`, `height` and `texels`, a "
                           "`[r, g, b, exponent]` for each luxel, byte * 2^exponent, where 255 is full light; row 0 of "
                           "the page comes first. In the others 1 is full light, and the picture is as upside down as "
                           "that of the `.tga`. `rend2` and `ioquake3` are the files `lm_NNNN.hdr` and `vertlight.raw` "
                           "that OpenJK and ioquake3 load."},
               &ExportOptions::hdrFormat}}}};
}

ExportOptions ParseExportOptions(Arguments &arguments, Log &log) {
    ExportOptions options;
    TakeSettings(ExportSettings(), options, arguments, log);
    return options;
}

} // namespace q3
