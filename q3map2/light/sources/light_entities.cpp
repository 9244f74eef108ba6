// GPL-2.0-or-later. Lights that mappers place as entities, and the light keys of the world.
#include "q3map2/light/sources/light_entities.h"

#include "common/error.h"
#include "libs/math/sampling.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/sources/light_suns.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace q3 {

const Entity *FindTarget(const std::vector<Entity> &entities, std::string_view target) {
    for (const Entity &entity : entities)
        if (entity.Value("targetname") == target)
            return &entity;
    return nullptr;
}

namespace {

/// Bits of the key spawnflags of lights; under -wolf the first two mean the opposite.
enum SpawnFlag { kSpawnLinear = 1, kSpawnNoAngle = 2, kSpawnNoGrid = 16, kSpawnColorAsIs = 32 };

constexpr auto kMaxIntensity = float(keys::kMaxIntensity);
/// Limit of values from world keys: products of larger ones could overflow float.
constexpr float kMaxWorldFactor = 1e6f;
constexpr double kRadiansPerDegree = std::numbers::pi / 180;
/// Directions over the disc of the sun, unless the entity says more.
constexpr int kSunDiscSamples = 32;
constexpr std::uint64_t kSeedJitter = 0x4C69676874ull; ///< "Light" in ASCII
/// A spotlight without a distance to its target counts as this far from it. Game units.
constexpr float kNoTargetDistance = 64;

Vec3f DecodeColor(const Vec3f &c, bool sRgb) {
    return sRgb ? Vec3f{LinearFromSrgb(c.x), LinearFromSrgb(c.y), LinearFromSrgb(c.z)} : c;
}

float Limited(double intensity, const Entity &entity, Log &log) {
    if (!(std::abs(intensity) <= kMaxIntensity)) {
        log.Warn("light intensity", "{}: intensity {:g} is limited to {:g}", LightLabel(entity), intensity,
                 kMaxIntensity);
        intensity = std::clamp(intensity, double(-kMaxIntensity), double(kMaxIntensity));
    }
    return float(intensity);
}

/// The factor of the key `scale`; 0 means 1.
double Scale(const Entity &entity) {
    const double scale = keys::kScale.Number(entity);
    return scale != 0 ? scale : 1;
}

float Intensity(const Entity &entity, Log &log) {
    double intensity = keys::kLight.Number(entity);
    if (intensity == 0)
        intensity = keys::kLight.initial;
    return Limited(intensity * Scale(entity), entity, log);
}

/// The color and brightness R G B [I] of a key, as photons and a color with largest component 1. False if the key has
/// fewer than three numbers. Errors: negative numbers.
bool TakeQuad(const Entity &entity, const EntityKey &key, Light &light, Log &log) {
    LightQuad quad{0, 0, 0, 255};
    std::string_view text = key.Text(entity);
    std::size_t count = 0;
    for (; count < quad.size(); ++count) {
        const std::optional<double> number = TakeNumber(text);
        if (!number)
            break;
        quad[count] = *number;
    }
    if (count == 2)
        log.Warn("brightness of a light", "{}: {} \"{}\": expected 1, 3 or 4 numbers; the first is used",
                 LightLabel(entity), key.info.name, key.Text(entity));
    if (count < 3)
        return false;
    if (*std::min_element(quad.begin(), quad.end()) < 0)
        throw Error("{}: {} \"{}\": expected a color and a brightness of at least 0", LightLabel(entity), key.info.name,
                    key.Text(entity));
    const Vec3d linear = LinearColor(quad);
    const double largest = std::max({linear.x, linear.y, linear.z});
    light.photons = Limited(largest * quad[3] * Scale(entity), entity, log);
    light.color = largest > 0 ? Vec3f(linear / largest) : Vec3f{1, 1, 1};
    return true;
}

/// Warns of HDR light that is not the same as that of `key`.
void WarnOfHdr(const Entity &entity, const EntityKey &hdr, const EntityKey &key, const EntityKey &scale, Log &log) {
    std::string_view text = hdr.Text(entity);
    const std::optional<double> first = TakeNumber(text);
    const bool other = first && *first >= 0 && hdr.Text(entity) != key.Text(entity);
    if (other || scale.Number(entity) != scale.initial)
        log.Warn("HDR brightness of a light", "{}: {} is not read: one result serves all ranges, {} counts",
                 LightLabel(entity), other ? hdr.info.name : scale.info.name, key.info.name);
}

struct EntityLight {
    Light light;
    bool byQuad = false; ///< _light is a color and a brightness
};

EntityLight LightFromKeys(const Entity &entity, const LightOptions &options, Log &log) {
    EntityLight result;
    Light &light = result.light;
    const int flags = keys::kSpawnFlags.Integer(entity);
    if (((flags & kSpawnLinear) != 0) != options.wolfLighting)
        light.curve = FalloffCurve::Linear;
    light.angleAttenuation = ((flags & (kSpawnLinear | kSpawnNoAngle)) == 0) != options.wolfLighting;
    light.lightsGrid = (flags & kSpawnNoGrid) == 0;
    if (EqualNoCase(entity.ClassName(), "lightJunior"))
        light.lightsGrid = true, light.lightsSurfaces = false;
    light.origin = keys::kOrigin.Vector(entity).value_or(Vec3f{});
    light.color = DecodeColor(keys::kColor.Vector(entity).value_or(Vec3f{1, 1, 1}), options.shader.sRgbColor);
    if ((flags & kSpawnColorAsIs) == 0)
        light.color = NormalizeColor(light.color);
    light.fade = float(keys::kFade.Number(entity));
    if (light.fade == 0)
        light.fade = 1;
    light.extraDist = float(keys::kExtraDist.Number(entity, options.extraDist));
    light.angleScale = float(keys::kAngleScale.Number(entity));
    light.angleAttenuation = light.angleAttenuation || light.angleScale != 0;
    light.filterRadius = float(keys::kFilterRadius.Number(entity));
    light.style = options.noStyles ? 0 : keys::kStyle.Integer(entity);
    light.name = entity.Value("targetname");
    light.label = light.name.empty()
                      ? LightLabel(entity)
                      : fmt::format("{} \"{}\" at \"{}\"", entity.ClassName(), light.name, entity.Value("origin"));
    result.byQuad = TakeQuad(entity, keys::kLight, light, log);
    if (!result.byQuad)
        light.photons = Intensity(entity, log);
    else if (keys::kColor.Given(entity))
        log.Warn("key of a light without effect", "{}: _color has no effect, since _light has a color",
                 LightLabel(entity));
    if (!IsFinite(light.color) || MaxAbsComponent(light.color) > kMaxIntensity) {
        log.Warn("light color", "{}: _color {} is out of range, white is used", LightLabel(entity),
                 keys::kColor.Text(entity));
        light.color = {1, 1, 1};
    }
    WarnOfHdr(entity, keys::kLightHdr, keys::kLight, keys::kLightScaleHdr, log);
    return result;
}

/// Turns a light into a spotlight aimed at `target`, with a cone by radius.
void Aim(Light &light, const Entity &entity, const Vec3f &target) {
    light.type = LightType::Spot;
    light.curve = FalloffCurve::InverseSquare;
    light.angleAttenuation = true;
    light.fade = 1;
    light.normal = Normalize(target - light.origin);
    float distance = Length(target - light.origin);
    if (distance == 0)
        distance = kNoTargetDistance;
    double radius = keys::kRadius.Number(entity);
    if (radius == 0)
        radius = keys::kRadius.initial;
    light.radiusByDist = (float(radius) + kConeMargin) / distance;
}

bool HasConeByAngles(const Entity &entity) {
    return EqualNoCase(entity.ClassName(), "light_spot") || keys::kInnerCone.Given(entity) ||
           keys::kCone.Given(entity) || keys::kExponent.Given(entity);
}

/// Where a light shines by its keys pitch, angles and angle.
Vec3f DirectionOfKeys(const Entity &entity) {
    constexpr double kUp = -1, kDown = -2; // values of angle
    const Vec3f angles = keys::kLightAngles.Vector(entity).value_or(Vec3f{});
    const double angle = keys::kLightAngle.Number(entity), pitchKey = keys::kPitch.Number(entity);
    if (angle == kUp || angle == kDown)
        return {0, 0, angle == kUp ? 1.0f : -1.0f};
    const double yaw = (angle != 0 ? angle : double(angles.y)) * kRadiansPerDegree;
    const double pitch = (pitchKey != 0 ? pitchKey : double(angles.x)) * kRadiansPerDegree;
    return Normalize(Vec3f(Vec3d{std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), std::sin(pitch)}));
}

