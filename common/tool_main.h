// GPL-2.0-or-later. What the main functions of the programs in tools/ share.
#pragma once

#include "common/log.h"

#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Sink of a Log that writes warnings and errors to stderr and drops other lines.
inline void PrintWarnings(LogLevel level, std::string_view text) {
    if (level != LogLevel::Normal)
        std::fwrite(text.data(), 1, text.size(), stderr);
}

/// Exit status of run(words), which gets the words after that of the program. An exception is printed to stderr after
/// the name of the program; the exit status is 1 then.
inline int RunTool(const char *name, int count, char **words, int (*run)(const std::vector<std::string> &)) {
    try {
        return run({words + 1, words + count});
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s: %s\n", name, error.what());
        return 1;
    }
}

} // namespace q3
