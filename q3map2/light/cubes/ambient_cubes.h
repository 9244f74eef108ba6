// GPL-2.0-or-later. Ambient cubes of the leafs of a map: at positions in a leaf, and the choice of those to keep.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/sources/light_sources.h"

#include <array>
#include <cstddef>
#include <optional>
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

/// Keeps at most `maxCount` samples. Greedy: each step adds the sample that most lowers the error of BlendCubes at the
/// positions of all samples, and stops when none lowers it, since a sample beside a light, far brighter than a screen
/// shows, can spoil the blend of a whole leaf. Error: sum of squared differences of light^(1/2), light clamped to 1.
void KeepBestCubes(std::size_t maxCount, std::vector<CubeSample> &samples);

/// Removes samples that the rest reproduce, those with the smallest error first: at each removed position, the blend of
/// the rest differs by a ScreenDifference of at most `tolerance`. At least one is left.
void ThinOutCubes(float tolerance, std::vector<CubeSample> &samples);

/// Ambient cubes by leaf. Leafs in solids and leafs without an open place have none.
using LeafCubes = std::vector<std::vector<CubeSample>>;

/// Light at up to options.cubesPerLeaf places of each leaf that is in a cluster. lights: from SetupEnvelopes for the SH
/// grid, of style 0 only. grid: the SH grid to evaluate; null: light is traced. Adds the number of places to
/// stats.points, the number of leafs with samples to stats.open.
LeafCubes SampleLeafs(const GridInputs &in, const std::vector<Light> &lights, const LightGridSH *grid,
                      GridStats &stats);

/// Thins out the samples (ThinOutCubes) and stores them by leaf. If more than `maxSamples` are left, the tolerance is
/// raised until they fit, with a warning. A leaf without samples refers to the nearest leaf with samples that it sees,
/// or else to the nearest one. Empty if no leaf has samples. Errors: more leafs with samples than `maxSamples`.
std::optional<AmbientCubes> StoreCubes(const BspSpace &space, const LeafCubes &leafs, float tolerance,
                                       const JobPool &jobs, Log &log, std::size_t maxSamples = kMostCubes);

} // namespace q3
