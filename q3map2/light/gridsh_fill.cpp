// GPL-2.0-or-later. SH grid points in solids.
#include "q3map2/light/gridsh_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace q3 {

namespace {

/// Points keep this clear of solids when they are lit. Game units.
constexpr float kClearance = 0.125f;
/// A point this near to open space is lit from there. Game units.
constexpr float kSmallSteps[] = {0.5f, 1, 2};
/// A side of mean light 0 weighs as much as one of this light. 1 = byte 255.
constexpr double kDarkest = 1.0 / 8192;
/// A point beside a wall weighs as much on its own side as this many neighbours at the shortest distance.
constexpr double kOwnWeight = 2;

struct Offset {
    int x, y, z;
};

/// The 26 neighbours of a point, or fractions of a cell.
constexpr std::array<Offset, 26> MakeNeighbours() {
    std::array<Offset, 26> result{};
    std::size_t n = 0;
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x)
                if (x != 0 || y != 0 || z != 0)
                    result[n++] = {x, y, z};
    return result;
}
constexpr std::array<Offset, 26> kNeighbours = MakeNeighbours();

bool TryPlace(const BspRegion &space, const Vec3f &p, int cluster, PointState state, PlacedPoint &placed) {
    const Vec3f margin{kClearance, kClearance, kClearance};
    if (cluster < 0 || space.AnySolid(p - margin, p + margin))
        return false;
    placed = {state, p, cluster};
    return true;
}

bool TryPlace(const BspRegion &space, const Vec3f &p, PointState state, PlacedPoint &placed) {
    return TryPlace(space, p, ClusterOfPoint(space, p), state, placed);
}

/// Small steps along the axes and diagonals, the nearest first.
bool TrySmallSteps(const BspRegion &space, const Vec3f &p, PlacedPoint &placed) {
    for (const float step : kSmallSteps)
        for (int axes = 1; axes <= 3; ++axes)
            for (const Offset &o : kNeighbours)
                if (std::abs(o.x) + std::abs(o.y) + std::abs(o.z) == axes &&
                    TryPlace(space, p + Vec3f{float(o.x), float(o.y), float(o.z)} * step, PointState::Beside, placed))
                    return true;
    return false;
}

/// Places within a cell around p on a lattice of quarter cells, the nearest first.
bool TryCells(const BspRegion &space, const Vec3f &p, const Vec3f &cell, PlacedPoint &placed) {
    constexpr int kSteps = 4;
    for (int shell = 1; shell <= kSteps; ++shell)
        for (int z = -shell; z <= shell; ++z)
            for (int y = -shell; y <= shell; ++y)
                for (int x = -shell; x <= shell; ++x) {
                    if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != shell)
                        continue;
                    const Vec3f offset = cell * Vec3f{float(x), float(y), float(z)} / kSteps;
                    if (TryPlace(space, p + offset, PointState::Moved, placed))
                        return true;
                }
    return false;
}

bool HasOpenNeighbour(const GridLayout &layout, const std::vector<int> &clusters, std::uint32_t index) {
    const std::int64_t width = layout.bounds[0], height = layout.bounds[1];
    const std::int64_t x = index % width, y = index / width % height, z = index / width / height;
    return std::any_of(kNeighbours.begin(), kNeighbours.end(), [&](const Offset &o) {
        const std::int64_t nx = x + o.x, ny = y + o.y, nz = z + o.z;
        return nx >= 0 && ny >= 0 && nz >= 0 && nx < width && ny < height && nz < layout.bounds[2] &&
               clusters[std::size_t(layout.Index(nx, ny, nz))] >= 0;
    });
}

/// Lit neighbours of one solid point that see each other.
struct Side {
    double weight = 0;
    std::array<std::array<double, 3>, 9> sum{};
    double Mean() const { return std::max(0.0, (sum[0][0] + sum[0][1] + sum[0][2]) / weight / 3 * kShC0); }
};

class Filler {
  public:
    Filler(const GridInputs &in, const GridLayout &layout, const std::vector<Displacement> &displaced,
           const std::vector<PointState> &states, const LightGridSH &grid)
        : in_(in), layout_(layout), displaced_(displaced), states_(states), grid_(grid) {}

