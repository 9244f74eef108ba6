// GPL-2.0-or-later. Bakes the sparse SH grid.
#include "q3map2/light/sparse/sparse_bake.h"

#include "common/parallel.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/light/sparse/corner_fit.h"
#include "q3map2/light/sparse/display_error.h"
#include "q3map2/light/sparse/near_light_samples.h"
#include "q3map2/light/sparse/octree.h"
#include "q3map2/light/sparse/octree_refine.h"
#include "q3map2/light/sparse/sparse_tree.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace q3 {

namespace {

/// Thresholds of refinement: the first one, the factor by which they fall, and the last one. Unit: bytes^2 times
/// kThresholdVolume of the volume of a cell of the uniform grid, that of the cell halved twice along each axis.
constexpr float kFirstThreshold = 16384, kThresholdStep = 2.5f, kMinThreshold = 1, kThresholdVolume = 1.0f / 64;
/// Leafs that a split adds: eight for one.
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
/// It also ends where kMoreLeafs times the leafs leave more than the fraction kErrorLeft of the measured error.
constexpr double kMoreLeafs = 1.5, kErrorLeft = 0.97;
/// The price of a leaf grows by this factor while the lump exceeds its limit.
constexpr float kPriceStep = 1.15f;
/// Without a budget the lump has at most this fraction of the bytes of the uniform grid, whatever its error, or
/// kSmallLump bytes if that is more.
constexpr double kMaxFractionOfUniform = 0.5, kSmallLump = 80e3;
/// Bytes of the lump per leaf, an upper estimate; those of nodes per leaf; bytes of a stored point.
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
/// It is above 1 because hanging corners are interpolated.
constexpr double kFirstErrorRatio = 1.2;
/// At most this many grids are made to meet the target as measured; a measured error of kTargetSlack targets meets it.
constexpr int kMaxRounds = 3;
constexpr double kTargetSlack = 1.02;
/// The expected error may be this many targets: where light changes little, it is above the measured one.
constexpr double kExpectedSlack = 1.3;

/// Limit of the error near lights that keeps no node from being pruned, and of bytes that every lump keeps.
constexpr float kAnyError = std::numeric_limits<float>::infinity();
constexpr double kAnySize = std::numeric_limits<double>::infinity();
/// Receivers of one job.
constexpr std::size_t kReceiversOfJob = 256;

float Squared(float x) {
    return x * x;
}

/// Refines and prunes an octree until it meets a goal. Keeps references.
class SparseGridBuilder {
  public:
    /// radiance: as light is stored, see ToDisplayed.
    SparseGridBuilder(const BspSpace &space, const JobPool &jobs, const SparseLattice &lattice, const SparseGoal &goal,
                      bool radiance)
        : space_(space), jobs_(jobs), lattice_(lattice), goal_(goal), radiance_(radiance), points_(lattice),
          tree_(lattice), refiner_(space, jobs, lattice, tree_, points_),
          maxNearLightError_(Squared(kNearLightTargets * goal.error)) {}
    /// Makes the tree of the uniform grid's cells. Call it first.
    void Start(const LightGridSH &uniform) {
        refiner_.Start(uniform, radiance_);
        maxBytes_ =
            std::max(kSmallLump, kMaxFractionOfUniform * double(uniform.points.size() * sizeof(bspGridPointSH_t)));
        if (goal_.budget)
            maxBytes_ = *goal_.budget;
    }
    /// Removes negative lobes from the values of the result.
    void EnableDering() { dering_ = true; }
    /// The grid of the coarsest tree that meets the goal; if none does, that of the finest tree.
    SparseGridSH WithoutRefinement(SparseStats &result) {
        refiner_.EstimateErrors({});
        result.stop = RefinementStop::NotRefined;
        return GridAtPrice(FindPrice(), result);
    }
    /// The same with smaller cells where they are needed. exact: where the error is measured; it is not if there are no
    /// receivers.
    SparseGridSH Refined(const GridInputs &in, const LatticeTracer &tracer, const NearLightSet &nearLights,
                         const ExactReceivers &exact, GridStats &work, SparseStats &result);

