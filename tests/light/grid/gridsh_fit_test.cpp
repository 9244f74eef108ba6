// GPL-2.0-or-later. SH grid: points fitted to the light between them.
#include "common/error.h"
#include "tests/support/light_fixture.h"

#include <algorithm>
#include <cmath>

namespace q3::test {

namespace {

using FitTest = LightTest;

constexpr Vec3d kLamp{0, 0, 150};
constexpr double kIntensity = 300;

/// A room whose walls are off the planes of points, with a light that falls off over a few cells.
SceneBuilder LitRoom() {
    SceneBuilder scene = Room({-250, -186, -60}, {250, 186, 196});
    scene.AddEntity(MakeEntity("light", {{"origin", "0 0 150"}, {"light", "300"}}));
    return scene;
}

/// Root of the mean square of what interpolation errs by at receivers `clear` units off the walls and 60 off the light,
/// between `low` and `high` along x.
double ErrorBetween(const GridView &grid, double low, double high, double clear = 17) {
    double sum = 0;
    int count = 0;
    for (double x = low; x <= high; x += 7)
        for (double y = -186 + clear; y <= 186 - clear; y += 11)
            for (double z = -60 + clear; z <= 196 - clear; z += 13) {
                const Vec3d p{x, y, z};
                if (Length(p - kLamp) < 60)
                    continue;
                const Coefficients shown = grid.Sample(p), right = FromPoint(p, kLamp, kIntensity);
                for (std::size_t k = 0; k < 9; ++k)
                    sum += (shown[k].x - right[k].x) * (shown[k].x - right[k].x);
                ++count;
            }
    return std::sqrt(sum / count);
}

TEST_F(FitTest, PointsInSolidsMakeTheLightBesideWallsRight) {
    const SceneBuilder scene = LitRoom();
    const GridView plain = LitGrid(scene, "-gridsh 48 48 48 -noshfill"), fitted = LitGrid(scene, "-gridsh 48 48 48");
    EXPECT_LT(ErrorBetween(fitted, 205, 233), 0.7 * ErrorBetween(plain, 205, 233));
    // Points in the open stay what they were.
    for (std::size_t i = 0; i < plain.Count(); ++i)
        if (Inside(plain.Position(i), RoomBounds(), 4)) {
            ASSERT_EQ(Difference(plain.At(i), fitted.At(i)), 0) << i;
        }
}

TEST_F(FitTest, AllPointsFittedErrLessBetweenThem) {
    const SceneBuilder scene = LitRoom();
    const GridView usual = LitGrid(scene, "-gridsh 48 48 48"), fitted = LitGrid(scene, "-gridsh 48 48 48 -shfit 8");
    // So far from the light that no side of anything is beyond white: what is counts less.
    EXPECT_LT(ErrorBetween(fitted, -233, -110), 0.95 * ErrorBetween(usual, -233, -110));
}

TEST_F(FitTest, ValuesStayNearTheRangeOfLight) {
    const SceneBuilder scene = LitRoom();
    for (const char *options : {"-gridsh 48 48 48", "-gridsh 48 48 48 -shfit 4", "-gridsh 48 48 48 -shradiance"}) {
        const bool radiance = std::string_view(options).find("radiance") != std::string_view::npos;
        const GridView grid = LitGrid(scene, options);
        for (std::size_t i = 0; i < grid.Count(); ++i) {
            const Coefficients c = grid.At(i);
            double bands = 0;
            for (std::size_t k = 1; k < 9; ++k)
                bands += c[k].x * c[k].x;
            // Light from one direction has the most: sqrt(8) of the mean, and 1.2829 when convolved. A quarter beyond
            // that makes up for blends.
            EXPECT_LE(std::sqrt(bands), (radiance ? std::sqrt(8.0) : 1.28291) * c[0].x * 1.2501) << options << " " << i;
        }
    }
}

TEST_F(FitTest, FittingAllPointsKeepsTheOtherSideOfAThinWallDark) {
    SceneBuilder scene = Room({-250, -186, -60}, {250, 186, 196});
    scene.AddBox({10, -186, -60}, {18, 186, 196}, TestShader("textures/test/wall"));
    scene.AddEntity(MakeEntity("light", {{"origin", "120 0 70"}, {"light", "300"}}));
    const GridView grid = LitGrid(scene, "-gridsh 32 32 32 -shfit");
    const double lit = FromPoint({40, 0, 70}, {120, 0, 70}, 300)[0].x;
    for (double x = -200; x <= -22; x += 6)
        EXPECT_LT(grid.Sample({x, 0, 70})[0].x, 0.01 * lit) << x;
}

TEST_F(FitTest, PointsInTheirPlaneDoNotDarkenWhatIsBesideASheetOfLight) {
    SceneBuilder scene = Room();
    scene.AddQuad({{{0, -96, 32}, {0, -96, 160}, {0, 96, 160}, {0, 96, 32}}}, TestShader("textures/vec/lite_two"));
    const GridView seen = LitGrid(scene, "-gridsh 64 64 64"), unseen = LitGrid(scene, "-gridsh 64 64 64 -noshfill");
    // Light on what faces the sheet, a cell away and near it. One value in the plane serves both sides.
    for (const double side : {1.0, -1.0}) {
        const double away = Evaluate(seen.Sample({64 * side, 0, 64}), {-side, 0, 0}).x;
        EXPECT_GT(Evaluate(seen.Sample({24 * side, 0, 64}), {-side, 0, 0}).x, 0.75 * away);
        EXPECT_LT(Evaluate(unseen.Sample({24 * side, 0, 64}), {-side, 0, 0}).x, 0.5 * away);
    }
}

TEST_F(FitTest, SameBytesForAnyNumberOfThreads) {
    const SceneBuilder scene = LitRoom();
    const GridView one = GridView(Lit(scene, "-gridsh 32 32 32 -shfit 3", 1));
    const GridView three = GridView(Lit(scene, "-gridsh 32 32 32 -shfit 3", 3));
    ASSERT_EQ(one.Count(), three.Count());
    for (std::size_t i = 0; i < one.Count(); ++i)
        ASSERT_EQ(Difference(one.At(i), three.At(i)), 0) << i;
}

TEST_F(FitTest, TakesNoNumberOfSamplesBeyondItsRange) {
    EXPECT_THROW(Lit(LitRoom(), "-shfit 65"), Error);
    EXPECT_THROW(Lit(LitRoom(), "-shfit -noshfill"), Error);
    EXPECT_NO_THROW(Lit(LitRoom(), "-gridsh 64 64 64 -shfit"));
}

} // namespace

} // namespace q3::test
