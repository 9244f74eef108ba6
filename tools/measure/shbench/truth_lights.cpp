// GPL-2.0-or-later. Light of one source at a place by brute force: falloff, cones, random rays to areas. It is summed
// for each normal, and as the exact SH projection, than which no grid is better.
#include "tools/measure/shbench/truth_lights.h"

#include "libs/sh/sh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3::bench {

namespace {

/// The formulas of point lights are those of Falloff and ConeFraction (light/sources/falloff.h), written again to check
/// them. No point light is stronger than at the distance kNearest, those with a polynomial kNearestPolynomial. Game
/// units.
constexpr double kNearest = 16, kNearestPolynomial = 1;
constexpr double kLinearScale = 1.0 / 8000; ///< of the photons of linear lights
constexpr double kConeRim = 32;             ///< over which a cone by radius fades, game units
/// Pieces are cut until their longest edge is under this share of their distance, at most kMaxCuts times.
constexpr double kMaxEdgeShare = 0.5;
constexpr int kMaxCuts = 14;
/// Pieces that give less are not cut. Byte scale.
constexpr double kSmallPiece = 0.002;

std::array<Vec3d, kNormals> MakeNormals() {
    std::array<Vec3d, kNormals> normals;
    std::size_t count = 0;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (x != 0 || y != 0 || z != 0)
                    normals[count++] = Normalize(Vec3d(x, y, z));
    return normals;
}

const std::array<Vec3d, kNormals> kNormalDirections = MakeNormals();

double StrongestChannel(const Light &light) {
    return std::max({std::abs(light.color.x), std::abs(light.color.y), std::abs(light.color.z)});
}

Vec3d SignedColor(const Light &light) {
    return Vec3d(light.color) * (light.negative ? -1.0 : 1.0);
}

Vec3d TintOf(const RayPacket &packet, std::size_t ray) {
    return packet.tinted ? Vec3d(packet.tint[ray]) : Vec3d{1, 1, 1};
}

} // namespace

const std::array<Vec3d, kNormals> &Normals() {
    return kNormalDirections;
}

void DirectionSum::Add(const Vec3d &d, const Vec3d &color) {
    const bool everywhere = d == Vec3d{};
    SHVector basis = everywhere ? SHVector{kSHC0} : SHBasis(d);
    for (std::size_t k = 0; k < 9; ++k)
        basis[k] *= kCosineLobe[k];
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t k = 0; k < 9; ++k)
            projection[channel][k] += color[channel] * basis[k];
    if (!forNormals)
        return;
    constexpr double kMeanCosine = 0.25; // mean of max(0, cosine) over all directions
    std::array<double, kNormals> cosines;
    for (std::size_t i = 0; i < kNormals; ++i)
        cosines[i] = everywhere ? kMeanCosine : std::max(0.0, Dot(kNormalDirections[i], d));
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t i = 0; i < kNormals; ++i)
            light[channel][i] += color[channel] * cosines[i];
}

DirectionSum &DirectionSum::operator+=(const DirectionSum &o) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t i = 0; i < kNormals; ++i)
            light[channel][i] += o.light[channel][i];
        for (std::size_t k = 0; k < 9; ++k)
            projection[channel][k] += o.projection[channel][k];
    }
    return *this;
}

namespace {

/// 1 before the start of the fade, 0 after its end, between them 1 - (10 t^3 - 15 t^4 + 6 t^5) (quintic smoothstep,
/// Perlin, 2002).
double FadeAt(double d, double start, double end) {
    if (d <= start)
        return 1;
    if (d >= end)
        return 0;
    const double t = (d - start) / (end - start);
    return 1 - t * t * t * (10 - 15 * t + 6 * t * t);
}

double CurveAt(const Light &light, double distance) {
    const Attenuation &k = light.attenuation;
    const double photons = light.photons, d = std::max(kNearest, distance);
    switch (light.curve) {
    case FalloffCurve::Linear:
        return photons * kLinearScale - d * double(light.fade);
    case FalloffCurve::Windowed: {
        const double left = 1 - std::pow(d / double(k.end), 4);
        return left > 0 ? photons / (d * d) * left * left : 0;
    }
    case FalloffCurve::Polynomial: {
        const double e = std::max(kNearestPolynomial, distance), flat = std::min(e, double(k.flatFrom));
        const double value = double(k.constant) + double(k.linear) * flat + double(k.quadratic) * flat * flat;
        return photons / value * FadeAt(e, k.fadeFrom, k.end);
    }
    case FalloffCurve::InverseSquare:
        break;
    }
    return photons / (d * d);
}

/// Share of a spotlight that its cone by angles lets through at an offset from the light, times the cosine to its axis.
double AngularShare(const Light &light, const Vec3d &away) {
    const double distance = Length(away), cosine = distance > 0 ? Dot(away, Vec3d(light.normal)) / distance : 0;
    const double inner = light.cone.cosInner, outer = light.cone.cosOuter;
    if (cosine <= outer || cosine < 0)
        return 0;
    return cosine >= inner ? cosine
                           : cosine * std::pow((cosine - outer) / (inner - outer), double(light.cone.exponent));
}

} // namespace

double PointLightAt(const Light &light, const Vec3d &p) {
    const Vec3d away = p - Vec3d(light.origin);
    const double extra = light.extraDist;
    double add = CurveAt(light, std::sqrt(Dot(away, away) + extra * extra));
    if (light.cone.byAngles)
        add *= AngularShare(light, away);
    else if (light.type == LightType::Spot) {
        const Vec3d aim(light.normal);
        const double along = Dot(away, aim), rim = double(light.radiusByDist) * along;
        const double off = Length(away - aim * along);
        if (along < 0 || off >= rim)
            return 0;
        add *= std::min(1.0, (rim - off) / kConeRim);
    }
    return std::max(0.0, add);
}

