// GPL-2.0-or-later. Chooses the lights that the points of a grid name, and fits their shares and the rest of the light.
#include "q3map2/light/named/named_fit.h"

#include "q3map2/light/grid/gridsh_fit.h"
#include "q3map2/light/sparse/least_squares.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// A cell names a light if that lowers its mean squared displayed error by more than this. Bytes^2.
constexpr float kMinNameGain = 0.1f;
/// Maximum of lights with a style that a cell names, and of names of a corner. With 31 names each, the eight points of
/// a node have at most 248 names together; a byte counts them.
constexpr std::size_t kMostStyled = 16, kMostAtCorner = 31;
/// RMS error, over all normals, of the L2 projection of light from one direction, as a fraction of that light on a
/// surface that faces it. Negative values are shown as 0.
constexpr float kDirectionFloor = 0.0325f;
/// Mean over all normals of the squared clamped cosine: the mean squared light from one direction is this times the
/// square of that on a surface that faces it.
constexpr float kMeanSquareOfDirection = 1.0f / 6;
/// Pull of a share towards the one that was traced at its corner, as a fraction of the weight of a sample there.
constexpr float kSharePull = 0.5f;
/// Pull of a rest towards the one that was traced at its corner, and of a value that could not be traced there towards
/// the mean of the samples around it. As a fraction of the weight of these samples.
constexpr float kRestPull = 0.1f, kUnknownPull = 0.01f;
/// Steps of conjugate gradients.
constexpr int kShareSteps = 2, kRestSteps = 2;
/// Leaks are samples with at most the fraction kDark of the mean light of all samples that are shown with more than the
/// fraction kLit of it. A second fit gives them kLeakFactor times their weight.
constexpr float kDark = 0.01f, kLit = 0.03f;
constexpr float kLeakFactor = 10;
/// Leafs, corners or samples of one job.
constexpr std::size_t kFitChunk = 64;
/// A corner hangs on a larger leaf unless that changes its displayed light by more than this: RMS over all normals,
/// bytes.
constexpr float kMaxHangingError = 1;
/// Corners in solids are left out if the other corners of the leaf have at least this weight together at each sample.
constexpr float kLeastWeight = 0.02f;

/// Weight of a sample with that light in a fit.
float FitWeightOf(const SHFloats &light) {
    return FitWeight(1, std::max(0.0f, MeanLight(light)), FittedPoints::All);
}

