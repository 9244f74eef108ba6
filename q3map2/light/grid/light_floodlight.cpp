// GPL-2.0-or-later. Floodlight: cheap light from wherever the surroundings are open.
#include "q3map2/light/grid/light_floodlight.h"

#include "q3map2/light/batch/hemisphere_rings.h"
#include "q3map2/light/batch/ray_batcher.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr float kIgnoreNear = 1.5f; ///< surfaces nearer than this do not count. Game units

} // namespace

std::vector<Vec3f> FloodDirections(bool lowQuality) {
    return HemisphereRings(kFloodElevations, lowQuality ? kRingAzimuths / 2 : kRingAzimuths);
}

float FloodShare(const LightScene &scene, const Vec3f &p, float up, float distance, std::span<const Vec3f> directions,
                 RayCounts &counts) {
    double sum = 0;
    auto rays = MakeRayBatcher<char>([&](RayPacket &packet, std::span<const char> tags) {
        scene.TraceDistance(packet, kIgnoreNear, counts);
        for (std::size_t i = 0; i < tags.size(); ++i)
            sum += double(std::min(1.0f, packet.distance[i] / distance));
    });
    for (const Vec3f &d : directions) // up = -1: half a turn about the y axis
        rays.Add({}, p, {d.x * up, d.y, d.z * up}, distance);
    rays.Flush();
    return float(sum / double(directions.size()));
}

} // namespace q3
