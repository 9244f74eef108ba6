// GPL-2.0-or-later. SH grid points in and beside solids: where they are lit from, and how they are filled.
#include "q3map2/light/grid/gridsh_fill.h"

#include "libs/sh/sh.h"
#include "q3map2/light/batch/ray_packet.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <span>

namespace q3 {

// ---- Where the points of the SH grid are lit from ----

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

LitGridPoints::LitGridPoints(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks)
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

void LitGridPoints::FindOnEmitters(const std::vector<Light> &lights) {
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

void LitGridPoints::AddReceiver(const BrickPoint &point, std::vector<ReceiverBatch> &blocks) const {
    Vec3f from = point.position;
    if (states_[point.index] != PointState::Open && states_[point.index] != PointState::OnEmitter)
        from = std::lower_bound(displaced_.begin(), displaced_.end(), point.index,
                                [](const DisplacedPoint &d, std::uint32_t i) { return d.index < i; })
                   ->position;
    BatchWithRoom(blocks).Add(from, from, litFrom_[point.index], point.index);
}

// ---- SH grid points in solids ----

namespace {

/// Distances at which open space beside a point is searched, to light the point from there. Game units.
constexpr float kSmallSteps[] = {0.5f, 1, 2};
/// A side of mean light m weighs 1 / (m + kDarkest): keeps the weight of a black side finite. 1 = byte 255.
constexpr double kDarkest = 1.0 / 8192;
/// A point beside a wall weighs as much on its own side as this many neighbors at the shortest distance.
constexpr double kOwnWeight = 2;

struct Offset {
    int x, y, z;
};

/// Offsets to the 26 neighbors of a point, in cells; also the directions of small steps.
constexpr std::array<Offset, 26> MakeNeighbors() {
    std::array<Offset, 26> result{};
    std::size_t n = 0;
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x)
                if (x != 0 || y != 0 || z != 0)
                    result[n++] = {x, y, z};
    return result;
}
constexpr std::array<Offset, 26> kNeighbors = MakeNeighbors();

bool TryPosition(const BspSpace &space, const Vec3f &p, PointState state, PlacedPoint &placed) {
    const PlacedPoint open = PlaceInOpen(space, p);
    if (open.state != PointState::Open)
        return false;
    placed = {state, p, open.cluster};
    return true;
}

/// Small steps along the axes and diagonals, the nearest first.
bool TrySmallSteps(const BspSpace &space, const Vec3f &p, PlacedPoint &placed) {
    for (const float step : kSmallSteps)
        for (int axes = 1; axes <= 3; ++axes)
            for (const Offset &o : kNeighbors)
                if (std::abs(o.x) + std::abs(o.y) + std::abs(o.z) == axes &&
                    TryPosition(space, p + Vec3f{float(o.x), float(o.y), float(o.z)} * step, PointState::Beside,
                                placed))
                    return true;
    return false;
}

/// Positions up to a cell away on a lattice of quarter cells, the nearest shell first.
bool TryCells(const BspSpace &space, const Vec3f &p, const Vec3f &cell, PlacedPoint &placed) {
    constexpr int kSteps = 4;
    const Vec3f step = cell / kSteps;
    const auto anyOpen = [&](const Vec3f &from, const Vec3f &to) {
        return space.AnyOpen(p + step * from, p + step * to, kClearance);
    };
    for (int shell = 1; shell <= kSteps; ++shell) {
        const auto reach = float(shell);
        if (!anyOpen({-reach, -reach, -reach}, {reach, reach, reach}))
            continue;
        for (int z = -shell; z <= shell; ++z) {
            if (!anyOpen({-reach, -reach, float(z)}, {reach, reach, float(z)}))
                continue;
            for (int y = -shell; y <= shell; ++y)
                for (int x = -shell; x <= shell; ++x)
                    if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == shell &&
                        TryPosition(space, p + step * Vec3f{float(x), float(y), float(z)}, PointState::Moved, placed))
                        return true;
        }
    }
    return false;
}

bool HasOpenNeighbor(const GridLayout &layout, const std::vector<int> &clusters, std::uint32_t index) {
    const std::int64_t width = layout.bounds[0], height = layout.bounds[1];
    const std::int64_t x = index % width, y = index / width % height, z = index / width / height;
    return std::any_of(kNeighbors.begin(), kNeighbors.end(), [&](const Offset &o) {
        const std::int64_t nx = x + o.x, ny = y + o.y, nz = z + o.z;
        return nx >= 0 && ny >= 0 && nz >= 0 && nx < width && ny < height && nz < layout.bounds[2] &&
               clusters[std::size_t(layout.Index(nx, ny, nz))] >= 0;
    });
}

/// Lit neighbors of one solid point that see each other.
struct Side {
    double weight = 0;
    std::array<double, kSHFloats> sum{};
    double Mean() const { return std::max(0.0, (sum[0] + sum[1] + sum[2]) / weight / 3 * kSHC0); }
    double BlendWeight() const { return weight / (Mean() + kDarkest); }
};

/// Batches rays that test whether two positions see each other.
class SightRays {
  public:
    SightRays(const LightScene &scene, RayCounts &counts) : rays_(Trace{scene, counts}) {}
    /// Sets a bit of `seen`, at the latest in Flush, if the positions see each other.
    void Ask(const Vec3f &from, const Vec3f &to, std::uint32_t bit, std::uint32_t &seen) {
        rays_.Aim({&seen, bit}, from, to);
    }
    void Flush() { rays_.Flush(); }

