// GPL-2.0-or-later. What the stages share that light a map or explain its light: the files beside it, the options of a
// light run, light that relighting loses, and the size of SH grids.
#include "q3map2/stages/light_files.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/prop_light.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/light/options/light_options.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace q3 {

// ---- Optional files beside a .bsp that the light stage reads ----

LightInputs ReadLightInputs(const MapFiles &files, Log &log) {
    LightInputs inputs;
    inputs.name = files.bsp.stem().string();
    const auto recovered = WithExtension(files.bsp, kRecoveredLights);
    for (const auto &path : {files.map, recovered})
        if (!inputs.mapEntities && std::filesystem::exists(path)) {
            log.Print("Loading {}\n", path.string());
            inputs.mapEntities = ParseMapEntities(ReadTextFile(path), path.string());
        }
    if (std::filesystem::exists(files.srf)) {
        log.Print("Loading {}\n", files.srf.string());
        inputs.surfaceFile = ReadTextFile(files.srf);
    }
    return inputs;
}

void WarnOfLuxelSizes(const std::vector<std::string> &given, const LightInputs &inputs, Arguments &arguments,
                      Log &log) {
    if (inputs.surfaceFile.empty())
        return;
    constexpr std::string_view kWord = "sampleSize "; // the first one is that of the block "default"
    constexpr std::size_t kNumberChars = 16;          // more than a number has
    const std::size_t at = inputs.surfaceFile.find(kWord);
    const std::string usual =
        at == std::string::npos
            ? std::string()
            : fmt::format(" ({} unless a shader or key says otherwise)",
                          IntegerFromText(inputs.surfaceFile.substr(at + kWord.size(), kNumberChars)));
    for (const std::string_view option : {"-samplesize", "-minsamplesize"}) {
        const std::string value = LastValueOf(option, given);
        if (value.empty())
            continue;
        arguments.DropChange(option);
        log.Warn("luxel size without effect",
                 "{} {} has no effect: {}.srf, which the bsp stage wrote, sets the luxel sizes{}; give {} {} "
                 "to the bsp stage, or use -samplescale here",
                 option, value, inputs.name, usual, option, value);
    }
}

TexLights ReadTexLights(const MapFiles &files, const VirtualFileSystem &vfs, const LightRun &run, bool recovers,
                        Log &log) {
    TexLights lights;
    const auto read = [&](std::string_view text, const std::string &name, const std::string &location) {
        log.Print("Loading {}\n", location);
        lights.Read(text, name, run.lightmap.hdr, log);
    };
    // False: no such file among those of the game.
    const auto readFromGame = [&](const std::string &name) {
        const auto bytes = vfs.Read(name);
        if (bytes)
            read(AsText(*bytes), name, vfs.Location(name));
        return bytes.has_value();
    };
    readFromGame("lights.rad");
    for (const std::string &name : run.options.texLightFiles)
        if (std::filesystem::exists(name))
            read(ReadTextFile(name), name, name);
        else if (!readFromGame(name))
            throw Error("-lights {}: no such file, neither by its path nor among the game's files", name);
    for (const auto &path : {files.rad, WithExtension(files.bsp, kRecoveredSources)})
        if (std::filesystem::exists(path) && !(recovers && path != files.rad))
            read(ReadTextFile(path), path.filename().string(), path.string());
    return lights;
}

// ---- Light grids in the formats of -gridformats: after a bake, and their files ----

GridFormats TakeGridFormats(LightOptions &options) {
    if (options.gridFormats.empty())
        return {};
    std::string list = options.gridFormats;
    const std::string_view stored = options.shBspx ? "shbspx" : "sh";
    const GridFormats named = ParseGridFormats(list);
    const auto same = [&](const GridFormat *format) { return format->word == stored; };
    const bool namesStored =
        std::ranges::any_of(named, same) || (!options.shBspx && HasPlace(named, GridPlace::Uniform));
    const bool keepRadiance = options.shRadiance && !options.shAdaptive && !AnyConvertible(named);
    if ((options.keepSH || keepRadiance) && !namesStored)
        list += fmt::format(",{}", stored);
    if (options.shAdaptive && !HasPlace(named, GridPlace::Sparse))
        list += ",sparse";
    const GridFormats formats = ParseGridFormats(list);
    if (!options.previewFile.empty() && !AnyConvertible(formats))
        throw Error("-shpreview needs sh, shbspx or sparse in -gridformats");
    options.shAdaptive |= HasPlace(formats, GridPlace::Sparse);
    options.noGrid |= AnyWritesLegacyGrid(formats);
    return formats;
}

