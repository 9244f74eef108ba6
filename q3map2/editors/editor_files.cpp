// GPL-2.0-or-later. Entries of the build menus of level editors, and the files that hold them.
#include "q3map2/editors/editor_files.h"

#include "q3map2/editors/editor_feedback.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace q3 {

// ---- Entries of the build menus of level editors ----

namespace {

std::string Capitalized(std::string_view word) {
    std::string text(word);
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
        text[0] = char(text[0] - 'a' + 'A');
    return text;
}

/// Whether a build makes an SH grid too.
enum class GridOfBuild { Legacy, SH };

EditorBuild WholeBuild(std::string_view preset, GridOfBuild grid) {
    const bool makesGridSH = grid == GridOfBuild::SH;
    return {.label = fmt::format("{}{}: bsp, vis, light", Capitalized(preset), makesGridSH ? " with SH grid" : ""),
            .steps = {fmt::format("-bsp -preset {}", preset), fmt::format("-vis -preset {} -saveprt", preset),
                      fmt::format("-light -preset {}{}", preset, makesGridSH ? " -shbspx" : "")},
            .opensGroup = !makesGridSH};
}

EditorBuild GridBuild(std::string_view preset) {
    return {.label = fmt::format("SH grid only, {}", preset),
            .steps = {fmt::format("-light -preset {} -onlygrid -shbspx", preset)}};
}

} // namespace

bool ReadsMapSource(std::string_view step) {
    return step.starts_with("-bsp") || step.starts_with("-watch");
}

std::vector<EditorBuild> EditorBuilds(std::span<const std::string_view> presets) {
    std::vector<EditorBuild> builds;
    for (const std::string_view preset : presets)
        for (const GridOfBuild grid : {GridOfBuild::Legacy, GridOfBuild::SH})
            builds.push_back(WholeBuild(preset, grid));
    builds.front().opensGroup = false;
    const std::size_t first = builds.size();
    for (const std::string_view preset : presets)
        builds.push_back(GridBuild(preset));
    builds[first].opensGroup = true;
    builds.push_back({.label = "Geometry only, to find leaks",
                      .steps = {fmt::format("-bsp -preset {} -leaktest", presets.front())},
                      .opensGroup = true});
    builds.push_back({.label = "Entities only", .steps = {"-bsp -onlyents"}});
    builds.push_back({.label = "Watch: compile and show on each save", .steps = {"-watch -open"}});
    builds.push_back({.label = "Package (pk3)", .steps = {R"(-pk3 -basepak "pak*.pk3")"}, .needsMap = false});
    return builds;
}

// ---- Menus and profiles in the forms that level editors read ----

namespace {

constexpr std::string_view kGeneratedBy = "Generated: q3map2 -editorfiles tools/generated/editors";

/// A quoted string in TrenchBroom's files.
std::string Quoted(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text)
        quoted += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return quoted + "\"";
}

/// A TrenchBroom compilation profile: exports the map, then runs the steps.
std::string Profile(const EditorBuild &build, const Game &game) {
    std::vector<std::string> tasks;
    if (build.needsMap)
        tasks.emplace_back(R"({ "type": "export", "target": "${WORK_DIR_PATH}/${MAP_BASE_NAME}.map" })");
    for (const std::string &step : build.steps) {
        const std::string parameters =
            fmt::format(R"(-game {} -fs_basepath "${{GAME_DIR_PATH}}" -fs_game ${{MODS[-1]}} {} )"
                        R"("${{MAP_BASE_NAME}}.{}")",
                        game.name, step, ReadsMapSource(step) ? "map" : "bsp");
        tasks.push_back(fmt::format("{{ \"type\": \"tool\", \"tool\": \"${{q3map2}}\", "
                                    "\"treatNonZeroResultCodeAsError\": true,\n        \"parameters\": {} }}",
                                    Quoted(parameters)));
    }
    return fmt::format("    {{ \"name\": {}, \"workdir\": \"${{GAME_DIR_PATH}}/${{MODS[-1]}}/maps\", \"tasks\": [\n"
                       "      {}\n    ] }}",
                       Quoted(build.label), fmt::join(tasks, ",\n      "));
}

} // namespace

std::string BuildMenu(const std::vector<EditorBuild> &builds, const Game &game) {
    std::string text = fmt::format("<?xml version=\"1.0\"?>\n<!-- {} -->\n<project version=\"2.0\">\n", kGeneratedBy);
    // The editor puts the user's own folders after the first piece of text, the program.
    text += fmt::format(R"(<var name="q3map2">"[RadiantPath]q3map2.[ExecutableType]")"
                        R"(<cond value="[MonitorAddress]"> -connect [MonitorAddress]</cond>)"
                        R"( -game {} -fs_basepath "[EnginePath]")"
                        R"(<cond value="[UserEnginePath]"> -fs_homepath "[UserEnginePath]"</cond>)"
                        R"(<cond value="[GameName]"> -fs_game [GameName]</cond></var>)",
                        game.name);
    text += '\n';
    for (const EditorBuild &build : builds) {
        text += fmt::format("{}<build name=\"{}\">\n", build.opensGroup ? "<separator/>\n" : "", XmlText(build.label));
        for (const std::string &step : build.steps)
            text += fmt::format("<command>[q3map2] {} \"[{}]\"</command>\n", XmlText(step),
                                ReadsMapSource(step) ? "MapFile" : "BspFile");
        text += "</build>\n";
    }
    return text + "</project>\n";
}

