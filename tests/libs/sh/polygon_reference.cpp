// GPL-2.0-or-later. Moments of polygons by adaptive quadrature, and random polygons.
#include "tests/libs/sh/polygon_reference.h"

#include "libs/math/sampling.h"
#include "libs/math/winding.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3::test {

namespace {

using Real = long double;
using Vec = Vec3<Real>;

constexpr Real kSmall = 0.8L; ///< longest edge over distance: twelve nodes err by about 1e-17

struct Triangle {
    Vec a, b, c;
};

Real Square(const Vec &v) {
    return Dot(v, v);
}

/// Adds the Gauss sum over a piece whose corners span `volume` (six times the signed volume with the origin).
void AddPiece(const Triangle &t, Real volume, const GaussRule &gauss, Moments10 &sum) {
    for (std::size_t i = 0; i < GaussRule::kNodes; i++)
        for (std::size_t j = 0; j < GaussRule::kNodes; j++) {
            const Real u = gauss.node[i], v = gauss.node[j];
            const Vec way = t.a * (1 - u) + t.b * (u * (1 - v)) + t.c * (u * v);
            const Real inverse = 1 / std::sqrt(Square(way));
            const Vec d = way * inverse;
            const Real w = gauss.weight[i] * gauss.weight[j] * u * volume * inverse * inverse * inverse;
            const Real terms[10] = {1, d.x, d.y, d.z, d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.y * d.z, d.x * d.z};
            for (std::size_t k = 0; k < 10; k++)
                sum[k] += w * terms[k];
        }
}

/// A triangle's plane as seen from the origin.
struct Frame {
    Vec normal; ///< unit, away from the origin
    Real height = 0;
};

/// Adds the integral over the triangle of the foot of the origin in the plane and the piece a to b of an edge: in polar
/// coordinates around the foot the radial integrals are elementary, the one along the edge is a Gauss sum.
void AddSector(const Frame &frame, const Vec &a, const Vec &b, const GaussRule &gauss, Moments10 &sum) {
    const Real h = frame.height;
    const Vec edge = b - a;
    const Real turn = Dot(frame.normal, Cross(a, edge)); // r^2 dphi = turn dt
    for (std::size_t i = 0; i < GaussRule::kNodes; i++) {
        const Vec at = a + edge * gauss.node[i], out = at - frame.normal * Dot(at, frame.normal);
        const Real r2 = Square(out), rho2 = r2 + h * h, rho = std::sqrt(rho2), x2 = r2 / (h * h), x = std::sqrt(x2);
        const Real w = gauss.weight[i] * turn;
        // Integral over the radius of h / rho^3 r dr times 1; cos; cos^2; sin; sin cos; sin^2, divided by r^2 and by
        // one r for each sin. cos and sin are those of the angle with the normal.
        const Real one = 1 / (rho * (rho + h)), cos1 = 1 / (2 * rho2);
        const Real cos2 = (rho2 + rho * h + h * h) / (3 * rho2 * rho * (rho + h));
        const Real sin1 = x < 0.01L ? (2.0L / 3 - x2 * (4.0L / 5 - x2 * (6.0L / 7 - x2 * (8.0L / 9 - x2 * 10 / 11)))) /
                                          (2 * h * h * h)
                                    : (std::atan(x) - x / (1 + x2)) / (2 * r2 * std::sqrt(r2));
        const Real sinCos = 1 / (3 * rho2 * rho), sin2 = (2 * rho + h) / (3 * rho2 * rho * (rho + h) * (rho + h));
        const Vec &n = frame.normal;
        const Vec first = n * cos1 + out * sin1;
        const auto second = [&](std::size_t p, std::size_t q) {
            return n[p] * n[q] * cos2 + (n[p] * out[q] + n[q] * out[p]) * sinCos + out[p] * out[q] * sin2;
        };
        const Real terms[10] = {one,          first.x,      first.y,      first.z,      second(0, 0),
                                second(1, 1), second(2, 2), second(0, 1), second(1, 2), second(0, 2)};
        for (std::size_t k = 0; k < 10; k++)
            sum[k] += w * terms[k];
    }
}

/// An edge in pieces that are small against their distance.
void AddEdge(const Frame &frame, const Vec &a, const Vec &b, const GaussRule &gauss, Moments10 &sum) {
    constexpr int kDeepest = 100;
    struct Piece {
        Real from, to;
        int depth;
    };
    const Vec edge = b - a;
    const Real length2 = Square(edge);
    if (length2 == 0)
        return;
    const Real foot = -Dot(a, edge) / length2, line2 = Square(a + edge * foot);
    std::vector<Piece> stack{{0, 1, 0}};
    while (!stack.empty()) {
        const auto [from, to, depth] = stack.back();
        stack.pop_back();
        const Real off = std::max({from - foot, foot - to, Real(0)}), size = to - from;
        if (size * size * length2 <= kSmall * kSmall * (line2 + off * off * length2) || depth >= kDeepest) {
            AddSector(frame, a + edge * from, a + edge * to, gauss, sum);
            continue;
        }
        const Real middle = (from + to) / 2;
        stack.push_back({from, middle, depth + 1});
        stack.push_back({middle, to, depth + 1});
    }
}

/// The triangle a, a + ab, a + ac. Edges come unrounded: far away, small triangles are all rounding otherwise.
void AddTriangle(const Vec &a, const Vec &ab, const Vec &ac, const GaussRule &gauss, Moments10 &sum) {
    const Triangle t{a, a + ab, a + ac};
    const Vec area = Cross(ab, ac);
    const Real volume = Dot(t.a, area);
    if (volume == 0)
        return;
    const Real longest = std::max({Square(t.b - t.a), Square(t.c - t.b), Square(t.a - t.c)});
    const Real nearest = std::sqrt(Square(t.a)) - std::sqrt(longest);
    if (nearest > 0 && longest <= kSmall * kSmall * nearest * nearest) {
        AddPiece(t, volume, gauss, sum);
        return;
    }
    const Real length = std::sqrt(Square(area)), side = volume > 0 ? 1 : -1;
    const Frame frame{area * (side / length), std::abs(volume) / length};
    Moments10 part{};
    AddEdge(frame, t.a, t.b, gauss, part);
    AddEdge(frame, t.b, t.c, gauss, part);
    AddEdge(frame, t.c, t.a, gauss, part);
    for (std::size_t k = 0; k < 10; k++)
        sum[k] += part[k];
}

/// Numbers of one random case.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : seed_(seed) {}
    double Unit() { return UnitFromHash(HashIndex(seed_ * 64 + count_++)); }
    double Between(double low, double high) { return low + (high - low) * Unit(); }
    /// Even in the logarithm.
    double Scale(double low, double high) { return low * std::pow(high / low, Unit()); }
    Vec3d Direction() {
        const double z = Between(-1, 1), angle = 2 * std::numbers::pi * Unit(), r = std::sqrt(1 - z * z);
        return {r * std::cos(angle), r * std::sin(angle), z};
    }

