// GPL-2.0-or-later. Parallel loops over indices.
#include "common/jobs.h"

#include "common/platform/platform.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <vector>

namespace q3 {

namespace {

constexpr std::size_t kCacheLine = 64; ///< bytes; of most processors

/// One call of For, shared by the workers that take part.
class Loop {
  public:
    Loop(std::int64_t count, const std::function<void(std::int64_t, int)> &body,
         const std::function<void(std::int64_t)> &done, LoopTimes *times)
        : count_(count), body_(body), done_(done), times_(times) {}

    /// Takes and runs indices until none is left.
    void Run(int worker) {
        for (std::int64_t index; (index = next_.fetch_add(1)) < count_;) {
            try {
                if (times_)
                    RunTimed(index, worker);
                else
                    body_(index, worker);
                if (done_)
                    Report();
            } catch (...) {
                Fail(index);
            }
        }
    }
    /// To be called after every worker has left Run. Errors: that of the lowest index.
    void Finish() {
        if (error_)
            std::rethrow_exception(error_);
        if (done_ && reported_ < count_)
            done_(count_);
    }

  private:
    void RunTimed(std::int64_t index, int worker) {
        const double start = ThreadCpuSeconds();
        body_(index, worker);
        times_->indices[std::size_t(index)] = float(ThreadCpuSeconds() - start);
    }

    /// A worker does not wait for another one that reports.
    void Report() {
        ++finished_;
        const std::unique_lock lock(reporting_, std::try_to_lock);
        if (const std::int64_t finished = finished_; lock && finished > reported_)
            done_(reported_ = finished);
    }

    /// Indices are handed out in ascending order, so the lowest index that fails has been handed out by now and runs
    /// to its end: the error that is kept does not depend on timing.
    void Fail(std::int64_t index) {
        next_ = count_;
        const std::lock_guard lock(mutex_);
        if (!error_ || index < failed_)
            error_ = std::current_exception(), failed_ = index;
    }

    const std::int64_t count_;
    const std::function<void(std::int64_t, int)> &body_;
    const std::function<void(std::int64_t)> &done_;
    LoopTimes *const times_; ///< null: not measured
    // On cache lines of their own, since each index changes them.
    alignas(kCacheLine) std::atomic<std::int64_t> next_{0};
    alignas(kCacheLine) std::atomic<std::int64_t> finished_{0};
    alignas(kCacheLine) std::mutex reporting_; ///< held during calls of done_
    std::int64_t reported_ = 0;                ///< count of the last call
    std::mutex mutex_;                         ///< guards the members below
    std::int64_t failed_ = 0;
    std::exception_ptr error_;
};

} // namespace

class JobPool::Workers {
  public:
    Workers(int threads, const ThreadStarter &start) : alarms_(std::size_t(threads)) {
        threads_.reserve(std::size_t(threads));
        try {
            for (int worker = 1; worker < threads; ++worker)
                threads_.push_back(start([this, worker] { Serve(worker); }));
        } catch (const std::system_error &) {
            // The pool makes do with the threads that started.
        } catch (...) {
            Stop();
            throw;
        }
    }
    ~Workers() { Stop(); }
    Workers(const Workers &) = delete;
    Workers &operator=(const Workers &) = delete;

    int Count() const { return int(threads_.size()) + 1; }

    /// Worker number of the calling thread; -1: neither a thread of the pool nor the caller of the running loop.
    int CurrentWorker() const {
        const std::thread::id self = std::this_thread::get_id();
        if (caller_.load() == self)
            return 0;
        for (std::size_t i = 0; i < threads_.size(); ++i)
            if (threads_[i].get_id() == self)
                return int(i) + 1;
        return -1;
    }

    /// Runs the loop for a calling thread that is not in the pool.
    void Run(Loop &loop, std::int64_t count) {
        const std::lock_guard turn(turn_);
        caller_ = std::this_thread::get_id();
        if (const int others = int(std::min<std::int64_t>(Count(), count)) - 1; others > 0)
            RunWith(others, loop);
        else
            loop.Run(0);
        caller_ = std::thread::id();
    }

