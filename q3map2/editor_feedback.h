// GPL-2.0-or-later. Sends the log of a compile to an editor (-connect).
#pragma once

#include "common/log.h"

#include <string>
#include <vector>

namespace q3 {

/// Sends everything that is logged to an editor as XML: one TCP connection, messages of a little-endian length and at
/// most 1014 bytes; the root element q3map_feedback is never closed.
class EditorFeedback {
  public:
    /// Connects to "a.b.c.d:port" and follows `log` until it ends. No address or no editor there: nothing happens.
    static void Attach(const std::string &address, Log &log);
};

} // namespace q3
