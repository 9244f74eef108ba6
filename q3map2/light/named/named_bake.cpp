// GPL-2.0-or-later. Bakes the SH light grid that names lights.
#include "q3map2/light/named/named_bake.h"

#include "libs/math/sampling.h"
#include "q3map2/light/grid/gridsh_fit.h"
#include "q3map2/light/named/light_table.h"
#include "q3map2/light/named/visible_shares.h"
#include "q3map2/light/sparse/corner_fit.h"
#include "q3map2/light/sparse/display_error.h"
#include "q3map2/light/sparse/least_squares.h"
#include "q3map2/light/sparse/octree_refine.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Samples in each cell, and candidates drawn at most for each.
int kSamplesPerCell = getenv("NSAMP") ? atoi(getenv("NSAMP")) : 4;
constexpr int kMaxTries = 4;
/// Cells whose samples are traced together.
constexpr std::size_t kCellsPerBrick = 64;
/// A light is named where that lowers the mean squared displayed error in the cell by more than this. Bytes^2.
float kMinGain = getenv("NGAIN") ? float(atof(getenv("NGAIN"))) : 0.1f;
/// RMS error, over all normals, of the L2 projection of light from one direction, as a fraction of it.
constexpr float kDirectionFloor = 0.0325f;
/// Lights that give less than this, 1 = byte 255, are not considered.
constexpr float kFaintest = 0.5f / 255;
/// Pull of a corner towards its own share, as a fraction of the weight that its light would have as a sample.
float kSharePull = getenv("NSPULL") ? float(atof(getenv("NSPULL"))) : 0.5f;
/// Pull of a corner towards its own rest, and of one whose light is not known, as a fraction of the weights of samples.
float kRestPull = getenv("NRPULL") ? float(atof(getenv("NRPULL"))) : 0.1f, kUnknownPull = 0.01f;
constexpr int kShareSteps = 12, kRestSteps = 10;

/// A light at a receiver: its irradiance vector without shadows, of the brightest channel, and what is seen of it.
struct LightHere {
    std::uint32_t light = 0;
    float share = 0;
    bool known = false; ///< `share` is set
    Vec3f vector;
};

/// The irradiance vector of the brightest channel: band 1 of convolved light is kSHC1 2 pi / 3 times it.
Vec3f VectorOf(const SHFloats &light) {
    constexpr float kBand1 = float(kSHC1 * 2 * std::numbers::pi / 3);
    Vec3f brightest;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const Vec3f v = Vec3f{light[9 + channel], light[3 + channel], light[6 + channel]} / kBand1;
        if (Dot(v, v) > Dot(brightest, brightest))
            brightest = v;
    }
    return brightest;
}

/// A position inside a cell.
struct CellSample {
    Vec3f at; ///< in smallest cells
    Vec3f position;
    int cluster = 0;
    SHFloats light{};
    std::vector<LightShare> shares;
};

class NamedGridBuilder {
  public:
    NamedGridBuilder(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                     const LightTable &table)
        : in_(in), lights_(lights), table_(table), lattice_(SparseLattice::OfUniformCells({layout.mins, layout.size, layout.bounds, 0})),
          points_(lattice_), tree_(lattice_), layout_(layout) {}

    NamedGridSH Bake(GridStats &work, NamedStats &result);

  private:
    void TraceCorners(GridSHTracer &tracer, GridStats &work);
    void TraceSamples(const LightAtPositions &light, GridStats &work);
    std::vector<CellSample> DrawSamples(const OctreeCell &leaf, std::size_t number) const;
    LightHere LightAt(std::uint32_t light, const Vec3f &position, int cluster, std::span<const LightShare> shares) const;
    std::vector<std::uint32_t> ChooseNames(std::size_t leaf) const;
    void NameLights();
    void FitShares();
    void FitRest();
    NamedGridSH Pack(NamedStats &result) const;
    std::vector<CornerTerm> TermsAt(std::size_t leaf, const Vec3f &at) { return corners_->TermsIn(tree_[leaves_[leaf]], at); }
    std::size_t SlotOf(std::uint32_t stored, std::uint32_t light) const {
        const auto &names = names_[stored];
        const auto at = std::lower_bound(names.begin(), names.end(), light);
        return at != names.end() && *at == light ? firstSlot_[stored] + std::size_t(at - names.begin()) : SIZE_MAX;
    }

