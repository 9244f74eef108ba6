// GPL-2.0-or-later. The cells of a grid that names lights while it is built.
#include "q3map2/light/named/named_cells.h"

#include "libs/math/sampling.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

namespace q3 {

namespace {

/// A leaf gets kFirstSamples samples, and kMostSamples in all where the squared displayed error at those is above
/// kSmallError, bytes^2, or where a goal is given, which may take long. They are chosen among kCandidates positions.
constexpr std::size_t kFirstSamples = 1, kMostSamples = 4;
constexpr float kSmallError = 2;
constexpr std::uint32_t kCandidates = 8;
/// A leaf that has open space, but no candidate where a player fits, counts as having this many such candidates: its
/// open fraction stays above 0, so that it stays open.
constexpr float kLittle = 1e-3f;
/// Receivers that are traced together, as a brick.
constexpr std::size_t kBrickReceivers = 256;
/// Leafs whose samples are drawn in one job.
constexpr std::size_t kLeafChunk = 64;
/// Positions that are closer to each other are one lattice point. Points are at least kMinCubicCell apart. Game units.
constexpr float kSamePoint = 0.5f;
/// Splitting makes no cell with a shorter edge. Game units.
constexpr float kLeastEdge = 8;

/// sum += factor times the coefficients, convolved with the cosine, of light from one direction with that irradiance
/// vector. tint: factors of the channels (LightTable::Tint).
void AddVector(float factor, const Vec3f &vector, const Vec3f &tint, SHFloats &sum) {
    const float length = Length(vector);
    if (!(length > 0))
        return;
    const auto basis = SHBasis(vector / length);
    for (std::size_t k = 0; k < 9; ++k) {
        const float value = factor * length * basis[k] * float(kCosineLobe[k]);
        sum[3 * k] += value * tint.x, sum[3 * k + 1] += value * tint.y, sum[3 * k + 2] += value * tint.z;
    }
}

template <typename Use> void ForChunks(const JobPool &jobs, std::size_t count, std::size_t chunk, const Use &use) {
    jobs.For(std::int64_t((count + chunk - 1) / chunk), [&](std::int64_t job, int worker) {
        use(std::size_t(job) * chunk, std::min(count, (std::size_t(job) + 1) * chunk), worker);
    });
}

/// A light with its shares at the corners of a cell.
struct CornerShares {
    std::uint32_t light;
    float most = 0; ///< largest squared irradiance that arrives at a corner
    std::array<float, 8> share{};
    std::array<bool, 8> known{};
};

/// The lights of style 0 that a cell would name: of those traced at its corners, the `most` with the largest irradiance
/// at a corner.
std::vector<CornerShares> SharesOf(const CornerReceivers &corners, const LightTable &table, std::size_t most) {
    std::vector<CornerShares> shares;
    for (const NamedReceiver *corner : corners)
        for (std::size_t i = 0; corner && i < corner->lights.size(); ++i) {
            const LightHere &here = corner->lights[i];
            if (table.Style(here.light) != 0) // never part of NamedReceiver::light
                continue;
            auto at = std::ranges::find(shares, here.light, &CornerShares::light);
            if (at == shares.end())
                at = shares.insert(shares.end(), CornerShares{.light = here.light});
            at->most = std::max(at->most, here.Squared() * here.share * here.share);
        }
    if (shares.size() > most) {
        std::ranges::sort(shares, [](const CornerShares &a, const CornerShares &b) {
            return a.most != b.most ? a.most > b.most : a.light < b.light;
        });
        shares.resize(most);
    }
    for (CornerShares &one : shares)
        for (std::size_t c = 0; c < 8; ++c)
            if (const auto here = corners[c] ? corners[c]->At(one.light, table) : std::nullopt;
                here && here->Squared() >= kFaintest * kFaintest)
                one.share[c] = here->share, one.known[c] = true;
    return shares;
}

/// The light at the corners minus the light that arrives there from named lights, by their irradiance vectors.
std::array<SHFloats, 8> RestOf(const CornerReceivers &corners, std::span<const CornerShares> shares,
                               const LightTable &table) {
    std::array<SHFloats, 8> rest{};
    for (std::size_t c = 0; c < 8; ++c) {
        if (!corners[c])
            continue;
        rest[c] = corners[c]->light;
        for (const CornerShares &one : shares)
            if (const LightHere *here = corners[c]->Find(one.light))
                AddVector(-here->share, here->vector, table.Tint(one.light), rest[c]);
    }
    return rest;
}

/// Weight of the squared error, 1 to kMost: (kDarkLight + shown) / (kDarkLight + right) of the mean light, since light
/// that leaks into the dark is easier to see than dark that leaks into light.
float LeakWeight(const SHFloats &right, const SHFloats &shown) {
    constexpr float kDarkLight = 0.02f, kMost = 16;
    const float ratio =
        (kDarkLight + std::max(0.0f, MeanLight(shown))) / (kDarkLight + std::max(0.0f, MeanLight(right)));
    return std::clamp(ratio, 1.0f, kMost);
}

/// Light that readers would interpolate between the corners of a cell at a receiver in it.
SHFloats Blend(const OctreeCell &cell, const CornerReceivers &corners, const std::array<SHFloats, 8> &rest,
               std::span<const CornerShares> shares, const NamedReceiver &receiver, const LightTable &table) {
    SHFloats sum{};
    std::array<float, 8> weights{};
    float total = 0;
    for (std::size_t c = 0; c < 8; ++c)
        if (corners[c]) {
            weights[c] = cell.Weight(c, receiver.at);
            total += weights[c];
            AddScaled(weights[c], rest[c], sum);
        }
    if (!(total > 0)) // all corners are in solids: counts as no error, since no smaller cell would help
        return receiver.light;
    for (float &value : sum)
        value /= total;
    for (const CornerShares &one : shares) {
        float share = 0, weight = 0;
        for (std::size_t c = 0; c < 8; ++c)
            if (one.known[c])
                share += weights[c] * one.share[c], weight += weights[c];
        if (!(share > 0))
            continue;
        const LightHere *known = receiver.Find(one.light);
        AddVector(share / weight, known ? known->vector : table.RoughVector(one.light, receiver.position),
                  table.Tint(one.light), sum);
    }
    return sum;
}

} // namespace

NamedCells::NamedCells(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                       const LightTable &table, CellSizes sizes)
    : in_(in), layout_(layout), table_(table),
      mostNames_(std::size_t(in.options.shNames)), world_{Vec3f(in.space.Map().models[0].mins),
                                                          Vec3f(in.space.Map().models[0].maxs)},
      lattice_(sizes == CellSizes::Uniform ? SparseLattice::OfUniformCells({layout.mins, layout.size, layout.bounds, 0})
                                           : SparseLattice::Cubic({layout.mins, layout.size, layout.bounds, 0})),
      tracer_(in, layout, lights), integrator_(in, lights), tree_(lattice_), points_(lattice_) {}

void NamedCells::Start(GridStats &work) {
    LightCollector collector(table_, std::size_t(layout_.Count()), LightCollector::Number::ByIndex);
    const LightGridSH grid = tracer_.TracePointsOnly(work, collector);
    light_.emplace(integrator_, tracer_.Weak());
    for (std::size_t i = 0; i < tree_.Size(); ++i) {
        const OctreeCell &cell = tree_[i];
        const bool open = HasOpenSpace(cell);
        tree_[i].openFraction = open ? 1.0f : 0.0f;
        if (open && cell.level > lattice_.BaseLevel())
            tree_.Split(i);
    }
    SetUniformPoints(grid, collector, tracer_.States());
    SampleLeafs(tree_.OpenLeafs(), work);
    if (lattice_.BaseLevel() == 0)
        return;
    // An inner cell has the samples of its leafs. Children have larger indexes than their parents.
    for (std::size_t i = tree_.Size(); i-- > 0;) {
        for (std::size_t c = 0; c < 8 && tree_[i].child != 0; ++c) {
            const auto &below = samplesOf_[tree_[i].child + c];
            samplesOf_[i].insert(samplesOf_[i].end(), below.begin(), below.end());
        }
        if (tree_[i].child != 0)
            MeasureError(i);
    }
}

void NamedCells::SetUniformPoints(const LightGridSH &grid, const LightCollector &collector,
                                  const std::vector<PointState> &states) {
    const auto step = [&](std::size_t axis) { return std::int32_t(1) << lattice_.UniformLevel(axis); };
    for (const std::size_t leaf : tree_.OpenLeafs()) {
        const OctreeCell &cell = tree_[leaf];
        for (std::int32_t z = 0; z <= cell.Edge(); z += step(2))
            for (std::int32_t y = 0; y <= cell.Edge(); y += step(1))
                for (std::int32_t x = 0; x <= cell.Edge(); x += step(0))
                    points_.Add({cell.origin[0] + x, cell.origin[1] + y, cell.origin[2] + z});
    }
    corners_.resize(points_.Size());
    ForChunks(in_.jobs, points_.Size(), kBrickReceivers, [&](std::size_t first, std::size_t end, int) {
        for (std::size_t i = first; i < end; ++i) {
            const std::size_t index = lattice_.UniformIndex(points_[i].at);
            const Vec3f position = lattice_.PositionOf(points_[i].at);
            const auto [x, y, z] = layout_.Coordinates(std::int64_t(index));
            // Outside the uniform grid UniformIndex returns the nearest point of the grid.
            const bool isInside = Length(Vec3f(layout_.Position(x, y, z)) - position) < kSamePoint;
            const PointState state = isInside ? states[index] : PointState::Exterior;
            points_[i].traced = state == PointState::Open || state == PointState::Beside;
            if (!points_[i].traced)
                continue;
            const PlacedPoint placed =
                state == PointState::Open ? PlaceInOpen(in_.space, position) : PlaceBeside(in_.space, position);
            points_[i].value = std::bit_cast<SHFloats>(grid.points[index]);
            corners_[i] = {LatticePosition(points_[i].at), placed.position, placed.cluster, points_[i].value,
                           collector.Of(index, placed.position)};
        }
    });
}

/// Traces lattice points from number `first` on that are in the open or a small step from it.
void NamedCells::TracePoints(std::size_t first, GridStats &work) {
    std::vector<NamedReceiver> receivers;
    std::vector<std::uint32_t> numbers;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::size_t i = first; i < points_.Size(); ++i)
        order.push_back({MortonOf(points_[i].at), std::uint32_t(i)});
    std::ranges::sort(order);
    for (const auto &[code, number] : order) {
        const Vec3f position = lattice_.PositionOf(points_[number].at);
        PlacedPoint placed = PlaceInOpen(in_.space, position);
        if (placed.state != PointState::Open)
            placed = PlaceBeside(in_.space, position);
        if (placed.state == PointState::Exterior)
            continue;
        numbers.push_back(number);
        receivers.push_back({LatticePosition(points_[number].at), placed.position, placed.cluster, {}, {}});
    }
    TraceReceivers(receivers, work);
    corners_.resize(points_.Size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (receivers[i].isOnLight)
            continue;
        points_[numbers[i]].traced = true;
        points_[numbers[i]].value = receivers[i].light;
        corners_[numbers[i]] = std::move(receivers[i]);
    }
}

