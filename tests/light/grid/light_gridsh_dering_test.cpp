// GPL-2.0-or-later. SH grid: -shdering takes negative lobes away and nothing else.
#include "tests/support/light_fixture.h"

#include "common/arguments.h"
#include "libs/sh/sh.h"
#include "q3map2/light/grid/light_gridsh.h"

#include "common/error.h"

#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>

namespace q3::test {

namespace {

using GridSHDeringTest = LightTest;

/// Near the colored lamps light comes from one side, which rings; far from both it does not everywhere.
SceneBuilder TwoLamps() {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", "12");
    scene.AddEntity(MakeEntity("light", {{"origin", "-200 0 120"}, {"light", "60"}, {"_color", "1 0.5 0.2"}}));
    scene.AddEntity(MakeEntity("light", {{"origin", "190 30 90"}, {"light", "50"}, {"_color", "0.2 0.4 1"}}));
    return scene;
}

double Lowest(const Coefficients &c, std::size_t channel) {
    double lowest = std::numeric_limits<double>::max();
    for (int i = 0; i < 2000; i++) {
        const double z = 1 - (2 * i + 1.0) / 2000, turn = 2.39996322972865 * i;
        const Vec3d n{std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z};
        lowest = std::min(lowest, Evaluate(c, n)[channel]);
    }
    return lowest;
}

TEST_F(GridSHDeringTest, NothingIsNegativeAndOnlyRingingPointsChange) {
    for (const std::string_view form : {"-sh", "-sh -shradiance"}) {
        const GridView plain = LitGrid(TwoLamps(), form), clean = LitGrid(TwoLamps(), std::string(form) + " -shdering");
        EXPECT_TRUE(Printed("points rid of negative lobes"));
        ASSERT_EQ(plain.Count(), clean.Count());
        int kept = 0, changed = 0;
        for (std::size_t i = 0; i < plain.Count(); i++)
            for (std::size_t channel = 0; channel < 3; channel++) {
                const Coefficients before = plain.At(i), after = clean.At(i);
                EXPECT_EQ(before[0][channel], after[0][channel]);
                EXPECT_GE(Lowest(after, channel), 0);
                bool same = true;
                for (std::size_t k = 1; k < 9; k++)
                    same = same && before[k][channel] == after[k][channel];
                // What lies between the directions tried may be a little lower.
                const double lowest = Lowest(before, channel);
                EXPECT_FALSE(same && lowest < 0);
                EXPECT_FALSE(!same && lowest > 0.01 * before[0][channel]);
                (same ? kept : changed)++;
            }
        EXPECT_GT(kept, 100);
        EXPECT_GT(changed, 50);
    }
}

TEST_F(GridSHDeringTest, NothingBetweenPointsIsNegative) {
    const GridView grid = LitGrid(TwoLamps(), "-sh -shdering");
    for (int i = 0; i < 500; i++) {
        const Vec3d p{-240 + 480 * std::fmod(0.7548776662466927 * i, 1), -180 + 360 * std::fmod(0.569840290998 * i, 1),
                      10 + 180 * std::fmod(0.6180339887 * i, 1)};
        for (std::size_t channel = 0; channel < 3; channel++)
            EXPECT_GE(Lowest(grid.Sample(p), channel), 0);
    }
}

TEST_F(GridSHDeringTest, TheSameBytesFromAnyNumberOfThreads) {
    const Bsp one = Lit(TwoLamps(), "-sh -shdering", 1), three = Lit(TwoLamps(), "-sh -shdering", 3);
    for (std::size_t i = 0; i < one.gridSH->points.size(); i++)
        EXPECT_EQ(one.gridSH->points[i].coeffs, three.gridSH->points[i].coeffs);
}

TEST_F(GridSHDeringTest, ReportsTheLargestChange) {
    // Green is 0.5 + n.x, which is negative around -x. Red and blue stay.
    bspGridPointSH_t point{};
    const double mean = 0.5 / kSHC0;
    point.coeffs[0] = {float(mean), float(mean), 0};
    point.coeffs[3][1] = float(1 / kSHC1);
    const bspGridPointSH_t before = point;
    const DeringStats stats = DeringPoint(point, false);
    EXPECT_EQ(stats.points, 1);
    double largest = 0;
    for (const Vec3d &n : Normals()) {
        const auto shown = [&](const bspGridPointSH_t &p) {
            Coefficients c;
            for (std::size_t k = 0; k < 9; k++)
                c[k] = Vec3d(p.coeffs[k]);
            return 255 * std::clamp(Evaluate(c, n).y, 0.0, 1.0);
        };
        largest = std::max(largest, std::abs(shown(point) - shown(before)));
    }
    EXPECT_GT(largest, 10);
    EXPECT_NEAR(stats.largestChange, largest, 1e-3);
    for (std::size_t k = 0; k < 9; k++) {
        EXPECT_EQ(point.coeffs[k][0], before.coeffs[k][0]);
        EXPECT_EQ(point.coeffs[k][2], 0);
    }
    EXPECT_EQ(DeringPoint(point, false).points, 0);
}

TEST_F(GridSHDeringTest, NeedsAGrid) {
    Log log(Log::Nowhere());
    for (const char *option : {"-shdering", "-sherror", "-shfit", "-shpreview x.png"}) {
        std::istringstream text{std::string(option)};
        Arguments arguments({std::istream_iterator<std::string>(text), {}});
        EXPECT_THROW(ParseLightOptions(arguments, *FindGame("quake3"), log), Error) << option;
    }
}

} // namespace

} // namespace q3::test