    /// The value of a Solid or Beside point, or nothing: no lit neighbour, or none on another side.
    std::optional<bspGridPointSH_t> Fill(int x, int y, int z, bool divided) const {
        if (!divided && states_[IndexOf(x, y, z)] == PointState::Beside)
            return std::nullopt;
        const Around lit = AroundPoint(x, y, z);
        if (lit.count == 0)
            return std::nullopt;
        std::array<std::uint8_t, kMostAround> sides{};
        std::vector<Side> sums(divided ? std::size_t(FindSides(lit, sides)) : 1);
        for (std::size_t i = 0; i < lit.count; ++i)
            Add(lit.neighbours[i], sums[sides[i]]);
        return Blend(sums);
    }

    /// Whether what is lit around the point does not all see each other.
    bool Divided(int x, int y, int z) const {
        std::array<std::uint8_t, kMostAround> sides{};
        return FindSides(AroundPoint(x, y, z), sides) > 1;
    }

  private:
    struct Neighbour {
        std::size_t index;
        Vec3f place;
        double weight;
    };
    static constexpr std::size_t kMostAround = kNeighbours.size() + 1;
    /// Lit neighbours, and before them the point itself when it is lit beside.
    struct Around {
        std::array<Neighbour, kMostAround> neighbours;
        std::size_t count = 0;
    };

    std::size_t IndexOf(int x, int y, int z) const { return std::size_t(layout_.Index(x, y, z)); }
    double Shortest() const {
        const double shortest = double(std::min({layout_.size[0], layout_.size[1], layout_.size[2]}));
        return shortest * shortest;
    }

    Vec3f PlaceOf(std::size_t index, int x, int y, int z) const {
        if (states_[index] == PointState::Open || states_[index] == PointState::OnLamp)
            return Vec3f(layout_.Position(x, y, z));
        const auto found = std::lower_bound(displaced_.begin(), displaced_.end(), index,
                                            [](const Displacement &d, std::size_t i) { return d.index < i; });
        return found->position;
    }

    Around AroundPoint(int x, int y, int z) const {
        Around lit;
        const std::size_t own = IndexOf(x, y, z);
        if (states_[own] == PointState::Beside)
            lit.neighbours[lit.count++] = {own, PlaceOf(own, x, y, z), kOwnWeight / Shortest()};
        for (const Offset &o : kNeighbours) {
            const int nx = x + o.x, ny = y + o.y, nz = z + o.z;
            if (nx < 0 || ny < 0 || nz < 0 || nx >= layout_.bounds[0] || ny >= layout_.bounds[1] ||
                nz >= layout_.bounds[2])
                continue;
            const std::size_t index = IndexOf(nx, ny, nz);
            const PointState state = states_[index];
            if (state == PointState::Void || state == PointState::Solid)
                continue;
            const Vec3f offset = Vec3f(layout_.Position(nx, ny, nz)) - Vec3f(layout_.Position(x, y, z));
            lit.neighbours[lit.count++] = {index, PlaceOf(index, nx, ny, nz), 1 / double(Dot(offset, offset))};
        }
        return lit;
    }

    /// Sorts neighbours into sides, and returns how many there are: the first of a side sees all of it, and none of the
    /// sides before.
    int FindSides(const Around &lit, std::array<std::uint8_t, kMostAround> &sides) const {
        std::array<std::size_t, kMostAround> left;
        std::size_t count = lit.count;
        std::iota(left.begin(), left.begin() + std::ptrdiff_t(count), std::size_t(0));
        int side = 0;
        for (; count > 0; ++side) {
            const std::size_t first = left[0];
            sides[first] = std::uint8_t(side);
            std::size_t unseen = 0;
            for (std::size_t start = 1; start < count; start += kPacketSize) {
                const std::size_t end = std::min(count, start + kPacketSize);
                RayPacket rays;
                for (std::size_t i = start; i < end; ++i)
                    rays.Aim(i - start, lit.neighbours[left[i]].place, lit.neighbours[first].place);
                RayCounts counts;
                in_.scene.TraceToLight(rays, ShadowRules::Exact, counts);
                for (std::size_t i = start; i < end; ++i)
                    if (rays.live[i - start] != 0)
                        sides[left[i]] = std::uint8_t(side);
                    else
                        left[unseen++] = left[i];
            }
            count = unseen;
        }
        return side;
    }