  private:
    std::uint64_t seed_, count_ = 0;
};

std::vector<Vec3f> RandomCorners(const Vec3d &origin, double size, double width, Dice &dice) {
    const Vec3d normal = dice.Direction(), right = Normalize(Cross(normal, dice.Direction())),
                up = Cross(normal, right);
    std::vector<double> angles(3 + std::size_t(dice.Unit() * 6));
    for (double &angle : angles)
        angle = 2 * std::numbers::pi * dice.Unit();
    std::sort(angles.rbegin(), angles.rend());
    std::vector<Vec3f> corners;
    for (const double angle : angles)
        corners.push_back(Vec3f(origin + (right * std::cos(angle) + up * (width * std::sin(angle))) * (0.5 * size)));
    return corners;
}

/// Every triangle of the fan turns the same way.
bool IsConvex(const std::vector<Vec3f> &corners) {
    const Winding<float> whole(corners.begin(), corners.end());
    const Vec3d normal = Normalize(WindingAreaVector(whole));
    for (std::size_t i = 0; i < corners.size(); i++) {
        const Vec3d a(corners[i]), b(corners[(i + 1) % corners.size()]), c(corners[(i + 2) % corners.size()]);
        if (!(Dot(Cross(b - a, c - b), normal) > 0.99 * Length(Cross(b - a, c - b))))
            return false;
    }
    return true;
}

