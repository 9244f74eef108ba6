// GPL-2.0-or-later. The stages that the command line can name.
#include "q3map2/stages.h"

#include "q3map2/convert/convert_options.h"
#include "q3map2/global_settings.h"
#include "q3map2/light/options/light_settings.h"
#include "q3map2/lightmap/options/lightmap_settings.h"
#include "q3map2/map/bsp_settings.h"
#include "q3map2/presets.h"
#include "q3map2/vis/vis_settings.h"

#include <algorithm>

namespace q3 {

namespace {

/// The sections after that of the stage's presets.
std::vector<SettingSection> AfterPresets(std::vector<SettingSection> sections) {
    sections.insert(sections.begin(), PresetSection());
    return sections;
}

std::vector<SettingSection> LightSections() {
    std::vector<SettingSection> sections = AfterPresets(Describe(LightSettings()));
    for (SettingSection &section : Describe(LightmapSettings()))
        sections.push_back(std::move(section));
    // Options without effect come last.
    std::stable_partition(sections.begin(), sections.end(),
                          [](const SettingSection &s) { return !s.title.starts_with("Accepted"); });
    return sections;
}

} // namespace

std::vector<Stage> Stages() {
    return {
        {"-bsp", "[-bsp] [options] maps/x.map", "Compile a map: maps/x.map to x.bsp, x.srf and x.prt",
         "The source has the extension `.map` whatever the line says, but for `.reg` (a region of a map) and, with "
         "`-onlyents`, `.ent`. Without the word `-bsp` the file must not be a `.bsp`, so that a compiled map is not "
         "replaced by mistake. Old `.prt`, `.lin` and `.reg` files beside it are removed first. A map that leaks gets "
         "`x.lin` in place of `x.prt`; that is no error, and the exit status is 0. A map without an entity in the open "
         "is an error, because nothing tells its inside from its outside.",
         BspStage, [] { return AfterPresets(Describe(BspSettings())); }},
        {"-vis", "-vis [options] maps/x.bsp", "Compute what can be seen from where, from maps/x.prt",
         "Reads `x.bsp` and `x.prt`, which the bsp stage wrote, and puts visibility data into `x.bsp`. "
         "[vis.md](vis.md) explains when to use what.",
         VisStage, [] { return AfterPresets(Describe(VisSettings())); }},
        {"-light", "-light [options] maps/x.bsp", "Light a compiled map: lightmaps, vertices and light grids", "",
         LightStage, LightSections},
        {"-info", "-info maps/a.bsp maps/b.bsp ...", "Print counts, bytes and the light grid of maps", "", InfoStage,
         nullptr},
        {"-json", "-json [-unpack|-pack] [options] maps/x.bsp", "Write all lumps as JSON files, or read them back", "",
         JsonStage, [] { return Describe(JsonSettings()); }},
        {"-convert", "-convert [options] maps/x.bsp", "Write a map in another format: as map source, in three forms",
         "[convert.md](convert.md) tells what each format is for and what is lost. The input is `x.bsp`, or `x.map` if "
         "the file is named so and the format reads map sources.",
         ConvertStage, [] { return Describe(ConvertSettings()); }},
        {"-export", "-export maps/x.bsp", "Write the lightmaps as images maps/x/lightmap_NNNN.tga",
         "24 bit, upside down in most viewers.", ExportStage, nullptr},
        {"-import", "-import maps/x.bsp", "Replace the lightmaps by these images",
         "A lightmap whose image is missing or has another size stays.", ImportStage, nullptr},
        {"-shpreview", "-shpreview FILE.png maps/x.bsp", "Draw what both light grids of a map show to a picture", "",
         PreviewStage, nullptr}};
}

std::vector<SettingSection> GlobalSections() {
    return Describe(GlobalSettings());
}

std::vector<std::string> Stage::OptionNames() const {
    std::vector<SettingSection> sections = GlobalSections();
    if (settings)
        for (SettingSection &section : settings())
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

} // namespace q3
