// GPL-2.0-or-later. What every lit map must fulfil, whatever was in it.
#pragma once

#include "common/error.h"
#include "common/platform/platform.h"
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/sparse_view.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <string_view>

namespace q3::test {

class StressTest : public LightTest {
  protected:
    static constexpr std::string_view kUniformGrid = "-gridsh 64 64 64", kBothGrids = "-gridsh 64 64 64 -shadaptive";

    /// Lights the map with one worker and with three: the same grids, all coefficients finite, no negative mean, legal
    /// legacy points. The same of the sparse grid, if the options ask for one, wherever it is sampled. Returns the lit
    /// map. Sanitizers, which make a bake 15 times slower, see the one with three workers only.
    Bsp LitSoundly(const Bsp &bsp, std::string_view options = kUniformGrid) {
        Bsp lit = Lit(bsp, options, 3);
        if (!kIsSanitized) {
            const LightResult three = result;
            EXPECT_TRUE(SameGrids(lit, Lit(bsp, options, 1))) << "three workers give other grids than one";
            EXPECT_EQ(three.gridSH.counts.rays, result.gridSH.counts.rays);
        }
        const GridView grid(lit);
        unsound_ = 0;
        for (std::size_t i = 0; i < grid.Count(); i++)
            ExpectSound(grid.At(i), grid.Position(i), "");
        if (lit.sparseGridSH)
            ExpectSound(*lit.sparseGridSH, grid.Grid().header);
        return lit;
    }
    Bsp LitSoundly(const SceneBuilder &scene, std::string_view options = kUniformGrid) {
        return LitSoundly(scene.Build(), options);
    }
    /// The same, or an Error whose text contains `name`.
    void LitSoundlyOrRefused(const SceneBuilder &scene, std::string_view options, std::string_view name) {
        try {
            LitSoundly(scene, options);
        } catch (const Error &error) {
            EXPECT_NE(std::string_view(error.what()).find(name), std::string_view::npos) << error.what();
        }
    }

    /// A shader that shines with a hemisphere's worth of `add` (byte scale), white, without backsplash.
    void LampShader(std::string_view name, double add, std::string_view more = "") {
        Script(fmt::format("{}\n{{\n\tq3map_surfacelight {}\n\tq3map_lightRGB 1 1 1\n\tq3map_backsplash 0 0\n\t{}\n"
                           "\t{{\n\t\tmap $whiteimage\n\t}}\n}}\n",
                           name, add / 0.75, more));
    }

  private:
    static constexpr int kReported = 3; ///< unsound values of a map

    void ExpectSound(const Coefficients &c, const Vec3d &p, std::string_view grid) {
        if (unsound_ == kReported || (AllFinite(c) && std::min({c[0].x, c[0].y, c[0].z}) >= 0))
            return;
        unsound_++;
        ADD_FAILURE() << grid << "at " << p.x << ' ' << p.y << ' ' << p.z << ": mean " << c[0].x << ' ' << c[0].y << ' '
                      << c[0].z << ", largest " << Largest(c);
    }
    /// At random positions up to two cells outside the uniform grid, and at the corners of smallest cells next to them.
    void ExpectSound(const SparseGridSH &grid, const bspGridSHHeader_t &uniform) {
        const SparseView view(grid);
        std::mt19937 random(7);
        for (int i = 0; i < 200; i++) {
            Vec3d position, corner;
            for (std::size_t axis = 0; axis < 3; axis++) {
                std::uniform_real_distribution<double> cells(-2, uniform.gridBounds[axis] + 1);
                const double mins(grid.mins[axis]), cell(grid.cell[axis]);
                position[axis] = double(uniform.gridMins[axis]) + double(uniform.gridSize[axis]) * cells(random);
                corner[axis] = mins + cell * std::round((position[axis] - mins) / cell);
            }
            ExpectSound(view.Sample(position), position, "sparse, ");
            ExpectSound(view.Sample(corner), corner, "sparse, ");
        }
    }
    static std::vector<std::byte> SparseLump(const Bsp &bsp) {
        return bsp.sparseGridSH ? EncodeSparseGrid(*bsp.sparseGridSH) : std::vector<std::byte>();
    }
    static bool SameGrids(const Bsp &a, const Bsp &b) {
        const auto samePoint = [](const bspGridPointSH_t &x, const bspGridPointSH_t &y) {
            return x.coeffs == y.coeffs;
        };
        return a.gridPoints.size() == b.gridPoints.size() &&
               std::equal(a.gridPoints.begin(), a.gridPoints.end(), b.gridPoints.begin(),
                          [](const bspGridPoint_t &x, const bspGridPoint_t &y) { return x == y; }) &&
               std::equal(a.gridSH->points.begin(), a.gridSH->points.end(), b.gridSH->points.begin(),
                          b.gridSH->points.end(), samePoint) &&
               SparseLump(a) == SparseLump(b);
    }

    int unsound_ = 0; ///< reported for the last map
};

/// A light entity at that place.
inline Entity PointLight(std::string_view origin, std::string_view intensity = "300") {
    return MakeEntity("light", {{"origin", std::string(origin)}, {"light", std::string(intensity)}});
}

} // namespace q3::test
