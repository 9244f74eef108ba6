// GPL-2.0-or-later. Ambient cubes of the leafs of a map: at positions in a leaf, and the choice of those to keep.
#include "q3map2/light/cubes/ambient_cubes.h"

#include "common/error.h"
#include "libs/math/elementary.h"
#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/light/cubes/cube_light.h"
#include "q3map2/light/cubes/leaf_positions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

namespace q3 {

// ---- The choice of the cubes of a leaf to keep ----

namespace {

constexpr float kScreenGamma = 2.2f; ///< of ScreenDifference

/// The 18 values of a sample: 6 sides times RGB.
using CubeNumbers = std::array<float, 18>;

CubeNumbers NumbersOf(const CubeSides &sides) {
    CubeNumbers numbers;
    for (std::size_t side = 0; side < sides.size(); ++side)
        for (std::size_t channel = 0; channel < 3; ++channel)
            numbers[3 * side + channel] = sides[side][channel];
    return numbers;
}

/// Approximation of displayed light: gamma 2, clamped to 1.
float Shown(float light) {
    return std::sqrt(std::min(light, 1.0f));
}

/// Weight of a sample at one of the points in the blend at the other, see BlendCubes.
float BlendWeight(const Vec3f &a, const Vec3f &b) {
    const Vec3f offset = a - b;
    return 1 / (Dot(offset, offset) + 1);
}

/// Error of the blend of a growing set of chosen samples at the positions of all samples.
class CubeChoice {
  public:
    explicit CubeChoice(const std::vector<CubeSample> &samples)
        : samples_(samples), sums_(samples.size()), weights_(samples.size()) {
        for (const CubeSample &sample : samples) {
            light_.push_back(NumbersOf(sample.sides));
            CubeNumbers &shown = shown_.emplace_back();
            std::transform(light_.back().begin(), light_.back().end(), shown.begin(), Shown);
        }
    }
    /// Sum of squared differences of shown light if sample k were also chosen; stops summing above `limit`.
    double ErrorWith(std::size_t k, double limit) const {
        double sum = 0;
        for (std::size_t j = 0; j < samples_.size() && sum < limit; ++j) {
            const float weight = BlendWeight(samples_[j].position, samples_[k].position);
            const float scale = 1 / (weights_[j] + weight);
            float squares = 0;
            for (std::size_t i = 0; i < light_[j].size(); ++i) {
                const float difference = Shown((sums_[j][i] + weight * light_[k][i]) * scale) - shown_[j][i];
                squares += difference * difference;
            }
            sum += double(squares);
        }
        return sum;
    }
    void Choose(std::size_t k) {
        for (std::size_t j = 0; j < samples_.size(); ++j) {
            const float weight = BlendWeight(samples_[j].position, samples_[k].position);
            weights_[j] += weight;
            for (std::size_t i = 0; i < light_[j].size(); ++i)
                sums_[j][i] += weight * light_[k][i];
        }
    }

