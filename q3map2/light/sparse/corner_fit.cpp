// GPL-2.0-or-later. Corners of the cells of an octree: which are stored, and their fit to the light inside the cells.
#include "q3map2/light/sparse/corner_fit.h"

#include "common/parallel.h"
#include "q3map2/light/grid/gridsh_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

namespace q3 {

// ---- Stored and hanging corners ----

namespace {

/// Exponent of the greatest power of two that divides all three coordinates of a point.
int PowerOf(const LatticePoint &p) {
    return std::countr_zero(std::uint32_t(p[0] | p[1] | p[2]));
}

/// Leafs, corners or points of one job.
constexpr std::size_t kJobSize = 1024;

/// Corners of the open leafs, each once, in the order of the leafs.
struct LeafCorners {
    std::vector<std::uint32_t> numbers;
    std::vector<std::size_t> hungOn; ///< LeafHungOn of each
};

LeafCorners CornersOfLeafs(const Octree &tree, const LatticePoints &points, const JobPool &jobs) {
    const std::vector<std::size_t> leafs = tree.OpenLeafs();
    const auto all = std::make_unique_for_overwrite<std::uint32_t[]>(8 * leafs.size());
    ForAll(jobs, leafs.size(), kJobSize, [&](std::size_t i) {
        for (std::size_t c = 0; c < 8; ++c)
            all[8 * i + c] = points.Find(tree[leafs[i]].Corner(c));
    });
    LeafCorners corners;
    std::vector<bool> known(points.Size());
    for (const std::uint32_t number : std::span(all.get(), 8 * leafs.size()))
        if (!known[number]) {
            known[number] = true;
            corners.numbers.push_back(number);
        }
    corners.hungOn.resize(corners.numbers.size());
    ForAll(jobs, corners.numbers.size(), kJobSize,
           [&](std::size_t i) { corners.hungOn[i] = LeafHungOn(tree, points[corners.numbers[i]].at); });
    return corners;
}

} // namespace

std::vector<LatticePoint> ParentsOf(const LatticePoint &p) {
    const int power = PowerOf(p);
    std::vector<LatticePoint> parents{p};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if ((p[axis] >> power & 1) == 0)
            continue;
        const std::size_t count = parents.size();
        for (std::size_t i = 0; i < count; ++i) {
            parents.push_back(parents[i]);
            parents[i][axis] -= 1 << power;
            parents.back()[axis] += 1 << power;
        }
    }
    return parents;
}

std::size_t LeafHungOn(const Octree &tree, const LatticePoint &p) {
    std::size_t largest = Octree::kNone;
    for (const std::size_t leaf : tree.LeafsAround(p))
        if (leaf != Octree::kNone && tree[leaf].openFraction > 0 && !tree[leaf].HasCorner(p) &&
            (largest == Octree::kNone || tree[leaf].level > tree[largest].level))
            largest = leaf;
    return largest;
}

CornerWeights::CornerWeights(const Octree &tree, const LatticePoints &points, std::vector<Rule> rules,
                             const JobPool &jobs)
    : tree_(tree), points_(points), rules_(std::move(rules)), storedOf_(points.Size(), LatticePoints::kUnknown),
      unstoredOf_(points.Size(), LatticePoints::kUnknown) {
    const LeafCorners corners = CornersOfLeafs(tree, points, jobs);
    std::vector<std::size_t> hungOn; // LeafHungOn, by index in unstored_
    for (std::size_t i = 0; i < corners.numbers.size(); ++i) {
        const std::uint32_t number = corners.numbers[i];
        const Rule rule = rules_.empty() ? Rule::HangOrStore : rules_[number];
        if (rule == Rule::Store || (rule == Rule::HangOrStore && corners.hungOn[i] == Octree::kNone)) {
            storedOf_[number] = number; // until NumberStored
            continue;
        }
        unstoredOf_[number] = std::uint32_t(unstored_.size());
        unstored_.push_back(number);
        hungOn.push_back(corners.hungOn[i]);
    }
    FindTerms(hungOn, jobs);
    NumberStored(corners.numbers, jobs);
}

/// Sets terms_, in which numbers of points stand for stored corners.
void CornerWeights::FindTerms(const std::vector<std::size_t> &hungOn, const JobPool &jobs) {
    // By the power of two that divides the coordinates of hanging corners: where they hang on others, it is greater.
    std::array<std::vector<std::uint32_t>, 32> byPower;
    for (std::size_t i = 0; i < unstored_.size(); ++i)
        if (const LatticePoint &p = points_[unstored_[i]].at; !IsLeftOut(unstored_[i]))
            byPower[std::size_t(PowerOf(p))].push_back(std::uint32_t(i));
    terms_.resize(unstored_.size());
    for (std::size_t power = byPower.size(); power-- > 0;)
        ForAll(jobs, byPower[power].size(), kJobSize, [&](std::size_t n) {
            const std::uint32_t i = byPower[power][n];
            const LatticePoint &p = points_[unstored_[i]].at;
            terms_[i] = rules_.empty() ? TermsIn(tree_[hungOn[i]], p) : TermsOfParents(p);
        });
}

