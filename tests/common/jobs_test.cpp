// GPL-2.0-or-later. Each promise of JobPool.
#include "common/jobs.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace q3 {

namespace {

/// Starts `limit` threads, then fails as std::thread does when the system has none left.
JobPool::ThreadStarter StartsAtMost(int limit, int &started) {
    return [limit, &started](std::function<void()> work) {
        if (started == limit)
            throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
        ++started;
        return std::thread(std::move(work));
    };
}

/// Counts how often a number is in use at once.
class Occupancy {
  public:
    void Enter(int number) { clashed_ = busy_[std::size_t(number)].exchange(true) || clashed_; }
    void Leave(int number) { busy_[std::size_t(number)] = false; }
    bool Clashed() const { return clashed_; }

  private:
    std::array<std::atomic<bool>, 64> busy_{};
    std::atomic<bool> clashed_{false};
};

TEST(JobPool, RunsEveryIndexOnceAndAWorkerRunsOneAtATime) {
    for (const int threads : {1, 2, 5}) {
        const JobPool jobs(threads);
        ASSERT_EQ(jobs.Threads(), threads);
        std::vector<std::atomic<int>> runs(10000);
        std::atomic<bool> inRange{true};
        Occupancy workers;
        jobs.For(std::int64_t(runs.size()), [&](std::int64_t index, int worker) {
            if (worker < 0 || worker >= threads) {
                inRange = false;
                return;
            }
            workers.Enter(worker);
            runs[std::size_t(index)]++;
            workers.Leave(worker);
        });
        EXPECT_TRUE(inRange);
        EXPECT_FALSE(workers.Clashed());
        for (const std::atomic<int> &count : runs)
            ASSERT_EQ(count, 1);
    }
}

TEST(JobPool, HandsOutIndicesInAscendingOrder) {
    for (const int threads : {1, 4}) {
        const JobPool jobs(threads);
        std::vector<std::vector<std::int64_t>> byWorker(std::size_t(jobs.Threads()));
        jobs.For(5000, [&](std::int64_t index, int worker) { byWorker[std::size_t(worker)].push_back(index); });
        for (const auto &indices : byWorker)
            EXPECT_TRUE(std::is_sorted(indices.begin(), indices.end()));
        if (threads == 1) {
            EXPECT_EQ(byWorker[0].size(), 5000u);
        }
    }
}

TEST(JobPool, RunsNothingForNoIndices) {
    const JobPool jobs(3);
    for (const std::int64_t count : {0, -5})
        jobs.For(
            count, [](std::int64_t, int) { FAIL(); }, [](std::int64_t) { FAIL(); });
}

TEST(JobPool, WorkerZeroIsTheCaller) {
    const JobPool jobs(3);
    const std::thread::id caller = std::this_thread::get_id();
    std::atomic<int> wrong{0};
    for (int i = 0; i < 50; ++i)
        jobs.For(20,
                 [&](std::int64_t, int worker) { wrong += (worker == 0) != (std::this_thread::get_id() == caller); });
    EXPECT_EQ(wrong, 0);
}

TEST(JobPool, ThreadsStartOnceAndServeAllLoops) {
    int started = 0;
    const JobPool jobs(4, StartsAtMost(100, started));
    EXPECT_EQ(started, 3);
    std::mutex mutex;
    std::set<std::thread::id> seen;
    for (int loop = 0; loop < 300; ++loop)
        jobs.For(30, [&](std::int64_t, int) {
            const std::lock_guard lock(mutex);
            seen.insert(std::this_thread::get_id());
        });
    EXPECT_EQ(started, 3);
    EXPECT_LE(seen.size(), 4u);
}

TEST(JobPool, LoopsOfAllSizesWakeEnoughWorkers) {
    constexpr int kWorkers = 16;
    const JobPool jobs(kWorkers);
    for (int loop = 0; loop < 2000; ++loop) {
        std::atomic<int> runs{0};
        jobs.For(loop % 40, [&](std::int64_t, int) { ++runs; });
        ASSERT_EQ(runs, loop % 40);
    }
    // All of them take part sooner or later, if an index takes longer than to wake up.
    std::array<std::atomic<bool>, kWorkers> seen{};
    const auto all = [&] { return std::ranges::all_of(seen, [](const auto &one) { return one.load(); }); };
    for (int loop = 0; loop < 1000 && !all(); ++loop)
        jobs.For(kWorkers, [&](std::int64_t, int worker) {
            seen[std::size_t(worker)] = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        });
    EXPECT_TRUE(all());
}

TEST(JobPool, ThrowsTheErrorOfTheLowestIndexWhateverTheThreads) {
    for (const int threads : {1, 2, 4}) {
        const JobPool jobs(threads);
        for (int repeat = 0; repeat < 200; ++repeat) {
            std::atomic<int> running{0};
            std::string what;
            try {
                jobs.For(1000, [&](std::int64_t index, int) {
                    running++;
                    if (index == 7) // mostly later than 8
                        std::this_thread::yield();
                    running--;
                    if (index == 7 || index == 8 || index > 500)
                        throw std::runtime_error(std::to_string(index));
                });
            } catch (const std::runtime_error &error) {
                what = error.what();
            }
            ASSERT_EQ(what, "7");
            ASSERT_EQ(running, 0) << "a body runs after For has thrown";
        }
    }
}

TEST(JobPool, HandsOutNothingAfterAnError) {
    const JobPool one(1);
    int runs = 0;
    EXPECT_THROW(one.For(100,
                         [&](std::int64_t index, int) {
                             ++runs;
                             if (index == 4)
                                 throw 1;
                         }),
                 int);
    EXPECT_EQ(runs, 5);
    // With two workers each may have been at an index when the other threw.
    const JobPool two(2);
    std::atomic<int> started{0};
    EXPECT_THROW(two.For(1000000,
                         [&](std::int64_t, int) {
                             started++;
                             throw 1;
                         }),
                 int);
    EXPECT_LE(started, 2);
    two.For(3, [&](std::int64_t, int) { started++; });
    EXPECT_GE(started, 4) << "the pool is as good as before";
}

TEST(JobPool, ReportsFinishedCountsInOrderAndOneAtATime) {
    const JobPool jobs(3);
    std::vector<std::int64_t> counts; // not locked: the thread sanitizer sees if two calls overlap
    jobs.For(
        500, [](std::int64_t, int) {}, [&](std::int64_t finished) { counts.push_back(finished); });
    ASSERT_FALSE(counts.empty());
    EXPECT_GE(counts.front(), 1);
    for (std::size_t i = 1; i < counts.size(); ++i)
        ASSERT_GT(counts[i], counts[i - 1]);
    EXPECT_EQ(counts.back(), 500);
    EXPECT_THROW(jobs.For(
                     9, [](std::int64_t, int) {}, [](std::int64_t) { throw 2; }),
                 int);
}

TEST(JobPool, NestedLoopsRunOnTheCallingWorker) {
    for (const int threads : {1, 3}) {
        const JobPool jobs(threads);
        std::atomic<int> strayed{0}, inner{0};
        jobs.For(60, [&](std::int64_t, int outer) {
            const std::thread::id self = std::this_thread::get_id();
            std::int64_t expected = 0;
            jobs.For(10, [&](std::int64_t index, int worker) {
                strayed += worker != outer || std::this_thread::get_id() != self || index != expected++;
                inner++;
            });
        });
        EXPECT_EQ(strayed, 0);
        EXPECT_EQ(inner, 600);
        EXPECT_THROW(jobs.For(4, [&](std::int64_t, int) { jobs.For(2, [](std::int64_t, int) { throw 3; }); }), int);
    }
}

TEST(JobPool, LoopsOfDifferentThreadsTakeTurns) {
    const JobPool jobs(2);
    Occupancy workers;
    std::atomic<int> runs{0};
    const auto caller = [&] {
        for (int loop = 0; loop < 200; ++loop)
            jobs.For(loop % 3 + 1, [&](std::int64_t, int worker) {
                workers.Enter(worker);
                runs++;
                workers.Leave(worker);
            });
    };
    std::thread other(caller);
    caller();
    other.join();
    EXPECT_FALSE(workers.Clashed());
    EXPECT_EQ(runs, 2 * (67 * 1 + 67 * 2 + 66 * 3));
}

TEST(JobPool, WorksWithTheThreadsThatCouldBeStarted) {
    for (const int limit : {0, 1, 2}) {
        int started = 0;
        const JobPool jobs(8, StartsAtMost(limit, started));
        EXPECT_EQ(jobs.Threads(), limit + 1);
        std::atomic<std::int64_t> sum{0};
        jobs.For(1000, [&](std::int64_t index, int worker) { sum += worker <= limit ? index : 0; });
        EXPECT_EQ(sum, 999 * 1000 / 2);
    }
}

TEST(JobPool, OtherErrorsOfStartingAThreadReachTheCaller) {
    int started = 0;
    const auto start = [&](std::function<void()> work) {
        if (++started == 3)
            throw std::bad_alloc();
        return std::thread(std::move(work));
    };
    EXPECT_THROW(JobPool(6, start), std::bad_alloc);
}

TEST(JobPool, CanBeMovedAndReplaced) {
    JobPool jobs(2);
    JobPool moved = std::move(jobs);
    jobs = JobPool(3);
    EXPECT_EQ(moved.Threads(), 2);
    EXPECT_EQ(jobs.Threads(), 3);
    std::atomic<int> runs{0};
    jobs.For(10, [&](std::int64_t, int) { runs++; });
    moved.For(10, [&](std::int64_t, int) { runs++; });
    EXPECT_EQ(runs, 20);
    EXPECT_GE(JobPool().Threads(), 1);
    EXPECT_EQ(JobPool(1000).Threads(), 64);
}

TEST(JobPool, ObserverIsToldOfTheLoopsOfTheCaller) {
    for (const int threads : {1, 3}) {
        std::vector<LoopTimes> told;
        const JobPool jobs(threads, {}, [&](const LoopTimes &times) { told.push_back(times); });
        jobs.For(5, [&](std::int64_t, int) { jobs.For(2, [](std::int64_t, int) {}); });
        jobs.For(0, [](std::int64_t, int) {});
        EXPECT_THROW(jobs.For(4, [](std::int64_t, int) { throw std::runtime_error("failed"); }), std::runtime_error);
        ASSERT_EQ(told.size(), 2u) << "neither those of bodies nor one that failed";
        EXPECT_EQ(told[0].indices.size(), 5u);
        EXPECT_GE(told[0].caller, 0);
        EXPECT_TRUE(told[1].indices.empty());
    }
}

} // namespace

} // namespace q3
