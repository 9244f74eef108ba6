// GPL-2.0-or-later. Which lights the points of a grid name, their shares, and the rest of the light.
#include "q3map2/light/named/named_fit.h"

#include "q3map2/light/grid/gridsh_fit.h"
#include "q3map2/light/sparse/least_squares.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// A light is named where that lowers the mean squared displayed error in the cell by more than this. Bytes^2.
constexpr float kMinNameGain = 0.1f;
/// Lights with a style that a cell names at most, and names of a corner: the eight points of a node then have at most
/// 248 together.
constexpr std::size_t kMostStyled = 16, kMostAtCorner = 31;
/// RMS error, over all normals, of the L2 projection of light from one direction, as a fraction of it.
constexpr float kDirectionFloor = 0.0325f;
/// Mean squared light, over all normals, of light from one direction, as a fraction of its square.
constexpr float kMeanSquareOfDirection = 1.0f / 6;
/// Pull of a corner towards its own share, in terms of the weight that its light would have as a sample.
constexpr float kSharePull = 0.5f;
/// Pull of a corner towards its own rest, and of values that are not known, as a fraction of the weight of the samples.
constexpr float kRestPull = 0.1f, kUnknownPull = 0.01f;
constexpr int kShareSteps = 4, kRestSteps = 4;
/// Samples that are dark, and shown with more than this light, count kLeakFactor times as much in a second fit. As a
/// fraction of the mean light of all samples: dark below kDark of it, lit above kLit.
constexpr float kDark = 0.01f, kLit = 0.03f;
constexpr float kLeakFactor = 10;
constexpr std::size_t kFitChunk = 64;
/// Corners hang on larger leafs unless that changes displayed light there by more than this. RMS, bytes.
constexpr float kMaxHangingError = 1;
/// Corners in solids are left out where the others have at least this weight together at all samples.
constexpr float kLeastWeight = 0.02f;

float FitWeightOf(const SHFloats &light) {
    return FitWeight(1, std::max(0.0f, MeanLight(light)), FittedPoints::All);
}

/// A light with the blend of its shares.
struct BlendedLight {
    std::uint32_t light;
    float share;
};

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
    /// A receiver inside a leaf or on its boundary, with the combination of stored corners that readers blend there.
    struct Sample {
        const NamedReceiver *receiver;
        float volume; ///< open volume that it stands for
        std::uint32_t firstTerm = 0, termCount = 0;
    };
    void SortSamples();
    /// How many lights a cell names.
    struct MostNames {
        std::size_t steady, styled;
    };
    void NameLights(std::map<std::uint32_t, std::size_t> &dropped);
    std::vector<std::uint32_t> RankLights(std::size_t leaf) const;
    void SetNames(std::span<const std::vector<std::uint32_t>> ranked, const MostNames &most);
    bool AreNamesReadable() const;
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
    /// Index in slots_; SIZE_MAX: the corner does not name the light.
    std::size_t SlotOf(std::uint32_t stored, std::uint32_t light) const {
        const auto &names = names_[stored];
        const auto at = std::lower_bound(names.begin(), names.end(), light);
        return at != names.end() && *at == light ? firstSlot_[stored] + std::size_t(at - names.begin()) : SIZE_MAX;
    }
    /// The lights that the corners of a sample name.
    void Blend(const Sample &sample, std::vector<BlendedLight> &lights) const;
    const NamedReceiver *CornerAt(std::size_t stored) const { return cells_.ReceiverAt(corners_.Stored()[stored]); }

    const Octree &tree_;
    const NamedCells &cells_;
    const LightTable &table_;
    CornerWeights &corners_;
    std::size_t mostNames_;
    const JobPool &jobs_;
    std::vector<std::size_t> leafs_;
    std::vector<Sample> samples_;          ///< by leaf
    std::vector<std::size_t> firstSample_; ///< by leaf, and the end
    std::vector<CornerTerm> terms_;
    std::vector<float> volumes_;                    ///< by stored corner: mean of Sample::volume around it
    std::vector<std::vector<std::uint32_t>> names_; ///< by stored corner, sorted
    std::vector<std::size_t> firstSlot_;            ///< by stored corner: of its first share
    std::vector<float> slots_;                      ///< shares
    std::vector<SHFloats> rest_;                    ///< by stored corner
    std::vector<SHFloats> restOfSamples_;           ///< what named lights leave at the samples
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
    for (std::uint32_t i = 0; i < cells_.Points().Size(); ++i) // those that pruning has made no corners
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

