// GPL-2.0-or-later. Surface and content flags by name: of one game for another, and in JSON.
#include "q3map2/convert/game/game_flags.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <ranges>
#include <set>
#include <string>

namespace q3 {

// ---- Surface and content bits of a BSP shader as named flags ----

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

// ---- A compiled map of one game for another ----

namespace {

/// Flags of one kind, surface or content, from the bits of one game to those of another.
class FlagTranslator {
  public:
    FlagTranslator(const Game &from, const Game &to, FlagKind kind) : from_(from), to_(to), kind_(kind) {
        for (const SurfaceParm &parm : to.surfaceParms)
            targetBits_ |= ParmBits(parm, kind);
    }

    std::uint32_t Translate(std::uint32_t flags) {
        std::uint32_t result = 0;
        for (const auto &[name, bits] : SplitFlags(flags, from_, kind_))
            if (const std::uint32_t translated = BitsInTarget(bits))
                result |= translated;
            else if ((bits & targetBits_) == 0)
                result |= bits;
            else
                lost_.insert(name == "?" ? fmt::format("0x{:x}", bits) : std::string(name));
        return result;
    }
    const std::set<std::string> &Lost() const { return lost_; }

  private:
    /// The target game's bits for the surfaceparm that is exactly `bits` in the source game; 0 if there is none. The
    /// last of several such names counts, as in SplitFlags: a game's own names follow those that all games share.
    std::uint32_t BitsInTarget(std::uint32_t bits) const {
        for (auto parm = from_.surfaceParms.rbegin(); parm != from_.surfaceParms.rend(); ++parm)
            if (ParmBits(*parm, kind_) == bits)
                if (const SurfaceParm *same = to_.FindParm(parm->name))
                    return ParmBits(*same, kind_);
        return 0;
    }

    const Game &from_, &to_;
    FlagKind kind_;
    std::uint32_t targetBits_ = 0; ///< bits that have a meaning in the target game
    std::set<std::string> lost_;   ///< names of dropped flags, or their bits in hexadecimal
};

} // namespace

void ConvertToGame(Bsp &bsp, const Game &from, const Game &to, Log &log) {
    FlagTranslator surface(from, to, FlagKind::Surface), content(from, to, FlagKind::Content);
    for (bspShader_t &shader : bsp.shaders) {
        shader.surfaceFlags = surface.Translate(shader.surfaceFlags);
        shader.contentFlags = content.Translate(shader.contentFlags);
    }
    for (const FlagTranslator *translator : {&surface, &content})
        for (const std::string &name : translator->Lost())
            log.Warn("surfaceparm of another game", "{} has no surfaceparm {}, which the map uses: it is dropped",
                     to.name, name);
    if (from.lightmapSize != to.lightmapSize && !bsp.lightmaps.empty())
        log.Warn("lightmaps of another size", "{} has lightmap pages of {} texels, {} of {}: light the map again",
                 to.name, to.lightmapSize, from.name, from.lightmapSize);
}

} // namespace q3
