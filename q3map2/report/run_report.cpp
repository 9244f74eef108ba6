// GPL-2.0-or-later. What a run tells about itself: on the screen, as a JSON file, and in the map that it wrote.
#include "q3map2/report/run_report.h"

#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "q3map2/report/version.h"

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace q3 {

// ---- What a run prints about itself ----

namespace {

constexpr double kBytesPerMebibyte = 1024 * 1024;

double SecondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

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

void RunReport::MeasureParallelWork(Log &log) {
    log.AddObserver(parallel_.emplace());
}

JobPool RunReport::Workers(int threads) {
    return JobPool(threads, {}, parallel_ ? parallel_->Observer() : JobPool::LoopObserver());
}

void RunReport::PrintEnd(RunEnd end, Log &log) {
    if (parallel_) {
        log.RemoveObserver(*parallel_);
        parallel_->Print(log);
        parallel_.reset();
    }
    const bool failed = end == RunEnd::Failed;
    const double seconds = SecondsSince(start_);
    for (const std::string &line : log.SummaryLines())
        log.Print("{}\n", line);
    log.Print("{:9.0f} {} elapsed\n", seconds, std::lround(seconds) == 1 ? "second" : "seconds");
    const std::string faults = Faults();
    // Editors look at the level of this line, not at the exit status.
    log.Write(failed ? LogLevel::Error : LogLevel::Normal,
              fmt::format("{}: {}{}, {:.1f} s, {:.1f} CPU s, {:.0f} MB peak memory\n", failed ? "failed" : "done",
                          faults.empty() ? "" : faults + ", ", WarningText(log), seconds, CpuSeconds(),
                          PeakMemory() / kBytesPerMebibyte));
}

// ---- The report of a run as a JSON file ----

namespace {

/// Chosen, so that reports of maps with very many faults stay readable.
constexpr std::size_t kMostWarnings = 10000;
/// JSON text with a line for each value. There is no tree of values: that of nlohmann allocates memory to
/// free it, and ends the program without.
class ReportText {
  public:
    void Open(char bracket) {
        text_ += bracket;
        isFirst_.push_back(true);
    }
    void Close(char bracket) {
        const bool isEmpty = isFirst_.back();
        isFirst_.pop_back();
        if (!isEmpty)
            NewLine();
        text_ += bracket;
    }
    /// Begins an element of the innermost list, or with `name` a member of the innermost object.
    ReportText &Next() {
        if (!isFirst_.back())
            text_ += ',';
        isFirst_.back() = false;
        NewLine();
        return *this;
    }
    ReportText &Next(std::string_view name) {
        Next().Value(name);
        text_ += ": ";
        return *this;
    }
    /// Names in maps may be in any encoding.
    void Value(const nlohmann::json &scalar) {
        constexpr int kOneLine = -1;
        constexpr bool kEscapesUtf8 = false;
        text_ += scalar.dump(kOneLine, ' ', kEscapesUtf8, nlohmann::json::error_handler_t::replace);
    }
    std::string Take() { return std::move(text_) + "\n"; }

  private:
    void NewLine() { text_.append("\n").append(isFirst_.size(), ' '); }

    std::string text_;
    std::vector<bool> isFirst_; ///< of each open list and object: whether it is empty so far
};

} // namespace

void ReportFile::EndPass() {
    Pass &pass = passes_[current_];
    const double cpu = CpuSeconds();
    pass.seconds += SecondsSince(passStart_);
    pass.cpuSeconds += cpu - passCpu_;
    passStart_ = Clock::now();
    passCpu_ = cpu;
}

void ReportFile::OnSection(std::string_view name) {
    EndPass();
    const auto found = std::ranges::find(passes_, name, &Pass::name);
    current_ = std::size_t(found - passes_.begin());
    if (found == passes_.end())
        passes_.push_back({std::string(name), 0, 0, {}});
}

void ReportFile::OnCount(long long value, std::string_view name) {
    std::vector<Count> &counts = passes_[current_].counts;
    const auto found = std::ranges::find(counts, name, &Count::name);
    if (found == counts.end())
        counts.push_back({std::string(name), value});
    else
        found->value += value;
}

void ReportFile::OnSetting(std::string_view name, std::string_view value, std::string_view source,
                           std::string_view initial) {
    settings_.push_back({std::string(name), std::string(value), std::string(source), std::string(initial)});
}

void ReportFile::OnWarning(std::string_view kind, std::string_view text, const LogMark *mark) {
    if (warnings_.size() < kMostWarnings)
        warnings_.push_back(
            {std::string(kind), std::string(text), mark ? mark->entity : -1, mark ? mark->primitive : -1});
}

void ReportFile::Write(const std::filesystem::path &path, const std::vector<std::string> &words,
                       std::string_view error) {
    EndPass();
    ReportText report;
    report.Open('{');
    report.Next("version").Value(kVersion);
    report.Next("commandLine").Open('[');
    for (const std::string &word : words)
        report.Next().Value(word);
    report.Close(']');
    report.Next("status").Value(error.empty() ? "done" : "failed");
    report.Next("seconds").Value(SecondsSince(start_));
    report.Next("cpuSeconds").Value(CpuSeconds());
    report.Next("peakMemoryBytes").Value(PeakMemory());
    if (!error.empty())
        report.Next("error").Value(error);
    report.Next("settings").Open('[');
    for (const Setting &s : settings_) {
        report.Next().Open('{');
        report.Next("name").Value(s.name);
        report.Next("value").Value(s.value);
        report.Next("default").Value(s.initial);
        report.Next("from").Value(s.source);
        report.Close('}');
    }
    report.Close(']');
    report.Next("passes").Open('[');
    for (const Pass &pass : passes_) {
        report.Next().Open('{');
        report.Next("name").Value(pass.name);
        report.Next("seconds").Value(pass.seconds);
        report.Next("cpuSeconds").Value(pass.cpuSeconds);
        report.Next("counts").Open('{');
        for (const Count &count : pass.counts)
            report.Next(count.name).Value(count.value);
        report.Close('}');
        report.Close('}');
    }
    report.Close(']');
    report.Next("warnings").Open('[');
    for (const Warning &w : warnings_) {
        report.Next().Open('{');
        report.Next("kind").Value(w.kind);
        report.Next("text").Value(w.text);
        if (w.entity >= 0)
            report.Next("entity").Value(w.entity);
        if (w.primitive >= 0)
            report.Next("brush").Value(w.primitive);
        report.Close('}');
    }
    report.Close(']');
    report.Close('}');
    ReplaceTextFile(path, report.Take());
}

// ---- Records command lines of the stages in worldspawn ----

namespace {

/// Bytes. Engines read at most 1024 of a value; the oldest records go first.
constexpr std::size_t kMaxRecord = 900;

} // namespace

void RecordCommand(Entity &world, std::string_view stage, const std::vector<std::string> &words) {
    std::string command(stage);
    for (const std::string &word : words) {
        command += ' ';
        for (const char c : word)
            if (c != '\\' && c != '"' && c != ';' && static_cast<unsigned char>(c) >= 32)
                command += c;
    }
    std::string record(world.Value("_q3map2_cmdline"));
    record += (record.empty() ? "" : "; ") + command;
    while (record.size() > kMaxRecord && record.find("; ") != std::string::npos)
        record.erase(0, record.find("; ") + 2);
    world.Set("_q3map2_cmdline", record.substr(0, kMaxRecord));
    world.Set("_q3map2_version", kVersion);
}

void RecordCommand(Bsp &bsp, std::string_view stage, std::string_view name, const std::vector<std::string> &words) {
    std::vector<Entity> entities = StoredEntities(bsp.entities, name);
    RecordCommand(entities.front(), stage, words);
    bsp.entities = FormatEntities(entities);
}

} // namespace q3
