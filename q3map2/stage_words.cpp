// GPL-2.0-or-later. Which stage a command line means, and which file.
#include "q3map2/stage_words.h"

#include "common/error.h"
#include "common/nearest_names.h"
#include "common/text/text.h"

#include <algorithm>

#include <fmt/ranges.h>

namespace q3 {

namespace {

/// Names that users of other compilers may give.
constexpr std::string_view kOtherStages[] = {"-vlight", "-ent"};
constexpr std::string_view kMapExtensions[] = {".map", ".bsp", ".reg", ".ent", ".prt", ".srf"};

bool IsOption(std::string_view word) {
    return word.size() > 1 && word.front() == '-';
}

const Stage *FindStage(const std::vector<Stage> &stages, std::string_view word) {
    const auto found = std::ranges::find_if(stages, [&](const Stage &s) { return EqualNoCase(s.word, word); });
    return found == stages.end() ? nullptr : &*found;
}

/// Position of the stage word. A word other than the first is not one if another stage on the line has an option of
/// that name, such as -export with -light.
std::optional<std::size_t> FindStageWord(const std::vector<Stage> &stages, const std::vector<std::string> &words) {
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

bool HasMapExtension(std::string_view word) {
    const std::string extension = LowerCase(std::filesystem::path(word).extension().string());
    return std::ranges::find(kMapExtensions, extension) != std::end(kMapExtensions);
}

/// Position of the word that is the file.
std::size_t FindFile(const StageContext &context, const std::vector<std::string> &words) {
    std::vector<std::size_t> files, maps;
    for (std::size_t i = 0; i < words.size(); ++i)
        if (!IsOption(words[i])) {
            files.push_back(i);
            if (HasMapExtension(words[i]))
                maps.push_back(i);
        }
    if (files.empty())
        throw Error("usage: q3map2 [global options] {}", context.stage.usage);
    if (!maps.empty() && maps.back() != files.back())
        throw Error("{} or {}: which is the map? It may stand anywhere, but every other word must belong to an option",
                    words[maps.back()], words[files.back()]);
    return files.back();
}

/// All names among which to look for what an unknown word was meant to be.
std::vector<std::string> KnownNames(const StageContext &context) {
    std::vector<std::string> names = context.stage.OptionNames();
    if (!context.stageGiven)
        for (const Stage &stage : Stages())
            names.emplace_back(stage.word);
    return names;
}

/// "; it is an option of -light", for an option of other stages.
std::string OwnerHint(std::string_view word) {
    std::vector<std::string_view> owners;
    for (const Stage &stage : Stages())
        if (stage.HasOption(word))
            owners.push_back(stage.word);
    return owners.empty() ? "" : fmt::format("; it is an option of {}", fmt::join(owners, " and "));
}

/// Warns about each word left; an error if no stage was named or the word stands before the stage word. With
/// `optionsOnly`, about words with a dash only.
void ReportUnknown(const StageContext &context, const Arguments &arguments, bool optionsOnly = false) {
    const bool saysOption = context.stage.word == "-bsp" || context.stage.word == "-vis";
    for (std::size_t i = 0; i < arguments.Rest().size(); ++i) {
        const std::string &word = arguments.Rest()[i];
        if (optionsOnly && !IsOption(word))
            continue;
        const std::string owners = OwnerHint(word);
        const std::string hint = owners.empty() ? DidYouMean(word, KnownNames(context)) : owners;
        if (!context.stageGiven)
            throw Error("{}: unknown{}{}", word, hint, owners.empty() ? "" : ", which the line does not name");
        if (arguments.IsBeforeStage(i))
            throw Error("{}: {} has no such option{}", word, context.stage.word, hint);
        const std::string text = fmt::format("Unknown {} \"{}\"{}", saysOption ? "option" : "argument", word, hint);
        context.log.Warn("unknown option", "{}", text);
        context.log.Repeat(text);
    }
}

} // namespace

ChosenStage TakeStage(Arguments &arguments) {
    const std::vector<Stage> stages = Stages();
    if (arguments.Empty())
        throw Error("no arguments; q3map2 -help lists what there is");
    if (const auto at = FindStageWord(stages, arguments.Rest())) {
        const Stage stage = *FindStage(stages, arguments.TakeAt(*at));
        arguments.SetBeforeStage(*at);
        return {stage, true};
    }
    for (const std::string_view name : kOtherStages)
        if (EqualNoCase(arguments.Rest().front(), name)) {
            std::vector<std::string_view> words;
            for (const Stage &stage : stages)
                words.push_back(stage.word);
            throw Error("{} is not a stage of this version; it has {}", name, fmt::join(words, ", "));
        }
    return {stages.front(), false};
}

StageFile TakeFile(const StageContext &context, Arguments &arguments, std::vector<std::string> given) {
    if (!context.stageGiven)
        ReportUnknown(context, arguments, true); // first, as the value of an unknown option could be taken for the file
    StageFile result;
    result.file = arguments.TakeAt(FindFile(context, arguments.Rest()));
    ReportUnknown(context, arguments);
    const auto last = std::ranges::find(given.rbegin(), given.rend(), result.file);
    if (last != given.rend())
        given.erase(std::next(last).base());
    result.recorded = std::move(given);
    return result;
}

std::vector<std::string> TakeFiles(const StageContext &context, Arguments &arguments) {
    std::vector<std::string> files;
    for (std::size_t i = 0; i < arguments.Rest().size();)
        if (IsOption(arguments.Rest()[i]))
            ++i;
        else
            files.push_back(arguments.TakeAt(i));
    ReportUnknown(context, arguments);
    return files;
}

} // namespace q3
