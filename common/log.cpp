// GPL-2.0-or-later. What the program prints, in the form that editors and build scripts expect.
#include "common/log.h"

#include "common/crash_report.h"
#include "common/platform/platform.h"
#include "common/text/text.h"

#include <cstdio>
#include <cstdlib>

namespace q3 {

namespace {

/// Whether warnings and errors are colored: on a terminal that can, unless NO_COLOR is set (no-color.org).
bool WantsColor() {
    const char *noColor = std::getenv("NO_COLOR");
    return (noColor == nullptr || *noColor == 0) && HasColors();
}

void PrintPlain(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
}

/// The text in yellow or red; the color ends before the line end. Needs no memory: the text may say that there is none.
void PrintColored(LogLevel level, std::string_view text) {
    // Foreground colors of ECMA-48, "select graphic rendition".
    constexpr std::string_view kRed = "\x1b[31m", kYellow = "\x1b[33m", kNormal = "\x1b[0m";
    const std::size_t end = text.find_last_not_of('\n') + 1;
    PrintPlain(level == LogLevel::Error ? kRed : kYellow);
    PrintPlain(text.substr(0, end));
    PrintPlain(kNormal);
    PrintPlain(text.substr(end));
}

Log::Sink Both(Log::Sink first, Log::Sink second) {
    return [first = std::move(first), second = std::move(second)](LogLevel level, std::string_view text) {
        first(level, text);
        second(level, text);
    };
}

} // namespace

Log::Sink Log::StandardOutput() {
    return [color = WantsColor()](LogLevel level, std::string_view text) {
        if (color && level != LogLevel::Normal)
            PrintColored(level, text);
        else
            PrintPlain(text);
        std::fflush(stdout);
    };
}

Log::Sink Log::Nowhere() {
    return [](LogLevel, std::string_view) {};
}

void Log::AddSink(Sink sink, MarkSink marks) {
    const std::lock_guard lock(mutex_);
    allSinks_ = Both(std::move(allSinks_), sink);
    addedSinks_ = addedSinks_ ? Both(std::move(addedSinks_), sink) : sink;
    if (marks)
        markSink_ = std::move(marks);
    else
        textSinks_ = Both(std::move(textSinks_), std::move(sink));
}

void Log::AddObserver(LogObserver &observer) {
    const std::lock_guard lock(mutex_);
    observers_.push_back(&observer);
}

void Log::RemoveObserver(LogObserver &observer) {
    const std::lock_guard lock(mutex_);
    std::erase(observers_, &observer);
}

void Log::Write(LogLevel level, std::string_view text) {
    const std::lock_guard lock(mutex_);
    allSinks_(level, text);
}

void Log::SectionText(std::string_view name, Printed printed) {
    const std::lock_guard lock(mutex_);
    AddCrashPass(name);
    for (LogObserver *observer : observers_)
        observer->OnSection(name);
    if (IsShown(printed))
        allSinks_(LogLevel::Normal, fmt::format("--- {} ---\n", name));
}

void Log::CountText(long long value, std::string_view name, Printed printed) {
    const std::lock_guard lock(mutex_);
    for (LogObserver *observer : observers_)
        observer->OnCount(value, name);
    if (IsShown(printed))
        allSinks_(LogLevel::Normal, fmt::format("{:9} {}\n", value, value == 1 ? Singular(name) : std::string(name)));
}

void Log::Setting(std::string_view name, std::string_view value, std::string_view source, std::string_view initial) {
    const std::lock_guard lock(mutex_);
    for (LogObserver *observer : observers_)
        observer->OnSetting(name, value, source, initial);
    allSinks_(LogLevel::Normal, fmt::format("  {}{}{} ({}{}{})\n", name, value.empty() ? "" : " ", value, source,
                                            initial.empty() ? "" : "; default ", initial));
}

void Log::WriteLive(std::string_view text) {
    const std::lock_guard lock(mutex_);
    mainSink_(LogLevel::Normal, text);
}

void Log::WriteAdded(std::string_view text) {
    const std::lock_guard lock(mutex_);
    if (addedSinks_)
        addedSinks_(LogLevel::Normal, text);
}

void Log::Mark(LogLevel level, std::string_view text, const LogMark &mark) {
    const std::lock_guard lock(mutex_);
    if (markSink_)
        markSink_(level, text, mark);
}

bool Log::CountWarning(std::string_view kind) {
    ++warningTotals_.try_emplace(std::string(kind), 0).first->second;
    auto found = unflushedWarnings_.find(kind);
    if (found == unflushedWarnings_.end())
        found = unflushedWarnings_.emplace(kind, 0).first;
    const bool isFirst = ++found->second == 1;
    return isFirst || verbose_;
}

void Log::WarnText(std::string_view kind, const std::string &text) {
    const std::lock_guard lock(mutex_);
    for (LogObserver *observer : observers_)
        observer->OnWarning(kind, text, nullptr);
    if (CountWarning(kind))
        allSinks_(LogLevel::Warning, "WARNING: " + text + "\n");
}

void Log::WarnAt(std::string_view kind, const LogMark &mark, const std::string &text) {
    const std::lock_guard lock(mutex_);
    for (LogObserver *observer : observers_)
        observer->OnWarning(kind, text, &mark);
    if (CountWarning(kind))
        textSinks_(LogLevel::Warning, "WARNING: " + text + "\n");
    if (markSink_)
        markSink_(LogLevel::Warning, text, mark);
}

void Log::FlushWarnings() {
    const std::lock_guard lock(mutex_);
    for (const auto &[kind, count] : unflushedWarnings_)
        if (count > 1 && !verbose_)
            allSinks_(LogLevel::Normal, fmt::format("{:9} more warning{} of this kind: {} (-v lists {})\n", count - 1,
                                                    count == 2 ? "" : "s", kind, count == 2 ? "it" : "them"));
    unflushedWarnings_.clear();
}

std::map<std::string, int, std::less<>> Log::WarningTotals() const {
    const std::lock_guard lock(mutex_);
    return warningTotals_;
}

void Log::AddToSummary(std::string line) {
    const std::lock_guard lock(mutex_);
    summaryLines_.push_back(std::move(line));
}

std::vector<std::string> Log::SummaryLines() const {
    const std::lock_guard lock(mutex_);
    return summaryLines_;
}

int Log::WarningCount(std::string_view kind) const {
    const std::lock_guard lock(mutex_);
    const auto found = unflushedWarnings_.find(kind);
    return found == unflushedWarnings_.end() ? 0 : found->second;
}

// ---- Progress of a pass ----

constexpr int kProgressMarks = 40;     ///< digits and dots of a finished pass
constexpr int kMarksPerDigit = 4;      ///< a digit and three dots, for a tenth of the pass
constexpr double kRedrawSeconds = 0.2; ///< least time between two changes of the live line

Progress::Progress(Log &log, std::int64_t total) : log_(log), total_(total), terminal_(IsTerminal()) {}

double Progress::Seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::DrawLive(std::int64_t done, std::uint64_t rays) {
    const double seconds = Seconds();
    if (seconds - lastShown_ < kRedrawSeconds || done == 0)
        return;
    lastShown_ = seconds;
    const double finished = double(done) / double(total_);
    std::string line = fmt::format("\r{:3.0f} %  ", 100 * finished);
    if (rays > 0)
        line += fmt::format("{:.1f} million rays/s  ", double(rays) / seconds / 1e6);
    log_.WriteLive(line + fmt::format("{:.0f} s left   ", seconds * (1 - finished) / finished));
}

void Progress::Update(std::int64_t done, std::uint64_t rays) {
    if (total_ <= 0)
        return;
    if (terminal_)
        DrawLive(done, rays);
    std::string steps;
    for (; marksPrinted_ < kProgressMarks && done * kProgressMarks >= std::int64_t(marksPrinted_ + 1) * total_;
         ++marksPrinted_)
        steps += marksPrinted_ % kMarksPerDigit == 0 ? fmt::format("{}", marksPrinted_ / kMarksPerDigit) : ".";
    if (steps.empty())
        return;
    if (terminal_)
        log_.WriteAdded(steps);
    else
        log_.Write(LogLevel::Normal, steps);
}

void Progress::Finish() {
    if (terminal_)
        log_.WriteLive(fmt::format("\r{:60}\r", "")); // 60 blanks cover the longest live line
    log_.Print(" ({:.0f})\n", Seconds());
}

} // namespace q3
