// GPL-2.0-or-later. Surface and content bits of a BSP shader as named flags.
#include "q3map2/convert/json/convert_json_flags.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <ranges>

namespace q3 {

std::uint32_t ParmBits(const SurfaceParm &parm, FlagKind kind) {
    return kind == FlagKind::Surface ? parm.surfaceSet : parm.contentSet;
}

std::vector<std::pair<std::string_view, std::uint32_t>> SplitFlags(std::uint32_t value, const Game &game,
                                                                   FlagKind kind) {
    std::vector<std::pair<std::string_view, std::uint32_t>> parts;
    for (auto at = game.surfaceParms.rbegin(); at != game.surfaceParms.rend(); ++at) {
        const SurfaceParm &parm = *at;
        const std::uint32_t bits = ParmBits(parm, kind);
        if (bits == 0 || (value & bits) != bits)
            continue;
        parts.emplace_back(parm.name, bits);
        value &= ~bits;
    }
    for (; value != 0; value &= value - 1)
        parts.emplace_back("?", std::uint32_t(1) << std::countr_zero(value));
    std::ranges::sort(parts, {}, [](const auto &part) { return part.second; });
    return parts;
}

bool ParseFlagNumber(std::string_view text, std::uint32_t &value) {
    int base = 10;
    if (text.starts_with("0x") || text.starts_with("0X")) {
        base = 16;
        text.remove_prefix(2);
    } else if (text.starts_with('0')) {
        base = 8;
    }
    const char *const end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value, base);
    return result.ec == std::errc() && result.ptr == end;
}

} // namespace q3
