// GPL-2.0-or-later. q3map2 -editorfiles: menus and profiles for level editors.
#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/editors/editor_files.h"
#include "q3map2/file_guard.h"
#include "q3map2/presets.h"
#include "q3map2/stage_words.h"
#include "q3map2/version.h"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace q3 {

namespace {

namespace fs = std::filesystem;

/// Words of a step, without quotes.
std::vector<std::string> WordsOfStep(const std::string &step) {
    std::istringstream text(step);
    std::vector<std::string> words;
    for (std::string word; text >> word;) {
        std::erase(word, '"');
        words.push_back(word);
    }
    return words;
}

/// 1.2.3 as 10203.
int VersionAsNumber() {
    int number = 0;
    for (std::string_view rest = kVersionNumber; !rest.empty();) {
        int part = 0;
        const char *const end = std::from_chars(rest.data(), rest.data() + rest.size(), part).ptr;
        number = number * 100 + part;
        rest.remove_prefix(std::min(std::size_t(end - rest.data()) + 1, rest.size()));
    }
    return number;
}

} // namespace

void CheckBuildStep(const std::string &step) {
    Log quiet([](LogLevel, std::string_view) {});
    Arguments arguments(WordsOfStep(step));
    const ChosenStage chosen = TakeStage(arguments);
    ExpandPreset(chosen.stage, arguments, quiet);
    const auto sections = chosen.stage.settings ? chosen.stage.settings() : std::vector<SettingSection>();
    for (const SettingSection &section : sections)
        for (const SettingEntry &entry : section.entries)
            for (std::size_t at = 0; at < arguments.Rest().size();)
                if (entry.info.Names(arguments.Rest()[at]))
                    TakeOccurrence(entry.info, entry.info.kind, arguments, at, quiet);
                else
                    ++at;
    if (!chosen.given || !arguments.Empty())
        throw Error("\"{}\" in the menus of editors: there is no {}", step,
                    arguments.Empty() ? "stage" : arguments.Rest().front());
}

int EditorFilesStage(const StageContext &context, Arguments arguments) {
    const std::vector<std::string> folders = TakeFiles(context, arguments);
    if (folders.size() != 1)
        throw Error("usage: q3map2 {}", context.stage.usage);
    FileGuard(context).WritesInto(folders.front());
    std::vector<std::string_view> presets;
    for (const Preset &preset : Presets())
        presets.push_back(preset.name);
    const std::vector<EditorBuild> builds = EditorBuilds(presets);
    for (const EditorBuild &build : builds)
        std::ranges::for_each(build.steps, CheckBuildStep);
    for (const std::string_view option : kEditorOptions)
        if (!context.stage.HasOption(option))
            throw Error("{} in the menus of editors: there is no such option", option);
    for (const EditorFile &file : EditorFiles(builds, *context.options.game, VersionAsNumber())) {
        const fs::path path = fs::absolute(folders.front()) / file.path;
        context.log.Print("Writing {}\n", path.string());
        MakeFolder(path.parent_path());
        ReplaceTextFile(path, file.text);
    }
    return 0;
}

} // namespace q3
