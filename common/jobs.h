// GPL-2.0-or-later. Loops over indices on several threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

namespace q3 {

/// Runs loops on a fixed number of threads. Results may not depend on which worker does what: a worker writes only the
/// slots of its own indices.
class JobPool {
  public:
    /// threads < 1: one per hardware thread.
    explicit JobPool(int threads = 0);

    int Threads() const { return threads_; }

    /// Calls body(index, worker) once for every index in 0..count-1, worker in 0..Threads()-1. With one thread it runs
    /// on the caller's. An exception from body stops the loop and is thrown to the caller. `done`, if given, is called
    /// from any worker with the number of finished indices, never concurrently with itself.
    void For(std::int64_t count, const std::function<void(std::int64_t, int)> &body,
             const std::function<void(std::int64_t)> &done = {}) const;

  private:
    int threads_;
};

} // namespace q3
