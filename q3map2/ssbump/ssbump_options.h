// GPL-2.0-or-later. Options of the stage -ssbump.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"

#include <string>
#include <vector>

namespace q3 {

struct SsbumpOptions {
    double bumpScale = 8; ///< height of white over black, texels; negative: white is deep
    bool tile = true;     ///< the height map repeats
    int rays = 32;        ///< azimuths along which a texel looks for its horizon
    int filter = 0;       ///< passes that smooth the steps of the image
    std::string normals;  ///< path of a normal map to write; empty: none
};

/// The options of the stage, declared.
std::vector<SettingGroup<SsbumpOptions>> SsbumpSettings();
/// Removes these options from `arguments`.
SsbumpOptions ParseSsbumpOptions(Arguments &arguments, Log &log);

} // namespace q3