    const GridInputs &in_;
    const std::vector<Light> &lights_;
    const LightTable &table_;
    SparseLattice lattice_;
    LatticePoints points_;
    Octree tree_;
    const GridLayout &layout_;
    std::vector<std::vector<LightShare>> shares_; ///< by lattice point
    std::vector<std::vector<LightHere>> here_;    ///< by lattice point: of shares_
    std::vector<int> clusters_;                   ///< by lattice point
    std::vector<std::size_t> leaves_;             ///< with open space
    std::vector<std::vector<CellSample>> samples_; ///< by leaf in leaves_
    std::optional<CornerWeights> corners_;
    std::vector<std::vector<std::uint32_t>> names_; ///< by stored corner, sorted
    std::vector<std::size_t> firstSlot_;            ///< by stored corner: of its first share
    std::vector<float> slots_;                      ///< shares
    std::vector<SHFloats> rest_;                    ///< by stored corner
};

void NamedGridBuilder::TraceCorners(GridSHTracer &tracer, GridStats &work) {
    GridShares observer(table_, std::size_t(layout_.Count()));
    const LightGridSH grid = tracer.TracePointsOnly(work, observer);
    OctreeRefiner refiner(in_.space, in_.jobs, lattice_, tree_, points_);
    refiner.Start(grid, false);
    shares_.resize(points_.Size()), here_.resize(points_.Size()), clusters_.assign(points_.Size(), -1);
    in_.jobs.For(std::int64_t(points_.Size()), [&](std::int64_t job, int) {
        const auto i = std::size_t(job);
        const std::size_t index = lattice_.UniformIndex(points_[i].at);
        const PointState state = tracer.States()[index];
        points_[i].traced = state == PointState::Open || state == PointState::Beside;
        if (!points_[i].traced)
            return;
        const Vec3f position = lattice_.PositionOf(points_[i].at);
        clusters_[i] = state == PointState::Open ? PlaceInOpen(in_.space, position).cluster : PlaceBeside(in_.space, position).cluster;
        shares_[i] = observer.Sums().Of(index);
        for (const LightShare &share : shares_[i])
            here_[i].push_back({share.light, share.share, true, VectorOf(table_.At(share.light, position).light)});
    });
    leaves_ = tree_.OpenLeafs();
}

std::vector<CellSample> NamedGridBuilder::DrawSamples(const OctreeCell &leaf, std::size_t number) const {
    std::vector<CellSample> samples;
    const auto seed = std::uint32_t(HashIndex(KeyOf(leaf.origin)));
    const int wanted = kSamplesPerCell;
    for (int i = 0; i < wanted * kMaxTries && int(samples.size()) < wanted; ++i) {
        const Sample2 s = PlasticSample(std::uint32_t(i), seed);
        const double layer = (i % wanted + UnitFromHash(HashIndex((std::uint64_t(seed) << 16) + std::uint64_t(i)))) / wanted;
        CellSample sample;
        sample.at = LatticePosition(leaf.origin) + Vec3f{float(s.u), float(s.v), float(layer)} * float(leaf.Edge());
        sample.position = lattice_.PositionOf(sample.at);
        sample.cluster = in_.space.ClusterAt(sample.position, kClearance);
        if (sample.cluster >= 0 && in_.space.PlayerFits(sample.position))
            samples.push_back(std::move(sample));
    }
    (void)number;
    return samples;
}

