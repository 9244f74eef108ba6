// GPL-2.0-or-later. What a run prints about itself.
#include "q3map2/run_report.h"

#include "common/cpu_time.h"
#include "common/text/counted.h"

#include <cmath>

#include <fmt/ranges.h>

namespace q3 {

namespace {

constexpr double kBytesPerMebibyte = 1024 * 1024;

std::string WarningText(const Log &log) {
    std::string kinds;
    int total = 0;
    for (const auto &[kind, count] : log.WarningTotals()) {
        kinds += fmt::format("{}{}: {}", kinds.empty() ? "" : ", ", kind, count);
        total += count;
    }
    if (total == 0)
        return "no warnings";
    return fmt::format("{} ({})", Counted(total, "warnings"), kinds);
}

} // namespace

void PrintChangedOptions(const Arguments &arguments, Log &log) {
    for (const Arguments::Change &change : arguments.Changes())
        log.Setting(change.name, change.values, "command line", change.before);
}

void PrintChangedKeys(const Entity &entity, std::span<const EntityKey> keys, std::string_view source, Log &log) {
    for (const EntityKey &key : keys)
        if (const std::string_view value = key.Text(entity); !value.empty() && value != key.InitialText())
            log.Setting(key.info.name, value, source, key.InitialText());
}

std::string RunReport::Faults() const {
    return fmt::format("{}", fmt::join(faults_, ", "));
}

void RunReport::PrintEnd(bool failed, Log &log) const {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    for (const std::string &line : log.Repeated())
        log.Print("{}\n", line);
    log.Print("{:9.0f} {} elapsed\n", seconds, std::lround(seconds) == 1 ? "second" : "seconds");
    const std::string faults = Faults();
    // Editors look at the level of this line, not at the exit status.
    log.Write(failed ? LogLevel::Error : LogLevel::Normal,
              fmt::format("{}: {}{}, {:.1f} s, {:.1f} CPU s, {:.0f} MB peak memory\n", failed ? "failed" : "done",
                          faults.empty() ? "" : faults + ", ", WarningText(log), seconds, CpuSeconds(),
                          PeakMemory() / kBytesPerMebibyte));
}

} // namespace q3
