// GPL-2.0-or-later. Refinement of the octree where the light is not smooth.
#include "q3map2/light/sparse/octree_refine.h"

#include "common/parallel.h"
#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/sparse/display_error.h"

#include <array>
#include <bit>
#include <limits>

namespace q3 {

namespace {

/// Expected squared error of a cell of the uniform grid, divided by the sum over the axes of its mean SecondDifference.
/// Chosen between the ratio of smooth light, 0.02, and that of edges, up to 0.25.
constexpr float kSecondDifferenceRatio = 0.15f;
/// Expected squared error of a cell made by a split, divided by the mean squared surplus of its corners. Chosen between
/// the ratio of smooth light, 0.06, and that of edges, up to 1.
constexpr float kSurplusRatio = 0.2f;
/// Weight of a point in a solid in the error of a large cell; a point in the open has weight 1. Its value counts, since
/// interpolation beside the solid uses it.
constexpr float kSolidWeight = 0.5f;
/// Noise of variance V at all points adds this times V to a squared surplus, and to a squared second difference along
/// an axis: 1 + sum of the squared weights of the points between which is interpolated. For second differences these
/// are two of weight 1/2; for surpluses the sum is 1/8 in the center of a cell to 1/2 in the middle of an edge.
constexpr float kNoiseOfSurplus = 1.3f, kNoiseOfSecond = 1.5f;
/// Cells or points of one job.
constexpr std::size_t kChunk = 256;
/// Of the new points of cells that are split, the fraction that remains when those of several cells count once;
/// typical.
constexpr double kNewOnce = 0.6;

/// Calls use(p) for the points of the uniform grid's lattice in a closed cell of the base level or above.
template <typename Use> void ForUniformPoints(const SparseLattice &lattice, const OctreeCell &cell, const Use &use) {
    const auto step = [&](std::size_t axis) { return std::int32_t(1) << lattice.UniformLevel(axis); };
    for (std::int32_t z = 0; z <= cell.Edge(); z += step(2))
        for (std::int32_t y = 0; y <= cell.Edge(); y += step(1))
            for (std::int32_t x = 0; x <= cell.Edge(); x += step(0))
                use(LatticePoint{cell.origin[0] + x, cell.origin[1] + y, cell.origin[2] + z});
}

SHFloats Interpolated(const OctreeCell &cell, const CornerLight &corners, const LatticePoint &p) {
    return InterpolatedLight(cell, corners, LatticePosition(p));
}

/// A mean of squared differences without what noise adds to it.
float WithoutNoise(float measured, float noise) {
    return std::max(0.0f, measured - noise);
}

} // namespace

CornerLight CornersOf(const LatticePoints &points, const OctreeCell &cell) {
    CornerLight corners{};
    for (std::size_t c = 0; c < 8; ++c)
        if (const std::uint32_t number = points.Find(cell.Corner(c)); number != LatticePoints::kUnknown)
            corners[c] = &points[number].value;
    return corners;
}

SHFloats InterpolatedLight(const OctreeCell &cell, const CornerLight &corners, const Vec3f &at) {
    return Vectorize([&]() Q3_INLINE {
        SHFloats value{};
        for (std::size_t c = 0; c < 8; ++c) {
            const float weight = cell.Weight(c, at);
            if (weight == 0)
                continue;
            for (std::size_t i = 0; i < kSHFloats; ++i)
                value[i] += weight * (*corners[c])[i];
        }
        return value;
    });
}

LatticePoint OctreeRefiner::ChildCorner(const OctreeCell &cell, std::size_t n) {
    const std::int32_t half = cell.Edge() / 2;
    return {cell.origin[0] + std::int32_t(n % 3) * half, cell.origin[1] + std::int32_t(n / 3 % 3) * half,
            cell.origin[2] + std::int32_t(n / 9) * half};
}

bool OctreeRefiner::HasOpenSpace(const OctreeCell &cell) const {
    return space_.AnyOpen(lattice_.PositionOf(cell.origin), lattice_.PositionOf(cell.Corner(7)), kClearance);
}

float OctreeRefiner::OpenFraction(const OctreeCell &cell) const {
    float fraction = 0;
    for (std::size_t c = 0; c < 8; ++c) {
        const std::uint32_t number = points_.Find(cell.Corner(c));
        fraction += number != LatticePoints::kUnknown && points_[number].traced ? 1.0f / 8 : 0;
    }
    return std::max(fraction, 1.0f / 8); // all corners may be in solids
}

void OctreeRefiner::Start(const LightGridSH &uniform, bool radiance) {
    for (std::size_t first = 0, end = tree_.Size(); first < end; first = end, end = tree_.Size()) { // cells of a level
        ForAll(jobs_, end - first, kChunk,
               [&](std::size_t i) { tree_[first + i].openFraction = HasOpenSpace(tree_[first + i]) ? 1.0f : 0.0f; });
        std::vector<std::size_t> split;
        for (std::size_t i = first; i < end; ++i)
            if (tree_[i].openFraction > 0 && tree_[i].level > lattice_.BaseLevel())
                split.push_back(i);
        tree_.Split(split, jobs_);
    }
    AddUniformPoints(uniform, radiance);
    ForAll(jobs_, tree_.Size(), kChunk, [&](std::size_t i) {
        if (tree_[i].openFraction > 0)
            tree_[i].openFraction = OpenFraction(tree_[i]);
    });
}

void OctreeRefiner::AddUniformPoints(const LightGridSH &uniform, bool radiance) {
    points_.AddUniform(
        [&](const auto &add) {
            for (std::size_t i = 0; i < tree_.Size(); ++i)
                if (tree_[i].level == lattice_.BaseLevel() && tree_[i].openFraction > 0)
                    ForUniformPoints(lattice_, tree_[i], add);
        },
        jobs_);
    ForAll(jobs_, points_.Size(), kChunk, [&](std::size_t i) {
        LatticeSample &point = points_[i];
        point.value = ToDisplayed(uniform.points[lattice_.UniformIndex(point.at)], radiance);
        point.traced = PlaceInOpen(space_, lattice_.PositionOf(point.at)).state == PointState::Open;
    });
}

/// Sum of the squared displayed differences of a point from the mean of its two neighbors, over the axes along which
/// base cells have no points of the uniform grid between their corners. Axes on which one of the three is in a solid do
/// not count.
float OctreeRefiner::SecondDifference(const LatticeSample &point) const {
    float sum = 0;
    for (std::size_t axis = 0; axis < 3 && point.traced; ++axis) {
        if (lattice_.UniformLevel(axis) < lattice_.BaseLevel())
            continue;
        LatticePoint low = point.at, high = point.at;
        low[axis] -= 1 << lattice_.BaseLevel();
        high[axis] += 1 << lattice_.BaseLevel();
        const std::uint32_t a = points_.Find(low), b = points_.Find(high);
        if (a == LatticePoints::kUnknown || b == LatticePoints::kUnknown || !points_[a].traced || !points_[b].traced)
            continue;
        SHFloats mean;
        for (std::size_t i = 0; i < kSHFloats; ++i)
            mean[i] = 0.5f * (points_[a].value[i] + points_[b].value[i]);
        sum += WithoutNoise(SquaredDisplayError(mean, point.value), kNoiseOfSecond * noise_.At(point.at));
    }
    return sum;
}

/// Mean squared error of interpolation at the points of the uniform grid inside a cell and on its boundary; infinite
/// where a corner is not known.
float OctreeRefiner::MeasuredError(const OctreeCell &cell) const {
    const CornerLight corners = CornersOf(points_, cell);
    if (std::find(corners.begin(), corners.end(), nullptr) != corners.end())
        return std::numeric_limits<float>::infinity();
    float sum = 0, count = 0;
    ForUniformPoints(lattice_, cell, [&](const LatticePoint &p) {
        const std::uint32_t number = points_.Find(p);
        if (number == LatticePoints::kUnknown || cell.HasCorner(p))
            return;
        const float weight = points_[number].traced ? 1 : kSolidWeight;
        sum += weight * WithoutNoise(SquaredDisplayError(Interpolated(cell, corners, p), points_[number].value),
                                     kNoiseOfSurplus * noise_.At(p));
        count += weight;
    });
    return count > 0 ? sum / count : 0;
}

void OctreeRefiner::EstimateErrors(BounceNoise noise) {
    noise_ = std::move(noise);
    std::vector<float> second(points_.Size());
    ForAll(jobs_, second.size(), kChunk, [&](std::size_t i) { second[i] = SecondDifference(points_[i]); });
    ForAll(jobs_, tree_.Size(), kChunk, [&](std::size_t i) {
        OctreeCell &cell = tree_[i];
        if (cell.level < lattice_.BaseLevel() || cell.openFraction <= 0)
            return;
        cell.error = MeasuredError(cell);
        if (cell.level > lattice_.BaseLevel())
            return;
        float sum = 0, count = 0;
        ForUniformPoints(lattice_, cell, [&](const LatticePoint &p) {
            if (const std::uint32_t number = points_.Find(p); points_[number].traced)
                sum += second[number], ++count;
        });
        cell.error += count > 0 ? kSecondDifferenceRatio * sum / count : 0;
    });
}

void OctreeRefiner::Refine(float threshold, const LatticeTracer &tracer, GridStats &stats) {
    for (int level = lattice_.BaseLevel(); level > 0; --level) {
        std::vector<std::size_t> cells;
        for (std::size_t i = 0; i < tree_.Size(); ++i)
            if (tree_[i].child == 0 && tree_[i].level == level && tree_[i].error * tree_[i].Volume() > threshold)
                cells.push_back(i);
        Split(cells, tracer, stats);
    }
}

void OctreeRefiner::Split(const std::vector<std::size_t> &cells, const LatticeTracer &tracer, GridStats &stats) {
    const std::size_t firstNew = points_.Size();
    std::vector<std::uint32_t> unknown(cells.size()); // by cell: bit n is set if ChildCorner n is not in points_
    ForAll(jobs_, cells.size(), kChunk, [&](std::size_t i) {
        for (std::size_t n = 0; n < 27; ++n)
            unknown[i] |= std::uint32_t(points_.Find(ChildCorner(tree_[cells[i]], n)) == LatticePoints::kUnknown) << n;
    });
    std::size_t added = 0;
    for (const std::uint32_t bits : unknown)
        added += std::size_t(std::popcount(bits));
    points_.Reserve(firstNew + std::size_t(kNewOnce * double(added)), jobs_);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        points_.Reserve(points_.Size() + 27, jobs_); // in case more remain
        for (std::uint32_t left = unknown[i]; left != 0; left &= left - 1)
            points_.Add(ChildCorner(tree_[cells[i]], std::size_t(std::countr_zero(left))));
    }
    tracer.Trace(points_, firstNew, stats);
    FillSolids(cells, firstNew);
    tree_.Split(cells, jobs_);
    ForAll(jobs_, cells.size(), kChunk, [&](std::size_t i) { SetErrorsAfterSplit(cells[i]); });
}

