// GPL-2.0-or-later. Lights that mappers place as entities, and the light keys of the world.
#include "common/error.h"
#include "libs/math/low_discrepancy.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/sources/light_suns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Larger intensities overflow float once squared distances divide them. Far over any that a map can use.
constexpr float kMaxIntensity = 1e9f;
/// Limit of world keys, for the same reason.
constexpr float kMaxWorldFactor = 1e6f;
constexpr int kMaxSamples = 4096;
constexpr double kMaxFilterRadius = 65536; ///< game units
/// Lights farther out than this are not in any map. Game units.
constexpr float kMaxCoordinate = 262144;
constexpr std::uint64_t kSeedJitter = 0x4C69676874ull;

Vec3f DecodeColor(const Vec3f &c, bool sRgb) {
    return sRgb ? Vec3f{LinearFromSrgb(c.x), LinearFromSrgb(c.y), LinearFromSrgb(c.z)} : c;
}

/// How messages name a light: editors find it by its place.
std::string Label(const Entity &entity) {
    return fmt::format("{} at \"{}\"", entity.ClassName(), entity.Value("origin"));
}

int SpawnFlags(const Entity &entity) {
    return int(std::clamp(entity.Number({"spawnflags"}), -1e9, 1e9));
}

float Intensity(const Entity &entity, Log &log) {
    double intensity = entity.Number({"_light", "light"}, 300);
    if (intensity == 0)
        intensity = 300;
    if (const double scale = entity.Number({"scale"}); scale != 0)
        intensity *= scale;
    if (!(std::abs(intensity) <= kMaxIntensity)) {
        log.Warn("light intensity", "{}: intensity {:g} is limited to {:g}", Label(entity), intensity, kMaxIntensity);
        intensity = std::clamp(intensity, double(-kMaxIntensity), double(kMaxIntensity));
    }
    return float(intensity);
}

int Style(const Entity &entity) {
    const double style = entity.Number({"_style", "style"});
    if (!(style >= 0 && style <= 254))
        throw Error("{}: style {} is not in 0..254", Label(entity), entity.Value({"_style", "style"}));
    return int(style);
}

Light LightFromKeys(const Entity &entity, const LightOptions &options, Log &log) {
    Light light;
    const int flags = SpawnFlags(entity);
    light.linear = ((flags & 1) != 0) != options.wolfLighting;
    light.angle = ((flags & 3) == 0) != options.wolfLighting;
    light.grid = (flags & 16) == 0;
    if (EqualNoCase(entity.ClassName(), "lightJunior"))
        light.grid = true, light.surfaces = false;
    light.alwaysFast = true;
    light.origin = entity.Vector({"origin"}).value_or(Vec3f{});
    light.color = DecodeColor(entity.Vector({"_color"}).value_or(Vec3f{1, 1, 1}), options.shader.sRgbColor);
    if ((flags & 32) == 0)
        light.color = NormalizeColor(light.color);
    light.fade = float(entity.Number({"fade"}, 1));
    if (light.fade == 0)
        light.fade = 1;
    light.extraDist = float(std::max(0.0, entity.Number({"_extradist"}, options.extraDist)));
    light.angleScale = float(std::clamp(entity.Number({"_anglescale"}), -1e6, 1e6));
    light.angle = light.angle || light.angleScale != 0;
    light.filterRadius =
        float(std::clamp(entity.Number({"_filterradius", "_filteradius", "_filter"}), 0.0, kMaxFilterRadius));
    light.style = Style(entity);
    light.photons = Intensity(entity, log);
    if (!IsFinite(light.color) || MaxComponent(Max(light.color, -light.color)) > kMaxIntensity) {
        log.Warn("light colour", "{}: _color {} is out of range, white is used", Label(entity), entity.Value("_color"));
        light.color = {1, 1, 1};
    }
    return light;
}

const Entity *FindTarget(const std::vector<Entity> &entities, std::string_view target) {
    for (const Entity &entity : entities)
        if (entity.Value("targetname") == target)
            return &entity;
    return nullptr;
}

/// Turns a light into a spotlight aimed at `target`.
void Aim(Light &light, const Entity &entity, const Vec3f &target, const LightOptions &options) {
    light.type = LightType::Spot;
    light.linear = false;
    light.angle = true;
    light.fade = 1;
    light.normal = Normalize(target - light.origin);
    float distance = Length(target - light.origin);
    if (distance == 0)
        distance = 64;
    double radius = entity.Number({"radius"}, 64);
    if (radius == 0)
        radius = 64;
    light.radiusByDist = (float(std::clamp(radius, -1e6, 1e6)) + 16) / distance;
    light.photons *= options.spotScale;
}

