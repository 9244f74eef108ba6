// GPL-2.0-or-later. Loops, memory and sorting on all workers of a pool.
#include "common/parallel.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace q3::test {

namespace {

TEST(Parallel, ForAllCallsEveryIndexOnce) {
    for (const std::size_t count : {std::size_t(0), std::size_t(1), std::size_t(99), std::size_t(100)}) {
        std::vector<int> calls(count);
        ForAll(JobPool(3), count, 10, [&](std::size_t i) { ++calls[i]; });
        EXPECT_EQ(calls, std::vector<int>(count, 1));
    }
}

TEST(Parallel, SortedValuesDoNotDependOnTheNumberOfWorkers) {
    std::mt19937 random(1);
    for (const std::size_t count :
         {std::size_t(0), std::size_t(1), std::size_t(2), std::size_t(1000), std::size_t(1023), std::size_t(5000)}) {
        std::vector<int> sorted(count);
        std::iota(sorted.begin(), sorted.end(), 0);
        std::vector<int> mixed = sorted;
        std::shuffle(mixed.begin(), mixed.end(), random);
        for (int workers = 1; workers <= 9; ++workers) {
            std::vector<int> values = mixed;
            SortInParallel(values, JobPool(workers));
            EXPECT_EQ(values, sorted) << count << " values, " << workers << " workers";
        }
    }
}

TEST(Parallel, AVectorThatGrowsKeepsItsValues) {
    const JobPool jobs(2);
    std::vector<int> values = VectorInParallel<int>(3, jobs);
    EXPECT_EQ(values, std::vector<int>(3));
    values = {1, 2, 3};
    GrowInParallel(1000, jobs, values);
    EXPECT_GE(values.capacity(), 1000u);
    EXPECT_EQ(values, (std::vector<int>{1, 2, 3}));
}

} // namespace

} // namespace q3::test
