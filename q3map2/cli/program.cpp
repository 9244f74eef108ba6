// GPL-2.0-or-later. From the command line to a stage: what a stage is and gets, which one is meant, and its run.
#include "q3map2/cli/program.h"

#include "common/crash_report.h"
#include "common/error.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "q3map2/cli/documentation.h"
#include "q3map2/cli/help.h"
#include "q3map2/cli/presets.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/editors/editor_feedback.h"
#include "q3map2/report/run_report.h"
#include "q3map2/report/version.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <system_error>

namespace q3 {

// ---- The words of a command line that choose a stage, and those that it takes ----

namespace {

/// Stages of other compilers, which are named in an error.
constexpr std::string_view kForeignStages[] = {"-vlight", "-ent"};

const Stage *FindStage(StageList stages, std::string_view word) {
    const auto found = std::ranges::find_if(stages, [&](const Stage &s) { return EqualNoCase(s.word, word); });
    return found == stages.end() ? nullptr : &*found;
}

/// Position of the stage word. A word other than the first is not one if another stage on the line has an option of
/// that name, such as -export with -light.
std::optional<std::size_t> FindStageWord(StageList stages, const std::vector<std::string> &words) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < words.size(); ++i)
        if (FindStage(stages, words[i]))
            found.push_back(i);
    const auto isOptionOfAnother = [&](std::size_t i) {
        return std::ranges::any_of(found, [&](std::size_t other) {
            return other != i && FindStage(stages, words[other])->HasOption(words[i]);
        });
    };
    std::erase_if(found, [&](std::size_t i) { return i > 0 && isOptionOfAnother(i); });
    for (const std::size_t i : found)
        if (!EqualNoCase(words[i], words[found.front()]))
            throw Error("{} and {} on one line: run one stage after the other", words[found.front()], words[i]);
    return found.empty() ? std::nullopt : std::optional(found.front());
}

constexpr std::string_view kMapExtensions[] = {".map", ".bsp", ".reg", ".ent", ".prt", ".srf"};

bool IsOption(std::string_view word) {
    return word.size() > 1 && word.front() == '-';
}

bool HasMapExtension(std::string_view word) {
    const std::string extension = LowerCase(std::filesystem::path(word).extension().string());
    return std::ranges::find(kMapExtensions, extension) != std::end(kMapExtensions);
}

/// Whether the word names a map: by its extension, or because a map of that name is there.
bool IsMap(std::string_view word) {
    std::error_code absent;
    return HasMapExtension(word) || std::ranges::any_of(kMapExtensions, [&](std::string_view extension) {
               return std::filesystem::exists(WithExtension(std::filesystem::path(word), extension), absent);
           });
}

/// Whether the word may be the value of the unknown option before it: the first word after it, and numbers after that.
bool MayBeValue(const std::vector<std::string> &words, std::size_t at) {
    if (at == 0 || IsOption(words[at]))
        return false;
    return IsOption(words[at - 1]) || (StrictNumber(words[at]) && MayBeValue(words, at - 1));
}

/// The names that an unknown word is compared with, to propose the nearest.
std::vector<std::string> NamesToPropose(const StageContext &context) {
    std::vector<std::string> names = context.stage.OptionNames();
    if (!context.stageIsNamed)
        for (const Stage &stage : context.stages)
            names.emplace_back(stage.word);
    return names;
}

/// "; it is an option of -light", for an option of other stages.
std::string OwnerHint(const StageContext &context, std::string_view word) {
    std::vector<std::string_view> owners;
    for (const Stage &stage : context.stages)
        if (stage.HasOption(word))
            owners.push_back(stage.word);
    return owners.empty() ? "" : fmt::format("; it is an option of {}", fmt::join(owners, " and "));
}

/// What an unknown word may have been meant to be.
struct Hint {
    std::string text;
    bool isOfOtherStage = false;
};

/// An option of another stage, one written with =, or a near name.
Hint HintFor(const StageContext &context, const std::string &word) {
    if (std::string owners = OwnerHint(context, word); !owners.empty())
        return {std::move(owners), true};
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (equals != std::string::npos && context.stage.HasOption(name))
        return {fmt::format("; write {} {}", name, word.substr(equals + 1))};
    return {DidYouMean(name, NamesToPropose(context))};
}

/// Whether the value of an unknown option seems to be a file or a folder.
bool LooksLikeFile(std::string_view word) {
    constexpr std::string_view kOtherExtensions[] = {
        ".lin", ".rad", ".aas", ".shader", ".txt", ".cfg", ".json", ".tga", ".png", ".jpg",  ".jpeg",
        ".dds", ".hdr", ".exr", ".pfm",    ".pk3", ".dpk", ".ase",  ".obj", ".md3", ".html", ".caulk"};
    const std::string extension = LowerCase(std::filesystem::path(word).extension().string());
    return word.find_first_of("/\\") != std::string_view::npos || HasMapExtension(word) ||
           std::ranges::find(kOtherExtensions, extension) != std::end(kOtherExtensions);
}

