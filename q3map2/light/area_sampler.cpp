// GPL-2.0-or-later. Samples of a polygon as a place sees it.
#include "q3map2/light/area_sampler.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Sums under this, of solid angles, come from rounding only.
constexpr double kNoSolidAngle = 1e-9;

/// The interval of rising sums that holds `pick`, and `pick` within it from 0 to 1.
template <typename T> std::size_t FindInterval(const std::vector<T> &sums, double &pick) {
    std::size_t i = 0;
    while (i + 1 < sums.size() && double(sums[i]) <= pick)
        ++i;
    const double start = i == 0 ? 0 : double(sums[i - 1]), width = double(sums[i]) - start;
    pick = width > 0 ? std::clamp((pick - start) / width, 0.0, 1.0) : 0;
    return i;
}

double Fraction(double x) {
    return x - double(std::int64_t(x));
}

} // namespace

Vec3f PointByArea(const Light &light, const Sample2 &s) {
    double pick = s.u * double(light.shape.area);
    const std::size_t i = FindInterval(light.shape.cumulative, pick);
    const float root = std::sqrt(float(pick)), v = float(s.v);
    return light.w[0] * (1 - root) + light.w[i + 1] * (root * (1 - v)) + light.w[i + 2] * (root * v);
}

AreaSampler::AreaSampler(const Light &light, std::span<const Vec3f> corners, const Vec3f &p, float height,
                         std::uint64_t seed, bool near)
    : light_(light), p_(p), height_(height) {
    const Sample2 start = PlasticSample(0, seed);
    startU_ = start.u, startV_ = start.v;
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

Sample2 AreaSampler::Pattern(std::uint32_t i) const {
    return {Fraction(startU_ + kPlasticA1 * double(i)), Fraction(startV_ + kPlasticA2 * double(i))};
}

void AreaSampler::Take(std::uint32_t first, AreaSamples &samples) const {
    if (!triangles_.empty())
        return TakeNear(first, samples);
    for (std::size_t i = 0; i < kPacketSize; ++i)
        samples.target.Set(i, PointByArea(light_, Pattern(first + std::uint32_t(i))));
    const float strength = height_ * light_.shape.area;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = samples.target.x[i] - p_.x, y = samples.target.y[i] - p_.y, z = samples.target.z[i] - p_.z;
        const float d = std::sqrt(x * x + y * y + z * z), divisor = d > 0 ? d : 1;
        samples.direction.x[i] = x / divisor, samples.direction.y[i] = y / divisor,
        samples.direction.z[i] = z / divisor;
        samples.weight[i] = strength / (divisor * divisor * divisor);
    }
}

void AreaSampler::TakeNear(std::uint32_t first, AreaSamples &samples) const {
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const Sample2 s = Pattern(first + std::uint32_t(i));
        double pick = s.u * cumulative_.back();
        const std::size_t triangle = FindInterval(cumulative_, pick);
        const Vec3d direction = triangles_[triangle].Sample({pick, s.v});
        const double facing = Dot(direction, normal_);
        const double distance = facing != 0 ? std::max(0.0, planeDistance_ / facing) : 0;
        samples.target.Set(i, p_ + Vec3f(direction * distance));
        samples.direction.Set(i, Vec3f(direction));
    }
    samples.weight.fill(float(cumulative_.back()));
}

} // namespace q3
