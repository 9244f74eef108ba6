// GPL-2.0-or-later. Which part of a run's work keeps all cores busy, and which runs on one, as -v prints it.
#pragma once

#include "common/jobs.h"
#include "common/log.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Seconds that `workers` take for the indices of a loop, if each takes the next index as soon as it is free (list
/// scheduling) and runs it as fast as it ran when it was measured.
double LoopSpan(std::span<const float> indexSeconds, int workers);

/// Adds up, by pass, the CPU time within loops of a pool and that of the main thread outside of them. To be made,
/// observed and printed by the main thread.
class ParallelReport final : public LogObserver {
  public:
    ParallelReport();
    /// For the pool of the run.
    JobPool::LoopObserver Observer();
    /// A row for each pass that took kLeastSeconds, and one for the run.
    void Print(Log &log);

    void OnSection(std::string_view name) override;
    void OnCount(long long, std::string_view) override {}
    void OnSetting(std::string_view, std::string_view, std::string_view, std::string_view) override {}
    void OnWarning(std::string_view, std::string_view, const LogMark *) override {}

  private:
    /// Numbers of workers for which the time is predicted; more than most machines have.
    static constexpr std::array<int, 3> kWorkers = {16, 32, 64};

    struct Pass {
        std::string name;
        double serial = 0, parallel = 0;  ///< CPU seconds
        double longest = 0;               ///< sum over the loops of their longest index, seconds
        std::array<double, 3> spans{};    ///< sum over the loops of LoopSpan, by kWorkers
        long long loops = 0, indices = 0; ///< how many there were
        void Add(const Pass &other);
        std::string Row() const;
    };

    void AddLoop(const LoopTimes &times);
    /// CPU seconds of the main thread since the last call.
    double Elapsed();

    std::vector<Pass> passes_;
    double last_ = 0; ///< CPU seconds of the main thread
};

} // namespace q3