/// Whether the unknown option at `at` seems to name a file or a folder. What it stands for would then be read or
/// written elsewhere than the user wants, so it must not pass with a warning.
bool TakesFile(const std::vector<std::string> &words, std::size_t at) {
    const std::string &word = words[at];
    const std::size_t equals = word.find('=');
    const std::string name = LowerCase(word.substr(0, equals));
    const bool isNamed = std::ranges::any_of(std::array{"file", "path", "dir"},
                                             [&](std::string_view end) { return name.ends_with(end); });
    const bool hasNext = at + 1 < words.size() && !IsOption(words[at + 1]);
    if (equals == std::string::npos && !hasNext)
        return isNamed;
    const std::string value = equals == std::string::npos ? words[at + 1] : word.substr(equals + 1);
    return !StrictNumber(value) && (isNamed || LooksLikeFile(value));
}

/// Error: the stage has no option `words[at]`, which seems to name a file.
[[noreturn]] void FailForFile(const StageContext &context, const std::vector<std::string> &words, std::size_t at,
                              std::string_view hint) {
    const bool hasValue = at + 1 < words.size() && !IsOption(words[at + 1]);
    throw Error("{}{}: {} has no such option, and it seems to name a file, so nothing is written{}", words[at],
                hasValue ? " " + words[at + 1] : "", context.stage.word, hint);
}

/// Position of the word that is the file: the last map, else the last word that no unknown option can claim.
std::size_t FindFile(const StageContext &context, const std::vector<std::string> &words) {
    std::optional<std::size_t> last, lastFree, map;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (IsOption(words[i]))
            continue;
        last = i;
        if (!MayBeValue(words, i))
            lastFree = i;
        if (!IsMap(words[i]))
            continue;
        if (map && words[*map] != words[i]) {
            for (const std::size_t at : {*map, i}) // one of them may be the value of an unknown option
                if (at > 0 && IsOption(words[at - 1]))
                    FailForFile(context, words, at - 1, HintFor(context, words[at - 1]).text);
            throw Error("{} and {}: a line is for one map; run the program once for each", words[*map], words[i]);
        }
        map = i;
    }
    if (!last)
        throw Error("usage: q3map2 [global options] {}", context.stage.usage);
    if (map && lastFree && *lastFree > *map)
        throw Error("{} or {}: which is the map? It may stand anywhere, but every other word must belong to an option",
                    words[*map], words[*lastFree]);
    return map.value_or(lastFree.value_or(*last));
}

/// "; its value 8 is ignored too", for the words after an unknown option that seem to be its values.
std::string ValuesAfter(const std::vector<std::string> &words, std::size_t at) {
    std::vector<std::string> values;
    while (++at < words.size() && MayBeValue(words, at))
        values.push_back(words[at]);
    return values.empty() ? ""
                          : fmt::format("; its value{} {} {} ignored too", values.size() == 1 ? "" : "s",
                                        fmt::join(values, " "), values.size() == 1 ? "is" : "are");
}

/// Which of the words left over are reported: all, or those with a dash.
enum class Checked { AllWords, Options };

/// Warns about each word that no option took; an option and its values share a warning. Errors: no stage was named, the
/// word stands before the stage word, or it seems to name a file.
void ReportUnknown(const StageContext &context, const Arguments &arguments, Checked checked = Checked::AllWords) {
    // The wording that users know: -bsp and -vis have always said "option", the other stages "argument".
    const std::string_view noun = context.stage.word == "-bsp" || context.stage.word == "-vis" ? "option" : "argument";
    const std::vector<std::string> &words = arguments.Rest();
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string &word = words[i];
        if (!IsOption(word) && (checked == Checked::Options || MayBeValue(words, i)))
            continue;
        const auto [hint, isOfOtherStage] = HintFor(context, word);
        if (!context.stageIsNamed)
            throw Error("{}: unknown{}{}", word, hint, isOfOtherStage ? ", which the line does not name" : "");
        if (arguments.IsBeforeStage(i))
            throw Error("{}: {} has no such option{}", word, context.stage.word, hint);
        if (IsOption(word) && TakesFile(words, i))
            FailForFile(context, words, i, hint);
        const std::string text = fmt::format("Unknown {} \"{}\"{}{}", noun, word, hint, ValuesAfter(words, i));
        context.log.Warn("unknown option", "{}", text);
        context.log.AddToSummary(text);
    }
}

} // namespace

