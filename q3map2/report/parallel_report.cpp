// GPL-2.0-or-later. Which part of a run's work keeps all cores busy, and which runs on one, as -v prints it.
#include "q3map2/report/parallel_report.h"

#include "common/platform/platform.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>

namespace q3 {

namespace {

/// Passes that took less are only in the row of the run.
constexpr double kLeastSeconds = 0.005;

constexpr std::string_view kPassOfStart = "start", kRowOfRun = "all";

} // namespace

double LoopSpan(std::span<const float> indexSeconds, int workers) {
    std::priority_queue<double, std::vector<double>, std::greater<>> freeAt; // when workers become free
    double end = 0;
    for (const float seconds : indexSeconds) {
        double start = 0;
        if (int(freeAt.size()) == workers)
            start = freeAt.top(), freeAt.pop();
        freeAt.push(start + double(seconds));
        end = std::max(end, start + double(seconds));
    }
    return end;
}

void ParallelReport::Pass::Add(const Pass &other) {
    serial += other.serial, parallel += other.parallel, longest += other.longest;
    loops += other.loops, indices += other.indices;
    for (std::size_t i = 0; i < spans.size(); ++i)
        spans[i] += other.spans[i];
}

std::string ParallelReport::Pass::Row() const {
    const double cpu = serial + parallel;
    std::string row =
        fmt::format("{:<24} {:8.3f} {:8.3f} {:6} {:9} {:8.3f}", name, cpu, serial, loops, indices, longest);
    for (const double span : spans)
        row += fmt::format(" {:6.1f}", cpu > 0 ? cpu / (serial + span) : 1);
    return row;
}

ParallelReport::ParallelReport() : passes_{{.name = std::string(kPassOfStart)}} {}

JobPool::LoopObserver ParallelReport::Observer() {
    return [this](const LoopTimes &times) { AddLoop(times); };
}

double ParallelReport::Elapsed() {
    const double now = ThreadCpuSeconds();
    return now - std::exchange(last_, now);
}

void ParallelReport::AddLoop(const LoopTimes &times) {
    Pass &pass = passes_.back();
    pass.serial += std::max(0.0, Elapsed() - times.caller);
    pass.parallel += std::accumulate(times.indices.begin(), times.indices.end(), 0.0);
    pass.longest += times.indices.empty() ? 0 : double(*std::ranges::max_element(times.indices));
    for (std::size_t i = 0; i < kWorkers.size(); ++i)
        pass.spans[i] += LoopSpan(times.indices, kWorkers[i]);
    ++pass.loops;
    pass.indices += (long long)(times.indices.size());
    last_ = ThreadCpuSeconds(); // without the time of this function
}

void ParallelReport::OnSection(std::string_view name) {
    passes_.back().serial += Elapsed();
    passes_.push_back({.name = std::string(name)});
}

void ParallelReport::Print(Log &log) {
    passes_.back().serial += Elapsed();
    Pass run{.name = std::string(kRowOfRun)};
    std::string speedups;
    for (const int workers : kWorkers)
        speedups += fmt::format(" {:>6}", fmt::format("x{}", workers));
    log.Print("{:<24} {:>8} {:>8} {:>6} {:>9} {:>8}{}\n", "Parallel work", "CPU s", "serial", "loops", "steps",
              "longest", speedups);
    for (const Pass &pass : passes_) {
        run.Add(pass);
        if (pass.serial + pass.parallel >= kLeastSeconds)
            log.Print("{}\n", pass.Row());
    }
    log.Print("{}\n", run.Row());
}

} // namespace q3
