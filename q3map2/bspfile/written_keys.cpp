// GPL-2.0-or-later. Keys of worldspawn that tell readers of a .bsp how it was lit.
#include "q3map2/bspfile/written_keys.h"

#include "common/text/text.h"

#include <fmt/format.h>

#include <optional>

namespace q3 {

std::string PatternKey(int style) {
    return fmt::format("_style{}pattern", style);
}

std::string SwitchKey(int style) {
    return fmt::format("_switch{}", style);
}

std::string DarkKey(int style) {
    return fmt::format("_switch{}dark", style);
}

int StyleOfKey(std::string_view key, std::string_view beginning, std::string_view end) {
    constexpr int kLastStyle = 254;
    if (key.size() <= beginning.size() + end.size() || !StartsWithNoCase(key, beginning) || !EndsWithNoCase(key, end))
        return -1;
    key = key.substr(beginning.size(), key.size() - beginning.size() - end.size());
    const std::optional<int> number = WholeInteger(key);
    return number && *number > 0 && *number <= kLastStyle ? *number : -1;
}

bool IsStyleKey(std::string_view key) {
    return StyleOfKey(key, "_style", "pattern") > 0 || StyleOfKey(key, "_switch", "") > 0 ||
           StyleOfKey(key, "_switch", "dark") > 0;
}

} // namespace q3