void AddEntityLights(const Entity &entity, std::size_t number, const std::vector<Entity> &entities,
                     const LightOptions &options, std::vector<Light> &lights, Log &log) {
    Light light = LightFromKeys(entity, options, log);
    const int samples = int(std::clamp(entity.Number({"_samples"}, 1), 1.0, double(kMaxSamples)));
    const float deviance = float(std::clamp(entity.Number({"_deviance", "_deviation", "_jitter"}), 0.0, 1e6));
    if (MaxComponent(Max(light.origin, -light.origin)) > kMaxCoordinate) {
        log.Warn("light origin", "{} is outside any map, it is dropped", Label(entity));
        return;
    }
    light.photons /= float(samples);
    light.tolerance = options.tolerance / float(samples);

    const std::string_view target = entity.Value("target");
    const Entity *aimedAt = target.empty() ? nullptr : FindTarget(entities, target);
    if (!target.empty() && !aimedAt)
        log.Warn("light target", "{}: target \"{}\" does not exist, the light has no direction", Label(entity), target);
    const Vec3f targetOrigin = aimedAt ? aimedAt->Vector({"origin"}).value_or(Vec3f{}) : Vec3f{};

    if (aimedAt && entity.Number({"_sun"}) != 0) {
        SunDirective sun{.direction = Normalize(light.origin - targetOrigin),
                         .color = light.color,
                         .photons = light.photons,
                         .deviance = deviance * std::numbers::pi_v<float> / 180,
                         .samples = samples,
                         .style = light.style};
        if (sun.direction == Vec3f{})
            sun.direction = {0, 0, 1};
        for (Light &one : MakeSuns(sun, -1, options)) {
            one.grid = light.grid, one.surfaces = light.surfaces;
            lights.push_back(std::move(one));
        }
        return;
    }
    if (aimedAt)
        Aim(light, entity, targetOrigin, options);
    else
        light.photons *= options.pointScale;

    lights.push_back(light);
    for (int i = 1; i < samples; ++i) {
        Light copy = light;
        for (std::size_t axis = 0; axis < 3; ++axis)
            copy.origin[axis] +=
                float(2 * UnitFromHash(HashIndex(kSeedJitter + (number << 24) + std::uint64_t(i) * 4 + axis)) - 1) *
                deviance;
        lights.push_back(copy);
    }
}

} // namespace

WorldLight ReadWorldLight(const Entity &world, const LightOptions &options) {
    WorldLight result;
    Vec3f color = world.Vector({"_color"}).value_or(Vec3f{1, 1, 1});
    if (color == Vec3f{})
        color = {1, 1, 1};
    color = DecodeColor(color, options.shader.sRgbColor);
    color = Max(Min(color, Vec3f{kMaxWorldFactor, kMaxWorldFactor, kMaxWorldFactor}),
                -Vec3f{kMaxWorldFactor, kMaxWorldFactor, kMaxWorldFactor});
    const auto scaled = [&](std::initializer_list<std::string_view> keys) {
        return color * float(std::clamp(world.Number(keys), -double(kMaxWorldFactor), double(kMaxWorldFactor)));
    };
    result.ambient = scaled({"_ambient", "ambient"});
    result.minLight = scaled({"_minlight"});
    result.minGrid = world.Has("_mingridlight") ? scaled({"_mingridlight"}) : result.minLight;
    result.minVertex = world.Has("_minvertexlight") ? scaled({"_minvertexlight"}) : result.minLight;
    if (world.Has("_maxlight"))
        result.maxLight = float(std::clamp(world.Number({"_maxlight"}), 0.0, 255.0));
    result.noShaderSun = world.Flag("_noshadersun");
    if (world.Has("_floodlight")) {
        result.hasFloodlight = true;
        double v[6] = {0, 0, 0, 0, 0, -1};
        std::string_view text = world.Value("_floodlight");
        for (double &value : v) {
            const std::optional<double> number = TakeNumber(text);
            if (!number)
                break;
            value = *number;
        }
        if (v[0] != 0 || v[1] != 0 || v[2] != 0)
            result.floodColor = {float(v[0]), float(v[1]), float(v[2])};
        result.floodDistance = v[3] < 1 ? 1024 : float(std::min(v[3], double(kSunDistance)));
        result.floodIntensity = v[4] < 1 ? 128 : float(std::min(v[4], double(kMaxWorldFactor)));
        result.floodDirectionScale = v[5] < 0 ? 1 : float(std::min(v[5], double(kMaxWorldFactor)));
    }
    result.floodColor = NormalizeColor(DecodeColor(result.floodColor, options.shader.sRgbColor));
    return result;
}

std::vector<Light> EntityLights(const std::vector<Entity> &entities, const LightOptions &options, Log &log) {
    std::vector<Light> lights;
    for (std::size_t i = 0; i < entities.size(); ++i)
        if (StartsWithNoCase(entities[i].ClassName(), "light"))
            AddEntityLights(entities[i], i, entities, options, lights, log);
    return lights;
}

} // namespace q3
