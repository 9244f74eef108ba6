// GPL-2.0-or-later. Self-shadowed bump maps against closed forms and slow code of their own.
#include "q3map2/ssbump/ssbump.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

using testing::Each;
using testing::ElementsAre;

constexpr int kRays = 32; // the default

HeightField Field(int width, int height, bool tiles, const std::function<double(int, int)> &heightAt) {
    HeightField field{width, height, tiles};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            field.heights.push_back(float(heightAt(x, y)));
    return field;
}

HeightField Random(int width, int height, bool tiles, double scale) {
    std::mt19937 random(3);
    return Field(width, height, tiles, [&](int, int) { return scale * double(random()) / 4294967296.0; });
}

/// Hills with several slopes and a pit; repeats.
HeightField Hills(int size) {
    return Field(size, size, true, [&](int x, int y) {
        const double s = 2 * std::numbers::pi * x / size, t = 2 * std::numbers::pi * y / size;
        return 3 * std::sin(2 * s + t) + 1.5 * std::sin(3 * t - s + 1) - 2 * std::exp(3 * std::cos(s + 2) - 3);
    });
}

std::vector<Vec3f> Bump(const HeightField &field, int rays = kRays, int threads = 1) {
    return SelfShadowedBump(field, rays, JobPool(threads));
}
std::vector<std::uint8_t> Bytes(const HeightField &field, int threads = 1) {
    return SsbumpBytes(Bump(field, kRays, threads));
}
Vec3f At(const HeightField &field, const std::vector<Vec3f> &bump, int x, int y) {
    return bump.at(std::size_t(y) * std::size_t(field.width) + std::size_t(x));
}

/// The basis, written as its definition has it.
std::array<Vec3d, 3> Basis() {
    const double up = 1 / std::sqrt(3.0), back = -1 / std::sqrt(6.0), side = 1 / std::sqrt(2.0);
    return {{{std::sqrt(2.0 / 3), 0, up}, {back, side, up}, {back, -side, up}}};
}

/// Channels times 255 by sums over a grid of directions above the plane of the texture. `seen`: whether nothing is in
/// the way along a direction.
Vec3d Channels(const Vec3d &normal, const std::function<bool(const Vec3d &)> &seen, int azimuths = 720,
               int elevations = 400) {
    Vec3d visible, whole;
    for (int i = 0; i < azimuths; ++i)
        for (int k = 0; k < elevations; ++k) {
            const double angle = 2 * std::numbers::pi * (i + 0.5) / azimuths, z = (k + 0.5) / elevations;
            const double radius = std::sqrt(1 - z * z);
            const Vec3d w{radius * std::cos(angle), radius * std::sin(angle), z};
            if (Dot(normal, w) <= 0)
                continue;
            const bool clear = seen(w);
            for (std::size_t b = 0; b < 3; ++b) {
                const double weight = std::max(0.0, Dot(Basis()[b], w)) * Dot(normal, w);
                whole[b] += weight;
                visible[b] += clear ? weight : 0;
            }
        }
    Vec3d channels;
    for (std::size_t b = 0; b < 3; ++b)
        channels[b] = 255 * std::max(0.0, Dot(Basis()[b], normal)) * visible[b] / whole[b];
    return channels;
}

void ExpectChannels(const Vec3f &bump, const Vec3d &expected, double tolerance) {
    for (std::size_t b = 0; b < 3; ++b)
        EXPECT_NEAR(255 * bump[b], expected[b], tolerance) << "channel " << b;
}

TEST(Ssbump, FlatHeightsSeeAll) {
    for (const bool tiles : {true, false})
        for (const double height : {0.0, 8.0})
            EXPECT_THAT(Bytes(Field(37, 5, tiles, [&](int, int) { return height; })), Each(147))
                << "255 / sqrt(3) = 147.2";
}

TEST(Ssbump, TiltedPlanesHaveNoShadows) {
    const double slope = std::tan(20 * std::numbers::pi / 180);
    for (int azimuth = 0; azimuth < 360; azimuth += 25) {
        const double s = std::cos(azimuth * std::numbers::pi / 180), t = std::sin(azimuth * std::numbers::pi / 180);
        const HeightField plane = Field(70, 40, false, [&](int x, int y) { return slope * (s * x + t * y); });
        const Vec3d normal = Normalize(Vec3d{-slope * s, -slope * t, 1});
        EXPECT_NEAR(normal.z, std::cos(20 * std::numbers::pi / 180), 1e-12);
        const auto bytes = Bytes(plane);
        for (std::size_t i = 0; i < bytes.size(); ++i)
            ASSERT_NEAR(bytes[i], 255 * Dot(normal, Basis()[i % 3]), 0.501) << azimuth << ' ' << i;
    }
}