std::vector<std::string> Stage::OptionNames() const {
    std::vector<SettingSection> sections = GlobalSections();
    for (SettingSection &section : SectionsOf(*this))
        sections.push_back(std::move(section));
    std::vector<std::string> names;
    for (const SettingSection &section : sections)
        for (const SettingEntry &entry : section.entries) {
            names.emplace_back(entry.info.name);
            for (const std::string_view alias : entry.info.aliases)
                if (!alias.empty())
                    names.emplace_back(alias);
        }
    return names;
}

bool Stage::HasOption(std::string_view option) const {
    return std::ranges::any_of(OptionNames(), [&](const std::string &name) { return EqualNoCase(name, option); });
}

StageFile TakeFile(const StageContext &context, Arguments &arguments, std::vector<std::string> given) {
    if (!context.stageIsNamed) // first, as the value of an unknown option could be taken for the file
        ReportUnknown(context, arguments, Checked::Options);
    StageFile result;
    result.file = arguments.TakeAt(FindFile(context, arguments.Rest()));
    SetCrashFile(result.file);
    ReportUnknown(context, arguments);
    const auto last = std::ranges::find(given.rbegin(), given.rend(), result.file);
    if (last != given.rend())
        given.erase(std::next(last).base());
    result.wordsToRecord = std::move(given);
    return result;
}

std::vector<std::string> TakeFiles(const StageContext &context, Arguments &arguments) {
    std::vector<std::string> files;
    for (std::size_t i = 0; i < arguments.Rest().size();)
        if (IsOption(arguments.Rest()[i]) || (StrictNumber(arguments.Rest()[i]) && MayBeValue(arguments.Rest(), i)))
            ++i;
        else
            files.push_back(arguments.TakeAt(i));
    ReportUnknown(context, arguments);
    return files;
}

ChosenStage TakeStage(StageList stages, Arguments &arguments) {
    if (arguments.Empty())
        throw Error("no arguments; q3map2 -help lists what there is");
    if (const auto at = FindStageWord(stages, arguments.Rest())) {
        const Stage stage = *FindStage(stages, arguments.TakeAt(*at));
        arguments.SetBeforeStage(*at);
        return {.stage = stage, .isNamed = true};
    }
    for (const std::string_view name : kForeignStages)
        if (EqualNoCase(arguments.Rest().front(), name)) {
            std::vector<std::string_view> words;
            for (const Stage &stage : stages)
                words.push_back(stage.word);
            throw Error("{} is not a stage of this version; it has {}", name, fmt::join(words, ", "));
        }
    return {.stage = stages.front(), .isNamed = false};
}

// ---- A run of the program ----

namespace {

/// The file of -log: everything that is printed goes to it too, without the live progress of terminals.
class LogFile {
  public:
    /// Errors: Error if the file cannot be made.
    explicit LogFile(const std::string &path) : path_(path), file_(OpenFile(path, "wbe")) {
        if (!file_)
            throw Error("-log {}: the file cannot be written", path);
    }
    void Write(std::string_view text) {
        if (failed_ == 0 &&
            (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() || std::fflush(file_.get()) != 0))
            failed_ = errno;
    }
    void WarnIfIncomplete(Log &log) const {
        if (failed_ != 0)
            log.Warn("log file", "-log {}: a part is missing: {}", path_, std::generic_category().message(failed_));
    }

  private:
    std::string path_;
    std::unique_ptr<std::FILE, CloseFile> file_;
    int failed_ = 0; ///< why the file ends early; 0: it does not
};

/// The words without the quotes that some editors leave around them, and that pasted paths have: plain ones, those of
/// other shells, and typographic ones. A single \" goes too: of the word "C:\games\", a shell of Windows takes the last
/// quote for a part of it.
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

/// Runs the stage that the words name, or prints the text that they ask for. Returns the exit status; nothing: no stage
/// ran.
std::optional<int> Run(StageList stages, const std::vector<std::string> &words, const std::filesystem::path &program,
                       RunReport &report, Log &log) {
    Arguments arguments(words);
    const GlobalOptions options = ParseGlobalOptions(arguments, log);
    if (options.help) {
        log.Print("{}{}", HelpText(stages, *options.help), options.help->empty() ? ManualLine(program) : "");
        return std::nullopt;
    }
    if (options.version) {
        log.Print("{}", VersionText());
        return std::nullopt;
    }
    log.Print("{}\n", kVersion);
    if (log.IsVerbose())
        report.MeasureParallelWork(log);
    const ChosenStage chosen = TakeStage(stages, arguments);
    TranslateVradOptions(chosen.stage, arguments, log);
    ExpandPreset(chosen.stage, arguments, log);
    const StageContext context{options,          chosen.stage, stages, chosen.isNamed, program,
                               arguments.Rest(), log,          report, words};
    return chosen.stage.run(context, std::move(arguments));
}

/// One run, from the command line to its exit status.
class ProgramRun {
  public:
    ProgramRun(const std::vector<std::string> &arguments, Log &log)
        : arguments_(arguments), reportPath_(LastValueOf("-report", arguments)), log_(log) {
        if (!reportPath_.empty())
            log.AddObserver(reportFile_);
    }
    ~ProgramRun() { log_.RemoveObserver(reportFile_); }
    ProgramRun(const ProgramRun &) = delete;
    ProgramRun &operator=(const ProgramRun &) = delete;

