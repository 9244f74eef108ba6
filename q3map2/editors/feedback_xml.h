// GPL-2.0-or-later. Log messages as the XML that editors read (-connect).
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

} // namespace q3