void SortUnique(std::vector<std::uint32_t> &numbers) {
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// A light with its interpolated share, 0 to 1.
struct BlendedLight {
    std::uint32_t light;
    float share;
};

/// Carries out FitNamedCorners, which has its parameters. Call Fit once.
class NamedFit {
  public:
    NamedFit(const Octree &tree, const NamedCells &cells, CornerWeights &corners, std::size_t mostNames,
             const JobPool &jobs)
        : tree_(tree), cells_(cells), table_(cells.Table()), corners_(corners), mostNames_(mostNames), jobs_(jobs),
          leafs_(tree.OpenLeafs()) {}

    std::vector<NamedValue> Fit(std::map<std::uint32_t, std::size_t> &dropped) {
        SortSamples();
        NameLights(dropped);
        FitShares();
        FitRest();
        return Values();
    }

  private:
    /// A receiver inside a leaf or on its boundary, with the weights that the stored corners have there. These add up
    /// to 1.
    struct Sample {
        const NamedReceiver *receiver;
        float volume; ///< its part of the open volume of the leaf, in smallest cells
        std::uint32_t firstTerm = 0, termCount = 0;
    };
    void SortSamples();
    /// The lights that a cell names, in descending order of GainOf, and the stored corners that hold these names.
    struct CellNames {
        std::vector<std::uint32_t> lights, corners;
    };
    void NameLights(std::map<std::uint32_t, std::size_t> &dropped);
    std::vector<std::uint32_t> RankLights(std::size_t leaf) const;
    std::vector<std::uint32_t> StoredCornersOf(std::size_t leaf) const;
    void SetNames(std::span<const CellNames> cells);
    bool ThinOut(std::span<CellNames> cells) const;
    float GainOf(std::uint32_t light, const OctreeCell &cell, const CornerReceivers &corners,
                 std::span<const Sample> samples) const;
    void FitShares();
    void TakeOutNamedLights();
    void SolveRest(std::span<const float> factors);
    bool FindLeaks(std::span<float> factors) const;
    void FitRest();
    std::vector<NamedValue> Values() const;
    /// Calls use(i) for i from 0 to count - 1, on all workers.
    template <typename Use> void ForChunks(std::size_t count, const Use &use) const {
        jobs_.For(std::int64_t((count + kFitChunk - 1) / kFitChunk), [&](std::int64_t job, int) {
            const std::size_t first = std::size_t(job) * kFitChunk, end = std::min(count, first + kFitChunk);
            for (std::size_t i = first; i < end; ++i)
                use(i);
        });
    }
    std::span<const CornerTerm> TermsOf(const Sample &sample) const {
        return std::span(terms_).subspan(sample.firstTerm, sample.termCount);
    }
    std::span<const Sample> SamplesOf(std::size_t leaf) const {
        return std::span(samples_).subspan(firstSample_[leaf], firstSample_[leaf + 1] - firstSample_[leaf]);
    }
    /// Index in slots_ of the share of a light at a stored corner; SIZE_MAX if the corner does not name the light.
    std::size_t SlotOf(std::uint32_t stored, std::uint32_t light) const {
        const auto &names = names_[stored];
        const auto at = std::lower_bound(names.begin(), names.end(), light);
        return at != names.end() && *at == light ? firstSlot_[stored] + std::size_t(at - names.begin()) : SIZE_MAX;
    }
    /// The lights that the corners of a sample name, with the interpolated shares.
    void Blend(const Sample &sample, std::vector<BlendedLight> &lights) const;
    const NamedReceiver *CornerAt(std::size_t stored) const { return cells_.ReceiverAt(corners_.Stored()[stored]); }

    const Octree &tree_;
    const NamedCells &cells_;
    const LightTable &table_;
    CornerWeights &corners_;
    std::size_t mostNames_;
    const JobPool &jobs_;
    std::vector<std::size_t> leafs_;
    std::vector<Sample> samples_;          ///< those of a leaf together
    std::vector<std::size_t> firstSample_; ///< by index in leafs_, then the end
    std::vector<CornerTerm> terms_;
    std::vector<float> volumes_;                    ///< by stored corner: weighted mean of Sample::volume around it
    std::vector<std::vector<std::uint32_t>> names_; ///< by stored corner, sorted
    std::vector<std::size_t> firstSlot_;            ///< by stored corner: index of its first share in slots_
    std::vector<float> slots_;                      ///< shares of all stored corners, 0 to 1
    std::vector<SHFloats> rest_;                    ///< by stored corner
    std::vector<SHFloats> restOfSamples_;           ///< by sample: its light minus the interpolated named lights
};

void NamedFit::SortSamples() {
    std::vector<std::uint32_t> leafNumber(tree_.Size(), 0);
    for (std::size_t i = 0; i < leafs_.size(); ++i)
        leafNumber[leafs_[i]] = std::uint32_t(i + 1);
    std::vector<std::vector<const NamedReceiver *>> inLeaf(leafs_.size());
    const auto add = [&](const NamedReceiver &receiver) {
        const std::size_t leaf = tree_.LeafAt(CellAt(receiver.at));
        if (leaf != Octree::kNone && leafNumber[leaf] > 0)
            inLeaf[leafNumber[leaf] - 1].push_back(&receiver);
    };
    for (const NamedReceiver &sample : cells_.Samples())
        add(sample);
    for (std::uint32_t i = 0; i < cells_.Points().Size(); ++i) // traced points that are not stored are samples
        if (const NamedReceiver *point = cells_.ReceiverAt(i); point && !corners_.IsStored(i))
            add(*point);
    for (std::size_t i = 0; i < leafs_.size(); ++i) {
        firstSample_.push_back(samples_.size());
        for (const NamedReceiver *receiver : inLeaf[i]) {
            std::vector<CornerTerm> terms = corners_.TermsIn(tree_[leafs_[i]], receiver->at);
            float total = 0;
            for (const CornerTerm &term : terms)
                total += term.weight;
            for (CornerTerm &term : terms)
                term.weight /= total;
            if (terms.empty())
                continue;
            samples_.push_back({receiver, tree_[leafs_[i]].Volume() / float(inLeaf[i].size()),
                                std::uint32_t(terms_.size()), std::uint32_t(terms.size())});
            terms_.insert(terms_.end(), terms.begin(), terms.end());
        }
    }
    firstSample_.push_back(samples_.size());
    std::vector<float> weights(corners_.Stored().size());
    volumes_.assign(weights.size(), 0);
    for (const Sample &sample : samples_)
        for (const CornerTerm &term : TermsOf(sample))
            volumes_[term.stored] += term.weight * sample.volume, weights[term.stored] += term.weight;
    for (std::size_t i = 0; i < weights.size(); ++i)
        volumes_[i] = weights[i] > 0 ? volumes_[i] / weights[i] : 0;
}

/// By how much the squared displayed error, summed over the samples of a cell, falls if its corners name the light.
/// With E the irradiance vector that arrives at a sample, E0 the same without shadows, s the share, and a bar over what
/// is interpolated between the corners, the error of the light falls from |Ebar - E|^2 / 6 + kDirectionFloor^2 |E|^2 to
/// (sbar - s)^2 |E0|^2 / 6.
float NamedFit::GainOf(std::uint32_t light, const OctreeCell &cell, const CornerReceivers &corners,
                       std::span<const Sample> samples) const {
    std::array<std::optional<LightHere>, 8> at;
    for (std::size_t c = 0; c < 8; ++c)
        if (corners[c])
            at[c] = corners[c]->At(light, table_);
    float gain = 0;
    for (const Sample &sample : samples) {
        const std::optional<LightHere> here = sample.receiver->At(light, table_);
        if (!here)
            continue;
        Vec3f blend;
        float share = 0, shareWeight = 0, total = 0;
        for (std::size_t c = 0; c < 8; ++c) {
            if (!at[c])
                continue;
            const float weight = cell.Weight(c, sample.receiver->at);
            total += weight;
            blend = blend + at[c]->vector * (weight * at[c]->share);
            if (at[c]->Squared() >= kFaintest * kFaintest)
                share += weight * at[c]->share, shareWeight += weight;
        }
        const Vec3f seen = here->vector * here->share;
        if (table_.Style(light) != 0 && Dot(seen, seen) >= kFaintest * kFaintest)
            return std::numeric_limits<float>::infinity(); // the rest cannot hold it
        const float dim = ScreenFactor(sample.receiver->light) * 255;
        const Vec3f off = seen - (total > 0 ? blend / total : blend);
        const float wrong = shareWeight > 0 ? share / shareWeight - here->share : 0;
        gain += dim * dim *
                (kMeanSquareOfDirection * (Dot(off, off) - wrong * wrong * here->Squared()) +
                 kDirectionFloor * kDirectionFloor * Dot(seen, seen));
    }
    return gain;
}

/// The lights that are worth naming in a cell, in descending order of GainOf. leaf: index in leafs_.
std::vector<std::uint32_t> NamedFit::RankLights(std::size_t leaf) const {
    const OctreeCell &cell = tree_[leafs_[leaf]];
    const CornerReceivers corners = cells_.CornersOf(cell);
    const std::span<const Sample> samples = SamplesOf(leaf);
    std::vector<std::uint32_t> candidates;
    for (const NamedReceiver *corner : corners)
        for (std::size_t i = 0; corner && i < corner->lights.size(); ++i)
            candidates.push_back(corner->lights[i].light);
    for (const Sample &sample : samples)
        for (const LightHere &here : sample.receiver->lights)
            candidates.push_back(here.light);
    SortUnique(candidates);
    std::vector<std::pair<float, std::uint32_t>> gains;
    for (const std::uint32_t light : candidates)
        if (const float gain = GainOf(light, cell, corners, samples); gain > kMinNameGain * float(samples.size()))
            gains.push_back({-gain, light});
    std::ranges::sort(gains);
    std::vector<std::uint32_t> lights;
    for (const auto &[gain, light] : gains)
        lights.push_back(light);
    return lights;
}

/// The stored corners that readers interpolate between in a cell. leaf: index in leafs_.
std::vector<std::uint32_t> NamedFit::StoredCornersOf(std::size_t leaf) const {
    const OctreeCell &cell = tree_[leafs_[leaf]];
    std::vector<std::uint32_t> stored;
    for (std::size_t c = 0; c < 8; ++c)
        for (const CornerTerm &term : corners_.TermsIn(cell, cell.Corner(c)))
            stored.push_back(term.stored);
    SortUnique(stored);
    return stored;
}

/// Makes all corners of each cell name the lights of that cell.
void NamedFit::SetNames(std::span<const CellNames> cells) {
    names_.assign(corners_.Stored().size(), {});
    for (const CellNames &cell : cells)
        for (const std::uint32_t corner : cell.corners)
            names_[corner].insert(names_[corner].end(), cell.lights.begin(), cell.lights.end());
    for (std::vector<std::uint32_t> &names : names_)
        SortUnique(names);
}

/// Takes the light of the lowest gain from cells at a corner of more than kMostAtCorner names, or at a corner of a cell
/// with more names than readers evaluate at a place. False if there are none.
bool NamedFit::ThinOut(std::span<CellNames> cells) const {
    std::vector<bool> isCrowded(names_.size());
    for (std::size_t i = 0; i < names_.size(); ++i)
        isCrowded[i] = names_[i].size() > kMostAtCorner;
    std::vector<std::uint32_t> all;
    for (const CellNames &cell : cells) {
        all.clear();
        for (const std::uint32_t corner : cell.corners)
            all.insert(all.end(), names_[corner].begin(), names_[corner].end());
        SortUnique(all);
        for (std::size_t i = 0; i < cell.corners.size() && all.size() > SHGRID_NAMES_AT_PLACE; ++i)
            isCrowded[cell.corners[i]] = true;
    }
    bool found = false;
    for (CellNames &cell : cells)
        if (!cell.lights.empty() &&
            std::ranges::any_of(cell.corners, [&](std::uint32_t corner) { return isCrowded[corner]; })) {
            cell.lights.pop_back();
            found = true;
        }
    return found;
}

void NamedFit::NameLights(std::map<std::uint32_t, std::size_t> &dropped) {
    std::vector<CellNames> cells(leafs_.size());
    ForChunks(leafs_.size(), [&](std::size_t i) { cells[i] = {RankLights(i), StoredCornersOf(i)}; });
    const auto forStyled = [&](const auto &use) {
        for (const CellNames &cell : cells)
            for (const std::uint32_t light : cell.lights)
                if (table_.Style(light) != 0)
                    use(light);
    };
    dropped.clear();
    forStyled([&](std::uint32_t light) { ++dropped[light]; });
    for (CellNames &cell : cells) {
        std::size_t steady = 0, styled = 0;
        std::erase_if(cell.lights, [&](std::uint32_t light) {
            return table_.Style(light) != 0 ? styled++ >= kMostStyled : steady++ >= mostNames_;
        });
    }
    do
        SetNames(cells);
    while (ThinOut(cells));
    forStyled([&](std::uint32_t light) { --dropped[light]; });
    std::erase_if(dropped, [](const auto &one) { return one.second == 0; });
    std::size_t slots = 0;
    for (const std::vector<std::uint32_t> &names : names_) {
        firstSlot_.push_back(slots);
        slots += names.size();
    }
    slots_.assign(slots, 0);
}

void NamedFit::Blend(const Sample &sample, std::vector<BlendedLight> &lights) const {
    lights.clear();
    for (const CornerTerm &term : TermsOf(sample))
        for (std::size_t n = 0; n < names_[term.stored].size(); ++n) {
            const std::uint32_t light = names_[term.stored][n];
            const float share = term.weight * slots_[firstSlot_[term.stored] + n];
            const auto at = std::ranges::find(lights, light, &BlendedLight::light);
            if (at != lights.end())
                at->share += share;
            else
                lights.push_back({light, share});
        }
}

void NamedFit::FitShares() {
    std::vector<float> sum(slots_.size()), weightSum(slots_.size()); // weighted, of the samples around a slot's corner
    std::vector<std::optional<float>> pulls(slots_.size());          // none: the share is not known at the corner
    for (std::size_t i = 0; i < names_.size(); ++i)
        for (std::size_t n = 0; n < names_[i].size() && CornerAt(i); ++n) {
            const std::optional<LightHere> here = CornerAt(i)->At(names_[i][n], table_);
            if (!here || here->Squared() < kFaintest * kFaintest)
                continue;
            const std::size_t slot = firstSlot_[i] + n;
            slots_[slot] = here->share;
            pulls[slot] = kSharePull * here->Squared() * volumes_[i] * FitWeightOf(CornerAt(i)->light);
        }
    std::vector<SampleBlock> samples(1);
    std::vector<float> values; // by number of a sample
    std::vector<BlendedLight> lights;
    std::vector<UnknownTerm> terms;
    for (const Sample &sample : samples_) {
        Blend(sample, lights);
        const float weight = sample.volume * FitWeightOf(sample.receiver->light);
        for (const BlendedLight &one : lights) {
            const std::optional<LightHere> here = sample.receiver->At(one.light, table_);
            if (!here || here->Squared() < kFaintest * kFaintest)
                continue;
            terms.clear();
            float named = 0; // weight of the corners that name it: the others count as share 0
            for (const CornerTerm &term : TermsOf(sample))
                if (const std::size_t slot = SlotOf(term.stored, one.light); slot != SIZE_MAX) {
                    terms.push_back({std::uint32_t(slot), term.weight});
                    named += term.weight;
                    sum[slot] += term.weight * here->Squared() * here->share;
                    weightSum[slot] += term.weight * here->Squared();
                }
            samples.front().Add(std::uint32_t(values.size()), weight * here->Squared(), terms);
            values.push_back(here->share * named);
        }
    }
    LeastSquares system(slots_.size(), std::move(samples), jobs_);
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
        if (!pulls[slot])
            slots_[slot] = weightSum[slot] > 0 ? sum[slot] / weightSum[slot] : 0;
        system.SetPull(slot, pulls[slot] ? *pulls[slot] : kUnknownPull * system.WeightOf(slot));
    }
    system.Solve([&](std::uint32_t number) { return values[number]; }, slots_, kShareSteps);
    for (float &share : slots_) // the rest is fitted to shares as they are stored
        share = std::round(std::clamp(share, 0.0f, 1.0f) * 255) / 255;
}