void NamedCells::TraceReceivers(std::span<NamedReceiver> receivers, GridStats &work) const {
    std::vector<GridStats> workers(std::size_t(in_.jobs.Threads()));
    ForChunks(in_.jobs, receivers.size(), kBrickReceivers, [&](std::size_t first, std::size_t end, int worker) {
        std::vector<ProbeReceiver> probes;
        for (const NamedReceiver &one : receivers.subspan(first, end - first)) {
            const auto at = std::bit_cast<std::array<std::uint32_t, 3>>(one.at);
            const std::uint64_t hash = HashIndex(HashIndex(HashIndex(at[0]) ^ at[1]) ^ at[2]);
            probes.push_back({one.position, one.cluster, std::uint32_t(hash)});
        }
        LightCollector collector(table_, probes.size(), LightCollector::Number::InBlocks);
        const auto values =
            light_->At(probes, HashIndex(probes.front().seed), workers[std::size_t(worker)], &collector);
        for (std::size_t i = first; i < end; ++i) {
            receivers[i].light = std::bit_cast<SHFloats>(values[i - first]);
            receivers[i].isOnLight = collector.IsOnLight(i - first, receivers[i].position);
            receivers[i].lights = collector.Of(i - first, receivers[i].position);
        }
    });
    for (const GridStats &part : workers)
        work.Add(part);
}