/// How much less the squared displayed error is, summed over the samples of a cell, if its corners name the light.
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
            return std::numeric_limits<float>::infinity(); // nothing else stores it
        const float dim = ScreenFactor(sample.receiver->light) * 255;
        const Vec3f off = seen - (total > 0 ? blend / total : blend);
        const float wrong = shareWeight > 0 ? share / shareWeight - here->share : 0;
        gain += dim * dim *
                (kMeanSquareOfDirection * (Dot(off, off) - wrong * wrong * here->Squared()) +
                 kDirectionFloor * kDirectionFloor * Dot(seen, seen));
    }
    return gain;
}

/// The lights worth naming in a cell, the best first.
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
    std::ranges::sort(candidates);
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
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

/// Gives the corners of each cell the names of its best lights.
void NamedFit::SetNames(std::span<const std::vector<std::uint32_t>> ranked, const MostNames &most) {
    names_.assign(corners_.Stored().size(), {});
    for (std::size_t i = 0; i < leafs_.size(); ++i) {
        std::vector<std::uint32_t> names;
        std::size_t steady = 0, styled = 0;
        for (const std::uint32_t light : ranked[i])
            if (table_.Style(light) != 0 ? styled++ < most.styled : steady++ < most.steady)
                names.push_back(light);
        for (std::size_t c = 0; c < 8 && !names.empty(); ++c)
            for (const CornerTerm &term : corners_.TermsIn(tree_[leafs_[i]], tree_[leafs_[i]].Corner(c)))
                names_[term.stored].insert(names_[term.stored].end(), names.begin(), names.end());
    }
    for (std::vector<std::uint32_t> &names : names_) {
        std::ranges::sort(names);
        names.erase(std::unique(names.begin(), names.end()), names.end());
    }
}

/// Whether readers find all names at each place, and a node has at most 255.
bool NamedFit::AreNamesReadable() const {
    for (const std::vector<std::uint32_t> &names : names_)
        if (names.size() > kMostAtCorner)
            return false;
    std::vector<std::uint32_t> all;
    for (const std::size_t leaf : leafs_) {
        all.clear();
        for (std::size_t c = 0; c < 8; ++c)
            for (const CornerTerm &term : corners_.TermsIn(tree_[leaf], tree_[leaf].Corner(c)))
                all.insert(all.end(), names_[term.stored].begin(), names_[term.stored].end());
        std::ranges::sort(all);
        if (std::unique(all.begin(), all.end()) - all.begin() > SHGRID_NAMES_AT_PLACE)
            return false;
    }
    return true;
}

