// GPL-2.0-or-later. What a run tells about itself: on the screen, as a JSON file, and in the map that it wrote.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/report/parallel_report.h"

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// Prints the options that changed a setting, with the value that they replace.
void PrintChangedOptions(const Arguments &arguments, Log &log);
/// Prints the keys whose value in `entity` is not their default. `source` is its class name.
void PrintChangedKeys(const Entity &entity, std::span<const EntityKey> keys, std::string_view source, Log &log);

enum class RunEnd { Done, Failed };

/// Times a run and says at its end how it went.
class RunReport {
  public:
    /// Keeps a fault that makes the result unfit, such as a leak: the last line says it first.
    void AddFault(std::string fault) { faults_.push_back(std::move(fault)); }
    /// The faults, separated by commas.
    std::string Faults() const;
    /// From now on measures which work is done in parallel, for PrintEnd. The log must outlive the report.
    void MeasureParallelWork(Log &log);
    /// A pool whose loops are measured if MeasureParallelWork was called.
    JobPool Workers(int threads);
    /// Repeats warnings of unknown options, then prints how the run ended, warnings by kind, times and memory.
    void PrintEnd(RunEnd end, Log &log);

  private:
    std::vector<std::string> faults_;
    std::optional<ParallelReport> parallel_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Collects what a run logs: changed settings, counts and times by pass, warnings.
class ReportFile final : public LogObserver {
  public:
    void OnSection(std::string_view name) override;
    void OnCount(long long value, std::string_view name) override;
    void OnSetting(std::string_view name, std::string_view value, std::string_view source,
                   std::string_view initial) override;
    void OnWarning(std::string_view kind, std::string_view text, const LogMark *mark) override;

    /// Writes the report; docs/reference/report.md describes it. `error`: of a failed run, else empty. Errors: the file
    /// cannot be written.
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

/// Appends a stage, such as "-light", and its options to the world's key `_q3map2_cmdline`, and sets `_q3map2_version`.
void RecordCommand(Entity &world, std::string_view stage, const std::vector<std::string> &words);
/// The same in the entities of a map. `name` is for messages. Errors: entity text that does not parse.
void RecordCommand(Bsp &bsp, std::string_view stage, std::string_view name, const std::vector<std::string> &words);

} // namespace q3
