// GPL-2.0-or-later. Parallel loops over indices.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace q3 {

/// Most workers of a pool; limit of this program, chosen.
inline constexpr int kMaxThreads = 64;

/// What a loop of a pool has cost. Times are CPU seconds; on Windows the system counts them in steps of 1/64 s.
struct LoopTimes {
    double caller = 0;          ///< of the thread that called For, until For returned
    std::vector<float> indices; ///< of the body, by index
};

/// Worker threads that run loops. They start with the pool, sleep between loops and end with the pool.
///
/// Workers: worker 0 is the thread that calls For, workers 1 to Threads() - 1 are threads of the pool. A worker runs
/// one index at a time, so scratch memory may be kept per worker number. Results must not depend on which worker runs
/// an index: a body writes only what belongs to its index or its worker.
///
/// Order: indices are handed out in ascending order, each exactly once. At most Threads() bodies run at the same time;
/// it is not promised that two ever do, so a body must never wait for another index.
///
/// Errors: when a body throws, no further index is handed out, bodies that are running finish, and For throws the error
/// of the lowest index that failed. It is the same error for every number of threads.
///
/// If the system refuses to start threads, the pool has fewer workers, at worst only the caller.
///
/// Nesting: For called by a body of the same pool runs its whole loop on the calling worker, in order and under that
/// worker's number. Calls from threads outside the pool take turns.
///
/// Cost of an empty loop: under 0.1 microseconds for one index or one worker, else up to 20 microseconds to wake the
/// others. For returns as soon as every index is done and does not wait for workers that are still asleep.
class JobPool {
  public:
    /// Starts a thread that runs `work`. Throws std::system_error if the system refuses.
    using ThreadStarter = std::function<std::thread(std::function<void()> work)>;

    /// Told about each loop that ended without an error, but for those of bodies. Called by the thread that called For.
    using LoopObserver = std::function<void(const LoopTimes &)>;

    /// threads < 1: one per hardware thread. At most kMaxThreads. `start` defaults to std::thread's constructor. With
    /// an observer an index takes about a microsecond more.
    explicit JobPool(int threads = 0, const ThreadStarter &start = {}, LoopObserver observer = {});
    ~JobPool();
    /// Neither pool may be running a loop. One that was moved from can only be assigned to or destroyed.
    JobPool(JobPool &&) noexcept;
    JobPool &operator=(JobPool &&) noexcept;

    /// Number of workers, the caller of For included.
    int Threads() const;

    /// Calls body(index, worker) for every index in 0 .. count - 1 and returns when all have finished. `done`, if
    /// given, is called by workers after indices, with the number of indices finished so far: each time a larger one,
    /// at last `count`, and never concurrently with itself. An index that finishes during such a call makes none. An
    /// exception from `done` counts as an error of the index.
    void For(std::int64_t count, const std::function<void(std::int64_t, int)> &body,
             const std::function<void(std::int64_t)> &done = {}) const;

  private:
    class Workers;
    std::unique_ptr<Workers> workers_;
    LoopObserver observer_;
};

} // namespace q3