/// Gives stored corners their numbers, in the order in which the corners of the leafs have terms of them.
void CornerWeights::NumberStored(const std::vector<std::uint32_t> &corners, const JobPool &jobs) {
    std::vector<bool> known(points_.Size());
    const auto add = [&](std::uint32_t number) {
        if (!known[number]) {
            known[number] = true;
            stored_.push_back(number);
        }
    };
    for (const std::uint32_t number : corners)
        if (IsStored(number))
            add(number);
        else
            for (const CornerTerm &term : terms_[unstoredOf_[number]])
                add(term.stored);
    ForAll(jobs, stored_.size(), kJobSize, [&](std::size_t i) { storedOf_[stored_[i]] = std::uint32_t(i); });
    ForAll(jobs, terms_.size(), kJobSize, [&](std::size_t i) {
        for (CornerTerm &term : terms_[i])
            term.stored = storedOf_[term.stored];
    });
}

std::size_t CountStoredCorners(const Octree &tree, const LatticePoints &points, const JobPool &jobs) {
    return std::size_t(std::ranges::count(CornersOfLeafs(tree, points, jobs).hungOn, Octree::kNone));
}

void CornerWeights::AddCorner(float weight, std::uint32_t number, std::vector<CornerTerm> &sum) const {
    const CornerTerm itself{storedOf_[number], 1.0f};
    if (IsStored(number))
        AddTerms(weight, std::span(&itself, 1), sum);
    else if (!IsLeftOut(number))
        AddTerms(weight, terms_[unstoredOf_[number]], sum);
}

void CornerWeights::AddTerms(float weight, std::span<const CornerTerm> terms, std::vector<CornerTerm> &sum) {
    for (const CornerTerm &term : terms) {
        const auto same =
            std::find_if(sum.begin(), sum.end(), [&](const CornerTerm &t) { return t.stored == term.stored; });
        if (same == sum.end())
            sum.push_back({term.stored, weight * term.weight});
        else
            same->weight += weight * term.weight;
    }
}

/// What a hanging point gets where some corners on larger leafs are stored: readers take these before others.
std::vector<CornerTerm> CornerWeights::TermsOfParents(const LatticePoint &p) const {
    std::vector<CornerTerm> sum;
    const std::vector<LatticePoint> parents = ParentsOf(p);
    for (const LatticePoint &parent : parents) {
        const float weight = 1 / float(parents.size());
        const std::uint32_t number = points_.Find(parent);
        if (number != LatticePoints::kUnknown && (IsLeftOut(number) || IsCorner(number)))
            AddCorner(weight, number, sum);
        else
            AddTerms(weight, TermsOfParents(parent), sum);
    }
    return sum;
}

std::vector<CornerTerm> CornerWeights::TermsIn(const OctreeCell &leaf, const Vec3f &at) const {
    std::vector<CornerTerm> combined;
    for (std::size_t c = 0; c < 8; ++c)
        if (const float weight = leaf.Weight(c, at); weight != 0)
            AddCorner(weight, points_.Find(leaf.Corner(c)), combined);
    return combined;
}

// ---- Least-squares fit of the stored corners to the light inside the cells ----

namespace {

/// Steps of conjugate gradients, which start from the corners' own light.
constexpr int kIterations = 4;
/// The fit changes a corner by at most this fraction of its mean light, so that the dark stays dark beside the bright.
constexpr float kMaxChange = 0.5f;
/// Tikhonov regularization: weight of the pull towards a corner's own light, as a fraction of the weight of the samples
/// around it.
constexpr float kRegularization = 0.05f;

/// Scales the change of a value down to kMaxChange times its mean light: the norms are those over all coefficients, and
/// over coefficient 0 of the three channels.
void LimitChange(const SHFloats &before, SHFloats &value) {
    float change = 0, meanSquared = 0;
    for (std::size_t k = 0; k < kSHFloats; ++k)
        change += (value[k] - before[k]) * (value[k] - before[k]);
    for (std::size_t channel = 0; channel < 3; ++channel)
        meanSquared += before[channel] * before[channel];
    const float maxChange = kMaxChange * std::sqrt(meanSquared);
    change = std::sqrt(change);
    for (std::size_t k = 0; k < kSHFloats && change > maxChange; ++k)
        value[k] = before[k] + (value[k] - before[k]) * (maxChange / change);
}

/// The light of a sample. Points are numbered first, then near lights.
const SHFloats &LightOfSample(std::size_t number, const LatticePoints &points,
                              std::span<const NearLightSample> nearLights) {
    return number < points.Size() ? points[number].value : nearLights[number - points.Size()].light;
}

/// Finds what SampleCorners adds.
class CornerSampler {
  public:
    CornerSampler(const Octree &tree, const LatticePoints &points, const CornerWeights &corners,
                  std::span<const NearLightSample> nearLights, const SparseLattice &lattice, const BspSpace &space,
                  const JobPool &jobs)
        : tree_(tree), points_(points), corners_(corners), nearLights_(nearLights), withoutSolid_(tree.Size()) {
        const std::vector<std::size_t> leafs = tree.OpenLeafs();
        ForAll(jobs, leafs.size(), kJobSize, [&](std::size_t i) {
            const OctreeCell &leaf = tree[leafs[i]];
            withoutSolid_[leafs[i]] =
                !space.AnySolid(lattice.PositionOf(leaf.origin), lattice.PositionOf(leaf.Corner(7)));
        });
    }
    /// Number of samples that there may be: the points, then the near lights.
    std::size_t Count() const { return points_.Size() + nearLights_.size(); }
    void Add(std::size_t number, SampleBlock &samples) const {
        if (number < points_.Size())
            AddPoint(number, samples);
        else
            AddNearLight(number, samples);
    }

