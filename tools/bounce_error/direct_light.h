// GPL-2.0-or-later. Direct light of a map at any point of a surface, by the rules of the light stage.
#pragma once

#include "q3map2/light/scene/light_space.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "tools/bounce_error/path_random.h"

#include <memory>
#include <vector>

namespace q3::bounce {

/// A receiver, as the light stage takes luxels: off its surface.
struct SurfacePoint {
    Vec3f position, normal;
    int cluster = -1; ///< below 0: unknown, visibility data are not used
    bool twoSided = false;
    int receiveShadows = 1; ///< shadow group
};

/// Light of one source at a receiver before shadows; zero color: none.
struct UnshadowedLight {
    Vec3f color;     ///< byte scale; negative of negative lights
    Vec3f direction; ///< of the shadow ray, unit
    float distance = 0;
    const Light *light = nullptr;
};

/// Evaluated apart from light/transfer but for falloff, cones and form factors. `light` is prepared by SetupEnvelopes
/// for surfaces.
UnshadowedLight LightWithoutShadow(const Light &light, const SurfacePoint &at);

/// All lights of style 0 that light surfaces, to be evaluated one by one or sampled. Safe from several threads; what it
/// returns does not depend on earlier calls.
class DirectLights {
  public:
    /// Keeps references.
    DirectLights(const SurfaceInputs &in, std::vector<Light> lights);
    ~DirectLights();

    /// Light at the point, every source with its shadow ray.
    Vec3f At(const SurfacePoint &at, RayCounts &counts) const;
    /// One source, chosen by importance; its color is scaled so that the mean over choices is the light of all sources.
    /// Its shadow ray is still to be traced.
    ///
    /// Resampled importance sampling (Talbot, Cline and Egbert, 2005): candidates are drawn by a bound of the light
    /// that a source gives in the cell of the point, mixed with the uniform density so that none is ever left out; one
    /// of them is kept by the light that it gives without shadow.
    UnshadowedLight Sample(const SurfacePoint &at, PathRandom &random) const;

    const std::vector<Light> &Lights() const { return lights_; }

  private:
    struct Cells;
    const SurfaceInputs &in_;
    const std::vector<Light> lights_;
    std::unique_ptr<Cells> cells_;
};

} // namespace q3::bounce
