// GPL-2.0-or-later. Where the points of the SH grid are lit from.
#include "q3map2/light/grid/lit_points.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Points this near to a surface light's plane are in it. Game units.
constexpr float kOnEmitter = 1.0f / 64;

/// Whether p is on the polygon of a surface light.
bool OnEmitter(const Light &light, const Vec3f &p) {
    if (std::abs(Dot(Vec3f(light.shape.normal), p) - float(light.shape.dist)) > kOnEmitter)
        return false;
    bool left = false, right = false;
    for (std::size_t i = 0; i < light.w.size(); ++i) {
        const Vec3f &a = light.w[i], edge = light.w[(i + 1) % light.w.size()] - a;
        const float side = Dot(Cross(edge, p - a), Vec3f(light.shape.normal)), margin = kOnEmitter * Length(edge);
        left = left || side > margin, right = right || side < -margin;
    }
    return !(left && right);
}

/// Calls use(brick, points) for all bricks, on all workers.
template <typename Use> void ForBricks(const GridInputs &in, const GridBricks &bricks, const Use &use) {
    in.jobs.For(bricks.Count(), [&](std::int64_t brick, int) { use(brick, bricks.Points(brick)); });
}

} // namespace

LitPoints::LitPoints(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks)
    : layout_(layout), states_(std::size_t(layout.Count()), PointState::Exterior), clusters_(states_.size()),
      litFrom_(states_.size()) {
    ForBricks(in, bricks, [&](std::int64_t, std::span<const BrickPoint> points) {
        for (const BrickPoint &point : points) {
            const PlacedPoint placed = PlaceInOpen(in.space, point.position);
            clusters_[point.index] = litFrom_[point.index] = placed.cluster;
            states_[point.index] = placed.state;
        }
    });
    std::vector<std::vector<DisplacedPoint>> displaced(std::size_t(bricks.Count()));
    ForBricks(in, bricks, [&](std::int64_t brick, std::span<const BrickPoint> points) {
        for (const BrickPoint &point : points) {
            if (states_[point.index] == PointState::Open)
                continue;
            const PlacedPoint placed = PlaceGridPoint(in.space, layout, clusters_, point);
            states_[point.index] = placed.state;
            litFrom_[point.index] = placed.cluster;
            if (placed.cluster >= 0)
                displaced[std::size_t(brick)].push_back({point.index, placed.position});
        }
    });
    for (const auto &part : displaced)
        displaced_.insert(displaced_.end(), part.begin(), part.end());
    std::sort(displaced_.begin(), displaced_.end(),
              [](const DisplacedPoint &a, const DisplacedPoint &b) { return a.index < b.index; });
}

void LitPoints::FindOnEmitters(const std::vector<Light> &lights) {
    for (const Light &light : lights) {
        if (light.type != LightType::Area)
            continue;
        const Boundsf box = WindingBounds(light.w);
        std::array<int, 3> first{}, last{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float cell = layout_.size[axis], least = (box.mins[axis] - kOnEmitter - layout_.mins[axis]) / cell;
            const float most = (box.maxs[axis] + kOnEmitter - layout_.mins[axis]) / cell;
            const auto end = float(layout_.bounds[axis]);
            first[axis] = int(std::ceil(std::clamp(least, 0.0f, end)));
            last[axis] = int(std::floor(std::clamp(most, -1.0f, end - 1)));
        }
        for (int z = first[2]; z <= last[2]; ++z)
            for (int y = first[1]; y <= last[1]; ++y)
                for (int x = first[0]; x <= last[0]; ++x) {
                    PointState &state = states_[std::size_t(layout_.Index(x, y, z))];
                    if (state == PointState::Open && OnEmitter(light, Vec3f(layout_.Position(x, y, z))))
                        state = PointState::OnEmitter;
                }
    }
}

void LitPoints::AddReceiver(const BrickPoint &point, std::vector<ReceiverBatch> &blocks) const {
    Vec3f from = point.position;
    if (states_[point.index] != PointState::Open && states_[point.index] != PointState::OnEmitter)
        from = std::lower_bound(displaced_.begin(), displaced_.end(), point.index,
                                [](const DisplacedPoint &d, std::uint32_t i) { return d.index < i; })
                   ->position;
    BatchWithRoom(blocks).Add(from, from, litFrom_[point.index], point.index);
}

} // namespace q3