TEST(Ssbump, LobesThatATexelTurnsAwayFromAreBlack) {
    // 70 degrees, facing along -s: b1 is at 35.26 degrees from the plane on the other side.
    const HeightField plane = Field(40, 40, false, [](int x, int) { return x * std::tan(70 * 0.017453292519943295); });
    const Vec3f texel = At(plane, Bump(plane), 20, 20);
    EXPECT_EQ(texel.x, 0);
    EXPECT_GT(texel.y, 0.5f);
    EXPECT_NEAR(texel.y, texel.z, 1e-6);
}

TEST(Ssbump, TheBottomOfAHoleIsDark) {
    const HeightField hole =
        Field(48, 48, true, [](int x, int y) { return std::max(std::abs(x - 24), std::abs(y - 24)) <= 3 ? -12.0 : 0; });
    const auto bump = Bump(hole);
    const Vec3f bottom = At(hole, bump, 24, 24), far = At(hole, bump, 4, 4);
    EXPECT_THAT(SsbumpBytes(std::vector{far}), Each(147));
    for (std::size_t b = 0; b < 3; ++b)
        EXPECT_LT(bottom[b], 0.4f * far[b]);
}

// An endless step of height 8: a direction is blocked if it meets the plane through its edge below the edge.
TEST(Ssbump, AWallShadowsWhatPointsToIt) {
    constexpr double kHeight = 8;
    constexpr int kEdge = 500;
    const HeightField step = Field(1000, 1, true, [](int x, int) { return x < kEdge ? 0 : kHeight; });
    const auto exact = Bump(step, 512), bump = Bump(step);
    for (const int distance : {3, 6, 10, 25, 60}) {
        const Vec3d expected = Channels(
            {0, 0, 1}, [&](const Vec3d &w) { return w.z * distance >= kHeight * w.x; }, 1440, 1000);
        ExpectChannels(At(step, exact, kEdge - distance, 0), expected, 0.15);
        ExpectChannels(At(step, bump, kEdge - distance, 0), expected, 0.6);
        const double full = 255 / std::sqrt(3.0);
        EXPECT_LT(expected.x, expected.y - 0.2 * (full - expected.x)) << distance;
        EXPECT_NEAR(expected.y, expected.z, 1e-9);
    }
    const Vec3d near = Channels({0, 0, 1}, [](const Vec3d &w) { return w.z * 6 >= kHeight * w.x; });
    EXPECT_LT(near.x, 100) << "a third of the lobe toward the wall is blocked";
    EXPECT_GT(near.y, 125) << "little of the others";
    EXPECT_THAT(SsbumpBytes(std::vector{At(step, bump, 750, 0)}), ElementsAre(147, 147, 147)) << "on top";
}

TEST(Ssbump, WallsAlongTShadowTheOtherLobes) {
    // Below the wall in the image, so it is towards -t.
    const HeightField step = Field(1, 400, true, [](int, int y) { return y < 200 ? 8 : 0; });
    const Vec3f texel = At(step, Bump(step), 0, 206);
    EXPECT_LT(texel.z, texel.x - 0.08f);
    EXPECT_LT(texel.x, texel.y);
}

/// Height by bilinear interpolation.
double HeightAt(const HeightField &field, double x, double y) {
    const int column = int(std::floor(x)), row = int(std::floor(y));
    const double u = x - column, v = y - row;
    const auto at = [&](int i, int k) {
        return double(field.At((i + 16 * field.width) % field.width, (k + 16 * field.height) % field.height));
    };
    return (at(column, row) * (1 - u) + at(column + 1, row) * u) * (1 - v) +
           (at(column, row + 1) * (1 - u) + at(column + 1, row + 1) * u) * v;
}

