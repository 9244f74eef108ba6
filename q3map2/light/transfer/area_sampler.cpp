// GPL-2.0-or-later. Samples of an area light from one receiver.
#include "q3map2/light/transfer/area_sampler.h"

#include <algorithm>
#include <cmath>

namespace q3 {

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
    bool Any(std::size_t number) const {
        return std::find(triangle.begin(), triangle.end(), std::int32_t(number)) != triangle.end();
    }

  private:
    void Spread(Sample2 start, std::uint32_t first, double sum);
    void Advance(double sum);
};

Q3_VECTOR void Picks::Spread(Sample2 start, std::uint32_t first, double sum) {
    for (const std::size_t i : kEachLane) {
        const double number = double(first) + double(std::int32_t(i));
        const double x = start.u + kPlasticA1 * number, y = start.v + kPlasticA2 * number;
        u[i] = (x - std::floor(x)) * sum, v[i] = y - std::floor(y);
        triangle[i] = 0;
    }
}

/// Moves samples beyond the sum to the next triangle.
Q3_VECTOR void Picks::Advance(double sum) {
    for (const std::size_t i : kEachLane)
        triangle[i] += u[i] >= sum ? 1 : 0;
}

/// One triangle of several: its number, the sum of the sizes before it, and its own size.
struct PickedTriangle {
    std::int32_t number;
    double before, size;

    template <typename T> PickedTriangle(const std::vector<T> &sums, std::size_t i) : number(std::int32_t(i)) {
        before = i == 0 ? 0 : double(sums[i - 1]);
        size = double(sums[i]) - before;
    }
    /// u as a share of this triangle, 0 to 1.
    double Within(double u) const { return size > 0 ? std::min(1.0, std::max(0.0, (u - before) / size)) : 0; }
};

/// Samples by solid angle in one triangle. normal, distance: the plane of the polygon relative to p.
Q3_VECTOR void SampleNear(const Picks &picks, PickedTriangle picked, SphericalTriangle triangle, Vec3f p, Vec3d normal,
                          double distance, AreaSamples &samples) {
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
}

/// Samples by area in one triangle.
Q3_VECTOR void SampleByArea(const Picks &picks, PickedTriangle picked, Vec3f a, Vec3f b, Vec3f c, Lanes3 &target) {
    Q3_INDEPENDENT
    for (const std::size_t i : kEachLane) {
        const float root = std::sqrt(float(picked.Within(picks.u[i]))), v = float(picks.v[i]);
        const Vec3f at = a * (1 - root) + b * (root * (1 - v)) + c * (root * v);
        const bool ours = picks.triangle[i] == picked.number;
        target.x[i] = ours ? at.x : target.x[i];
        target.y[i] = ours ? at.y : target.y[i];
        target.z[i] = ours ? at.z : target.z[i];
    }
}

/// Directions to samples by area and their weights, strength / d^3.
Q3_VECTOR void AimByArea(Vec3f p, float strength, AreaSamples &samples) {
    for (const std::size_t i : kEachLane) {
        const Lanes3 &target = samples.target;
        const auto [x, y, z, d] = DirectionOf(target.x[i] - p.x, target.y[i] - p.y, target.z[i] - p.z);
        const float divisor = d > 0 ? d : 1;
        samples.direction.x[i] = x, samples.direction.y[i] = y, samples.direction.z[i] = z;
        samples.weight[i] = strength / (divisor * divisor * divisor);
    }
}

} // namespace

Vec3f SampleUniformArea(const Light &light, const Sample2 &s) {
    const std::vector<float> &sums = light.shape.cumulative;
    const double pick = s.u * double(light.shape.area);
    std::size_t i = 0;
    while (i + 1 < sums.size() && double(sums[i]) <= pick)
        ++i;
    const float root = std::sqrt(float(PickedTriangle(sums, i).Within(pick))), v = float(s.v);
    return light.w[0] * (1 - root) + light.w[i + 1] * (root * (1 - v)) + light.w[i + 2] * (root * v);
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

void AreaSampler::Take(std::uint32_t first, AreaSamples &samples) const {
    if (!triangles_.empty()) {
        const Picks picks(start_, first, cumulative_);
        for (std::size_t i = 0; i < triangles_.size(); ++i)
            if (picks.Any(i))
                SampleNear(picks, PickedTriangle(cumulative_, i), triangles_[i], p_, normal_, planeDistance_, samples);
        samples.weight.fill(float(cumulative_.back()));
        return;
    }
    const std::vector<float> &sums = light_.shape.cumulative;
    const Picks picks(start_, first, sums);
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (picks.Any(i))
            SampleByArea(picks, PickedTriangle(sums, i), light_.w[0], light_.w[i + 1], light_.w[i + 2], samples.target);
    AimByArea(p_, height_ * light_.shape.area, samples);
}

} // namespace q3
