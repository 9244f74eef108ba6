// GPL-2.0-or-later. Curved surfaces as meshes.
#include "libs/math/patch_mesh.h"

namespace q3 {

namespace {

/// Curves up to subdivisions * 16 * 2^n game units long are halved n times, longer ones three times.
constexpr float kCurveUnit = 16;
constexpr int kMaxHalvings = 3;
constexpr int kMeshSizeLimit = 128; ///< exclusive limit of points along an axis
/// A row or column closer than this to the line through its neighbors is dropped. Game units.
constexpr float kFlat = 0.1f;
constexpr float kShortEdge = 0.125f;     ///< game units: a curve with control points this near counts as a point
constexpr float kStraightCosine = 0.99f; ///< of the angles between control points of a curve that counts as straight

} // namespace

float HalvingMeasure(const Vec3f &a, const Vec3f &b, const Vec3f &c) {
    const float ab = Length(b - a), bc = Length(c - b), ac = Length(c - a);
    if (ab < kShortEdge || bc < kShortEdge || ac < kShortEdge)
        return 0;
    const Vec3f nab = (b - a) / ab;
    if (Dot(nab, (c - b) / bc) > kStraightCosine && Dot(nab, (c - a) / ac) > kStraightCosine)
        return 0;
    constexpr float kTime = 0.875f; // see the declaration
    return ab + kTime * Length((c - b) - (b - a));
}

namespace patch {

int Halvings(float halvingMeasure, int subdivisions) {
    const float unit = kCurveUnit * float(subdivisions);
    int halvings = 0;
    while (halvings < kMaxHalvings && unit * float(1 << halvings) < halvingMeasure)
        ++halvings;
    return halvings;
}

int SpansToHalve(int size, int spans) {
    return std::clamp((kMeshSizeLimit - 1 - size) / 2, 0, spans);
}

bool NearLine(const Vec3f &p, const Vec3f &a, const Vec3f &b) {
    const Vec3f direction = Normalize(b - a);
    const Vec3f off = (p - a) - direction * Dot(p - a, direction);
    return Length(off) < kFlat;
}

} // namespace patch

} // namespace q3
