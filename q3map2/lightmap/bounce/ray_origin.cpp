// GPL-2.0-or-later. From where the rays of luxels start.
#include "q3map2/lightmap/bounce/ray_origin.h"

#include <utility>

namespace q3 {

namespace {

/// Ray origins with a solid this near are moved aside. Game units.
constexpr float kSolidMargin = 0.25f;

} // namespace

Vec3f ClearOrigin(const BspSpace &space, const RawLightmap &raw, std::size_t luxel, const GatherFrame &frame) {
    const Vec3f margin{kSolidMargin, kSolidMargin, kSolidMargin}, position = raw.positions[luxel];
    const auto clear = [&](const Vec3f &p) { return !space.AnySolid(p - margin, p + margin); };
    if (clear(position))
        return position;
    const float half = raw.actualSampleSize / float(2 * raw.super);
    const Vec3f u = raw.hasVectors ? raw.step[0] * 0.5f : frame.right * half;
    const Vec3f v = raw.hasVectors ? raw.step[1] * 0.5f : frame.up * half;
    for (const auto &[x, y] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}) {
        const Vec3f aside = position + u * float(x) + v * float(y);
        if (clear(aside))
            return aside;
    }
    return position;
}

} // namespace q3
