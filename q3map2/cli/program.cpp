// GPL-2.0-or-later. From the command line to a stage.
#include "q3map2/cli/program.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/cli/help.h"
#include "q3map2/cli/presets.h"
#include "q3map2/editors/editor_feedback.h"
#include "q3map2/report/run_report.h"
#include "q3map2/report/version.h"

#include <array>
#include <fstream>
#include <memory>
#include <new>

namespace q3 {

namespace {

/// Everything that is printed goes to the file too, without the live progress of terminals.
void AddLogFile(const std::string &path, Log &log) {
    auto file = std::make_shared<std::ofstream>(std::filesystem::path(path), std::ios::binary);
    if (!*file)
        throw Error("-log {}: the file cannot be written", path);
    log.AddSink([file](LogLevel, std::string_view text) { *file << text << std::flush; });
}

/// The words without the quotes that some editors leave around them, and that pasted paths have: plain ones, those of
/// other shells, and typographic ones. A single \" goes too: in "C:\games\" the shell takes the last for a part of the
/// word.
std::vector<std::string> Unquoted(std::vector<std::string> words) {
    struct Quotes {
        std::string_view left, right;
        bool areRemovedSingly; ///< also where only one of them is there
    };
    constexpr std::array<Quotes, 3> kQuotes = {{{.left = "\"", .right = "\"", .areRemovedSingly = true},
                                                {.left = "'", .right = "'", .areRemovedSingly = false},
                                                {.left = "\u201C", .right = "\u201D", .areRemovedSingly = false}}};
    for (std::string &word : words)
        for (const Quotes &quotes : kQuotes) {
            const bool left = word.starts_with(quotes.left), right = word.ends_with(quotes.right);
            const std::size_t length = (left ? quotes.left.size() : 0) + (right ? quotes.right.size() : 0);
            if (length < word.size() && ((left && right) || (quotes.areRemovedSingly && (left || right))))
                word = word.substr(left ? quotes.left.size() : 0, word.size() - length);
        }
    return words;
}

int Run(StageList stages, const std::vector<std::string> &words, const std::filesystem::path &program,
        RunReport &report, Log &log) {
    // First, so that errors in options arrive.
    EditorFeedback::Attach(LastValueOf("-connect", words), log);
    if (const std::string file = LastValueOf("-log", words); !file.empty())
        AddLogFile(file, log);
    Arguments arguments(words);
    const GlobalOptions options = ParseGlobalOptions(arguments, log);
    if (options.help) {
        log.Print("{}", HelpText(stages, *options.help));
        return 0;
    }
    if (options.version) {
        log.Print("{}", VersionText());
        return 0;
    }
    log.Print("{}\n", kVersion);
    const ChosenStage chosen = TakeStage(stages, arguments);
    TranslateVradOptions(chosen.stage, arguments, log);
    ExpandPreset(chosen.stage, arguments, log);
    const StageContext context{options, chosen.stage, stages, chosen.isNamed, program, arguments.Rest(), log, report};
    const int status = chosen.stage.run(context, std::move(arguments));
    log.FlushWarnings();
    report.PrintEnd(status == 0 ? RunEnd::Done : RunEnd::Failed, log);
    return status;
}

} // namespace

int RunProgram(StageList stages, const std::vector<std::string> &given, const std::filesystem::path &program,
               Log &log) {
    const std::vector<std::string> arguments = Unquoted(given);
    RunReport report;
    const std::string reportPath = LastValueOf("-report", arguments);
    ReportFile collected;
    bool reports = !reportPath.empty();
    if (reports)
        log.SetObserver(&collected);
    const auto end = [&](int status, std::string_view error) {
        log.SetObserver(nullptr);
        if (!reports)
            return status;
        try {
            collected.Write(reportPath, arguments, error);
        } catch (const Error &failure) {
            log.Write(LogLevel::Error, fmt::format("-report: {}\n", failure.what()));
            return 1;
        }
        return status;
    };
    const auto fail = [&](std::string_view text) {
        log.FlushWarnings();
        log.Write(LogLevel::Error, fmt::format("************ ERROR ************\n{}\n", text));
        report.PrintEnd(RunEnd::Failed, log);
        return end(1, text);
    };
    if (reports)
        try {
            RequireWritable(reportPath); // fail now, not after hours of computing
        } catch (const Error &error) {
            reports = false;
            return fail(fmt::format("-report: {}", error.what()));
        }
    try {
        const int status = Run(stages, arguments, program, report, log);
        const std::string faults = report.Faults();
        return end(status, status == 0 ? "" : faults.empty() ? "the log says what is wrong" : faults);
    } catch (const Error &error) {
        return fail(error.what());
    } catch (const std::bad_alloc &) {
        return fail("out of memory");
    } catch (const std::exception &error) {
        return fail(fmt::format("unexpected failure: {}", error.what()));
    }
}

} // namespace q3