/// A half angle of at most 90 degrees, in radians.
double HalfAngle(const Entity &entity, const EntityKey &key, double degrees, Log &log) {
    constexpr double kWidest = 90;
    if (degrees > kWidest)
        log.Warn("cone of a light", "{}: {} {:g} is limited to {:g}", LightLabel(entity), key.info.name, degrees,
                 kWidest);
    return std::min(degrees, kWidest) * kRadiansPerDegree;
}

/// Turns a light into a spotlight along `direction`, with a cone by angles, unless the cone is the whole sphere.
void AimByAngles(Light &light, const Entity &entity, const Vec3f &direction, Log &log) {
    constexpr double kSphere = 180;
    const double inner = keys::kInnerCone.Number(entity);
    const double outer = std::max(inner, keys::kCone.Number(entity, inner));
    if (inner == kSphere)
        return;
    light.type = LightType::Spot;
    light.curve = FalloffCurve::InverseSquare;
    light.angleAttenuation = true;
    light.normal = direction;
    const double exponent = keys::kExponent.Number(entity);
    light.cone = {.byAngles = true,
                  .cosInner = float(std::cos(HalfAngle(entity, keys::kInnerCone, inner, log))),
                  .cosOuter = float(std::cos(HalfAngle(entity, keys::kCone, outer, log))),
                  .exponent = exponent != 0 ? float(exponent) : 1};
}

