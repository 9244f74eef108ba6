// GPL-2.0-or-later. Collects what the picture of a grid's errors shows.
#include "tools/measure/shbench/error_top_view.h"

#include <algorithm>
#include <cmath>

namespace q3::bench {

namespace {

/// Picture units.
constexpr double kViewLeft = 24, kViewTop = 102, kMaxWidth = 616, kMaxHeight = 790;
constexpr int kCellsPerUnit = 2;      ///< of the ground, per picture unit: one per PNG pixel
constexpr float kMargin = 48;         ///< of the area around the positions, game units
constexpr int kMaxLevels = 24;        ///< heights at which open space is searched for
constexpr float kLevelSpacing = 32;   ///< least spacing of these heights, game units
constexpr float kFloorStep = 20;      ///< floors that differ by more get an edge; over a stair step, game units
constexpr double kScaledShare = 0.98; ///< of the positions: within the color scale

/// Rounds up to 1, 1.5, 2, 3, 5 or 7 times a power of ten.
double RoundUp(double value) {
    if (!(value > 0))
        return 1;
    const double power = std::pow(10, std::floor(std::log10(value)));
    for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.0})
        if (step * power >= value)
            return step * power;
    return 10 * power;
}

double EndOfScale(const std::vector<TopViewDot> &dots) {
    std::vector<double> errors;
    for (const TopViewDot &dot : dots)
        errors.push_back(dot.error);
    if (errors.empty())
        return 1;
    const auto at = std::min(errors.size() - 1, std::size_t(kScaledShare * double(errors.size())));
    std::nth_element(errors.begin(), errors.begin() + std::ptrdiff_t(at), errors.end());
    return RoundUp(errors[at]);
}

Boundsf AreaOf(const std::vector<TopViewDot> &dots) {
    Boundsf area;
    for (const TopViewDot &dot : dots)
        area.Add(dot.position);
    if (area.Empty())
        area.Add(Vec3f{});
    const Vec3f margin{kMargin, kMargin, 0};
    return {area.mins - margin, area.maxs + margin};
}

/// Of the worst positions, or of all positions without rings.
float MedianHeight(const ErrorTopView &view) {
    std::vector<float> heights;
    for (const ErrorTopView::Ring &ring : view.rings)
        heights.push_back(view.dots[ring.dot].position.z);
    if (heights.empty())
        for (const TopViewDot &dot : view.dots)
            heights.push_back(dot.position.z);
    if (heights.empty())
        return 0;
    const auto middle = heights.begin() + std::ptrdiff_t((heights.size() - 1) / 2);
    std::nth_element(heights.begin(), middle, heights.end());
    return *middle;
}

/// Probes of the ground in a row of the view, from west to east.
class GroundRow {
  public:
    GroundRow(const BenchMap &map, const ErrorTopView &view, int row)
        : map_(map), view_(view), heights_(std::size_t(view.columns), kNone) {
        y_ = view.area.maxs.y - (view.area.maxs.y - view.area.mins.y) * (float(row) + 0.5f) / float(view.rows);
        for (int column = 0; column < view.columns; ++column)
            heights_[std::size_t(column)] = OpenHeight(X(column));
    }
    TopViewGround Ground(int column) const {
        const float height = heights_[std::size_t(column)];
        return height == kNone          ? TopViewGround::Solid
               : height == view_.height ? TopViewGround::Open
                                        : TopViewGround::Elsewhere;
    }
    /// Heights of the first surfaces below the probes; kNone in solid.
    std::vector<float> Floors() const {
        std::vector<float> floors(heights_.size(), kNone);
        for (std::size_t first = 0; first < heights_.size(); first += kPacketSize) {
            RayPacket packet{};
            const std::size_t count = std::min(kPacketSize, heights_.size() - first);
            for (std::size_t i = 0; i < count; ++i) {
                const Vec3f from{X(int(first + i)), y_, heights_[first + i]};
                if (from.z != kNone)
                    packet.Aim(i, from, from - Vec3f{0, 0, kDeep});
            }
            RayCounts counts;
            const LaneMask traced = packet.live;
            map_.scene.TraceDistance(packet, 0, counts);
            for (std::size_t i = 0; i < count; ++i)
                if (traced[i] != 0)
                    floors[first + i] = heights_[first + i] - packet.distance[i];
        }
        return floors;
    }
    static constexpr float kNone = -1e9f; ///< a height far below any map