bool NamedCells::HasOpenSpace(const OctreeCell &cell) const {
    Vec3f mins = lattice_.PositionOf(cell.origin), maxs = lattice_.PositionOf(cell.Corner(7));
    for (std::size_t axis = 0; axis < 3; ++axis) { // leafs of the BSP tree that count as open reach beyond the world
        mins[axis] = std::max(mins[axis], world_.mins[axis]);
        maxs[axis] = std::min(maxs[axis], world_.maxs[axis]);
        if (mins[axis] >= maxs[axis])
            return false;
    }
    return in_.space.AnyOpen(mins, maxs, kClearance);
}

/// Candidate `number` for a sample of a leaf: x and y from a low-discrepancy sequence, z stratified.
NamedReceiver NamedCells::Candidate(const OctreeCell &leaf, std::uint32_t number) const {
    const auto seed = std::uint32_t(HashIndex(KeyOf(leaf.origin) * 32 + std::uint64_t(leaf.level)));
    const Sample2 s = PlasticSample(number, seed);
    const double height = UnitFromHash(HashIndex((std::uint64_t(seed) << 16) + number));
    const auto z = float(((seed + number) % kMostSamples + height) / kMostSamples);
    NamedReceiver sample;
    sample.at = LatticePosition(leaf.origin) + Vec3f{float(s.u), float(s.v), z} * float(leaf.Edge());
    sample.position = lattice_.PositionOf(sample.at);
    sample.cluster = in_.space.ClusterAt(sample.position, kClearance);
    return sample;
}

