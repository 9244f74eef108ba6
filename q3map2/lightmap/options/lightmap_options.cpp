// GPL-2.0-or-later. Settings of lightmaps, vertex light and bounces.
#include "q3map2/lightmap/options/lightmap_options.h"

#include "q3map2/lightmap/options/lightmap_settings.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

namespace {

constexpr int kMinPageSide = 2;

/// The page size given by an option; none, with a warning, unless both sides are powers of two in range.
std::optional<std::array<int, 2>> PageSize(const std::vector<int> &given, std::string_view name, Log &log) {
    if (given.empty())
        return std::nullopt;
    const int w = given.front(), h = given.back();
    const auto fits = [](int side) {
        return side >= kMinPageSide && side <= kMaxPageSide && std::has_single_bit(unsigned(side));
    };
    if (fits(w) && fits(h))
        return std::array{w, h};
    log.Warn("page size", "{} {} {}: expected powers of two from {} to {}; the option is ignored", name, w, h,
             kMinPageSide, kMaxPageSide);
    return std::nullopt;
}

void ApplyPageSizes(LightmapOptions &o, Log &log) {
    bool external = false;
    if (const auto size = PageSize(o.lightmapSize, "-lightmapsize", log)) {
        o.pageSize = *size;
        external = o.pageSize != o.gamePageSize;
    }
    if (const auto size = PageSize(o.hackSize, "-extlmhacksize", log); size && !external)
        o.pageSize = *size;
    o.external |= external || !o.externalFolder.empty();
    if (o.searchPower) {
        const double ratio = o.gamePageSize[0] * std::exp2(*o.searchPower) / o.pageSize[0];
        o.searchBlock = int(std::clamp(ratio * ratio, 1.0, double(1 << 20)));
    }
    if (o.noSearch)
        o.searchBlock = 1;
}

} // namespace

LightmapOptions ParseLightmapOptions(Arguments &arguments, const LightOptions &light, const Game &game, Log &log) {
    LightmapOptions o;
    o.fast = light.fast;
    o.faster = light.faster;
    o.cheap = light.cheap;
    o.sRgbTexture = light.sRgbTexture;
    o.halfLambert = game.halfLambert;
    o.deluxe = game.deluxe;
    o.deluxeTangent = game.deluxeTangent;
    o.pageSize = o.gamePageSize = {game.lightmapSize, game.lightmapSize};
    TakeSettings(LightmapSettings(), o, arguments, log);
    ApplyPageSizes(o, log);
    if (o.show != DebugView::Light || o.debugNormals)
        o.rnm = o.rnmAll = o.lightmass = false;
    const bool forEngines = o.hdrFiles == HdrFiles::Rend2 || o.hdrFiles == HdrFiles::Ioquake3;
    if (forEngines && !o.ldr) {
        log.Warn("HDR files", "engines load HDR files beside 8-bit lightmaps only, which are stored too");
        o.ldr = true;
    }
    o.shade |= o.shadeAngle > 0;
    o.deluxe |= o.debugDeluxe;
    if (o.deluxe && !o.ldr) {
        log.Warn("light directions", "pages of light directions belong to 8-bit lightmaps, which -hdr leaves out");
        o.deluxe = false;
    }
    o.dirty |= o.show == DebugView::Dirt;
    return o;
}

} // namespace q3
