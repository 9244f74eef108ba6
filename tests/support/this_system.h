// GPL-2.0-or-later. What operating systems differ in and tests ask for. A test of something that Windows has not is
// skipped there and says what it is.
#pragma once

namespace q3::test {

#ifdef _WIN32
inline constexpr bool kIsWindows = true;
#else
inline constexpr bool kIsWindows = false;
#endif

/// Why a test is skipped.
inline constexpr const char *kNoCase = "names of files that differ only in case are the same file on Windows";

} // namespace q3::test