  private:
    static constexpr float kDeep = 65536; // length of the rays down, game units
    float X(int column) const {
        const float width = view_.area.maxs.x - view_.area.mins.x;
        return view_.area.mins.x + width * (float(column) + 0.5f) / float(view_.columns);
    }
    /// The view's height if it is open there, else the highest open height in the range of the positions.
    float OpenHeight(float x) const {
        if (map_.space.ClusterAt({x, y_, view_.height}, 0) >= 0)
            return view_.height;
        const float range = view_.area.maxs.z - view_.area.mins.z;
        const int levels = std::clamp(int(range / kLevelSpacing) + 1, 1, kMaxLevels);
        for (int level = 0; level < levels; ++level) {
            const float z = view_.area.maxs.z - range * (float(level) + 0.5f) / float(levels);
            if (map_.space.ClusterAt({x, y_, z}, 0) >= 0)
                return z;
        }
        return kNone;
    }

    const BenchMap &map_;
    const ErrorTopView &view_;
    float y_ = 0;
    std::vector<float> heights_;
};

/// Marks neighboring cells whose floors differ by more than kFloorStep. `floors`: of the whole view.
void MarkSteps(const std::vector<float> &floors, ErrorTopView &view) {
    const auto columns = std::size_t(view.columns);
    const auto differ = [&](std::size_t a, std::size_t b) {
        return view.ground[a] != TopViewGround::Solid && view.ground[b] != TopViewGround::Solid &&
               std::abs(floors[a] - floors[b]) > kFloorStep;
    };
    std::vector<std::size_t> steps;
    for (std::size_t at = 0; at < view.ground.size(); ++at)
        for (const std::size_t next : {at % columns + 1 < columns ? at + 1 : at, at + columns})
            if (next < view.ground.size() && differ(at, next))
                steps.push_back(at), steps.push_back(next);
    for (const std::size_t at : steps)
        view.ground[at] = TopViewGround::Step;
}

void ProbeGround(const BenchMap &map, ErrorTopView &view, const JobPool &jobs) {
    const TopViewFrame frame = FrameOf(view.area);
    view.columns = std::max(1, int(frame.width * kCellsPerUnit));
    view.rows = std::max(1, int(frame.height * kCellsPerUnit));
    view.ground.resize(std::size_t(view.columns) * std::size_t(view.rows));
    std::vector<float> floors(view.ground.size());
    jobs.For(view.rows, [&](std::int64_t row, int) {
        const GroundRow probes(map, view, int(row));
        const auto first = std::ptrdiff_t(row) * view.columns;
        for (int column = 0; column < view.columns; ++column)
            view.ground[std::size_t(first + column)] = probes.Ground(column);
        std::ranges::copy(probes.Floors(), floors.begin() + first);
    });
    MarkSteps(floors, view);
}

/// RMS over the positions of one kind of error.
double RmsOver(const std::vector<PositionErrors> &errors, double PositionErrors::*which) {
    double sum = 0;
    for (const PositionErrors &one : errors)
        sum += one.*which * one.*which;
    return errors.empty() ? 0 : std::sqrt(sum / double(errors.size()));
}

} // namespace

TopViewFrame FrameOf(const Boundsf &area) {
    const double width = double(area.maxs.x - area.mins.x), height = double(area.maxs.y - area.mins.y);
    TopViewFrame frame;
    frame.scale = std::min(kMaxWidth / width, kMaxHeight / height);
    frame.width = width * frame.scale, frame.height = height * frame.scale;
    frame.x = kViewLeft + (kMaxWidth - frame.width) / 2, frame.y = kViewTop;
    return frame;
}

ErrorTopView MakeErrorTopView(const BenchMap &map, const TopViewInputs &in, const JobPool &jobs) {
    ErrorTopView view;
    view.title = fmt::format("{}: error of the {} by position", map.inputs.name, in.grid);
    view.subtitle = fmt::format("{}; {} positions; RMSE {:.2f}, L2 truncation limit {:.2f}, grid error {:.2f} levels",
                                in.setting, in.truth.points.size(), RmsOver(in.errors, &PositionErrors::shown),
                                RmsOver(in.errors, &PositionErrors::floor), RmsOver(in.errors, &PositionErrors::grid));
    view.errorName = in.by == WorstBy::Reference ? "displayed error of a position, RMS in 8-bit levels"
                                                 : "grid error of a position, RMS in 8-bit levels";
    for (std::size_t i = 0; i < in.truth.points.size(); ++i)
        view.dots.push_back({in.truth.points[i].position, ErrorOf(in.errors[i], in.by)});
    for (const WorstPosition &place : in.worst)
        view.rings.push_back({place.point, in.causes[place.point]});
    for (const Light &light : map.lights)
        if (light.type == LightType::Sun)
            ++view.suns;
        else
            view.lights.push_back(light.type == LightType::Area ? light.shape.center : light.origin);
    view.shares = SharesByCause(in.causes, in.errors);
    view.area = AreaOf(view.dots);
    view.height = MedianHeight(view);
    view.fullScaleError = EndOfScale(view.dots);
    ProbeGround(map, view, jobs);
    return view;
}

} // namespace q3::bench
