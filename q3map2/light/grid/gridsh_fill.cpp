// GPL-2.0-or-later. SH grid points in and beside solids: where they are lit from, and how they are filled.
#include "q3map2/light/grid/gridsh_fill.h"

#include "libs/sh/sh.h"
#include "q3map2/light/batch/receivers.h"

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

/// Whether p is on the polygon of a surface light: in its plane, and on the same side of all edges.
bool OnEmitter(const Light &light, const Vec3f &p) {
    if (std::abs(Dot(Vec3f(light.shape.normal), p) - float(light.shape.dist)) > kOnEmitter)
        return false;
    bool left = false, right = false;
    for (std::size_t i = 0; i < light.polygon.size(); ++i) {
        const Vec3f &a = light.polygon[i], edge = light.polygon[(i + 1) % light.polygon.size()] - a;
        const float side = Dot(Cross(edge, p - a), Vec3f(light.shape.normal)), margin = kOnEmitter * Length(edge);
        left = left || side > margin, right = right || side < -margin;
    }
    return !(left && right);
}

/// The position that a lit point is lit from: its own, unless `displaced`, which is sorted by index, has another.
Vec3f LitPosition(const BrickPoint &point, PointState state, const std::vector<DisplacedPoint> &displaced) {
    if (state == PointState::Open || state == PointState::OnEmitter)
        return point.position;
    const auto found = std::lower_bound(displaced.begin(), displaced.end(), point.index,
                                        [](const DisplacedPoint &d, std::uint32_t i) { return d.index < i; });
    return found != displaced.end() && found->index == point.index ? found->position : point.position;
}

/// Calls use(brick, points) for all bricks, on all workers.
template <typename Use> void ForBricks(const GridInputs &in, const GridBricks &bricks, const Use &use) {
    in.jobs.For(bricks.Count(), [&](std::int64_t brick, int) { use(brick, bricks.Points(brick)); });
}

} // namespace

