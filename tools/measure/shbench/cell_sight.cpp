// GPL-2.0-or-later. What a position and the grid points around it see of each light.
#include "tools/measure/shbench/cell_sight.h"

#include "libs/math/sampling.h"
#include "libs/sh/polygon_moments.h"
#include "tools/measure/shbench/truth_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace q3::bench {

namespace {

/// No more rays are cast to an area light of which each receiver saw all or nothing by this many.
constexpr int kFirstRays = 4;

/// L2 projection of light from unit direction d, convolved with the cosine.
SHVector FromDirection(const Vec3d &d, double light) {
    SHVector projection = SHBasis(d);
    for (std::size_t k = 0; k < 9; ++k)
        projection[k] *= kCosineLobe[k] * light;
    return projection;
}

/// Point of the triangle that is nearest to p.
Vec3d NearestOnTriangle(const Vec3d &p, const Vec3d &a, const Vec3d &b, const Vec3d &c) {
    const Vec3d normal = Normalize(Cross(b - a, c - a));
    const std::array<Vec3d, 3> corners = {a, b, c};
    Vec3d nearest = p - normal * Dot(p - a, normal);
    bool inside = true;
    double least = std::numeric_limits<double>::infinity();
    Vec3d onEdge = a;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d &from = corners[i], edge = corners[(i + 1) % 3] - from;
        inside = inside && Dot(Cross(edge, nearest - from), normal) >= 0;
        const double length2 = Dot(edge, edge);
        const double share = length2 > 0 ? std::clamp(Dot(p - from, edge) / length2, 0.0, 1.0) : 0;
        const Vec3d at = from + edge * share;
        if (Length(p - at) < least)
            least = Length(p - at), onEdge = at;
    }
    return inside ? nearest : onEdge;
}

/// Point `sample` of the polygon: 0 is its center, the others are spread evenly over its area.
Vec3f PointOn(const Light &light, int sample) {
    const Winding<float> &w = light.polygon;
    if (sample == 0)
        return light.shape.center;
    double total = 0;
    for (std::size_t i = 2; i < w.size(); ++i)
        total += Length(Cross(Vec3d(w[i - 1] - w[0]), Vec3d(w[i] - w[0])));
    // u chooses the triangle by area; what is left of it and v are a uniform point of the triangle, see SamplePiece.
    const Sample2 at = PlasticSample(std::uint32_t(sample), 1);
    double left = at.u * total;
    for (std::size_t i = 2; i < w.size(); ++i) {
        const Vec3d a(w[0]), b(w[i - 1]), c(w[i]);
        const double area = Length(Cross(b - a, c - a));
        if (left > area && i + 1 < w.size()) {
            left -= area;
            continue;
        }
        const double root = area > 0 ? std::sqrt(std::clamp(left / area, 0.0, 1.0)) : 0;
        return Vec3f(a * (1 - root) + b * (root * (1 - at.v)) + c * (root * at.v));
    }
    return light.shape.center;
}

/// Signed distance from the plane of an area light, above 0 in front of it.
double HeightOver(const Light &light, const Vec3f &p) {
    return Dot(light.shape.normal, Vec3d(p)) - light.shape.dist;
}

/// Whether each receiver saw either all rays or none.
bool AllOrNothing(const CellSight::Shares &sums, int rays) {
    return std::all_of(sums.begin(), sums.end(), [&](const Vec3d &sum) {
        return sum == Vec3d{} || sum == Vec3d{1, 1, 1} * double(rays);
    });
}

} // namespace

SHVector UnshadowedLight(const Light &light, const Vec3d &p) {
    if (light.type == LightType::Sun)
        return FromDirection(-Vec3d(light.normal), double(light.photons));
    if (light.type != LightType::Area) {
        const Vec3d way = Vec3d(light.origin) - p;
        const double add = PointLightAt(light, p);
        return add > 0 && Length(way) > 0 ? FromDirection(Normalize(way), add) : SHVector{};
    }
    SHVector projection = MomentsOfPolygon(light.polygon, p).Projection();
    if (light.twoSided && projection[0] == 0)
        projection = MomentsOfPolygon(light.shape.back, p).Projection();
    for (std::size_t k = 0; k < 9; ++k)
        projection[k] *= kCosineLobe[k] * double(light.radiosity) / std::numbers::pi;
    return projection;
}

bool Reaches(const Light &light, const Vec3f &p) {
    if (light.type == LightType::Sun)
        return true;
    if (light.type != LightType::Area)
        return PointLightAt(light, Vec3d(p)) > 0;
    const double height = HeightOver(light, p);
    return height > 0 || (height < 0 && light.twoSided);
}

