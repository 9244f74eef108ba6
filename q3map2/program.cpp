// GPL-2.0-or-later. From the command line to a stage.
#include "common/error.h"
#include "q3map2/editor_feedback.h"
#include "q3map2/help.h"
#include "q3map2/presets.h"
#include "q3map2/run_report.h"
#include "q3map2/stage_words.h"
#include "q3map2/version.h"

#include <new>

namespace q3 {

namespace {

int Run(const std::vector<std::string> &words, const std::filesystem::path &program, const RunReport &report,
        Log &log) {
    EditorFeedback::Attach(EditorAddress(words), log); // first: the editor gets errors in options, too
    Arguments arguments(words);
    const GlobalOptions options = ParseGlobalOptions(arguments, log);
    if (options.help) {
        log.Print("{}", HelpText(*options.help));
        return 0;
    }
    if (options.version) {
        log.Print("{}", VersionText());
        return 0;
    }
    log.Print("{}\n", kVersion);
    const ChosenStage chosen = TakeStage(arguments);
    ExpandPreset(chosen.stage, arguments, log);
    const StageContext context{options, chosen.stage, chosen.given, program, arguments.Rest(), log};
    const int status = chosen.stage.run(context, std::move(arguments));
    log.FlushWarnings();
    report.PrintEnd(status != 0, log);
    return status;
}

} // namespace

std::filesystem::path WithExtension(const std::filesystem::path &path, std::string_view extension) {
    std::filesystem::path result = path;
    return result.replace_extension(extension);
}

int RunProgram(const std::vector<std::string> &arguments, const std::filesystem::path &program, Log &log) {
    const RunReport report;
    const auto fail = [&](std::string_view text) {
        log.FlushWarnings();
        log.Write(LogLevel::Error, fmt::format("************ ERROR ************\n{}\n", text));
        report.PrintEnd(true, log);
        return 1;
    };
    try {
        return Run(arguments, program, report, log);
    } catch (const Error &error) {
        return fail(error.what());
    } catch (const std::bad_alloc &) {
        return fail("out of memory");
    } catch (const std::exception &error) {
        return fail(fmt::format("unexpected failure: {}", error.what()));
    }
}

} // namespace q3