  private:
    const std::vector<CubeSample> &samples_;
    std::vector<CubeNumbers> light_, shown_; ///< by sample: its light; that light as Shown
    std::vector<CubeNumbers> sums_;          ///< by sample: weighted sum of the chosen ones at its position
    std::vector<float> weights_;             ///< by sample: sum of these weights
};

/// Removes the samples that `kept` does not mark.
void Keep(const std::vector<bool> &kept, std::vector<CubeSample> &samples) {
    std::vector<CubeSample> result;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (kept[i])
            result.push_back(samples[i]);
    samples = std::move(result);
}

/// The largest ScreenDifference between a sample not in `kept` and the blend of the kept ones at its position.
float LargestError(const std::vector<CubeSample> &samples, const std::vector<bool> &kept) {
    std::vector<CubeSample> blended;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (kept[i])
            blended.push_back(samples[i]);
    float largest = 0;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (!kept[i])
            largest = std::max(largest, ScreenDifference(BlendCubes(blended, samples[i].position), samples[i].sides));
    return largest;
}

} // namespace

CubeSample MakeCubeSample(const bspLeaf_t &leaf, const std::array<std::uint8_t, 3> &position, const CubeSides &sides) {
    CubeSample sample;
    sample.stored.position = position;
    sample.position = CubePosition(leaf, sample.stored);
    for (std::size_t side = 0; side < sides.size(); ++side) {
        sample.stored.sides[side] = EncodeRgbExp32(sides[side]);
        sample.sides[side] = DecodeRgbExp32(sample.stored.sides[side]);
    }
    return sample;
}

CubeSides BlendCubes(std::span<const CubeSample> samples, const Vec3f &position) {
    CubeSides sum{};
    float weights = 0;
    for (const CubeSample &sample : samples) {
        const float weight = BlendWeight(sample.position, position);
        weights += weight;
        for (std::size_t side = 0; side < sum.size(); ++side)
            sum[side] += sample.sides[side] * weight;
    }
    for (Vec3f &side : sum)
        side = side / weights;
    return sum;
}

float ScreenDifference(const CubeSides &a, const CubeSides &b) {
    const auto shown = [](float light) { return 255 * Pow(std::max(light, 0.0f), 1 / kScreenGamma); };
    float largest = 0;
    for (std::size_t side = 0; side < a.size(); ++side)
        for (std::size_t channel = 0; channel < 3; ++channel)
            largest = std::max(largest, std::abs(shown(a[side][channel]) - shown(b[side][channel])));
    return largest;
}

void KeepBestCubes(std::size_t maxCount, std::vector<CubeSample> &samples) {
    if (samples.size() <= maxCount)
        return;
    CubeChoice choice(samples);
    std::vector<bool> chosen(samples.size());
    double error = std::numeric_limits<double>::infinity();
    for (std::size_t step = 0; step < maxCount; ++step) {
        std::size_t best = samples.size();
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (!chosen[k])
                if (const double with = choice.ErrorWith(k, error); with < error)
                    best = k, error = with;
        if (best == samples.size())
            break;
        choice.Choose(best);
        chosen[best] = true;
    }
    Keep(chosen, samples);
}

void ThinOutCubes(float tolerance, std::vector<CubeSample> &samples) {
    std::vector<bool> kept(samples.size(), true);
    for (std::size_t left = samples.size(); left > 1; --left) {
        std::size_t best = samples.size();
        float bestError = tolerance;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (!kept[i])
                continue;
            kept[i] = false;
            if (const float error = LargestError(samples, kept);
                error < bestError || (best == samples.size() && error <= tolerance))
                best = i, bestError = error;
            kept[i] = true;
        }
        if (best == samples.size())
            break;
        kept[best] = false;
    }
    Keep(kept, samples);
}

// ---- The cubes of all leafs of a map ----

namespace {

/// Leafs of one cluster are lit in groups of about this many places.
constexpr std::size_t kPlacesTogether = 256;
/// The tolerance is multiplied by kToleranceStep while there are too many samples. Beyond kLastTolerance it becomes
/// infinite, which leaves one sample in each leaf.
constexpr float kToleranceStep = 1.5f, kLastTolerance = 1e30f;

/// Leafs of one cluster that are lit together.
using LeafGroup = std::vector<std::size_t>;

std::vector<LeafGroup> GroupLeafs(const Bsp &bsp, const std::vector<std::vector<CubePlace>> &places) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < places.size(); ++i)
        if (!places[i].empty())
            order.push_back(i);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return bsp.leafs[a].cluster < bsp.leafs[b].cluster; });
    std::vector<LeafGroup> groups;
    std::size_t count = kPlacesTogether; // places of the last group; full, so that the first leaf begins one
    for (const std::size_t leaf : order) {
        if (count >= kPlacesTogether || bsp.leafs[groups.back().back()].cluster != bsp.leafs[leaf].cluster) {
            groups.emplace_back();
            count = 0;
        }
        groups.back().push_back(leaf);
        count += places[leaf].size();
    }
    return groups;
}

