// GPL-2.0-or-later. Points of a triangle, uniform in solid angle.
#pragma once

#include "libs/math/low_discrepancy.h"
#include "libs/math/vec.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

/// A unit direction uniform over the solid angle of the triangle a, b, c (seen from the origin) for sample s.
/// Arvo, Stratified Sampling of Spherical Triangles, 1995. Meant for solid angles over about 3e-4 sr; below, rounding spoils it.
inline Vec3d SampleSphericalTriangle(const Vec3d &a, const Vec3d &b, const Vec3d &c, const Sample2 &s) {
    const Vec3d va = Normalize(a), vb = Normalize(b), vc = Normalize(c);
    const Vec3d nab = Normalize(Cross(va, vb)), nbc = Normalize(Cross(vb, vc)), nca = Normalize(Cross(vc, va));
    const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
    const double alpha = angle(-Dot(nca, nab)), beta = angle(-Dot(nab, nbc)), gamma = angle(-Dot(nbc, nca));
    const double area = alpha + beta + gamma - std::numbers::pi;
    const double cosC = Dot(va, vb);
    const double subArea = s.u * area;
    const double sinD = std::sin(subArea - alpha), cosD = std::cos(subArea - alpha);
    const double sinA = std::sin(alpha), cosA = std::cos(alpha);
    const double u = cosD - cosA, v = sinD + sinA * cosC;
    const double denominator = (v * sinD + u * cosD) * sinA;
    const double q =
        std::abs(denominator) < 1e-300 ? 1 : std::clamp(((v * cosD - u * sinD) * cosA - v) / denominator, -1.0, 1.0);
    const Vec3d side = Normalize(vc - va * Dot(vc, va));
    const Vec3d onArc = va * q + side * std::sqrt(std::max(0.0, 1 - q * q));
    const double z = 1 - s.v * (1 - Dot(onArc, vb));
    const Vec3d up = Normalize(onArc - vb * Dot(onArc, vb));
    return Normalize(vb * z + up * std::sqrt(std::max(0.0, 1 - z * z)));
}

} // namespace q3
