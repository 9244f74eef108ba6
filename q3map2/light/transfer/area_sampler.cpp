// GPL-2.0-or-later. Samples of an area light from one receiver, and moments of its polygon for a batch of receivers.
#include "q3map2/light/transfer/area_sampler.h"

#include "libs/math/lane_functions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace q3 {

// ---- Moments of one polygon as the receivers of a batch see it: polygon_moments.h, laid out for SIMD ----

void MomentLanes::SeenCorner::See(Vec3f corner, const Lanes3 &receivers) {
    Vectorize([&, corner]() Q3_INLINE {
        Q3_INDEPENDENT
        for (const std::size_t i : kEachLane) {
            const double wx = double(corner.x) - double(receivers.x[i]), wy = double(corner.y) - double(receivers.y[i]),
                         wz = double(corner.z) - double(receivers.z[i]);
            const double l = std::sqrt(wx * wx + wy * wy + wz * wz), divisor = l > 0 ? l : 1;
            x[i] = wx, y[i] = wy, z[i] = wz;
            dx[i] = wx / divisor, dy[i] = wy / divisor, dz[i] = wz / divisor;
            length[i] = l;
        }
    });
}

void MomentLanes::Clear() {
    for (DoubleLanes *row : {&solidAngle, &x, &y, &z, &xx, &yy, &zz, &xy, &yz, &xz})
        row->fill(0);
}

/// AddEdge of polygon_moments.h, which has the derivation, in every lane. Multiplies `half` by the complex number whose
/// argument is half the solid angle of the triangle of normal, a and b (van Oosterom and Strackee 1983).
void MomentLanes::AddEdge(const SeenCorner &a, const SeenCorner &b, Vec3d normal, HalfSolidAngles &half) {
    Vectorize([&, normal]() Q3_INLINE {
        Q3_INDEPENDENT
        for (const std::size_t i : kEachLane) {
            const Vec3d aw{a.x[i], a.y[i], a.z[i]}, bw{b.x[i], b.y[i], b.z[i]};
            const Vec3d ad{a.dx[i], a.dy[i], a.dz[i]}, bd{b.dx[i], b.dy[i], b.dz[i]};
            const double la = a.length[i], lb = b.length[i], lengths = la * lb;
            const Vec3d across = Cross(aw, bw - aw);
            const double sine = std::sqrt(Dot(across, across)), cosine = Dot(aw, bw);
            const Vec3d outward = across * (sine > 0 ? -1 / sine : 0);
            const Vec3d acute = (ad + bd) * (sine / (lengths + cosine)), obtuse = Cross(outward, bd - ad);
            const bool isAcute = cosine > 0;
            const double arcX = isAcute ? acute.x : obtuse.x, arcY = isAcute ? acute.y : obtuse.y,
                         arcZ = isAcute ? acute.z : obtuse.z;
            const double angle = AngleOf(sine, cosine) * 0.5;
            x[i] -= outward.x * angle, y[i] -= outward.y * angle, z[i] -= outward.z * angle;
            xx[i] -= arcX * outward.x * (1.0 / 3), yy[i] -= arcY * outward.y * (1.0 / 3);
            zz[i] -= arcZ * outward.z * (1.0 / 3);
            xy[i] -= (arcX * outward.y + arcY * outward.x) * (1.0 / 6);
            yz[i] -= (arcY * outward.z + arcZ * outward.y) * (1.0 / 6);
            xz[i] -= (arcX * outward.z + arcZ * outward.x) * (1.0 / 6);
            const double real = (lengths + Dot(normal, aw) * lb + cosine + Dot(bw, normal) * la) / lengths;
            const double imaginary = Dot(normal, across) / lengths;
            const double before = half.real[i];
            half.real[i] = before * real - half.imaginary[i] * imaginary;
            half.imaginary[i] = before * imaginary + half.imaginary[i] * real;
        }
    });
}