  private:
    struct Answer {
        std::uint32_t *seen;
        std::uint32_t bit;
    };
    struct Trace {
        const LightScene &scene;
        RayCounts &counts;
        void operator()(RayPacket &packet, std::span<const Answer> answers) const {
            scene.TraceToLight(packet, ShadowRules::Exact, counts);
            for (std::size_t i = 0; i < answers.size(); ++i)
                *answers[i].seen |= packet.live[i] != 0 ? answers[i].bit : 0;
        }
    };
    RayBatcher<Answer, Trace> rays_;
};

/// sum[i] += weight * value[i].
Q3_VECTOR void AddWeighted(double weight, const float *value, double *sum) {
    for (std::size_t i = 0; i < kSHFloats; ++i)
        sum[i] += weight * double(value[i]);
}

class Filler {
  public:
    Filler(const GridInputs &in, const GridLayout &layout, const std::vector<DisplacedPoint> &displaced,
           const std::vector<PointState> &states)
        : in_(in), layout_(layout), displaced_(displaced), states_(states) {
        for (std::size_t i = 0; i < kNeighbors.size(); ++i) {
            const Offset &o = kNeighbors[i];
            const Vec3f cell(layout.size), offset = cell * Vec3f{float(o.x), float(o.y), float(o.z)};
            weights_[i] = 1 / double(Dot(offset, offset));
        }
    }

    /// The value of a Solid or Beside point, or nothing: no lit neighbor, or none on another side. split: the point's
    /// groups; null if it has one group only.
    std::optional<bspGridPointSH_t> Fill(int x, int y, int z, const VisibilityGroups::PointGroups *split,
                                         const LightGridSH &grid) const {
        if (!split && states_[IndexOf(x, y, z)] == PointState::Beside)
            return std::nullopt;
        const Around lit = AroundPoint(x, y, z, false);
        if (lit.count == 0)
            return std::nullopt;
        return Blend(SidesAround(lit, split, grid));
    }

