// GPL-2.0-or-later. Differences between operating systems that tests depend on. A test of something that Windows lacks
// is skipped there with a reason, or left out where it would not compile.
#pragma once

namespace q3::test {

#ifdef _WIN32
inline constexpr bool kIsWindows = true;
#else
inline constexpr bool kIsWindows = false;
#endif

/// Reasons for skipping a test on Windows.
inline constexpr const char *kNoSizeLimit = "Windows does not limit the size of files";
inline constexpr const char *kNoTerminals = "Windows has no terminal that another process can read";
inline constexpr const char *kNoCase = "names of files that differ only in case are the same file on Windows";

} // namespace q3::test
