// GPL-2.0-or-later. Crashes that a program cannot be made to have from outside.
#include "common/crash_report.h"
#include "common/jobs.h"
#include "common/platform/platform.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

namespace q3 {

namespace {

#ifndef _WIN32 // no signals

/// Needs more stack than there is.
int Overflow(int depth) {
    volatile char block[4096];
    block[0] = char(depth);
    return depth < 0 ? 0 : block[0] + Overflow(depth + 1);
}

TEST(CrashReportDeathTest, AFullStackOfAWorkerIsReported) {
    if (kIsSanitized)
        GTEST_SKIP() << "sanitizers have reports of their own";
    const auto crash = [] {
        InstallCrashReport("the version\n");
        JobPool(2).For(2, [](std::int64_t, int worker) {
            if (worker != 0)
                Overflow(0);
            std::this_thread::sleep_for(std::chrono::seconds(10)); // until the other ends the process
        });
    };
    EXPECT_EXIT(crash(), testing::KilledBySignal(SIGSEGV), "Invalid memory access \\(SIGSEGV\\).*\n.*the version");
}

#endif

} // namespace

} // namespace q3