    /// The neighbors that Fill blends, with their shares.
    std::vector<FillSource> Sources(int x, int y, int z, const VisibilityGroups::PointGroups *split,
                                    const LightGridSH &grid) const {
        std::vector<FillSource> sources;
        if (!split && states_[IndexOf(x, y, z)] != PointState::Solid)
            return sources;
        const Around lit = AroundPoint(x, y, z, true);
        const std::vector<Side> sides = SidesAround(lit, split, grid);
        double total = 0;
        for (const Side &side : sides)
            total += side.BlendWeight();
        for (std::size_t i = 0; i < lit.count; ++i) {
            const int group = split ? split->groups[i] : 0;
            const Side &side = sides[std::size_t(group)];
            sources.push_back({std::uint32_t(lit.neighbors[i].index), lit.neighbors[i].position, group,
                               lit.neighbors[i].weight / side.weight * side.BlendWeight() / total});
        }
        return sources;
    }

    /// Appends the sides of the points that have several. points: grid coordinates x y z.
    void FindSides(std::span<const std::array<int, 3>> points, std::vector<VisibilityGroups::PointGroups> &found,
                   RayCounts &counts) const {
        // The first rays of all points share packets: most points have one side only and need no more.
        std::vector<Around> around;
        std::vector<std::uint32_t> seen(points.size(), 1);
        SightRays rays(in_.scene, counts);
        around.reserve(points.size());
        for (std::size_t n = 0; n < points.size(); ++n) {
            const Around &lit = around.emplace_back(AroundPoint(points[n][0], points[n][1], points[n][2], true));
            for (std::size_t i = 1; i < lit.count; ++i)
                rays.Ask(lit.neighbors[i].position, lit.neighbors[0].position, 1u << i, seen[n]);
        }
        rays.Flush();
        for (std::size_t n = 0; n < points.size(); ++n)
            if (const std::uint32_t all = (1u << around[n].count) - 1; (~seen[n] & all) != 0)
                found.push_back(SidesOf(std::uint32_t(IndexOf(points[n][0], points[n][1], points[n][2])), around[n],
                                        ~seen[n] & all, rays));
    }

  private:
    struct Neighbor {
        std::size_t index;
        Vec3f position;
        double weight;
    };
    /// The point itself if its state is Beside, then its lit neighbors.
    struct Around {
        std::array<Neighbor, VisibilityGroups::kMaxNeighbors> neighbors;
        std::size_t count = 0;
    };

    std::size_t IndexOf(int x, int y, int z) const { return std::size_t(layout_.Index(x, y, z)); }
    double ShortestSquared() const {
        const double shortest = double(std::min({layout_.size[0], layout_.size[1], layout_.size[2]}));
        return shortest * shortest;
    }

    Vec3f PositionOf(std::size_t index, int x, int y, int z) const {
        if (states_[index] == PointState::Open || states_[index] == PointState::OnEmitter)
            return Vec3f(layout_.Position(x, y, z));
        const auto found = std::lower_bound(displaced_.begin(), displaced_.end(), index,
                                            [](const DisplacedPoint &d, std::size_t i) { return d.index < i; });
        return found->position;
    }

    static std::vector<Side> SidesAround(const Around &lit, const VisibilityGroups::PointGroups *split,
                                         const LightGridSH &grid) {
        std::vector<Side> sums(split ? split->groupCount : 1);
        for (std::size_t i = 0; i < lit.count; ++i) {
            Side &side = sums[split ? split->groups[i] : 0];
            const Neighbor &neighbor = lit.neighbors[i];
            side.weight += neighbor.weight;
            AddWeighted(neighbor.weight, grid.points[neighbor.index].coeffs[0].data(), side.sum.data());
        }
        return sums;
    }

