// GPL-2.0-or-later. q3map2 -json, -info, -shpreview, -convert, -convertgrid, -exportents and -analyze: a map in another
// form.
#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/bspfile/switchable_lights.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/convert/bsp_info.h"
#include "q3map2/convert/convert_options.h"
#include "q3map2/convert/game/format_change.h"
#include "q3map2/convert/game/game_flags.h"
#include "q3map2/convert/json/convert_json.h"
#include "q3map2/convert/mesh/mesh_export.h"
#include "q3map2/convert/preview/grid_preview.h"
#include "q3map2/convert/source/source_from_bsp.h"
#include "q3map2/convert/source/source_writer.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/gridformats/grid_formats.h"
#include "q3map2/map/map_parse.h"
#include "q3map2/report/run_report.h"
#include "q3map2/stages/light_files.h"
#include "q3map2/stages/stages.h"
#include "q3map2/stages/written_map.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace q3 {

// ---- q3map2 -json, -info and -shpreview ----

int JsonStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const JsonOptions options = ParseJsonOptions(arguments, log);
    const std::string file = TakeFile(context, arguments, {}).file;
    const auto bspPath = options.pack ? MapPath(file, ".bsp") : ExistingBsp(file);
    const auto folder = WithExtension(bspPath, "");
    const Game &game = *context.options.game;
    if (!options.pack) {
        log.Section("Unpack to JSON");
        FileGuard guard(context);
        guard.Needs(bspPath);
        guard.WritesInto(folder, SizeOfFile(bspPath) * 2); // assumed: JSON text has twice the bytes
        UnpackJson(ReadBspFile(bspPath, context.options.Format(), log), game, folder, log);
        return 0;
    }
    log.Section("Pack from JSON");
    auto packed = bspPath;
    packed.replace_filename(bspPath.stem().string() + "_json.bsp");
    FileGuard(context).Writes(packed, SizeOfFile(bspPath));
    const Bsp bsp = PackJson(folder, game,
                             {.useFlagNames = options.useFlagNames, .dropUnknownFlags = options.dropUnknownFlags}, log);
    WriteBspFile(packed, bsp, FormatOfMap(bsp, folder, context.options), log);
    WarnOfEngineLimits(packed, bsp, game, log);
    return 0;
}

int InfoStage(const StageContext &context, Arguments arguments) {
    const std::vector<std::string> files = TakeFiles(context, arguments);
    if (files.empty()) {
        constexpr int kNoFilesStatus = 255; // as the manual page says
        context.log.Print("No files to dump info for.\n");
        return kNoFilesStatus;
    }
    for (const std::string &file : files) {
        const auto path = ExistingBsp(file);
        const Bsp bsp = ReadBspFile(path, context.options.Format(), context.log);
        PrintBspInfo(path, bsp, std::filesystem::file_size(path), context.log);
    }
    return 0;
}

int PreviewStage(const StageContext &context, Arguments arguments) {
    const std::vector<std::string> files = TakeFiles(context, arguments);
    if (files.size() != 2)
        throw Error("usage: q3map2 {}", context.stage.usage);
    const auto path = ExistingBsp(files[1]);
    FileGuard guard(context);
    guard.Needs(path);
    guard.Writes(files[0]);
    WriteGridPreview(files[0], ReadBspFile(path, context.options.Format(), context.log), context.log);
    return 0;
}

// ---- q3map2 -convert: a map in another format ----

