// GPL-2.0-or-later. The log of a compile as XML, sent to an editor (-connect).
#pragma once

#include "common/log.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Largest payload of a network message, in bytes without the length before it. Editors accept up to 1020.
inline constexpr std::size_t kMaxPayload = 1014;

/// The root element; it is never closed.
inline constexpr std::string_view kFeedbackRoot = "<?xml version=\"1.0\"?><q3map_feedback version=\"1\">";

/// The text with markup escaped; invalid UTF-8 and control characters, which XML cannot hold, are replaced.
std::string XmlText(std::string_view text);

/// A `message` element, divided into payloads of network messages: only inside its text, between characters.
std::vector<std::string> MessagePayloads(LogLevel level, std::string_view text);

/// A `message` with a polyline, or a `select` of a brush. Editors parse the text of `point`, `brush` and `select` from
/// a single network message, so these are never divided; the text of a `select` is cut to fit.
std::vector<std::string> MarkPayloads(LogLevel level, std::string_view text, const LogMark &mark);

/// Sends everything that is logged to an editor as XML over one TCP connection. Each message is a payload of at most
/// kMaxPayload bytes after its length, 4 bytes little-endian.
class EditorFeedback {
  public:
    /// Connects to "a.b.c.d:port" in the background and sends what is logged until `log` ends. The run waits for the
    /// editor only at its end: for five seconds at most, and for one if the editor takes nothing. Without an
    /// address or an editor nothing happens; an address that cannot be parsed is a warning.
    static void Attach(const std::string &address, Log &log);
};

} // namespace q3
