// GPL-2.0-or-later. Corners of the cells of an octree: which are stored, their fit to the light inside the cells, and
// their values.
#include "q3map2/light/sparse/corner_fit.h"

#include "q3map2/light/grid/gridsh_fit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_set>

namespace q3 {

// ---- Stored and hanging corners of the cells of an octree ----

CornerWeights::CornerWeights(const Octree &tree, const LatticePoints &light)
    : tree_(tree), light_(light), storedOf_(light.Size(), LatticePoints::kUnknown), terms_(light.Size()) {
    for (const std::size_t leaf : tree.OpenLeafs())
        for (std::size_t c = 0; c < 8; ++c)
            TermsOf(tree[leaf].Corner(c));
}

std::size_t CornerWeights::HangsOn(const LatticePoint &p) const {
    std::size_t largest = Octree::kNone;
    for (const std::size_t leaf : tree_.LeafsAround(p))
        if (leaf != Octree::kNone && tree_[leaf].open > 0 && !tree_[leaf].HasCorner(p) &&
            (largest == Octree::kNone || tree_[leaf].level > tree_[largest].level))
            largest = leaf;
    return largest;
}

const std::vector<CornerTerm> &CornerWeights::TermsOf(const LatticePoint &corner) {
    const std::uint32_t number = light_.Find(corner);
    if (!terms_[number].empty())
        return terms_[number];
    const std::size_t leaf = HangsOn(corner);
    if (leaf != Octree::kNone)
        return terms_[number] = TermsIn(tree_[leaf], corner);
    storedOf_[number] = std::uint32_t(stored_.size());
    stored_.push_back(number);
    return terms_[number] = {{storedOf_[number], 1.0f}};
}

std::vector<CornerTerm> CornerWeights::TermsIn(const OctreeCell &leaf, const Vec3f &at) {
    std::vector<CornerTerm> combined;
    for (std::size_t c = 0; c < 8; ++c) {
        const float weight = leaf.Weight(c, at);
        if (weight == 0)
            continue;
        for (const CornerTerm &term : TermsOf(leaf.Corner(c))) {
            const auto same = std::find_if(combined.begin(), combined.end(),
                                           [&](const CornerTerm &t) { return t.stored == term.stored; });
            if (same == combined.end())
                combined.push_back({term.stored, weight * term.weight});
            else
                same->weight += weight * term.weight;
        }
    }
    return combined;
}

// ---- Least-squares fit of the stored corners to the light inside the cells ----

namespace {

constexpr int kIterations = 4;
/// The fit changes a corner by at most this fraction of its mean light, so that the dark stays dark beside the bright.
constexpr float kMaxChange = 0.5f;
/// Weight of a corner's own light, as a fraction of the weight of the samples around it.
constexpr float kPull = 0.05f;

/// The normal equations of the fit, without their matrix: products with it are sums over the samples.
class FitSystem {
  public:
    explicit FitSystem(std::size_t unknowns) : weights_(unknowns), diagonal_(unknowns) {}
    /// terms: the interpolated value at the sample.
    void AddSample(const SHFloats &light, const std::vector<CornerTerm> &terms) {
        const float weight = FitWeight(1, std::max(0.0f, MeanLight(light)), FittedPoints::All);
        samples_.push_back({light, weight, std::uint32_t(terms_.size()), std::uint32_t(terms.size())});
        for (const CornerTerm &term : terms) {
            terms_.push_back(term);
            weights_[term.stored] += weight * term.weight;
            diagonal_[term.stored] += weight * term.weight * term.weight;
        }
    }
    /// A few steps of preconditioned conjugate gradients from `values`, towards which each unknown is pulled.
    void Solve(std::vector<SHFloats> &values) const;

  private:
    using Vector = std::vector<SHFloats>;
    struct Sample {
        SHFloats light;
        float weight;
        std::uint32_t first, count;
    };
    /// Matrix times x.
    void Apply(const Vector &x, Vector &product) const;
    /// Right-hand side minus matrix times x, with the pull towards x itself.
    Vector Residual(const Vector &x) const;
    SHFloats Interpolated(const Sample &sample, const Vector &x) const {
        SHFloats sum{};
        for (std::uint32_t t = sample.first; t < sample.first + sample.count; ++t)
            AddScaled(terms_[t].weight, x[terms_[t].stored], sum);
        return sum;
    }
    /// Adds the transpose of interpolation, times the weight of the sample, of a value at it.
    void Scatter(const Sample &sample, const SHFloats &value, Vector &to) const {
        for (std::uint32_t t = sample.first; t < sample.first + sample.count; ++t)
            AddScaled(sample.weight * terms_[t].weight, value, to[terms_[t].stored]);
    }
    double Dot(const Vector &a, const Vector &b) const {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            float row = 0;
            for (std::size_t k = 0; k < kSHFloats; ++k)
                row += a[i][k] * b[i][k];
            sum += double(row);
        }
        return sum;
    }
    /// The Jacobi preconditioner applied to a residual.
    Vector Preconditioned(const Vector &r) const {
        Vector z(r.size());
        for (std::size_t i = 0; i < r.size(); ++i)
            if (const float diagonal = diagonal_[i] + kPull * weights_[i]; diagonal > 0)
                AddScaled(1 / diagonal, r[i], z[i]);
        return z;
    }

