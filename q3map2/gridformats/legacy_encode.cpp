// GPL-2.0-or-later. Points of the legacy grid as engines read them, sampled from the SH grid: lump 15, and
// lightgrid.raw.
#include "q3map2/gridformats/legacy_encode.h"

#include "common/error.h"
#include "q3map2/gridformats/grid_source.h"
#include "q3map2/light/grid/light_grid.h"
#include "q3map2/light/grid/probe_integrator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

// ---- The SH grid sampled at the points of the legacy grid ----

namespace {

/// Content flags. The games of RBSP have their own.
constexpr std::int32_t kContentsSolid = 1, kContentsTranslucent = 0x20000000,
                       kRbspContentsTranslucent = std::int32_t(0x80000000);
/// The epsilon of BspSpace::AnyOpen: opaque brushes count as 0.125 game units smaller on each side.
constexpr float kBrushMargin = -0.125f;

/// Calls f(x, y, z, index) for each point of a layout in its order.
template <typename F> void EachPoint(const GridLayout &layout, const F &f) {
    std::size_t index = 0;
    for (int z = 0; z < layout.bounds[2]; ++z)
        for (int y = 0; y < layout.bounds[1]; ++y)
            for (int x = 0; x < layout.bounds[0]; ++x)
                f(x, y, z, index++);
}

/// Calls f(index, squared distance) for the up to 26 neighbors of a point.
template <typename F> void EachNeighbor(const GridLayout &layout, int x, int y, int z, const F &f) {
    for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const int ax = x + dx, ay = y + dy, az = z + dz;
                if ((dx == 0 && dy == 0 && dz == 0) || ax < 0 || ay < 0 || az < 0 || ax >= layout.bounds[0] ||
                    ay >= layout.bounds[1] || az >= layout.bounds[2])
                    continue;
                const Vec3f step = Vec3f(layout.size) * Vec3f{float(dx), float(dy), float(dz)};
                f(std::size_t(layout.Index(ax, ay, az)), Dot(step, step));
            }
}

/// Classifies and lights the points of a legacy grid.
class PointSampler {
  public:
    PointSampler(const GridSource &source, const BspSpace &space, const GridLayout &layout)
        : source_(source), space_(space), lit_(std::size_t(layout.Count())) {
        points_.layout = layout;
        points_.light.resize(lit_.size());
        points_.use.assign(lit_.size(), PointUse::Void);
    }

    LegacyPoints Run() {
        const std::vector<bool> solid = SolidPoints(space_, points_.layout);
        EachPoint(points_.layout, [&](int x, int y, int z, std::size_t index) {
            const Vec3f at(points_.layout.Position(x, y, z));
            if (!solid[index])
                points_.use[index] = PointUse::Open;
            else if (space_.AnyOpen(at - Cell(), at + Cell(), kBrushMargin))
                points_.use[index] = PointUse::Solid;
            else
                return;
            // In the open, no light in reach means darkness.
            lit_[index] = source_.Sample(at, points_.light[index]) || !solid[index];
        });
        EachPoint(points_.layout, [&](int x, int y, int z, std::size_t) { MarkSoleSources(x, y, z); });
        while (Dilate()) {
        }
        return std::move(points_);
    }

  private:
    Vec3f Cell() const { return Vec3f(points_.layout.size); }

    /// Marks the corners of the cell whose lowest corner is the point, if it has open space but all corners are in
    /// solids.
    void MarkSoleSources(int x, int y, int z) {
        const GridLayout &layout = points_.layout;
        std::array<std::size_t, 8> corners{};
        for (unsigned i = 0; i < 8; ++i) {
            const int at[3] = {x + int(i & 1), y + int(i >> 1 & 1), z + int(i >> 2)};
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (at[axis] >= layout.bounds[axis])
                    return;
            corners[i] = std::size_t(layout.Index(at[0], at[1], at[2]));
        }
        const auto isOpen = [this](std::size_t i) { return points_.use[i] == PointUse::Open; };
        const Vec3f mins(layout.Position(x, y, z));
        if (std::ranges::any_of(corners, isOpen) || !space_.AnyOpen(mins, mins + Cell(), kBrushMargin))
            return;
        for (const std::size_t i : corners)
            points_.use[i] = PointUse::SoleSource;
    }

