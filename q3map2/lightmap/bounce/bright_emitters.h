// GPL-2.0-or-later. Next event estimation of the brightest emitters of a bounce.
#pragma once

#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/lightmap/bounce/bounce_filter.h"
#include "q3map2/lightmap/bounce/bright_tree.h"
#include "q3map2/lightmap/bounce/faint_patches.h"

namespace q3 {

/// Few gather rays hit the small bright spots that lights make on nearby walls, and each hit adds much light: noise. So
/// the part of an emitter's radiosity above a limit is removed from the gathered emission and sampled by shadow rays to
/// the nodes of a light tree. Const after construction; safe from several threads.
class BrightEmitters {
  public:
    /// Removes from `emission` the part above `limit` (byte scale) and samples it. patches: leaves out faint emitters
    /// under -fast; else null. Keeps references.
    BrightEmitters(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                   const EmitterIndex &emitters, const FaintPatches *patches, float limit,
                   std::vector<Vec3f> &emission);
    bool Empty() const { return tree_.Empty(); }
    std::size_t Patches() const { return count_; }

    /// Adds the light of bright emitters on the luxels of a lightmap. origins: ray origins by luxel.
    void AddToLuxels(const RawLightmap &raw, const std::vector<Vec3f> &origins, BounceEstimate &estimate) const;
    /// Light of bright emitters at a point of a surface, byte scale. origin: of the rays. twoSided: the surface is lit
    /// from both sides.
    Vec3f IrradianceAt(const Vec3f &position, const Vec3f &origin, const Vec3f &normal, bool twoSided) const;
    /// Appends the light of bright emitters at a point in the open.
    void Gather(const Vec3f &point, std::uint64_t seed, std::vector<IndirectRay> &rays) const;

  private:
    struct Receivers;
    /// Light on one receiver from one node.
    struct Sample {
        std::size_t receiver;
        Vec3f direction; ///< unit, to the node
        Vec3f light;     ///< on a surface that faces the node, byte scale
    };
    void SampleTree(const Receivers &receivers, std::vector<Sample> &samples) const;
    bool SampleNode(const Receivers &receivers, std::size_t i, std::uint32_t node, std::uint32_t stride, Sample &sample,
                    Vec3f &target) const;

    const BspSpace &space_;
    const BounceScene &scene_;
    const FaintPatches *patches_;
    std::size_t count_ = 0;
    BrightTree tree_;
};

} // namespace q3
