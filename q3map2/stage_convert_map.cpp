// GPL-2.0-or-later. q3map2 -convert: a map in another format.
#include "common/error.h"
#include "common/files/files.h"
#include "common/nearest_names.h"
#include "q3map2/convert/convert_options.h"
#include "q3map2/convert/game/game_convert.h"
#include "q3map2/convert/mesh/mesh_export.h"
#include "q3map2/convert/source/source_from_bsp.h"
#include "q3map2/convert/source/source_from_map.h"
#include "q3map2/engine_memory.h"
#include "q3map2/file_guard.h"
#include "q3map2/game_check.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/map/map_parse.h"
#include "q3map2/run_report.h"
#include "q3map2/stage_words.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace q3 {

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
    ConvertToGame(bsp, job.context.game, game, job.context.log);
    const fs::path output = PathOfOutput(job.input, FormatKind::Game, {});
    WriteBspFile(output, bsp, {.version = game.bspVersion, .advertisements = game.hasAdvertisements}, job.context.log);
    WarnOfEngineMemory(output, bsp, game, job.context.log);
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
    throw Error("-format {}: unknown, expected {}or a game{}", name, expected, DidYouMean(name, ConvertFormatNames()));
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

std::vector<std::string> ConvertFormatNames() {
    std::vector<std::string> names;
    for (const ConvertFormat &format : kFormats)
        names.emplace_back(format.name);
    for (const Game &game : Games())
        names.emplace_back(game.name);
    return names;
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
    const fs::path input = WithExtension(fs::absolute(file), isMap ? ".map" : ".bsp");
    FileGuard guard(context);
    guard.Needs(input);
    guard.Writes(PathOfOutput(input, format.kind, format.name), SizeOfFile(input));
    const auto folders = GameFolders(context.options, context.words, context.program);
    const fs::path input = MapPath(file, isMap ? ".map" : ".bsp");
    RequireMap(input, folders);
    RequireGameFiles(context.options, folders, context.words, log);
    const VirtualFileSystem vfs = OpenGameFiles(context.options, folders, log);
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

} // namespace q3