    /// Lights points in solids that have lit neighbors, from the state before this round. False: there are none.
    bool Dilate() {
        const std::vector<bool> before = lit_;
        bool any = false;
        EachPoint(points_.layout, [&](int x, int y, int z, std::size_t index) {
            if (before[index] || points_.use[index] == PointUse::Void)
                return;
            bspGridPointSH_t sum{};
            float total = 0;
            EachNeighbor(points_.layout, x, y, z, [&](std::size_t from, float distanceSquared) {
                if (!before[from])
                    return;
                const float weight = 1 / distanceSquared;
                total += weight;
                AddScaled(weight, points_.light[from], sum);
            });
            if (!(total > 0))
                return;
            for (Float3 &rgb : sum.coeffs)
                for (float &value : rgb)
                    value /= total;
            points_.light[index] = sum;
            lit_[index] = any = true;
        });
        return any;
    }

    const GridSource &source_;
    const BspSpace &space_;
    LegacyPoints points_;
    std::vector<bool> lit_;
};

} // namespace

GridLayout LegacyLayout(const Bsp &bsp) {
    if (bsp.models.empty())
        throw Error("the map has no world model, so no place for a light grid");
    const Vec3f cell = LegacyCell(bsp);
    const GridLayout layout = LayoutGrid(bsp.models[0].mins, bsp.models[0].maxs, cell.Array());
    if (layout.Count() > std::max(kMaxLegacyPoints, std::int64_t(bsp.gridPoints.size())))
        throw Error("the legacy light grid has {} points with the gridsize {} {} {}, expected at most {}",
                    layout.Count(), cell.x, cell.y, cell.z, kMaxLegacyPoints);
    return layout;
}

LegacyPoints SampleLegacyPoints(const GridSource &source, const BspSpace &space, const GridLayout &layout) {
    return PointSampler(source, space, layout).Run();
}

std::vector<bool> SolidBrushes(const Bsp &bsp) {
    std::vector<bool> solid;
    solid.reserve(bsp.brushes.size());
    const std::int32_t translucent = bsp.ident == kRbspIdent ? kRbspContentsTranslucent : kContentsTranslucent;
    for (const bspBrush_t &brush : bsp.brushes) {
        const std::int32_t contents = bsp.shaders[std::size_t(brush.shaderNum)].contentFlags;
        solid.push_back((contents & kContentsSolid) != 0 && (contents & translucent) == 0);
    }
    return solid;
}

std::vector<bool> SolidPoints(const BspSpace &space, const GridLayout &layout) {
    std::vector<bool> solid(std::size_t(layout.Count()));
    EachPoint(layout, [&](int x, int y, int z, std::size_t index) {
        solid[index] = space.ClusterAt(Vec3f(layout.Position(x, y, z)), 0) == kSolidCluster;
    });
    return solid;
}

// ---- Points of the legacy grid as engines read them: lump 15, and lightgrid.raw ----

