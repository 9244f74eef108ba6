// GPL-2.0-or-later. Area lights as the SH grid sees them.
#include "q3map2/light/light_area.h"

#include "libs/math/low_discrepancy.h"
#include "libs/math/spherical_triangle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Points nearer than this to an emitter's plane get nothing from it. Game units.
constexpr float kPlaneClearance = 1.0f / 64;
/// Lights that give less than this are judged by one ray; brighter ones by their corners. Byte scale.
constexpr float kFaint = 1.0f / 4;
/// Under this the share of the first rays that arrive is good enough for a light that is partly hidden. Byte scale.
constexpr float kRefine = 0.5f;
/// From twice this on, neighbours that see another share make it worth a closer look too; from kBright on, samples of
/// the inside look for what is smaller than a straight shadow edge. Byte scale.
constexpr float kBright = 2;
constexpr int kInnerProbes = 2;
/// A straight shadow edge that crosses a convex emitter hides or shows one of its corners, so each gets a ray, moved
/// inward by this share.
constexpr float kCornerInset = 0.01f;
/// Moments are approximated where that errs by less than this. Byte scale.
constexpr float kMomentError = 1.0f / 256;
/// Rays for a partly hidden light: as many as keep the expected error of the estimate under kTolerance, within these
/// limits.
constexpr int kMinRefined = 16, kMaxRefined = 1024;
/// Byte scale: an eighth of what a screen can show.
constexpr double kTolerance = 0.125;
/// Rays end this far in front of the emitter, which is itself in the scene, or half way to its plane. Game units.
constexpr float kEmitterGap = 0.125f;
/// Under this solid angle sampling by area is as good and avoids cancellation; pbrt-v4 uses the same limit.
constexpr double kMinSphericalTriangle = 3e-4;

struct AreaSample {
    Vec3f target;    ///< where the ray ends: just in front of the emitter
    Vec3d direction; ///< unit, to the emitter itself
};

/// Samples a polygon, seen from a point, in proportion to solid angle.
class SolidAngleSampler {
  public:
    SolidAngleSampler(std::span<const Vec3f> corners, const Vec3f &p, const Vec3f &lift) : p_(p), lift_(lift) {
        for (const Vec3f &corner : corners)
            corners_.push_back(Vec3d(corner) - p_);
        for (std::size_t i = 2; i < corners_.size(); ++i) {
            total_ += std::max(0.0, TriangleSolidAngle(corners_[0], corners_[i - 1], corners_[i]));
            cumulative_.push_back(total_);
        }
        normal_ = Normalize(WindingAreaVector(corners_));
    }

    double SolidAngle() const { return total_; }

    AreaSample Sample(Sample2 s) const {
        const double pick = s.u * total_;
        std::size_t i = 0;
        while (i + 1 < cumulative_.size() && cumulative_[i] <= pick)
            ++i;
        const double start = i == 0 ? 0 : cumulative_[i - 1], angle = cumulative_[i] - start;
        s.u = angle > 0 ? std::clamp((pick - start) / angle, 0.0, 1.0) : 0;
        const Vec3d &a = corners_[0], &b = corners_[i + 1], &c = corners_[i + 2];
        if (angle > kMinSphericalTriangle) {
            const Vec3d direction = SampleSphericalTriangle(a, b, c, s);
            const double facing = Dot(direction, normal_);
            const double distance = facing != 0 ? Dot(a, normal_) / facing : 0;
            return {Vec3f(p_ + direction * distance) + lift_, direction};
        }
        const double root = std::sqrt(s.u);
        const Vec3d offset = a * (1 - root) + b * (root * (1 - s.v)) + c * (root * s.v);
        return {Vec3f(p_ + offset) + lift_, Normalize(offset)};
    }

  private:
    Vec3d p_;
    Vec3f lift_;
    Winding<double> corners_;
    std::vector<double> cumulative_;
    double total_ = 0;
    Vec3d normal_;
};

void SetRay(RayPacket &rays, std::size_t i, const Vec3f &origin, const Vec3f &target) {
    const Vec3f way = target - origin;
    rays.origin[i] = origin;
    rays.distance[i] = Length(way);
    rays.direction[i] = rays.distance[i] > 0 ? way / rays.distance[i] : Vec3f{0, 0, 1};
    rays.blocked[i] = false;
}

/// From the plane of the light towards the point, so that rays end before the emitter.
Vec3f LiftOf(const Light &light, const AreaView &view) {
    const float lift = std::min(kEmitterGap, 0.5f * view.height);
    return Vec3f(light.shape.normal) * (view.fromBehind ? -lift : lift);
}

int RefinedRays(float facing) {
    // A stratified pattern's error falls about as n^-0.75, from half of the light at one ray.
    const double n = std::pow(0.5 * double(facing) / kTolerance, 1 / 0.75);
    const int packets = int(std::ceil(std::clamp(n, double(kMinRefined), double(kMaxRefined)) / kPacketSize));
    return packets * kPacketSize;
}

} // namespace