void CutAreaLight(const Light &light, const Vec3d &p, std::vector<AreaPiece> &pieces) {
    if (light.polygon.size() < 3)
        return;
    const Vec3d front = -Normalize(WindingAreaVector(light.polygon));
    const double height = Dot(front, p - Vec3d(light.polygon[0]));
    if (height == 0 || (height < 0 && !light.twoSided))
        return;
    const Vec3d lift = front * std::copysign(std::min(kEmitterGap, 0.5 * std::abs(height)), height);
    struct Part {
        std::array<Vec3d, 3> c; ///< corners
        int cuts;
    };
    std::vector<Part> stack;
    for (std::size_t i = 2; i < light.polygon.size(); ++i)
        stack.push_back({{Vec3d(light.polygon[0]), Vec3d(light.polygon[i - 1]), Vec3d(light.polygon[i])}, 0});
    while (!stack.empty()) {
        const Part part = stack.back();
        stack.pop_back();
        const double area = Length(Cross(part.c[1] - part.c[0], part.c[2] - part.c[0])) / 2;
        if (!(area > 0))
            continue;
        const double d = Length((part.c[0] + part.c[1] + part.c[2]) / 3.0 - p);
        std::size_t longest = 0;
        std::array<double, 3> edges;
        for (std::size_t i = 0; i < 3; ++i) {
            edges[i] = Length(part.c[(i + 1) % 3] - part.c[i]);
            longest = edges[i] > edges[longest] ? i : longest;
        }
        // Form factor of a small piece: area times the emitter's cosine over pi d^2, with the cosine height / d.
        const double share = d > 0 ? std::min(1.0, area * std::abs(height) / (std::numbers::pi * d * d * d)) : 1;
        const double bound = StrongestChannel(light) * double(light.radiosity) * share;
        if (edges[longest] > kMaxEdgeShare * d && part.cuts < kMaxCuts && bound > kSmallPiece) {
            const Vec3d &a = part.c[longest], &b = part.c[(longest + 1) % 3], &c = part.c[(longest + 2) % 3];
            const Vec3d middle = (a + b) / 2.0;
            stack.push_back({{a, middle, c}, part.cuts + 1});
            stack.push_back({{middle, b, c}, part.cuts + 1});
        } else
            pieces.push_back({&light, part.c, area, lift, bound});
    }
}

void PointRays::Cast(const Vec3d &target, const Vec3d &direction, const Vec3d &color, DirectionSum *sum, int *clear) {
    pending_[count_++] = {Vec3f(target), direction, color, sum, clear};
    if (count_ == kPacketSize)
        Flush();
}

void PointRays::CastToSky(const Light &sun, DirectionSum &sum) {
    RayPacket packet{};
    packet.origin.Set(0, Vec3f(p_));
    packet.direction.Set(0, -sun.normal);
    packet.distance[0] = kSunDistance;
    packet.live[0] = -1;
    scene_.TraceToSky(packet, sun.skyIndex, ShadowRules::Exact, counts_);
    if (packet.live[0] != 0)
        sum.Add(-Vec3d(sun.normal), SignedColor(sun) * TintOf(packet, 0) * double(sun.photons));
}

void PointRays::Flush() {
    if (count_ == 0)
        return;
    RayPacket packet{};
    for (std::size_t ray = 0; ray < count_; ++ray)
        packet.Aim(ray, Vec3f(p_), pending_[ray].target);
    scene_.TraceToLight(packet, ShadowRules::Exact, counts_);
    for (std::size_t ray = 0; ray < count_; ++ray) {
        if (packet.live[ray] == 0)
            continue;
        const Pending &one = pending_[ray];
        if (one.clear)
            ++*one.clear;
        if (one.sum)
            one.sum->Add(one.direction, one.color * TintOf(packet, ray));
    }
    count_ = 0;
}

int SamplePiece(const AreaPiece &piece, const Vec3d &p, int n, Random &random, PointRays &rays, DirectionSum *sum,
                int *clear) {
    // Strata of the unit square, mapped to the triangle with equal areas: (u, v) has the weights 1 - sqrt u,
    // sqrt u (1 - v) and sqrt u v of the corners (Turk, 1990).
    const int rows = std::max(1, int(std::sqrt(double(n)))), columns = (n + rows - 1) / rows;
    const Vec3d normal = Normalize(Cross(piece.corners[1] - piece.corners[0], piece.corners[2] - piece.corners[0]));
    const Vec3d color = SignedColor(*piece.light) *
                        (double(piece.light->radiosity) * piece.area / (std::numbers::pi * double(rows * columns)));
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const double root = std::sqrt((row + Unit(random)) / rows), v = (column + Unit(random)) / columns;
            const Vec3d at =
                piece.corners[0] * (1 - root) + piece.corners[1] * (root * (1 - v)) + piece.corners[2] * (root * v);
            const Vec3d way = at - p;
            const double d2 = Dot(way, way);
            const Vec3d direction = way / std::sqrt(d2);
            rays.Cast(at + piece.lift, direction, color * (std::abs(Dot(normal, direction)) / d2), sum, clear);
        }
    return rows * columns;
}

} // namespace q3::bench