  private:
    void RunWith(int others, Loop &loop) {
        {
            const std::lock_guard lock(mutex_);
            loop_ = &loop, wanted_ = invited_ = others;
        }
        WakeNext(0, others);
        loop.Run(0);
        std::unique_lock lock(mutex_);
        wanted_ = 0; // no index is left for workers that are still asleep
        idle_.wait(lock, [this] { return running_ == 0; });
    }

    /// Each worker wakes the next two of a binary tree, so that the last of 64 does not wait for 63 calls of the system
    /// in a row. invited: the number of the last worker that is wanted.
    void WakeNext(int worker, int invited) {
        for (int next = 2 * worker + 1; next <= std::min(2 * worker + 2, invited); ++next)
            Wake(next);
    }

    /// Workers sleep on alarms of their own. Waking up by a common condition variable would make the one that wakes
    /// others wait until those that it woke before have left it.
    void Wake(int worker) {
        Alarm &alarm = alarms_[std::size_t(worker)];
        ++alarm.rings;
        alarm.rings.notify_one();
    }

    void Serve(int worker) {
        PrepareThreadForCrashes();
        std::uint32_t heard = 0;
        for (;;) {
            std::atomic<std::uint32_t> &rings = alarms_[std::size_t(worker)].rings;
            rings.wait(heard);
            heard = rings;
            std::unique_lock lock(mutex_);
            if (stopped_)
                return;
            if (wanted_ == 0) // the loop has ended, or a worker that was late for the one before took the place
                continue;
            Loop &loop = *loop_;
            --wanted_, ++running_;
            const int invited = invited_;
            lock.unlock();
            WakeNext(worker, invited);
            loop.Run(worker);
            lock.lock();
            if (--running_ == 0)
                idle_.notify_one();
        }
    }

    void Stop() {
        {
            const std::lock_guard lock(mutex_);
            stopped_ = true;
        }
        for (int worker = 1; worker < Count(); ++worker)
            Wake(worker);
        for (std::thread &thread : threads_)
            thread.join();
    }

    struct alignas(kCacheLine) Alarm {
        std::atomic<std::uint32_t> rings{0}; ///< how often the worker was woken
    };

    std::mutex turn_; ///< held by the outside thread whose loop runs
    std::atomic<std::thread::id> caller_{};
    std::vector<Alarm> alarms_; ///< by worker
    std::mutex mutex_;          ///< guards the members below except threads_
    std::condition_variable idle_;
    Loop *loop_ = nullptr;
    int invited_ = 0; ///< workers that are woken for the loop, from 1
    int wanted_ = 0;  ///< workers that may still join the loop
    int running_ = 0; ///< workers in the loop, without the caller
    bool stopped_ = false;
    std::vector<std::thread> threads_; ///< threads_[i] is worker i + 1
};

JobPool::JobPool(int threads, const ThreadStarter &start, LoopObserver observer)
    : workers_(std::make_unique<Workers>(
          std::clamp(threads < 1 ? int(std::thread::hardware_concurrency()) : threads, 1, kMaxThreads),
          start ? start : [](std::function<void()> work) { return std::thread(std::move(work)); })),
      observer_(std::move(observer)) {}

JobPool::~JobPool() = default;
JobPool::JobPool(JobPool &&) noexcept = default;
JobPool &JobPool::operator=(JobPool &&) noexcept = default;

int JobPool::Threads() const {
    return workers_->Count();
}

void JobPool::For(std::int64_t count, const std::function<void(std::int64_t, int)> &body,
                  const std::function<void(std::int64_t)> &done) const {
    const int worker = workers_->CurrentWorker();
    if (worker >= 0) { // called by a body of this pool
        Loop loop(count, body, done, nullptr);
        loop.Run(worker);
        loop.Finish();
        return;
    }
    LoopTimes times;
    if (observer_)
        times.indices.resize(std::size_t(std::max<std::int64_t>(0, count)));
    Loop loop(count, body, done, observer_ ? &times : nullptr);
    const double start = observer_ ? ThreadCpuSeconds() : 0;
    workers_->Run(loop, count);
    loop.Finish();
    if (observer_) {
        times.caller = ThreadCpuSeconds() - start;
        observer_(times);
    }
}

} // namespace q3
