// GPL-2.0-or-later. What each light gives a receiver, and why the others give nothing.
#pragma once

#include "q3map2/lightmap/direct/luxel_contribution.h"
#include "q3map2/lightmap/explain/obstacles.h"

#include <span>
#include <vector>

namespace q3 {

/// A light as a pass takes it.
struct PreparedLight {
    Light light;        ///< after SetupEnvelopes
    bool isUsed = true; ///< by the pass; else `fate` says why not
    LightFate fate = LightFate::Arrives;
};

/// All lights of a map prepared for a pass, also those that the pass leaves out. fastPoint: as for SetupEnvelopes.
std::vector<PreparedLight> PrepareLights(const LightSetup &setup, LightPass pass, bool fastPoint);

/// A position of a luxel that is lit.
struct LuxelReceiver {
    Vec3f position, normal;
    int cluster = kSolidCluster;
    bool inMean = true; ///< counts in the mean over the luxel; else only its own light is wanted
};

/// Explains lights at receivers. Keeps references.
class LightExplainer {
  public:
    LightExplainer(const LightSetup &setup, const MapSource &source, const ObstacleFinder &obstacles)
        : setup_(setup), source_(source), obstacles_(obstacles) {}

    /// At a point in the open, by the rules of the SH grid: lights strongest first, then those that give nothing, the
    /// nearest first.
    std::vector<LightAccount> AtPoint(const std::vector<PreparedLight> &lights, const Vec3f &p, int cluster) const;
    /// At a luxel: the mean over its receivers that are inMean. arriving: set to the light at each receiver.
    std::vector<LightAccount> AtLuxel(const std::vector<PreparedLight> &lights, const RawLightmap &lightmap,
                                      const LuxelPass &pass, std::span<const LuxelReceiver> receivers,
                                      std::vector<Vec3f> &arriving) const;

  private:
    struct Part;
    class Accounts;
    LightFate WhyNothing(const PreparedLight &light, const Vec3f &p, int cluster, const Vec3f *normal) const;
    LightAccount AccountOf(const Light &light) const;
    Obstacle SolidOf(const Light &light) const;

    const LightSetup &setup_;
    const MapSource &source_;
    const ObstacleFinder &obstacles_;
};

} // namespace q3
