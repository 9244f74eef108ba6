// GPL-2.0-or-later. Lights whose origin, or part of whose polygon, is inside a solid.
#pragma once

#include "common/log.h"
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sources/light_sources.h"

#include <span>
#include <vector>

namespace q3 {

/// The cluster in which a light shines, or kSolidCluster. Moves `origin` if it is in a solid: by steps of 2 units, as
/// the established program does, whose search continues after a success, so a light can move several times; the last
/// attempt decides.
int LightCluster(Vec3f &origin, const BspSpace &space);

/// The area light as it is if its polygon is in the open and its origin in sight of it. Else one light for each part in
/// the open, with an origin before that part; a two-sided light shines from its back where its front is covered. If a
/// solid covers all of it: the light as it is if LightCluster finds a way out, else none.
std::vector<Light> OpenAreaLights(Light light, const BspSpace &space);

/// How far before an area light its backsplash can be, at most `distance`: half the way to the first solid, if one
/// stands between.
float BacksplashDistance(const Light &light, float distance, const BspSpace &space);

/// Warns of point lights and spotlights of entities that light nothing: in solids and, unless `scene` is null, in
/// models or behind curves.
void WarnOfHiddenLights(std::span<const Light> lights, const BspSpace &space, const LightScene *scene, Log &log);

} // namespace q3
