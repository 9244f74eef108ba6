// GPL-2.0-or-later. Sections, counts and warnings of a run, kept to print them again.
#include "q3map2/stages/run_events.h"

#include <algorithm>
#include <cstdint>
#include <string>

namespace q3 {

namespace {

enum class EventKind : std::uint8_t { Section, Count, Warning };

void ReplayWarning(UnitReader &reader, std::string_view kind, Log &log) {
    std::string text;
    reader.GetText(text);
    std::uint8_t hasMark = 0;
    reader.Get(hasMark);
    if (hasMark == 0)
        return log.Warn(kind, "{}", text);
    LogMark mark;
    reader.Get(mark.entity), reader.Get(mark.primitive);
    reader.GetAll(mark.line);
    log.WarnAt(kind, mark, text);
}

} // namespace

void RunEvents::OnSection(std::string_view name) {
    events_.Put(EventKind::Section), events_.PutText(name);
}

void RunEvents::OnCount(long long value, std::string_view name) {
    events_.Put(EventKind::Count), events_.Put(value), events_.PutText(name);
}

void RunEvents::OnWarning(std::string_view kind, std::string_view text, const LogMark *mark) {
    if (std::ranges::find(omitted_, kind) != omitted_.end())
        return;
    ++warnings_;
    events_.Put(EventKind::Warning);
    events_.PutText(kind), events_.PutText(text);
    events_.Put(std::uint8_t(mark ? 1 : 0));
    if (!mark)
        return;
    events_.Put(mark->entity), events_.Put(mark->primitive);
    events_.PutAll(mark->line);
}

void RunEvents::Replay(std::span<const std::byte> events, Log &log) {
    UnitReader reader(events);
    while (reader.Fits() && !reader.IsComplete()) {
        EventKind kind{};
        std::string name;
        reader.Get(kind);
        long long value = 0;
        if (kind == EventKind::Count)
            reader.Get(value);
        reader.GetText(name);
        if (kind == EventKind::Section)
            log.VerboseSection(name);
        else if (kind == EventKind::Count)
            log.VerboseCount(value, name);
        else
            ReplayWarning(reader, name, log);
    }
}

} // namespace q3
