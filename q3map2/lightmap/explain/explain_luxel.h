// GPL-2.0-or-later. The luxel nearest to a point: where it is lit, its samples and its lights.
#pragma once

#include "q3map2/lightmap/explain/explain_lights.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <array>
#include <optional>
#include <vector>

namespace q3 {

/// Surfaces farther from the point than this are not asked for. Game units.
inline constexpr float kLuxelReach = 64;

/// A triangle of a surface with a lightmap, clockwise seen from the front.
struct SurfaceTriangle {
    std::array<Vec3f, 3> corners{};
    Vec3f normal;
};

/// Explains luxels by mapping and lighting the raw lightmap that holds them again. Keeps references.
class LuxelExplainer {
  public:
    LuxelExplainer(const SurfaceInputs &in, const LightSetup &setup, const MapSource &source,
                   const ObstacleFinder &obstacles);

    /// The luxel of the nearest surface with a lightmap in front of which p is; none within kLuxelReach.
    std::optional<LuxelAccount> NearestTo(const Vec3f &p) const;
    /// Of all surfaces with lightmaps, in their order.
    std::vector<SurfaceTriangle> Triangles() const;

  private:
    struct Spot;
    std::optional<Spot> FindSpot(const Vec3f &p) const;
    SurfaceLight OneLightmap(const Spot &spot) const;
    void AddPage(const Spot &spot, LuxelAccount &account) const;
    void AddSamples(const Spot &spot, const RawLightmap &raw, LuxelAccount &account,
                    std::vector<LuxelReceiver> &receivers, std::vector<std::size_t> &sampleOf) const;
    void AddLight(SurfaceLight &surfaces, const Spot &spot, LuxelAccount &account) const;
    std::optional<Obstacle> WhyNotLit(const Vec3f &from, const Vec3f &wanted) const;

    const SurfaceInputs &in_;
    const ObstacleFinder &obstacles_;
    LightExplainer explainer_;
    std::vector<PreparedLight> lights_; ///< all, with the reasons of those that the pass leaves out
    std::vector<Light> passLights_;     ///< as the pass takes them
    SurfaceLight surfaces_;             ///< set up, without luxels
};

} // namespace q3