void NamedGridBuilder::TraceSamples(const LightAtPositions &light, GridStats &work) {
    samples_.resize(leaves_.size());
    const auto bricks = std::int64_t((leaves_.size() + kCellsPerBrick - 1) / kCellsPerBrick);
    RunBricks(in_, bricks, work, [&](std::int64_t brick, GridStats &stats) {
        const std::size_t first = std::size_t(brick) * kCellsPerBrick, end = std::min(leaves_.size(), first + kCellsPerBrick);
        std::vector<ProbeReceiver> receivers;
        for (std::size_t i = first; i < end; ++i) {
            samples_[i] = DrawSamples(tree_[leaves_[i]], i);
            for (std::size_t s = 0; s < samples_[i].size(); ++s)
                receivers.push_back({samples_[i][s].position, samples_[i][s].cluster,
                                     std::uint32_t(HashIndex(KeyOf(tree_[leaves_[i]].origin) * 64 + s))});
        }
        if (receivers.empty())
            return;
        BrickShares shares(table_, receivers.size());
        const auto values = light.At(receivers, HashIndex(std::uint64_t(brick)), stats, &shares);
        std::size_t next = 0;
        for (std::size_t i = first; i < end; ++i)
            for (CellSample &sample : samples_[i]) {
                sample.light = ToDisplayed(values[next], false);
                sample.shares = shares.Sums().Of(next++);
            }
    });
}

LightHere NamedGridBuilder::LightAt(std::uint32_t light, const Vec3f &position, int cluster,
                                    std::span<const LightShare> shares) const {
    LightHere here{light, 0, false, VectorOf(table_.At(light, position).light)};
    const auto known = std::ranges::find(shares, light, &LightShare::light);
    if (known != shares.end())
        here.share = known->share, here.known = true;
    else if (!table_.MaySee(light, cluster) || Dot(here.vector, here.vector) < kFaintest * kFaintest)
        here.known = true;
    return here;
}

/// The lights that corners of a cell name for it.
std::vector<std::uint32_t> NamedGridBuilder::ChooseNames(std::size_t number) const {
    const OctreeCell &leaf = tree_[leaves_[number]];
    const std::vector<CellSample> &samples = samples_[number];
    std::array<std::uint32_t, 8> corner{};
    std::vector<std::uint32_t> candidates;
    for (std::size_t c = 0; c < 8; ++c) {
        corner[c] = points_.Find(leaf.Corner(c));
        for (const LightHere &here : here_[corner[c]])
            candidates.push_back(here.light);
    }
    for (const CellSample &sample : samples)
        for (const LightShare &share : sample.shares)
            candidates.push_back(share.light);
    std::ranges::sort(candidates);
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    struct Gain {
        float gain;
        std::uint32_t light;
    };
    std::vector<Gain> gains;
    for (const std::uint32_t light : candidates) {
        std::array<LightHere, 8> at;
        std::array<bool, 8> open{};
        for (std::size_t c = 0; c < 8; ++c) {
            open[c] = points_[corner[c]].traced;
            if (!open[c])
                continue;
            const auto known = std::ranges::find(here_[corner[c]], light, &LightHere::light);
            at[c] = known != here_[corner[c]].end()
                        ? *known
                        : LightAt(light, lattice_.PositionOf(points_[corner[c]].at), clusters_[corner[c]], {});
        }
        float gain = 0;
        bool shines = false;
        for (const CellSample &sample : samples) {
            const LightHere here = LightAt(light, sample.position, sample.cluster, sample.shares);
            if (!here.known)
                continue;
            Vec3f blend;
            float share = 0, shareWeight = 0, weightSum = 0;
            for (std::size_t c = 0; c < 8; ++c) {
                if (!open[c])
                    continue;
                const float weight = leaf.Weight(c, sample.at);
                weightSum += weight;
                blend = blend + at[c].vector * (weight * (at[c].known ? at[c].share : here.share));
                if (at[c].known && Dot(at[c].vector, at[c].vector) >= kFaintest * kFaintest)
                    share += weight * at[c].share, shareWeight += weight;
            }
            const float dim = ScreenFactor(sample.light) * 255;
            const Vec3f seen = here.vector * here.share;
            if (weightSum > 0)
                blend = blend / weightSum;
            const Vec3f off = seen - blend;
            const float floor = kDirectionFloor * Length(seen);
            const float wrong = shareWeight > 0 ? share / shareWeight - here.share : 0;
            shines = shines || Length(seen) > kFaintest;
            gain += dim * dim *
                    (Dot(off, off) / 6 + floor * floor - wrong * wrong * Dot(here.vector, here.vector) / 6);
        }
        if (table_.Style(light) != 0 && shines)
            gain = 1e30f;
        if (gain > kMinGain * float(samples.size()))
            gains.push_back({gain, light});
    }
    std::ranges::sort(gains, [](const Gain &a, const Gain &b) { return a.gain != b.gain ? a.gain > b.gain : a.light < b.light; });
    std::vector<std::uint32_t> names;
    for (const Gain &gain : gains)
        if (names.size() < std::size_t(in_.options.shNames) || table_.Style(gain.light) != 0)
            names.push_back(gain.light);
    return names;
}

