// GPL-2.0-or-later. Next event estimation of the brightest emitters of a bounce.
#pragma once

#include "q3map2/light/grid/indirect_light.h"
#include "q3map2/lightmap/bounce/bounce_estimate.h"
#include "q3map2/lightmap/bounce/bright_tree.h"
#include "q3map2/lightmap/bounce/radiosity_patches.h"

namespace q3 {

/// Few gather rays hit the small spots of light that lamps make on walls nearby, and each hit counts much: noise. So
/// what the radiosity of such emitters has above a limit is left out of the gathered emission and sampled by shadow
/// rays to the nodes of a light tree. Const after construction; safe from several threads.
class BrightEmitters {
  public:
    /// Takes from `emission` what is above `limit`, byte scale, in any channel. patches: null unless -fast. Keeps
    /// references.
    BrightEmitters(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                   const EmitterIndex &emitters, const RadiosityPatches *patches, float limit,
                   std::vector<Vec3f> &emission);
    bool Empty() const { return tree_.Empty(); }
    std::size_t Patches() const { return count_; }

    /// Adds their light on the luxels of a lightmap to the estimate. origins: of rays, by luxel.
    void AddToLuxels(const RawLightmap &raw, const std::vector<Vec3f> &origins, BounceEstimate &estimate) const;
    /// Their light at a point of a surface, byte scale. origin: of rays. twoSided: as in RadiosityPatches.
    Vec3f IrradianceAt(const Vec3f &position, const Vec3f &origin, const Vec3f &normal, bool twoSided) const;
    /// Appends their light at a point in the open.
    void Gather(const Vec3f &point, std::uint64_t seed, std::vector<IndirectRay> &rays) const;

  private:
    struct Receivers;
    /// Light on one receiver from one node.
    struct Sample {
        std::size_t receiver;
        Vec3f direction, light; ///< to the node; light on a surface that faces it, byte scale
    };
    void SampleTree(const Receivers &receivers, std::vector<Sample> &samples) const;
    bool SampleNode(const Receivers &receivers, std::size_t i, std::uint32_t node, std::uint32_t stride, Sample &sample,
                    Vec3f &target) const;

    const BspSpace &space_;
    const BounceScene &scene_;
    const RadiosityPatches *patches_;
    std::size_t count_ = 0;
    BrightTree tree_;
};

} // namespace q3
