// GPL-2.0-or-later. How far a pass has come.
#pragma once

#include "common/log.h"

#include <chrono>
#include <cstdint>

namespace q3 {

/// "0...1...2...3...4...5...6...7...8...9... (12)", which editors know. A terminal gets one live line instead, with
/// percent, rays per second and time left; an editor that follows gets the former all the same.
class Progress {
  public:
    Progress(Log &log, std::int64_t total);

    /// `rays` cast so far in this pass. Not safe to call from two threads at once.
    void Update(std::int64_t done, std::uint64_t rays);
    /// Ends the line with the seconds it took.
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
