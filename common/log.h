// GPL-2.0-or-later. What the program prints, in the form that editors and build scripts expect.
#pragma once

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// The numbers are those of the protocol of -connect.
enum class LogLevel { Normal = 1, Warning = 2, Error = 3 };

/// A position in the map source that an editor marks along with a message.
struct LogMark {
    int entity = -1, primitive = -1;        ///< numbers in the map source; -1: the mark is `line`
    std::vector<std::array<float, 3>> line; ///< points of a polyline, in order
};

/// Told what a run does, for its report. Called with the log locked: must not print.
class LogObserver {
  public:
    virtual ~LogObserver() = default;
    virtual void OnSection(std::string_view name) = 0;
    virtual void OnCount(long long value, std::string_view name) = 0;
    /// A setting that is not at its default. `source`: "command line", or the class name of the entity with the key.
    virtual void OnSetting(std::string_view name, std::string_view value, std::string_view source,
                           std::string_view initial) = 0;
    virtual void OnWarning(std::string_view kind, std::string_view text, const LogMark *mark) = 0;
};

/// Hands text to its sinks: standard output or another one, and those that are added, such as an editor. Safe to call
/// from worker threads.
class Log {
  public:
    using Sink = std::function<void(LogLevel, std::string_view)>;
    using MarkSink = std::function<void(LogLevel, std::string_view, const LogMark &)>;

    explicit Log(Sink sink = StandardOutput(), bool verbose = false)
        : mainSink_(sink), allSinks_(sink), textSinks_(std::move(sink)), verbose_(verbose) {}
    ~Log() { FlushWarnings(); }
    Log(const Log &) = delete;
    Log &operator=(const Log &) = delete;

    /// Standard output; warnings and errors in color on terminals that have it.
    static Sink StandardOutput();
    /// A sink that prints nothing, for steps whose messages nobody should see.
    static Sink Nowhere();

    /// Must outlive its use, which RemoveObserver ends.
    void AddObserver(LogObserver &observer);
    void RemoveObserver(LogObserver &observer);
    void SetVerbose(bool on) { verbose_ = on; }
    bool IsVerbose() const { return verbose_; }
    /// Adds a sink that receives everything printed from now on. With `marks`, text with a mark goes
    /// to `marks` instead.
    void AddSink(Sink sink, MarkSink marks = {});

    template <typename... Args> void Print(fmt::format_string<Args...> format, Args &&...args) {
        Write(LogLevel::Normal, fmt::format(format, std::forward<Args>(args)...));
    }
    /// Only printed under -v.
    template <typename... Args> void Verbose(fmt::format_string<Args...> format, Args &&...args) {
        if (verbose_)
            Write(LogLevel::Normal, fmt::format(format, std::forward<Args>(args)...));
    }
    /// "--- Name ---" on a line of its own.
    void Section(std::string_view name) { SectionText(name, Printed::Always); }
    /// One count in the format of q3map2: the value right-aligned in nine columns, then its name.
    template <std::integral T> void Count(T value, std::string_view name) {
        CountText((long long)(value), name, Printed::Always);
    }
    /// The same, only printed under -v. An observer is told in any case.
    void VerboseSection(std::string_view name) { SectionText(name, Printed::IfVerbose); }
    template <std::integral T> void VerboseCount(T value, std::string_view name) {
        CountText((long long)(value), name, Printed::IfVerbose);
    }
    /// A setting that is not at its default; see LogObserver::OnSetting.
    void Setting(std::string_view name, std::string_view value, std::string_view source, std::string_view initial);

    /// Prints the first warning of each kind as "WARNING: text" and counts the others, for FlushWarnings. `kind` is a
    /// short constant phrase such as "shader not found".
    template <typename... Args> void Warn(std::string_view kind, fmt::format_string<Args...> format, Args &&...args) {
        WarnText(kind, fmt::format(format, std::forward<Args>(args)...));
    }
    /// Prints how many further warnings of each kind there were (each one in full under -v), then forgets them.
    void FlushWarnings();
    /// How many warnings of each kind there were so far, flushed or not.
    std::map<std::string, int, std::less<>> WarningTotals() const;
    /// Keeps a line that the summary at the end of the run prints again.
    void AddToSummary(std::string line);
    std::vector<std::string> SummaryLines() const;
    /// Warnings of that kind since the last flush, for tests.
    int WarningCount(std::string_view kind) const;

    /// Writes to all sinks.
    void Write(LogLevel level, std::string_view text);
    /// Writes to the sink of the constructor only: text that a terminal overwrites in place, such as progress.
    void WriteLive(std::string_view text);
    /// Writes to the added sinks only.
    void WriteAdded(std::string_view text);
    /// Writes to the editor (MarkSink) only.
    void Mark(LogLevel level, std::string_view text, const LogMark &mark);
    /// Warn with a mark: an editor gets every warning, other sinks only what Warn prints.
    void WarnAt(std::string_view kind, const LogMark &mark, const std::string &text);

  private:
    enum class Printed { Always, IfVerbose };

    void SectionText(std::string_view name, Printed printed);
    void CountText(long long value, std::string_view name, Printed printed);
    bool IsShown(Printed printed) const { return printed == Printed::Always || verbose_; }
    void WarnText(std::string_view kind, const std::string &text);
    /// Whether to print one more warning of that kind.
    bool CountWarning(std::string_view kind);

    Sink mainSink_;     ///< the sink of the constructor
    Sink addedSinks_;   ///< the sinks of AddSink; null if none
    Sink allSinks_;     ///< mainSink_ and addedSinks_
    MarkSink markSink_; ///< null: no sink takes marks
    Sink textSinks_;    ///< those of allSinks_ that take no marks
    bool verbose_ = false;
    std::vector<LogObserver *> observers_;
    mutable std::mutex mutex_;
    std::map<std::string, int, std::less<>> unflushedWarnings_, warningTotals_; ///< counts by kind
    std::vector<std::string> summaryLines_;
};

/// Prints the progress of a pass. Terminals get one live line with percent, rays per second and time left; files and
/// editors get "0...1...2...3...4...5...6...7...8...9... (12)", with the seconds at the end.
class Progress {
  public:
    Progress(Log &log, std::int64_t total);

    /// `done` of `total` steps are finished; `rays`: cast so far in this pass. Not for concurrent calls.
    void Update(std::int64_t done, std::uint64_t rays);
    /// Ends the line with the elapsed seconds.
    void Finish();
    /// Since the pass began.
    double Seconds() const;

  private:
    void DrawLive(std::int64_t done, std::uint64_t rays);

    Log &log_;
    std::int64_t total_;
    bool terminal_;
    int marksPrinted_ = 0;
    double lastShown_ = 0; ///< when the live line changed last, in seconds since the start
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

} // namespace q3
