// GPL-2.0-or-later. A log that prints nothing and keeps what it is told.
#pragma once

#include "common/log.h"

#include <string>
#include <string_view>

namespace q3::test {

/// Neither copied nor moved, since the log refers to the text.
struct KeptLog {
    std::string text;
    Log log{[this](LogLevel, std::string_view line) { text += line; }};
};

} // namespace q3::test
