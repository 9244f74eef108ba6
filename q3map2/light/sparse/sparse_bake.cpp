// GPL-2.0-or-later. Bakes the sparse SH grid.
#include "q3map2/light/sparse/sparse_bake.h"

#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/light/sparse/corner_fit.h"
#include "q3map2/light/sparse/display_error.h"
#include "q3map2/light/sparse/near_light_samples.h"
#include "q3map2/light/sparse/octree.h"
#include "q3map2/light/sparse/octree_refine.h"

#include <cmath>

namespace q3 {

namespace {

/// Thresholds of refinement fall from the first one by this factor: bytes^2 times an eighth of an eighth of the volume
/// of a cell of the uniform grid.
constexpr float kFirstThreshold = 16384, kThresholdStep = 2.5f, kMinThreshold = 1;
/// Leafs that a split adds.
constexpr float kLeafsPerSplit = 7;
/// Prices of a leaf (see PruneOctree): the lowest without refinement, and the highest. Bytes^2 times smallest cells.
constexpr float kMinPrice = 1.0f / 64, kMaxPrice = 1e9f;
/// The price is found by kBisections bisections, on a logarithmic scale, of a range from the lowest price that
/// refinement allows to kPriceRange times that.
constexpr float kPriceRange = 65536;
constexpr int kBisections = 14;
/// Refinement to an error target ends where a further leaf reduces the squared error by less than this fraction of the
/// mean squared error of a leaf.
constexpr double kMinGain = 0.25;
/// It also ends where kMoreLeafs times the leafs leave more than this fraction, kLeastFall, of the measured error.
constexpr double kMoreLeafs = 1.5, kLeastFall = 0.97;
/// The price of a leaf grows by this factor while the lump exceeds its limit.
constexpr float kPriceStep = 1.15f;
/// Without a budget the lump has at most this fraction of the bytes of the uniform grid, whatever its error, or
/// kSmallLump bytes if that is more.
constexpr double kMaxFractionOfUniform = 0.5, kSmallLump = 80e3;
/// Upper estimate of the bytes of the lump per leaf; its fraction of a node, and the bytes of a stored point.
constexpr double kBytesPerLeaf = 25, kNodeBytesPerLeaf = 2, kBytesPerPoint = 28;
/// Cells that positions near lights need take at most this fraction of a lump that is at its limit: beyond it, the
/// error allowed near lights grows by kNearLightSlackStep.
constexpr double kMaxNearLightFraction = 0.5;
constexpr float kNearLightSlackStep = 1.5f;
/// Cells near lights are split while their error is above this many error targets.
constexpr float kNearLightTargets = 1.6f;
/// Positions near lights: at most one for so many points of the uniform grid, or kFewNearLightSamples if that is more.
constexpr std::size_t kPointsPerNearLightSample = 4, kFewNearLightSamples = 16384;
/// First guess of the ratio of the measured error of a grid to that of interpolation between the corners' own light.
/// It is above 1 because corners on the boundary of larger cells are interpolated.
constexpr double kFirstFitGain = 1.2;
/// At most this many grids are made to meet the target as measured; a measured error of kTargetSlack targets meets it.
constexpr int kMostRounds = 3;
constexpr double kTargetSlack = 1.02;
/// The expected error may be this many targets: where light changes little, it is above the measured one.
constexpr double kExpectedSlack = 1.3;

float Squared(float x) {
    return x * x;
}

/// Refines and prunes an octree until it meets a goal. Keeps references.
class SparseGridBuilder {
  public:
    /// radiance: as light is stored, see ToDisplayed.
    SparseGridBuilder(const BspSpace &space, const JobPool &jobs, const SparseLattice &lattice, const SparseGoal &goal,
                      bool radiance)
        : space_(space), lattice_(lattice), goal_(goal), radiance_(radiance), light_(lattice), tree_(lattice),
          refiner_(space, jobs, lattice, tree_, light_), maxNearLightError_(Squared(kNearLightTargets * goal.error)) {}
    void Start(const LightGridSH &uniform) {
        refiner_.Start(uniform, radiance_);
        limit_ = std::max(kSmallLump, kMaxFractionOfUniform * double(uniform.points.size() * sizeof(bspGridPointSH_t)));
        if (goal_.budget)
            limit_ = *goal_.budget;
    }
    /// Makes Grid remove negative lobes from the values.
    void EnableDering() { dering_ = true; }
    /// The grid of the coarsest tree that meets the goal; if none does, that of the finest tree.
    SparseGridSH Joined(SparseStats &result) {
        refiner_.EstimateErrors({});
        result.end = SparseEnd::NotRefined;
        return Grid(FindPrice(), result);
    }
    /// The same with smaller cells where they are needed. check: without receivers, the error is not measured.
    SparseGridSH Refined(const GridInputs &in, const LatticeTracer &tracer, const NearLightSet &nearLights,
                         const ExactReceivers &check, GridStats &work, SparseStats &result);

