// GPL-2.0-or-later. Bump maps as image files.
#pragma once

#include "common/log.h"
#include "q3map2/ssbump/ssbump.h"
#include "q3map2/ssbump/ssbump_options.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace q3 {

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
