// GPL-2.0-or-later. Converts a compiled map of one game for another: surface and content flags.
#include "q3map2/convert/game/game_convert.h"

#include "q3map2/convert/json/convert_json_flags.h"

#include <algorithm>
#include <set>
#include <string>

namespace q3 {

namespace {

/// Flags of one kind, surface or content, from the bits of one game to those of another.
class FlagTranslator {
  public:
    FlagTranslator(const Game &from, const Game &to, FlagKind kind) : from_(from), to_(to), kind_(kind) {
        for (const SurfaceParm &parm : to.surfaceParms)
            used_ |= ParmBits(parm, kind);
    }

    std::uint32_t Translate(std::uint32_t flags) {
        std::uint32_t result = 0;
        for (const auto &[name, bits] : SplitFlags(flags, from_, kind_))
            if (const std::uint32_t translated = BitsInTarget(bits))
                result |= translated;
            else if ((bits & used_) == 0)
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
    std::uint32_t used_ = 0;     ///< bits that have a meaning in the target game
    std::set<std::string> lost_; ///< names of dropped flags, or their bits in hexadecimal
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