void StoreBakedGrids(const GridFormats &formats, const LightOptions &options, const std::filesystem::path &folder,
                     Bsp &bsp, const JobPool &jobs, FileSet &written, Log &log) {
    if (formats.empty()) {
        DropGridLumps(bsp);
        AddGridFiles(folder, {}, written, log);
        return;
    }
    log.Section("Light grid formats");
    // Factors that are not above 0 count as 1.
    const GridStoring storing{.ambientFactor = options.gridAmbientScale > 0 ? double(options.gridAmbientScale) : 1};
    AddGridFiles(folder, StoreGridFormats(bsp, formats, storing, jobs, log), written, log);
}

void AddGridFiles(const std::filesystem::path &folder, const std::vector<GridFile> &files, FileSet &written, Log &log) {
    const auto isRaw = [](const GridFile &file) { return file.name == kRawGridFile; };
    const std::filesystem::path raw = folder / kRawGridFile;
    if (std::ranges::none_of(files, isRaw) && std::filesystem::exists(raw))
        log.Warn("raw light grid", "{} is of an earlier run: engines that read it show the light of that run",
                 raw.string());
    for (const GridFile &file : files) {
        written.AddFolder(folder);
        const std::filesystem::path path = folder / file.name;
        written.AddFile(path, file.bytes);
        written.AddLine(log, fmt::format("Wrote {} ({} bytes)\n", path.string(), file.bytes.size()));
    }
}

// ---- Light that relighting a map loses ----

namespace {

/// Mean over the points of the legacy grid of ambient plus directed light, summed over channels; 8-bit levels.
double MeanLight(const Bsp &bsp) {
    std::uint64_t sum = 0;
    for (const bspGridPoint_t &point : bsp.gridPoints)
        for (std::size_t channel = 0; channel < 3; ++channel)
            sum += point.ambient[0][channel] + unsigned(point.directed[0][channel]);
    return bsp.gridPoints.empty() ? 0 : double(sum) / double(bsp.gridPoints.size());
}

/// The settings of a run that decide which light it makes.
struct BakeSettings {
    const LightOptions &options;
    const LightmapOptions &lightmap;
    const GridFormats &formats;
};

/// A lump that is lost by a bake that makes it stale (BspxRow::staleAfter) and does not make it again.
struct LostLump {
    BspxId id;
    std::string_view kind;   ///< of the warning
    std::string_view what;   ///< for messages
    std::string_view option; ///< makes it again
    bool (*isMadeAgain)(const BakeSettings &run);
};

constexpr LostLump kLostLumps[] = {
    {BspxId::LightGridSH, "SH grid dropped", "SH light grid", "-shbspx",
     [](const BakeSettings &run) {
         return run.formats.empty() ? run.options.sh : HasPlace(run.formats, GridPlace::Uniform);
     }},
    {BspxId::SparseGridSH, "sparse SH grid dropped", "sparse SH light grid", "-shadaptive",
     [](const BakeSettings &run) { return run.options.shAdaptive && !run.options.shLights; }},
    {BspxId::NamedGridSH, "SH grid with lights dropped", "SH light grid that names lights", "-shlights",
     [](const BakeSettings &run) { return run.options.shLights; }},
    {BspxId::AmbientCubes, "ambient cubes dropped", kBspxAmbientCubes, "-ambientcubes",
     [](const BakeSettings &run) { return run.options.ambientCubes; }},
    {BspxId::LightmapsE5bgr9, "HDR lightmaps dropped", kBspxLightmapsE5bgr9, "-both",
     [](const BakeSettings &run) { return run.lightmap.hdr && !run.lightmap.external; }},
    {BspxId::VertexE5bgr9, "HDR vertex light dropped", kBspxVertexE5bgr9, "-both",
     [](const BakeSettings &run) { return run.lightmap.hdr; }},
    {BspxId::Rnm, "basis maps dropped", kBspxRnm, "-rnm", [](const BakeSettings &run) { return run.lightmap.rnm; }},
    {BspxId::PropLight, "prop light dropped", kBspxPropLight, "-staticproplighting",
     [](const BakeSettings &run) { return run.options.staticPropLighting; }},
};
static_assert(HasRowOfEachLump(kLostLumps));

/// A light grid for another engine, which -gridformats makes.
struct LostGrid {
    std::string_view lump;
    std::string_view kind; ///< of the warning
    GridPlace place;
    std::string_view option; ///< makes it again
};

constexpr LostGrid kLostGrids[] = {
    {kBspxGridOctree, "octree grid dropped", GridPlace::OctreeLump, "-gridformats octree"},
    {kBspxGrids, "light grids dropped", GridPlace::GridsLump, "-gridformats grids"},
};

} // namespace

