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
    EXPECT_EQ(VectorInParallel<int>(3, jobs), std::vector<int>(3));
    ChunkedVector<int> values;
    for (int i = 0; i < 100'000; ++i)
        values.Add(i);
    const int *const first = &values[0];
    values.Grow(1'000'000, jobs);
    EXPECT_EQ(first, &values[0]);
    ASSERT_EQ(values.Size(), 1'000'000u);
    const ChunkedVector<int> copy = values;
    values[99'999] = 0;
    for (std::size_t i = 0; i < copy.Size(); ++i)
        ASSERT_EQ(copy[i], i < 100'000 ? int(i) : 0);
}

} // namespace

} // namespace q3::test
