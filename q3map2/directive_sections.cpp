// GPL-2.0-or-later. Documentation of the directives of shader scripts.
#include "q3map2/directive_sections.h"

#include "q3map2/shader/shader_directive.h"

namespace q3 {

std::vector<SettingSection> DirectiveSections() {
    std::vector<SettingSection> sections;
    for (const DirectiveGroup &group : DirectiveGroups()) {
        SettingSection &section = sections.emplace_back(SettingSection{group.title, group.intro, {}});
        for (const ShaderDirective &directive : group.directives)
            section.entries.push_back({directive.info, std::string(directive.info.initial), directive.stage});
    }
    SettingSection &stages = sections.emplace_back(SettingSection{
        "Inside stages",
        "Of a stage, a block in braces within a shader, the compiler reads images only. What the engine does with them "
        "(blending, alpha tests, movement) does not change light: shadows through textures need `surfaceparm "
        "alphashadow` or `lightfilter`. A generated shader repeats the stages, and its images replace `$lightmap`.",
        {}});
    for (const StageWordEntry &word : StageWords())
        stages.entries.push_back({word.info, {}, "both"});
    return sections;
}

} // namespace q3