LitGridPoints::LitGridPoints(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks)
    : layout_(layout), states_(std::size_t(layout.Count()), PointState::Exterior), clusters_(states_.size()),
      litClusters_(states_.size()) {
    ForBricks(in, bricks, [&](std::int64_t, std::span<const BrickPoint> points) {
        for (const BrickPoint &point : points) {
            const PlacedPoint placed = PlaceInOpen(in.space, point.position);
            clusters_[point.index] = litClusters_[point.index] = placed.cluster;
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
            litClusters_[point.index] = placed.cluster;
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
        const Boundsf box = WindingBounds(light.polygon);
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
    const Vec3f from = LitPosition(point, states_[point.index], displaced_);
    BatchWithRoom(blocks).Add(from, from, litClusters_[point.index], point.index);
}

// ---- Points of the SH grid in or beside solids: lit from nearby, or filled from groups of neighbors ----

namespace {

/// Distances at which open space beside a point is searched, to light the point from there. Game units.
constexpr float kSmallSteps[] = {0.5f, 1, 2};
/// A group of mean light m weighs 1 / (m + kDarkestMean): keeps the weight of a black group finite. 1 = byte 255.
constexpr double kDarkestMean = 1.0 / 8192;
/// A point beside a wall weighs as much in its group as this many neighbors at the shortest distance.
constexpr double kSelfWeight = 2;

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

/// Sets `placed` if p is in the open. False: it is not.
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

/// Weighted sum of the light of one visibility group.
struct GroupSum {
    double weight = 0;
    std::array<double, kSHFloats> sum{};
    /// Mean light over directions and channels, at least 0.
    double Mean() const { return std::max(0.0, (sum[0] + sum[1] + sum[2]) / weight / 3 * kSHC0); }
    /// Weight of the group in the blend.
    double BlendWeight() const { return weight / (Mean() + kDarkestMean); }
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
void AddWeighted(double weight, const float *value, double *sum) {
    Vectorize([&, weight]() Q3_INLINE {
        for (std::size_t i = 0; i < kSHFloats; ++i)
            sum[i] += weight * double(value[i]);
    });
}

/// Finds the lit points around grid points in or beside solids. Keeps references.
class LitNeighborhood {
  public:
    struct Neighbor {
        std::size_t index;
        Vec3f position; ///< that it is lit from; zero unless asked for
        double weight;  ///< inverse square of its distance, game units
    };
    /// The point itself if its state is Beside, then its lit neighbors.
    struct Neighbors {
        std::array<Neighbor, VisibilityGroups::kMaxNeighbors> list;
        std::size_t count = 0;
    };
    enum class Positions { LeaveOut, Find };

    LitNeighborhood(const GridLayout &layout, const std::vector<DisplacedPoint> &displaced,
                    const std::vector<PointState> &states)
        : layout_(layout), displaced_(displaced), states_(states) {
        const Vec3f cell(layout.size);
        for (std::size_t i = 0; i < kNeighbors.size(); ++i) {
            const Offset &o = kNeighbors[i];
            const Vec3f offset = cell * Vec3f{float(o.x), float(o.y), float(o.z)};
            weights_[i] = 1 / double(Dot(offset, offset));
        }
        const double shortest = double(std::min({layout.size[0], layout.size[1], layout.size[2]}));
        selfWeight_ = kSelfWeight / (shortest * shortest);
    }

    std::size_t IndexOf(int x, int y, int z) const { return std::size_t(layout_.Index(x, y, z)); }
    PointState StateOf(std::size_t index) const { return states_[index]; }

    Neighbors Around(int x, int y, int z, Positions positions) const {
        Neighbors lit;
        const std::size_t self = IndexOf(x, y, z);
        const auto add = [&](std::size_t index, int px, int py, int pz, double weight) {
            lit.list[lit.count++] = {index, positions == Positions::Find ? PositionOf(index, px, py, pz) : Vec3f{},
                                     weight};
        };
        if (states_[self] == PointState::Beside)
            add(self, x, y, z, selfWeight_);
        for (std::size_t i = 0; i < kNeighbors.size(); ++i) {
            const Offset &o = kNeighbors[i];
            const int nx = x + o.x, ny = y + o.y, nz = z + o.z;
            if (nx < 0 || ny < 0 || nz < 0 || nx >= layout_.bounds[0] || ny >= layout_.bounds[1] ||
                nz >= layout_.bounds[2])
                continue;
            const std::size_t index = IndexOf(nx, ny, nz);
            if (states_[index] != PointState::Exterior && states_[index] != PointState::Solid)
                add(index, nx, ny, nz, weights_[i]);
        }
        return lit;
    }

  private:
    Vec3f PositionOf(std::size_t index, int x, int y, int z) const {
        return LitPosition({Vec3f(layout_.Position(x, y, z)), std::uint32_t(index)}, states_[index], displaced_);
    }

    const GridLayout &layout_;
    const std::vector<DisplacedPoint> &displaced_;
    const std::vector<PointState> &states_;
    std::array<double, kNeighbors.size()> weights_; ///< by neighbor: inverse square of its distance
    double selfWeight_;
};

/// Sorts the entries of `lit` into groups: the first entry of a group sees all the others of it, but is not seen by the
/// first entries of the groups before. unseen: bits of the entries that entry 0 does not see.
VisibilityGroups::PointGroups GroupsOf(std::uint32_t index, const LitNeighborhood::Neighbors &lit, std::uint32_t unseen,
                                       SightRays &rays) {
    VisibilityGroups::PointGroups result{index, 1, {}};
    while (unseen != 0) {
        const auto first = std::size_t(std::countr_zero(unseen));
        std::uint32_t seen = 1u << first;
        for (std::uint32_t left = unseen & (unseen - 1); left != 0; left &= left - 1) {
            const auto i = std::size_t(std::countr_zero(left));
            rays.Ask(lit.list[i].position, lit.list[first].position, 1u << i, seen);
        }
        rays.Flush();
        for (std::uint32_t group = seen; group != 0; group &= group - 1)
            result.groups[std::size_t(std::countr_zero(group))] = std::uint8_t(result.groupCount);
        ++result.groupCount;
        unseen &= ~seen;
    }
    return result;
}

/// Appends the groups of those points that have several. points: grid coordinates x y z.
void FindGroups(const LightScene &scene, const LitNeighborhood &neighborhood,
                std::span<const std::array<int, 3>> points, std::vector<VisibilityGroups::PointGroups> &found,
                RayCounts &counts) {
    // The first rays of all points share packets: most points have one group only and need no more.
    std::vector<LitNeighborhood::Neighbors> around;
    std::vector<std::uint32_t> seen(points.size(), 1); // by point: bits of the entries that entry 0 sees, itself too
    SightRays rays(scene, counts);
    around.reserve(points.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
        const auto &[x, y, z] = points[n];
        const auto &lit = around.emplace_back(neighborhood.Around(x, y, z, LitNeighborhood::Positions::Find));
        for (std::size_t i = 1; i < lit.count; ++i)
            rays.Ask(lit.list[i].position, lit.list[0].position, 1u << i, seen[n]);
    }
    rays.Flush();
    for (std::size_t n = 0; n < points.size(); ++n) {
        const auto &[x, y, z] = points[n];
        const std::uint32_t unseen = ~seen[n] & ((1u << around[n].count) - 1);
        if (unseen != 0)
            found.push_back(GroupsOf(std::uint32_t(neighborhood.IndexOf(x, y, z)), around[n], unseen, rays));
    }
}

/// The mean of the groups' lights, each weighted by GroupSum::BlendWeight.
bspGridPointSH_t Blend(const std::vector<GroupSum> &groups) {
    std::array<double, kSHFloats> sum{};
    double total = 0;
    for (const GroupSum &group : groups) {
        const double weight = group.BlendWeight();
        total += weight;
        for (std::size_t i = 0; i < kSHFloats; ++i)
            sum[i] += group.sum[i] / group.weight * weight;
    }
    std::array<float, kSHFloats> filled;
    for (std::size_t i = 0; i < kSHFloats; ++i)
        filled[i] = float(sum[i] / total);
    return std::bit_cast<bspGridPointSH_t>(filled);
}

/// Sums of the neighbors' lights by group. groups: null if they are in one group.
std::vector<GroupSum> SumByGroup(const LitNeighborhood::Neighbors &lit, const VisibilityGroups::PointGroups *groups,
                                 const LightGridSH &grid) {
    std::vector<GroupSum> sums(groups ? groups->groupCount : 1);
    for (std::size_t i = 0; i < lit.count; ++i) {
        GroupSum &group = sums[groups ? groups->groups[i] : 0];
        const LitNeighborhood::Neighbor &neighbor = lit.list[i];
        group.weight += neighbor.weight;
        AddWeighted(neighbor.weight, grid.points[neighbor.index].coeffs[0].data(), group.sum.data());
    }
    return sums;
}

/// The value of a Solid or Beside point; nothing if it has no lit neighbor, or is Beside and all its neighbors are in
/// one group. groups: null if it has one group only.
std::optional<bspGridPointSH_t> FilledValue(const LitNeighborhood &neighborhood, int x, int y, int z,
                                            const VisibilityGroups::PointGroups *groups, const LightGridSH &grid) {
    if (!groups && neighborhood.StateOf(neighborhood.IndexOf(x, y, z)) == PointState::Beside)
        return std::nullopt;
    const auto lit = neighborhood.Around(x, y, z, LitNeighborhood::Positions::LeaveOut);
    if (lit.count == 0)
        return std::nullopt;
    return Blend(SumByGroup(lit, groups, grid));
}

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
    const LitNeighborhood neighborhood(layout, displaced, states);
    std::vector<std::vector<VisibilityGroups::PointGroups>> found(static_cast<std::size_t>(rows));
    in.jobs.For(rows, [&](std::int64_t row, int) {
        std::vector<std::array<int, 3>> points;
        for (int x = 0; x < width; ++x) {
            const PointState state = states[std::size_t(row) * std::size_t(width) + std::size_t(x)];
            if (state == PointState::Solid || state == PointState::Beside)
                points.push_back({x, int(row % height), int(row / height)});
        }
        RayCounts counts; // discarded: the log counts rays to lights only
        FindGroups(in.scene, neighborhood, points, found[std::size_t(row)], counts);
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

std::vector<FillSource> FillSources(const GridLayout &layout, const std::vector<DisplacedPoint> &displaced,
                                    const VisibilityGroups &groups, const std::vector<PointState> &states,
                                    const LightGridSH &grid, std::uint32_t index) {
    const auto found = std::ranges::find(groups.points, index, &VisibilityGroups::PointGroups::index);
    const VisibilityGroups::PointGroups *split = found == groups.points.end() ? nullptr : &*found;
    const PointState state = states[index];
    if (state != PointState::Solid && (state != PointState::Beside || !split))
        return {};
    const auto [x, y, z] = layout.Coordinates(index);
    const LitNeighborhood neighborhood(layout, displaced, states);
    const auto lit = neighborhood.Around(x, y, z, LitNeighborhood::Positions::Find);
    const std::vector<GroupSum> sums = SumByGroup(lit, split, grid);
    double total = 0;
    for (const GroupSum &sum : sums)
        total += sum.BlendWeight();
    std::vector<FillSource> sources;
    for (std::size_t i = 0; i < lit.count; ++i) {
        const LitNeighborhood::Neighbor &neighbor = lit.list[i];
        const int group = split ? split->groups[i] : 0;
        const GroupSum &sum = sums[std::size_t(group)];
        sources.push_back({std::uint32_t(neighbor.index), neighbor.position, group,
                           neighbor.weight / sum.weight * sum.BlendWeight() / total});
    }
    return sources;
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
    const LitNeighborhood neighborhood(layout, displaced, states);
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
            if (const auto value = FilledValue(neighborhood, x, int(row % height), int(row / height),
                                               split ? &*nextSplit : nullptr, grid))
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
