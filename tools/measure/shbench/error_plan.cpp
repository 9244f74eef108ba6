// GPL-2.0-or-later. Collects what the picture of a grid's errors shows.
#include "tools/measure/shbench/error_plan.h"

#include <algorithm>
#include <cmath>

namespace q3::bench {

namespace {

/// Picture units.
constexpr double kPlanLeft = 24, kPlanTop = 102, kMaxWidth = 616, kMaxHeight = 790;
constexpr int kCellsPerUnit = 2;    ///< of the ground, per picture unit: one per PNG pixel
constexpr float kMargin = 48;       ///< of the area around the positions, game units
constexpr int kMaxLevels = 24;      ///< heights at which open space is searched for
constexpr float kFloorStep = 20;    ///< floors that differ by more get an edge; over a stair step, game units
constexpr float kLevelSpacing = 32; ///< least spacing of these heights, game units
constexpr double kScaleEnd = 0.98;  ///< share of the positions within the color scale

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

double EndOfScale(const std::vector<PlanDot> &dots) {
    std::vector<double> errors;
    for (const PlanDot &dot : dots)
        errors.push_back(dot.error);
    if (errors.empty())
        return 1;
    const auto at = std::min(errors.size() - 1, std::size_t(kScaleEnd * double(errors.size())));
    std::nth_element(errors.begin(), errors.begin() + std::ptrdiff_t(at), errors.end());
    return RoundUp(errors[at]);
}

Boundsf AreaOf(const std::vector<PlanDot> &dots) {
    Boundsf area;
    for (const PlanDot &dot : dots)
        area.Add(dot.position);
    if (area.Empty())
        area.Add(Vec3f{});
    const Vec3f margin{kMargin, kMargin, 0};
    return {area.mins - margin, area.maxs + margin};
}

/// Of the worst positions, or of all positions without rings.
float MedianHeight(const ErrorPlan &plan) {
    std::vector<float> heights;
    for (const ErrorPlan::Ring &ring : plan.rings)
        heights.push_back(plan.dots[ring.dot].position.z);
    if (heights.empty())
        for (const PlanDot &dot : plan.dots)
            heights.push_back(dot.position.z);
    if (heights.empty())
        return 0;
    const auto middle = heights.begin() + std::ptrdiff_t((heights.size() - 1) / 2);
    std::nth_element(heights.begin(), middle, heights.end());
    return *middle;
}

/// Probes of the ground in a row of the plan, from west to east.
class GroundRow {
  public:
    GroundRow(const BenchMap &map, const ErrorPlan &plan, int row)
        : map_(map), plan_(plan), heights_(std::size_t(plan.columns), kNone) {
        y_ = plan.area.maxs.y - (plan.area.maxs.y - plan.area.mins.y) * (float(row) + 0.5f) / float(plan.rows);
        for (int column = 0; column < plan.columns; ++column)
            heights_[std::size_t(column)] = OpenHeight(X(column));
    }
    PlanGround Ground(int column) const {
        const float height = heights_[std::size_t(column)];
        return height == kNone ? PlanGround::Solid : height == plan_.height ? PlanGround::Open : PlanGround::Elsewhere;
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
    static constexpr float kNone = -1e9f;

  private:
    static constexpr float kDeep = 65536;
    float X(int column) const {
        const float width = plan_.area.maxs.x - plan_.area.mins.x;
        return plan_.area.mins.x + width * (float(column) + 0.5f) / float(plan_.columns);
    }
    /// The plan's height if it is open there, else the highest open height in the range of the positions.
    float OpenHeight(float x) const {
        if (map_.space.ClusterAt({x, y_, plan_.height}, 0) >= 0)
            return plan_.height;
        const float range = plan_.area.maxs.z - plan_.area.mins.z;
        const int levels = std::clamp(int(range / kLevelSpacing) + 1, 1, kMaxLevels);
        for (int level = 0; level < levels; ++level) {
            const float z = plan_.area.maxs.z - range * (float(level) + 0.5f) / float(levels);
            if (map_.space.ClusterAt({x, y_, z}, 0) >= 0)
                return z;
        }
        return kNone;
    }

    const BenchMap &map_;
    const ErrorPlan &plan_;
    float y_ = 0;
    std::vector<float> heights_;
};

/// Marks neighboring cells whose floors differ by more than kFloorStep. `floors`: of the whole plan.
void MarkSteps(const std::vector<float> &floors, ErrorPlan &plan) {
    const auto columns = std::size_t(plan.columns);
    const auto differ = [&](std::size_t a, std::size_t b) {
        return plan.ground[a] != PlanGround::Solid && plan.ground[b] != PlanGround::Solid &&
               std::abs(floors[a] - floors[b]) > kFloorStep;
    };
    std::vector<std::size_t> steps;
    for (std::size_t at = 0; at < plan.ground.size(); ++at)
        for (const std::size_t next : {at % columns + 1 < columns ? at + 1 : at, at + columns})
            if (next < plan.ground.size() && differ(at, next))
                steps.push_back(at), steps.push_back(next);
    for (const std::size_t at : steps)
        plan.ground[at] = PlanGround::Step;
}

void ProbeGround(const BenchMap &map, ErrorPlan &plan, const JobPool &jobs) {
    const PlanFrame frame = FrameOf(plan.area);
    plan.columns = std::max(1, int(frame.width * kCellsPerUnit));
    plan.rows = std::max(1, int(frame.height * kCellsPerUnit));
    plan.ground.resize(std::size_t(plan.columns) * std::size_t(plan.rows));
    std::vector<float> floors(plan.ground.size());
    jobs.For(plan.rows, [&](std::int64_t row, int) {
        const GroundRow probes(map, plan, int(row));
        const auto first = std::ptrdiff_t(row) * plan.columns;
        for (int column = 0; column < plan.columns; ++column)
            plan.ground[std::size_t(first + column)] = probes.Ground(column);
        std::ranges::copy(probes.Floors(), floors.begin() + first);
    });
    MarkSteps(floors, plan);
}

/// RMS over the positions.
double Total(const std::vector<PositionErrors> &errors, double PositionErrors::*which) {
    double sum = 0;
    for (const PositionErrors &one : errors)
        sum += one.*which * one.*which;
    return errors.empty() ? 0 : std::sqrt(sum / double(errors.size()));
}

} // namespace

PlanFrame FrameOf(const Boundsf &area) {
    const double width = double(area.maxs.x - area.mins.x), height = double(area.maxs.y - area.mins.y);
    PlanFrame frame;
    frame.scale = std::min(kMaxWidth / width, kMaxHeight / height);
    frame.width = width * frame.scale, frame.height = height * frame.scale;
    frame.x = kPlanLeft + (kMaxWidth - frame.width) / 2, frame.y = kPlanTop;
    return frame;
}

ErrorPlan MakeErrorPlan(const BenchMap &map, const PlanInputs &in, const JobPool &jobs) {
    ErrorPlan plan;
    plan.title = fmt::format("{}: where the {} errs", map.inputs.name, in.grid);
    plan.subtitle = fmt::format("{}; {} positions; RMSE {:.2f}, floor {:.2f}, grid error {:.2f} bytes of 255",
                                in.setting, in.truth.points.size(), Total(in.errors, &PositionErrors::shown),
                                Total(in.errors, &PositionErrors::floor), Total(in.errors, &PositionErrors::grid));
    plan.errorName = in.by == WorstBy::Shown ? "displayed error of a position, RMS in bytes"
                                             : "grid error of a position, RMS in bytes";
    for (std::size_t i = 0; i < in.truth.points.size(); ++i)
        plan.dots.push_back({in.truth.points[i].position, ErrorOf(in.errors[i], in.by)});
    for (const WorstPosition &place : in.worst)
        plan.rings.push_back({place.point, in.causes[place.point]});
    for (const Light &light : map.lights)
        if (light.type == LightType::Sun)
            ++plan.suns;
        else
            plan.lights.push_back(light.type == LightType::Area ? light.shape.center : light.origin);
    plan.shares = SharesByCause(in.causes, in.errors);
    plan.area = AreaOf(plan.dots);
    plan.height = MedianHeight(plan);
    plan.fullScaleError = EndOfScale(plan.dots);
    ProbeGround(map, plan, jobs);
    return plan;
}

} // namespace q3::bench
