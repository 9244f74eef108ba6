// GPL-2.0-or-later. Sends the log of a compile to an editor (-connect).
#pragma once

#include "common/log.h"

#include <string>

namespace q3 {

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