/// Sets rest_ to the light at the corners minus their named lights, and restOfSamples_ to the light at the samples
/// minus the interpolated named lights. At a corner the traced share counts, not the fitted one: right beside a lamp,
/// the difference between the two would be a large and steep part of the rest.
void NamedFit::TakeOutNamedLights() {
    rest_.assign(names_.size(), SHFloats{});
    ForChunks(names_.size(), [&](std::size_t i) {
        if (!CornerAt(i))
            return;
        rest_[i] = CornerAt(i)->light;
        for (std::size_t n = 0; n < names_[i].size(); ++n) {
            const std::optional<LightHere> here = CornerAt(i)->At(names_[i][n], table_);
            const float share = here ? here->share : slots_[firstSlot_[i] + n];
            if (share > 0 && table_.Style(names_[i][n]) == 0)
                AddScaled(-share, table_.At(names_[i][n], CornerAt(i)->position), rest_[i]);
        }
    });
    restOfSamples_.resize(samples_.size());
    ForChunks(samples_.size(), [&](std::size_t i) {
        std::vector<BlendedLight> lights;
        Blend(samples_[i], lights);
        restOfSamples_[i] = samples_[i].receiver->light;
        for (const BlendedLight &one : lights)
            if (one.share > 0 && table_.Style(one.light) == 0)
                AddScaled(-one.share, table_.At(one.light, samples_[i].receiver->position), restOfSamples_[i]);
    });
}

