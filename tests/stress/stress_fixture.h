// GPL-2.0-or-later. What every lit map must fulfil, whatever was in it.
#pragma once

#include "common/error.h"
#include "q3map2/bspfile/bspfile.h"
#include "tests/light/light_fixture.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace q3::test {

class StressTest : public LightTest {
  protected:
    /// Lights the map with one worker and with three: the same bytes, all coefficients finite, no negative mean, legal
    /// legacy points. Returns the lit map.
    Bsp LitSoundly(const Bsp &bsp, std::string_view options = "-gridsh 64 64 64") {
        Bsp lit = Lit(bsp, options, 1);
        const LightResult one = result;
        const Bsp other = Lit(bsp, options, 3);
        EXPECT_TRUE(SameGrids(lit, other)) << "three workers give other bytes than one";
        EXPECT_EQ(one.gridSH.counts.rays, result.gridSH.counts.rays);
        const GridView grid(lit);
        int unsound = 0;
        for (std::size_t i = 0; i < grid.Count() && unsound < 3; i++) {
            const Coefficients c = grid.At(i);
            if (AllFinite(c) && std::min({c[0].x, c[0].y, c[0].z}) >= 0)
                continue;
            unsound++;
            const Vec3d p = grid.Position(i);
            ADD_FAILURE() << "at " << p.x << ' ' << p.y << ' ' << p.z << ": mean " << c[0].x << ' ' << c[0].y << ' '
                          << c[0].z << ", largest " << Largest(c);
        }
        return lit;
    }
    Bsp LitSoundly(const SceneBuilder &scene, std::string_view options = "-gridsh 64 64 64") {
        return LitSoundly(scene.Build(), options);
    }
    /// The same, or an Error that names the entity or key.
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
    static bool SameGrids(const Bsp &a, const Bsp &b) {
        const auto samePoint = [](const bspGridPointSH_t &x, const bspGridPointSH_t &y) {
            return x.coeffs == y.coeffs;
        };
        return a.gridPoints.size() == b.gridPoints.size() &&
               std::equal(a.gridPoints.begin(), a.gridPoints.end(), b.gridPoints.begin(),
                          [](const bspGridPoint_t &x, const bspGridPoint_t &y) {
                              return x.ambient == y.ambient && x.directed == y.directed && x.latLong == y.latLong;
                          }) &&
               std::equal(a.gridSH->points.begin(), a.gridSH->points.end(), b.gridSH->points.begin(),
                          b.gridSH->points.end(), samePoint);
    }
};

/// A light entity at that place.
inline Entity PointLight(std::string_view origin, std::string_view intensity = "300") {
    return MakeEntity("light", {{"origin", std::string(origin)}, {"light", std::string(intensity)}});
}

} // namespace q3::test
