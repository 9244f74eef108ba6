// GPL-2.0-or-later. From the command line to a stage.
#include "common/error.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/editor_feedback.h"
#include "q3map2/stages.h"

#include <chrono>
#include <memory>
#include <new>

namespace q3 {

namespace {

struct Stage {
    std::string_view name;
    int (*run)(const StageContext &, Arguments);
};
constexpr Stage kStages[] = {{"-bsp", BspStage},       {"-vis", VisStage},          {"-light", LightStage},
                             {"-export", ExportStage}, {"-import", ImportStage},    {"-json", JsonStage},
                             {"-info", InfoStage},     {"-shpreview", PreviewStage}};

/// Names that users of other compilers may give. Without this list they would start the bsp stage, which replaces the
/// map.
constexpr std::string_view kOtherStages[] = {"-analyze", "-convert", "-exportents", "-fixaas", "-mergebsp", "-minimap",
                                             "-pk3",     "-repack",  "-scale",      "-shift",  "-vlight",   "-ent"};

int RunStage(const StageContext &context, Arguments arguments) {
    for (const Stage &stage : kStages)
        if (!arguments.Empty() && EqualNoCase(arguments.Rest().front(), stage.name)) {
            arguments.TakeFirst();
            return stage.run(context, std::move(arguments));
        }
    if (arguments.Empty())
        throw Error("no arguments; q3map2 -help lists what there is");
    for (const std::string_view name : kOtherStages)
        if (EqualNoCase(arguments.Rest().front(), name))
            throw Error(
                "{} is not a stage of this version; it has -bsp, -vis, -light, -export, -import, -json, -info and "
                "-shpreview",
                name);
    return BspStage(context, std::move(arguments));
}

int Run(const std::vector<std::string> &words, const std::filesystem::path &program, Log &log) {
    EditorFeedback::Attach(EditorAddress(words), log); // first: the editor gets errors in options, too
    Arguments arguments(words);
    const GlobalOptions options = ParseGlobalOptions(arguments, log);
    if (options.help) {
        PrintUsage(*options.help, log);
        return 0;
    }
    const auto start = std::chrono::steady_clock::now();
    log.Print("{}\n", kVersion);
    const StageContext context{options, program, arguments.Rest(), log};
    const int status = RunStage(context, std::move(arguments));
    log.FlushWarnings();
    log.Print("{:9.0f} seconds elapsed\n",
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return status;
}

} // namespace

std::filesystem::path WithExtension(const std::filesystem::path &path, std::string_view extension) {
    std::filesystem::path result = path;
    return result.replace_extension(extension);
}

int RunProgram(const std::vector<std::string> &arguments, const std::filesystem::path &program, Log &log) {
    const auto fail = [&](std::string_view text) {
        log.FlushWarnings();
        log.Write(LogLevel::Error, fmt::format("************ ERROR ************\n{}\n", text));
        return 1;
    };
    try {
        return Run(arguments, program, log);
    } catch (const Error &error) {
        return fail(error.what());
    } catch (const std::bad_alloc &) {
        return fail("out of memory");
    } catch (const std::exception &error) {
        return fail(fmt::format("unexpected failure: {}", error.what()));
    }
}

} // namespace q3
