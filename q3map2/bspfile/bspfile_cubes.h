// GPL-2.0-or-later. The BSPX lump AMBIENT_CUBES.
#pragma once

#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace q3 {

struct ByteSource;
struct FilePart;

/// The most samples whose numbers fit the records of leafs.
inline constexpr std::size_t kMostCubes = 65536;

/// The head that belongs to the cubes.
bspCubeHeader_t HeaderOf(const AmbientCubes &cubes);
/// Reads the lump. Errors: a head of another kind, a length that is not what it says.
AmbientCubes ReadAmbientCubes(const ByteSource &file, const FilePart &part, std::string_view name);
/// Errors: Error if the map has cubes that do not fit its leafs, or contradict themselves.
void CheckAmbientCubes(const Bsp &bsp, std::string_view name);
/// Drops cubes made for other leafs, with a warning: another program has changed the map. Errors as CheckAmbientCubes.
void DropUnfitCubes(Bsp &bsp, std::string_view name, Log &log);

/// Position of a sample of that leaf. Game units.
Vec3f CubePosition(const bspLeaf_t &leaf, const bspCubeSample_t &sample);
/// The nearest position that a sample of the leaf can have.
std::array<std::uint8_t, 3> EncodeCubePosition(const bspLeaf_t &leaf, const Vec3f &position);

} // namespace q3
