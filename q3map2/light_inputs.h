// GPL-2.0-or-later. Optional files beside a .bsp that the light stage reads.
#pragma once

#include "common/arguments.h"
#include "common/files/vfs.h"
#include "q3map2/light/light.h"

#include <filesystem>

namespace q3 {

/// The .map and the .srf beside the .bsp, if they exist. Errors: Error, for files that cannot be read or
/// parsed.
LightInputs ReadLightInputs(const std::filesystem::path &bspPath, Log &log);

/// Warns of luxel sizes on the command line (`given`) that the .srf overrides, and removes them from the list of
/// changed options.
void WarnOfLuxelSizes(const std::vector<std::string> &given, const LightInputs &inputs, Arguments &arguments, Log &log);

/// The texlights of a map: lights.rad among the game's files, `given` (-lights), and the .rad beside the .bsp, in this
/// order. hdr: see TexLights::Read. Errors: Error, if one of `given` does not exist or a file cannot be read.
TexLights ReadTexLights(const std::filesystem::path &bspPath, const VirtualFileSystem &vfs,
                        const std::vector<std::string> &given, bool hdr, Log &log);

} // namespace q3
