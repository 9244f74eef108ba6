// GPL-2.0-or-later. Loops over indices on several threads.
#include "common/jobs.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace q3 {

constexpr int kMaxThreads = 64;

JobPool::JobPool(int threads)
    : threads_(std::clamp(threads < 1 ? int(std::thread::hardware_concurrency()) : threads, 1, kMaxThreads)) {}

void JobPool::For(std::int64_t count, const std::function<void(std::int64_t, int)> &body,
                  const std::function<void(std::int64_t)> &done) const {
    std::atomic<std::int64_t> next{0};
    std::int64_t finished = 0;
    std::mutex mutex;
    std::exception_ptr failure;

    auto work = [&](int worker) {
        for (;;) {
            const std::int64_t index = next.fetch_add(1);
            if (index >= count)
                return;
            try {
                body(index, worker);
                if (done) {
                    const std::lock_guard lock(mutex);
                    done(++finished);
                }
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!failure)
                    failure = std::current_exception();
                next = count;
                return;
            }
        }
    };

    const int workers = int(std::min<std::int64_t>(threads_, count));
    std::vector<std::jthread> others;
    for (int worker = 1; worker < workers; ++worker)
        others.emplace_back(work, worker);
    work(0);
    others.clear();
    if (failure)
        std::rethrow_exception(failure);
}

} // namespace q3
