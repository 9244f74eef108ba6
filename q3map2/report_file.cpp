// GPL-2.0-or-later. The report of a run as a JSON file.
#include "q3map2/report_file.h"

#include "common/cpu_time.h"
#include "common/files/files.h"
#include "q3map2/version.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace q3 {

namespace {

/// Reports of maps with very many faults stay readable.
constexpr std::size_t kMostWarnings = 10000;

double SecondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

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
    using Json = nlohmann::ordered_json;
    Json report{{"version", kVersion},
                {"commandLine", words},
                {"status", error.empty() ? "done" : "failed"},
                {"seconds", SecondsSince(start_)},
                {"cpuSeconds", CpuSeconds()},
                {"peakMemoryBytes", PeakMemory()}};
    if (!error.empty())
        report["error"] = error;
    report["settings"] = Json::array();
    for (const Setting &s : settings_)
        report["settings"].push_back(
            {{"name", s.name}, {"value", s.value}, {"default", s.initial}, {"from", s.source}});
    report["passes"] = Json::array();
    for (const Pass &pass : passes_) {
        Json counts = Json::object();
        for (const Count &count : pass.counts)
            counts[count.name] = count.value;
        report["passes"].push_back(
            {{"name", pass.name}, {"seconds", pass.seconds}, {"cpuSeconds", pass.cpuSeconds}, {"counts", counts}});
    }
    report["warnings"] = Json::array();
    for (const Warning &w : warnings_) {
        Json warning{{"kind", w.kind}, {"text", w.text}};
        if (w.entity >= 0)
            warning["entity"] = w.entity;
        if (w.primitive >= 0)
            warning["brush"] = w.primitive;
        report["warnings"].push_back(std::move(warning));
    }
    // Names in maps may be in any encoding.
    const std::string text = report.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
    ReplaceTextFile(path, text);
}

} // namespace q3