void NamedGridBuilder::NameLights() {
    corners_.emplace(tree_, points_);
    names_.resize(corners_->Stored().size());
    std::vector<std::vector<std::uint32_t>> chosen(leaves_.size());
    constexpr std::size_t kChunk = 64;
    in_.jobs.For(std::int64_t((leaves_.size() + kChunk - 1) / kChunk), [&](std::int64_t chunk, int) {
        for (std::size_t i = std::size_t(chunk) * kChunk; i < std::min(leaves_.size(), (std::size_t(chunk) + 1) * kChunk); ++i)
            chosen[i] = ChooseNames(i);
    });
    for (std::size_t i = 0; i < leaves_.size(); ++i)
        for (std::size_t c = 0; c < 8 && !chosen[i].empty(); ++c)
            for (const CornerTerm &term : corners_->TermsIn(tree_[leaves_[i]], tree_[leaves_[i]].Corner(c)))
                names_[term.stored].insert(names_[term.stored].end(), chosen[i].begin(), chosen[i].end());
    firstSlot_.resize(names_.size());
    std::size_t slots = 0;
    for (std::size_t i = 0; i < names_.size(); ++i) {
        std::ranges::sort(names_[i]);
        names_[i].erase(std::unique(names_[i].begin(), names_[i].end()), names_[i].end());
        firstSlot_[i] = slots;
        slots += names_[i].size();
    }
    slots_.assign(slots, 0);
}

float FitWeightOf(const SHFloats &light) {
    return FitWeight(1, std::max(0.0f, MeanLight(light)), FittedPoints::All);
}

