// GPL-2.0-or-later. Keys that all surfaces of an entity share.
#include "q3map2/map/map_settings.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr float kMaxColor = 1e6f; // far over any light, and no overflow in products

Vec3f AmbientOf(const Entity &pairs) {
    const float ambient = std::clamp(float(pairs.Number({"_ambient", "ambient"})), -kMaxColor, kMaxColor);
    Vec3f color = pairs.Vector({"_color"}).value_or(Vec3f{1, 1, 1});
    for (std::size_t i = 0; i < 3; ++i)
        color[i] = std::clamp(color[i], -kMaxColor, kMaxColor);
    return color * ambient;
}

int WholeNumber(const Entity &pairs, std::initializer_list<std::string_view> keys, int fallback) {
    const std::string_view text = pairs.Value(keys);
    return text.empty() ? fallback : IntegerFromText(text);
}

} // namespace

SurfaceSettings SettingsOf(const MapEntity &entity, const Map &map, const BspContext &context) {
    const Entity &pairs = entity.pairs;
    const bool isWorld = entity.number == 0;
    SurfaceSettings settings;
    settings.entity = entity.number;
    settings.castShadows =
        WholeNumber(pairs, {"_castShadows", "_cs"}, isWorld || EqualNoCase(pairs.ClassName(), "func_group") ? 1 : 0);
    settings.receiveShadows = WholeNumber(pairs, {"_receiveShadows", "_rs"}, 1);
    settings.sampleSize = std::max(0, WholeNumber(pairs, {"_lightmapsamplesize", "_samplesize", "_ss"}, 0));
    settings.lightmapScale =
        std::clamp(float(pairs.Number({"lightmapscale", "_lightmapscale", "_ls"})), 0.0f, kMaxColor);
    settings.shadeAngle =
        std::clamp(float(pairs.Number({"_shadeangle", "_smoothnormals", "_sn", "_sa", "_smooth"})), 0.0f, 360.0f);
    settings.ambient = AmbientOf(pairs);
    if (settings.ambient == Vec3f{} && !isWorld && !map.entities.empty())
        settings.ambient = AmbientOf(map.entities.front().pairs);
    const std::string_view cel = pairs.Value("_celshader");
    settings.celShader = cel.empty() ? map.defaultCelShader : &context.shaders.Get(fmt::format("textures/{}", cel));
    return settings;
}

} // namespace q3
