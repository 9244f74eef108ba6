// GPL-2.0-or-later. What operating systems differ in and tests ask for. A test of something that Windows has not is
// skipped there and says what it is.
#pragma once

namespace q3::test {

#ifdef _WIN32
inline constexpr bool kIsWindows = true;
#else
inline constexpr bool kIsWindows = false;
#endif

} // namespace q3::test