// Short steps along each azimuth, and sums over directions.
TEST(Ssbump, MatchesMarchedRays) {
    constexpr int kSize = 24, kAzimuths = 180;
    const HeightField field = Hills(kSize);
    const auto fine = Bump(field, 512), bump = Bump(field);
    double squares = 0, shadows = 0;
    int count = 0;
    for (int x = 1; x < kSize; x += 4)
        for (int y = 2; y < kSize; y += 5) {
            const double s = (double(field.At((x + 1) % kSize, y)) - field.At(x - 1, y)) / 2,
                         t = (double(field.At(x, (y + 1) % kSize)) - field.At(x, y - 1)) / 2;
            std::vector<double> horizons;
            for (int i = 0; i < kAzimuths; ++i) {
                const double angle = 2 * std::numbers::pi * (i + 0.5) / kAzimuths;
                double most = 0;
                for (double r = 0.01; r < 200; r += r < 30 ? 0.02 : 0.2)
                    most = std::max(most, (HeightAt(field, x + r * std::cos(angle), y + r * std::sin(angle)) -
                                           double(field.At(x, y))) /
                                              r);
                horizons.push_back(most);
            }
            const Vec3d normal = Normalize(Vec3d{-s, -t, 1});
            int azimuth = -1;
            double lastX = 2;
            const auto seen = [&](const Vec3d &w) {
                const double angle = std::atan2(w.y, w.x);
                if (std::abs(angle - lastX) > 1e-6)
                    lastX = angle,
                    azimuth = int(std::floor(angle / (2 * std::numbers::pi) * kAzimuths + kAzimuths)) % kAzimuths;
                return w.z >= horizons[std::size_t(azimuth)] * std::hypot(w.x, w.y) - 1e-6;
            };
            const Vec3d expected = Channels(normal, seen, kAzimuths, 1000);
            ExpectChannels(At(field, fine, x, y), expected, 0.6);
            for (std::size_t b = 0; b < 3; ++b) {
                squares += std::pow(255 * At(field, bump, x, y)[b] - expected[b], 2);
                shadows = std::max(shadows, 255 * std::max(0.0, Dot(normal, Basis()[b])) - expected[b]);
                ++count;
            }
        }
    EXPECT_LT(std::sqrt(squares / count), 0.5);
    EXPECT_GT(shadows, 30) << "there is something to get wrong";
}

TEST(Ssbump, TheDefaultIsNearManyRays) {
    const HeightField field = Random(40, 40, true, 1);
    const auto few = Bump(field), many = Bump(field, 1024);
    double squares = 0;
    for (std::size_t i = 0; i < few.size(); ++i)
        squares += Dot(few[i] - many[i], few[i] - many[i]);
    EXPECT_LT(255 * std::sqrt(squares / double(3 * few.size())), 1) << "white noise, the worst case";
    EXPECT_GT(squares, 0);
}

TEST(Ssbump, TilesFollowAShift) {
    for (const auto &size : {std::pair{50, 33}, std::pair{64, 32}, std::pair{5, 3}}) {
        const int width = size.first, height = size.second;
        const HeightField field = Random(width, height, true, 6);
        const int right = 17 % width, down = 9 % height;
        const HeightField moved = Field(width, height, true, [&](int x, int y) {
            return field.At((x + width - right) % width, (y + height - down) % height);
        });
        const auto from = Bump(field), to = Bump(moved);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                ASSERT_EQ(At(moved, to, (x + right) % width, (y + down) % height), At(field, from, x, y))
                    << x << ' ' << y;
    }
}

TEST(Ssbump, MirroredImagesSwapTheLobesBeside) {
    const HeightField field = Random(40, 31, true, 5);
    const HeightField mirrored = Field(40, 31, true, [&](int x, int y) { return field.At(x, 30 - y); });
    const auto from = Bump(field), to = Bump(mirrored);
    for (int y = 0; y < 31; ++y)
        for (int x = 0; x < 40; ++x) {
            const Vec3f a = At(field, from, x, y), b = At(mirrored, to, x, 30 - y);
            ASSERT_NEAR(a.x, b.x, 1e-5);
            ASSERT_NEAR(a.y, b.z, 1e-5);
            ASSERT_NEAR(a.z, b.y, 1e-5);
        }
}

