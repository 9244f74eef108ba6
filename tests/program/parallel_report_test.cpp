// GPL-2.0-or-later. The prediction of ParallelReport for many workers, and its table.
#include "q3map2/report/parallel_report.h"
#include "tests/support/kept_log.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {

namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(LoopSpan, WorkersTakeTheNextIndexAsSoonAsTheyAreFree) {
    const std::vector<float> longFirst{3, 1, 1, 1}, longLast{1, 1, 1, 3};
    EXPECT_EQ(LoopSpan(longFirst, 1), 6);
    EXPECT_EQ(LoopSpan(longFirst, 2), 3);
    EXPECT_EQ(LoopSpan(longLast, 2), 4) << "the long index starts when the first worker is free again, at 1";
    EXPECT_EQ(LoopSpan(longLast, 64), 3);
    EXPECT_EQ(LoopSpan({}, 4), 0);
}

TEST(ParallelReport, CountsTheLoopsOfEachPass) {
    test::KeptLog out;
    ParallelReport report;
    out.log.AddObserver(report);
    const JobPool::LoopObserver observer = report.Observer();
    observer({.caller = 0, .indices = {2, 2}});
    out.log.Section("Second");
    observer({.caller = 0, .indices = {8}});
    observer({.caller = 0, .indices = {1, 1, 1}});
    out.log.RemoveObserver(report);
    out.log.Section("Third");
    report.Print(out.log);
    // Loops, indices, and the sum of the longest index of each loop.
    EXPECT_THAT(out.text, ContainsRegex("start .* 1 +2 +2\\.000"));
    EXPECT_THAT(out.text, ContainsRegex("Second .* 2 +4 +9\\.000"));
    EXPECT_THAT(out.text, ContainsRegex("all .* 3 +6 +11\\.000"));
    EXPECT_THAT(out.text, Not(HasSubstr("Third  ")));
}

} // namespace

} // namespace q3
