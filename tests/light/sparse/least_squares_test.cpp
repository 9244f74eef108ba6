// GPL-2.0-or-later. Sparse linear least squares: the values found, and that they do not depend on how samples are kept.
#include "q3map2/light/sparse/least_squares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace q3::test {

namespace {

constexpr std::size_t kUnknowns = 50, kSamples = 200'000;

float Wanted(std::size_t unknown) {
    return std::sin(float(unknown));
}

struct Problem {
    std::vector<SampleBlock> blocks;
    std::vector<float> values; ///< by number of a sample
};

/// Random samples of the wanted unknowns, in blocks of equal size. noise: added to their values.
Problem RandomProblem(std::size_t blockSize, float noise) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit;
    std::uniform_int_distribution<std::uint32_t> unknown(0, kUnknowns - 1);
    Problem problem;
    for (std::size_t s = 0; s < kSamples; ++s) {
        const std::vector<UnknownTerm> terms{{unknown(random), unit(random)}, {unknown(random), unit(random)}};
        float value = noise * unit(random);
        for (const UnknownTerm &term : terms)
            value += term.weight * Wanted(term.unknown);
        if (s % blockSize == 0)
            problem.blocks.emplace_back();
        problem.blocks.back().Add(std::uint32_t(s), 1 + unit(random), terms);
        problem.values.push_back(value);
    }
    return problem;
}

std::vector<float> Solved(Problem problem, int steps, int threads = 1) {
    const JobPool jobs(threads);
    const LeastSquares system(kUnknowns, std::move(problem.blocks), jobs);
    std::vector<float> x(kUnknowns);
    system.Solve([&](std::uint32_t number) { return problem.values[number]; }, x, steps, jobs);
    return x;
}

TEST(LeastSquares, FindsTheValuesThatSamplesWereMadeOf) {
    const std::vector<float> x = Solved(RandomProblem(1000, 0), 30);
    for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_NEAR(x[i], Wanted(i), 1e-4f) << i;
}

TEST(LeastSquares, BlocksAndThreadsDoNotChangeABit) {
    const std::vector<float> x = Solved(RandomProblem(kSamples, 1), 4);
    for (const std::size_t blockSize : {std::size_t(1000), std::size_t(70'000)})
        for (const int threads : {1, 3})
            EXPECT_EQ(Solved(RandomProblem(blockSize, 1), 4, threads), x) << blockSize << ' ' << threads;
}

} // namespace

} // namespace q3::test