TEST(Ssbump, NothingStandsBeyondTheEdgesOfAnImageThatDoesNotTile) {
    const auto wall = [](int x, int) { return x > 90 ? 12.0 : 0; };
    const HeightField open = Field(100, 9, false, wall), tiled = Field(100, 9, true, wall);
    const auto atEdge = At(open, Bump(open), 0, 4);
    EXPECT_THAT(SsbumpBytes(std::vector{atEdge}), Each(147));
    // Behind the left edge is the wall of the tile before, whose lobes lean to -s.
    const Vec3f shadowed = At(tiled, Bump(tiled), 2, 4);
    EXPECT_LT(shadowed.y, atEdge.y - 0.2f);
    EXPECT_LT(shadowed.y, shadowed.x);
}

TEST(Ssbump, ThreadsChangeNothing) {
    const HeightField field = Random(70, 65, true, 7);
    EXPECT_EQ(Bump(field, kRays, 1), Bump(field, kRays, 4));
}

TEST(Ssbump, SmallAndNarrowImages) {
    for (const bool tiles : {true, false}) {
        EXPECT_THAT(Bytes(Field(1, 1, tiles, [](int, int) { return 5; })), ElementsAre(147, 147, 147));
        for (const auto &[width, height] : {std::pair{1, 40}, std::pair{40, 1}, std::pair{2, 2}})
            for (const Vec3f &texel : Bump(Random(width, height, tiles, 300)))
                for (std::size_t b = 0; b < 3; ++b)
                    EXPECT_TRUE(texel[b] >= 0 && texel[b] <= 1) << width << ' ' << height;
    }
}

TEST(Ssbump, HeightIsLuminance) {
    DeepImage image{3, 1, 16, {65535, 65535, 65535, 0, 65535, 0, 0, 65535, 12345, 12345, 12345, 9}};
    const HeightField field = HeightsOf(image, -10, true);
    EXPECT_FLOAT_EQ(field.heights[0], -10);
    EXPECT_FLOAT_EQ(field.heights[1], -3);
    EXPECT_FLOAT_EQ(field.heights[2], float(-10 * 12345 / 65535.0));
}

TEST(Ssbump, NormalMapsHoldTheGradient) {
    const HeightField plane = Field(6, 5, false, [](int x, int y) { return 0.75 * x - 0.5 * y; });
    const auto bytes = NormalBytes(plane);
    const Vec3d normal = Normalize(Vec3d{-0.75, 0.5, 1});
    for (std::size_t i = 0; i < bytes.size(); ++i)
        ASSERT_NEAR(bytes[i], 127 + 127.5 * normal[i % 3], 0.501);
    EXPECT_THAT(NormalBytes(Field(1, 1, true, [](int, int) { return 0; })), ElementsAre(127, 127, 255));
}

TEST(Ssbump, SmoothedStepsAreNearerToTheSlope) {
    constexpr double kStep = 1.0 / 16;
    const HeightField smooth = Hills(64);
    HeightField steps = smooth;
    for (float &height : steps.heights)
        height = float(std::round(height / kStep) * kStep);
    HeightField filtered = steps;
    SmoothSteps(filtered, 32, kStep, JobPool(2));
    double before = 0, after = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const Vec3f normal = NormalOf(GradientAt(smooth, x, y));
            before += std::pow(double(Length(NormalOf(GradientAt(steps, x, y)) - normal)), 2);
            after += std::pow(double(Length(NormalOf(GradientAt(filtered, x, y)) - normal)), 2);
            EXPECT_LE(std::abs(filtered.At(x, y) - steps.At(x, y)), kStep / 2 + 1e-6);
        }
    EXPECT_GT(before, 9 * after) << "a third of the angle, root mean square";
}

TEST(Ssbump, SmoothingKeepsPlanesAndEdges) {
    HeightField plane = Field(20, 20, false, [](int x, int y) { return 0.25 * x + 0.5 * y; }), same = plane;
    SmoothSteps(same, 8, 0.5, JobPool(1));
    for (std::size_t i = 0; i < plane.heights.size(); ++i)
        EXPECT_NEAR(same.heights[i], plane.heights[i], 1e-4);
    HeightField edge = Field(20, 20, true, [](int x, int) { return x < 10 ? 0 : 6; });
    SmoothSteps(edge, 8, 0.1, JobPool(1));
    EXPECT_GE(edge.At(10, 5) - edge.At(9, 5), 5.89f);
}

} // namespace
} // namespace q3
