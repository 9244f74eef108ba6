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

/// Samples in a row, each a combination of unknowns with a number, by which LeastSquares::Solve asks for its value.
/// Several of them make up the samples of a LeastSquares, so that workers can fill them at the same time.
class SampleBlock {
  public:
    /// terms: structures of an unknown and its weight.
    template <typename Terms> void Add(std::uint32_t number, float weight, const Terms &terms) {
        samples_.push_back({number, weight, std::uint32_t(terms.size())});
        for (const auto &[unknown, termWeight] : terms)
            terms_.push_back({unknown, termWeight});
    }
    /// Gives back memory that is left over when all samples are added.
    void ShrinkToFit() {
        samples_.shrink_to_fit();
        terms_.shrink_to_fit();
    }
    std::size_t Size() const { return samples_.size(); }
    std::size_t TermCount() const { return terms_.size(); }
    /// Calls use(i, number, weight, terms) for each sample i.
    template <typename Use> void ForEach(const Use &use) const {
        const UnknownTerm *terms = terms_.data();
        for (std::size_t i = 0; i < samples_.size(); terms += samples_[i++].termCount)
            use(i, samples_[i].number, samples_[i].weight, std::span(terms, samples_[i].termCount));
    }

  private:
    struct Sample {
        std::uint32_t number;
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
class LeastSquares {
  public:
    /// blocks: all samples, in order.
    LeastSquares(std::size_t unknowns, std::vector<SampleBlock> blocks, const JobPool &jobs)
        : blocks_(std::move(blocks)), pull_(unknowns), diagonal_(unknowns), weights_(unknowns) {
        std::size_t samples = 0, terms = 0;
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            if (parts_.empty() || samples - parts_.back().firstSample >= kSamplesOfPart)
                parts_.push_back({b, b, samples, samples});
            firstSamples_.push_back(std::uint32_t(samples));
            samples += blocks_[b].Size(), terms += blocks_[b].TermCount();
            parts_.back().endBlock = b + 1, parts_.back().endSample = samples;
        }
        MakeColumns(terms, jobs);
    }
    /// Sum over s of w(s) a(s, unknown).
    float WeightOf(std::size_t unknown) const { return weights_[unknown]; }
    void SetPull(std::size_t unknown, float pull) { pull_[unknown] = pull; }

    /// Conjugate gradients with Jacobi's preconditioner M, at most `steps` of them. valueOf(number): the value of the
    /// samples of that number. x: x0, replaced by the result. As usual r is the residual, z = M^-1 r, rho = r . z,
    /// alpha the step length, and beta the factor of the last direction in the next one.
    template <typename Value, typename ValueOf>
    void Solve(const ValueOf &valueOf, std::vector<Value> &x, int steps, const JobPool &jobs = JobPool(1)) const {
        const Vector<Value> r = MakeVector<Value>(x.size()), direction = MakeVector<Value>(x.size()),
                            product = MakeVector<Value>(x.size());
        // A^T W (value - A x) for x = x0, where the pull is 0; and z.
        ForAll(jobs, x.size(), kUnknownsOfJob, [&](std::size_t i) { r[i] = {}; });
        const auto difference = [&](std::uint32_t number, std::span<const UnknownTerm> terms) {
            Value value = valueOf(number);
            AddScaledValue(-1, Combined(terms, x.data()), value);
            return value;
        };
        AddColumns(difference, r, jobs);
        ForAll(jobs, x.size(), kUnknownsOfJob, [&](std::size_t i) { direction[i] = Preconditioned(i, r[i]); });
        const auto productOfZ = [&](std::size_t i) { return DotOfValues(r[i], Preconditioned(i, r[i])); };
        double rho = SumInOrder(productOfZ, jobs);
        for (int step = 0; step < steps && rho > 0; ++step) {
            Apply(direction, product, jobs);
            const double curvature =
                SumInOrder([&](std::size_t i) { return DotOfValues(direction[i], product[i]); }, jobs);
            if (!(curvature > 0))
                return;
            const auto alpha = float(rho / curvature);
            ForAll(jobs, x.size(), kUnknownsOfJob, [&](std::size_t i) {
                AddScaledValue(alpha, direction[i], x[i]);
                AddScaledValue(-alpha, product[i], r[i]);
            });
            const double nextRho = SumInOrder(productOfZ, jobs);
            const auto beta = float(nextRho / rho);
            ForAll(jobs, x.size(), kUnknownsOfJob, [&](std::size_t i) {
                Value next = Preconditioned(i, r[i]);
                AddScaledValue(beta, direction[i], next);
                direction[i] = next;
            });
            rho = nextRho;
        }
    }