/// Replaces rest_, the traced values, by the least-squares fit to the samples. factors: of the weights, by sample.
void NamedFit::SolveRest(std::span<const float> factors) {
    const std::size_t count = names_.size();
    std::vector<SampleBlock> samples(1);
    std::vector<SHFloats> sum(count); // weighted, of the samples around a corner; for corners in solids
    std::vector<UnknownTerm> terms;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        terms.clear();
        const float weight = factors[i] * samples_[i].volume * FitWeightOf(samples_[i].receiver->light);
        for (const CornerTerm &term : TermsOf(samples_[i])) {
            terms.push_back({term.stored, term.weight});
            AddScaled(weight * term.weight, restOfSamples_[i], sum[term.stored]);
        }
        samples.front().Add(std::uint32_t(i), weight, terms);
    }
    LeastSquares system(count, std::move(samples), jobs_);
    for (std::size_t i = 0; i < count; ++i) {
        const float weight = system.WeightOf(i);
        if (!CornerAt(i) && weight > 0)
            AddScaled(1 / weight, sum[i], rest_[i]);
        system.SetPull(i, (CornerAt(i) ? kRestPull : kUnknownPull) * weight);
    }
    system.Solve([&](std::uint32_t number) { return restOfSamples_[number]; }, rest_, kRestSteps);
}