void AreaRays::Add(LightPlace &place, std::uint32_t number, float weight) {
    const AreaShape &shape = light_.shape;
    const float s = float(Dot(shape.normal, Vec3d(place.position)) - shape.dist);
    AreaView view{place.position, place.rayOrigin, number, place.index, s < 0, std::abs(s), weight};
    if (view.height < kPlaneClearance || (view.fromBehind && !light_.twoSided) || light_.w.size() < 3 ||
        !light_.bounds.Contains(place.position)) {
        ++counts_.skippedFacing;
        return;
    }
    const Vec3f toCenter = shape.center - place.position;
    const float d2 = Dot(toCenter, toCenter), d = std::sqrt(d2);
    // As a point with a cosine the light errs by about the square of its size over its distance.
    const float relativeError = d > 0 ? shape.radius * shape.radius / d2 : 1;
    if (relativeError < 0.25f) {
        view.facing = light_.add * shape.area * view.height / (d2 * d * std::numbers::pi_v<float>);
        if (!settings_.exactAreas && view.facing * relativeError < kMomentError)
            view.method = AreaView::Method::Point;
        else if (!settings_.exactAreas && view.facing * relativeError * relativeError < kMomentError)
            view.method = AreaView::Method::Quadrature;
    } else
        view.facing = light_.add * float(Length(Moments(view).first) / std::numbers::pi);
    if (view.facing <= 0 || (light_.fast && view.facing <= light_.tolerance)) {
        ++counts_.skippedFacing;
        return;
    }
    if (!TakeFaint(settings_.faint, view.facing, place, view.weight)) {
        ++counts_.skippedFaint;
        return;
    }
    views_[count_++] = view;
    if (count_ == kMaxViews)
        Flush();
}

std::span<const Vec3f> AreaRays::Corners(const AreaView &view) const {
    return view.fromBehind ? light_.shape.back : light_.w;
}

PolygonMoments AreaRays::Moments(const AreaView &view) const {
    return MomentsOfPolygon(Corners(view), Vec3d(view.position));
}

int AreaRays::Probes(const AreaView &view) const {
    if (Under(view, kFaint))
        return 1;
    return int(light_.w.size()) + (Under(view, kBright) ? 0 : kInnerProbes);
}

Vec3f AreaRays::ProbeTarget(const AreaView &view, int probe) const {
    const AreaShape &shape = light_.shape;
    const Vec3f lift = LiftOf(light_, view);
    const int corners = Under(view, kFaint) ? 0 : int(light_.w.size());
    if (probe < corners) {
        const Vec3f &corner = light_.w[std::size_t(probe)];
        return corner + (shape.center - corner) * kCornerInset + lift;
    }
    Sample2 s = PlasticSample(std::uint32_t(probe - corners), view.seed);
    const double pick = s.u * double(shape.area);
    std::size_t i = 0;
    while (i + 1 < shape.cumulative.size() && double(shape.cumulative[i]) <= pick)
        ++i;
    const double start = i == 0 ? 0 : double(shape.cumulative[i - 1]), area = double(shape.cumulative[i]) - start;
    const float root = float(std::sqrt(area > 0 ? std::clamp((pick - start) / area, 0.0, 1.0) : 0)), v = float(s.v);
    return light_.w[0] * (1 - root) + light_.w[i + 1] * (root * (1 - v)) + light_.w[i + 2] * (root * v) + lift;
}

void AreaRays::FirstLook() {
    int most = 0;
    for (std::size_t i = 0; i < count_; ++i) {
        looks_[i] = {};
        most = std::max(most, Probes(views_[i]));
    }
    RayPacket rays;
    std::array<std::size_t, kPacketSize> of{};
    const auto trace = [&] {
        scene_.TraceToLight(rays, ShadowRules::Exact, counts_);
        for (std::size_t ray = 0; ray < std::size_t(rays.count); ++ray) {
            Look &look = looks_[of[ray]];
            ++look.cast;
            if (!rays.blocked[ray]) {
                ++look.clear;
                look.tint += rays.tint[ray];
            }
        }
        rays.count = 0;
    };
    for (int probe = 0; probe < most; ++probe)
        for (std::size_t i = 0; i < count_; ++i) {
            if (probe >= Probes(views_[i]))
                continue;
            const auto ray = std::size_t(rays.count++);
            of[ray] = i;
            SetRay(rays, ray, views_[i].rayOrigin, ProbeTarget(views_[i], probe));
            if (rays.count == kPacketSize)
                trace();
        }
    if (rays.count > 0)
        trace();
}

bool AreaRays::NeedsMore(std::size_t i) const {
    const Look &look = looks_[i];
    if (Under(views_[i], kRefine))
        return false;
    if (!look.Whole() && !look.Hidden())
        return true;
    if (Under(views_[i], 2 * kRefine))
        return false;
    constexpr std::size_t kNeighbours = kPacketSize / 2;
    const std::size_t first = i < kNeighbours ? 0 : i - kNeighbours, last = std::min(count_, i + kNeighbours + 1);
    for (std::size_t j = first; j < last; ++j)
        if (looks_[j].Whole() != look.Whole() || looks_[j].Hidden() != look.Hidden())
            return true;
    return false;
}