    int Status(StageList stages, const std::filesystem::path &program) {
        try {
            RequireReportFile();
            // Before the options are parsed, so that the editor and the file get errors in them too.
            EditorFeedback::Attach(LastValueOf("-connect", arguments_), log_);
            OpenLogFile();
            const std::optional<int> status = Run(stages, arguments_, program, report_, log_);
            if (!status)
                return 0;
            const std::string faults = report_.Faults();
            return End(*status, *status == 0 ? "" : faults.empty() ? "the log says what is wrong" : faults);
        } catch (const Error &error) {
            return Fail(error.what());
        } catch (const std::bad_alloc &) {
            return Fail(kOutOfMemory);
        } catch (const std::filesystem::filesystem_error &error) {
            const std::string path = error.path1().string();
            return Fail(path.empty() ? error.code().message() : fmt::format("{}: {}", path, error.code().message()));
        } catch (const std::exception &error) {
            return Fail(fmt::format("unexpected failure: {}", error.what()));
        }
    }

    /// The exit status after Status has thrown for want of memory, even for its error line. Needs none itself.
    int StatusWithoutMemory() {
        if (!isErrorPrinted_)
            for (const std::string_view part : {kErrorHeader, kOutOfMemory, std::string_view("\n")})
                log_.Write(LogLevel::Error, part);
        return 1;
    }

  private:
    /// Fails now, not after hours of computing.
    void RequireReportFile() {
        if (reportPath_.empty())
            return;
        try {
            RequireWritable(reportPath_);
        } catch (const Error &error) {
            reportPath_.clear();
            throw Error("-report: {}", error.what());
        }
    }

    void OpenLogFile() {
        const std::string file = LastValueOf("-log", arguments_);
        if (file.empty())
            return;
        logFile_ = std::make_shared<LogFile>(file);
        log_.AddSink([logFile = logFile_](LogLevel, std::string_view text) { logFile->Write(text); });
    }

    int Fail(std::string_view text) {
        log_.FlushWarnings();
        const std::string lines = fmt::format("{}{}\n", kErrorHeader, text);
        log_.Write(LogLevel::Error, lines);
        isErrorPrinted_ = true;
        return End(1, text);
    }

    /// Writes the report first, so that the last line says how the whole run has ended.
    int End(int status, std::string_view error) {
        if (logFile_)
            logFile_->WarnIfIncomplete(log_);
        log_.FlushWarnings();
        if (!WriteReport(error))
            status = 1;
        report_.PrintEnd(status == 0 ? RunEnd::Done : RunEnd::Failed, log_);
        return status;
    }

    bool WriteReport(std::string_view error) {
        log_.RemoveObserver(reportFile_);
        if (reportPath_.empty())
            return true;
        try {
            reportFile_.Write(reportPath_, arguments_, error);
        } catch (const Error &failure) {
            const bool isFirst = error.empty(); // a run has one error
            log_.Write(isFirst ? LogLevel::Error : LogLevel::Warning,
                       fmt::format("{}-report: {}\n", isFirst ? kErrorHeader : "WARNING: ", failure.what()));
            return false;
        }
        return true;
    }

    const std::vector<std::string> &arguments_;
    std::string reportPath_; ///< empty: no report is written
    Log &log_;
    RunReport report_;
    ReportFile reportFile_;
    std::shared_ptr<LogFile> logFile_; ///< null: the log goes to no file
    bool isErrorPrinted_ = false;
};

} // namespace

int RunProgram(StageList stages, const std::vector<std::string> &given, const std::filesystem::path &program,
               Log &log) {
    const std::vector<std::string> arguments = Unquoted(given);
    InstallCrashReport(VersionText());
    SetCrashCommand(fmt::format("{}", fmt::join(arguments, " ")));
    ProgramRun run(arguments, log);
    try {
        return run.Status(stages, program);
    } catch (const std::bad_alloc &) {
        return run.StatusWithoutMemory();
    }
}

} // namespace q3
