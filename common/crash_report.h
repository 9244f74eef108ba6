// GPL-2.0-or-later. What the program prints if it crashes.
#pragma once

#include <string_view>

namespace q3 {

/// From now on a fatal signal (on Windows an unhandled exception) prints `version`, the facts below and where to report
/// the crash to standard error. The signal then ends the process as it would have without this. `version` ends in a
/// newline.
void InstallCrashReport(std::string_view version);

/// Facts that a crash prints: the command line, the file that the stage works on, and the last passes. Long ones are
/// cut: they are kept in arrays of fixed size, since a signal handler may interrupt an allocation.
void SetCrashCommand(std::string_view command);
void SetCrashFile(std::string_view file);
/// Not for concurrent calls.
void AddCrashPass(std::string_view pass);

} // namespace q3
