// GPL-2.0-or-later. AreaShape of area lights, from their polygon.
#include "q3map2/light/sources/light_sources.h"

#include <algorithm>

namespace q3 {

void Light::SetShape() {
    shape = {};
    shape.back.assign(w.rbegin(), w.rend());
    shape.normal = -Normalize(WindingAreaVector(w));
    if (w.size() < 3)
        return;
    shape.dist = Dot(shape.normal, Vec3d(w.front()));
    Vec3d center;
    for (std::size_t i = 2; i < w.size(); ++i) {
        const float triangle = float(WindingArea(Winding<float>{w[0], w[i - 1], w[i]}));
        shape.area += triangle;
        shape.cumulative.push_back(shape.area);
        center += Vec3d(w[0] + w[i - 1] + w[i]) * (double(triangle) / 3);
    }
    shape.center = shape.area > 0 ? Vec3f(center / double(shape.area)) : w.front();
    for (const Vec3f &p : w)
        shape.radius = std::max(shape.radius, Length(p - shape.center));
}

} // namespace q3
