// GPL-2.0-or-later. SH grids with light of closed forms.
#pragma once

#include "q3map2/gridformats/legacy_encode.h"

#include <gtest/gtest.h>

#include <functional>

namespace q3::test {

/// Convolved coefficients of the same light from all sides.
bspGridPointSH_t ConstantLight(const Vec3d &color);
/// Convolved coefficients of a light in one direction, of that color on surfaces which face it.
bspGridPointSH_t LightFrom(const Vec3d &direction, const Vec3d &color);
bspGridPointSH_t operator+(bspGridPointSH_t a, const bspGridPointSH_t &b);

/// A grid of 32 units with the light of each position.
StoredGridSH SampleGrid(const Int3 &bounds, const Float3 &mins,
                        const std::function<bspGridPointSH_t(const Vec3f &)> &light);

/// A world of these bounds: solid where x is below `wall`, else open.
Bsp WorldWithWall(const Float3 &mins, const Float3 &maxs, float wall);

/// All points of a legacy grid of 64 x 64 x 128 in the open.
LegacyPoints OpenPoints(const GridSource &source, const GridLayout &layout);

/// The 26 directions to faces, edges and corners of a cube.
std::vector<Vec3f> ProbeNormals();

template <typename T> std::span<const std::byte> BytesOf(const std::vector<T> &records) {
    return std::as_bytes(std::span(records));
}

} // namespace q3::test
