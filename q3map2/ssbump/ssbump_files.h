// GPL-2.0-or-later. Bump maps as image files, and the options of -ssbump.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "q3map2/ssbump/ssbump.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace q3 {

// ---- Options of the stage -ssbump ----

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

/// Bytes of the channels of a bump map: 255 for 1, rounded to nearest.
std::vector<std::uint8_t> SsbumpBytes(std::span<const Vec3f> bump);
/// Bytes of the unit normals of a field, x, y, z for red, green, blue: 127 for 0, 255 for 1.
std::vector<std::uint8_t> NormalBytes(const HeightField &field);

/// Reads a height map, and writes its self-shadowed bump map and, if asked for, its normal map. The extension of the
/// files written, .tga or .png, is their format. They have 24 bits a texel, or 32 with the alpha of the height map if
/// it has any texel that is not opaque. Errors: other extensions, files that cannot be read or written.
void WriteSsbump(const std::filesystem::path &heightMap, const std::filesystem::path &output,
                 const SsbumpOptions &options, const JobPool &jobs, Log &log);

} // namespace q3