void NamedGridBuilder::FitShares() {
    LeastSquares<float> system(slots_.size());
    std::vector<float> priorSum(slots_.size()), priorWeight(slots_.size());
    std::vector<UnknownTerm> terms;
    std::vector<bool> known(slots_.size());
    for (std::size_t i = 0; i < names_.size(); ++i) {
        const std::uint32_t number = corners_->Stored()[i];
        const LatticeSample &point = points_[number];
        for (std::size_t n = 0; n < names_[i].size(); ++n) {
            const std::size_t slot = firstSlot_[i] + n;
            if (!point.traced)
                continue;
            const LightHere here = LightAt(names_[i][n], lattice_.PositionOf(point.at), clusters_[number], shares_[number]);
            const float square = Dot(here.vector, here.vector);
            if (!here.known || square < kFaintest * kFaintest)
                continue;
            known[slot] = true;
            slots_[slot] = here.share;
            system.SetPull(slot, kSharePull * square * FitWeightOf(point.value));
        }
    }
    for (std::size_t i = 0; i < leaves_.size(); ++i)
        for (const CellSample &sample : samples_[i]) {
            const auto corner = TermsAt(i, sample.at);
            std::vector<std::uint32_t> lights;
            for (const CornerTerm &term : corner)
                lights.insert(lights.end(), names_[term.stored].begin(), names_[term.stored].end());
            std::ranges::sort(lights);
            lights.erase(std::unique(lights.begin(), lights.end()), lights.end());
            const float weight = FitWeightOf(sample.light);
            for (const std::uint32_t light : lights) {
                const LightHere here = LightAt(light, sample.position, sample.cluster, sample.shares);
                const float square = Dot(here.vector, here.vector);
                if (!here.known || square < kFaintest * kFaintest)
                    continue;
                terms.clear();
                float covered = 0;
                for (const CornerTerm &term : corner)
                    if (const std::size_t slot = SlotOf(term.stored, light); slot != SIZE_MAX) {
                        terms.push_back({std::uint32_t(slot), term.weight});
                        covered += term.weight;
                        priorSum[slot] += term.weight * square * here.share;
                        priorWeight[slot] += term.weight * square;
                    }
                system.AddSample(here.share * covered, weight * square, terms);
            }
        }
    for (std::size_t slot = 0; slot < slots_.size(); ++slot)
        if (!known[slot]) {
            slots_[slot] = priorWeight[slot] > 0 ? priorSum[slot] / priorWeight[slot] : 0;
            system.SetPull(slot, kUnknownPull * system.WeightOf(slot));
        }
    system.Solve(slots_, kShareSteps);
    for (float &share : slots_)
        share = std::round(std::clamp(share, 0.0f, 1.0f) * 255) / 255;
}

void NamedGridBuilder::FitRest() {
    const std::size_t count = names_.size();
    rest_.assign(count, SHFloats{});
    LeastSquares<SHFloats> system(count);
    std::vector<SHFloats> priorSum(count);
    std::vector<float> priorWeight(count);
    for (std::size_t i = 0; i < count; ++i) {
        const LatticeSample &point = points_[corners_->Stored()[i]];
        if (!point.traced)
            continue;
        rest_[i] = point.value;
        for (std::size_t n = 0; n < names_[i].size(); ++n)
            if (const float share = slots_[firstSlot_[i] + n]; share > 0)
                AddScaled(-share, table_.At(names_[i][n], lattice_.PositionOf(point.at)).light, rest_[i]);
        if (getenv("NDBG") && i % 5000 == 0 && !names_[i].empty()) {
            const Vec3f p = lattice_.PositionOf(point.at);
            fprintf(stderr, "point %g %g %g T %g rest %g\n", double(p.x), double(p.y), double(p.z), double(point.value[0]), double(rest_[i][0]));
            for (std::size_t n = 0; n < names_[i].size(); ++n) {
                const auto b = table_.At(names_[i][n], p);
                const auto &l = table_.Stored().lights[names_[i][n]];
                fprintf(stderr, "   light %u type %d share %g c0 %g strength %g origin %g %g %g intensity %g curve %d\n", names_[i][n], l.type, double(slots_[firstSlot_[i]+n]), double(b.light[0]), double(b.strength), double(l.origin[0]), double(l.origin[1]), double(l.origin[2]), double(l.intensity), l.curve);
            }
        }
    }
    for (std::size_t i = 0; i < leaves_.size(); ++i)
        for (const CellSample &sample : samples_[i]) {
            const auto corner = TermsAt(i, sample.at);
            std::vector<std::pair<std::uint32_t, float>> lights;
            std::vector<UnknownTerm> terms;
            for (const CornerTerm &term : corner) {
                terms.push_back({term.stored, term.weight});
                for (std::size_t n = 0; n < names_[term.stored].size(); ++n) {
                    const std::uint32_t light = names_[term.stored][n];
                    const float share = term.weight * slots_[firstSlot_[term.stored] + n];
                    const auto at = std::ranges::find(lights, light, &std::pair<std::uint32_t, float>::first);
                    if (at != lights.end())
                        at->second += share;
                    else
                        lights.push_back({light, share});
                }
            }
            SHFloats rest = sample.light;
            for (const auto &[light, share] : lights)
                if (share > 0)
                    AddScaled(-share, table_.At(light, sample.position).light, rest);
            const float weight = FitWeightOf(sample.light);
            system.AddSample(rest, weight, terms);
            for (const CornerTerm &term : corner)
                AddScaled(weight * term.weight, rest, priorSum[term.stored]), priorWeight[term.stored] += weight * term.weight;
        }
    for (std::size_t i = 0; i < count; ++i) {
        const bool known = points_[corners_->Stored()[i]].traced;
        if (!known && priorWeight[i] > 0)
            AddScaled(1 / priorWeight[i], priorSum[i], rest_[i]);
        system.SetPull(i, (known ? kRestPull : kUnknownPull) * system.WeightOf(i));
    }
    system.Solve(rest_, kRestSteps);
}

