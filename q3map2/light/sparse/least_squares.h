// GPL-2.0-or-later. Sparse linear least squares with a pull towards initial values, by conjugate gradients.
#pragma once

#include "q3map2/light/grid/probe_integrator.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// A term of a linear combination of unknowns.
struct UnknownTerm {
    std::uint32_t unknown = 0;
    float weight = 0;
};

// Operations of LeastSquares on its values: floats, or coefficients.
inline void AddScaledValue(float factor, const SHFloats &value, SHFloats &sum) {
    AddScaled(factor, value, sum);
}
inline void AddScaledValue(float factor, float value, float &sum) {
    sum += factor * value;
}
inline float DotOfValues(const SHFloats &a, const SHFloats &b) {
    float sum = 0;
    for (std::size_t k = 0; k < kSHFloats; ++k)
        sum += a[k] * b[k];
    return sum;
}
inline float DotOfValues(float a, float b) {
    return a * b;
}

/// Minimizes over x, with samples s and unknowns i,
///
///     sum over s of w(s) |sum over i of a(s, i) x(i) - value(s)|^2 + sum over i of pull(i) |x(i) - x0(i)|^2
///
/// x0: initial values (Tikhonov regularization); a(s, i): weight of UnknownTerm i of s. The normal equations are
/// (A^T W A + R) x = A^T W value + R x0, with W = diag(w) and R = diag(pull). Matrix-free: products are sums over the
/// samples.
template <typename Value> class LeastSquares {
  public:
    explicit LeastSquares(std::size_t unknowns) : pull_(unknowns), diagonal_(unknowns), weights_(unknowns) {}

    void AddSample(const Value &value, float weight, std::span<const UnknownTerm> terms) {
        samples_.push_back({value, weight, std::uint32_t(terms_.size()), std::uint32_t(terms.size())});
        for (const UnknownTerm &term : terms) {
            terms_.push_back(term);
            weights_[term.unknown] += weight * term.weight;
            diagonal_[term.unknown] += weight * term.weight * term.weight;
        }
    }
    /// Sum over s of w(s) a(s, unknown).
    float WeightOf(std::size_t unknown) const { return weights_[unknown]; }
    void SetPull(std::size_t unknown, float pull) { pull_[unknown] = pull; }

    /// Conjugate gradients with Jacobi's preconditioner M, at most `steps` of them. x: x0, replaced by the result. As
    /// usual r is the residual, z = M^-1 r, rho = r . z, alpha the step length, and beta the factor of the last
    /// direction in the next one.
    void Solve(std::vector<Value> &x, int steps) const {
        Vector r = ResidualAtStart(x), z = Preconditioned(r), direction = z, product(x.size());
        double rho = Dot(r, z);
        for (int step = 0; step < steps && rho > 0; ++step) {
            Apply(direction, product);
            const double curvature = Dot(direction, product);
            if (!(curvature > 0))
                return;
            const auto alpha = float(rho / curvature);
            for (std::size_t i = 0; i < x.size(); ++i) {
                AddScaledValue(alpha, direction[i], x[i]);
                AddScaledValue(-alpha, product[i], r[i]);
            }
            z = Preconditioned(r);
            const double nextRho = Dot(r, z);
            const auto beta = float(nextRho / rho);
            for (std::size_t i = 0; i < x.size(); ++i) {
                Value next = z[i];
                AddScaledValue(beta, direction[i], next);
                direction[i] = next;
            }
            rho = nextRho;
        }
    }

  private:
    using Vector = std::vector<Value>;
    struct Sample {
        Value value;
        float weight;
        std::uint32_t firstTerm, termCount;
    };
    /// (A x)(s).
    Value Combined(const Sample &sample, const Vector &x) const {
        Value sum{};
        for (std::uint32_t t = sample.firstTerm; t < sample.firstTerm + sample.termCount; ++t)
            AddScaledValue(terms_[t].weight, x[terms_[t].unknown], sum);
        return sum;
    }
    /// to += A^T W of a vector that is `value` at s, and 0 at all other samples.
    void Scatter(const Sample &sample, const Value &value, Vector &to) const {
        for (std::uint32_t t = sample.firstTerm; t < sample.firstTerm + sample.termCount; ++t)
            AddScaledValue(sample.weight * terms_[t].weight, value, to[terms_[t].unknown]);
    }
    /// product = (A^T W A + R) x.
    void Apply(const Vector &x, Vector &product) const {
        for (std::size_t i = 0; i < x.size(); ++i) {
            product[i] = {};
            AddScaledValue(pull_[i], x[i], product[i]);
        }
        for (const Sample &sample : samples_)
            Scatter(sample, Combined(sample, x), product);
    }
    /// A^T W (value - A x) for x = x0, where the pull is 0.
    Vector ResidualAtStart(const Vector &x) const {
        Vector residual(x.size());
        for (const Sample &sample : samples_) {
            Value difference = sample.value;
            AddScaledValue(-1, Combined(sample, x), difference);
            Scatter(sample, difference, residual);
        }
        return residual;
    }
    static double Dot(const Vector &a, const Vector &b) {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            sum += double(DotOfValues(a[i], b[i]));
        return sum;
    }
    /// M^-1 r, M the diagonal of A^T W A + R.
    Vector Preconditioned(const Vector &r) const {
        Vector z(r.size());
        for (std::size_t i = 0; i < r.size(); ++i)
            if (const float diagonal = diagonal_[i] + pull_[i]; diagonal > 0)
                AddScaledValue(1 / diagonal, r[i], z[i]);
        return z;
    }

    std::vector<Sample> samples_;
    std::vector<UnknownTerm> terms_;
    std::vector<float> pull_;     ///< by unknown
    std::vector<float> diagonal_; ///< of A^T W A
    std::vector<float> weights_;  ///< WeightOf, by unknown
};

} // namespace q3