Vec3d Placed(PolygonView view, const std::vector<Vec3d> &corners, const Vec3d &center, double size, const Vec3d &normal,
             Dice &dice) {
    const std::size_t n = corners.size(), first = std::size_t(dice.Unit() * double(n)) % n;
    const Vec3d &a = corners[first], &b = corners[(first + 1) % n];
    const double distance = dice.Scale(1e-3, 1e5), share = dice.Scale(1e-6, 1), t = dice.Unit();
    const Vec3d direction = dice.Direction(), inPlane = Normalize(Cross(normal, dice.Direction()));
    switch (view) {
    case PolygonView::Grazing:
        return center + inPlane * distance + normal * (distance * share);
    case PolygonView::NearEdge:
        return a + (b - a) * t + direction * (size * share);
    case PolygonView::NearCorner:
        return a + direction * (size * share);
    case PolygonView::OverInside:
        return center + (a + (b - a) * t - center) * dice.Unit() + normal * (size * share);
    default:
        return center + direction * distance;
    }
}

} // namespace

GaussRule::GaussRule() {
    for (int i = 0; i < kNodes; i++) {
        Real x = std::cos(std::numbers::pi_v<Real> * (Real(i) + 0.75L) / (kNodes + 0.5L)), slope = 0;
        for (int step = 0; step < 20; step++) {
            Real before = 1, value = x;
            for (int n = 2; n <= kNodes; n++) {
                const Real next = (Real(2 * n - 1) * x * value - Real(n - 1) * before) / Real(n);
                before = value, value = next;
            }
            slope = kNodes * (x * value - before) / (x * x - 1);
            x -= value / slope;
        }
        node[std::size_t(i)] = (1 + x) / 2;
        weight[std::size_t(i)] = 1 / ((1 - x * x) * slope * slope);
    }
}

Moments10 ReferenceMoments(std::span<const Vec3f> corners, const Vec3d &p, const GaussRule &gauss) {
    Moments10 sum{};
    const Vec first(corners[0]);
    for (std::size_t i = 2; i < corners.size(); i++)
        AddTriangle(first - Vec(p), Vec(corners[i - 1]) - first, Vec(corners[i]) - first, gauss, sum);
    return sum;
}

Moments10 ToArray(const PolygonMoments &m) {
    return {m.solidAngle, m.first.x, m.first.y, m.first.z, m.xx, m.yy, m.zz, m.xy, m.yz, m.xz};
}

PolygonCase RandomPolygon(std::uint64_t index) {
    Dice dice(index);
    PolygonCase result;
    result.view = PolygonView(index % std::uint64_t(PolygonView::Count));
    const bool away = result.view == PolygonView::FarFromOrigin || dice.Unit() < 0.25;
    double size = 0;
    // Rounding to float can leave polygons that are not convex any more, often without any area: those do not count.
    do {
        size = dice.Scale(1e-3, 1e4);
        const Vec3d origin = away ? Vec3d{65536, dice.Between(-65536, 65536), -65536} : Vec3d{};
        result.corners = RandomCorners(origin, size, dice.Scale(1e-6, 1), dice);
    } while (!IsConvex(result.corners));
    std::vector<Vec3d> stored;
    Vec3d center;
    for (const Vec3f &corner : result.corners) {
        stored.push_back(Vec3d(corner));
        center += stored.back() / double(result.corners.size());
    }
    // Rounding to float turns and bends the polygon. From between its triangles it would have no side.
    const Vec3d area = WindingAreaVector(stored);
    const Vec3d front = -Normalize(area);
    result.p = Placed(result.view, stored, center, size, front, dice);
    double bend = 0;
    for (const Vec3d &corner : stored)
        bend = std::max(bend, std::abs(Dot(corner - center, front)));
    const double height = Dot(result.p - center, front);
    if (std::abs(height) < 8 * bend)
        result.p += front * (height < 0 ? -8 * bend : 8 * bend);
    if (height < 0)
        std::reverse(result.corners.begin(), result.corners.end());
    return result;
}

} // namespace q3::test