    /// positions: also sets Neighbor::position, else zero.
    Around AroundPoint(int x, int y, int z, bool positions) const {
        Around lit;
        const std::size_t own = IndexOf(x, y, z);
        if (states_[own] == PointState::Beside)
            lit.neighbors[lit.count++] = {own, positions ? PositionOf(own, x, y, z) : Vec3f{},
                                          kOwnWeight / ShortestSquared()};
        for (std::size_t i = 0; i < kNeighbors.size(); ++i) {
            const Offset &o = kNeighbors[i];
            const int nx = x + o.x, ny = y + o.y, nz = z + o.z;
            if (nx < 0 || ny < 0 || nz < 0 || nx >= layout_.bounds[0] || ny >= layout_.bounds[1] ||
                nz >= layout_.bounds[2])
                continue;
            const std::size_t index = IndexOf(nx, ny, nz);
            const PointState state = states_[index];
            if (state == PointState::Exterior || state == PointState::Solid)
                continue;
            lit.neighbors[lit.count++] = {index, positions ? PositionOf(index, nx, ny, nz) : Vec3f{}, weights_[i]};
        }
        return lit;
    }

    /// Sorts the entries of `lit` into sides: the first entry of a side sees all the others of it, but none of the
    /// first entries before. unseen: bits of the entries that entry 0 does not see.
    static VisibilityGroups::PointGroups SidesOf(std::uint32_t index, const Around &lit, std::uint32_t unseen,
                                                 SightRays &rays) {
        VisibilityGroups::PointGroups result{index, 1, {}};
        while (unseen != 0) {
            const auto first = std::size_t(std::countr_zero(unseen));
            std::uint32_t seen = 1u << first;
            for (std::uint32_t left = unseen & (unseen - 1); left != 0; left &= left - 1) {
                const auto i = std::size_t(std::countr_zero(left));
                rays.Ask(lit.neighbors[i].position, lit.neighbors[first].position, 1u << i, seen);
            }
            rays.Flush();
            for (std::uint32_t side = seen; side != 0; side &= side - 1)
                result.groups[std::size_t(std::countr_zero(side))] = std::uint8_t(result.groupCount);
            ++result.groupCount;
            unseen &= ~seen;
        }
        return result;
    }

    static bspGridPointSH_t Blend(const std::vector<Side> &sides) {
        std::array<double, kSHFloats> sum{};
        double total = 0;
        for (const Side &side : sides) {
            const double weight = side.BlendWeight();
            total += weight;
            for (std::size_t i = 0; i < kSHFloats; ++i)
                sum[i] += side.sum[i] / side.weight * weight;
        }
        std::array<float, kSHFloats> filled;
        for (std::size_t i = 0; i < kSHFloats; ++i)
            filled[i] = float(sum[i] / total);
        return std::bit_cast<bspGridPointSH_t>(filled);
    }

    const GridInputs &in_;
    const GridLayout &layout_;
    const std::vector<DisplacedPoint> &displaced_;
    const std::vector<PointState> &states_;
    std::array<double, kNeighbors.size()> weights_; ///< inverse squares of distances
};

} // namespace

PlacedPoint PlaceInOpen(const BspSpace &space, const Vec3f &p) {
    const Vec3f margin{kClearance, kClearance, kClearance};
    const int cluster = space.ClusterAt(p, kClearance);
    const bool open = cluster >= 0 && !space.AnySolid(p - margin, p + margin);
    return {open ? PointState::Open : PointState::Exterior, p, cluster};
}

PlacedPoint PlaceBeside(const BspSpace &space, const Vec3f &p) {
    PlacedPoint placed;
    constexpr float kReach = *std::max_element(std::begin(kSmallSteps), std::end(kSmallSteps));
    const Vec3f reach{kReach, kReach, kReach};
    if (space.AnyOpen(p - reach, p + reach, kClearance))
        TrySmallSteps(space, p, placed);
    return placed;
}

PlacedPoint PlaceGridPoint(const BspSpace &space, const GridLayout &layout, const std::vector<int> &clusters,
                           const BrickPoint &point) {
    PlacedPoint placed;
    const Vec3f cell(layout.size), &p = point.position;
    if (!space.AnyOpen(p - cell, p + cell, kClearance))
        return placed;
    placed = PlaceBeside(space, p);
    if (placed.state == PointState::Beside)
        return placed;
    if (HasOpenNeighbor(layout, clusters, point.index))
        placed.state = PointState::Solid;
    else
        TryCells(space, p, cell, placed);
    return placed;
}