/// Finds the candidates where a player fits. Sets the open fraction of the leaf to their fraction, so that errors count
/// where players can be.
NamedCells::LeafToSample NamedCells::FindCandidates(std::size_t leaf) {
    LeafToSample found{leaf, 0};
    for (std::uint32_t i = 0; i < kCandidates; ++i)
        if (const NamedReceiver one = Candidate(tree_[leaf], i);
            world_.Contains(one.position) && one.cluster >= 0 && in_.space.PlayerFits(one.position))
            found.candidates |= 1u << i;
    tree_[leaf].openFraction = std::max(float(std::popcount(found.candidates)), kLittle) / kCandidates;
    return found;
}

/// Adds samples to leafs until they have `wanted`, from their first candidates on, and measures their errors.
void NamedCells::AddSamples(std::span<LeafToSample> leafs, std::size_t wanted, GridStats &work) {
    const std::size_t before = samples_.size();
    for (LeafToSample &one : leafs)
        for (std::size_t count = samplesOf_[one.leaf].size(); count < wanted && one.candidates != 0; ++count) {
            const int number = std::countr_zero(one.candidates);
            one.candidates &= one.candidates - 1;
            samples_.push_back(Candidate(tree_[one.leaf], std::uint32_t(number)));
        }
    TraceReceivers(std::span(samples_).subspan(before), work);
    for (std::size_t i = before; i < samples_.size(); ++i)
        samplesOf_[tree_.LeafAt(CellAt(samples_[i].at))].push_back(std::uint32_t(i));
    ForChunks(in_.jobs, leafs.size(), kLeafChunk, [&](std::size_t first, std::size_t end, int) {
        for (std::size_t i = first; i < end; ++i)
            MeasureError(leafs[i].leaf);
    });
}