NamedGridSH NamedGridBuilder::Pack(NamedStats &result) const {
    const StoredTree stored = StoreTree(tree_, points_, *corners_);
    NamedGridSH grid;
    grid.mins = lattice_.Mins().Array(), grid.cell = lattice_.Cell().Array();
    grid.roots = lattice_.Roots(), grid.levels = lattice_.Levels();
    grid.table = table_.Stored();
    std::size_t next = 0;
    for (const SparseGridNode &from : stored.nodes) {
        NamedGridNode node;
        node.inner = from.inner, node.stored = from.stored, node.hanging = from.hanging;
        std::vector<std::uint32_t> names;
        const auto count = std::size_t(std::popcount(from.stored));
        for (std::size_t p = 0; p < count; ++p) {
            const std::uint32_t i = stored.order[next + p];
            for (std::size_t n = 0; n < names_[i].size(); ++n)
                if (slots_[firstSlot_[i] + n] > 0)
                    names.push_back(names_[i][n]);
        }
        std::ranges::sort(names);
        names.erase(std::unique(names.begin(), names.end()), names.end());
        node.nameCount = std::uint8_t(names.size());
        grid.names.insert(grid.names.end(), names.begin(), names.end());
        for (std::size_t p = 0; p < count; ++p) {
            const std::uint32_t i = stored.order[next + p];
            grid.points.push_back(QuantizeNamed(ToStored(rest_[i], false)));
            for (const std::uint32_t light : names) {
                const std::size_t slot = SlotOf(i, light);
                grid.shares.push_back(slot == SIZE_MAX ? 0 : std::uint8_t(std::lround(slots_[slot] * 255)));
            }
        }
        next += count;
        grid.nodes.push_back(node);
    }
    NumberNamedNodes(grid);
    result.lights = grid.table.lights.size(), result.cells = leaves_.size(), result.points = grid.points.size();
    result.names = grid.shares.size();
    result.bytes = EncodeNamedGrid(grid).size();
    return grid;
}

NamedGridSH NamedGridBuilder::Bake(GridStats &work, NamedStats &result) {
    GridSHTracer tracer(in_, layout_, lights_);
    TraceCorners(tracer, work);
    const ProbeIntegrator integrator(in_, lights_);
    TraceSamples(LightAtPositions(integrator, tracer.Weak()), work);
    for (const auto &samples : samples_)
        result.samples += samples.size();
    NameLights();
    FitShares();
    FitRest();
    return Pack(result);
}

} // namespace

NamedGridSH BakeNamedGrid(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                          GridStats &work, NamedStats &result) {
    const LightTable table(lights, in.options.PositiveGridScale());
    return NamedGridBuilder(in, layout, lights, table).Bake(work, result);
}

void PrintNamedStats(const NamedStats &stats, Log &log) {
    log.Count(stats.lights, "lights that points can name");
    log.Count(stats.cells, "cells with open space");
    log.Count(stats.samples, "positions inside cells");
    log.Count(stats.points, "points");
    log.Print("{:9.2f} names a point\n", double(stats.names) / double(std::max<std::size_t>(1, stats.points)));
    log.Print("{:9.2f} MB\n", double(stats.bytes) / 1e6);
}

} // namespace q3
