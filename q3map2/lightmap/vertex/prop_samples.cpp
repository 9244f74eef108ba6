// GPL-2.0-or-later. Where the vertices of static props are lit.
#include "q3map2/lightmap/vertex/prop_samples.h"

#include "q3map2/light/scene/open_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace q3 {

namespace {

/// Samples lie this far off the surface. Game units.
constexpr float kPropLift = 1.0f / 8;
/// Samples are not farther than this from their vertex. Game units.
constexpr float kPropSampleReach = 8;
/// A vertex has at least this many samples, the same number on each of its triangles.
constexpr std::size_t kPropSamples = 6;
/// Points that were buried are lit from this far into the open. Game units.
constexpr float kPropWayOut = 1;
/// Bisections that find where a segment leaves a solid.
constexpr int kPropBisections = 20;

/// Samples on one triangle for a vertex with that many triangles, as a grid of columns and rows.
std::array<int, 2> SampleGrid(std::size_t triangles) {
    if (triangles >= kPropSamples)
        return {1, 1};
    return triangles > 2 ? std::array{2, 1} : triangles == 2 ? std::array{3, 1} : std::array{3, 2};
}

/// The area nearest to corner a of a triangle: a, the middles of its edges, and the centroid, shrunk toward a.
struct CornerArea {
    Vec3f a, toB, toC, toCenter;
    float area;

    CornerArea(const Vec3f &corner, const Vec3f &b, const Vec3f &c) : a(corner) {
        toB = (b - a) * 0.5f, toC = (c - a) * 0.5f, toCenter = ((b - a) + (c - a)) / 3;
        const float reach = std::max({Length(toB), Length(toC), Length(toCenter)});
        const float scale = reach > kPropSampleReach ? kPropSampleReach / reach : 1;
        toB *= scale, toC *= scale, toCenter *= scale;
        area = Length(Cross(toB, toC)) * 2 / 3; // unless shrunk, a third of the triangle's |AB x AC| / 2
    }
    /// Bilinear; u and v from 0 to 1.
    Vec3f At(float u, float v) const { return a + toB * (u * (1 - v)) + toC * (v * (1 - u)) + toCenter * (u * v); }
};

} // namespace

PropPlace PropSampler::Place(std::size_t number) const {
    const PropModel::Point &point = prop_.model->points[number];
    const Vec3f normal(prop_.transform.Normal(Vec3d(point.normal)));
    const Vec3f lift = (prop_.ignoresNormals ? Vec3f{0, 0, 1} : normal) * kPropLift;
    return {Vec3f(prop_.transform.Point(Vec3d(point.xyz))) + lift, normal};
}

void PropSampler::Samples(std::size_t number, std::vector<PropSample> &samples) const {
    samples.clear();
    const PropModel &model = *prop_.model;
    const std::uint32_t first = model.firstCorner[number], end = model.firstCorner[number + 1];
    const PropPlace placed = Place(number);
    const auto grid = SampleGrid(end - first);
    const auto world = [&](std::uint32_t corner) { return Vec3f(prop_.transform.Point(Vec3d(model.corners[corner]))); };
    for (std::uint32_t i = first; i < end; ++i) {
        const std::uint32_t corner = model.cornersAt[i], triangle = corner / 3 * 3;
        const Vec3f at = world(corner);
        const CornerArea area(at, world(triangle + (corner + 1) % 3), world(triangle + (corner + 2) % 3));
        for (int x = 0; x < grid[0] && area.area > 0; ++x)
            for (int y = 0; y < grid[1]; ++y) {
                const Vec3f p = area.At((float(x) + 0.5f) / float(grid[0]), (float(y) + 0.5f) / float(grid[1]));
                if (const Vec3f lifted = p + (placed.position - at);
                    IsOpen(lifted) && StateOfSegment(space_, placed.position, lifted) != SegmentState::Blocked)
                    samples.push_back({lifted, area.area / float(grid[0] * grid[1])});
            }
    }
    if (samples.empty() && IsOpen(placed.position))
        samples.push_back({placed.position, 1});
}

bool PropSampler::IsOpen(const Vec3f &p) const {
    return space_.ClusterAt(p, -kPropSolidDepth) >= 0;
}

Vec3f PropSampler::OpenPlaceToward(const Vec3f &buried, const Vec3f &open) const {
    Vec3f inside = buried, outside = open;
    for (int step = 0; step < kPropBisections; ++step) {
        const Vec3f middle = (inside + outside) * 0.5f;
        (IsOpen(middle) ? outside : inside) = middle;
    }
    const Vec3f rest = open - outside;
    const float length = Length(rest);
    const Vec3f farther = length > kPropWayOut ? outside + rest * (kPropWayOut / length) : open;
    return IsOpen(farther) ? farther : outside;
}

NearestPoints::NearestPoints(std::vector<Entry> entries) : entries_(std::move(entries)) {
    std::stable_sort(entries_.begin(), entries_.end(),
                     [](const Entry &a, const Entry &b) { return a.position.x < b.position.x; });
}

Vec3f NearestPoints::Find(const Vec3f &position, const Vec3f &normal) const {
    float best = std::numeric_limits<float>::max();
    Vec3f found;
    const auto consider = [&](const Entry &entry) {
        if (std::abs(entry.position.x - position.x) >= best)
            return false; // and so are all farther on
        const float distance = Length(entry.position - position) * (2 - Dot(entry.normal, normal));
        if (distance < best)
            best = distance, found = entry.position;
        return true;
    };
    const auto middle = std::lower_bound(entries_.begin(), entries_.end(), position.x,
                                         [](const Entry &entry, float x) { return entry.position.x < x; });
    auto up = middle, down = middle;
    for (bool more = true; more;) {
        more = up != entries_.end() && consider(*up);
        if (more)
            ++up;
        if (down != entries_.begin() && consider(*std::prev(down)))
            --down, more = true;
    }
    return found;
}

} // namespace q3