namespace {

constexpr double kMaxByte = 255;

/// The ambient and directed light that the engine should show.
AmbientDirected FitFor(const bspGridPointSH_t &light, const LegacyTarget &target, const GridTone &tone,
                       double ambientFactor) {
    // The least ambient light that the engine shows: that of byte 1. With a tone, the light that becomes byte 1 is not
    // known.
    const bool addsToBlack = target.ambientAdded > 0 && ambientFactor == 1 && tone.IsPlain();
    const double least = addsToBlack ? (target.ambientScale + target.ambientAdded) / kMaxByte : 0;
    AmbientDirected fit =
        target.directedWeight > 0 ? FitMeanAndDirected(light, target.directedWeight) : FitAmbientDirected(light, least);
    fit.ambient *= ambientFactor;
    return fit;
}

bool IsWritten(PointUse use, const LegacyTarget &target) {
    return use == PointUse::Open || use == PointUse::SoleSource || (use == PointUse::Solid && !target.skipsSolid);
}

/// Ambient light from which the engine's factor and addition make this. Byte scale.
Vec3d UndoAmbient(const Vec3d &ambient, const LegacyTarget &target) {
    const double added = target.ambientAdded;
    return Max(ambient - Vec3d{added, added, added}, Vec3d{}) / target.ambientScale;
}

/// Rounded; what is brighter than 255 keeps its hue.
std::array<std::uint8_t, 3> ToBytes(Vec3d color) {
    if (const double most = MaxComponent(color); most > kMaxByte)
        color *= kMaxByte / most;
    std::array<std::uint8_t, 3> bytes;
    for (std::size_t i = 0; i < 3; ++i)
        bytes[i] = std::uint8_t(std::lround(color[i]));
    return bytes;
}

void AppendFloats(const Vec3d &color, std::vector<std::byte> &bytes) {
    for (const float value : Vec3f(color).Array()) {
        const auto *from = reinterpret_cast<const std::byte *>(&value);
        bytes.insert(bytes.end(), from, from + sizeof value);
    }
}

} // namespace

std::array<std::uint8_t, 2> EncodeDirection(const Vec3d &direction, int angleSteps) {
    const double steps = angleSteps / (2 * std::numbers::pi);
    const int fromZ = int(std::lround(std::acos(std::clamp(direction.z, -1.0, 1.0)) * steps));
    const bool isPole = direction.x == 0 && direction.y == 0;
    const int aroundZ = isPole ? 0 : int(std::lround(std::atan2(direction.y, direction.x) * steps));
    return {std::uint8_t(fromZ), std::uint8_t((aroundZ + angleSteps) % angleSteps)};
}

std::vector<bspGridPoint_t> EncodeLegacyGrid(const LegacyPoints &points, const LegacyTarget &target,
                                             const GridTone &tone, double ambientFactor) {
    std::vector<bspGridPoint_t> grid(points.light.size(), bspGridPoint_t{});
    for (std::size_t i = 0; i < grid.size(); ++i) {
        if (!IsWritten(points.use[i], target))
            continue;
        const AmbientDirected fit = FitFor(points.light[i], target, tone, ambientFactor);
        bspGridPoint_t &point = grid[i];
        point.ambient[0] = ToBytes(UndoAmbient(tone.Limited(fit.ambient), target));
        point.directed[0] = ToBytes(tone.Limited(fit.directed));
        if (point.ambient[0] == std::array<std::uint8_t, 3>{})
            point.ambient[0] = {1, 1, 1};
        point.latLong = EncodeDirection(fit.direction, target.angleSteps);
    }
    return grid;
}

std::vector<std::byte> EncodeRawGrid(const LegacyPoints &points, const LegacyTarget &target, const GridTone &tone,
                                     double ambientFactor, double scale) {
    constexpr double kMinAmbient = 1; // of 255: points outside the void are never black
    std::vector<std::byte> bytes;
    constexpr std::size_t kFloats = 6; // ambient and directed color
    bytes.reserve(points.light.size() * kFloats * sizeof(float));
    for (std::size_t i = 0; i < points.light.size(); ++i) {
        Vec3d ambient, directed;
        if (IsWritten(points.use[i], target)) {
            const AmbientDirected fit = FitFor(points.light[i], target, tone, ambientFactor);
            ambient = UndoAmbient(tone.Unlimited(fit.ambient), target);
            directed = tone.Unlimited(fit.directed);
            if (ambient == Vec3d{})
                ambient = {kMinAmbient, kMinAmbient, kMinAmbient};
        }
        AppendFloats(ambient * scale, bytes);
        AppendFloats(directed * scale, bytes);
    }
    return bytes;
}

} // namespace q3
