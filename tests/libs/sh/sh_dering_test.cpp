// GPL-2.0-or-later. Spherical harmonics without negative lobes: nowhere negative.
#include "libs/sh/sh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

constexpr double kRingPi = std::numbers::pi;

/// Spread evenly over the sphere.
std::vector<Vec3d> Directions(int count) {
    std::vector<Vec3d> directions;
    for (int i = 0; i < count; i++) {
        const double z = 1 - (2 * i + 1.0) / count, turn = kRingPi * (3 - std::sqrt(5)) * i;
        directions.push_back({std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z});
    }
    return directions;
}

double Evaluate(const SHVector &c, const Vec3d &n) {
    const SHVector basis = SHBasis(n);
    double sum = 0;
    for (std::size_t k = 0; k < 9; k++)
        sum += c[k] * basis[k];
    return sum;
}

double Lowest(const SHVector &c, const std::vector<Vec3d> &directions) {
    double lowest = std::numeric_limits<double>::max();
    for (const Vec3d &n : directions)
        lowest = std::min(lowest, Evaluate(c, n));
    return lowest;
}

/// Light of one direction: sharp as projected, or convolved with the clamped cosine.
SHVector Delta(const Vec3d &d, double light, bool convolved) {
    SHVector c = SHBasis(d);
    for (std::size_t k = 0; k < 9; k++)
        c[k] *= light * (convolved ? kCosineLobe[k] : 1);
    return c;
}

SHVector Sum(const SHVector &a, const SHVector &b) {
    SHVector sum = a;
    for (std::size_t k = 0; k < 9; k++)
        sum[k] += b[k];
    return sum;
}

/// Sums of lights from a few directions, as at points of a map, and coefficients of any kind.
std::vector<SHVector> Samples(int count) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::vector<SHVector> samples;
    for (int i = 0; i < count; i++) {
        SHVector c{};
        if (i % 2 == 0) {
            const int lights = 1 + i / 2 % 4;
            for (int k = 0; k < lights; k++) {
                const Vec3d d = Normalize(Vec3d{normal(random), normal(random), normal(random)});
                c = Sum(c, Delta(d, std::exp(normal(random)), i % 4 == 0));
            }
        } else {
            const double size = std::pow(10, normal(random)), scale = std::pow(10, 3 * normal(random));
            for (double &x : c)
                x = normal(random) * size * scale;
            c[0] = std::abs(normal(random)) * scale;
        }
        samples.push_back(c);
    }
    return samples;
}

/// What is in memory of a map.
SHVector Rounded(SHVector c) {
    for (double &x : c)
        x = double(float(x));
    return c;
}

TEST(Dering, MinimumIsTheLeastOfAllDirections) {
    const std::vector<Vec3d> directions = Directions(20000);
    for (const SHVector &c : Samples(60)) {
        const SHMinimum found = MinimumOfSH(c);
        double size = 0;
        for (const double x : c)
            size += std::abs(x);
        const double lowest = Lowest(c, directions);
        EXPECT_NEAR(Length(found.direction), 1, 1e-12);
        EXPECT_NEAR(found.value, Evaluate(c, found.direction), 1e-12 * size);
        EXPECT_LE(found.value, lowest + 1e-12 * size);
        EXPECT_GE(found.value, lowest - 1e-3 * size);
    }
}

TEST(Dering, MinimumOfSumsWithoutAUniqueOne) {
    // Uniform, one band only, a ring, a pair of poles: the direction is any of them.
    EXPECT_NEAR(MinimumOfSH({2}).value, 2 * kSHC0, 1e-15);
    EXPECT_NEAR(MinimumOfSH({1, 0, 3}).value, kSHC0 - 3 * kSHC1, 1e-15);
    EXPECT_NEAR(MinimumOfSH({1, 0, 0, 0, 0, 0, 2}).value, kSHC0 - 2 * kSHC3, 1e-15);
    EXPECT_NEAR(MinimumOfSH({1, 0, 0, 0, 0, 0, -2}).value, kSHC0 - 4 * kSHC3, 1e-15);
    EXPECT_NEAR(MinimumOfSH(Delta({0.6, 0, 0.8}, 1, true)).value, 3.0 / 32 - 2.0 / 15, 1e-15);
    EXPECT_EQ(MinimumOfSH({}).value, 0);
}

TEST(Dering, NothingIsNegativeAfterwardsAndTheMeanStays) {
    const std::vector<Vec3d> directions = Directions(100000);
    int changed = 0;
    for (const SHVector &sample : Samples(100)) {
        const SHVector before = Rounded(sample);
        SHVector after = before;
        changed += RemoveNegativeLobes(after);
        EXPECT_EQ(after[0], before[0]);
        EXPECT_GE(Lowest(Rounded(after), directions), 0);
    }
    EXPECT_GT(changed, 80);
}

