// GPL-2.0-or-later. Options of -scale, -shift and -mergebsp.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "libs/math/vec.h"

#include <string>
#include <string_view>

namespace q3 {

struct ScaleOptions {
    Vec3d factors{1, 1, 1};
    bool projectTextures = false; ///< textures keep their size in the world; else they are stretched with the faces
    float spawnReference = 0;     ///< height of a player's origin over the floor; game units
};

struct MergeOptions {
    bool fixNames = false; ///< targets and target names that both maps have get a number in the second
    bool world = false;    ///< the world of the second map too, not its brush entities only
};

std::vector<SettingGroup<ScaleOptions>> ScaleSettings();
std::vector<SettingGroup<MergeOptions>> MergeSettings();

/// Takes one to three numbers off the words that are left: S, or SXY SZ, or SX SY SZ. A number that is the only word
/// left is the file. `stage` is for messages. Errors: none, or more than three.
Vec3d TakeAxisValues(Arguments &arguments, std::string_view stage);

} // namespace q3