    std::vector<Sample> samples_;
    std::vector<CornerTerm> terms_;
    std::vector<float> weights_;  ///< by unknown: sum over its samples of their weight times its fraction
    std::vector<float> diagonal_; ///< by unknown: of the matrix, without the pull
};

void FitSystem::Apply(const Vector &x, Vector &product) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
        product[i] = {};
        AddScaled(kPull * weights_[i], x[i], product[i]);
    }
    for (const Sample &sample : samples_)
        Scatter(sample, Interpolated(sample, x), product);
}

FitSystem::Vector FitSystem::Residual(const Vector &x) const {
    Vector residual(x.size());
    for (const Sample &sample : samples_) {
        SHFloats difference = Interpolated(sample, x);
        for (std::size_t k = 0; k < kSHFloats; ++k)
            difference[k] = sample.light[k] - difference[k];
        Scatter(sample, difference, residual);
    }
    return residual;
}

void FitSystem::Solve(Vector &values) const {
    Vector r = Residual(values), z = Preconditioned(r), direction = z, product(values.size());
    double rho = Dot(r, z);
    for (int step = 0; step < kIterations && rho > 0; ++step) {
        Apply(direction, product);
        const double curvature = Dot(direction, product);
        if (!(curvature > 0))
            return;
        const auto length = float(rho / curvature);
        for (std::size_t i = 0; i < values.size(); ++i) {
            AddScaled(length, direction[i], values[i]);
            AddScaled(-length, product[i], r[i]);
        }
        z = Preconditioned(r);
        const double next = Dot(r, z);
        const auto keep = float(next / rho);
        for (std::size_t i = 0; i < values.size(); ++i)
            for (std::size_t k = 0; k < kSHFloats; ++k)
                direction[i][k] = z[i][k] + keep * direction[i][k];
        rho = next;
    }
}

/// Scales the change of a value down to kMaxChange times the norm of its coefficients 0.
void LimitChange(const SHFloats &before, SHFloats &value) {
    float change = 0, base = 0;
    for (std::size_t k = 0; k < kSHFloats; ++k)
        change += (value[k] - before[k]) * (value[k] - before[k]);
    for (std::size_t channel = 0; channel < 3; ++channel)
        base += before[channel] * before[channel];
    const float most = kMaxChange * std::sqrt(base);
    change = std::sqrt(change);
    for (std::size_t k = 0; k < kSHFloats && change > most; ++k)
        value[k] = before[k] + (value[k] - before[k]) * (most / change);
}

} // namespace

std::vector<SHFloats> FitCorners(const Octree &tree, const LatticePoints &light, CornerWeights &corners,
                                 const SparseLattice &lattice, const BspSpace &space,
                                 std::span<const NearLightSample> nearLights) {
    std::vector<SHFloats> values;
    for (const std::uint32_t number : corners.Stored())
        values.push_back(light[number].value);
    std::vector<bool> clear(tree.Size()); // leafs without solids
    for (const std::size_t leaf : tree.OpenLeafs())
        clear[leaf] = !space.AnySolid(lattice.PositionOf(tree[leaf].origin), lattice.PositionOf(tree[leaf].Corner(7)));
    FitSystem system(values.size());
    for (std::size_t i = 0; i < light.Size(); ++i) {
        const LatticeSample &point = light[i];
        if (!point.open)
            continue;
        std::size_t inside = Octree::kNone;
        bool nearSolid = false;
        for (const std::size_t leaf : tree.LeafsAround(point.at))
            if (leaf != Octree::kNone && tree[leaf].open > 0) {
                inside = leaf; // any of the leafs that touch the point will do: light is continuous
                nearSolid = nearSolid || !clear[leaf];
            }
        const bool stored = corners.IsStored(std::uint32_t(i));
        if (inside != Octree::kNone && (stored || !nearSolid))
            system.AddSample(point.value, corners.TermsIn(tree[inside], point.at));
    }
    for (const NearLightSample &sample : nearLights) {
        const std::size_t leaf = tree.LeafAt(CellAt(sample.at));
        if (leaf != Octree::kNone && tree[leaf].open > 0 && clear[leaf])
            system.AddSample(sample.light, corners.TermsIn(tree[leaf], sample.at));
    }
    system.Solve(values);
    for (std::size_t i = 0; i < values.size(); ++i)
        LimitChange(light[corners.Stored()[i]].value, values[i]);
    return values;
}

// ---- Converts the octree to the nodes and values of the sparse SH grid ----

