// GPL-2.0-or-later. What rays see.
#pragma once

#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/light/light_options.h"
#include "q3map2/light/surface_table.h"

#include <array>
#include <cstdint>
#include <memory>

namespace q3 {

/// Rays that are traced together: from neighbouring points toward one light.
inline constexpr int kPacketSize = 16;

/// Whose shadow rules count.
enum class ShadowRules {
    LegacyGrid, ///< as the established program: surfaces (and skies) nearer than a radius and all patches are ignored
    Exact       ///< everything that casts shadows does
};

/// One packet. Rays that start with blocked = true are left out.
struct RayPacket {
    int count = 0;
    std::array<Vec3f, kPacketSize> origin, direction; ///< unit directions
    std::array<float, kPacketSize> distance;          ///< game units; to the light
    std::array<bool, kPacketSize> blocked{};          ///< in: skip; out: no light arrives
    std::array<Vec3f, kPacketSize> tint; ///< out: what coloured surfaces on the way let through, 1 1 1 usually
};

/// Rays cast so far, for statistics; one per worker.
struct RayCounts {
    std::uint64_t rays = 0;
};

/// All shadow casters of a map. Const after construction; tracing is safe from several threads.
class LightScene {
  public:
    /// legacyIgnoreRadius: game units, ShadowRules::LegacyGrid. The Bsp and the table are only read here.
    LightScene(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, float legacyIgnoreRadius);
    ~LightScene();

    /// Point, spot and area lights: blocked by solids and by surfaces.
    void TraceToLight(RayPacket &packet, ShadowRules rules, RayCounts &counts) const;
    /// Suns: light arrives only where the first thing on the way is a sky, of that number unless -1.
    void TraceToSky(RayPacket &packet, int skyIndex, ShadowRules rules, RayCounts &counts) const;
    /// Distance to the first blocker up to packet.distance, into packet.distance; skies count as open. For floodlight.
    void TraceDistance(RayPacket &packet, float ignoreRadius, RayCounts &counts) const;

    std::size_t TriangleCount() const;
    bool HasSky() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3
