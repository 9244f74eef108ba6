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

/// Name of a parm in a script: q3map_material has its own.
std::string NameInScript(std::string_view parm) {
    constexpr std::string_view kMaterial = "*mat_";
    return parm.starts_with(kMaterial) ? fmt::format("material {}", parm.substr(kMaterial.size()))
                                       : fmt::format("surfaceparm {}", parm);
}

/// Flags of one kind, surface or content, from the bits of one game to those of another.
class FlagTranslator {
  public:
    FlagTranslator(const Game &from, const Game &to, FlagKind kind) : from_(from), to_(to), kind_(kind) {
        for (const SurfaceParm &parm : to.surfaceParms)
            targetBits_ |= ParmBits(parm, kind);
        if (const SurfaceParm *parm = from.FindParm("default"))
            fromDefault_ = ParmBits(*parm, kind);
        if (const SurfaceParm *parm = to.FindParm("default"))
            toDefault_ = ParmBits(*parm, kind);
    }

    std::uint32_t Translate(std::uint32_t flags) {
        std::uint32_t result = 0;
        std::uint32_t byDefault = toDefault_ & ~fromDefault_; // what shaders of the target have unless a parm clears it
        for (const auto &[name, bits] : SplitFlags(flags, from_, kind_))
            if (const SurfaceParm *parm = ParmInTarget(bits, flags)) {
                result |= ParmBits(*parm, kind_);
                byDefault &= kind_ == FlagKind::Content ? ~parm->contentClear : ~parm->surfaceClear;
            } else if ((bits & fromDefault_) != 0 && name == "?") {
                result |= bits & toDefault_; // what another parm left of the default
            } else if ((bits & targetBits_) == 0) {
                result |= bits;
            } else {
                lost_.insert(name == "?" ? fmt::format("surfaceparm 0x{:x}", bits) : NameInScript(name));
            }
        return result | byDefault;
    }
    const std::set<std::string> &Lost() const { return lost_; }

  private:
    /// The target game's surfaceparm of the name that is exactly `bits` in the source game; null if there is none, or
    /// if it sets other flags only. Of several names the one counts that clears most of what `flags` lack, then the
    /// last, as in SplitFlags: a game's own names follow those that all games share.
    const SurfaceParm *ParmInTarget(std::uint32_t bits, std::uint32_t flags) const {
        const SurfaceParm *found = nullptr;
        int most = -1;
        for (auto parm = from_.surfaceParms.rbegin(); parm != from_.surfaceParms.rend(); ++parm) {
            if (ParmBits(*parm, kind_) != bits)
                continue;
            const SurfaceParm *same = to_.FindParm(parm->name);
            const bool leavesNoTrace = same && (same->surfaceSet | same->contentSet) == 0;
            if (!same || (ParmBits(*same, kind_) == 0 && !leavesNoTrace))
                continue;
            const std::uint32_t clears = kind_ == FlagKind::Content ? parm->contentClear : parm->surfaceClear;
            if (const int cleared = (flags & clears) == 0 ? std::popcount(clears) : 0; cleared > most) {
                most = cleared;
                found = same;
            }
        }
        return found;
    }

    const Game &from_, &to_;
    FlagKind kind_;
    std::uint32_t targetBits_ = 0;                  ///< bits that have a meaning in the target game
    std::uint32_t fromDefault_ = 0, toDefault_ = 0; ///< of shaders without surfaceparms
    std::set<std::string> lost_;                    ///< names of dropped flags, or their bits in hexadecimal
};

/// Surfaces are not erased, since leafs, models and brush sides have their numbers.
void EmptyFoliage(Bsp &bsp, const Game &to, Log &log) {
    std::size_t count = 0;
    for (bspDrawSurface_t &surface : bsp.drawSurfaces)
        if (surface.surfaceType == MST_FOLIAGE) {
            surface.surfaceType = MST_TRIANGLE_SOUP;
            surface.numVerts = surface.numIndexes = surface.patchWidth = surface.patchHeight = 0;
            ++count;
        }
    if (count > 0)
        log.Warn("foliage", "{} surfaces of foliage are left out, since {} loads no map with such surfaces", count,
                 to.title);
}

} // namespace

void ConvertToGame(Bsp &bsp, const Game &from, const Game &to, Log &log) {
    FlagTranslator surface(from, to, FlagKind::Surface), content(from, to, FlagKind::Content);
    for (bspShader_t &shader : bsp.shaders) {
        shader.surfaceFlags = surface.Translate(shader.surfaceFlags);
        shader.contentFlags = content.Translate(shader.contentFlags);
    }
    for (const FlagTranslator *translator : {&surface, &content})
        for (const std::string &name : translator->Lost())
            log.Warn("surfaceparm of another game", "{} has no {}, which the map uses: it is dropped", to.name, name);
    if (to.refusesFoliage)
        EmptyFoliage(bsp, to, log);
    if (from.bspIdent == to.bspIdent && from.lightmapSize != to.lightmapSize && !bsp.lightmaps.empty())
        log.Warn("lightmaps of another size", "{} has lightmap pages of {} texels, {} of {}: light the map again",
                 to.name, to.lightmapSize, from.name, from.lightmapSize);
}

} // namespace q3