namespace {

/// What the file says of the lower corner of a leaf.
enum class CornerRecord : std::uint8_t { Nothing, Stored, Hanging };

/// Marks the lower corners of leafs, then writes the nodes breadth first.
class TreeWriter {
  public:
    TreeWriter(Octree tree, const LatticePoints &light, const CornerWeights &corners)
        : tree_(std::move(tree)), light_(light), corners_(corners) {
        for (const std::uint32_t number : corners.Stored())
            Place(light[number].at, CornerRecord::Stored);
        for (const std::size_t leaf : tree_.OpenLeafs())
            for (std::size_t c = 0; c < 8; ++c)
                if (const LatticePoint p = tree_[leaf].Corner(c); !corners.IsStored(light.Find(p)))
                    PlaceHanging(p);
    }

    SparseGridTree Write(const std::vector<SHFloats> &values) const;

  private:
    /// Marks p, and splits the leaf that contains it until p is its lower corner. A leaf with open space is not split:
    /// p lies on its boundary, and readers go on to the cube around by themselves.
    void Place(const LatticePoint &p, CornerRecord what) {
        std::size_t leaf = tree_.LeafAt(p);
        if (leaf == Octree::kNone)
            return;
        while (tree_[leaf].origin != p) {
            if (tree_[leaf].open > 0)
                return;
            tree_.Split(leaf);
            recordOfLeaf_.resize(tree_.Size(), CornerRecord::Nothing);
            std::swap(recordOfLeaf_[leaf],
                      recordOfLeaf_[tree_[leaf].child]); // the lower corner is now that of the first child
            leaf = tree_.LeafAt(p);
        }
        recordOfLeaf_.resize(tree_.Size(), CornerRecord::Nothing);
        if (recordOfLeaf_[leaf] == CornerRecord::Nothing)
            recordOfLeaf_[leaf] = what;
    }
    /// Places a hanging point and its parents, between which readers interpolate it: with 2^power the greatest power of
    /// two that divides all its coordinates, the points 2^power away on both sides of each axis on which its coordinate
    /// is an odd multiple of that.
    void PlaceHanging(const LatticePoint &p) {
        if (!hanging_.insert(KeyOf(p)).second)
            return;
        Place(p, CornerRecord::Hanging);
        const int power = std::countr_zero(std::uint32_t(p[0] | p[1] | p[2]));
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
        for (const LatticePoint &parent : parents) {
            const std::uint32_t number = light_.Find(parent);
            if (number == LatticePoints::kUnknown || !corners_.IsStored(number))
                PlaceHanging(parent);
        }
    }
    /// By cell: whether it, or a leaf below it, owns a point.
    std::vector<bool> FindUsed() const;

    Octree tree_;
    const LatticePoints &light_;
    const CornerWeights &corners_;
    std::vector<CornerRecord> recordOfLeaf_;    ///< by leaf; may be shorter than the tree
    std::unordered_set<std::uint64_t> hanging_; ///< keys of the hanging points that are placed
};

std::vector<bool> TreeWriter::FindUsed() const {
    std::vector<bool> used(tree_.Size());
    for (std::size_t i = tree_.Size(); i-- > 0;) {
        if (tree_[i].child == 0)
            used[i] = i < recordOfLeaf_.size() && recordOfLeaf_[i] != CornerRecord::Nothing;
        for (std::size_t c = 0; c < 8 && tree_[i].child != 0; ++c)
            used[i] = used[i] || used[tree_[i].child + c];
    }
    return used;
}

SparseGridTree TreeWriter::Write(const std::vector<SHFloats> &values) const {
    SparseGridTree file;
    const std::vector<bool> used = FindUsed();
    std::vector<std::size_t> level(tree_.RootCount()), next;
    for (std::size_t i = 0; i < level.size(); ++i)
        level[i] = i;
    std::vector<std::uint32_t> valueOf(light_.Size());
    for (std::size_t i = 0; i < values.size(); ++i)
        valueOf[corners_.Stored()[i]] = std::uint32_t(i);
    for (; !level.empty(); level = std::move(next), next.clear())
        for (const std::size_t at : level) {
            SparseGridNode &node = file.nodes.emplace_back();
            for (std::size_t c = 0; c < 8 && tree_[at].child != 0; ++c) {
                const std::size_t child = tree_[at].child + c;
                const auto bit = std::uint8_t(1u << c);
                if (tree_[child].child != 0 && used[child]) {
                    node.inner |= bit;
                    next.push_back(child);
                } else if (used[child] && recordOfLeaf_[child] == CornerRecord::Hanging)
                    node.hanging |= bit;
                else if (used[child]) {
                    node.stored |= bit;
                    file.values.push_back(
                        std::bit_cast<bspGridPointSH_t>(values[valueOf[light_.Find(tree_[child].origin)]]));
                }
            }
        }
    return file;
}

} // namespace

SparseGridTree MakeSparseTree(Octree tree, const LatticePoints &light, const CornerWeights &corners,
                              const SparseLattice &lattice, const std::vector<SHFloats> &values) {
    SparseGridTree file = TreeWriter(std::move(tree), light, corners).Write(values);
    const Vec3f &mins = lattice.Mins(), &cell = lattice.Cell();
    file.mins = {mins.x, mins.y, mins.z};
    file.cell = {cell.x, cell.y, cell.z};
    file.roots = lattice.Roots();
    file.levels = lattice.Levels();
    return file;
}

} // namespace q3
