// GPL-2.0-or-later. Direct light of a map at any point of a surface, by the rules of the light stage.
#pragma once

#include "q3map2/light/scene/light_space.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "tools/measure/bounce_error/path_random.h"

#include <memory>
#include <vector>

namespace q3::bounce {

/// A receiver with its position off the surface, like the light stage's luxels.
struct SurfacePoint {
    Vec3f position, normal;
    int cluster = -1; ///< below 0: unknown, then the PVS is not used
    bool twoSided = false;
    int receiveShadows = 1; ///< shadow group
};

/// Light of one source at a receiver before shadows; null light: none.
struct UnshadowedLight {
    Vec3f color;     ///< byte scale; below 0 for negative lights
    Vec3f direction; ///< of the shadow ray, unit
    float distance = 0;
    const Light *light = nullptr;
};

/// Light of the source at the receiver, without shadows. Independent of light/transfer, except that it shares the
/// formulas of falloff, cones and form factors. light: from SetupEnvelopes for surfaces.
UnshadowedLight LightWithoutShadow(const Light &light, const SurfacePoint &at);

/// The part of it that arrives: one shadow ray, with the tint of see-through surfaces.
Vec3f ArrivingLight(const LightScene &scene, const UnshadowedLight &one, const SurfacePoint &at, RayCounts &counts);

/// Whether the receiver lies on the emitting surface itself: within 3 units of the light's plane, with the cosine
/// between the normals above 0.9. The same values as in light/transfer/light_sample.cpp.
bool IsOnEmitter(const Light &light, const SurfacePoint &at);

/// Where shadow rays to an area light end: its origin, or for receivers behind it the point as far behind its polygon.
Vec3f OriginToward(const Light &light, bool behind);

/// All lights of style 0 that light surfaces, to sum up or to sample. Safe from several threads; results do not depend
/// on earlier calls.
class DirectLights {
  public:
    /// Keeps references.
    DirectLights(const SurfaceInputs &in, std::vector<Light> lights);
    ~DirectLights();

    /// Light at the point: the sum over all sources, each with a shadow ray.
    Vec3f At(const SurfacePoint &at, RayCounts &counts) const;
    /// One source, chosen by importance, its color scaled so that the expected value is the light of all sources. The
    /// caller must trace the shadow ray.
    ///
    /// Resampled importance sampling (Talbot, Cline and Egbert, 2005): candidates are drawn in proportion
    /// to a bound of the light that a source gives in the point's cell, mixed with a uniform density so that no source
    /// has probability 0; one of them is chosen in proportion to its unshadowed light.
    UnshadowedLight Sample(const SurfacePoint &at, PathRandom &random) const;

    const std::vector<Light> &Lights() const { return lights_; }

  private:
    struct Cells;
    const SurfaceInputs &in_;
    const std::vector<Light> lights_;
    std::unique_ptr<Cells> cells_;
};

} // namespace q3::bounce
