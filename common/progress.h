// GPL-2.0-or-later. Progress of a pass.
#pragma once

#include "common/log.h"

#include <chrono>
#include <cstdint>

namespace q3 {

/// Prints the progress of a pass. Terminals get one live line with percent, rays per second and time left; files and
/// editors get "0...1...2...3...4...5...6...7...8...9... (12)", with the seconds at the end.
class Progress {
  public:
    Progress(Log &log, std::int64_t total);

    /// `done` of `total` steps are finished; `rays`: cast so far in this pass. Not for concurrent calls.
    void Update(std::int64_t done, std::uint64_t rays);
    /// Ends the line with the elapsed seconds.
    void Finish();
    double Seconds() const;

  private:
    void DrawLive(std::int64_t done, std::uint64_t rays);

    Log &log_;
    std::int64_t total_;
    bool terminal_;
    int step_ = 0;
    double lastShown_ = 0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

} // namespace q3