/// Corrects the closed form by what many rays see: with V and W the traced moments of the visible part and of the whole
/// and f the visible share, f * exact + V - f * W is exact where nothing or everything is hidden.
void AreaRays::Refine(const AreaView &view) {
    const int n = RefinedRays(view.facing);
    const SolidAngleSampler sampler(Corners(view), view.position, LiftOf(light_, view));
    const double weight = sampler.SolidAngle() / n;
    ShVector visible{}, whole{};
    Vec3d tint;
    int clear = 0;
    ++counts_.refined;
    for (int first = 0; first < n; first += kPacketSize) {
        RayPacket rays;
        rays.count = kPacketSize;
        std::array<Vec3d, kPacketSize> directions;
        for (std::size_t i = 0; i < std::size_t(kPacketSize); ++i) {
            const AreaSample sample = sampler.Sample(PlasticSample(std::uint32_t(first) + std::uint32_t(i), view.seed));
            directions[i] = sample.direction;
            SetRay(rays, i, view.rayOrigin, sample.target);
        }
        scene_.TraceToLight(rays, ShadowRules::Exact, counts_);
        for (std::size_t i = 0; i < std::size_t(kPacketSize); ++i) {
            const ShVector basis = ShBasis(directions[i]);
            for (std::size_t k = 0; k < 9; ++k) {
                whole[k] += basis[k] * weight;
                visible[k] += rays.blocked[i] ? 0 : basis[k] * weight;
            }
            if (!rays.blocked[i]) {
                ++clear;
                tint += Vec3d(rays.tint[i]);
            }
        }
    }
    if (clear == 0)
        return;
    const double share = double(clear) / n;
    const PolygonMoments moments = Moments(view);
    ShVector projection = moments.Projection();
    for (std::size_t k = 0; k < 9; ++k)
        projection[k] = share * projection[k] + visible[k] - share * whole[k];
    Arrive(view, projection, moments.solidAngle, Vec3f(tint / double(clear)));
}

void AreaRays::Arrive(const AreaView &view, const ShVector &projection, double solidAngle, const Vec3f &tint) {
    const double scale = double(light_.add) / std::numbers::pi;
    Arrival arrival;
    arrival.place = view.place;
    arrival.weight = view.weight;
    arrival.add = float(scale * solidAngle);
    arrival.direction = Normalize(light_.shape.center - view.position);
    arrival.visible = tint;
    for (std::size_t k = 0; k < 9; ++k)
        arrival.moments[k] = float(projection[k] * scale * (settings_.radiance ? 1 : kCosineLobe[k]));
    if (arrival.add > 0)
        arrivals_.push_back(arrival);
}

void AreaRays::ArriveWhole(const AreaView &view, const Vec3f &tint) {
    if (view.method == AreaView::Method::ClosedForm) {
        const PolygonMoments moments = Moments(view);
        Arrive(view, moments.Projection(), moments.solidAngle, tint);
        return;
    }
    if (view.method == AreaView::Method::Quadrature) {
        ArriveByQuadrature(view, tint);
        return;
    }
    const Vec3f direction = Normalize(light_.shape.center - view.position);
    const double solidAngle = double(view.facing) * std::numbers::pi / double(light_.add);
    ShVector projection = ShBasis(Vec3d(direction));
    for (double &value : projection)
        value *= solidAngle;
    Arrive(view, projection, solidAngle, tint);
}

/// Three interior points a triangle, exact for quadratic integrands: errs by the fourth power of size over distance.
void AreaRays::ArriveByQuadrature(const AreaView &view, const Vec3f &tint) {
    const Winding<float> &w = light_.w;
    const AreaShape &shape = light_.shape;
    std::array<float, 9> projection{};
    float solidAngle = 0, before = 0;
    for (std::size_t i = 2; i < w.size(); ++i) {
        const float triangle = (shape.cumulative[i - 2] - before) / 3;
        before = shape.cumulative[i - 2];
        const Vec3f sum = w[0] + w[i - 1] + w[i];
        for (const Vec3f &corner : {w[0], w[i - 1], w[i]}) {
            const Vec3f way = sum / 6 + corner * 0.5f - view.position;
            const float d2 = Dot(way, way), d = std::sqrt(d2);
            const float weight = triangle * view.height / (d2 * d);
            const std::array<float, 9> basis = ShBasis(way / d);
            solidAngle += weight;
            for (std::size_t k = 0; k < 9; ++k)
                projection[k] += weight * basis[k];
        }
    }
    ShVector total;
    std::copy(projection.begin(), projection.end(), total.begin());
    Arrive(view, total, double(solidAngle), tint);
}

void AreaRays::Flush() {
    if (count_ == 0)
        return;
    FirstLook();
    for (std::size_t i = 0; i < count_; ++i) {
        if (NeedsMore(i))
            Refine(views_[i]);
        else if (!looks_[i].Hidden())
            ArriveWhole(views_[i], looks_[i].tint / float(looks_[i].cast));
    }
    count_ = 0;
}

} // namespace q3