namespace {

namespace fs = std::filesystem;

/// Input of the functions that write a format.
struct ConvertJob {
    const ConvertOptions &options;
    fs::path input;
    bool isMap; ///< the input is a map source
    const BspContext &context;
    BspFormat bspFormat;
};

enum class FormatKind { Model, Source, Game };

/// `format`: name of the format, which is the extension of models.
fs::path PathOfOutput(const fs::path &input, FormatKind kind, std::string_view format) {
    if (kind == FormatKind::Model)
        return WithExtension(input, fmt::format(".{}", format));
    fs::path output = input;
    return output.replace_filename(input.stem().string() + (kind == FormatKind::Source ? "_converted.map" : "_c.bsp"));
}

std::string ReadText(const fs::path &path, Log &log) {
    log.Print("Loading {}\n", path.string());
    return ReadTextFile(path);
}

/// The input as a .bsp: read, or compiled without vis and light.
Bsp InputBsp(const ConvertJob &job) {
    if (!job.isMap) {
        job.context.log.Print("Loading {}\n", job.input.string());
        return ReadBspFile(job.input, job.bspFormat, job.context.log);
    }
    Map map = ReadMap(ReadText(job.input, job.context.log), job.input.string(), job.context);
    return CompileMap(map, job.context).bsp;
}

void WriteSource(MapForm form, const ConvertJob &job) {
    const std::string name = job.input.string();
    std::string text;
    if (job.isMap) {
        text = ConvertedSource(ReadText(job.input, job.context.log), name, form, job.context);
    } else {
        const DecompileOptions options{.form = form,
                                       .withTextures = !job.options.fast,
                                       .keepModelClip = job.options.keepModelClip,
                                       .markUnknown = job.options.markUnknown};
        text = DecompiledSource(InputBsp(job), name, options, job.context);
    }
    const fs::path output = PathOfOutput(job.input, FormatKind::Source, {});
    job.context.log.Print("Writing {}\n", output.string());
    ReplaceTextFile(output, text);
}

using MeshWriter = void (*)(const Bsp &, ShaderLibrary &, const MeshExportOptions &, const fs::path &, Log &);

void WriteModel(MeshWriter write, std::string_view extension, const ConvertJob &job) {
    const MeshExportOptions options{.shadersAsBitmap = job.options.shadersAsBitmap,
                                    .lightmapsAsTexCoord = job.options.lightmapsAsTexCoord,
                                    .deluxemapsAsTexCoord = job.options.deluxemapsAsTexCoord,
                                    .shaderFolder = job.context.game.shaderDir};
    write(InputBsp(job), job.context.shaders, options, WithExtension(job.input, extension), job.context.log);
}

/// The .bsp for the game that -format names: x_c.bsp.
void WriteForGame(const ConvertJob &job) {
    const Game &game = *FindGame(job.options.format);
    Bsp bsp = InputBsp(job);
    if (bsp.ident != job.context.game.bspIdent)
        throw Error("{}: a map of the format {}: give the game that it is for with -game", job.input.string(),
                    bsp.ident);
    ConvertToGame(bsp, job.context.game, game, job.context.log);
    ChangeFormat(bsp, game.bspIdent, job.context.log);
    const fs::path output = PathOfOutput(job.input, FormatKind::Game, {});
    const BspFormat format{
        .version = game.bspVersion, .advertisements = game.hasAdvertisements, .ident = game.bspIdent};
    WriteBspFile(output, bsp, format, job.context.log);
    WarnOfEngineLimits(output, bsp, game, job.context.log);
}

/// A value of -format.
struct ConvertFormat {
    std::string_view name;
    FormatKind kind;
    void (*write)(const ConvertJob &);
};

/// The first one is the default.
constexpr ConvertFormat kFormats[] = {
    {"ase", FormatKind::Model, [](const ConvertJob &job) { WriteModel(WriteAse, ".ase", job); }},
    {"obj", FormatKind::Model, [](const ConvertJob &job) { WriteModel(WriteObj, ".obj", job); }},
    {"map", FormatKind::Source, [](const ConvertJob &job) { WriteSource(MapForm::Classic, job); }},
    {"map_bp", FormatKind::Source, [](const ConvertJob &job) { WriteSource(MapForm::Primitive, job); }},
    {"map_220", FormatKind::Source, [](const ConvertJob &job) { WriteSource(MapForm::Valve, job); }},
};

std::vector<std::string> FormatNames() {
    std::vector<std::string> names;
    for (const ConvertFormat &format : kFormats)
        names.emplace_back(format.name);
    for (const Game &game : Games())
        names.emplace_back(game.name);
    return names;
}

ConvertFormat FindFormat(std::string_view name) {
    if (name.empty())
        return kFormats[0];
    if (const Game *game = FindGame(name))
        return {game->name, FormatKind::Game, WriteForGame};
    std::string expected;
    for (const ConvertFormat &format : kFormats) {
        if (EqualNoCase(format.name, name))
            return format;
        expected += fmt::format("{}, ", format.name);
    }
    throw Error("-format {}: unknown, expected {}or a game{}", name, expected, DidYouMean(name, FormatNames()));
}

bool ReadsMap(const std::string &file, const ConvertOptions &options, const ConvertFormat &format) {
    const bool isNamedMap = EqualNoCase(fs::path(file).extension().string(), ".map");
    return options.readMap || (format.kind == FormatKind::Source && isNamedMap && !options.readBsp);
}

/// Errors: options that would change nothing.
void RefuseIdleOptions(const ConvertOptions &options, const ConvertFormat &format, bool isMap) {
    const auto refuse = [&](bool given, std::string_view option, std::string_view reason) {
        if (given)
            throw Error("{}: no effect with -format {} {}: {}", option, format.name,
                        isMap ? "from a map source" : "from a .bsp", reason);
    };
    const bool isSource = format.kind == FormatKind::Source, isModel = format.kind == FormatKind::Model;
    if (isMap && format.kind == FormatKind::Game)
        throw Error("-readmap: -format {} converts a .bsp; compile the map with -game {} instead", format.name,
                    format.name);
    constexpr std::string_view kNoFit = "no texture axes are looked for", kNoCompile = "nothing is compiled";
    const bool decompiles = isSource && !isMap, compiles = isModel && isMap;
    refuse(options.fast && !decompiles, "-fast", kNoFit);
    refuse(options.markUnknown && !decompiles, "-wtf", kNoFit);
    refuse(options.keepModelClip && !decompiles, "-modelclip", "there are no brushes that clip models");
    refuse(options.meta && !compiles, "-meta", kNoCompile);
    refuse(options.patchMeta && !compiles, "-patchmeta", kNoCompile);
    constexpr std::string_view kNoMaterials = "there are no materials";
    refuse(options.shadersAsBitmap && !isModel, "-shadersasbitmap", kNoMaterials);
    refuse(options.lightmapsAsTexCoord && !isModel, "-lightmapsastexcoord", kNoMaterials);
    refuse(options.deluxemapsAsTexCoord && !isModel, "-deluxemapsastexcoord", kNoMaterials);
    refuse(options.normalEpsilon && !isMap, "-ne", "no planes are compared");
    refuse(options.distanceEpsilon && !isMap && !isSource, "-de", "no planes are compared");
}

BspOptions CompileOptions(const StageContext &context, const ConvertOptions &options) {
    Arguments none({});
    BspOptions compile = ParseBspOptions(none, *context.options.game, context.log);
    compile.subdivisions = context.options.subdivisions;
    compile.maxDrawSurfaces = context.options.maxDrawSurfaces;
    compile.patchMeta = options.patchMeta;
    compile.meta = options.meta || options.patchMeta;
    compile.normalEpsilon = options.normalEpsilon.value_or(compile.normalEpsilon);
    compile.distanceEpsilon = options.distanceEpsilon.value_or(compile.distanceEpsilon);
    return compile;
}

/// Editors put two blanks between words, and some start programs with an empty word for it.
void DropEmptyWords(Arguments &arguments) {
    for (std::size_t i = 0; i < arguments.Rest().size();)
        if (arguments.Rest()[i].empty())
            arguments.TakeAt(i);
        else
            ++i;
}

} // namespace

