// GPL-2.0-or-later. Progress of a pass.
#include "common/progress.h"

#include "common/platform/platform.h"

namespace q3 {

constexpr int kSteps = 40;
constexpr double kRedrawSeconds = 0.2;

Progress::Progress(Log &log, std::int64_t total) : log_(log), total_(total), terminal_(IsTerminal()) {}

double Progress::Seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::DrawLive(std::int64_t done, std::uint64_t rays) {
    const double seconds = Seconds();
    if (seconds - lastShown_ < kRedrawSeconds || done == 0)
        return;
    lastShown_ = seconds;
    const double share = double(done) / double(total_);
    std::string line = fmt::format("\r{:3.0f} %  ", 100 * share);
    if (rays > 0)
        line += fmt::format("{:.1f} million rays/s  ", double(rays) / seconds / 1e6);
    log_.WriteLive(line + fmt::format("{:.0f} s left   ", seconds * (1 - share) / share));
}

void Progress::Update(std::int64_t done, std::uint64_t rays) {
    if (total_ <= 0)
        return;
    if (terminal_)
        DrawLive(done, rays);
    std::string steps;
    for (; step_ < kSteps && done * kSteps >= std::int64_t(step_ + 1) * total_; ++step_)
        steps += step_ % 4 == 0 ? fmt::format("{}", step_ / 4) : ".";
    if (steps.empty())
        return;
    if (terminal_)
        log_.WriteAdded(steps);
    else
        log_.Write(LogLevel::Normal, steps);
}

void Progress::Finish() {
    if (terminal_)
        log_.WriteLive(fmt::format("\r{:60}\r", ""));
    log_.Print(" ({:.0f})\n", Seconds());
}

} // namespace q3