LostLightCheck::LostLightCheck(const Bsp &bsp) : before_(MeanLight(bsp)) {}

void LostLightCheck::Report(const Bsp &bsp, bool recovered, bool force, Log &log) const {
    const double after = MeanLight(bsp);
    const bool lostAThird = 3 * after < 2 * before_, lostHalf = 2 * after < before_;
    if ((!recovered && log.WarningTotals().count("no light entities") == 0) || !lostAThird)
        return;
    const std::string text = fmt::format(
        "the light grid has {:.0f} % of the light that it had: {}", after * 100 / before_,
        recovered ? "the lamps that were found do not explain its light; keep the map as it was"
                  : "the map was lit by light entities, which its .bsp does not have; put its .map next to it, find "
                    "its lamps with -recoverlights, or keep the map as it was");
    if (lostHalf && !force)
        throw Error("{}. Nothing is written; -force writes the map anyway", text);
    log.Warn("light entities lost", "{}", text);
    log.AddToSummary(text);
}

void WarnOfDroppedLight(const Bsp &bsp, const LightOptions &options, const LightmapOptions &lightmap,
                        const GridFormats &formats, Log &log) {
    const auto warn = [&log](std::string_view kind, std::string_view what, std::uint64_t bytes,
                             std::string_view option) {
        log.Warn(kind,
                 "the {} of the map ({}) will be dropped: this run does not make a new one, and the old one would not "
                 "match the new light; {} makes one",
                 what, SizeText(bytes), option);
    };
    for (const LostLump &lost : kLostLumps) {
        const BspxRow &row = RowOf(lost.id);
        if (row.has(bsp) && MakesStale(row.staleAfter, lightmap.onlyGrid) &&
            !lost.isMadeAgain({options, lightmap, formats}))
            warn(lost.kind, lost.what, BytesOfLump(bsp, lost.id), IsInBspx(bsp, row) ? lost.option : "-sh");
    }
    for (const BspxLump &lump : bsp.bspx) {
        const auto lost = std::ranges::find(kLostGrids, lump.name, &LostGrid::lump);
        if (lost != std::end(kLostGrids) && !lump.data.empty() && !HasPlace(formats, lost->place))
            warn(lost->kind, lost->lump, lump.data.size(), lost->option);
    }
}

// ---- Size of the SH grids in a .bsp, plain and zipped ----

namespace {

/// EstimateDeflated packs up to kMaxPieces pieces of kPieceBytes, twice what deflate looks back on.
constexpr std::size_t kPieceBytes = std::size_t(1) << 16, kMaxPieces = 16;
/// Grids up to this size never give a warning, however small the rest of the file is. Bytes.
constexpr std::uint64_t kSmallGrid = 1000000;

std::size_t DeflatedSize(std::span<const std::byte> data) {
    uLongf size = compressBound(uLong(data.size()));
    std::vector<Bytef> packed(size);
    compress(packed.data(), &size, reinterpret_cast<const Bytef *>(data.data()), uLong(data.size()));
    return size;
}

/// A cell with about twice the volume and the same proportions, in multiples of 8 game units like the grids of maps; in
/// whole units where it is small.
std::array<int, 3> CellForHalfThePoints(const Float3 &cell) {
    constexpr double kStep = 8, kLeastStepped = 32;
    std::array<int, 3> wider{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double size = double(cell[axis]) * std::cbrt(2.0), step = size < kLeastStepped ? 1 : kStep;
        wider[axis] = int(std::lround(size / step) * std::lround(step));
    }
    return wider;
}

} // namespace

