// GPL-2.0-or-later. SH grid points in solids.
#include "q3map2/light/gridsh_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
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

bool TryPlace(const BspSpace &space, const Vec3f &p, PointState state, PlacedPoint &placed) {
    const Vec3f margin{kClearance, kClearance, kClearance};
    const int cluster = space.ClusterAt(p, kClearance);
    if (cluster < 0 || space.AnySolid(p - margin, p + margin))
        return false;
    placed = {state, p, cluster};
    return true;
}

/// Small steps along the axes and diagonals, the nearest first.
bool TrySmallSteps(const BspSpace &space, const Vec3f &p, PlacedPoint &placed) {
    for (const float step : kSmallSteps)
        for (int axes = 1; axes <= 3; ++axes)
            for (const Offset &o : kNeighbours)
                if (std::abs(o.x) + std::abs(o.y) + std::abs(o.z) == axes &&
                    TryPlace(space, p + Vec3f{float(o.x), float(o.y), float(o.z)} * step, PointState::Beside, placed))
                    return true;
    return false;
}

/// Places within a cell around p on a lattice of quarter cells, the nearest first.
bool TryCells(const BspSpace &space, const Vec3f &p, const Vec3f &cell, PlacedPoint &placed) {
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

bool HasOpenNeighbour(const BspSpace &space, const GridLayout &layout, const Vec3f &p) {
    const Vec3f cell(layout.size);
    const Boundsf grid{Vec3f(layout.mins),
                       Vec3f(layout.Position(layout.bounds[0] - 1, layout.bounds[1] - 1, layout.bounds[2] - 1))};
    return std::any_of(kNeighbours.begin(), kNeighbours.end(), [&](const Offset &o) {
        const Vec3f neighbour = p + cell * Vec3f{float(o.x), float(o.y), float(o.z)};
        return grid.Contains(neighbour) && space.ClusterAt(neighbour, kClearance) >= 0;
    });
}

/// Lit neighbours of one solid point that see each other.
struct Side {
    Vec3f first;
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
        const std::vector<Side> sides = SidesOf(x, y, z, divided);
        if (sides.empty())
            return std::nullopt;
        return Blend(sides);
    }

    /// Lit neighbours, and the point itself when it is lit beside, by what sees each other. divided: false when all
    /// are known to; then no ray is needed.
    std::vector<Side> SidesOf(int x, int y, int z, bool divided) const {
        std::vector<Side> sides;
        const std::size_t index = IndexOf(x, y, z);
        if (states_[index] == PointState::Beside)
            Add(index, PlaceOf(index, x, y, z), kOwnWeight / Shortest(), divided, sides);
        for (const Offset &o : kNeighbours)
            AddNeighbour(x, y, z, o, divided, sides);
        return sides;
    }

  private:
    std::size_t IndexOf(int x, int y, int z) const {
        return std::size_t(x) +
               std::size_t(layout_.bounds[0]) * (std::size_t(y) + std::size_t(layout_.bounds[1]) * std::size_t(z));
    }
    double Shortest() const {
        const double shortest = double(std::min({layout_.size[0], layout_.size[1], layout_.size[2]}));
        return shortest * shortest;
    }

    Vec3f PlaceOf(std::size_t index, int x, int y, int z) const {
        if (states_[index] == PointState::Open)
            return Vec3f(layout_.Position(x, y, z));
        const auto found = std::lower_bound(displaced_.begin(), displaced_.end(), index,
                                            [](const Displacement &d, std::size_t i) { return d.index < i; });
        return found->position;
    }

    void AddNeighbour(int x, int y, int z, const Offset &o, bool divided, std::vector<Side> &sides) const {
        const int nx = x + o.x, ny = y + o.y, nz = z + o.z;
        if (nx < 0 || ny < 0 || nz < 0 || nx >= layout_.bounds[0] || ny >= layout_.bounds[1] || nz >= layout_.bounds[2])
            return;
        const std::size_t index = IndexOf(nx, ny, nz);
        const PointState state = states_[index];
        if (state != PointState::Open && state != PointState::Beside && state != PointState::Moved)
            return;
        const Vec3f offset = Vec3f(layout_.Position(nx, ny, nz)) - Vec3f(layout_.Position(x, y, z));
        Add(index, PlaceOf(index, nx, ny, nz), 1 / double(Dot(offset, offset)), divided, sides);
    }

    void Add(std::size_t index, const Vec3f &place, double weight, bool divided, std::vector<Side> &sides) const {
        Side &side = !divided && !sides.empty() ? sides.front() : FindSide(place, sides);
        side.weight += weight;
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                side.sum[k][channel] += weight * double(grid_.points[index].coeffs[k][channel]);
    }

    /// The side that the place sees, or a new one.
    Side &FindSide(const Vec3f &p, std::vector<Side> &sides) const {
        RayPacket rays;
        const std::size_t known = std::min(sides.size(), kPacketSize);
        for (std::size_t i = 0; i < known; ++i)
            rays.Aim(i, p, sides[i].first);
        if (known > 0) {
            RayCounts counts;
            in_.scene.TraceToLight(rays, ShadowRules::Exact, counts);
        }
        for (std::size_t i = 0; i < known; ++i)
            if (rays.live[i] != 0)
                return sides[i];
        sides.push_back({});
        sides.back().first = p;
        return sides.back();
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

PlacedPoint PlaceGridPoint(const BspSpace &space, const GridLayout &layout, const Vec3f &p) {
    PlacedPoint placed;
    const Vec3f cell(layout.size);
    if (TryPlace(space, p, PointState::Open, placed) || !space.AnyOpen(p - cell, p + cell))
        return placed;
    constexpr float kReach = *std::max_element(std::begin(kSmallSteps), std::end(kSmallSteps));
    const Vec3f reach{kReach, kReach, kReach};
    if (space.AnyOpen(p - reach, p + reach) && TrySmallSteps(space, p, placed))
        return placed;
    if (HasOpenNeighbour(space, layout, p))
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
                found[index] = filler.SidesOf(x, int(row % height), int(row / height), true).size() > 1;
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
