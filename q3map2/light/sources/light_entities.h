// GPL-2.0-or-later. Lights that mappers place as entities, and the light keys of the world.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/sources/light_sources.h"

#include <optional>
#include <string>
#include <vector>

namespace q3 {

/// World keys that concern light.
struct WorldLight {
    Vec3f ambient;                             ///< byte scale
    Vec3f minGrid;                             ///< least light of grid points; byte scale
    Vec3f minLight, minVertex;                 ///< least light of lightmaps and of vertices; byte scale
    float maxLight = 255;                      ///< key _maxlight: limit of light in bytes
    bool noShaderSun = false;                  ///< suns of shaders do not shine
    bool hasFloodlight = false;                ///< the key _floodlight is given
    Vec3f floodColor{0.94f, 0.94f, 1.0f};      ///< largest component 1
    std::string macroTexture;                  ///< _macrotexture; empty: none
    std::optional<Vec3f> macroMins, macroMaxs; ///< where its edges are; else those of the world
    float floodDistance = 1024;                ///< reach of floodlight rays. Game units
    float floodIntensity = 128;                ///< byte scale
    float floodDirectionScale = 1;             ///< factor of floodlight in the direction of deluxe maps
};
/// World keys; missing and bad ones are the defaults.
WorldLight ReadWorldLight(const Entity &world, const LightOptions &options);

/// Warns of bad values of the keys that a light reads. `number`: index of the entity in its file.
void WarnOfBadLightKeys(const Entity &entity, std::size_t number, Log &log);

/// The first entity of that targetname, at which lights aim; null: none.
const Entity *FindTarget(const std::vector<Entity> &entities, std::string_view target);

/// Lights of entities whose class name starts with "light", in entity order. Unusable keys are warnings.
/// Errors: a style out of range, a color and brightness below 0, distances without a curve.
std::vector<Light> EntityLights(const std::vector<Entity> &entities, const LightOptions &options, Log &log);

} // namespace q3
