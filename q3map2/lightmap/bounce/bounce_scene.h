// GPL-2.0-or-later. What rays that gather bounced light meet.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <memory>
#include <span>

namespace q3 {

/// Number of something that sends light on: a texel of a raw lightmap, or a vertex of a surface without one.
using EmitterId = std::uint32_t;
inline constexpr EmitterId kNoEmitter = ~EmitterId(0);

/// Numbers texels of all raw lightmaps (without supersampling), then all draw vertices.
class EmitterNumbers {
  public:
    explicit EmitterNumbers(const SurfaceLight &surfaces);
    EmitterId Texel(std::size_t lightmap, int x, int y) const {
        return first_[lightmap] + EmitterId(y * widths_[lightmap] + x);
    }
    EmitterId FirstOf(std::size_t lightmap) const { return first_[lightmap]; }
    EmitterId Vertex(int vertex) const { return first_.back() + EmitterId(vertex); }
    std::size_t Count() const { return count_; }

  private:
    std::vector<EmitterId> first_; // by raw lightmap; the last is that of vertices
    std::vector<int> widths_;
    std::size_t count_ = 0;
};

/// A corner of a face of a draw surface.
struct FaceCorner {
    Vec3f xyz, normal;
    std::array<float, 2> st{}, luxel{};
    int vertex = 0; ///< draw vertex that it is nearest to
};
using Face = std::vector<FaceCorner>;

/// Whether bounced light meets the surface at all.
bool MeetsBounces(const SurfaceInputs &in, std::size_t surface);
/// Triangles of a surface, quads of a curve; clockwise seen from the front.
std::vector<Face> FacesOf(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t surface);
/// What a white texture of this surface sends on of a luxel's light, over the byte scale.
float BounceScale(const SurfaceInputs &in, std::size_t surface);

/// Visible surfaces in Embree. Solids are not in it: their visible sides are surfaces at the same receivers, and what
/// has none is hidden by the backs of others. Const after construction; safe from several threads.
class BounceScene {
  public:
    BounceScene(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterNumbers &emitters);
    ~BounceScene();

    /// The emitter whose front each live ray meets first; kNoEmitter where that sends no light on, or nothing is met.
    /// coherent: the rays go much the same way, which is faster.
    std::array<EmitterId, kPacketSize> FirstEmitters(const RayPacket &rays, bool coherent) const;
    /// Share of the light that each emitter sends on, in channels, over 1 only by -bouncescale: colour of the texture
    /// there times the scales. Zero: sends nothing.
    const std::vector<Vec3f> &Reflectance() const { return reflectance_; }

  private:
    struct State;
    void FindReflectance(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterNumbers &emitters);

    std::unique_ptr<State> state_;
    std::vector<Vec3f> reflectance_;
};

} // namespace q3
