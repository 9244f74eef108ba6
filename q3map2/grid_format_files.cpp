// GPL-2.0-or-later. Light grids in the formats of -gridformats: after a bake, and their files.
#include "q3map2/grid_format_files.h"

#include "common/error.h"
#include "common/files/files.h"

#include <algorithm>

namespace q3 {

GridFormats TakeGridFormats(LightOptions &options) {
    if (options.gridFormats.empty())
        return {};
    std::string list = options.gridFormats;
    const std::string_view stored = options.shBspx ? "shbspx" : "sh";
    const GridFormats named = ParseGridFormats(list);
    const auto same = [&](const GridFormat *format) { return format->word == stored; };
    const bool isSaid = std::ranges::any_of(named, same) || (!options.shBspx && HasPlace(named, GridPlace::Full));
    const bool keepRadiance = options.shRadiance && !options.shAdaptive && !KeepSource(named);
    if ((options.keepSH || keepRadiance) && !isSaid)
        list += fmt::format(",{}", stored);
    if (options.shAdaptive && !HasPlace(named, GridPlace::Sparse))
        list += ",sparse";
    const GridFormats formats = ParseGridFormats(list);
    if (!options.previewFile.empty() && !KeepSource(formats))
        throw Error("-shpreview needs sh, shbspx or sparse in -gridformats");
    options.shAdaptive |= HasPlace(formats, GridPlace::Sparse);
    options.noGrid |= ReplaceLegacyGrid(formats);
    return formats;
}

void StoreBakedGrids(const GridFormats &formats, const LightOptions &options, const std::filesystem::path &folder,
                     Bsp &bsp, const JobPool &jobs, Log &log) {
    if (formats.empty()) {
        DropGridLumps(bsp);
        WriteGridFiles(folder, {}, log);
        return;
    }
    log.Section("Light grid formats");
    const GridStoring storing{.ambientFactor = options.gridAmbientScale > 0 ? double(options.gridAmbientScale) : 1};
    WriteGridFiles(folder, StoreGridFormats(bsp, formats, storing, jobs, log), log);
}

void WriteGridFiles(const std::filesystem::path &folder, const std::vector<GridFile> &files, Log &log) {
    const auto isRaw = [](const GridFile &file) { return file.name == kRawGridFile; };
    const std::filesystem::path raw = folder / kRawGridFile;
    if (std::ranges::none_of(files, isRaw) && std::filesystem::exists(raw))
        log.Warn("raw light grid", "{} is of an earlier run: engines that read it show the light of that run",
                 raw.string());
    for (const GridFile &file : files) {
        MakeFolder(folder);
        const std::filesystem::path path = folder / file.name;
        ReplaceFile(path, file.bytes);
        log.Print("Wrote {} ({} bytes)\n", path.string(), file.bytes.size());
    }
}

} // namespace q3