VisibilityGroups FindVisibilityGroups(const GridInputs &in, const GridLayout &layout,
                                      const std::vector<DisplacedPoint> &displaced,
                                      const std::vector<PointState> &states) {
    const int width = layout.bounds[0], height = layout.bounds[1];
    const std::int64_t rows = std::int64_t(height) * layout.bounds[2];
    const Filler filler(in, layout, displaced, states);
    std::vector<std::vector<VisibilityGroups::PointGroups>> found(static_cast<std::size_t>(rows));
    in.jobs.For(rows, [&](std::int64_t row, int) {
        std::vector<std::array<int, 3>> points;
        for (int x = 0; x < width; ++x) {
            const PointState state = states[std::size_t(row) * std::size_t(width) + std::size_t(x)];
            if (state == PointState::Solid || state == PointState::Beside)
                points.push_back({x, int(row % height), int(row / height)});
        }
        RayCounts counts; // discarded: the log counts rays to lights only
        filler.FindSides(points, found[std::size_t(row)], counts);
    });
    VisibilityGroups groups;
    groups.isSplit.resize(states.size());
    for (const auto &row : found) {
        for (const VisibilityGroups::PointGroups &point : row)
            groups.isSplit[point.index] = true;
        groups.points.insert(groups.points.end(), row.begin(), row.end());
    }
    return groups;
}

std::vector<FillSource> FillSources(const GridInputs &in, const GridLayout &layout,
                                    const std::vector<DisplacedPoint> &displaced, const VisibilityGroups &groups,
                                    const std::vector<PointState> &states, const LightGridSH &grid,
                                    std::uint32_t index) {
    if (states[index] != PointState::Solid && states[index] != PointState::Beside)
        return {};
    const auto found = std::find_if(groups.points.begin(), groups.points.end(),
                                    [&](const VisibilityGroups::PointGroups &p) { return p.index == index; });
    const auto [x, y, z] = layout.Coordinates(index);
    return Filler(in, layout, displaced, states)
        .Sources(x, y, z, found == groups.points.end() ? nullptr : &*found, grid);
}

void FillGridSH(const GridInputs &in, const GridLayout &layout, const std::vector<DisplacedPoint> &displaced,
                const VisibilityGroups &groups, std::vector<PointState> &states, LightGridSH &grid) {
    struct Value {
        std::size_t index;
        bspGridPointSH_t point;
    };
    const int width = layout.bounds[0], height = layout.bounds[1];
    const std::int64_t rows = std::int64_t(height) * layout.bounds[2];
    // Every value is computed from the lit points before any is stored, so the order does not matter.
    std::vector<std::vector<Value>> filled(static_cast<std::size_t>(rows));
    const Filler filler(in, layout, displaced, states);
    in.jobs.For(rows, [&](std::int64_t row, int) {
        const auto first = std::size_t(row) * std::size_t(width);
        auto nextSplit =
            std::lower_bound(groups.points.begin(), groups.points.end(), first,
                             [](const VisibilityGroups::PointGroups &p, std::size_t index) { return p.index < index; });
        for (int x = 0; x < width; ++x) {
            const std::size_t index = first + std::size_t(x);
            if (states[index] != PointState::Solid && states[index] != PointState::Beside)
                continue;
            const bool split = nextSplit != groups.points.end() && nextSplit->index == index;
            if (const auto value =
                    filler.Fill(x, int(row % height), int(row / height), split ? &*nextSplit : nullptr, grid))
                filled[std::size_t(row)].push_back({index, *value});
            nextSplit += split ? 1 : 0;
        }
    });
    for (const auto &row : filled)
        for (const Value &value : row) {
            grid.points[value.index] = value.point;
            states[value.index] = PointState::Filled;
        }
    std::replace(states.begin(), states.end(), PointState::Solid, PointState::Exterior);
}

} // namespace q3
