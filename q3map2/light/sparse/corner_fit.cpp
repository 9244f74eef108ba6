// GPL-2.0-or-later. Least-squares fit of the stored corners to the light inside the cells.
#include "q3map2/light/sparse/corner_fit.h"

#include "q3map2/light/grid/gridsh_fit.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

constexpr int kIterations = 4;
/// The fit changes a corner by at most this share of its mean light, so that the dark stays dark beside the bright.
constexpr float kMaxChange = 0.5f;
/// Weight of a corner's own light, as a share of the weight of the samples around it.
constexpr float kPull = 0.05f;

/// The normal equations of the fit, without their matrix: products with it are sums over the samples.
class FitSystem {
  public:
    explicit FitSystem(std::size_t unknowns) : weights_(unknowns), diagonal_(unknowns) {}
    /// terms: the interpolated value at the sample.
    void AddSample(const ShFloats &light, const std::vector<CornerTerm> &terms) {
        const float weight = FitWeight(1, std::max(0.0f, MeanLight(light)), true);
        samples_.push_back({light, weight, std::uint32_t(terms_.size()), std::uint32_t(terms.size())});
        for (const CornerTerm &term : terms) {
            terms_.push_back(term);
            weights_[term.stored] += weight * term.weight;
            diagonal_[term.stored] += weight * term.weight * term.weight;
        }
    }
    /// A few steps of preconditioned conjugate gradients from `values`, towards which each unknown is pulled.
    void Solve(std::vector<ShFloats> &values) const;

  private:
    using Vector = std::vector<ShFloats>;
    struct Sample {
        ShFloats light;
        float weight;
        std::uint32_t first, count;
    };
    /// Matrix times x.
    void Apply(const Vector &x, Vector &product) const;
    /// Right-hand side minus matrix times x, with the pull towards x itself.
    Vector Residual(const Vector &x) const;
    ShFloats Interpolated(const Sample &sample, const Vector &x) const {
        ShFloats sum{};
        for (std::uint32_t t = sample.first; t < sample.first + sample.count; ++t)
            AddScaled(terms_[t].weight, x[terms_[t].stored], sum);
        return sum;
    }
    /// Adds the transpose of interpolation, times the weight of the sample, of a value at it.
    void Scatter(const Sample &sample, const ShFloats &value, Vector &to) const {
        for (std::uint32_t t = sample.first; t < sample.first + sample.count; ++t)
            AddScaled(sample.weight * terms_[t].weight, value, to[terms_[t].stored]);
    }
    double Dot(const Vector &a, const Vector &b) const {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            float row = 0;
            for (std::size_t k = 0; k < kShFloats; ++k)
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
    std::vector<float> weights_;  ///< by unknown: sum over its samples of their weight times its share
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
        ShFloats difference = Interpolated(sample, x);
        for (std::size_t k = 0; k < kShFloats; ++k)
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
            for (std::size_t k = 0; k < kShFloats; ++k)
                direction[i][k] = z[i][k] + keep * direction[i][k];
        rho = next;
    }
}

/// Scales the change of a value down to kMaxChange times the norm of its coefficients 0.
void LimitChange(const ShFloats &before, ShFloats &value) {
    float change = 0, base = 0;
    for (std::size_t k = 0; k < kShFloats; ++k)
        change += (value[k] - before[k]) * (value[k] - before[k]);
    for (std::size_t channel = 0; channel < 3; ++channel)
        base += before[channel] * before[channel];
    const float most = kMaxChange * std::sqrt(base);
    change = std::sqrt(change);
    for (std::size_t k = 0; k < kShFloats && change > most; ++k)
        value[k] = before[k] + (value[k] - before[k]) * (most / change);
}

} // namespace

std::vector<ShFloats> FitCorners(const Octree &tree, const LatticePoints &light, CornerWeights &corners,
                                 const SparseLattice &lattice, const BspSpace &space,
                                 std::span<const LampSample> lamps) {
    std::vector<ShFloats> values;
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
    for (const LampSample &lamp : lamps) {
        const std::size_t leaf = tree.LeafAt(CellAt(lamp.at));
        if (leaf != Octree::kNone && tree[leaf].open > 0 && clear[leaf])
            system.AddSample(lamp.light, corners.TermsIn(tree[leaf], lamp.at));
    }
    system.Solve(values);
    for (std::size_t i = 0; i < values.size(); ++i)
        LimitChange(light[corners.Stored()[i]].value, values[i]);
    return values;
}

} // namespace q3