void MomentLanes::Finish(const HalfSolidAngles &half) {
    Vectorize([&]() Q3_INLINE {
        constexpr double kPi = std::numbers::pi;
        for (const std::size_t i : kEachLane) {
            // The argument of `half` is half the solid angle, 0 to pi. If it is negative, rounding pushed it past pi
            // (to near -pi: wrapped), or the polygon is seen from behind (0).
            const double angle = 2 * AngleOf(std::abs(half.imaginary[i]), half.real[i]);
            const double wrapped = angle > kPi ? 4 * kPi - angle : 0;
            const double solid = half.imaginary[i] < 0 ? wrapped : angle;
            const double seen = solid > 0 ? 1 : 0, third = solid * (1.0 / 3);
            solidAngle[i] = seen > 0 ? solid : 0;
            x[i] = seen > 0 ? x[i] : 0, y[i] = seen > 0 ? y[i] : 0, z[i] = seen > 0 ? z[i] : 0;
            xx[i] = seen > 0 ? xx[i] + third : 0, yy[i] = seen > 0 ? yy[i] + third : 0;
            zz[i] = seen > 0 ? zz[i] + third : 0;
            xy[i] = seen > 0 ? xy[i] : 0, yz[i] = seen > 0 ? yz[i] : 0, xz[i] = seen > 0 ? xz[i] : 0;
        }
    });
}

void MomentLanes::CopyLanes(const MomentLanes &from, const LaneMask &lanes) {
    Vectorize([&]() Q3_INLINE {
        const auto copy = [&](const DoubleLanes &a, DoubleLanes &b) {
            for (const std::size_t i : kEachLane)
                b[i] = lanes[i] != 0 ? a[i] : b[i];
        };
        copy(from.solidAngle, solidAngle), copy(from.x, x), copy(from.y, y), copy(from.z, z);
        copy(from.xx, xx), copy(from.yy, yy), copy(from.zz, zz);
        copy(from.xy, xy), copy(from.yz, yz), copy(from.xz, xz);
    });
}

void MomentLanes::Measure(std::span<const Vec3f> corners, const Lanes3 &receivers, const LaneMask &lanes) {
    MomentLanes seen;
    seen.Clear();
    HalfSolidAngles half;
    half.real.fill(1), half.imaginary.fill(0);
    const Vec3d normal = PolygonAspect(corners, {}).normal;
    SeenCorner a, b;
    a.See(corners.back(), receivers);
    for (const Vec3f &corner : corners) {
        b.See(corner, receivers);
        seen.AddEdge(a, b, normal, half);
        std::swap(a, b);
    }
    seen.Finish(half);
    CopyLanes(seen, lanes);
}

void MomentLanes::Project(double scale, const LaneMask &lanes, std::array<Lanes, 9> &projections) const {
    Vectorize([&, scale]() Q3_INLINE {
        for (const std::size_t i : kEachLane) {
            const auto values =
                SHFromMoments<double>(solidAngle[i], {x[i], y[i], z[i]}, xy[i], yz[i], zz[i], xz[i], xx[i] - yy[i]);
            const auto put = [&](std::size_t k) {
                projections[k][i] = lanes[i] != 0 ? float(values[k] * scale) : projections[k][i];
            };
            put(0), put(1), put(2), put(3), put(4), put(5), put(6), put(7), put(8);
        }
    });
}

PolygonMoments MomentLanes::Of(std::size_t i) const {
    PolygonMoments m;
    m.solidAngle = solidAngle[i];
    m.first = {x[i], y[i], z[i]};
    m.xx = xx[i], m.yy = yy[i], m.zz = zz[i], m.xy = xy[i], m.yz = yz[i], m.xz = xz[i];
    return m;
}

// ---- Samples of an area light from one receiver ----

namespace {

/// Solid angles below this are rounding error.
constexpr double kNoSolidAngle = 1e-9;

/// Sixteen points of the unit square, and the triangles of the polygon that they fall in.
struct Picks {
    DoubleLanes u, v; ///< u: from 0 to the sum of the sizes of all triangles
    IntLanes triangle;

    /// Points first to first + 15 of the pattern that starts at `start`. sums: running sums of the triangles' sizes.
    template <typename T> Picks(const Sample2 &start, std::uint32_t first, const std::vector<T> &sums) {
        Spread(start, first, double(sums.back()));
        for (std::size_t i = 0; i + 1 < sums.size(); ++i)
            Advance(double(sums[i]));
    }
    /// The given points, with u from 0 to below 1.
    Picks(const Lanes &unitU, const Lanes &unitV, const std::vector<float> &sums) {
        for (const std::size_t i : kEachLane)
            u[i] = double(unitU[i]) * double(sums.back()), v[i] = double(unitV[i]), triangle[i] = 0;
        for (std::size_t i = 0; i + 1 < sums.size(); ++i)
            Advance(double(sums[i]));
    }
    /// Whether a point falls in that triangle.
    bool AnyIn(std::size_t number) const {
        return std::find(triangle.begin(), triangle.end(), std::int32_t(number)) != triangle.end();
    }

