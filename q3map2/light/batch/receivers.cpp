// GPL-2.0-or-later. What is lit together: neighboring receivers, the light that arrives at them, and packets of their
// rays.
#include "q3map2/light/batch/receivers.h"

namespace q3 {

void LaneClusters::Add(std::size_t lane, int cluster) {
    std::size_t i = 0;
    while (i < count && number[i] != cluster)
        ++i;
    if (i == count)
        number[count++] = cluster;
    lanes[i] |= 1u << lane;
}

void ReceiverBatch::Add(const Vec3f &at, const Vec3f &raysFrom, int clusterAt, std::uint32_t indexAt) {
    position.Set(count, at);
    rayOrigin.Set(count, raysFrom);
    clusters.Add(count, clusterAt);
    index[count] = indexAt;
    wanted[count] = -1;
    ++count;
}

void SurfaceReceiverBatch::Add(const Vec3f &at, const Vec3f &normalAt, int clusterAt) {
    normal.Set(count, normalAt);
    ReceiverBatch::Add(at, at, clusterAt, 0);
}

} // namespace q3
