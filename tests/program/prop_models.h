// GPL-2.0-or-later. MD3 models for tests of static props.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace q3::test {

/// A vertex of a model; the normal is of a few directions that the format holds exactly.
struct TestVert {
    Vec3f xyz;
    Vec3f normal{0, 0, 1}; ///< along an axis
    std::array<float, 2> st{};
};

/// A mesh of an MD3 model. Triangles are clockwise seen from the front.
struct TestMesh {
    std::string shader = "textures/test/pillar";
    std::vector<TestVert> verts;
    std::vector<std::array<int, 3>> triangles;

    /// A grid of side x side cells in the plane of z, from (low, low) to (high, high), facing up; st from 0 to 1.
    void AddSheet(float low, float high, int side, float z);
    /// The sheet from `low` to `high`, one cell.
    void AddPlate(const Vec3f &low, const Vec3f &high);
    /// Four walls around the z axis at distance `radius`, with vertices at these heights; no top and no bottom.
    void AddWalls(float radius, const std::vector<float> &heights);
};

/// The bytes of an MD3 file with one frame, by the published layout of the format.
std::vector<std::byte> Md3Of(const std::vector<TestMesh> &meshes);

} // namespace q3::test
