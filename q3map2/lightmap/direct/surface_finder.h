// GPL-2.0-or-later. Finds the drawn surface at a place, and its luxels there.
#pragma once

#include "q3map2/light/batch/ray_packet.h"
#include "q3map2/lightmap/raw/surface_faces.h"

#include <array>
#include <memory>

namespace q3 {

/// Up to four luxels of a raw lightmap that stand for a place between them, with weights that add up to 1.
struct LuxelTap {
    std::uint32_t lightmap = 0;
    std::array<std::uint32_t, 4> luxels{}; ///< of the super grid
    std::array<float, 4> weights{};        ///< 0: the luxel is not mapped

    /// Blend of `values`, which has an entry for each luxel of the super grid.
    Vec3f Of(const std::vector<Vec3f> &values) const {
        Vec3f sum;
        for (std::size_t i = 0; i < luxels.size(); ++i)
            if (weights[i] > 0)
                sum += values[luxels[i]] * weights[i];
        return sum;
    }
};

/// Where a ray meets the front of a drawn surface.
struct SurfacePlace {
    int surface = -1;  ///< -1: no surface, or the back of one
    int lightmap = -1; ///< -1: it is lit at its vertices
    Vec3f position, normal;
    std::array<float, 2> luxel{}; ///< coordinates in the super grid of its raw lightmap
};

/// Drawn surfaces as two Embree scenes, opaque and translucent ones, so that a decal does not hide the wall below it.
/// Const after construction; safe from several threads.
class SurfaceFinder {
  public:
    /// Keeps references.
    SurfaceFinder(const SurfaceInputs &in, const SurfaceLight &surfaces);
    ~SurfaceFinder();

    using Places = std::array<SurfacePlace, kPacketSize>;
    /// First hits of the live rays with surfaces that are as translucent as asked for.
    Places FirstHits(const RayPacket &rays, bool translucent) const;
    /// Clears the live lanes of rays that meet an opaque surface, from either side.
    void TraceOccluded(RayPacket &rays) const;
    bool IsTranslucent(int surface) const;
    /// Whether both surfaces belong to the same inline model, or to the world.
    bool MoveTogether(int a, int b) const { return models_[std::size_t(a)] == models_[std::size_t(b)]; }
    /// The luxels around a place, by bilinear weights over those that are mapped. False: none is.
    bool FindTap(const SurfacePlace &place, LuxelTap &tap) const;

  private:
    struct State;
    void FindModels();

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    std::vector<int> models_;                      // by draw surface
    std::array<std::unique_ptr<State>, 2> states_; // opaque, translucent
};

} // namespace q3