/// Applies keys for the curve of falloff, and the options that scale intensities.
void SetEntityFalloff(Light &light, bool byQuad, const Entity &entity, const LightOptions &options, Log &log) {
    constexpr float kDefaultEntityScale = 7500; // the default of -pointscale and of -spotscale
    const bool byteValues = SetCurve(entity, byQuad, light, log);
    // For lights in byte values flag 1 is that of Source, "initially dark": only flag 2 turns the angle off.
    if (byteValues && light.type == LightType::Point)
        light.angleAttenuation = (keys::kSpawnFlags.Integer(entity) & kSpawnNoAngle) == 0 || light.angleScale != 0;
    const float scale = light.type == LightType::Spot ? options.spotScale : options.pointScale;
    light.photons *= byteValues ? scale / kDefaultEntityScale : scale;
}

void AddSun(const Light &light, const Vec3f &target, float deviance, int samples, const LightOptions &options,
            std::vector<Light> &lights) {
    SunDirective sun{.direction = Normalize(light.origin - target),
                     .color = light.color,
                     .photons = light.photons,
                     .deviance = deviance * std::numbers::pi_v<float> / 180,
                     .samples = samples,
                     .style = light.style};
    if (sun.direction == Vec3f{})
        sun.direction = {0, 0, 1};
    AddSunOfEntity(sun, light, options, lights);
}

void AddEnvironment(const Entity &entity, const LightOptions &options, std::vector<Light> &lights, Log &log) {
    auto [sun, byQuad] = LightFromKeys(entity, options, log);
    if (!byQuad)
        sun.photons = Limited(keys::kLight.Number(entity, 0) * Scale(entity), entity, log);
    Environment environment{.direction = DirectionOfKeys(entity),
                            .color = sun.color,
                            .photons = sun.photons,
                            .spread = float(keys::kSunSpread.Number(entity)),
                            .samples = keys::kSamples.Integer(entity, kSunDiscSamples)};
    Light ambient;
    if (TakeQuad(entity, keys::kSkyAmbient, ambient, log))
        environment.ambientColor = ambient.color, environment.ambient = ambient.photons;
    else
        environment.ambient = Limited(keys::kSkyAmbient.Number(entity) * Scale(entity), entity, log);
    WarnOfHdr(entity, keys::kAmbientHdr, keys::kSkyAmbient, keys::kAmbientScaleHdr, log);
    for (Light &light : EnvironmentLights(environment, sun, options))
        lights.push_back(std::move(light));
}

