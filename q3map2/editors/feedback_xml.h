// GPL-2.0-or-later. The text of the stream that editors read (-connect).
#pragma once

#include "common/log.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Bytes of a network message after its length, at most. Editors take up to 1020.
inline constexpr std::size_t kMaxPayload = 1014;

/// The root element; it is never closed.
inline constexpr std::string_view kFeedbackRoot = "<?xml version=\"1.0\"?><q3map_feedback version=\"1\">";

/// Text as XML has it: markup escaped; bytes that are no UTF-8 and control characters, which XML cannot hold, replaced.
std::string XmlText(std::string_view text);

/// A `message` element as payloads of network messages. A payload ends at the end of the element or inside its text,
/// never inside a character.
std::vector<std::string> MessagePayloads(LogLevel level, std::string_view text);

/// A `message` with a polyline, or a `select` of a brush. Editors read the text of a point, a brush and a `select` as
/// it arrives: none is divided. Text of a `select` that would not fit is cut.
std::vector<std::string> MarkPayloads(LogLevel level, std::string_view text, const LogMark &mark);

} // namespace q3