  private:
    void Spread(Sample2 start, std::uint32_t first, double sum);
    void Advance(double sum);
};

void Picks::Spread(Sample2 start, std::uint32_t first, double sum) {
    Vectorize([&, start, first, sum]() Q3_INLINE {
        for (const std::size_t i : kEachLane) {
            const double number = double(first) + double(std::int32_t(i));
            const double x = start.u + kPlasticA1 * number, y = start.v + kPlasticA2 * number;
            u[i] = (x - std::floor(x)) * sum, v[i] = y - std::floor(y);
            triangle[i] = 0;
        }
    });
}

/// Moves samples beyond the sum to the next triangle.
void Picks::Advance(double sum) {
    Vectorize([&, sum]() Q3_INLINE {
        for (const std::size_t i : kEachLane)
            triangle[i] += u[i] >= sum ? 1 : 0;
    });
}

/// One triangle of several: its number, the sum of the sizes before it, and its own size.
struct PickedTriangle {
    std::int32_t number;
    double before, size;

    template <typename T> PickedTriangle(const std::vector<T> &sums, std::size_t i) : number(std::int32_t(i)) {
        before = i == 0 ? 0 : double(sums[i - 1]);
        size = double(sums[i]) - before;
    }
    /// u as a fraction of this triangle, 0 to 1.
    double Within(double u) const { return size > 0 ? std::min(1.0, std::max(0.0, (u - before) / size)) : 0; }
};

/// Samples by solid angle in one triangle. normal, distance: the plane of the polygon relative to p.
void SampleBySolidAngle(const Picks &picks, PickedTriangle picked, SphericalTriangle triangle, Vec3f p, Vec3d normal,
                        double distance, AreaSamples &samples) {
    Vectorize([&, picked, triangle, p, normal, distance]() Q3_INLINE {
        Lanes3 &target = samples.target, &direction = samples.direction;
        Q3_INDEPENDENT
        for (const std::size_t i : kEachLane) {
            const Vec3d d = triangle.Sample({picked.Within(picks.u[i]), picks.v[i]});
            const double facing = Dot(d, normal), along = distance / facing;
            const double length = facing != 0 ? std::max(0.0, along) : 0;
            const bool ours = picks.triangle[i] == picked.number;
            direction.x[i] = ours ? float(d.x) : direction.x[i];
            direction.y[i] = ours ? float(d.y) : direction.y[i];
            direction.z[i] = ours ? float(d.z) : direction.z[i];
            target.x[i] = ours ? p.x + float(d.x * length) : target.x[i];
            target.y[i] = ours ? p.y + float(d.y * length) : target.y[i];
            target.z[i] = ours ? p.z + float(d.z * length) : target.z[i];
        }
    });
}

/// Samples by area in one triangle.
void SampleByArea(const Picks &picks, PickedTriangle picked, Vec3f a, Vec3f b, Vec3f c, Lanes3 &target) {
    Vectorize([&, picked, a, b, c]() Q3_INLINE {
        Q3_INDEPENDENT
        for (const std::size_t i : kEachLane) {
            const float root = std::sqrt(float(picked.Within(picks.u[i]))), v = float(picks.v[i]);
            const Vec3f at = a * (1 - root) + b * (root * (1 - v)) + c * (root * v);
            const bool ours = picks.triangle[i] == picked.number;
            target.x[i] = ours ? at.x : target.x[i];
            target.y[i] = ours ? at.y : target.y[i];
            target.z[i] = ours ? at.z : target.z[i];
        }
    });
}

/// Directions to samples by area and their weights, strength / d^3.
void AimByArea(Vec3f p, float strength, AreaSamples &samples) {
    Vectorize([&, p, strength]() Q3_INLINE {
        for (const std::size_t i : kEachLane) {
            const Lanes3 &target = samples.target;
            const auto [x, y, z, d] = DirectionOf(target.x[i] - p.x, target.y[i] - p.y, target.z[i] - p.z);
            const float divisor = d > 0 ? d : 1;
            samples.direction.x[i] = x, samples.direction.y[i] = y, samples.direction.z[i] = z;
            samples.weight[i] = strength / (divisor * divisor * divisor);
        }
    });
}

} // namespace

