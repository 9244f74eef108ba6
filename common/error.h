// GPL-2.0-or-later. The one exception type: a failure that the user can act on.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace q3 {

/// Bad input, bad arguments or a failing file system. The text is one line that names the file, the line or entry, and
/// what was expected. Only RunProgram (q3map2/cli/program.h), or RunTool in the programs of tools/, turns it into an
/// exit status; libraries neither print nor exit.
class Error : public std::runtime_error {
  public:
    explicit Error(const std::string &text) : std::runtime_error(text) {}
    template <typename First, typename... Rest>
    Error(fmt::format_string<First, Rest...> format, First &&first, Rest &&...rest)
        : std::runtime_error(fmt::format(format, std::forward<First>(first), std::forward<Rest>(rest)...)) {}
};

} // namespace q3
