// GPL-2.0-or-later. Options of -scale, -shift and -mergebsp.
#include "q3map2/edit/edit_options.h"

#include "common/error.h"
#include "common/text/text.h"

namespace q3 {

std::vector<SettingGroup<ScaleOptions>> ScaleSettings() {
    return {{"Scaling",
             "Before the file stand one to three factors: one for all axes, one for x and y and one for z, or one an "
             "axis.",
             {{{.name = "-tex", .help = "Textures keep their size in the world, and are not stretched with the faces"},
               &ScaleOptions::projectTextures},
              {{.name = "-spawn_ref",
                .values = "F",
                .unit = "game units",
                .help = "Height of `info_player_` entities over the floor, which is not scaled"},
               &ScaleOptions::spawnReference}}}};
}

std::vector<SettingGroup<MergeOptions>> MergeSettings() {
    return {{"Merging",
             "",
             {{{.name = "-fixnames", .help = "Give targets of the second map that the first has too other names"},
               &MergeOptions::fixNames},
              {{.name = "-world", .help = "Merge the world of the second map too, not its entities only"},
               &MergeOptions::world}}}};
}

Vec3d TakeAxisValues(Arguments &arguments, std::string_view stage) {
    std::vector<double> values;
    for (std::size_t i = 0; i < arguments.Rest().size() && arguments.Rest().size() > 1;) {
        const auto number = WholeNumber(arguments.Rest()[i]);
        if (number) {
            values.push_back(*number);
            arguments.TakeAt(i);
        } else {
            ++i;
        }
    }
    if (values.empty() || values.size() > 3)
        throw Error("{}: {} numbers, expected 1 to 3 before the file: S, or SXY SZ, or SX SY SZ", stage, values.size());
    const std::size_t last = values.size() - 1;
    return {values[0], values[last == 2 ? 1 : 0], values[last]};
}

} // namespace q3
