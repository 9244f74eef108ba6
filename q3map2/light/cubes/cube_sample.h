// GPL-2.0-or-later. Ambient cubes at positions of a leaf, and which of them are kept.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace q3 {

/// Light on surfaces that face +x, -x, +y, -y, +z, -z; 1 = byte 255.
using CubeSides = std::array<Vec3f, 6>;

/// A sample as it is stored, and what a reader makes of it.
struct CubeSample {
    bspCubeSample_t stored;
    Vec3f position;
    CubeSides sides;
};

/// The sample of a leaf with that stored position and those sides, negative light cut off.
CubeSample MakeCubeSample(const bspLeaf_t &leaf, const std::array<std::uint8_t, 3> &position, const CubeSides &sides);

/// Blend of samples at a position, with weights 1 / (distance^2 + 1). At least one sample.
CubeSides BlendCubes(std::span<const CubeSample> samples, const Vec3f &position);

/// Largest difference of a side and channel, in steps of 255 on a screen of gamma 2.2.
float ScreenDifference(const CubeSides &a, const CubeSides &b);

/// Keeps at most `most` samples: chosen one by one, each time the one with which the blend of those chosen shows all
/// samples best, by the sum of squared differences of light on a screen of gamma 2, cut at 1. Fewer if more would not
/// help. A sample beside a lamp, far brighter than a screen shows, would spoil the blend of a whole leaf.
void KeepBestCubes(std::size_t most, std::vector<CubeSample> &samples);

/// Removes samples that the rest reproduces, the best reproduced first: at each removed position, the blend of what is
/// left differs by at most `tolerance`, see ScreenDifference. At least one is left.
void ThinOutCubes(float tolerance, std::vector<CubeSample> &samples);

} // namespace q3
