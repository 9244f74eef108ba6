// GPL-2.0-or-later. Next event estimation of the brightest emitters of a bounce: small patches in a light tree.
#pragma once

#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/lightmap/bounce/bounce_filter.h"
#include "q3map2/lightmap/bounce/bounce_scene.h"
#include "q3map2/lightmap/bounce/faint_patches.h"

#include <vector>

namespace q3 {

/// A small, nearly flat piece of an emitter.
struct BrightPatch {
    Vec3f center, normal;
    float area = 0;           ///< square game units
    Vec3f radiosity;          ///< byte scale
    EmitterId emitter = 0;    ///< the emitter that it is a piece of
    int cluster = kNoCluster; ///< kNoCluster: unknown
    bool twoSided = false;    ///< emits from its back as well
    static constexpr int kNoCluster = -1;
};

/// A group of receivers that share a cut of the tree, bounded by a sphere.
struct ReceiverGroup {
    Vec3f center;
    float radius = 0;          ///< of a sphere around center that holds the receivers
    Vec3f normal;              ///< normal of all receivers; zero: they differ, or are in the open
    std::vector<int> clusters; ///< of the receivers; empty: unknown
};

/// Light tree (Walter et al., Lightcuts, 2005) over patches. A cut is a set of nodes that together hold each patch
/// once, except for patches that cannot light the receivers. Const after construction.
class BrightTree {
  public:
    struct Node {
        Vec3f center, axis;  ///< means of patch centers and normals, weighted by power
        float radius = 0;    ///< of a sphere around center that holds the patches
        float minCosine = 1; ///< between axis and the normal of any of the patches
        Vec3f power;         ///< sum of radiosity * area
        float area = 0;
        std::uint32_t first = 0, count = 0;    ///< range of its patches
        std::uint32_t right = 0;               ///< its right child; the left one is the next node. 0: a leaf
        int cluster = BrightPatch::kNoCluster; ///< if all its patches are in the same cluster, else kNoCluster
        bool twoSided = false;
    };

    explicit BrightTree(std::vector<BrightPatch> patches);
    bool Empty() const { return patches_.empty(); }

    /// Appends the nodes of a cut in which each node is small compared to its distance from all receivers, or gives
    /// them less light than `faint` (byte scale), or is a leaf.
    void Cut(const ReceiverGroup &receivers, const BspSpace &space, float faint, std::vector<std::uint32_t> &cut) const;
    const Node &At(std::uint32_t node) const { return nodes_[node]; }
    /// Upper bound of the luminance that a node gives to a receiver of the group at least 1 unit away: L / (pi d^2),
    /// with L the luminance of its power and d the distance between the bounding spheres. Byte scale.
    static float MostLight(const Node &node, const ReceiverGroup &receivers);
    /// Samples a patch of a node in proportion to power: inverts its cumulative distribution at `u` in [0, 1).
    const BrightPatch &PatchAt(const Node &node, float u) const;

  private:
    std::uint32_t Build(std::uint32_t first, std::uint32_t count);
    Node Sum(std::uint32_t first, std::uint32_t count) const;

    std::vector<BrightPatch> patches_; // sorted so that the patches of a node are consecutive
    std::vector<double> powerBefore_;  // prefix sums of luminance * area over patches_
    std::vector<Node> nodes_;
    std::vector<std::uint32_t>
        roots_; // one for each main direction that patches face, so that normals within a node are similar
};

/// Patches for the emitters with a nonzero radiosity `excess` (by emitter, byte scale): texels of raw lightmaps cut
/// into 2 x 2 pieces and clipped to their surfaces; on surfaces lit at vertices, the part of each triangle nearest to
/// the vertex.
std::vector<BrightPatch> MakeBrightPatches(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                           const EmitterIndex &emitters, std::span<const Vec3f> excess);

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
    std::size_t PatchCount() const { return patchCount_; }

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
    std::size_t patchCount_ = 0;
    BrightTree tree_;
};

} // namespace q3
