// GPL-2.0-or-later. Curved surfaces as meshes.
#include "q3map2/light/light_patch.h"

#include <algorithm>
#include <utility>

namespace q3 {

namespace {

/// Curves up to 8 * 16 * 2^n game units long are halved n times, longer ones three times.
constexpr float kCurveUnit = 8 * 16;
constexpr int kMaxHalvings = 3;
constexpr int kMaxMeshSize = 128;
/// A row or column closer than this to the line through its neighbours is dropped. Game units.
constexpr float kFlat = 0.1f;

} // namespace

namespace patch {

int Halvings(float longestCurve) {
    int halvings = 0;
    while (halvings < kMaxHalvings && kCurveUnit * float(1 << halvings) < longestCurve)
        ++halvings;
    return halvings;
}

int SpansToHalve(int size, int spans) {
    return std::clamp((kMaxMeshSize - 1 - size) / 2 + 1, 0, spans);
}

bool NearLine(const Vec3f &p, const Vec3f &a, const Vec3f &b) {
    const Vec3f direction = Normalize(b - a);
    const Vec3f off = (p - a) - direction * Dot(p - a, direction);
    return Length(off) < kFlat;
}

} // namespace patch

Mesh TessellatePatch(const Bsp &bsp, const bspDrawSurface_t &surface, float longestCurve) {
    Mesh mesh{surface.patchWidth, surface.patchHeight, {}};
    for (int i = 0; i < surface.numVerts; ++i) {
        const bspDrawVert_t &v = bsp.drawVerts[std::size_t(surface.firstVert + i)];
        mesh.verts.push_back({Vec3f(v.xyz), Vec3f(v.normal), v.st});
    }
    return Tessellated(std::move(mesh), longestCurve);
}

float LongestCurve(const Bsp &bsp, const bspDrawSurface_t &surface) {
    const auto control = [&](int x, int y) {
        return Vec3f(bsp.drawVerts[std::size_t(surface.firstVert + y * surface.patchWidth + x)].xyz);
    };
    const auto curve = [](const Vec3f &a, const Vec3f &b, const Vec3f &c) {
        const float ab = Length(b - a), bc = Length(c - b), ac = Length(c - a);
        if (ab < 0.125f || bc < 0.125f || ac < 0.125f)
            return 0.0f;
        const Vec3f nab = (b - a) / ab;
        if (Dot(nab, (c - b) / bc) > 0.99f && Dot(nab, (c - a) / ac) > 0.99f)
            return 0.0f;
        return ab + 0.875f * Length((c - b) - (b - a));
    };
    float longest = 0;
    for (int y = 0; y + 2 < surface.patchHeight; y += 2)
        for (int x = 0; x + 2 < surface.patchWidth; x += 2) {
            longest = std::max(longest, curve(control(x, y), control(x + 1, y), control(x + 2, y)));
            longest = std::max(longest, curve(control(x, y), control(x, y + 1), control(x, y + 2)));
        }
    return longest;
}

} // namespace q3
