// GPL-2.0-or-later. Light of static props as files beside the map.
#pragma once

#include "q3map2/lightmap/props/prop_lighting.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace q3 {

/// The light of a prop as a file of Source: head, meshes, then from the next multiple of 512 on four bytes a vertex,
/// blue, green, red and 255. A byte is 127.5 * light^(1 / 2.2), at most 255.
std::vector<std::byte> EncodeVhv(const PropVertexLight &light);

/// Writes FOLDER/sp_N.vhv for prop N of the lump, from 0, and FOLDER/proplight.raw: three little-endian floats for each
/// color of the lump, unit scale. Errors: Error for files that cannot be written.
void WritePropFiles(const std::filesystem::path &folder, const std::vector<PropVertexLight> &light, Log &log);

} // namespace q3