/// Sets the factors of leaks (kLeakFactor). False if there are none.
bool NamedFit::FindLeaks(std::span<float> factors) const {
    double total = 0;
    for (const Sample &sample : samples_)
        total += double(std::clamp(MeanLight(sample.receiver->light), 0.0f, 1.0f));
    const float mean = samples_.empty() ? 0 : float(total / double(samples_.size()));
    bool found = false;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        if (MeanLight(samples_[i].receiver->light) > kDark * mean)
            continue;
        SHFloats shown = samples_[i].receiver->light;
        AddScaled(-1, restOfSamples_[i], shown);
        for (const CornerTerm &term : TermsOf(samples_[i]))
            AddScaled(term.weight, rest_[term.stored], shown);
        if (MeanLight(shown) > kLit * mean)
            factors[i] = kLeakFactor, found = true;
    }
    return found;
}

void NamedFit::FitRest() {
    TakeOutNamedLights();
    const std::vector<SHFloats> traced = rest_;
    std::vector<float> factors(samples_.size(), 1);
    SolveRest(factors);
    if (!FindLeaks(factors))
        return;
    rest_ = traced;
    SolveRest(factors);
}

std::vector<NamedValue> NamedFit::Values() const {
    std::vector<NamedValue> values(names_.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i].rest = rest_[i];
        for (std::size_t n = 0; n < names_[i].size(); ++n)
            if (const auto share = std::uint8_t(std::lround(slots_[firstSlot_[i] + n] * 255)); share > 0) {
                values[i].names.push_back(names_[i][n]);
                values[i].shares.push_back(share);
            }
    }
    return values;
}

} // namespace