TEST(Dering, ASecondTimeChangesNothing) {
    for (const SHVector &sample : Samples(2000)) {
        SHVector c = Rounded(sample);
        RemoveNegativeLobes(c);
        const SHVector once = Rounded(c);
        SHVector twice = once;
        EXPECT_FALSE(RemoveNegativeLobes(twice));
        EXPECT_EQ(twice, once);
    }
}

TEST(Dering, WhatIsNowhereNegativeStaysAsItIs) {
    int kept = 0;
    for (const SHVector &sample : Samples(2000)) {
        SHVector c = sample;
        // Raised until its minimum is just above zero.
        c[0] += (std::max(0.0, -MinimumOfSH(c).value) + 1e-9 * std::abs(c[0])) / kSHC0;
        const SHVector before = c;
        EXPECT_FALSE(RemoveNegativeLobes(c));
        kept += c == before;
    }
    EXPECT_EQ(kept, 2000);
}

/// The factors of bands 1 and 2, each the same for all its coefficients that are not zero.
std::array<double, 2> FactorsOf(const SHVector &before, const SHVector &after) {
    std::array<double, 2> factors{1, 1};
    for (std::size_t k = 1; k < 9; k++) {
        double &factor = factors[k < 4 ? 0 : 1];
        if (before[k] == 0)
            continue;
        factor = after[k] / before[k];
        for (std::size_t i = k < 4 ? 1 : 4; i < (k < 4 ? 4u : 9u); i++)
            EXPECT_NEAR(after[i], factor * before[i], 1e-12 * std::abs(before[i]));
    }
    return factors;
}

TEST(Dering, BandsAreScaledByAWindow) {
    int changed = 0;
    for (const SHVector &before : Samples(200)) {
        SHVector after = before;
        if (!RemoveNegativeLobes(after))
            continue;
        changed++;
        const auto [band1, band2] = FactorsOf(before, after);
        // 1 / (1 + 4 x) and 1 / (1 + 36 x).
        EXPECT_NEAR(9 * (1 / band1 - 1), 1 / band2 - 1, 1e-9 / band2);
    }
    EXPECT_GT(changed, 150);
}

TEST(Dering, TheWindowIsNoNarrowerThanNeeded) {
    const std::vector<Vec3d> directions = Directions(100000);
    int changed = 0;
    for (const SHVector &before : Samples(60)) {
        SHVector after = before;
        if (!RemoveNegativeLobes(after))
            continue;
        changed++;
        const auto [band1, band2] = FactorsOf(before, after);
        // A thousandth less of lambda is too little.
        SHVector wider = before;
        const double lambda = (1 / band2 - 1) / 36 * 0.998 - 1e-5;
        for (std::size_t k = 1; k < 9; k++)
            wider[k] /= 1 + (k < 4 ? 4 : 36) * lambda;
        EXPECT_LT(MinimumOfSH(wider).value, 0) << band1;
    }
    EXPECT_GT(changed, 40);
}

TEST(Dering, LightOfOneDirection) {
    // Around its direction the light is 1/4 + t/2 + 15/32 (t^2 - 1/3). Lambda by direct search over t and lambda.
    const auto lowest = [](double lambda) {
        double least = 1;
        for (double t = -1; t <= 1; t += 1e-3)
            least =
                std::min(least, 0.25 + t / 2 / (1 + 4 * lambda) + 15.0 / 32 * (t * t - 1.0 / 3) / (1 + 36 * lambda));
        return least;
    };
    double lambda = 0;
    while (lowest(lambda) < 0)
        lambda += 1e-5;
    EXPECT_GT(lambda, 0);
    for (const Vec3d &d : {Vec3d{0, 0, 1}, Normalize(Vec3d{1, -2, 0.5}), Vec3d{-1, 0, 0}}) {
        SHVector c = Delta(d, 3, true);
        EXPECT_TRUE(RemoveNegativeLobes(c));
        for (const Vec3d &n : Directions(50)) {
            const double t = Dot(n, d);
            const double expected = 0.25 + t / 2 / (1 + 4 * lambda) + 15.0 / 32 * (t * t - 1.0 / 3) / (1 + 36 * lambda);
            EXPECT_NEAR(Evaluate(c, n), 3 * expected, 1e-3);
        }
    }
}

TEST(Dering, AbsurdValuesBecomeFiniteOnes) {
    const std::vector<Vec3d> directions = Directions(2000);
    for (const double mean : {0.0, -1.0, 1e-40, 1e-20, 1.0, 1e9})
        for (const double other : {0.0, 1e-40, 1e-9, 1.0, 1e9, 1e25})
            for (std::size_t k = 1; k < 9; k++) {
                SHVector c{mean};
                c[k] = other;
                c[9 - k] -= other / 3;
                RemoveNegativeLobes(c);
                for (const double x : c)
                    ASSERT_TRUE(std::isfinite(x));
                EXPECT_EQ(c[0], mean);
                EXPECT_GE(Lowest(Rounded(c), directions), std::min(0.0, double(float(mean)))) << mean << ' ' << other;
            }
}

} // namespace

} // namespace q3::test