std::vector<std::string> ConvertChoices(std::string_view option) {
    return option == "-format" ? FormatNames() : std::vector<std::string>();
}

int ConvertStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    log.Section("Convert");
    DropEmptyWords(arguments);
    const ConvertOptions options = ParseConvertOptions(arguments, log);
    const std::string file = TakeFile(context, arguments, {}).file;
    PrintChangedOptions(arguments, log);
    const ConvertFormat format = FindFormat(options.format);
    const bool isMap = ReadsMap(file, options, format);
    RefuseIdleOptions(options, format, isMap);
    const auto folders = GameFolders(context.options, context.words, context.program);
    const fs::path input = MapPath(file, isMap ? ".map" : ".bsp");
    RequireMap(input, folders);
    FileGuard guard(context);
    guard.Needs(input);
    guard.Writes(PathOfOutput(input, format.kind, format.name), SizeOfFile(input));
    RequireGameFiles(context.options, folders, context.words, log);
    const VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log, context.words);
    const BspOptions compile = CompileOptions(context, options);
    ShaderLibrary library(vfs, *context.options.game, {.sRgbColor = compile.sRgbColor, .imageSizes = true}, log);
    const BspContext bspContext{
        .options = compile, .game = *context.options.game, .shaders = library, .log = log, .vfs = &vfs};
    format.write({.options = options,
                  .input = input,
                  .isMap = isMap,
                  .context = bspContext,
                  .bspFormat = context.options.Format()});
    return 0;
}

