// GPL-2.0-or-later. Sections, counts and warnings of a run, kept to print them again.
#pragma once

#include "common/log.h"
#include "q3map2/units/unit_bytes.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Keeps what the log gets as long as it exists.
class RunEvents final : public LogObserver {
  public:
    /// omitted: kinds of warnings to leave out.
    explicit RunEvents(Log &log, std::vector<std::string_view> omitted = {}) : log_(log), omitted_(std::move(omitted)) {
        log.AddObserver(*this);
    }
    ~RunEvents() override { log_.RemoveObserver(*this); }
    RunEvents(const RunEvents &) = delete;
    RunEvents &operator=(const RunEvents &) = delete;

    void OnSection(std::string_view name) override;
    void OnCount(long long value, std::string_view name) override;
    void OnSetting(std::string_view, std::string_view, std::string_view, std::string_view) override {}
    void OnWarning(std::string_view kind, std::string_view text, const LogMark *mark) override;

    bool HasWarnings() const { return warnings_ > 0; }
    /// The events, for Replay.
    std::vector<std::byte> Take() { return events_.Take(); }
    static void Replay(std::span<const std::byte> events, Log &log);

  private:
    Log &log_;
    std::vector<std::string_view> omitted_;
    UnitWriter events_;
    int warnings_ = 0;
};

} // namespace q3
