// GPL-2.0-or-later. Sparse linear least squares with a pull towards initial values, by conjugate gradients.
#pragma once

#include "common/jobs.h"
#include "common/parallel_memory.h"
#include "q3map2/light/grid/probe_integrator.h"

#include <algorithm>
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
/// (A^T W A + R) x = A^T W value + R x0, with W = diag(w) and R = diag(pull). Matrix-free: products with A and A^T W
/// are sums over the terms of a sample, and of an unknown in the order of samples, so any number of workers rounds
/// alike.
template <typename Value> class LeastSquares {
  public:
    explicit LeastSquares(std::size_t unknowns) : pull_(unknowns), diagonal_(unknowns), weights_(unknowns) {}

    /// Gets memory for that many samples, with that many terms in all.
    void Reserve(std::size_t samples, std::size_t terms, const JobPool &jobs) {
        ReserveInParallel(samples, jobs, samples_);
        ReserveInParallel(terms, jobs, terms_);
    }
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
    void Solve(std::vector<Value> &x, int steps, const JobPool &jobs = JobPool(1)) const {
        const Columns columns = ColumnsOfSamples(jobs);
        const auto makeVector = [&](std::size_t size) { return VectorInParallel<Value>(size, jobs); };
        Vector differences = makeVector(samples_.size()), r = makeVector(x.size()), z = makeVector(x.size());
        Vector product = makeVector(x.size());
        ForParts(jobs, samples_.size(), [&](std::size_t s) {
            differences[s] = samples_[s].value;
            AddScaledValue(-1, Combined(samples_[s], x), differences[s]);
        });
        // A^T W (value - A x) for x = x0, where the pull is 0; and z.
        ForParts(jobs, x.size(), [&](std::size_t i) {
            AddColumn(columns, i, differences, r[i]);
            z[i] = Preconditioned(i, r[i]);
        });
        Vector direction = z;
        double rho = Dot(r, z, jobs);
        for (int step = 0; step < steps && rho > 0; ++step) {
            Apply(columns, direction, differences, product, jobs);
            const double curvature = Dot(direction, product, jobs);
            if (!(curvature > 0))
                return;
            const auto alpha = float(rho / curvature);
            ForParts(jobs, x.size(), [&](std::size_t i) {
                AddScaledValue(alpha, direction[i], x[i]);
                AddScaledValue(-alpha, product[i], r[i]);
                z[i] = Preconditioned(i, r[i]);
            });
            const double nextRho = Dot(r, z, jobs);
            const auto beta = float(nextRho / rho);
            ForParts(jobs, x.size(), [&](std::size_t i) {
                Value next = z[i];
                AddScaledValue(beta, direction[i], next);
                direction[i] = next;
            });
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
    /// A sample in which an unknown has a term, and w(s) a(s, unknown).
    struct Entry {
        std::uint32_t sample;
        float weight;
    };
    /// A^T W: for each unknown its entries, in the order of samples.
    struct Columns {
        std::vector<std::uint32_t> ends; ///< by unknown: end of its entries
        std::vector<Entry> entries;
    };

    /// Calls use(i) for i from 0 to count - 1, on all workers.
    template <typename Use> static void ForParts(const JobPool &jobs, std::size_t count, const Use &use) {
        constexpr std::size_t kPart = 2048;
        jobs.For(std::int64_t((count + kPart - 1) / kPart), [&](std::int64_t part, int) {
            const std::size_t first = std::size_t(part) * kPart, end = std::min(count, first + kPart);
            for (std::size_t i = first; i < end; ++i)
                use(i);
        });
    }
    Columns ColumnsOfSamples(const JobPool &jobs) const {
        Columns columns{std::vector<std::uint32_t>(pull_.size() + 1), VectorInParallel<Entry>(terms_.size(), jobs)};
        for (const UnknownTerm &term : terms_)
            ++columns.ends[term.unknown + 1];
        for (std::size_t i = 1; i < columns.ends.size(); ++i)
            columns.ends[i] += columns.ends[i - 1];
        for (std::size_t s = 0; s < samples_.size(); ++s)
            for (std::uint32_t t = samples_[s].firstTerm; t < samples_[s].firstTerm + samples_[s].termCount; ++t)
                columns.entries[columns.ends[terms_[t].unknown]++] = {std::uint32_t(s),
                                                                      samples_[s].weight * terms_[t].weight};
        return columns;
    }
    /// (A x)(s).
    Value Combined(const Sample &sample, const Vector &x) const {
        Value sum{};
        for (std::uint32_t t = sample.firstTerm; t < sample.firstTerm + sample.termCount; ++t)
            AddScaledValue(terms_[t].weight, x[terms_[t].unknown], sum);
        return sum;
    }
    /// to += (A^T W ofSamples)(unknown).
    static void AddColumn(const Columns &columns, std::size_t unknown, const Vector &ofSamples, Value &to) {
        for (std::uint32_t e = unknown > 0 ? columns.ends[unknown - 1] : 0; e < columns.ends[unknown]; ++e)
            AddScaledValue(columns.entries[e].weight, ofSamples[columns.entries[e].sample], to);
    }
    /// product = (A^T W A + R) x. `ofSamples`: scratch memory.
    void Apply(const Columns &columns, const Vector &x, Vector &ofSamples, Vector &product, const JobPool &jobs) const {
        ForParts(jobs, samples_.size(), [&](std::size_t s) { ofSamples[s] = Combined(samples_[s], x); });
        ForParts(jobs, x.size(), [&](std::size_t i) {
            product[i] = {};
            AddScaledValue(pull_[i], x[i], product[i]);
            AddColumn(columns, i, ofSamples, product[i]);
        });
    }
    /// The sum is made in order.
    static double Dot(const Vector &a, const Vector &b, const JobPool &jobs) {
        std::vector<float> products(a.size());
        ForParts(jobs, a.size(), [&](std::size_t i) { products[i] = DotOfValues(a[i], b[i]); });
        double sum = 0;
        for (const float product : products)
            sum += double(product);
        return sum;
    }
    /// M^-1 r, M the diagonal of A^T W A + R, for one unknown.
    Value Preconditioned(std::size_t unknown, const Value &r) const {
        Value z{};
        if (const float diagonal = diagonal_[unknown] + pull_[unknown]; diagonal > 0)
            AddScaledValue(1 / diagonal, r, z);
        return z;
    }

    std::vector<Sample> samples_;
    std::vector<UnknownTerm> terms_;
    std::vector<float> pull_;     ///< by unknown
    std::vector<float> diagonal_; ///< of A^T W A
    std::vector<float> weights_;  ///< WeightOf, by unknown
};

} // namespace q3