// ---- q3map2 -convertgrid ----

int ConvertGridStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const std::vector<std::string> given = arguments.Rest();
    log.Section("Convert light grid");
    const ConvertGridOptions options = ParseConvertGridOptions(arguments, context.options.game->gridAmbientScale, log);
    const StageFile file = TakeFile(context, arguments, given);
    PrintChangedOptions(arguments, log);
    const GridFormats formats = ParseGridFormats(options.formats);
    const auto input = ExistingBsp(file.file);
    const auto output =
        options.output.empty() ? input : WithExtension(std::filesystem::absolute(options.output), ".bsp");
    std::error_code none;
    if (!AnyConvertible(formats) && (output == input || std::filesystem::equivalent(output, input, none)))
        throw Error(
            "-gridformats {}: {} would lose its SH grid: add sh, shbspx or sparse, or name another file with -out",
            options.formats, input.string());

    FileGuard guard(context);
    guard.Needs(input);
    guard.Writes(output, SizeOfFile(input));
    if (HasPlace(formats, GridPlace::RawFile))
        guard.WritesInto(WithExtension(output, ""));
    log.Print("Loading {}\n", input.string());
    Bsp bsp = ReadBspFile(input, context.options.Format(), log);
    const BspFormat format = FormatOfMap(bsp, input, context.options);
    std::vector<GridFile> files;
    try {
        GridStoring storing{.ambientFactor = double(options.ambientFactor)};
        if (options.remakesSparse)
            storing.sparse = options.sparse;
        files = StoreGridFormats(bsp, formats, storing, JobPool(context.options.threads), log);
    } catch (const Error &error) {
        throw Error("{}: {}", input.string(), error.what());
    }
    RecordCommand(bsp, "-convertgrid", input.string(), file.wordsToRecord);
    guard.CheckUnchanged();
    FileSet written;
    AddGridFiles(WithExtension(output, ""), files, written, log);
    const BotCheck bots(output, log);
    AddBspFile(output, bsp, format, written, log);
    written.Commit();
    WarnOfEngineLimits(output, bsp, *context.options.game, log);
    bots.Report(BotCheck::SameGeometry, options.fixBotFiles ? BotCheck::FixFiles : BotCheck::OnlyWarn);
    return 0;
}

// ---- q3map2 -exportents and -analyze ----

int ExportEntitiesStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const auto bspPath = ExistingBsp(TakeFile(context, arguments, {}).file);
    const auto path = WithExtension(bspPath, ".ent");
    FileGuard guard(context);
    guard.Needs(bspPath);
    guard.Writes(path);
    log.Print("Loading {}\n", bspPath.string());
    const Bsp bsp = ReadBspFile(bspPath, context.options.Format(), log);
    std::string text = bsp.entities.substr(0, bsp.entities.find('\0'));
    if (text.empty()) {
        log.Warn("no entities", "{}: the map has no entities to write", bspPath.string());
        return 0;
    }
    if (bsp.ident != kIbspIdent) {
        std::vector<Entity> entities = ParseEntities(text, bspPath.string());
        std::ranges::for_each(entities, RestoreLightStyle);
        text = FormatEntities(entities);
    }
    log.Print("Writing {}\n", path.string());
    ReplaceTextFile(path, text + "\n");
    return 0;
}

int AnalyzeStage(const StageContext &context, Arguments arguments) {
    AnalyzeOptions options;
    TakeSettings(AnalyzeSettings(), options, arguments, context.log);
    std::filesystem::path path = std::filesystem::absolute(TakeFile(context, arguments, {}).file);
    if (!std::filesystem::is_regular_file(path))
        path = ExistingBsp(path.string());
    PrintAnalysis(ReadFile(path), options.lumpSwap, path.string(), context.log);
    return 0;
}

} // namespace q3