void NamedFit::NameLights(std::map<std::uint32_t, std::size_t> &dropped) {
    std::vector<std::vector<std::uint32_t>> ranked(leafs_.size());
    ForChunks(leafs_.size(), [&](std::size_t i) { ranked[i] = RankLights(i); });
    MostNames most{mostNames_, kMostStyled};
    for (SetNames(ranked, most); !AreNamesReadable() && most.styled > 0; SetNames(ranked, most))
        most.steady > 0 ? --most.steady : most.styled /= 2;
    dropped.clear();
    for (const std::vector<std::uint32_t> &lights : ranked) {
        std::size_t styled = 0;
        for (const std::uint32_t light : lights)
            if (table_.Style(light) != 0 && styled++ >= most.styled)
                ++dropped[light];
    }
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
    LeastSquares<float> system(slots_.size());
    std::vector<float> sum(slots_.size()), weightSum(slots_.size()); // of the samples around a corner
    std::vector<bool> known(slots_.size());
    for (std::size_t i = 0; i < names_.size(); ++i)
        for (std::size_t n = 0; n < names_[i].size() && CornerAt(i); ++n) {
            const std::optional<LightHere> here = CornerAt(i)->At(names_[i][n], table_);
            if (!here || here->Squared() < kFaintest * kFaintest)
                continue;
            const std::size_t slot = firstSlot_[i] + n;
            known[slot] = true;
            slots_[slot] = here->share;
            system.SetPull(slot, kSharePull * here->Squared() * volumes_[i] * FitWeightOf(CornerAt(i)->light));
        }
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
            float named = 0; // weight of the corners that name it
            for (const CornerTerm &term : TermsOf(sample))
                if (const std::size_t slot = SlotOf(term.stored, one.light); slot != SIZE_MAX) {
                    terms.push_back({std::uint32_t(slot), term.weight});
                    named += term.weight;
                    sum[slot] += term.weight * here->Squared() * here->share;
                    weightSum[slot] += term.weight * here->Squared();
                }
            system.AddSample(here->share * named, weight * here->Squared(), terms);
        }
    }
    for (std::size_t slot = 0; slot < slots_.size(); ++slot)
        if (!known[slot]) {
            slots_[slot] = weightSum[slot] > 0 ? sum[slot] / weightSum[slot] : 0;
            system.SetPull(slot, kUnknownPull * system.WeightOf(slot));
        }
    system.Solve(slots_, kShareSteps);
    for (float &share : slots_) // as they are stored
        share = std::round(std::clamp(share, 0.0f, 1.0f) * 255) / 255;
}

/// Sets rest_ to what the corners' own shares leave of their light, and restOfSamples_ likewise from blended shares.
void NamedFit::TakeOutNamedLights() {
    rest_.assign(names_.size(), SHFloats{});
    ForChunks(names_.size(), [&](std::size_t i) {
        if (!CornerAt(i))
            return;
        rest_[i] = CornerAt(i)->light;
        for (std::size_t n = 0; n < names_[i].size(); ++n)
            if (const float share = slots_[firstSlot_[i] + n]; share > 0 && table_.Style(names_[i][n]) == 0)
                AddScaled(-share, table_.At(names_[i][n], CornerAt(i)->position), rest_[i]);
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

/// Moves rest_ to the least-squares fit to the samples, from what was traced. factors: of their weights.
void NamedFit::SolveRest(std::span<const float> factors) {
    const std::size_t count = names_.size();
    LeastSquares<SHFloats> system(count);
    std::vector<SHFloats> sum(count); // weighted, of the samples around a corner
    std::vector<UnknownTerm> terms;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        terms.clear();
        const float weight = factors[i] * samples_[i].volume * FitWeightOf(samples_[i].receiver->light);
        for (const CornerTerm &term : TermsOf(samples_[i])) {
            terms.push_back({term.stored, term.weight});
            AddScaled(weight * term.weight, restOfSamples_[i], sum[term.stored]);
        }
        system.AddSample(restOfSamples_[i], weight, terms);
    }
    for (std::size_t i = 0; i < count; ++i) {
        const float weight = system.WeightOf(i);
        if (!CornerAt(i) && weight > 0)
            AddScaled(1 / weight, sum[i], rest_[i]);
        system.SetPull(i, (CornerAt(i) ? kRestPull : kUnknownPull) * weight);
    }
    system.Solve(rest_, kRestSteps);
}

/// Sets the factors of samples that are dark, but shown with light. False: there are none.
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
            // A leaf with open space owns its lower corner alone: nothing can be said of other points in it.
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
