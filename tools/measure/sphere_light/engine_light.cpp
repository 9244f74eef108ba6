// GPL-2.0-or-later. The bytes that ioquake3 shows of the light grids of a map on a white matte surface.
#include "tools/measure/sphere_light/engine_light.h"

#include "common/error.h"
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/light_keys.h"
#include "tests/support/grid_readers/legacy_reader.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace q3 {

namespace {

constexpr std::size_t kLightStyles = 64;
constexpr float kAddedAmbient = 32; ///< that the engine adds to ambient light, bytes

/// Limited to 255, keeping the hue.
Vec3f HueLimited(const Vec3f &color) {
    const float most = MaxComponent(color);
    return most > 255 ? color * (255 / most) : color;
}

/// Limited to 255 by channel.
Vec3f Limited(const Vec3f &color) {
    return Min(color, Vec3f{255, 255, 255});
}

/// A color of a lump times 2^shift as the renderers load it: limited to 255, keeping the hue, in whole bytes.
std::array<std::uint8_t, 3> Shifted(const std::array<std::uint8_t, 3> &color, int shift) {
    std::array<int, 3> wide{};
    for (std::size_t i = 0; i < 3; ++i)
        wide[i] = color[i] << shift;
    const int most = std::max(255, std::ranges::max(wide));
    std::array<std::uint8_t, 3> bytes{};
    for (std::size_t i = 0; i < 3; ++i)
        bytes[i] = std::uint8_t(wide[i] * 255 / most);
    return bytes;
}

/// See LegacyGridLight.
Vec3f LegacyColor(const LegacyLight &light, Renderer renderer, const Vec3f &normal) {
    LegacyLight limited = light;
    if (renderer == Renderer::OpenGL2) {
        limited.ambient = HueLimited(light.ambient);
        limited.directed = HueLimited(light.directed);
        return Limited(limited.On(normal));
    }
    limited.ambient = Limited(light.ambient);
    const Vec3f color = Limited(limited.On(normal));
    return {std::floor(color.x), std::floor(color.y), std::floor(color.z)};
}

} // namespace

EngineLight SHGridLight(const std::vector<std::byte> &file, const Bsp &bsp, int shift, std::optional<int> darkStyle) {
    shgrid_grid grid;
    if (const auto result = shgrid_load(file.data(), file.size(), &grid); result != SHGRID_OK)
        throw Error("SH grid: {}", shgrid_message(result));
    const Entity world = StoredWorld(bsp.entities);
    shgrid_tone tone;
    const std::string words(world.Value(kToneKey));
    if (shgrid_parse_tone(words.c_str(), &tone) != SHGRID_OK)
        throw Error("{}: {}", kToneKey, shgrid_message(SHGRID_BAD_TONE));
    const bool isRadiance = world.Value(kGridSHKey) == kRadiance;
    std::array<float, kLightStyles> styles;
    styles.fill(1);
    if (darkStyle)
        styles.at(std::size_t(*darkStyle)) = 0;
    return [grid, tone, isRadiance, shift, styles](const Vec3f &position) -> NormalColor {
        const float at[3] = {position.x, position.y, position.z};
        shgrid_lighting lighting;
        shgrid_lights(&grid, at, styles.data(),
                      &lighting); // the engine limits their number: that counts as a difference
        if (isRadiance)
            shgrid_convolve(&lighting.rest);
        return [lighting, tone, shift](const Vec3f &normal) {
            const float n[3] = {normal.x, normal.y, normal.z};
            float rgb[3];
            shgrid_shade(&lighting, n, rgb);
            shgrid_apply_tone(&tone, rgb);
            return HueLimited(Vec3f{rgb[0], rgb[1], rgb[2]} * std::ldexp(255.0f, shift));
        };
    };
}

EngineLight LegacyGridLight(const Bsp &bsp, Renderer renderer, int shift) {
    const auto cell = keys::kGridSize.Vector(StoredWorld(bsp.entities));
    const LegacyPlaces places(Vec3f(bsp.models[0].mins), Vec3f(bsp.models[0].maxs), cell.value_or(Vec3f{64, 64, 128}));
    std::vector<bspGridPoint_t> points = bsp.gridPoints;
    for (bspGridPoint_t &point : points) {
        point.ambient[0] = Shifted(point.ambient[0], shift);
        point.directed[0] = Shifted(point.directed[0], shift);
    }
    LegacyEngine engine = kIoquake3Engine;
    engine.ambientAdded = kAddedAmbient;
    engine.keepsDirected = renderer == Renderer::OpenGL2;
    auto reader = LegacyGridReader::Load(IbspGridLump(points), places, engine);
    if (!reader)
        throw Error("the legacy grid has another number of points than the map's bounds need");
    return [reader = std::move(*reader), renderer](const Vec3f &position) -> NormalColor {
        return [light = reader.At(position), renderer](const Vec3f &normal) {
            return LegacyColor(light, renderer, normal);
        };
    };
}

} // namespace q3
