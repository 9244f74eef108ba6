// GPL-2.0-or-later. Ambient cubes at positions in a leaf, and the choice of those to keep.
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

/// A sample as stored, and decoded as readers decode it.
struct CubeSample {
    bspCubeSample_t stored;
    Vec3f position;
    CubeSides sides;
};

/// Encodes and decodes a sample; negative light becomes 0. position: 0..255 across the bounds of the leaf.
CubeSample MakeCubeSample(const bspLeaf_t &leaf, const std::array<std::uint8_t, 3> &position, const CubeSides &sides);

/// Blend of samples at a position, with weights 1 / (distance^2 + 1). At least one sample.
CubeSides BlendCubes(std::span<const CubeSample> samples, const Vec3f &position);

/// Largest difference over sides and channels, in bytes of a screen of gamma 2.2.
float ScreenDifference(const CubeSides &a, const CubeSides &b);

/// Keeps at most `most` samples. Greedy: each step adds the sample that most lowers the error of BlendCubes at the
/// positions of all samples, and stops when none lowers it, since a sample beside a lamp, far brighter than a screen
/// shows, can spoil the blend of a whole leaf. Error: sum of squared differences of light^(1/2), light clamped to 1.
void KeepBestCubes(std::size_t most, std::vector<CubeSample> &samples);

/// Removes samples that the rest reproduce, those with the smallest error first: at each removed position, the blend of
/// the rest differs by a ScreenDifference of at most `tolerance`. At least one is left.
void ThinOutCubes(float tolerance, std::vector<CubeSample> &samples);

} // namespace q3