  private:
    struct PrunedTree {
        Octree tree;
        PruningStats stats;
    };
    void Prune(float price, PrunedTree &pruned) const;
    PrunedTree Pruned(float price) const {
        PrunedTree pruned{Octree(lattice_), {}};
        Prune(price, pruned);
        return pruned;
    }
    bool MeetsGoal(const PrunedTree &pruned) const;
    double EstimatedBytes(const PrunedTree &pruned) const;
    bool NearLightsTakeTooMuch(const PrunedTree &pruned) const;
    double InterpolationError(const Octree &tree) const;
    RefinementStop Refine(const LatticeTracer &tracer, GridStats &work);
    float FindPrice() const;
    SparseGridSH GridAtPrice(float price, SparseStats &result);
    /// A grid whose values are not fitted yet.
    struct UnfittedGrid {
        StoredTree tree;
        CornerSamples samples;
    };
    std::optional<UnfittedGrid> Unfitted(PrunedTree pruned, double maxBytes, SparseStats &result) const;
    SparseGridSH Fitted(UnfittedGrid unfitted, SparseStats &result) const;
    void MeasureNearLights(const SparseGridSH &grid, SparseStats &result) const;

    const BspSpace &space_;
    const JobPool &jobs_;
    const SparseLattice &lattice_;
    SparseGoal goal_;
    bool radiance_;
    LatticePoints points_;
    Octree tree_;
    OctreeRefiner refiner_;
    ScreenError screen_;
    std::span<const NearLightSample> nearLights_;
    const ExactReceivers *exact_ = nullptr; ///< null: nothing is measured
    double errorRatio_ = kFirstErrorRatio;  ///< measured error of the last grid over InterpolationError of its tree
    float maxNearLightError_;               ///< larger OctreeCell::nearLightError needs smaller cells, bytes^2
    float nearLightSlack_ = 1; ///< factor of maxNearLightError, above 1 where the lump would exceed its limit
    bool dering_ = false;
    double maxBytes_ = 0;               ///< of the lump
    float thresholdVolume_ = 1;         ///< volume in the unit of thresholds, smallest cells
    float threshold_ = kFirstThreshold; ///< the next one, in that unit
    float minPrice_ = kMinPrice;        ///< of a leaf: the tree is not refined for lower ones
    double leastError_ = 0;             ///< InterpolationError in Refine, before refinements that gained nothing
    std::size_t leastErrorLeafs_ = 0;   ///< leafs of that tree; 0: none is measured yet
    float leastErrorPrice_ = kMinPrice; ///< minPrice_ of that tree
};

/// `pruned`: replaced, but for its memory.
void SparseGridBuilder::Prune(float price, PrunedTree &pruned) const {
    float maxNearLightError = maxNearLightError_;
    if (goal_.budget && !nearLights_.empty()) { // no error target: the expected error at that price serves as one
        pruned.tree.CopyFrom(tree_, jobs_);
        maxNearLightError = Squared(kNearLightTargets * float(PruneOctree(pruned.tree, price, kAnyError, jobs_).error));
    }
    pruned.tree.CopyFrom(tree_, jobs_);
    pruned.stats = PruneOctree(pruned.tree, price, maxNearLightError * nearLightSlack_, jobs_);
}

/// RMS error of interpolation between the corners' own light, which is not fitted, at the receivers; 0 without
/// receivers.
double SparseGridBuilder::InterpolationError(const Octree &tree) const {
    constexpr float kNoCell = -1; // of a receiver outside of cells whose light is known
    std::vector<float> squared(exact_ ? exact_->Size() : 0, kNoCell);
    ForAll(jobs_, squared.size(), kReceiversOfJob, [&](std::size_t i) {
        const Vec3f at = lattice_.InCells(exact_->Position(i));
        const std::size_t leaf = tree.LeafAt(CellAt(at));
        if (leaf == Octree::kNone || tree[leaf].openFraction <= 0)
            return;
        const CornerLight corners = CornersOf(points_, tree[leaf]);
        if (std::find(corners.begin(), corners.end(), nullptr) != corners.end())
            return;
        squared[i] = screen_.Squared(InterpolatedLight(tree[leaf], corners, at), ToDisplayed(exact_->At(i), radiance_));
    });
    double sum = 0, count = 0;
    for (const float one : squared)
        if (one != kNoCell)
            sum += double(one), ++count;
    return count > 0 ? std::sqrt(std::max(0.0, sum / count - exact_->Noise())) : 0;
}

/// Whether the tree is fine enough: the lump uses up the budget or, without one, the error is at most the target.
bool SparseGridBuilder::MeetsGoal(const PrunedTree &pruned) const {
    if (goal_.budget)
        return EstimatedBytes(pruned) >= maxBytes_;
    if (!exact_)
        return pruned.stats.error <= double(goal_.error);
    return pruned.stats.error <= kExpectedSlack * double(goal_.error) &&
           errorRatio_ * InterpolationError(pruned.tree) <= double(goal_.error);
}

/// Estimate of the bytes of the lump; far below its limit an upper one.
double SparseGridBuilder::EstimatedBytes(const PrunedTree &pruned) const {
    const auto leafs = double(pruned.stats.leafs);
    if (leafs * kBytesPerLeaf < maxBytes_)
        return leafs * kBytesPerLeaf;
    return double(CountStoredCorners(pruned.tree, points_, jobs_)) * kBytesPerPoint + leafs * kNodeBytesPerLeaf;
}

/// Whether cells near lights take more than kMaxNearLightFraction of the leafs.
bool SparseGridBuilder::NearLightsTakeTooMuch(const PrunedTree &pruned) const {
    if (nearLights_.empty() || goal_.budget)
        return false;
    Octree tree(lattice_);
    tree.CopyFrom(tree_, jobs_);
    const PruningStats withoutNearLights = PruneOctree(tree, minPrice_, kAnyError, jobs_);
    return double(pruned.stats.leafs - withoutNearLights.leafs) > kMaxNearLightFraction * double(pruned.stats.leafs);
}

/// Splits cells until pruning can meet the goal, or more cells do not help. Returns which of the two.
RefinementStop SparseGridBuilder::Refine(const LatticeTracer &tracer, GridStats &work) {
    for (;;) {
        const PrunedTree pruned = Pruned(minPrice_);
        const PruningStats &stats = pruned.stats;
        if (MeetsGoal(pruned))
            return RefinementStop::ExpectedToMeetGoal;
        if (EstimatedBytes(pruned) >= maxBytes_) {
            if (!NearLightsTakeTooMuch(pruned))
                return RefinementStop::ByteLimit;
            nearLightSlack_ *= Squared(kNearLightSlackStep);
            continue;
        }
        // A further leaf saves about minPrice_ of squared error times volume; the mean leaf has error^2 volume / leafs.
        if (leastErrorLeafs_ > 0 && !goal_.budget &&
            double(minPrice_) * double(stats.leafs) < kMinGain * stats.error * stats.error * stats.volume)
            return RefinementStop::LittleExpectedGain;
        const double error = InterpolationError(pruned.tree);
        if (leastErrorLeafs_ == 0 || error <= kErrorLeft * leastError_)
            leastError_ = error, leastErrorLeafs_ = stats.leafs, leastErrorPrice_ = minPrice_;
        else if (double(stats.leafs) > kMoreLeafs * double(leastErrorLeafs_))
            return RefinementStop::NoMeasuredGain;
        if (threshold_ <= kMinThreshold)
            return RefinementStop::LastThreshold;
        refiner_.Refine(threshold_ * thresholdVolume_, tracer, work);
        minPrice_ = threshold_ * thresholdVolume_ / kLeafsPerSplit;
        threshold_ /= kThresholdStep;
    }
}

/// Highest price of a leaf at which the pruned tree still meets the goal.
float SparseGridBuilder::FindPrice() const {
    float low = minPrice_, high = minPrice_ * kPriceRange;
    PrunedTree pruned{Octree(lattice_), {}};
    for (int i = 0; i < kBisections; ++i) {
        const float middle = std::sqrt(low * high);
        Prune(middle, pruned);
        (MeetsGoal(pruned) ? low : high) = middle;
    }
    return low;
}

/// The grid at that price, or at the lowest higher one at which its lump keeps the limit.
SparseGridSH SparseGridBuilder::GridAtPrice(float price, SparseStats &result) {
    double bytesPerLeaf = 0;
    PrunedTree pruned{Octree(lattice_), {}};
    for (;; price *= kPriceStep, nearLightSlack_ *= Squared(kPriceStep)) {
        Prune(price, pruned);
        const bool isCoarsest = price > kMaxPrice;
        if (double(pruned.stats.leafs) * bytesPerLeaf > maxBytes_ && !isCoarsest)
            continue;
        if (std::optional<UnfittedGrid> grid =
                Unfitted(std::exchange(pruned, {Octree(lattice_), {}}), isCoarsest ? kAnySize : maxBytes_, result))
            return Fitted(*std::move(grid), result);
        bytesPerLeaf = double(result.bytes) / double(result.leafs);
        if (!goal_.budget)
            result.stop = RefinementStop::ByteLimit;
    }
}

/// The grid of a pruned tree, with its size and expected error in `result`; none if its lump exceeds `maxBytes`. What
/// only this needs of the tree is freed before the fit, which takes the most memory of all.
std::optional<SparseGridBuilder::UnfittedGrid> SparseGridBuilder::Unfitted(PrunedTree pruned, double maxBytes,
                                                                           SparseStats &result) const {
    pruned.tree.DropUnused();
    const CornerWeights corners(pruned.tree, points_, {}, jobs_);
    StoredTree stored = StoreTree(pruned.tree, points_, corners, jobs_);
    result.leafs = pruned.stats.leafs;
    result.storedPoints = stored.order.size();
    result.bytes = SparseGridBytes(stored.nodes.size(), stored.order.size());
    result.expectedError = pruned.stats.error;
    if (double(result.bytes) > maxBytes)
        return {};
    return UnfittedGrid{std::move(stored),
                        SampleCorners(pruned.tree, points_, corners, lattice_, space_, nearLights_, jobs_)};
}

/// The grid with its values, and what deringing did to them in `result`.
SparseGridSH SparseGridBuilder::Fitted(UnfittedGrid unfitted, SparseStats &result) const {
    const std::vector<SHFloats> values = FitCorners(std::move(unfitted.samples), points_, nearLights_, jobs_);
    SparseGridTree tree = MakeSparseTree(std::move(unfitted.tree), lattice_, values, jobs_);
    result.dering = {};
    for (bspGridPointSH_t &value : tree.values) {
        value = ToStored(std::bit_cast<SHFloats>(value), radiance_);
        if (dering_)
            result.dering.Add(DeringPoint(value, radiance_));
    }
    return PackSparseGrid(tree);
}

/// Sets the error of the finished grid at positions near lights.
void SparseGridBuilder::MeasureNearLights(const SparseGridSH &grid, SparseStats &result) const {
    const std::vector<std::byte> lump = EncodeSparseGrid(grid);
    const shgrid_grid reader = SparseReader(lump);
    std::vector<float> squared(nearLights_.size());
    ForAll(jobs_, squared.size(), kReceiversOfJob, [&](std::size_t i) {
        const Vec3f p = lattice_.PositionOf(nearLights_[i].at);
        const float position[3] = {p.x, p.y, p.z};
        shgrid_coeffs read;
        shgrid_sample(&reader, position, &read);
        bspGridPointSH_t value;
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                value.coeffs[k][channel] = read.c[k][channel];
        squared[i] = screen_.Squared(ToDisplayed(value, radiance_), nearLights_[i].light);
    });
    double sum = 0;
    for (const float one : squared)
        sum += double(one);
    result.nearLightSamples = nearLights_.size();
    result.nearLightError = nearLights_.empty() ? 0 : std::sqrt(sum / double(nearLights_.size()));
}

SparseGridSH SparseGridBuilder::Refined(const GridInputs &in, const LatticeTracer &tracer,
                                        const NearLightSet &nearLights, const ExactReceivers &exact, GridStats &work,
                                        SparseStats &result) {
    nearLights_ = nearLights.All();
    exact_ = exact.Size() > 0 ? &exact : nullptr;
    thresholdVolume_ = kThresholdVolume;
    for (std::size_t axis = 0; axis < 3; ++axis)
        thresholdVolume_ *= float(1 << lattice_.UniformLevel(axis));
    const BounceNoise noise(in, lattice_, points_);
    refiner_.EstimateErrors(noise);
    SplitNearLights(nearLights, maxNearLightError_, noise, in.jobs, tree_, points_, refiner_, tracer, work);
    minPrice_ = kFirstThreshold * kThresholdStep * thresholdVolume_ / kLeafsPerSplit; // as if one threshold was done
    for (int round = 1;; ++round) {
        nearLightSlack_ = 1;
        result.stop = Refine(tracer, work);
        float price = minPrice_;
        if (result.stop == RefinementStop::ExpectedToMeetGoal)
            price = FindPrice();
        else if (result.stop == RefinementStop::NoMeasuredGain)
            price = leastErrorPrice_;
        const double interpolationError = InterpolationError(Pruned(price).tree);
        SparseGridSH grid = GridAtPrice(price, result);
        if (exact_) {
            result.measured = exact.ErrorOf(grid);
            if (interpolationError > 0)
                errorRatio_ = result.measured->rms / interpolationError; // with which the next round aims better
        }
        if (result.stop != RefinementStop::ExpectedToMeetGoal || goal_.budget || !exact_ || round == kMaxRounds ||
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
    const std::size_t maxSamples = std::max(kFewNearLightSamples, uniform.points.size() / kPointsPerNearLightSample);
    const NearLightSet nearLights(in, lights, light, lattice, maxSamples, work);
    const ExactReceivers exact(in, lights);
    return builder.Refined(in, tracer, nearLights, exact, work, result);
}

SparseGridSH SparseFromUniform(const BspSpace &space, const LightGridSH &uniform, bool radiance, const SparseGoal &goal,
                               const JobPool &jobs, SparseStats &result) {
    const SparseLattice lattice(uniform.header);
    SparseGridBuilder builder(space, jobs, lattice, goal, radiance);
    builder.Start(uniform);
    return builder.WithoutRefinement(result);
}

namespace {

std::string_view WhyNotFiner(RefinementStop stop) {
    switch (stop) {
    case RefinementStop::ByteLimit:
        return "smaller cells would take more than half of the bytes of the uniform grid, or 0.08 MB if that is more";
    case RefinementStop::ExpectedToMeetGoal:
        static_assert(kMaxRounds == 3);
        return "three attempts came no nearer";
    case RefinementStop::NotRefined:
        return "no cell is smaller than those of the uniform grid";
    case RefinementStop::NoMeasuredGain:
        return "with half as many cells more it was hardly smaller, so they are left out";
    default:
        return "smaller cells would hardly reduce it";
    }
}

} // namespace

void PrintSparseStats(const SparseStats &stats, const SparseGoal &goal, Log &log) {
    log.Count(stats.leafs, "cells with open space");
    log.Count(stats.storedPoints, "points");
    log.Print("{:9.2f} MB\n", double(stats.bytes) / 1e6);
    double error = stats.expectedError;
    if (stats.measured && stats.measured->receivers > 0) {
        error = stats.measured->rms;
        log.Print("{:9.2f} levels: RMS error of displayed light at {} random player positions\n", error,
                  stats.measured->receivers);
    } else
        log.Print("{:9.2f} levels: expected error of interpolation\n", error);
    if (stats.nearLightSamples > 0)
        log.Print("{:9.2f} levels: RMS error at {} positions near lights\n", stats.nearLightError,
                  stats.nearLightSamples);
    constexpr double kUnmentioned = 1.1; // as many targets are not mentioned: the price of leafs is found in steps
    if (!goal.budget && error > kUnmentioned * double(goal.error))
        log.Print("That is above the target of {:g}: {}\n", goal.error, WhyNotFiner(stats.stop));
    if (goal.budget && stats.stop == RefinementStop::NoMeasuredGain)
        log.Print("It is smaller than -shbudget allows: more cells would hardly reduce the error\n");
    if (goal.budget && double(stats.bytes) > *goal.budget)
        log.Warn("SH grid budget",
                 "the sparse SH grid has {:.2f} MB with its largest cells, more than the {:g} of -shbudget",
                 double(stats.bytes) / 1e6, *goal.budget / 1e6);
}

} // namespace q3