/// Sets the values of new points in solids. A point of several cells gets the mean over them.
void OctreeRefiner::FillSolids(const std::vector<std::size_t> &cells, std::size_t firstNew) {
    std::vector<std::vector<SolidValue>> values((cells.size() + kChunk - 1) / kChunk);
    ForAll(jobs_, cells.size(), kChunk,
           [&](std::size_t i) { AddSolidValues(tree_[cells[i]], firstNew, values[i / kChunk]); });
    std::vector<float> counts(points_.Size() - firstNew); // by new point: values that it has got
    for (const std::vector<SolidValue> &ofChunk : values)
        for (const SolidValue &one : ofChunk) {
            float &count = counts[one.number - firstNew];
            SHFloats &mean = points_[one.number].value;
            for (std::size_t k = 0; k < kSHFloats; ++k)
                mean[k] = (mean[k] * count + one.value[k]) / (count + 1);
            ++count;
        }
}

/// Appends the values of the new points of a cell in solids: interpolated in the cell that was split, whose corners are
/// not new, plus the mean surplus of its points in the open, weighted by the inverse of their squared distance.
void OctreeRefiner::AddSolidValues(const OctreeCell &cell, std::size_t firstNew,
                                   std::vector<SolidValue> &values) const {
    std::array<std::uint32_t, 27> numbers{};
    bool anySolid = false;
    for (std::size_t n = 0; n < 27; ++n) {
        numbers[n] = points_.Find(ChildCorner(cell, n));
        anySolid = anySolid || (numbers[n] >= firstNew && !points_[numbers[n]].traced);
    }
    if (!anySolid)
        return;
    std::array<SHFloats, 27> interpolated;
    const CornerLight corners = CornersOf(points_, cell);
    for (std::size_t n = 0; n < 27; ++n)
        interpolated[n] = Interpolated(cell, corners, points_[numbers[n]].at);
    for (std::size_t n = 0; n < 27; ++n) {
        const LatticeSample &point = points_[numbers[n]];
        if (numbers[n] < firstNew || point.traced)
            continue;
        SHFloats surplus{};
        float total = 0;
        for (std::size_t m = 0; m < 27; ++m) {
            const LatticeSample &other = points_[numbers[m]];
            if (!other.traced)
                continue;
            const Vec3f away = (LatticePosition(other.at) - LatticePosition(point.at)) * lattice_.Cell();
            const float weight = 1 / Dot(away, away);
            total += weight;
            for (std::size_t k = 0; k < kSHFloats; ++k)
                surplus[k] += weight * (other.value[k] - interpolated[m][k]);
        }
        SolidValue &one = values.emplace_back(SolidValue{numbers[n], {}});
        for (std::size_t k = 0; k < kSHFloats; ++k)
            one.value[k] = interpolated[n][k] + (total > 0 ? surplus[k] / total : 0);
    }
}