std::string ProjectTemplate(const std::vector<EditorBuild> &builds, const Game &game, int templateVersion) {
    // No comment: the editor expects the root right after the type.
    std::string text = "<?xml version=\"1.0\"?>\n<!DOCTYPE project SYSTEM \"dtds/project.dtd\">\n<project>\n";
    const auto key = [&](std::string_view name, std::string_view value) {
        text += fmt::format("<key name=\"{}\" value=\"{}\"/>\n", XmlText(name), XmlText(value));
    };
    key("version", "2");
    key("template_version", std::to_string(templateVersion));
    key("basepath", "$TEMPLATEenginepath$TEMPLATEbasedir/");
    key("rshcmd", "");
    key("remotebasepath", "$TEMPLATEenginepath$TEMPLATEbasedir/");
    key("entitypath", "$TEMPLATEtoolspath$TEMPLATEbasedir/scripts/entities.def");
    key("texturepath", "$TEMPLATEenginepath$TEMPLATEbasedir/textures/");
    key("autosave", "$TEMPLATEuserhomepath$TEMPLATEbasedir/maps/autosave.map");
    key("mapspath", "$TEMPLATEenginepath$TEMPLATEbasedir/maps/");
    for (const EditorBuild &build : builds) {
        std::vector<std::string> commands; // the editor replaces $ by the map, # by -connect ADDRESS, ! by nothing
        for (const std::string &step : build.steps)
            commands.push_back(fmt::format("! \"$TEMPLATEapppath$TEMPLATEq3map2\" # -game {} -fs_basepath "
                                           "\"$TEMPLATEenginepath\" -fs_basegame \"$TEMPLATEbasedir\" {} $",
                                           game.name, step));
        key("bsp_" + build.label, fmt::format("{}", fmt::join(commands, " && ")));
    }
    return text + "</project>\n";
}

std::string CompilationProfiles(const std::vector<EditorBuild> &builds, const Game &game) {
    std::vector<std::string> profiles;
    for (const EditorBuild &build : builds)
        profiles.push_back(Profile(build, game));
    return fmt::format("// {}\n{{ \"version\": 1,\n  \"profiles\": [\n{}\n  ]\n}}\n", kGeneratedBy,
                       fmt::join(profiles, ",\n"));
}

std::string EngineProfiles() {
    constexpr std::string_view kParameters = "+set fs_game ${MODS[-1]} +set sv_pure 0 +devmap ${MAP_BASE_NAME}";
    return fmt::format("// {}; the path is yours to set\n{{ \"version\": 1,\n  \"profiles\": [\n"
                       "    {{ \"name\": \"Play the map\", \"path\": \"\",\n      \"parameters\": {} }}\n  ]\n}}\n",
                       kGeneratedBy, Quoted(kParameters));
}

std::string GameConfig(const Game &game) {
    const std::string name = game.name == "quake3" ? "Quake 3" : std::string(game.name);
    // The contents word of a map source has only the detail bit; TrenchBroom wants an entry for each lower bit too.
    constexpr int kDetailBit = 27;
    std::string flags;
    for (int bit = 0; bit < kDetailBit; ++bit)
        flags += R"({ "unused": true }, )";
    return fmt::format(R"cfg(// {}
{{ "version": 9,
  "name": {},
  "fileformats": [ {{ "format": "Quake3 (Valve)" }}, {{ "format": "Quake3 (legacy)" }} ],
  "filesystem": {{
    "searchpath": {},
    "packageformat": {{ "extension": {}, "format": "zip" }} }},
  "materials": {{
    "root": "textures",
    "extensions": [".tga", ".png", ".jpg", ".jpeg"],
    "shaderSearchPath": {} }},
  "entities": {{
    "definitions": ["entities.ent"],
    "defaultcolor": "0.6 0.6 0.6 1.0",
    "scale": [modelscale, modelscale_vec] }},
  "tags": {{
    "brush": [ {{ "name": "Trigger", "attribs": ["transparent"], "match": "classname", "pattern": "trigger*" }} ],
    "brushface": [
      {{ "name": "Clip", "attribs": ["transparent"], "match": "surfaceparm", "pattern": ["playerclip", "botclip"] }},
      {{ "name": "Hint", "attribs": ["transparent"], "match": "surfaceparm", "pattern": "hint" }},
      {{ "name": "Area portal", "attribs": ["transparent"], "match": "surfaceparm", "pattern": "areaportal" }},
      {{ "name": "Fog", "attribs": ["transparent"], "match": "surfaceparm", "pattern": "fog" }},
      {{ "name": "Sky", "match": "surfaceparm", "pattern": "sky" }},
      {{ "name": "Detail", "match": "contentflag", "flags": ["detail"] }} ] }},
  "faceattribs": {{
    "defaults": {{ "scale": [0.5, 0.5] }},
    "surfaceflags": [],
    "contentflags": [ {}{{ "name": "detail", "description": "Divides no leafs and hides nothing from -vis" }} ] }},
  "softMapBounds": "-65536 -65536 -65536 65536 65536 65536",
  "compilationTools": [
    {{ "name": "q3map2", "description": "Path of q3map2: bsp, visibility, light" }},
    {{ "name": "bspc", "description": "Path of the tool that makes bot files" }} ]
}}
)cfg",
                       kGeneratedBy, Quoted(name), Quoted(game.gameDir),
                       Quoted("." + std::string(game.archiveExtension)), Quoted(game.shaderDir), flags);
}

std::vector<EditorFile> EditorFiles(const std::vector<EditorBuild> &builds, const Game &game, int templateVersion) {
    return {{"netradiant/default_build_menu.xml", BuildMenu(builds, game)},
            {"gtkradiant/default_project.proj", ProjectTemplate(builds, game, templateVersion)},
            {"trenchbroom/CompilationProfiles.cfg", CompilationProfiles(builds, game)},
            {"trenchbroom/GameEngineProfiles.cfg", EngineProfiles()},
            {"trenchbroom/GameConfig.cfg", GameConfig(game)}};
}

} // namespace q3