  private:
    void AddSample(std::size_t number, const std::vector<CornerTerm> &terms, SampleBlock &samples) const {
        samples.Add(
            std::uint32_t(number),
            FitWeight(1, std::max(0.0f, MeanLight(LightOfSample(number, points_, nearLights_))), FittedPoints::All),
            terms);
    }
    /// Adds a point if it is in the open, and stored or away from solids.
    void AddPoint(std::size_t number, SampleBlock &samples) const {
        const LatticeSample &point = points_[number];
        if (!point.traced)
            return;
        std::size_t inside = Octree::kNone;
        bool nearSolid = false;
        for (const std::size_t leaf : tree_.LeafsAround(point.at))
            if (leaf != Octree::kNone && tree_[leaf].openFraction > 0) {
                inside = leaf; // any of the leafs that touch the point will do: light is continuous
                nearSolid = nearSolid || withoutSolid_[leaf] == 0;
            }
        if (inside != Octree::kNone && (corners_.IsStored(std::uint32_t(number)) || !nearSolid))
            AddSample(number, corners_.TermsIn(tree_[inside], point.at), samples);
    }
    void AddNearLight(std::size_t number, SampleBlock &samples) const {
        const NearLightSample &sample = nearLights_[number - points_.Size()];
        const std::size_t leaf = tree_.LeafAt(CellAt(sample.at));
        if (leaf != Octree::kNone && tree_[leaf].openFraction > 0 && withoutSolid_[leaf] != 0)
            AddSample(number, corners_.TermsIn(tree_[leaf], sample.at), samples);
    }

    const Octree &tree_;
    const LatticePoints &points_;
    const CornerWeights &corners_;
    std::span<const NearLightSample> nearLights_;
    std::vector<std::uint8_t> withoutSolid_; ///< by leaf: 1 or 0
};

} // namespace

CornerSamples SampleCorners(const Octree &tree, const LatticePoints &points, const CornerWeights &corners,
                            const SparseLattice &lattice, const BspSpace &space,
                            std::span<const NearLightSample> nearLights, const JobPool &jobs) {
    const CornerSampler sampler(tree, points, corners, nearLights, lattice, space, jobs);
    CornerSamples samples{corners.Stored(), std::vector<SampleBlock>((sampler.Count() + kJobSize - 1) / kJobSize)};
    jobs.For(std::int64_t(samples.blocks.size()), [&](std::int64_t job, int) {
        SampleBlock &block = samples.blocks[std::size_t(job)];
        const std::size_t first = std::size_t(job) * kJobSize;
        for (std::size_t i = first; i < std::min(sampler.Count(), first + kJobSize); ++i)
            sampler.Add(i, block);
        block.ShrinkToFit();
    });
    return samples;
}

std::vector<SHFloats> FitCorners(CornerSamples samples, const LatticePoints &points,
                                 std::span<const NearLightSample> nearLights, const JobPool &jobs) {
    const std::vector<std::uint32_t> &stored = samples.stored;
    LeastSquares system(stored.size(), std::move(samples.blocks), jobs);
    std::vector<SHFloats> values = VectorInParallel<SHFloats>(stored.size(), jobs);
    ForAll(jobs, values.size(), kJobSize, [&](std::size_t i) {
        values[i] = points[stored[i]].value;
        system.SetPull(i, kRegularization * system.WeightOf(i));
    });
    const auto lightOf = [&](std::uint32_t number) { return LightOfSample(number, points, nearLights); };
    system.Solve(lightOf, values, kIterations, jobs);
    ForAll(jobs, values.size(), kJobSize, [&](std::size_t i) { LimitChange(points[stored[i]].value, values[i]); });
    return values;
}

} // namespace q3
