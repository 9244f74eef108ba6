// GPL-2.0-or-later. Functions for vector code against the standard library.
#include "libs/math/lane_functions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace q3 {
namespace {

TEST(LaneFunctions, SineAndCosineAreRightTo1e15) {
    for (int i = -100000; i <= 100000; ++i) {
        const double angle = std::numbers::pi * i / 100000;
        const auto [sine, cosine] = SineCosineOf(angle);
        EXPECT_NEAR(sine, std::sin(angle), 1e-15);
        EXPECT_NEAR(cosine, std::cos(angle), 1e-15);
    }
}

TEST(LaneFunctions, AnglesAreRightToTheirOwnSize) {
    for (double angle = 1e-300; angle <= std::numbers::pi; angle *= 1.01) {
        const double y = std::sin(angle), x = std::cos(angle);
        EXPECT_NEAR(AngleOf(y, x) / std::atan2(y, x), 1, 2e-15) << angle;
    }
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1, 1), power(-100, 100);
    for (int i = 0; i < 100000; ++i) {
        const double y = std::abs(any(random)) * std::exp(power(random)), x = any(random) * std::exp(power(random));
        EXPECT_NEAR(AngleOf(y, x) / std::atan2(y, x), 1, 2e-15) << y << ' ' << x;
    }
}

TEST(LaneFunctions, AnglesInFloatsAreRightTo3e7) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> any(-1, 1);
    for (int i = 0; i < 100000; ++i) {
        const float y = std::abs(any(random)), x = any(random);
        EXPECT_NEAR(AngleOf(y, x), std::atan2(y, x), 5e-7f) << y << ' ' << x;
    }
    EXPECT_EQ(AngleOf(0.0f, 0.0f), 0);
}

TEST(LaneFunctions, AnglesOnTheAxes) {
    EXPECT_EQ(AngleOf(0.0, 0.0), 0);
    EXPECT_EQ(AngleOf(0.0, 5.0), 0);
    EXPECT_DOUBLE_EQ(AngleOf(5.0, 0.0), std::numbers::pi / 2);
    EXPECT_DOUBLE_EQ(AngleOf(0.0, -5.0), std::numbers::pi);
}

} // namespace
} // namespace q3
