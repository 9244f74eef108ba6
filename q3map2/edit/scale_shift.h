// GPL-2.0-or-later. Maps scaled or moved as a whole, and the options of -scale, -shift and -mergebsp.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"

#include <string>
#include <string_view>

namespace q3 {

// ---- Options of -scale, -shift and -mergebsp ----

struct ScaleOptions {
    Vec3d factors{1, 1, 1};
    bool projectTextures = false; ///< textures keep their size in the world; else they are stretched with the faces
    float spawnReference = 0;     ///< minus the height of a player's origin over the floor; game units
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

/// Scales geometry, positions of entities, cells of light grids. Lightmaps, visibility and values of the grids stay.
/// `name` is for messages. Errors: a factor that is not above 0.
void ScaleMap(Bsp &bsp, const ScaleOptions &options, std::string_view name, Log &log);

/// Adds the vector to all positions. The model of a brush entity with an `origin` is relative to that and stays, with
/// planes and vertices of its own where it shared them. Lightmaps and visibility stay. `name` is for messages. Errors:
/// a distance over 2^24.
void ShiftMap(Bsp &bsp, const Vec3d &shift, std::string_view name, Log &log);

} // namespace q3