/// Lights the places of groups of leafs.
class LeafSampler {
  public:
    LeafSampler(const GridInputs &in, const std::vector<Light> &lights, const LightGridSH *grid, LeafCubes &cubes)
        : in_(in), bsp_(in.space.Map()), integrator_(in, lights), cubes_(cubes), places_(bsp_.leafs.size()) {
        if (grid)
            gridCubes_ = std::make_unique<CubesFromGridSH>(*grid, in.options.shRadiance);
    }

    void Run(GridStats &stats) {
        const LeafPolytopes polytopes(bsp_);
        in_.jobs.For(std::int64_t(bsp_.leafs.size()), [&](std::int64_t leaf, int) {
            if (bsp_.leafs[std::size_t(leaf)].cluster >= 0)
                places_[std::size_t(leaf)] = FindCubePlaces(in_.space, polytopes, std::size_t(leaf));
        });
        const std::vector<LeafGroup> groups = GroupLeafs(bsp_, places_);
        RunBricks(in_, std::int64_t(groups.size()), stats, [&](std::int64_t group, GridStats &work) {
            LightGroup(groups[std::size_t(group)], std::uint64_t(group), work);
        });
        for (const std::vector<CubePlace> &places : places_)
            stats.points += std::int64_t(places.size()), stats.open += places.empty() ? 0 : 1;
    }

  private:
    void LightGroup(const LeafGroup &group, std::uint64_t seed, GridStats &work) const {
        const std::vector<CubeSides> sides = gridCubes_ ? FromGrid(group) : Traced(group, seed, work);
        auto next = sides.begin();
        for (const std::size_t leaf : group) {
            for (const CubePlace &place : places_[leaf])
                cubes_[leaf].push_back(MakeCubeSample(bsp_.leafs[leaf], place.stored, *next++));
            KeepBestCubes(std::size_t(in_.options.cubesPerLeaf), cubes_[leaf]);
        }
    }

    std::vector<CubeSides> FromGrid(const LeafGroup &group) const {
        std::vector<CubeSides> sides;
        for (const std::size_t leaf : group)
            for (const CubePlace &place : places_[leaf])
                sides.push_back(gridCubes_->At(place.position));
        return sides;
    }

    std::vector<CubeSides> Traced(const LeafGroup &group, std::uint64_t seed, GridStats &work) const {
        std::vector<ReceiverBatch> blocks;
        for (const std::size_t leaf : group)
            for (std::uint32_t i = 0; i < places_[leaf].size(); ++i) {
                const Vec3f &p = places_[leaf][i].position;
                BatchWithRoom(blocks).Add(p, p, bsp_.leafs[leaf].cluster, std::uint32_t(leaf) * kMaxCubePlaces + i);
            }
        return integrator_.Sides(blocks, seed, work);
    }

    const GridInputs &in_;
    const Bsp &bsp_;
    CubeIntegrator integrator_;
    std::unique_ptr<const CubesFromGridSH> gridCubes_;
    LeafCubes &cubes_;
    std::vector<std::vector<CubePlace>> places_; // by leaf
};

std::size_t CountSamples(const LeafCubes &leafs) {
    return std::accumulate(leafs.begin(), leafs.end(), std::size_t(0),
                           [](std::size_t sum, const auto &samples) { return sum + samples.size(); });
}

LeafCubes ThinnedOut(const LeafCubes &leafs, float tolerance, const JobPool &jobs) {
    LeafCubes thin = leafs;
    jobs.For(std::int64_t(thin.size()),
             [&](std::int64_t leaf, int) { ThinOutCubes(tolerance, thin[std::size_t(leaf)]); });
    return thin;
}

/// Throws if even one sample for each leaf with samples is too many.
void CheckLeafCount(const LeafCubes &leafs, std::size_t maxSamples) {
    std::size_t count = 0;
    for (std::size_t leaf = 0; leaf < leafs.size(); ++leaf)
        if (!leafs[leaf].empty() && ++count > maxSamples)
            throw Error("-ambientcubes: leaf {} is the {}th with light, but the format holds {} samples: make detail "
                        "brushes of structural ones, or bake -sh instead",
                        leaf, count, maxSamples);
}

