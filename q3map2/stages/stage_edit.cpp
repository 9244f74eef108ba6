// GPL-2.0-or-later. q3map2 -scale, -shift, -mergebsp and -fixaas.
#include "common/error.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/edit/merge_maps.h"
#include "q3map2/edit/scale_shift.h"
#include "q3map2/report/run_report.h"
#include "q3map2/stages/stages.h"
#include "q3map2/stages/written_map.h"

#include <algorithm>

namespace q3 {

namespace {

Bsp Load(const std::filesystem::path &path, const StageContext &context) {
    context.log.Print("Loading {}\n", path.string());
    return ReadBspFile(path, context.options.Format(), context.log);
}

/// maps/x.bsp as maps/x_END.bsp.
std::filesystem::path PathBeside(std::filesystem::path source, std::string_view end) {
    return source.replace_filename(source.stem().string() + std::string(end) + ".bsp");
}

/// Guards the files of a stage that makes one map from `sources` and writes it beside the first.
FileGuard GuardEdit(const std::vector<std::filesystem::path> &sources, std::string_view end,
                    const StageContext &context) {
    FileGuard guard(context);
    std::uint64_t bytes = 0;
    for (const auto &source : sources) {
        guard.Needs(source);
        bytes += SizeOfFile(source);
    }
    guard.Writes(PathBeside(sources.front(), end), bytes);
    return guard;
}

/// Writes maps/x.bsp as maps/x_END.bsp, with the command in its record.
void WriteBeside(const std::filesystem::path &source, std::string_view end, Bsp bsp,
                 const std::vector<std::string> &recorded, const FileGuard &guard, const StageContext &context) {
    const auto path = PathBeside(source, end);
    guard.CheckUnchanged();
    RecordCommand(bsp, context.stage.word, source.string(), recorded);
    const BotCheck bots(path, context.log);
    WriteBspFile(path, bsp, FormatOfMap(bsp, source, context.options), context.log);
    WarnOfEngineLimits(path, bsp, *context.options.game, context.log);
    bots.Report(BotCheck::OtherGeometry, BotCheck::OnlyWarn);
}

/// Reads the map, applies `edit` to it and writes it beside the original, with `end` appended to its name.
template <typename Edit>
void EditMap(const StageContext &context, const StageFile &file, std::string_view end, const Edit &edit) {
    const auto path = ExistingBsp(file.file);
    const FileGuard guard = GuardEdit({path}, end, context);
    Bsp bsp = Load(path, context);
    edit(bsp, path.string());
    WriteBeside(path, end, std::move(bsp), file.wordsToRecord, guard, context);
}

} // namespace

int ScaleStage(const StageContext &context, Arguments arguments) {
    const std::vector<std::string> given = arguments.Rest();
    ScaleOptions options;
    context.log.Section("Scale");
    TakeSettings(ScaleSettings(), options, arguments, context.log);
    options.factors = TakeAxisValues(arguments, context.stage.word);
    if (options.factors == Vec3d{1, 1, 1})
        throw Error("-scale: all factors are 1, which changes nothing");
    EditMap(context, TakeFile(context, arguments, given), "_s",
            [&](Bsp &bsp, const std::string &name) { ScaleMap(bsp, options, name, context.log); });
    return 0;
}

int ShiftStage(const StageContext &context, Arguments arguments) {
    const std::vector<std::string> given = arguments.Rest();
    context.log.Section("Shift");
    const Vec3d shift = TakeAxisValues(arguments, context.stage.word);
    EditMap(context, TakeFile(context, arguments, given), "_sh",
            [&](Bsp &bsp, const std::string &name) { ShiftMap(bsp, shift, name, context.log); });
    return 0;
}

int MergeStage(const StageContext &context, Arguments arguments) {
    std::vector<std::string> recorded = arguments.Rest();
    MergeOptions options;
    context.log.Section("Merge");
    TakeSettings(MergeSettings(), options, arguments, context.log);
    const std::vector<std::string> files = TakeFiles(context, arguments);
    if (files.size() != 2)
        throw Error("usage: q3map2 {}", context.stage.usage);
    std::erase_if(recorded, [&](const std::string &word) { return std::ranges::find(files, word) != files.end(); });
    const auto mainPath = ExistingBsp(files[0]), addedPath = ExistingBsp(files[1]);
    const FileGuard guard = GuardEdit({mainPath, addedPath}, "_merged", context);
    const Bsp added = Load(addedPath, context), main = Load(mainPath, context);
    const std::string mainName = mainPath.string(), addedName = addedPath.string();
    Bsp merged = MergeMaps({main, mainName}, {added, addedName}, options, context.log);
    WriteBeside(mainPath, "_merged", std::move(merged), recorded, guard, context);
    return 0;
}

int FixAasStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const auto path = ExistingBsp(TakeFile(context, arguments, {}).file);
    log.Section("FixAAS");
    const std::vector<BotFile> files = FindBotFiles(path);
    if (files.empty())
        throw Error("{}: no bot file next to it; expected {}, or the same with _b0 or _b1 after the name",
                    path.string(), WithExtension(path, ".aas").string());
    FileGuard guard(context);
    guard.Needs(path);
    for (const BotFile &file : files) {
        guard.Reads(file.path);
        guard.Writes(file.path, SizeOfFile(file.path));
    }
    const std::uint32_t checksum = MapChecksum(path);
    guard.CheckUnchanged();
    log.Print("{}: checksum {:08x}\n", path.string(), checksum);
    for (const BotFile &file : files) {
        if (file.checksum == checksum) {
            log.Print("{} fits already\n", file.path.string());
            continue;
        }
        SetChecksum(file, checksum);
        log.Print("{}: checksum was {:08x}, is {:08x}\n", file.path.string(), file.checksum, checksum);
    }
    return 0;
}

} // namespace q3