/// Sets the error that a cell had before it was split, which is the mean squared surplus of its children's corners, and
/// the open fractions and expected errors of the children.
void OctreeRefiner::SetErrorsAfterSplit(std::size_t parent) {
    OctreeCell &cell = tree_[parent];
    const CornerLight corners = CornersOf(points_, cell);
    std::array<float, 27> surplus{};
    std::array<bool, 27> known{};
    float sum = 0, count = 0;
    for (std::size_t n = 0; n < 27; ++n) {
        const LatticeSample &point = points_.At(ChildCorner(cell, n));
        known[n] = point.traced && !cell.HasCorner(point.at);
        if (!known[n])
            continue;
        surplus[n] = WithoutNoise(SquaredDisplayError(Interpolated(cell, corners, point.at), point.value),
                                  kNoiseOfSurplus * noise_.At(point.at));
        sum += surplus[n], ++count;
    }
    cell.error = count > 0 ? sum / count : 0;
    for (std::size_t c = 0; c < 8; ++c) {
        OctreeCell &child = tree_[cell.child + c];
        child.openFraction = HasOpenSpace(child) ? OpenFraction(child) : 0;
        float childSum = 0, childCount = 0;
        for (std::size_t d = 0; d < 8; ++d) { // ChildCorner(cell, n) is corner d of child c
            const std::size_t n = ((c & 1) + (d & 1)) + 3 * ((c >> 1 & 1) + (d >> 1 & 1)) + 9 * ((c >> 2) + (d >> 2));
            if (known[n])
                childSum += surplus[n], ++childCount;
        }
        child.error = childCount > 0 ? kSurplusRatio * childSum / childCount : 0;
    }
}

} // namespace q3