void NamedCells::SampleLeafs(std::span<const std::size_t> leafs, GridStats &work) {
    samplesOf_.resize(tree_.Size());
    std::vector<LeafToSample> found(leafs.size());
    ForChunks(in_.jobs, leafs.size(), kLeafChunk, [&](std::size_t first, std::size_t end, int) {
        for (std::size_t i = first; i < end; ++i)
            found[i] = FindCandidates(leafs[i]);
    });
    AddSamples(found, in_.options.sparseGoal.isGiven ? kMostSamples : kFirstSamples, work);
    std::erase_if(found, [&](const LeafToSample &one) { return tree_[one.leaf].error <= kSmallError; });
    AddSamples(found, kMostSamples, work);
}

CornerReceivers NamedCells::CornersOf(const OctreeCell &cell) const {
    CornerReceivers corners{};
    for (std::size_t c = 0; c < 8; ++c)
        if (const std::uint32_t number = points_.Find(cell.Corner(c)); number != LatticePoints::kUnknown)
            corners[c] = ReceiverAt(number);
    return corners;
}

float NamedCells::ErrorOf(const OctreeCell &cell, std::span<const std::uint32_t> samples) const {
    for (std::size_t c = 0; c < 8; ++c)
        if (points_.Find(cell.Corner(c)) == LatticePoints::kUnknown)
            return std::numeric_limits<float>::infinity(); // some corners were never traced: the cell must stay split
    const CornerReceivers corners = CornersOf(cell);
    const std::vector<CornerShares> shares = SharesOf(corners, table_, mostNames_);
    const std::array<SHFloats, 8> rest = RestOf(corners, shares, table_);
    double sum = 0;
    for (const std::uint32_t i : samples) {
        const SHFloats shown = Blend(cell, corners, rest, shares, samples_[i], table_);
        sum += double(screen_.Squared(shown, samples_[i].light) * LeakWeight(samples_[i].light, shown));
    }
    return samples.empty() ? 0 : float(sum / double(samples.size()));
}

float NamedCells::SquaredErrorAt(const OctreeCell &cell, const NamedReceiver &receiver) const {
    const CornerReceivers corners = CornersOf(cell);
    const std::vector<CornerShares> shares = SharesOf(corners, table_, mostNames_);
    return screen_.Squared(Blend(cell, corners, RestOf(corners, shares, table_), shares, receiver, table_),
                           receiver.light);
}

bool NamedCells::CanSplit(const OctreeCell &cell) const {
    const Vec3f edge = lattice_.Cell() * float(cell.Edge());
    return cell.level > 0 && std::min({edge.x, edge.y, edge.z}) >= 2 * kLeastEdge;
}

bool NamedCells::Split(float threshold, GridStats &work) {
    std::vector<std::size_t> cells;
    for (const std::size_t leaf : tree_.OpenLeafs())
        if (tree_[leaf].error * tree_[leaf].Volume() > threshold && CanSplit(tree_[leaf]))
            cells.push_back(leaf);
    if (cells.empty())
        return false;
    const std::size_t firstNew = points_.Size();
    for (const std::size_t i : cells) {
        const std::int32_t half = tree_[i].Edge() / 2;
        for (std::int32_t n = 0; n < 27; ++n)
            points_.Add({tree_[i].origin[0] + n % 3 * half, tree_[i].origin[1] + n / 3 % 3 * half,
                         tree_[i].origin[2] + n / 9 * half});
    }
    TracePoints(firstNew, work);
    std::vector<std::size_t> children;
    for (const std::size_t i : cells) {
        tree_.Split(i);
        for (std::size_t c = 0; c < 8; ++c) {
            OctreeCell &child = tree_[tree_[i].child + c];
            const bool open = HasOpenSpace(child);
            child.openFraction = open ? 1.0f : 0.0f;
            if (open)
                children.push_back(tree_[i].child + c);
        }
    }
    samplesOf_.resize(tree_.Size());
    for (const std::size_t parent : cells)
        for (const std::uint32_t i : samplesOf_[parent])
            samplesOf_[tree_.LeafAt(CellAt(samples_[i].at))].push_back(i);
    SampleLeafs(children, work);
    return true;
}

} // namespace q3
