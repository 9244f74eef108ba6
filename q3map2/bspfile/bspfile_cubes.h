// GPL-2.0-or-later. The BSPX lump AMBIENT_CUBES.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace q3 {

/// The most samples whose numbers fit the records of leafs.
inline constexpr std::size_t kMostCubes = 65536;

/// The head that belongs to the cubes.
bspCubeHeader_t HeaderOf(const AmbientCubes &cubes);
/// Reads the lump. Errors: a head of another kind, a length that is not what it says.
AmbientCubes ReadAmbientCubes(const BspxSource &from);
/// The bytes of the lump.
ByteRanges CubeRanges(const AmbientCubes &cubes);
/// What is wrong if the map has cubes for other leafs; empty: nothing.
std::string CubesMisfit(const Bsp &bsp);
/// Errors: Error if the map has cubes that do not fit its leafs, or contradict themselves.
void CheckAmbientCubes(const Bsp &bsp, std::string_view name);

/// Position of a sample of that leaf. Game units.
Vec3f CubePosition(const bspLeaf_t &leaf, const bspCubeSample_t &sample);
/// The nearest position that a sample of the leaf can have.
std::array<std::uint8_t, 3> EncodeCubePosition(const bspLeaf_t &leaf, const Vec3f &position);

} // namespace q3