  private:
    static constexpr std::size_t kUnknownsOfJob = 2048;
    /// Products with A are in memory for so many samples at a time, or a block more.
    static constexpr std::size_t kSamplesOfPart = 32768;
    /// Not initialized: the workers that fill it get its memory from the system, too.
    template <typename Value> using Vector = std::unique_ptr<Value[]>;
    template <typename Value> static Vector<Value> MakeVector(std::size_t size) {
        return std::make_unique_for_overwrite<Value[]>(size);
    }
    /// A sample in which an unknown has a term, and w(s) a(s, unknown).
    struct Entry {
        std::uint32_t sample;
        float weight;
    };
    /// Blocks in a row.
    struct Part {
        std::size_t firstBlock, endBlock, firstSample, endSample;
    };

    /// Calls use(s, number, weight, terms) for the samples s of a block.
    template <typename Use> void ForSamplesOf(std::size_t block, const Use &use) const {
        blocks_[block].ForEach(
            [&](std::size_t i, std::uint32_t number, float weight, std::span<const UnknownTerm> terms) {
                use(firstSamples_[block] + i, number, weight, terms);
            });
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
                        b, [&](std::size_t s, std::uint32_t, float weight, std::span<const UnknownTerm> ofSample) {
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
        ForAll(jobs, pull_.size(), kUnknownsOfJob, [&](std::size_t i) {
            for (std::uint32_t e = BeginOf(i); e < ends_[i]; ++e) {
                weights_[i] += entries_[e].weight;
                diagonal_[i] += entries_[e].weight * factors[e];
            }
        });
    }
    /// Sum of terms: (A x)(s) for those of a sample s.
    template <typename Value> static Value Combined(std::span<const UnknownTerm> terms, const Value *x) {
        Value sum{};
        for (const UnknownTerm &term : terms)
            AddScaledValue(term.weight, x[term.unknown], sum);
        return sum;
    }
    std::uint32_t BeginOf(std::size_t unknown) const { return unknown > 0 ? ends_[unknown - 1] : 0; }
    /// to += A^T W y. ofSample(number, terms): y(s) for the sample with these.
    template <typename Value, typename OfSample>
    void AddColumns(const OfSample &ofSample, const Vector<Value> &to, const JobPool &jobs) const {
        std::size_t largest = 0;
        for (const Part &part : parts_)
            largest = std::max(largest, part.endSample - part.firstSample);
        const Vector<Value> ofPart = MakeVector<Value>(largest);
        std::vector<std::uint32_t> next(pull_.size()); // by unknown: its first entry that is not added yet
        ForAll(jobs, next.size(), kUnknownsOfJob, [&](std::size_t i) { next[i] = BeginOf(i); });
        for (const Part &part : parts_) {
            jobs.For(std::int64_t(part.endBlock - part.firstBlock), [&](std::int64_t b, int) {
                ForSamplesOf(part.firstBlock + std::size_t(b),
                             [&](std::size_t s, std::uint32_t number, float, std::span<const UnknownTerm> terms) {
                                 ofPart[s - part.firstSample] = ofSample(number, terms);
                             });
            });
            ForAll(jobs, next.size(), kUnknownsOfJob, [&](std::size_t i) {
                std::uint32_t e = next[i];
                for (; e < ends_[i] && entries_[e].sample < part.endSample; ++e)
                    AddScaledValue(entries_[e].weight, ofPart[entries_[e].sample - part.firstSample], to[i]);
                next[i] = e;
            });
        }
    }
    /// product = (A^T W A + R) x.
    template <typename Value>
    void Apply(const Vector<Value> &x, const Vector<Value> &product, const JobPool &jobs) const {
        ForAll(jobs, pull_.size(), kUnknownsOfJob, [&](std::size_t i) {
            product[i] = {};
            AddScaledValue(pull_[i], x[i], product[i]);
        });
        AddColumns([&](std::uint32_t, std::span<const UnknownTerm> terms) { return Combined(terms, x.get()); }, product,
                   jobs);
    }
    /// Sum of termOf(i) over the unknowns i, made in order.
    template <typename TermOf> double SumInOrder(const TermOf &termOf, const JobPool &jobs) const {
        std::vector<float> terms(pull_.size());
        ForAll(jobs, terms.size(), kUnknownsOfJob, [&](std::size_t i) { terms[i] = termOf(i); });
        double sum = 0;
        for (const float term : terms)
            sum += double(term);
        return sum;
    }
    /// M^-1 r, M the diagonal of A^T W A + R, for one unknown.
    template <typename Value> Value Preconditioned(std::size_t unknown, const Value &r) const {
        Value z{};
        if (const float diagonal = diagonal_[unknown] + pull_[unknown]; diagonal > 0)
            AddScaledValue(1 / diagonal, r, z);
        return z;
    }

    std::vector<SampleBlock> blocks_;
    std::vector<std::uint32_t> firstSamples_; ///< by block: number of its first sample
    std::vector<Part> parts_;                 ///< of all blocks
    std::vector<float> pull_;                 ///< by unknown
    std::vector<float> diagonal_;             ///< of A^T W A
    std::vector<float> weights_;              ///< WeightOf, by unknown
    // A^T W: for each unknown its entries, in the order of samples.
    std::vector<std::uint32_t> ends_; ///< by unknown: end of its entries
    std::unique_ptr<Entry[]> entries_;
};

} // namespace q3