    void Add(const Neighbour &neighbour, Side &side) const {
        side.weight += neighbour.weight;
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                side.sum[k][channel] += neighbour.weight * double(grid_.points[neighbour.index].coeffs[k][channel]);
    }

    static bspGridPointSH_t Blend(const std::vector<Side> &sides) {
        std::array<std::array<double, 3>, 9> sum{};
        double total = 0;
        for (const Side &side : sides) {
            const double weight = side.weight / (side.Mean() + kDarkest);
            total += weight;
            for (std::size_t k = 0; k < 9; ++k)
                for (std::size_t channel = 0; channel < 3; ++channel)
                    sum[k][channel] += side.sum[k][channel] / side.weight * weight;
        }
        bspGridPointSH_t filled;
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                filled.coeffs[k][channel] = float(sum[k][channel] / total);
        return filled;
    }

    const GridInputs &in_;
    const GridLayout &layout_;
    const std::vector<Displacement> &displaced_;
    const std::vector<PointState> &states_;
    const LightGridSH &grid_;
};

} // namespace

int ClusterOfPoint(const BspRegion &space, const Vec3f &p) {
    return space.ClusterAt(p, kClearance);
}

PlacedPoint PlaceGridPoint(const BspRegion &space, const GridLayout &layout, const std::vector<int> &clusters,
                           const BrickPoint &point) {
    PlacedPoint placed;
    const Vec3f cell(layout.size), &p = point.position;
    if (TryPlace(space, p, clusters[point.index], PointState::Open, placed) || !space.AnyOpen(p - cell, p + cell))
        return placed;
    constexpr float kReach = *std::max_element(std::begin(kSmallSteps), std::end(kSmallSteps));
    const Vec3f reach{kReach, kReach, kReach};
    if (space.AnyOpen(p - reach, p + reach) && TrySmallSteps(space, p, placed))
        return placed;
    if (HasOpenNeighbour(layout, clusters, point.index))
        placed.state = PointState::Solid;
    else
        TryCells(space, p, cell, placed);
    return placed;
}

std::vector<bool> DividedPoints(const GridInputs &in, const GridLayout &layout,
                                const std::vector<Displacement> &displaced, const std::vector<PointState> &states,
                                const LightGridSH &grid) {
    const int width = layout.bounds[0], height = layout.bounds[1];
    const Filler filler(in, layout, displaced, states, grid);
    std::vector<std::uint8_t> found(states.size());
    in.jobs.For(std::int64_t(height) * layout.bounds[2], [&](std::int64_t row, int) {
        for (int x = 0; x < width; ++x) {
            const auto index = std::size_t(row) * std::size_t(width) + std::size_t(x);
            if (states[index] == PointState::Solid || states[index] == PointState::Beside)
                found[index] = filler.Divided(x, int(row % height), int(row / height));
        }
    });
    return {found.begin(), found.end()};
}

void FillGridSH(const GridInputs &in, const GridLayout &layout, const std::vector<Displacement> &displaced,
                const std::vector<bool> &divided, std::vector<PointState> &states, LightGridSH &grid) {
    struct Value {
        std::size_t index;
        bspGridPointSH_t point;
    };
    const int width = layout.bounds[0], height = layout.bounds[1];
    const std::int64_t rows = std::int64_t(height) * layout.bounds[2];
    // Sources are values as they were lit, so the order of filling does not matter.
    std::vector<std::vector<Value>> filled(static_cast<std::size_t>(rows));
    const Filler filler(in, layout, displaced, states, grid);
    in.jobs.For(rows, [&](std::int64_t row, int) {
        for (int x = 0; x < width; ++x) {
            const auto index = std::size_t(row) * std::size_t(width) + std::size_t(x);
            if (states[index] == PointState::Solid || states[index] == PointState::Beside)
                if (const auto value = filler.Fill(x, int(row % height), int(row / height), divided[index]))
                    filled[std::size_t(row)].push_back({index, *value});
        }
    });
    for (const auto &row : filled)
        for (const Value &value : row) {
            grid.points[value.index] = value.point;
            states[value.index] = PointState::Filled;
        }
    std::replace(states.begin(), states.end(), PointState::Solid, PointState::Void);
}

} // namespace q3
