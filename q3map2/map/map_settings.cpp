// GPL-2.0-or-later. Settings of the surfaces of an entity, from its keys.
#include "q3map2/map/map_settings.h"

#include "q3map2/bspfile/surface_keys.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr float kMaxColor = 1e6f; // far above any light, and products do not overflow

Vec3f AmbientOf(const Entity &pairs) {
    const float ambient = std::clamp(float(keys::kAmbient.Number(pairs)), -kMaxColor, kMaxColor);
    Vec3f color = keys::kWorldColor.Vector(pairs).value_or(Vec3f{1, 1, 1});
    for (std::size_t i = 0; i < 3; ++i)
        color[i] = std::clamp(color[i], -kMaxColor, kMaxColor);
    return color * ambient;
}

} // namespace

SurfaceSettings SettingsOf(const MapEntity &entity, const Map &map, const BspContext &context) {
    const Entity &pairs = entity.pairs;
    const bool isWorld = entity.number == 0;
    SurfaceSettings settings;
    settings.entity = entity.number;
    const bool casts = isWorld || EqualNoCase(pairs.ClassName(), "func_group");
    settings.castShadows = keys::kCastShadows.Integer(pairs, casts ? 1 : 0);
    settings.receiveShadows = keys::kReceiveShadows.Integer(pairs);
    settings.sampleSize = keys::kSampleSize.Integer(pairs);
    settings.lightmapScale = float(keys::kLightmapScale.Number(pairs, 0));
    settings.shadeAngle = float(keys::kShadeAngle.Number(pairs));
    settings.ambient = AmbientOf(pairs);
    if (settings.ambient == Vec3f{} && !isWorld && !map.entities.empty())
        settings.ambient = AmbientOf(map.entities.front().pairs);
    const std::string_view cel = keys::kCelShader.Text(pairs);
    settings.celShader = cel.empty() ? map.defaultCelShader : &context.shaders.Get(fmt::format("textures/{}", cel));
    return settings;
}

} // namespace q3