double CellsToLight(const Light &light, const Vec3f &p, const Vec3f &cell) {
    if (light.type == LightType::Sun)
        return std::numeric_limits<double>::infinity();
    const auto inCells = [&](const Vec3f &way) {
        return Vec3d(double(way.x) / double(cell.x), double(way.y) / double(cell.y), double(way.z) / double(cell.z));
    };
    if (light.type != LightType::Area)
        return Length(inCells(light.origin - p));
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 2; i < light.polygon.size(); ++i)
        least = std::min(least,
                         Length(NearestOnTriangle({}, inCells(light.polygon[0] - p), inCells(light.polygon[i - 1] - p),
                                                  inCells(light.polygon[i] - p))));
    return least;
}

CellSight::CellSight(const BenchMap &map, const GridLayout &layout, const Vec3f &position) : map_(map) {
    std::array<std::array<int, 2>, 3> ends{};
    std::array<double, 3> shares{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at = (double(position[axis]) - double(layout.mins[axis])) / double(layout.size[axis]);
        const double least = std::floor(at);
        shares[axis] = at - least;
        for (int end = 0; end < 2; ++end)
            ends[axis][std::size_t(end)] = int(std::clamp(least + end, 0.0, double(layout.bounds[axis] - 1)));
    }
    for (std::size_t corner = 0; corner < kCorners; ++corner) {
        const std::array<std::size_t, 3> upper = {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
        const Float3 at = layout.Position(ends[0][upper[0]], ends[1][upper[1]], ends[2][upper[2]]);
        receivers_[corner] = {at[0], at[1], at[2]};
        weights_[corner] = 1;
        for (std::size_t axis = 0; axis < 3; ++axis)
            weights_[corner] *= upper[axis] ? shares[axis] : 1 - shares[axis];
    }
    receivers_[kSelf] = position;
    SetWeights();
}

void CellSight::SetWeights() {
    RayPacket packet{};
    for (std::size_t corner = 0; corner < kCorners; ++corner)
        if (weights_[corner] > 0 && map_.space.ClusterAt(receivers_[corner], 0) >= 0)
            packet.Aim(corner, receivers_[corner], receivers_[kSelf]);
    RayCounts counts;
    map_.scene.TraceToLight(packet, ShadowRules::Exact, counts);
    double sum = 0;
    for (std::size_t corner = 0; corner < kCorners; ++corner) {
        const bool hidden = weights_[corner] > 0 && packet.live[corner] == 0;
        anyHidden_ = anyHidden_ || hidden;
        if (hidden)
            weights_[corner] = 0;
        sum += weights_[corner];
    }
    for (double &weight : weights_)
        weight = sum > 0 ? weight / sum : 0;
}

void CellSight::AddRay(const Light &light, const Vec3f &target, Shares &sums) const {
    RayPacket packet{};
    for (std::size_t i = 0; i < receivers_.size(); ++i) {
        if ((i != kSelf && weights_[i] == 0) || !Reaches(light, receivers_[i]))
            continue;
        Vec3d end(target);
        if (light.type == LightType::Area) {
            const double height = HeightOver(light, receivers_[i]);
            end += light.shape.normal * std::copysign(std::min(kEmitterGap, std::abs(height) / 2), height);
        }
        packet.Aim(i, receivers_[i], Vec3f(end));
        if (light.type == LightType::Sun)
            packet.direction.Set(i, -light.normal), packet.distance[i] = kSunDistance;
    }
    RayCounts counts;
    if (light.type == LightType::Sun)
        map_.scene.TraceToSky(packet, light.skyIndex, ShadowRules::Exact, counts);
    else
        map_.scene.TraceToLight(packet, ShadowRules::Exact, counts);
    for (std::size_t i = 0; i < receivers_.size(); ++i)
        if (packet.live[i] != 0)
            sums[i] += packet.tinted ? Vec3d(packet.tint[i]) : Vec3d{1, 1, 1};
}

CellSight::Shares CellSight::Seen(const Light &light, int samples) const {
    Shares shares{};
    const bool area = light.type == LightType::Area;
    int ray = 0;
    while (ray < (area ? samples : 1)) {
        AddRay(light, area ? PointOn(light, ray++) : light.origin, shares);
        if (!area || (ray == kFirstRays && AllOrNothing(shares, ray)))
            break;
    }
    for (Vec3d &share : shares)
        share = share / double(std::max(ray, 1));
    for (std::size_t corner = 0; corner < kCorners; ++corner)
        if (weights_[corner] > 0 && !Reaches(light, receivers_[corner]))
            shares[corner] = shares[kSelf];
    return shares;
}

} // namespace q3::bench