std::vector<CornerWeights::Rule> RulesOfCorners(const Octree &tree, const NamedCells &cells, const JobPool &jobs) {
    using enum CornerWeights::Rule;
    std::vector<CornerWeights::Rule> rules(cells.Points().Size(), HangOrStore);
    jobs.For(std::int64_t((rules.size() + kFitChunk - 1) / kFitChunk), [&](std::int64_t job, int) {
        const std::size_t first = std::size_t(job) * kFitChunk, end = std::min(rules.size(), first + kFitChunk);
        for (std::size_t i = first; i < end; ++i) {
            const NamedReceiver *corner = cells.ReceiverAt(std::uint32_t(i));
            // A file has one point for an open leaf, at its lower corner. Other points on the leaf can only hang.
            const std::size_t owner = tree.LeafAt(cells.Points()[i].at);
            if (owner != Octree::kNone && tree[owner].openFraction > 0 && tree[owner].origin != cells.Points()[i].at)
                continue;
            if (!corner) {
                rules[i] = LeaveOut;
                continue;
            }
            const std::size_t leaf = LeafHungOn(tree, cells.Points()[i].at);
            if (leaf != Octree::kNone &&
                cells.SquaredErrorAt(tree[leaf], *corner) > kMaxHangingError * kMaxHangingError)
                rules[i] = Store;
        }
    });
    std::vector<bool> isThin(tree.Size());
    for (const NamedReceiver &sample : cells.Samples()) {
        const std::size_t leaf = tree.LeafAt(CellAt(sample.at));
        const CornerReceivers corners = cells.CornersOf(tree[leaf]);
        float weight = 0;
        for (std::size_t c = 0; c < 8; ++c)
            weight += corners[c] ? tree[leaf].Weight(c, sample.at) : 0;
        isThin[leaf] = isThin[leaf] || weight < kLeastWeight;
    }
    for (const std::size_t leaf : tree.OpenLeafs())
        for (std::size_t c = 0; c < 8 && isThin[leaf]; ++c)
            if (CornerWeights::Rule &rule = rules[cells.Points().Find(tree[leaf].Corner(c))]; rule == LeaveOut)
                rule = HangOrStore;
    return rules;
}

std::vector<NamedValue> FitNamedCorners(const Octree &tree, const NamedCells &cells, CornerWeights &corners,
                                        std::size_t mostNames, const JobPool &jobs,
                                        std::map<std::uint32_t, std::size_t> &dropped) {
    return NamedFit(tree, cells, corners, mostNames, jobs).Fit(dropped);
}

} // namespace q3
