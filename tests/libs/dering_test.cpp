// GPL-2.0-or-later. Spherical harmonics without negative lobes: nowhere negative, and the nearest of that kind.
#include "libs/sh/dering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

constexpr double kPi = std::numbers::pi;

/// From bands that are this many means long, the slow method below does not get near.
constexpr double kFarthest = 30;

/// Spread evenly over the sphere.
std::vector<Vec3d> Directions(int count) {
    std::vector<Vec3d> directions;
    for (int i = 0; i < count; i++) {
        const double z = 1 - (2 * i + 1.0) / count, turn = kPi * (3 - std::sqrt(5)) * i;
        directions.push_back({std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z});
    }
    return directions;
}

double Evaluate(const ShVector &c, const Vec3d &n) {
    const ShVector basis = ShBasis(n);
    double sum = 0;
    for (std::size_t k = 0; k < 9; k++)
        sum += c[k] * basis[k];
    return sum;
}

double Lowest(const ShVector &c, const std::vector<Vec3d> &directions) {
    double lowest = std::numeric_limits<double>::max();
    for (const Vec3d &n : directions)
        lowest = std::min(lowest, Evaluate(c, n));
    return lowest;
}

double Distance2(const ShVector &a, const ShVector &b) {
    double sum = 0;
    for (std::size_t k = 0; k < 9; k++)
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

/// Light of one direction: sharp as projected, or convolved with the clamped cosine.
ShVector Delta(const Vec3d &d, double light, bool convolved) {
    ShVector c = ShBasis(d);
    for (std::size_t k = 0; k < 9; k++)
        c[k] *= light * (convolved ? kCosineLobe[k] : 1);
    return c;
}

ShVector Sum(const ShVector &a, const ShVector &b) {
    ShVector sum = a;
    for (std::size_t k = 0; k < 9; k++)
        sum[k] += b[k];
    return sum;
}

/// Sums of lights from a few directions, as at points of a map, and coefficients of any kind.
std::vector<ShVector> Samples(int count) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::vector<ShVector> samples;
    for (int i = 0; i < count; i++) {
        ShVector c{};
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
ShVector Rounded(ShVector c) {
    for (double &x : c)
        x = double(float(x));
    return c;
}

/// A lower bound of half the squared distance to everything that is not negative in these directions: the value of the
/// dual problem after some sweeps of Hildreth's method. Mean 1.
double DualBound(const ShVector &c, const std::vector<ShVector> &basis, int sweeps) {
    std::vector<double> weights(basis.size());
    ShVector moved = c;
    const double norm = 2 / kPi;
    const auto at = [](const ShVector &a, const ShVector &b) {
        double sum = 0;
        for (std::size_t k = 0; k < 9; k++)
            sum += a[k] * b[k];
        return sum;
    };
    for (int sweep = 0; sweep < sweeps; sweep++)
        for (std::size_t i = 0; i < basis.size(); i++) {
            const double value = at(moved, basis[i]);
            if (value >= 0 && weights[i] == 0)
                continue;
            const double change = std::max(-weights[i], -value / norm);
            weights[i] += change;
            for (std::size_t k = 1; k < 9; k++)
                moved[k] += change * basis[i][k];
        }
    double bound = -Distance2(moved, c) / 2;
    for (std::size_t i = 0; i < basis.size(); i++)
        bound -= weights[i] * at(c, basis[i]);
    return bound;
}

TEST(Dering, MinimumIsTheLeastOfAllDirections) {
    const std::vector<Vec3d> directions = Directions(20000);
    for (const ShVector &c : Samples(60)) {
        const ShMinimum found = MinimumOfSh(c);
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
    EXPECT_NEAR(MinimumOfSh({2}).value, 2 * kShC0, 1e-15);
    EXPECT_NEAR(MinimumOfSh({1, 0, 3}).value, kShC0 - 3 * kShC1, 1e-15);
    EXPECT_NEAR(MinimumOfSh({1, 0, 0, 0, 0, 0, 2}).value, kShC0 - 2 * kShC3, 1e-15);
    EXPECT_NEAR(MinimumOfSh({1, 0, 0, 0, 0, 0, -2}).value, kShC0 - 4 * kShC3, 1e-15);
    EXPECT_NEAR(MinimumOfSh(Delta({0.6, 0, 0.8}, 1, true)).value, 3.0 / 32 - 2.0 / 15, 1e-15);
    EXPECT_EQ(MinimumOfSh({}).value, 0);
}

TEST(Dering, NothingIsNegativeAfterwardsAndTheMeanStays) {
    const std::vector<Vec3d> directions = Directions(100000);
    int changed = 0;
    for (const ShVector &sample : Samples(100)) {
        const ShVector before = Rounded(sample);
        ShVector after = before;
        changed += RemoveNegativeLobes(after);
        EXPECT_EQ(after[0], before[0]);
        EXPECT_GE(Lowest(Rounded(after), directions), 0);
    }
    EXPECT_GT(changed, 80);
}

TEST(Dering, ASecondTimeChangesNothing) {
    for (const ShVector &sample : Samples(2000)) {
        ShVector c = Rounded(sample);
        RemoveNegativeLobes(c);
        const ShVector once = Rounded(c);
        ShVector twice = once;
        EXPECT_FALSE(RemoveNegativeLobes(twice));
        EXPECT_EQ(twice, once);
    }
}

TEST(Dering, WhatIsNowhereNegativeStaysAsItIs) {
    int kept = 0;
    for (const ShVector &sample : Samples(2000)) {
        ShVector c = sample;
        // Raised until its minimum is just above zero.
        c[0] += (std::max(0.0, -MinimumOfSh(c).value) + 1e-9 * std::abs(c[0])) / kShC0;
        const ShVector before = c;
        EXPECT_FALSE(RemoveNegativeLobes(c));
        kept += c == before;
    }
    EXPECT_EQ(kept, 2000);
}

TEST(Dering, NothingNearerIsNowhereNegative) {
    std::vector<ShVector> basis;
    for (const Vec3d &n : Directions(20000))
        basis.push_back(ShBasis(n));
    int changed = 0;
    for (const ShVector &sample : Samples(60)) {
        ShVector before = sample;
        const double length = std::sqrt(Distance2(before, {before[0]}));
        for (std::size_t k = 1; k < 9; k++)
            before[k] /= std::max(sample[0] * kShC0, length / kFarthest);
        before[0] = 1 / kShC0;
        ShVector after = before;
        if (!RemoveNegativeLobes(after))
            continue;
        changed++;
        const double distance = Distance2(before, after) / 2, bound = DualBound(before, basis, 400);
        EXPECT_GT(bound, 0);
        EXPECT_LE(distance, bound * 1.002 + 1e-5);
        EXPECT_GE(distance, bound * (1 - 1e-9) - 1e-9);
    }
    EXPECT_GT(changed, 40);
}

TEST(Dering, LightOfOneDirectionBecomesASquare) {
    // Around its direction the light 1/4 + t/2 + 15/32 (t^2 - 1/3) has mean 1/4. Nowhere negative and zero on a ring,
    // it is m (1 + k t)^2 / (1 + k^2/3); the k that is nearest by direct search.
    const double linear = 0.5, square = 15.0 / 32, mean = 0.25;
    const auto parts = [&](double k) {
        const double scale = mean / (1 + k * k / 3);
        return std::array<double, 2>{2 * scale * k, scale * k * k};
    };
    double best = std::numeric_limits<double>::max(), bestK = 0;
    for (double k = 0.5; k < 4; k += 1e-5) {
        // Squared norms of t and t^2 - 1/3 over the sphere: 4 pi / 3 and 16 pi / 45.
        const auto [a, b] = parts(k);
        const double distance = (a - linear) * (a - linear) / 3 + (b - square) * (b - square) * 4 / 45;
        if (distance < best)
            best = distance, bestK = k;
    }
    const auto [a, b] = parts(bestK);
    for (const Vec3d &d : {Vec3d{0, 0, 1}, Normalize(Vec3d{1, -2, 0.5}), Vec3d{-1, 0, 0}}) {
        ShVector c = Delta(d, 3, true);
        EXPECT_TRUE(RemoveNegativeLobes(c));
        for (const Vec3d &n : Directions(50)) {
            const double t = Dot(n, d);
            EXPECT_NEAR(Evaluate(c, n), 3 * (mean + a * t + b * (t * t - 1.0 / 3)), 1e-4);
        }
    }
}

TEST(Dering, AbsurdValuesBecomeFiniteOnes) {
    const std::vector<Vec3d> directions = Directions(2000);
    for (const double mean : {0.0, -1.0, 1e-40, 1e-20, 1.0, 1e9})
        for (const double other : {0.0, 1e-40, 1e-9, 1.0, 1e9, 1e25})
            for (std::size_t k = 1; k < 9; k++) {
                ShVector c{mean};
                c[k] = other;
                c[9 - k] -= other / 3;
                RemoveNegativeLobes(c);
                for (const double x : c)
                    ASSERT_TRUE(std::isfinite(x));
                EXPECT_EQ(c[0], mean);
                EXPECT_GE(Lowest(Rounded(c), directions), std::min(0.0, double(float(mean)))) << mean << ' ' << other;
            }
}

TEST(Dering, ChannelsAreChangedOnTheirOwn) {
    // A channel that is nowhere negative stays whatever the others are; one with a lobe loses it and keeps its mean.
    const std::vector<Vec3d> directions = Directions(20000);
    const ShVector dark{}, smooth{4, 0.1, -0.2, 0.3}, ringing = Rounded(Delta({0.6, 0, 0.8}, 3, true));
    ASSERT_LT(MinimumOfSh(ringing).value, 0);
    ASSERT_GT(MinimumOfSh(smooth).value, 0);
    for (std::size_t lobed = 0; lobed < 3; lobed++) {
        std::array<ShVector, 3> channels{};
        channels[lobed] = ringing, channels[(lobed + 1) % 3] = smooth;
        const std::array<bool, 3> changed = RemoveNegativeLobes(channels);
        for (std::size_t channel = 0; channel < 3; channel++)
            EXPECT_EQ(changed[channel], channel == lobed);
        EXPECT_EQ(channels[(lobed + 1) % 3], smooth);
        EXPECT_EQ(channels[(lobed + 2) % 3], dark);
        EXPECT_EQ(channels[lobed][0], ringing[0]);
        EXPECT_GE(Lowest(Rounded(channels[lobed]), directions), 0);
    }
}

/// Colours whose channels are multiples of each other share their work: the results must be nearest all the same.
TEST(Dering, ProportionalChannelsBecomeProportional) {
    const ShVector ringing = Rounded(Delta({0.6, 0, 0.8}, 3, true));
    std::array<ShVector, 3> channels{ringing, ringing, ringing};
    for (std::size_t k = 0; k < 9; k++)
        channels[1][k] *= 0.5, channels[2][k] *= 0.125;
    EXPECT_EQ(RemoveNegativeLobes(channels), (std::array{true, true, true}));
    for (std::size_t k = 0; k < 9; k++) {
        EXPECT_NEAR(channels[1][k], 0.5 * channels[0][k], 1e-4 * std::abs(ringing[0]));
        EXPECT_NEAR(channels[2][k], 0.125 * channels[0][k], 1e-4 * std::abs(ringing[0]));
    }
}

} // namespace

} // namespace q3::test
