// GPL-2.0-or-later. Samples of triangles in the grid of a lightmap.
#include "q3map2/lightmap/luxel_raster.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

using Luxels = std::vector<std::array<float, 2>>;

/// A vertex of a surface that lies in the grid.
SurfaceVertex At(float s, float t) {
    SurfaceVertex v;
    v.xyz = {16 * s, 16 * t, 8}, v.normal = {0, 0, 1}, v.luxel = {s, t};
    return v;
}

std::vector<std::array<SurfaceVertex, 3>> SomeTriangles() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(0, 40);
    std::vector<std::array<SurfaceVertex, 3>> triangles;
    for (int i = 0; i < 20; ++i)
        triangles.push_back(
            {At(place(random), place(random)), At(place(random), place(random)), At(place(random), place(random))});
    triangles.push_back({At(0, 0), At(32, 0), At(0, 32)});
    return triangles;
}

LuxelVertex Short(const SurfaceVertex &v) {
    return {LuxelVertex::Pair{v.luxel[0], v.luxel[1]}};
}

std::array<float, 2> LuxelOf(LuxelVertex v) {
    return {v.luxel[0], v.luxel[1]};
}

TEST(LuxelRasterTest, EveryLuxelInsideATriangleGetsASample) {
    constexpr int kSide = 33;
    std::vector<int> hits(kSide * kSide);
    SubdivideTriangle<true>(At(0, 0), At(kSide, 0), At(0, kSide), 1.0f, [&](const SurfaceVertex &v) {
        EXPECT_FLOAT_EQ(v.xyz.x, 16 * v.luxel[0]);
        ++hits[std::size_t(int(v.luxel[1]) * kSide + int(v.luxel[0]))];
    });
    for (int t = 0; t < kSide; ++t)
        for (int s = 0; s + t + 2 < kSide; ++s)
            EXPECT_GT(hits[std::size_t(t * kSide + s)], 0) << s << " " << t;
}

TEST(LuxelRasterTest, ShortVerticesGetTheSameSamples) {
    for (const auto &[a, b, c] : SomeTriangles()) {
        Luxels whole, brief;
        SubdivideTriangle<true>(a, b, c, 1.0f, [&](const SurfaceVertex &v) { whole.push_back(v.luxel); });
        SubdivideTriangle<true>(Short(a), Short(b), Short(c), 1.0f,
                                [&](LuxelVertex v) { brief.push_back(LuxelOf(v)); });
        EXPECT_EQ(whole, brief);
    }
}

TEST(LuxelRasterTest, EdgesGetTheSamplesOfATriangleWithoutWidthEachOnce) {
    for (const auto &[a, b, c] : SomeTriangles()) {
        Luxels thin, edge;
        SubdivideTriangle<true>(a, b, b, 1.0f, [&](const SurfaceVertex &v) {
            if (std::find(thin.begin(), thin.end(), v.luxel) == thin.end())
                thin.push_back(v.luxel);
        });
        SubdivideEdge(Short(a), Short(b), 1.0f, [&](LuxelVertex v) { edge.push_back(LuxelOf(v)); });
        EXPECT_EQ(thin, edge);
        EXPECT_FALSE(edge.empty());
    }
}

} // namespace

} // namespace q3::test
