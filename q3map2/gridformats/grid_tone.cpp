// GPL-2.0-or-later. The tone of the lightmaps, for grids that hold bytes.
#include "q3map2/gridformats/grid_tone.h"

#include "common/error.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/written_keys.h"
#include "q3map2/shader/shader_color.h"

#include <cmath>
#include <string>

namespace q3 {

namespace {

constexpr float kFull = 255;
/// Unlimited scales light by this before the limit at 255, and undoes it after: limits light at 2^20 times 255. A power
/// of two, so that no rounding is added.
constexpr float kHeadroom = 1.0f / (1 << 20);

} // namespace

GridTone::GridTone(std::string_view entities, Log &log) {
    const std::string text(StoredWorld(std::string(entities)).Value(kToneKey));
    if (shgrid_parse_tone(text.c_str(), &tone_) != SHGRID_OK)
        log.Warn("tone", "worldspawn: {} \"{}\" is not pairs of a word and a number in range: grids get no tone",
                 kToneKey, text);
}

GridTone::GridTone(const char *tone) {
    if (shgrid_parse_tone(tone, &tone_) != SHGRID_OK)
        throw Error("tone \"{}\": expected pairs of a word and a number in range", tone);
}

bool GridTone::IsPlain() const {
    return tone_.contrast == 1 && tone_.gamma == 1 && tone_.exposure == 0 && tone_.saturation == 1 &&
           tone_.scale == 1 && tone_.maxlight == kFull && tone_.srgb == 0;
}

Vec3d GridTone::Limited(const Vec3d &light) const {
    float rgb[3] = {float(light.x), float(light.y), float(light.z)};
    shgrid_apply_tone(&tone_, rgb);
    return Vec3d{double(rgb[0]), double(rgb[1]), double(rgb[2])} * double(kFull);
}

Vec3d GridTone::Unlimited(const Vec3d &light) const {
    if (tone_.maxlight < kFull)
        return Limited(light);
    shgrid_tone tone = tone_;
    tone.scale *= kHeadroom;
    tone.srgb = 0;
    float rgb[3] = {float(light.x), float(light.y), float(light.z)};
    shgrid_apply_tone(&tone, rgb);
    Vec3d color;
    for (std::size_t i = 0; i < 3; ++i) {
        const float linear = rgb[i] / kHeadroom;
        color[i] = double(kFull * (tone_.srgb ? SrgbFromLinear(linear) : linear));
    }
    return color;
}

std::array<std::uint8_t, 3> GridTone::Bytes(const Vec3d &light) const {
    const Vec3d color = Limited(light);
    std::array<std::uint8_t, 3> bytes;
    for (std::size_t i = 0; i < 3; ++i)
        bytes[i] = std::uint8_t(std::lround(color[i]));
    return bytes;
}

} // namespace q3