Vec3f SampleUniformArea(const Light &light, const Sample2 &s) {
    const std::vector<float> &sums = light.shape.cumulative;
    const double pick = s.u * double(light.shape.area);
    std::size_t i = 0;
    while (i + 1 < sums.size() && double(sums[i]) <= pick)
        ++i;
    const float root = std::sqrt(float(PickedTriangle(sums, i).Within(pick))), v = float(s.v);
    return light.polygon[0] * (1 - root) + light.polygon[i + 1] * (root * (1 - v)) + light.polygon[i + 2] * (root * v);
}

/// Points of the parallelogram a + u (b - a) + v (c - a).
void PointsOfParallelogram(Vec3f a, Vec3f b, Vec3f c, const Lanes &u, const Lanes &v, Lanes3 &points) {
    Vectorize([&, a, b, c]() Q3_INLINE {
        for (const std::size_t i : kEachLane)
            points.Set(i, a + (b - a) * u[i] + (c - a) * v[i]);
    });
}

/// Points in one triangle. Those of the half of the parallelogram a b c that is not in it are turned into it, which
/// keeps patterns as even as they are.
void FoldIntoTriangle(const Picks &picks, PickedTriangle picked, Vec3f a, Vec3f b, Vec3f c, Lanes3 &points) {
    Vectorize([&, picked, a, b, c]() Q3_INLINE {
        Q3_INDEPENDENT
        for (const std::size_t i : kEachLane) {
            const float u = float(picked.Within(picks.u[i])), v = float(picks.v[i]);
            const bool turned = u + v > 1;
            const Vec3f at = a + (b - a) * (turned ? 1 - u : u) + (c - a) * (turned ? 1 - v : v);
            const bool ours = picks.triangle[i] == picked.number;
            points.x[i] = ours ? at.x : points.x[i];
            points.y[i] = ours ? at.y : points.y[i];
            points.z[i] = ours ? at.z : points.z[i];
        }
    });
}

void PointsByArea(const Light &light, const Lanes &u, const Lanes &v, Lanes3 &points) {
    const Winding<float> &w = light.polygon;
    constexpr float kParallel = 1e-3f; // of the radius
    if (w.size() == 4 && Length(w[0] + w[2] - w[1] - w[3]) < kParallel * light.shape.radius)
        return PointsOfParallelogram(w[0], w[1], w[3], u, v, points);
    const std::vector<float> &sums = light.shape.cumulative;
    const Picks picks(u, v, sums);
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (picks.AnyIn(i))
            FoldIntoTriangle(picks, PickedTriangle(sums, i), w[0], w[i + 1], w[i + 2], points);
}

AreaSampler::AreaSampler(const Light &light, std::span<const Vec3f> corners, const Vec3f &p, float height,
                         std::uint64_t seed, bool near)
    : light_(light), p_(p), height_(height), start_(PlasticSample(0, seed)) {
    if (!near)
        return;
    const Vec3d a = Vec3d(corners[0]) - Vec3d(p);
    double total = 0;
    for (std::size_t i = 2; i < corners.size(); ++i) {
        triangles_.emplace_back(a, Vec3d(corners[i - 1]) - Vec3d(p), Vec3d(corners[i]) - Vec3d(p));
        cumulative_.push_back(total += triangles_.back().SolidAngle());
    }
    normal_ = light.shape.normal;
    planeDistance_ = Dot(a, normal_);
    if (!(total > kNoSolidAngle))
        triangles_.clear();
}

void AreaSampler::Sample(std::uint32_t first, AreaSamples &samples) const {
    if (!triangles_.empty()) {
        const Picks picks(start_, first, cumulative_);
        for (std::size_t i = 0; i < triangles_.size(); ++i)
            if (picks.AnyIn(i))
                SampleBySolidAngle(picks, PickedTriangle(cumulative_, i), triangles_[i], p_, normal_, planeDistance_,
                                   samples);
        samples.weight.fill(float(cumulative_.back()));
        return;
    }
    const std::vector<float> &sums = light_.shape.cumulative;
    const Picks picks(start_, first, sums);
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (picks.AnyIn(i))
            SampleByArea(picks, PickedTriangle(sums, i), light_.polygon[0], light_.polygon[i + 1],
                         light_.polygon[i + 2], samples.target);
    AimByArea(p_, height_ * light_.shape.area, samples);
}

} // namespace q3
