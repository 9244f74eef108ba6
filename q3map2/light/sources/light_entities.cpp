// GPL-2.0-or-later. Lights that mappers place as entities, and the light keys of the world.
#include "q3map2/light/sources/light_entities.h"

#include "common/error.h"
#include "libs/math/low_discrepancy.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/light/sources/light_suns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr auto kMaxIntensity = float(keys::kMaxIntensity);
/// Limit of values from world keys: products of larger ones could overflow float.
constexpr float kMaxWorldFactor = 1e6f;
constexpr std::uint64_t kSeedJitter = 0x4C69676874ull;

Vec3f DecodeColor(const Vec3f &c, bool sRgb) {
    return sRgb ? Vec3f{LinearFromSrgb(c.x), LinearFromSrgb(c.y), LinearFromSrgb(c.z)} : c;
}

/// How messages name a light: editors find it by its position.
std::string Label(const Entity &entity) {
    return fmt::format("{} at \"{}\"", entity.ClassName(), entity.Value("origin"));
}

float Intensity(const Entity &entity, Log &log) {
    double intensity = keys::kLight.Number(entity);
    if (intensity == 0)
        intensity = keys::kLight.initial;
    if (const double scale = keys::kScale.Number(entity); scale != 0)
        intensity *= scale;
    if (!(std::abs(intensity) <= kMaxIntensity)) {
        log.Warn("light intensity", "{}: intensity {:g} is limited to {:g}", Label(entity), intensity, kMaxIntensity);
        intensity = std::clamp(intensity, double(-kMaxIntensity), double(kMaxIntensity));
    }
    return float(intensity);
}

int Style(const Entity &entity) {
    if (!keys::kStyle.InRange(entity))
        throw Error("{}: style {} is not in 0..254", Label(entity), keys::kStyle.Text(entity));
    return keys::kStyle.Integer(entity);
}

Light LightFromKeys(const Entity &entity, const LightOptions &options, Log &log) {
    Light light;
    const int flags = keys::kSpawnFlags.Integer(entity);
    light.linear = ((flags & 1) != 0) != options.wolfLighting;
    light.angle = ((flags & 3) == 0) != options.wolfLighting;
    light.grid = (flags & 16) == 0;
    if (EqualNoCase(entity.ClassName(), "lightJunior"))
        light.grid = true, light.surfaces = false;
    light.origin = keys::kOrigin.Vector(entity).value_or(Vec3f{});
    light.color = DecodeColor(keys::kColor.Vector(entity).value_or(Vec3f{1, 1, 1}), options.shader.sRgbColor);
    if ((flags & 32) == 0)
        light.color = NormalizeColor(light.color);
    light.fade = float(keys::kFade.Number(entity));
    if (light.fade == 0)
        light.fade = 1;
    light.extraDist = float(keys::kExtraDist.Number(entity, options.extraDist));
    light.angleScale = float(keys::kAngleScale.Number(entity));
    light.angle = light.angle || light.angleScale != 0;
    light.filterRadius = float(keys::kFilterRadius.Number(entity));
    light.style = Style(entity);
    light.name = entity.Value("targetname");
    light.photons = Intensity(entity, log);
    if (!IsFinite(light.color) || MaxComponent(Max(light.color, -light.color)) > kMaxIntensity) {
        log.Warn("light color", "{}: _color {} is out of range, white is used", Label(entity),
                 keys::kColor.Text(entity));
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
    double radius = keys::kRadius.Number(entity);
    if (radius == 0)
        radius = keys::kRadius.initial;
    light.radiusByDist = (float(radius) + 16) / distance;
    light.photons *= options.spotScale;
}

void AddEntityLights(const Entity &entity, std::size_t number, const std::vector<Entity> &entities,
                     const LightOptions &options, std::vector<Light> &lights, Log &log) {
    Light light = LightFromKeys(entity, options, log);
    const int samples = keys::kSamples.Integer(entity);
    const float deviance = float(keys::kDeviance.Number(entity));
    if (MaxComponent(Max(light.origin, -light.origin)) > kMaxLightCoordinate) {
        log.Warn("light origin", "{} is outside any map, it is dropped", Label(entity));
        return;
    }
    light.photons /= float(samples);
    light.tolerance = options.tolerance / float(samples);

    const std::string_view target = keys::kTarget.Text(entity);
    const Entity *aimedAt = target.empty() ? nullptr : FindTarget(entities, target);
    if (!target.empty() && !aimedAt)
        log.Warn("light target", "{}: target \"{}\" does not exist, the light has no direction", Label(entity), target);
    const Vec3f targetOrigin = aimedAt ? keys::kOrigin.Vector(*aimedAt).value_or(Vec3f{}) : Vec3f{};

    if (aimedAt && keys::kSun.Number(entity) != 0) {
        SunDirective sun{.direction = Normalize(light.origin - targetOrigin),
                         .color = light.color,
                         .photons = light.photons,
                         .deviance = deviance * std::numbers::pi_v<float> / 180,
                         .samples = samples,
                         .style = light.style};
        if (sun.direction == Vec3f{})
            sun.direction = {0, 0, 1};
        for (Light &one : MakeSuns(sun, -1, options)) {
            one.name = light.name, one.grid = light.grid, one.surfaces = light.surfaces;
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
    Vec3f color = keys::kWorldColor.Vector(world).value_or(Vec3f{1, 1, 1});
    if (color == Vec3f{})
        color = {1, 1, 1};
    color = DecodeColor(color, options.shader.sRgbColor);
    color = Max(Min(color, Vec3f{kMaxWorldFactor, kMaxWorldFactor, kMaxWorldFactor}),
                -Vec3f{kMaxWorldFactor, kMaxWorldFactor, kMaxWorldFactor});
    const auto scaled = [&](const EntityKey &key) { return color * float(key.Number(world)); };
    result.ambient = scaled(keys::kAmbient);
    result.minLight = scaled(keys::kMinLight);
    result.minGrid = keys::kMinGridLight.Given(world) ? scaled(keys::kMinGridLight) : result.minLight;
    result.minVertex = keys::kMinVertexLight.Given(world) ? scaled(keys::kMinVertexLight) : result.minLight;
    if (keys::kMaxLight.Given(world))
        result.maxLight = float(keys::kMaxLight.Number(world));
    result.noShaderSun = keys::kNoShaderSun.Flag(world);
    if (keys::kFloodlight.Given(world)) {
        result.hasFloodlight = true;
        double v[6] = {0, 0, 0, 0, 0, -1};
        std::string_view text = keys::kFloodlight.Text(world);
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
