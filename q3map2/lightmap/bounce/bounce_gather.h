// GPL-2.0-or-later. Final gathering of bounced light at luxels, vertices and points of the light grids.
#pragma once

#include "q3map2/lightmap/bounce/bounce_filter.h"
#include "q3map2/lightmap/bounce/bright_emitters.h"
#include "q3map2/lightmap/bounce/faint_patches.h"
#include "q3map2/lightmap/bounce/gather_rays.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <map>

namespace q3 {

/// Vertices gather at points moved this far (at most a quarter of the way) toward the center of their surface, since
/// the edge of a surface often lies in the plane of another. Not along the normal: the center of a closed model lies
/// inside it. Game units.
inline constexpr float kVertexInset = 2;

/// Whether the surface is lit at its vertices.
inline bool IsLitAtVertices(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t surface) {
    return surfaces.lightmapOf[surface] < 0 && !in.table[surface].shader->lightmap.noVertexLight;
}

/// Calls use(vertex, position to gather at) for the draw vertices of a surface.
template <typename Use>
void ForVertexReceivers(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t number, const Use &use) {
    const bspDrawSurface_t &surface = in.bsp.drawSurfaces[number];
    Vec3f center;
    for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v)
        center += surfaces.verts[std::size_t(v)].xyz / float(surface.numVerts);
    for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v) {
        const auto &[at, normal, st, luxel] = surfaces.verts[std::size_t(v)];
        const Vec3f offset = center - at, inward = offset - normal * Dot(offset, normal);
        use(v, at + inward * std::min(0.25f, kVertexInset / std::max(1.0f, Length(inward))));
    }
}

/// Radiosity of each emitter, byte scale: light it received times its reflectance.
using Emission = std::vector<Vec3f>;

/// Seed of the gather rays of a vertex: equal for vertices at the same place, so that surfaces that meet there get the
/// same light.
std::uint64_t VertexSeed(const Vec3f &vertex);

/// Monte Carlo estimate of irradiance over cosine-weighted directions: E = 1/N sum of the radiosity that ray i hits, on
/// a scale where E equals the radiosity of surroundings of uniform radiosity. Each mapped luxel traces N = 64 rays
/// (24 under -fast; max(4, N / S^2) under -super S; -bouncerays sets N); the 16 luxels of a 4 x 4 block trace different
/// directions, and so do the blocks. Rays hit the same emitters in every bounce, so hits are kept: all of them if
/// memory allows; else fewer per texel for GatherTexels, and GatherLuxels traces its rays anew. Const after
/// construction; safe from several threads.
class BounceGather {
  public:
    /// patches: leaves out faint emitters under -fast; else null. Keeps references.
    BounceGather(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                 const FaintPatches *patches);

    /// Sets `estimate`, which must be zero, to the light of `emission` on the luxels of a lightmap. Adds to
    /// `difference`, by luxel, half the difference between the luminance from even and from odd rays: a sample of the
    /// error of the irradiance.
    void GatherLuxels(const Emission &emission, std::size_t lightmap, const RawLightmap &raw, BounceEstimate &estimate,
                      std::span<float> difference) const;
    /// Sets `texels`, those of the lightmap without supersampling, to the mean light of `emission` over their mapped
    /// luxels; zero for texels without any.
    void GatherTexels(const Emission &emission, std::size_t lightmap, const RawLightmap &raw,
                      std::span<Vec3f> texels) const;
    /// The hits that GatherTexels reads, in unspecified order.
    std::span<const EmitterId> KeptHits(std::size_t lightmap) const { return rows_[lightmap].hits; }
    /// Where rays of a vertex start: off its surface, but not behind a decal or the like over it.
    Vec3f VertexRayOrigin(const Vec3f &position, const Vec3f &normal) const;
    /// The emitters that `count` rays from a vertex hit. twoSided: its surface is seen from both sides. seed: shifts
    /// their directions, VertexSeed.
    std::vector<EmitterId> VertexHits(const Vec3f &position, const Vec3f &normal, bool twoSided, int count,
                                      std::uint64_t seed) const;
    /// Light at a vertex, by 4 N rays (256 under -fast).
    Vec3f IrradianceAt(const Vec3f &position, const Vec3f &normal, bool twoSided, const Emission &emission,
                       std::uint64_t seed) const;

    /// RayOrigins of a lightmap.
    const std::vector<Vec3f> &Origins(std::size_t lightmap) const { return origins_[lightmap]; }
    /// Number of rays of all luxels together.
    std::uint64_t Rays() const { return rays_; }

  private:
    /// Hits of the rays of mapped luxels, `rays` for each luxel, row by row of the super grid. Only luxels whose x and
    /// y are both stride / 2 modulo `stride`.
    struct HitRows {
        int stride = 1, rays = 0;
        std::vector<EmitterId> hits;
        bool Has(const RawLightmap &raw, std::size_t luxel, int x, int y) const {
            return x % stride == stride / 2 && y % stride == stride / 2 && raw.Mapped(luxel);
        }
    };
    /// Up to 16 luxels of a block, their sets of directions, and the index of the first hit of each.
    struct GatherBatch;
    class ChannelSum;
    HitRows TraceRows(std::size_t lightmap, const RawLightmap &raw, int stride,
                      const GatherDirections &directions) const;
    void TraceBatch(const RawLightmap &raw, const std::vector<Vec3f> &origins, const GatherDirections &directions,
                    const GatherBatch &batch, HitRows &rows) const;
    const GatherDirections &DirectionsOf(const RawLightmap &raw) const { return directions_.at(RaysPerLuxel(raw)); }
    EmitterId Dithered(EmitterId emitter, const Vec3f &position, const Vec3f &normal, bool twoSided,
                       std::size_t number) const;
    int RaysPerLuxel(const RawLightmap &raw) const;

    const BounceScene &scene_;
    const FaintPatches *patches_;
    const int luxelRays_, vertexRays_;

    std::map<int, GatherDirections> directions_; // by number of rays
    bool keepAll_ = false;                       // rows_ holds all hits of all luxels
    std::vector<std::vector<Vec3f>> origins_;    // by lightmap and luxel
    std::vector<HitRows> rows_;                  // by lightmap
    std::uint64_t rays_ = 0;
};

/// Bounced light of style 0 at points in the open: uniform rays gather radiosity summed over bounces, and shadow rays
/// sample the brightest emitters. Const after construction; safe from several threads. Keeps references.
class PointGather : public IndirectLight {
  public:
    /// Default number of rays from a point, not counting shadow rays to bright emitters.
    static constexpr int kRays = 96;

    /// emission: radiosity without the part that `bright` samples. rays: number of rays from a point.
    PointGather(const BounceScene &scene, const std::vector<Vec3f> &emission, const BrightEmitters &bright, int rays)
        : scene_(scene), emission_(emission), bright_(bright), rays_(rays) {}
    int RaysPerPoint() const override { return rays_; }
    void Gather(const Vec3f &position, std::uint64_t seed, std::vector<IndirectRay> &rays) const override;

  private:
    const BounceScene &scene_;
    const std::vector<Vec3f> &emission_;
    const BrightEmitters &bright_;
    const int rays_;
};

} // namespace q3
