// GPL-2.0-or-later. A small valid map for the tests.
#pragma once

#include "common/error.h"
#include "q3map2/bspfile/bsp.h"
#include "tests/support/kept_log.h"

#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace q3::test {

/// The layout of Quake Live.
inline const BspFormat kQuakeLive{.version = 47, .advertisements = true};

/// A slab of floor under a room: two nodes, four leafs, two brushes, a quad, a 3x3 patch, a soup triangle and a flare,
/// a fog, two clusters, a light grid of 3 x 3 x 2 points. No lightmap page, no advertisement, no SH grid.
Bsp SampleBsp();
/// 2 x 3 x 1 points whose coefficients are all different.
LightGridSH SampleGridSH();
/// The bytes of its lump: 40 of the head, 108 a point.
std::vector<std::byte> GridLump(const LightGridSH &grid);
/// Advertisement with finite fields.
bspAdvertisement_t SampleAdvertisement();

/// Text of the Error that `action` throws, or "no error".
std::string ErrorOf(const std::function<void()> &action);

/// Reads a 32-bit integer of a file image, and writes one.
std::int32_t IntAt(const std::vector<std::byte> &file, std::size_t at);
void SetInt(std::vector<std::byte> &file, std::size_t at, std::int32_t value);

} // namespace q3::test