  private:
    using PrunedTree = std::pair<Octree, PrunedOctree>;
    PrunedTree Pruned(float price) const;
    bool MeetsGoal(const PrunedTree &pruned) const;
    double Bytes(const PrunedTree &pruned) const;
    bool NearLightsTakeTooMuch(const PrunedTree &pruned) const;
    double Interpolated(const Octree &tree) const;
    SparseEnd Refine(const LatticeTracer &tracer, GridStats &work);
    float FindPrice() const;
    SparseGridSH Grid(float price, SparseStats &result);
    SparseGridSH GridOf(const PrunedTree &pruned, SparseStats &result) const;
    void MeasureNearLights(const SparseGridSH &grid, SparseStats &result) const;

    const BspSpace &space_;
    const SparseLattice &lattice_;
    SparseGoal goal_;
    bool radiance_;
    LatticePoints light_;
    Octree tree_;
    OctreeRefiner refiner_;
    ScreenError screen_;
    std::span<const NearLightSample> nearLights_;
    const ExactReceivers *check_ = nullptr; ///< null: nothing is measured
    double fitGain_ = kFirstFitGain;        ///< measured error of the last grid over that without its fit
    float maxNearLightError_;               ///< larger OctreeCell::nearLightError needs smaller cells, bytes^2
    float nearLightSlack_ = 1; ///< factor of maxNearLightError, above 1 where the lump would exceed its limit
    bool dering_ = false;
    double limit_ = 0;                  ///< bytes of the lump
    float unit_ = 1;                    ///< of thresholds, smallest cells
    float threshold_ = kFirstThreshold; ///< the next one, in those units
    float minPrice_ = kMinPrice;        ///< of a leaf: the tree is not refined for lower ones
    double leastError_ = 0;             ///< measured in Refine, before refinements that gained nothing
    std::size_t leastErrorLeafs_ = 0;   ///< leafs of that tree; 0: none is measured yet
    float leastErrorPrice_ = kMinPrice; ///< minPrice_ of that tree
};

SparseGridBuilder::PrunedTree SparseGridBuilder::Pruned(float price) const {
    float maxNearLightError = maxNearLightError_;
    if (goal_.budget && !nearLights_.empty()) {
        Octree tree = tree_;
        maxNearLightError = Squared(kNearLightTargets * float(PruneOctree(tree, price).error));
    }
    PrunedTree pruned{tree_, {}};
    pruned.second = PruneOctree(pruned.first, price, maxNearLightError * nearLightSlack_);
    return pruned;
}

/// RMS error of interpolation between the corners' own light, which is not fitted, at the receivers; 0 without
/// receivers.
double SparseGridBuilder::Interpolated(const Octree &tree) const {
    double sum = 0, count = 0;
    for (std::size_t i = 0; check_ && i < check_->Size(); ++i) {
        const Vec3f at = lattice_.InCells(check_->Position(i));
        const std::size_t leaf = tree.LeafAt(CellAt(at));
        if (leaf == Octree::kNone || tree[leaf].open <= 0)
            continue;
        const CornerLight corners = CornersOf(light_, tree[leaf]);
        if (std::find(corners.begin(), corners.end(), nullptr) != corners.end())
            continue;
        sum +=
            double(screen_.Squared(InterpolatedLight(tree[leaf], corners, at), ToDisplayed(check_->At(i), radiance_)));
        ++count;
    }
    return count > 0 ? std::sqrt(std::max(0.0, sum / count - check_->Noise())) : 0;
}

bool SparseGridBuilder::MeetsGoal(const PrunedTree &pruned) const {
    if (goal_.budget)
        return Bytes(pruned) >= limit_;
    if (!check_)
        return pruned.second.error <= double(goal_.error);
    return pruned.second.error <= kExpectedSlack * double(goal_.error) &&
           fitGain_ * Interpolated(pruned.first) <= double(goal_.error);
}

/// Estimate of the bytes of the lump; far below its limit an upper one.
double SparseGridBuilder::Bytes(const PrunedTree &pruned) const {
    const auto leafs = double(pruned.second.leafs);
    if (leafs * kBytesPerLeaf < limit_)
        return leafs * kBytesPerLeaf;
    return double(CornerWeights(pruned.first, light_).Stored().size()) * kBytesPerPoint + leafs * kNodeBytesPerLeaf;
}

bool SparseGridBuilder::NearLightsTakeTooMuch(const PrunedTree &pruned) const {
    if (nearLights_.empty() || goal_.budget)
        return false;
    Octree tree = tree_;
    const PrunedOctree withoutNearLights = PruneOctree(tree, minPrice_);
    return double(pruned.second.leafs - withoutNearLights.leafs) > kMaxNearLightFraction * double(pruned.second.leafs);
}

/// Splits cells until pruning can meet the goal, or more cells do not help. Says which.
SparseEnd SparseGridBuilder::Refine(const LatticeTracer &tracer, GridStats &work) {
    for (;;) {
        const PrunedTree pruned = Pruned(minPrice_);
        const PrunedOctree &size = pruned.second;
        if (MeetsGoal(pruned))
            return SparseEnd::Goal;
        if (Bytes(pruned) >= limit_) {
            if (!NearLightsTakeTooMuch(pruned))
                return SparseEnd::Bytes;
            nearLightSlack_ *= Squared(kNearLightSlackStep);
            continue;
        }
        // Whether further leafs hardly reduce the error: most of it is in the smallest cells.
        if (leastErrorLeafs_ > 0 && !goal_.budget &&
            double(minPrice_) * double(size.leafs) < kMinGain * size.error * size.error * size.volume)
            return SparseEnd::LittleGain;
        const double error = Interpolated(pruned.first);
        if (leastErrorLeafs_ == 0 || error <= kLeastFall * leastError_)
            leastError_ = error, leastErrorLeafs_ = size.leafs, leastErrorPrice_ = minPrice_;
        else if (double(size.leafs) > kMoreLeafs * double(leastErrorLeafs_))
            return SparseEnd::NoGain;
        if (threshold_ <= kMinThreshold)
            return SparseEnd::Smallest;
        refiner_.Refine(threshold_ * unit_, tracer, work);
        minPrice_ = threshold_ * unit_ / kLeafsPerSplit;
        threshold_ /= kThresholdStep;
    }
}

/// Highest price of a leaf at which the pruned tree still meets the goal.
float SparseGridBuilder::FindPrice() const {
    float low = minPrice_, high = minPrice_ * kPriceRange;
    for (int i = 0; i < kBisections; ++i) {
        const float middle = std::sqrt(low * high);
        (MeetsGoal(Pruned(middle)) ? low : high) = middle;
    }
    return low;
}

/// The grid at that price, or at the lowest higher one at which its lump keeps the limit.
SparseGridSH SparseGridBuilder::Grid(float price, SparseStats &result) {
    double bytesPerLeaf = 0;
    for (;; price *= kPriceStep, nearLightSlack_ *= Squared(kPriceStep)) {
        const PrunedTree pruned = Pruned(price);
        const bool isCoarsest = price > kMaxPrice;
        if (double(pruned.second.leafs) * bytesPerLeaf > limit_ && !isCoarsest)
            continue;
        SparseGridSH grid = GridOf(pruned, result);
        if (double(result.bytes) <= limit_ || isCoarsest)
            return grid;
        bytesPerLeaf = double(result.bytes) / double(pruned.second.leafs);
        if (!goal_.budget)
            result.end = SparseEnd::Bytes;
    }
}

SparseGridSH SparseGridBuilder::GridOf(const PrunedTree &pruned, SparseStats &result) const {
    CornerWeights corners(pruned.first, light_);
    const std::vector<SHFloats> values = FitCorners(pruned.first, light_, corners, lattice_, space_, nearLights_);
    SparseGridTree tree = MakeSparseTree(pruned.first, light_, corners, lattice_, values);
    DeringStats dering;
    for (bspGridPointSH_t &value : tree.values) {
        value = ToStored(std::bit_cast<SHFloats>(value), radiance_);
        if (dering_)
            dering.Add(DeringPoint(value, radiance_));
    }
    SparseGridSH grid = PackSparseGrid(tree);
    result.leafs = pruned.second.leafs;
    result.stored = grid.points.size();
    result.bytes = EncodeSparseGrid(grid).size();
    result.error = pruned.second.error;
    result.dering = dering;
    return grid;
}

/// Sets the error of the finished grid at positions near lights.
void SparseGridBuilder::MeasureNearLights(const SparseGridSH &grid, SparseStats &result) const {
    const std::vector<std::byte> lump = EncodeSparseGrid(grid);
    const shgrid_grid reader = SparseReader(lump);
    double sum = 0;
    for (const NearLightSample &sample : nearLights_) {
        const Vec3f p = lattice_.PositionOf(sample.at);
        const float position[3] = {p.x, p.y, p.z};
        shgrid_coeffs read;
        shgrid_sample(&reader, position, &read);
        bspGridPointSH_t value;
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                value.coeffs[k][channel] = read.c[k][channel];
        sum += double(screen_.Squared(ToDisplayed(value, radiance_), sample.light));
    }
    result.nearLightSamples = nearLights_.size();
    result.nearLightError = nearLights_.empty() ? 0 : std::sqrt(sum / double(nearLights_.size()));
}

SparseGridSH SparseGridBuilder::Refined(const GridInputs &in, const LatticeTracer &tracer,
                                        const NearLightSet &nearLights, const ExactReceivers &check, GridStats &work,
                                        SparseStats &result) {
    nearLights_ = nearLights.All();
    check_ = check.Size() > 0 ? &check : nullptr;
    unit_ = 1.0f / 64;
    for (std::size_t axis = 0; axis < 3; ++axis)
        unit_ *= float(1 << lattice_.UniformLevel(axis));
    const BounceNoise noise(in, lattice_, light_);
    refiner_.EstimateErrors(noise);
    SplitNearLights(nearLights, maxNearLightError_, noise, in.jobs, tree_, light_, refiner_, tracer, work);
    minPrice_ = kFirstThreshold * kThresholdStep * unit_ / kLeafsPerSplit;
    for (int round = 1;; ++round) {
        nearLightSlack_ = 1;
        result.end = Refine(tracer, work);
        float price = minPrice_;
        if (result.end == SparseEnd::Goal)
            price = FindPrice();
        else if (result.end == SparseEnd::NoGain)
            price = leastErrorPrice_;
        const double interpolated = Interpolated(Pruned(price).first);
        SparseGridSH grid = Grid(price, result);
        if (check_) {
            result.measured = check.ErrorOf(grid);
            if (interpolated > 0)
                fitGain_ = result.measured->rms / interpolated;
        }
        if (result.end != SparseEnd::Goal || goal_.budget || !check_ || round == kMostRounds ||
            result.measured->rms <= kTargetSlack * double(goal_.error)) {
            MeasureNearLights(grid, result);
            return grid;
        }
    }
}

} // namespace

SparseGridSH BakeSparseGrid(const GridInputs &in, const std::vector<Light> &lights, const LightAtPositions &light,
                            const LightGridSH &uniform, const SparseGoal &goal, GridStats &work, SparseStats &result) {
    const SparseLattice lattice = SparseLattice::Cubic(uniform.header);
    const LatticeTracer tracer(in, light, lattice);
    SparseGridBuilder builder(in.space, in.jobs, lattice, goal, in.options.shRadiance);
    if (in.options.shDering)
        builder.EnableDering();
    builder.Start(uniform);
    const std::size_t mostSamples = std::max(kFewNearLightSamples, uniform.points.size() / kPointsPerNearLightSample);
    const NearLightSet nearLights(in, lights, light, lattice, mostSamples, work);
    const ExactReceivers check(in, lights);
    return builder.Refined(in, tracer, nearLights, check, work, result);
}

SparseGridSH SparseFromUniform(const BspSpace &space, const LightGridSH &uniform, bool radiance, const SparseGoal &goal,
                               const JobPool &jobs, SparseStats &result) {
    const SparseLattice lattice(uniform.header);
    SparseGridBuilder builder(space, jobs, lattice, goal, radiance);
    builder.Start(uniform);
    return builder.Joined(result);
}

namespace {

std::string_view WhyNotFiner(SparseEnd end) {
    switch (end) {
    case SparseEnd::Bytes:
        return "smaller cells would take more than half of the bytes of the uniform grid, or 0.08 MB if that is more";
    case SparseEnd::Goal:
        static_assert(kMostRounds == 3);
        return "three attempts came no nearer";
    case SparseEnd::NotRefined:
        return "no cell is smaller than those of the uniform grid";
    case SparseEnd::NoGain:
        return "with half as many cells more it was hardly smaller, so they are left out";
    default:
        return "smaller cells would hardly reduce it";
    }
}

} // namespace

void PrintSparseStats(const SparseStats &stats, const SparseGoal &goal, Log &log) {
    log.Count(stats.leafs, "cells with open space");
    log.Count(stats.stored, "points");
    log.Print("{:9.2f} MB\n", double(stats.bytes) / 1e6);
    double error = stats.error;
    if (stats.measured && stats.measured->receivers > 0) {
        error = stats.measured->rms;
        log.Print("{:9.2f} of 255 is the error of displayed light, measured at {} random positions of players (RMS)\n",
                  error, stats.measured->receivers);
    } else
        log.Print("{:9.2f} of 255 is the expected error of interpolation\n", error);
    if (stats.nearLightSamples > 0)
        log.Print("{:9.2f} of 255 is the error at {} positions near lights\n", stats.nearLightError,
                  stats.nearLightSamples);
    constexpr double kShown = 1.1; // the price of leafs is found in steps
    if (!goal.budget && error > kShown * double(goal.error))
        log.Print("That is above the {:g} that was asked for: {}\n", goal.error, WhyNotFiner(stats.end));
    if (goal.budget && stats.end == SparseEnd::NoGain)
        log.Print("It is smaller than -shbudget allows: more cells would hardly reduce the error\n");
    if (goal.budget && double(stats.bytes) > *goal.budget)
        log.Warn("SH grid budget",
                 "the sparse SH grid has {:.2f} MB with its largest cells, more than the {:g} of -shbudget",
                 double(stats.bytes) / 1e6, *goal.budget / 1e6);
}

} // namespace q3