void AddEntityLights(const Entity &entity, std::size_t number, const std::vector<Entity> &entities,
                     const LightOptions &options, std::vector<Light> &lights, Log &log) {
    auto [light, byQuad] = LightFromKeys(entity, options, log);
    const int samples = keys::kSamples.Integer(entity);
    const float deviance = float(keys::kDeviance.Number(entity)); // of suns degrees, of others game units
    if (MaxAbsComponent(light.origin) > kMaxLightCoordinate) {
        log.Warn("light origin", "{} is outside any map, it is dropped", LightLabel(entity));
        return;
    }
    light.entity = int(number);
    light.photons /= float(samples);
    light.tolerance = options.tolerance / float(samples);

    const std::string_view target = keys::kTarget.Text(entity);
    const Entity *aimedAt = target.empty() ? nullptr : FindTarget(entities, target);
    if (!target.empty() && !aimedAt)
        log.Warn("light target", "{}: target \"{}\" does not exist, the light has no direction", LightLabel(entity),
                 target);
    if (target.empty() && keys::kSun.Number(entity) != 0)
        log.Warn("light target",
                 "{}: _sun has no effect without a target, so this light is not a sun; give it a target in the "
                 "direction of its light, "
                 "or use a light_environment",
                 LightLabel(entity));
    const Vec3f targetOrigin = aimedAt ? keys::kOrigin.Vector(*aimedAt).value_or(Vec3f{}) : Vec3f{};

    if (aimedAt && keys::kSun.Number(entity) != 0)
        return AddSun(light, targetOrigin, deviance, samples, options, lights);
    if (HasConeByAngles(entity))
        AimByAngles(light, entity, aimedAt ? Normalize(targetOrigin - light.origin) : DirectionOfKeys(entity), log);
    else if (aimedAt)
        Aim(light, entity, targetOrigin);
    SetEntityFalloff(light, byQuad, entity, options, log);

    const std::uint64_t seed = kSeedJitter + (number << 24);
    const auto sampled = [&, &light = light](int count) {
        const bool asAsked = count == samples;
        std::vector<Light> copies(std::size_t(count), light);
        for (int i = 0; i < count; ++i) {
            Light &copy = copies[std::size_t(i)];
            copy.sample = i;
            copy.photons *= float(samples) / float(count), copy.tolerance *= float(samples) / float(count);
            const Sample3 even = R3Sample(std::uint32_t(i), seed); // of the samples for surfaces alone
            const std::array<double, 3> at{even.u, even.v, even.w};
            for (std::size_t axis = 0; axis < 3 && i > 0; ++axis) {
                const double hashed = UnitFromHash(HashIndex(seed + std::uint64_t(i) * 4 + axis));
                copy.origin[axis] += float(2 * (asAsked ? hashed : at[axis]) - 1) * deviance;
            }
        }
        return copies;
    };
    const bool canGroup = deviance > 0 && light.IsTimesCosine(); // on surfaces
    for (Light &copy : canGroup ? WithSurfaceSamples(samples, options, sampled) : sampled(samples))
        lights.push_back(std::move(copy));
}

bool IsEnvironment(const Entity &entity) {
    return EqualNoCase(entity.ClassName(), "light_environment");
}

/// The entity whose sun and sky count: the last. The number of entities if there is none.
std::size_t LastEnvironment(const std::vector<Entity> &entities, Log &log) {
    std::size_t last = entities.size();
    for (std::size_t i = 0; i < entities.size(); ++i) {
        if (!IsEnvironment(entities[i]))
            continue;
        if (last < entities.size())
            log.Warn("several light_environment", "{}: not used, the last light_environment of the map counts",
                     LightLabel(entities[last]));
        last = i;
    }
    return last;
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
    result.macroTexture = keys::kMacroTexture.Text(world);
    result.macroMins = keys::kWorldMins.Vector(world);
    result.macroMaxs = keys::kWorldMaxs.Vector(world);
    if (keys::kFloodlight.Given(world)) {
        result.hasFloodlight = true;
        std::array<double, 6> values = {0, 0, 0, 0, 0, -1};
        std::string_view text = keys::kFloodlight.Text(world);
        for (double &value : values) {
            const std::optional<double> number = TakeNumber(text);
            if (!number)
                break;
            value = *number;
        }
        const auto [red, green, blue, distance, intensity, directionScale] = values;
        if (red != 0 || green != 0 || blue != 0)
            result.floodColor = {float(red), float(green), float(blue)};
        if (!(distance < 1)) // missing or too small numbers leave the defaults
            result.floodDistance = float(std::min(distance, double(kSunDistance)));
        if (!(intensity < 1))
            result.floodIntensity = float(std::min(intensity, double(kMaxWorldFactor)));
        if (!(directionScale < 0))
            result.floodDirectionScale = float(std::min(directionScale, double(kMaxWorldFactor)));
    }
    result.floodColor = NormalizeColor(DecodeColor(result.floodColor, options.shader.sRgbColor));
    return result;
}

void WarnOfBadLightKeys(const Entity &entity, std::size_t number, Log &log) {
    WarnOfBadKeys(entity, number, keys::kLightKeys, log);
    WarnOfBadKeys(entity, number, keys::kFalloffKeys, log);
    WarnOfBadKeys(entity, number, keys::kHdrLightKeys, log);
    if (HasConeByAngles(entity) || IsEnvironment(entity))
        WarnOfBadKeys(entity, number, keys::kConeKeys, log);
    if (IsEnvironment(entity))
        WarnOfBadKeys(entity, number, keys::kEnvironmentKeys, log);
}

std::vector<Light> EntityLights(const std::vector<Entity> &entities, const LightOptions &options, Log &log) {
    std::vector<Light> lights;
    const std::size_t environment = LastEnvironment(entities, log);
    for (std::size_t i = 0; i < entities.size(); ++i)
        if (i == environment)
            AddEnvironment(entities[i], options, lights, log);
        else if (StartsWithNoCase(entities[i].ClassName(), "light") && !IsEnvironment(entities[i]))
            AddEntityLights(entities[i], i, entities, options, lights, log);
    return lights;
}

} // namespace q3
