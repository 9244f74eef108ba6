// GPL-2.0-or-later. Ambient and directed light fitted to SH coefficients.
#include "q3map2/gridformats/grid_source.h"
#include "tests/gridformats/sample_grid.h"

namespace q3::test {

namespace {

/// Sum over normals, evenly spread, of the squared difference of a fit from the light, red.
double SquaredError(const bspGridPointSH_t &light, double ambient, double directed, const Vec3d &direction) {
    constexpr int kNormals = 4000;
    double sum = 0;
    for (int i = 0; i < kNormals; ++i) { // a Fibonacci lattice
        const double z = 1 - (2 * i + 1.0) / kNormals, radius = std::sqrt(1 - z * z), angle = 2.399963229728653 * i;
        const Vec3d n{radius * std::cos(angle), radius * std::sin(angle), z};
        // Light without its limit at 0, which LightOn applies: lifted out of its reach.
        const double lift = 100;
        const double exact = LightOn(light + ConstantLight({lift, lift, lift}), n).x - lift;
        const double error = exact - ambient - directed * std::max(0.0, Dot(n, direction));
        sum += error * error / kNormals;
    }
    return sum;
}

TEST(AmbientDirectedFit, ConstantLightIsAmbient) {
    const AmbientDirected fit = FitAmbientDirected(ConstantLight({1, 0.5, 0}));
    EXPECT_NEAR(fit.ambient.x, 1, 1e-6);
    EXPECT_NEAR(fit.ambient.y, 0.5, 1e-6);
    EXPECT_NEAR(fit.ambient.z, 0, 1e-6);
    EXPECT_NEAR(Length(fit.directed), 0, 1e-6);
    EXPECT_EQ(fit.direction, (Vec3d{0, 0, 1}));
}

TEST(AmbientDirectedFit, OneLightIsDirected) {
    for (const Vec3d &direction : {Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, 1}, Vec3d{2, -1, 2} / 3.0}) {
        const AmbientDirected fit = FitAmbientDirected(LightFrom(direction, {1, 0, 0.25}));
        EXPECT_NEAR(fit.ambient.x, 0.003125, 1e-6);
        EXPECT_NEAR(fit.directed.x, 0.9875, 1e-6);
        EXPECT_NEAR(fit.directed.z, 0.9875 / 4, 1e-6);
        EXPECT_NEAR(fit.directed.y, 0, 1e-6);
        EXPECT_NEAR(Length(fit.direction - direction), 0, 1e-6);
    }
}

TEST(AmbientDirectedFit, NothingNearbyIsNearer) {
    const auto light =
        LightFrom({1, 2, 2}, {1, 0, 0}) + LightFrom({-1, 0, 1}, {0.4, 0, 0}) + ConstantLight({0.1, 0, 0});
    const AmbientDirected fit = FitAmbientDirected(light);
    const double best = SquaredError(light, fit.ambient.x, fit.directed.x, fit.direction);
    for (const double step : {-0.01, 0.01}) {
        EXPECT_GT(SquaredError(light, fit.ambient.x + step, fit.directed.x, fit.direction), best);
        EXPECT_GT(SquaredError(light, fit.ambient.x, fit.directed.x + step, fit.direction), best);
    }
}

// Red opposes the direction that green gives, blue has too little ambient light for its directed part.
TEST(AmbientDirectedFit, NegativePartsBecomeZeroAndTheOtherIsFittedAnew) {
    bspGridPointSH_t light = LightFrom({1, 0, 0}, {0, 1, 0}) + LightFrom({-1, 0, 0}, {0.5, 0, 0});
    for (std::size_t k = 0; k < 4; ++k)
        light.coeffs[k][2] = 0.1f * LightFrom({1, 0, 0}, {0, 0, 1}).coeffs[k][2];
    light.coeffs[3][2] *= 4;
    const AmbientDirected fit = FitAmbientDirected(light);
    EXPECT_EQ(fit.directed.x, 0);
    EXPECT_NEAR(fit.ambient.x, 0.125, 1e-6) << "the mean over all normals is a quarter of the light";
    EXPECT_EQ(fit.ambient.z, 0);
    // The integral of light times max(0, n . x): band 0 gives pi/4, band 1 pi/3 times 4, each times 0.1.
    const double lobe = 0.1 * std::numbers::pi * (0.25 + 4.0 / 3);
    EXPECT_NEAR(fit.directed.z, 3 * lobe / (2 * std::numbers::pi), 1e-6);
}

TEST(AmbientDirectedFit, LightThatIsTakenAwayIsBlack) {
    const AmbientDirected fit = FitAmbientDirected(ConstantLight({-1, -1, -1}));
    EXPECT_EQ(fit.ambient, (Vec3d{}));
    EXPECT_EQ(fit.directed, (Vec3d{}));
}

// An engine that shows at least 0.1 of ambient light gets less directed light: no other amount is nearer.
TEST(AmbientDirectedFit, LeastAmbientLight) {
    const auto light = LightFrom({1, 2, 2}, {1, 0, 0});
    const AmbientDirected fit = FitAmbientDirected(light, 0.1);
    EXPECT_EQ(fit.ambient.x, 0.1);
    EXPECT_LT(fit.directed.x, 0.9);
    const double best = SquaredError(light, 0.1, fit.directed.x, fit.direction);
    for (const double step : {-0.01, 0.01})
        EXPECT_GT(SquaredError(light, 0.1, fit.directed.x + step, fit.direction), best);
    EXPECT_EQ(FitAmbientDirected(ConstantLight({}), 0.1).directed.x, 0);
}

TEST(AmbientDirectedFit, OneColorKeepsTheMean) {
    for (const double share : {0.25, 0.4})
        for (const auto &light : {LightFrom({0, 1, 1}, {1, 0.2, 0.5}), ConstantLight({0.3, 0.2, 1}),
                                  LightFrom({0, 0, 1}, {1, 1, 1}) + ConstantLight({0.2, 0, 0.1})}) {
            const AmbientDirected fit = FitMeanAndDirected(light, share);
            const Vec3d kept = fit.ambient + fit.directed * share;
            EXPECT_NEAR(Length(kept - MeanLight(light)), 0, 1e-6) << share;
            EXPECT_GE(std::min({fit.ambient.x, fit.ambient.y, fit.ambient.z}), 0);
        }
    EXPECT_NEAR(MeanLight(LightFrom({0, 0, 1}, {1, 1, 1})).x, 0.25, 1e-6);
}

} // namespace

} // namespace q3::test