/// Thins out the samples, by a higher tolerance if more than maxSamples are left.
LeafCubes ThinToFit(const LeafCubes &leafs, float tolerance, const JobPool &jobs, Log &log, std::size_t maxSamples) {
    LeafCubes thin = ThinnedOut(leafs, tolerance, jobs);
    const std::size_t asked = CountSamples(thin);
    if (asked <= maxSamples)
        return thin;
    CheckLeafCount(leafs, maxSamples);
    float raised = std::max(tolerance, 1.0f); // a tolerance of 0 would not grow
    while (CountSamples(thin) > maxSamples) {
        raised = raised > kLastTolerance ? std::numeric_limits<float>::infinity() : raised * kToleranceStep;
        thin = ThinnedOut(leafs, raised, jobs);
    }
    log.Warn("ambient cubes",
             "{} ambient cubes within a tolerance of {:g}, but the format holds {}: a tolerance of {:g} leaves {}",
             asked, tolerance, maxSamples, raised, CountSamples(thin));
    return thin;
}

/// Squared distance between the bounds of two leafs.
double SquaredLeafDistance(const bspLeaf_t &a, const bspLeaf_t &b) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double gap =
            std::max({0.0, double(a.mins[axis]) - double(b.maxs[axis]), double(b.mins[axis]) - double(a.maxs[axis])});
        sum += gap * gap;
    }
    return sum;
}

/// The leaf whose samples `leaf`, which has none, refers to. lit: the leafs to choose from, at least one.
std::uint16_t NearestLit(const BspSpace &space, std::size_t leaf, const std::vector<std::size_t> &lit) {
    const bspLeaf_t &here = space.Map().leafs[leaf];
    std::size_t best = lit.front();
    bool bestSeen = false;
    double bestDistance = std::numeric_limits<double>::infinity();
    for (const std::size_t other : lit) {
        const bspLeaf_t &there = space.Map().leafs[other];
        const bool seen = space.Visible(here.cluster, there.cluster);
        if (seen < bestSeen)
            continue;
        const double distance = SquaredLeafDistance(here, there);
        if (seen > bestSeen || distance < bestDistance)
            best = other, bestSeen = seen, bestDistance = distance;
    }
    return std::uint16_t(best);
}

} // namespace

LeafCubes SampleLeafs(const GridInputs &in, const std::vector<Light> &lights, const LightGridSH *grid,
                      GridStats &stats) {
    LeafCubes cubes(in.space.Map().leafs.size());
    LeafSampler(in, lights, grid, cubes).Run(stats);
    return cubes;
}

std::optional<AmbientCubes> StoreCubes(const BspSpace &space, const LeafCubes &leafs, float tolerance,
                                       const JobPool &jobs, Log &log, std::size_t maxSamples) {
    const LeafCubes thin = ThinToFit(leafs, tolerance, jobs, log, maxSamples);
    AmbientCubes cubes;
    cubes.leafs.resize(thin.size());
    std::vector<std::size_t> lit;
    for (std::size_t leaf = 0; leaf < thin.size(); ++leaf) {
        if (thin[leaf].empty())
            continue;
        if (leaf <= UINT16_MAX) // leafs without samples refer to one by 16 bits
            lit.push_back(leaf);
        cubes.leafs[leaf] = {std::uint16_t(thin[leaf].size()), std::uint16_t(cubes.samples.size())};
        for (const CubeSample &sample : thin[leaf])
            cubes.samples.push_back(sample.stored);
    }
    if (lit.empty()) {
        log.Warn("ambient cubes", "no leaf of a cluster has an open place: no ambient cubes are stored");
        return std::nullopt;
    }
    jobs.For(std::int64_t(thin.size()), [&](std::int64_t leaf, int) {
        if (thin[std::size_t(leaf)].empty())
            cubes.leafs[std::size_t(leaf)].first = NearestLit(space, std::size_t(leaf), lit);
    });
    return cubes;
}

} // namespace q3
