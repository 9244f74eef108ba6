// GPL-2.0-or-later. Sparse linear least squares with a pull towards first values, by conjugate gradients.
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

// What LeastSquares needs of its values.
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

/// Minimizes over x the sum of w(s) |sum of terms of s in x - value(s)|^2 over samples s, plus pull(i) |x(i) - x0(i)|^2
/// over unknowns i, x0 their first values (Tikhonov regularization). The normal equations are (A^T W A + R) x = A^T W
/// value + R x0, with A the terms of the samples, W their weights and R the pulls. Matrix-free: products are sums over
/// the samples.
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
    /// Sum over samples of weight times term of an unknown.
    float WeightOf(std::size_t unknown) const { return weights_[unknown]; }
    void SetPull(std::size_t unknown, float pull) { pull_[unknown] = pull; }

    /// Steps of conjugate gradients with Jacobi's preconditioner, from x0, which becomes the result. Names as usual:
    /// residual r, z = M^-1 r, rho = r . z, step alpha, and beta, the part of the last direction in the next one.
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
    Value Combined(const Sample &sample, const Vector &x) const {
        Value sum{};
        for (std::uint32_t t = sample.firstTerm; t < sample.firstTerm + sample.termCount; ++t)
            AddScaledValue(terms_[t].weight, x[terms_[t].unknown], sum);
        return sum;
    }
    void Scatter(const Sample &sample, const Value &value, Vector &to) const {
        for (std::uint32_t t = sample.firstTerm; t < sample.firstTerm + sample.termCount; ++t)
            AddScaledValue(sample.weight * terms_[t].weight, value, to[terms_[t].unknown]);
    }
    void Apply(const Vector &x, Vector &product) const {
        for (std::size_t i = 0; i < x.size(); ++i) {
            product[i] = {};
            AddScaledValue(pull_[i], x[i], product[i]);
        }
        for (const Sample &sample : samples_)
            Scatter(sample, Combined(sample, x), product);
    }
    /// The pull does not count: x is where it pulls to.
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
    Vector Preconditioned(const Vector &r) const {
        Vector z(r.size());
        for (std::size_t i = 0; i < r.size(); ++i)
            if (const float diagonal = diagonal_[i] + pull_[i]; diagonal > 0)
                AddScaledValue(1 / diagonal, r[i], z[i]);
        return z;
    }

    std::vector<Sample> samples_;
    std::vector<UnknownTerm> terms_;
    std::vector<float> pull_, diagonal_, weights_; ///< by unknown
};

} // namespace q3
