// GPL-2.0-or-later. Lights whose origin, or part of whose polygon, is inside a solid or crossed by a surface.
#pragma once

#include "common/log.h"
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sources/light_sources.h"

#include <span>
#include <vector>

namespace q3 {

/// Moves an origin in a solid into the open by steps of 2 units, and returns its cluster, or kSolidCluster. As in the
/// established program, the search goes on after a success, so a light can move several times, and the last attempt
/// decides about the cluster.
int NudgeIntoOpen(Vec3f &origin, const BspSpace &space);

/// The parts of an area light that emit. It stays as it is if its polygon is in the open and its origin sees the
/// polygon. Otherwise each open part becomes a light with an origin in front of it; where only the front of a two-sided
/// light is covered, its back emits. A light that is covered as a whole stays as it is if NudgeIntoOpen finds a way
/// out, else there is none.
std::vector<Light> OpenAreaLights(Light light, const BspSpace &space);

/// Cuts area lights along surfaces that cross them through their middle, such as the second one of two crossed flames,
/// and returns all lights. Each part has an origin of its own, so that a receiver sees those on its side.
std::vector<Light> CutCrossedLights(std::vector<Light> lights, const BspSpace &space, const LightScene &scene);

/// Distance from an area light to its backsplash, game units: `distance`, or half the distance to the first solid in
/// between.
float BacksplashDistance(const Light &light, float distance, const BspSpace &space);

/// Warns of point lights and spotlights of entities that light nothing because they are in solids or, unless `scene` is
/// null, in models or behind curves.
void WarnOfHiddenLights(std::span<const Light> lights, const BspSpace &space, const LightScene *scene, Log &log);

} // namespace q3
