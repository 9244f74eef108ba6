// GPL-2.0-or-later. Sparse linear least squares with a pull towards initial values, by conjugate gradients.
#pragma once

#include "common/parallel.h"
#include "q3map2/light/grid/probe_integrator.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
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

/// Samples in a row, each a combination of unknowns with its value. Several of them make up the samples of a
/// LeastSquares, so that workers can fill them at the same time.
template <typename Value> class SampleBlock {
  public:
    /// terms: structures of an unknown and its weight.
    template <typename Terms> void Add(const Value &value, float weight, const Terms &terms) {
        samples_.push_back({value, weight, std::uint32_t(terms.size())});
        for (const auto &[unknown, termWeight] : terms)
            terms_.push_back({unknown, termWeight});
    }
    std::size_t Size() const { return samples_.size(); }
    std::size_t TermCount() const { return terms_.size(); }
    /// Calls use(i, value, weight, terms) for each sample i.
    template <typename Use> void ForEach(const Use &use) const {
        const UnknownTerm *terms = terms_.data();
        for (std::size_t i = 0; i < samples_.size(); terms += samples_[i++].termCount)
            use(i, samples_[i].value, samples_[i].weight, std::span(terms, samples_[i].termCount));
    }

  private:
    struct Sample {
        Value value;
        float weight;
        std::uint32_t termCount;
    };
    std::vector<Sample> samples_;
    std::vector<UnknownTerm> terms_; ///< of all samples in a row
};

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
    /// blocks: all samples, in order.
    LeastSquares(std::size_t unknowns, std::vector<SampleBlock<Value>> blocks, const JobPool &jobs)
        : blocks_(std::move(blocks)), pull_(unknowns), diagonal_(unknowns), weights_(unknowns) {
        std::size_t terms = 0;
        for (const SampleBlock<Value> &block : blocks_) {
            firstSamples_.push_back(std::uint32_t(samples_));
            samples_ += block.Size(), terms += block.TermCount();
        }
        MakeColumns(terms, jobs);
    }
    /// Sum over s of w(s) a(s, unknown).
    float WeightOf(std::size_t unknown) const { return weights_[unknown]; }
    void SetPull(std::size_t unknown, float pull) { pull_[unknown] = pull; }

    /// Conjugate gradients with Jacobi's preconditioner M, at most `steps` of them. x: x0, replaced by the result. As
    /// usual r is the residual, z = M^-1 r, rho = r . z, alpha the step length, and beta the factor of the last
    /// direction in the next one.
    void Solve(std::vector<Value> &x, int steps, const JobPool &jobs = JobPool(1)) const {
        const auto makeVector = [](std::size_t size) { return std::make_unique_for_overwrite<Value[]>(size); };
        const Vector differences = makeVector(samples_), r = makeVector(x.size()), z = makeVector(x.size());
        const Vector direction = makeVector(x.size()), product = makeVector(x.size());
        ForSamples(jobs, [&](std::size_t s, const Value &value, float, std::span<const UnknownTerm> terms) {
            differences[s] = value;
            AddScaledValue(-1, Combined(terms, x.data()), differences[s]);
        });
        // A^T W (value - A x) for x = x0, where the pull is 0; and z.
        ForAll(jobs, x.size(), kPart, [&](std::size_t i) {
            r[i] = {};
            AddColumn(i, differences, r[i]);
            direction[i] = z[i] = Preconditioned(i, r[i]);
        });
        double rho = Dot(r, z, jobs);
        for (int step = 0; step < steps && rho > 0; ++step) {
            Apply(direction, differences, product, jobs);
            const double curvature = Dot(direction, product, jobs);
            if (!(curvature > 0))
                return;
            const auto alpha = float(rho / curvature);
            ForAll(jobs, x.size(), kPart, [&](std::size_t i) {
                AddScaledValue(alpha, direction[i], x[i]);
                AddScaledValue(-alpha, product[i], r[i]);
                z[i] = Preconditioned(i, r[i]);
            });
            const double nextRho = Dot(r, z, jobs);
            const auto beta = float(nextRho / rho);
            ForAll(jobs, x.size(), kPart, [&](std::size_t i) {
                Value next = z[i];
                AddScaledValue(beta, direction[i], next);
                direction[i] = next;
            });
            rho = nextRho;
        }
    }

  private:
    static constexpr std::size_t kPart = 2048; ///< unknowns of one job
    /// Not initialized: the workers that fill it get its memory from the system, too.
    using Vector = std::unique_ptr<Value[]>;
    /// A sample in which an unknown has a term, and w(s) a(s, unknown).
    struct Entry {
        std::uint32_t sample;
        float weight;
    };

    /// Calls use(s, value, weight, terms) for the samples s of a block.
    template <typename Use> void ForSamplesOf(std::size_t block, const Use &use) const {
        blocks_[block].ForEach(
            [&](std::size_t i, const Value &value, float weight, std::span<const UnknownTerm> terms) {
                use(firstSamples_[block] + i, value, weight, terms);
            });
    }
    /// The same for all samples, on all workers.
    template <typename Use> void ForSamples(const JobPool &jobs, const Use &use) const {
        jobs.For(std::int64_t(blocks_.size()), [&](std::int64_t block, int) { ForSamplesOf(std::size_t(block), use); });
    }
    /// Sets the columns, and the sums over each. A counting sort of all terms by unknown: several groups of blocks are
    /// counted and sorted at the same time.
    void MakeColumns(std::size_t terms, const JobPool &jobs) {
        constexpr int kMaxGroups = 16; // each takes as much memory as the ends
        const auto groups = std::size_t(std::min(jobs.Threads(), kMaxGroups));
        // By group and unknown: number of its entries; then the place of the next one.
        std::vector<std::vector<std::uint32_t>> places(groups);
        const auto forTerms = [&](const auto &use) {
            jobs.For(std::int64_t(groups), [&](std::int64_t job, int) {
                const auto group = std::size_t(job);
                places[group].resize(pull_.size());
                for (std::size_t b = blocks_.size() * group / groups; b < blocks_.size() * (group + 1) / groups; ++b)
                    ForSamplesOf(
                        b, [&](std::size_t s, const Value &, float weight, std::span<const UnknownTerm> ofSample) {
                            for (const UnknownTerm &term : ofSample)
                                use(places[group][term.unknown], s, weight, term.weight);
                        });
            });
        };
        forTerms([](std::uint32_t &count, std::size_t, float, float) { ++count; });
        ends_.resize(pull_.size());
        std::uint32_t end = 0;
        for (std::size_t i = 0; i < ends_.size(); ++i) {
            for (std::vector<std::uint32_t> &ofGroup : places)
                end += std::exchange(ofGroup[i], end);
            ends_[i] = end;
        }
        entries_ = std::make_unique_for_overwrite<Entry[]>(terms);
        const auto factors = std::make_unique_for_overwrite<float[]>(terms); // by entry: a(s, unknown)
        forTerms([&](std::uint32_t &place, std::size_t s, float weight, float factor) {
            factors[place] = factor;
            entries_[place++] = {std::uint32_t(s), weight * factor};
        });
        ForAll(jobs, pull_.size(), kPart, [&](std::size_t i) {
            for (std::uint32_t e = BeginOf(i); e < ends_[i]; ++e) {
                weights_[i] += entries_[e].weight;
                diagonal_[i] += entries_[e].weight * factors[e];
            }
        });
    }
    /// Sum of terms: (A x)(s) for those of a sample s.
    static Value Combined(std::span<const UnknownTerm> terms, const Value *x) {
        Value sum{};
        for (const UnknownTerm &term : terms)
            AddScaledValue(term.weight, x[term.unknown], sum);
        return sum;
    }
    std::uint32_t BeginOf(std::size_t unknown) const { return unknown > 0 ? ends_[unknown - 1] : 0; }
    /// to += (A^T W ofSamples)(unknown).
    void AddColumn(std::size_t unknown, const Vector &ofSamples, Value &to) const {
        for (std::uint32_t e = BeginOf(unknown); e < ends_[unknown]; ++e)
            AddScaledValue(entries_[e].weight, ofSamples[entries_[e].sample], to);
    }
    /// product = (A^T W A + R) x. `ofSamples`: scratch memory.
    void Apply(const Vector &x, const Vector &ofSamples, const Vector &product, const JobPool &jobs) const {
        ForSamples(jobs, [&](std::size_t s, const Value &, float, std::span<const UnknownTerm> terms) {
            ofSamples[s] = Combined(terms, x.get());
        });
        ForAll(jobs, pull_.size(), kPart, [&](std::size_t i) {
            product[i] = {};
            AddScaledValue(pull_[i], x[i], product[i]);
            AddColumn(i, ofSamples, product[i]);
        });
    }
    /// The sum is made in order.
    double Dot(const Vector &a, const Vector &b, const JobPool &jobs) const {
        std::vector<float> products(pull_.size());
        ForAll(jobs, products.size(), kPart, [&](std::size_t i) { products[i] = DotOfValues(a[i], b[i]); });
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

    std::vector<SampleBlock<Value>> blocks_;
    std::vector<std::uint32_t> firstSamples_; ///< by block: number of its first sample
    std::size_t samples_ = 0;                 ///< number of all samples
    std::vector<float> pull_;                 ///< by unknown
    std::vector<float> diagonal_;             ///< of A^T W A
    std::vector<float> weights_;              ///< WeightOf, by unknown
    // A^T W: for each unknown its entries, in the order of samples.
    std::vector<std::uint32_t> ends_; ///< by unknown: end of its entries
    std::unique_ptr<Entry[]> entries_;
};

} // namespace q3
