// GPL-2.0-or-later. What the program prints.
#include "common/log.h"

#include <cstdio>

namespace q3 {

Log::Sink Log::StandardOutput() {
    return [](LogLevel, std::string_view text) {
        std::fwrite(text.data(), 1, text.size(), stdout);
        std::fflush(stdout);
    };
}

void Log::AddSink(Sink sink) {
    const std::lock_guard lock(mutex_);
    sink_ = [first = std::move(sink_), second = std::move(sink)](LogLevel level, std::string_view text) {
        first(level, text);
        second(level, text);
    };
}

void Log::Write(LogLevel level, std::string_view text) {
    const std::lock_guard lock(mutex_);
    sink_(level, text);
}

void Log::WarnText(std::string_view kind, std::string text) {
    const std::lock_guard lock(mutex_);
    auto found = warnings_.find(kind);
    if (found == warnings_.end())
        found = warnings_.emplace(kind, 0).first;
    if (++found->second == 1 || verbose_)
        sink_(LogLevel::Warning, "WARNING: " + text + "\n");
}

void Log::FlushWarnings() {
    const std::lock_guard lock(mutex_);
    for (const auto &[kind, count] : warnings_)
        if (count > 1 && !verbose_)
            sink_(LogLevel::Normal, fmt::format("{:9} more warnings like it: {} (-v lists them)\n", count - 1, kind));
    warnings_.clear();
}

int Log::WarningCount(std::string_view kind) const {
    const std::lock_guard lock(mutex_);
    const auto found = warnings_.find(kind);
    return found == warnings_.end() ? 0 : found->second;
}

} // namespace q3