std::uint64_t EstimateDeflated(std::span<const std::byte> data, const JobPool &jobs) {
    const std::size_t pieces = (data.size() + kPieceBytes - 1) / kPieceBytes, used = std::min(pieces, kMaxPieces);
    const auto pieceOf = [&](std::size_t i) {
        const std::size_t first = i * pieces / used * kPieceBytes;
        return data.subspan(first, std::min(kPieceBytes, data.size() - first));
    };
    std::vector<std::size_t> sizes(used);
    jobs.For(std::int64_t(used),
             [&](std::int64_t i, int) { sizes[std::size_t(i)] = DeflatedSize(pieceOf(std::size_t(i))); });
    std::uint64_t sampled = 0, packed = 0;
    for (std::size_t i = 0; i < used; ++i)
        sampled += pieceOf(i).size(), packed += sizes[i];
    return sampled == 0 ? 0 : packed * data.size() / sampled;
}

void PrintGridSHSize(const Bsp &bsp, std::uint64_t fileBytes, const JobPool &jobs, Log &log) {
    if (bsp.sparseGridSH) {
        const std::vector<std::byte> lump = EncodeSparseGrid(*bsp.sparseGridSH);
        log.Print("Sparse SH grid: {}, {} of the file's {}, about {} zipped\n",
                  Counted(bsp.sparseGridSH->points.size(), "points"), SizeText(lump.size()), SizeText(fileBytes),
                  SizeText(EstimateDeflated(lump, jobs)));
    }
    if (!bsp.gridSH)
        return;
    const LightGridSH &grid = *bsp.gridSH;
    const auto points = std::as_bytes(std::span(grid.points));
    const std::uint64_t bytes = sizeof(grid.header) + points.size();
    const std::array<int, 3> cell = CellForHalfThePoints(grid.header.gridSize);
    log.Print("SH grid: {}, {} of the file's {}, about {} zipped; -gridsh {} {} {} would take about half\n",
              Counted(grid.points.size(), "points"), SizeText(bytes), SizeText(fileBytes),
              SizeText(EstimateDeflated(points, jobs)), cell[0], cell[1], cell[2]);
    const Float3 &size = grid.header.gridSize;
    const double relativeSize = double(size[0]) * double(size[1]) * double(size[2]) / std::pow(double(kSmallCellSH), 3);
    if (bytes > kSmallGrid && bytes > fileBytes / 2 && relativeSize < 1)
        log.Warn("large SH grid",
                 "the SH grid is {:.0f} % of the file; -shsmall, without another -gridsh, bakes one of {} of its "
                 "size",
                 100 * double(bytes) / double(fileBytes),
                 relativeSize < 0.01 ? std::string("less than 1 %")
                                     : fmt::format("about {:.0f} %", 100 * relativeSize));
}

// ---- A light run ----

LightRun TakeLightRun(Arguments &arguments, const Game &game, Log &log) {
    LightRun run;
    run.options = ParseLightOptions(arguments, game, log);
    run.gridFormats = TakeGridFormats(run.options);
    run.lightmap = ParseLightmapOptions(arguments, run.options, game, log);
    return run;
}

void DeclareInputs(const MapFiles &files, const LightOptions &options, FileGuard &guard) {
    guard.Needs(files.bsp);
    for (const std::filesystem::path &file : {files.map, WithExtension(files.bsp, kRecoveredLights),
                                              WithExtension(files.bsp, kRecoveredSources), files.srf, files.rad})
        guard.Reads(file);
    for (const std::string &file : options.texLightFiles)
        guard.Reads(file);
}

ShaderLibrary ShadersOfMap(const Bsp &bsp, const LightOptions &options, const VirtualFileSystem &vfs, const Game &game,
                           Log &log) {
    ShaderLibrary library(vfs, game, options.shader, log);
    log.Count(library.DefinedCount(), "shaders defined");
    for (const bspShader_t &shader : bsp.shaders)
        library.SetDefaultFlags(FieldName(shader.shader), shader.surfaceFlags, shader.contentFlags);
    return library;
}

void WithExplainer(const Bsp &bsp, const MapFiles &files, const LightInputs &inputs, const LightRun &run,
                   ShaderLibrary &library, const StageContext &context,
                   const std::function<void(const Explainer &, const JobPool &)> &use) {
    const std::string mapText = std::filesystem::exists(files.map) ? ReadTextFile(files.map) : std::string();
    const JobPool jobs(context.options.threads);
    use(Explainer(bsp, inputs, mapText, files.map.filename().string(), run.options, run.lightmap, library,
                  *context.options.game, jobs, context.log),
        jobs);
}

} // namespace q3
