// GPL-2.0-or-later. The report of a run as a JSON file: -report.
#pragma once

#include "common/log.h"

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace q3 {

/// Collects what a run logs: changed settings, counts and times by pass, warnings.
class ReportFile final : public LogObserver {
  public:
    void OnSection(std::string_view name) override;
    void OnCount(long long value, std::string_view name) override;
    void OnSetting(std::string_view name, std::string_view value, std::string_view source,
                   std::string_view initial) override;
    void OnWarning(std::string_view kind, std::string_view text, const LogMark *mark) override;

    /// Writes the report; docs/report.md describes it. `error`: of a failed run, else empty. Errors: the file cannot be
    /// written.
    void Write(const std::filesystem::path &path, const std::vector<std::string> &words, std::string_view error);

  private:
    using Clock = std::chrono::steady_clock;

    struct Count {
        std::string name;
        long long value = 0;
    };
    /// A pass: from its section line to the next. Passes of one name are one entry.
    struct Pass {
        std::string name;
        double seconds = 0, cpuSeconds = 0;
        std::vector<Count> counts;
    };
    struct Setting {
        std::string name, value, source, initial;
    };
    struct Warning {
        std::string kind, text;
        int entity = -1, primitive = -1; ///< numbers in the map source; -1: none
    };

    void EndPass();

    std::vector<Pass> passes_{{"start", 0, 0, {}}};
    std::size_t current_ = 0; ///< of passes_
    std::vector<Setting> settings_;
    std::vector<Warning> warnings_;
    Clock::time_point start_ = Clock::now(), passStart_ = start_;
    double passCpu_ = 0; ///< CPU seconds of the process when the pass began
};

} // namespace q3
