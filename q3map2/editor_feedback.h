// GPL-2.0-or-later. Sends the log of a compile to an editor (-connect).
#pragma once

#include "common/log.h"

#include <string>

namespace q3 {

/// Sends everything that is logged to an editor as XML over one TCP connection: messages of a little-endian length of
/// four bytes and at most kMaxPayload bytes.
class EditorFeedback {
  public:
    /// Connects to "a.b.c.d:port" in the background and follows `log` until it ends. The run never waits for the
    /// editor, but for a second at its end if the editor takes nothing (at most five in all). Without an address or an
    /// editor nothing happens; an address that cannot be read is a warning.
    static void Attach(const std::string &address, Log &log);
};

} // namespace q3
