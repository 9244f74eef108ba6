// GPL-2.0-or-later. The cells of a grid that names lights while it is built.
#include "q3map2/light/named/named_cells.h"

#include "libs/math/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Samples in each leaf, and candidates drawn at most for each.
int kSamplesPerLeaf = getenv("NSAMP") ? atoi(getenv("NSAMP")) : 4;
constexpr int kMaxTries = 4;
/// Receivers that are traced together.
constexpr std::size_t kBrickReceivers = 256;
/// Leafs whose samples are drawn in one job.
constexpr std::size_t kLeafChunk = 64;
/// Edge of the smallest cells, game units.
constexpr float kLeastEdge = 8;

/// Adds light from one direction, from the irradiance vector of its brightest channel. tint: of that channel 1.
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

} // namespace

SHFloats NamedPrediction(const OctreeCell &cell, const CornerReceivers &corners, const NamedReceiver &receiver,
                         const LightTable &table) {
    SHFloats sum{};
    float total = 0;
    std::array<float, 8> weights{};
    std::vector<std::uint32_t> names;
    for (std::size_t c = 0; c < 8; ++c) {
        if (!corners[c])
            continue;
        weights[c] = cell.Weight(c, receiver.at);
        total += weights[c];
        AddScaled(weights[c], corners[c]->light, sum);
        for (const LightHere &here : corners[c]->lights) {
            AddVector(-weights[c] * here.share, here.vector, table.Tint(here.light), sum);
            if (std::ranges::find(names, here.light) == names.end())
                names.push_back(here.light);
        }
    }
    if (!(total > 0))
        return receiver.light;
    for (float &value : sum)
        value /= total;
    for (const std::uint32_t name : names) {
        float share = 0, weight = 0;
        for (std::size_t c = 0; c < 8; ++c)
            if (corners[c])
                if (const auto here = corners[c]->At(name, table); here && here->Squared() >= kFaintest * kFaintest)
                    share += weights[c] * here->share, weight += weights[c];
        const LightHere *known = receiver.Find(name);
        if (weight > 0)
            AddVector(share / weight, known ? known->vector : table.RoughVector(name, receiver.position),
                      table.Tint(name), sum);
    }
    return sum;
}

NamedCells::NamedCells(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                       const LightTable &table, CellSizes sizes)
    : in_(in), layout_(layout), table_(table),
      lattice_(sizes == CellSizes::Uniform
                   ? SparseLattice::OfUniformCells({layout.mins, layout.size, layout.bounds, 0})
                   : SparseLattice::Cubic({layout.mins, layout.size, layout.bounds, 0})),
      tracer_(in, layout, lights), integrator_(in, lights), tree_(lattice_), points_(lattice_) {}

void NamedCells::Start(GridStats &work) {
    LightCollector collector(table_, std::size_t(layout_.Count()), LightCollector::Number::ByIndex);
    const LightGridSH grid = tracer_.TracePointsOnly(work, collector);
    light_.emplace(integrator_, tracer_.Weak());
    for (std::size_t i = 0; i < tree_.Size(); ++i) {
        const OctreeCell &cell = tree_[i];
        const bool open = in_.space.AnyOpen(lattice_.PositionOf(cell.origin), lattice_.PositionOf(cell.Corner(7)), kClearance);
        tree_[i].openFraction = open ? 1.0f : 0.0f;
        if (open && cell.level > lattice_.BaseLevel())
            tree_.Split(i);
    }
    SetUniformPoints(grid, collector, tracer_.States());
    for (std::size_t i = 0; i < tree_.Size(); ++i)
        SetOpenFraction(tree_[i]);
    SampleLeafs(tree_.OpenLeafs(), work);
    if (lattice_.BaseLevel() > 0)
        MeasureErrors(0);
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
            // Points outside the uniform grid have the index of another.
            const bool inside = Length(Vec3f(layout_.Position(layout_.Coordinates(std::int64_t(index))[0],
                                                              layout_.Coordinates(std::int64_t(index))[1],
                                                              layout_.Coordinates(std::int64_t(index))[2])) -
                                       position) < 0.5f;
            const PointState state = inside ? states[index] : PointState::Exterior;
            points_[i].traced = state == PointState::Open || state == PointState::Beside;
            if (!points_[i].traced)
                continue;
            const PlacedPoint placed =
                state == PointState::Open ? PlaceInOpen(in_.space, position) : PlaceBeside(in_.space, position);
            points_[i].value = std::bit_cast<SHFloats>(grid.points[index]);
            corners_[i] = {LatticePosition(points_[i].at), position, placed.cluster, points_[i].value,
                           collector.Of(index, position)};
        }
    });
}

void NamedCells::SetOpenFraction(OctreeCell &cell) const {
    if (!(cell.openFraction > 0))
        return;
    float fraction = 0;
    for (std::size_t c = 0; c < 8; ++c) {
        const std::uint32_t number = points_.Find(cell.Corner(c));
        fraction += number != LatticePoints::kUnknown && points_[number].traced ? 1.0f / 8 : 0;
    }
    cell.openFraction = std::max(fraction, 1.0f / 8); // all corners may be in solids
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
        points_[numbers[i]].traced = true;
        points_[numbers[i]].value = receivers[i].light;
        receivers[i].position = lattice_.PositionOf(points_[numbers[i]].at);
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
        const auto values = light_->At(probes, HashIndex(probes.front().seed), workers[std::size_t(worker)], &collector);
        for (std::size_t i = first; i < end; ++i) {
            receivers[i].light = std::bit_cast<SHFloats>(values[i - first]);
            receivers[i].lights = collector.Of(i - first, receivers[i].position);
        }
    });
    for (const GridStats &part : workers)
        work.Add(part);
}

/// Positions where a player fits: x and y from a low-discrepancy sequence, z stratified. have: samples in the leaf.
std::vector<NamedReceiver> NamedCells::DrawSamples(const OctreeCell &leaf, std::size_t have) const {
    std::vector<NamedReceiver> samples;
    const auto seed = std::uint32_t(HashIndex(KeyOf(leaf.origin) * 32 + std::uint64_t(leaf.level)));
    const int wanted = kSamplesPerLeaf - int(std::min(have, std::size_t(kSamplesPerLeaf)));
    for (int i = 0; i < wanted * kMaxTries && int(samples.size()) < wanted; ++i) {
        const Sample2 s = PlasticSample(std::uint32_t(i), seed);
        const double height = UnitFromHash(HashIndex((std::uint64_t(seed) << 16) + std::uint64_t(i)));
        NamedReceiver sample;
        sample.at = LatticePosition(leaf.origin) +
                    Vec3f{float(s.u), float(s.v), float((i % wanted + height) / wanted)} * float(leaf.Edge());
        sample.position = lattice_.PositionOf(sample.at);
        sample.cluster = in_.space.ClusterAt(sample.position, kClearance);
        if (sample.cluster >= 0 && in_.space.PlayerFits(sample.position))
            samples.push_back(std::move(sample));
    }
    return samples;
}

void NamedCells::SampleLeafs(std::span<const std::size_t> leafs, GridStats &work) {
    samplesOfLeaf_.resize(tree_.Size());
    std::vector<std::vector<NamedReceiver>> drawn((leafs.size() + kLeafChunk - 1) / kLeafChunk);
    ForChunks(in_.jobs, leafs.size(), kLeafChunk, [&](std::size_t first, std::size_t end, int) {
        for (std::size_t i = first; i < end; ++i)
            for (NamedReceiver &sample : DrawSamples(tree_[leafs[i]], samplesOfLeaf_[leafs[i]]))
                drawn[first / kLeafChunk].push_back(std::move(sample));
    });
    const std::size_t before = samples_.size();
    for (std::vector<NamedReceiver> &part : drawn)
        std::ranges::move(part, std::back_inserter(samples_));
    TraceReceivers(std::span(samples_).subspan(before), work);
    for (std::size_t i = before; i < samples_.size(); ++i)
        ++samplesOfLeaf_[tree_.LeafAt(CellAt(samples_[i].at))];
}

CornerReceivers NamedCells::CornersOf(const OctreeCell &cell) const {
    CornerReceivers corners{};
    for (std::size_t c = 0; c < 8; ++c)
        if (const std::uint32_t number = points_.Find(cell.Corner(c)); number != LatticePoints::kUnknown)
            corners[c] = ReceiverAt(number);
    return corners;
}

void NamedCells::MeasureErrors(std::size_t firstCell) {
    // The sums of the cells above a leaf: each receiver is blended in all of them.
    std::vector<std::vector<std::uint32_t>> inside(tree_.Size());
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        std::size_t cell = tree_.RootAt(samples_[i].at);
        for (;;) {
            inside[cell].push_back(std::uint32_t(i));
            if (tree_[cell].child == 0)
                break;
            const LatticePoint p = CellAt(samples_[i].at);
            const int bit = tree_[cell].level - 1;
            cell = tree_[cell].child +
                   std::size_t((p[0] >> bit & 1) | (p[1] >> bit & 1) << 1 | (p[2] >> bit & 1) << 2);
        }
    }
    ForChunks(in_.jobs, tree_.Size() - firstCell, kLeafChunk, [&](std::size_t first, std::size_t end, int) {
        for (std::size_t i = firstCell + first; i < firstCell + end; ++i) {
            OctreeCell &cell = tree_[i];
            const CornerReceivers corners = CornersOf(cell);
            double sum = 0;
            for (const std::uint32_t sample : inside[i])
                sum += double(screen_.Squared(NamedPrediction(cell, corners, samples_[sample], table_),
                                              samples_[sample].light));
            cell.error = inside[i].empty() ? 0 : float(sum / double(inside[i].size()));
            for (std::size_t c = 0; c < 8; ++c) // cannot be a leaf
                if (points_.Find(cell.Corner(c)) == LatticePoints::kUnknown)
                    cell.error = std::numeric_limits<float>::infinity();
        }
    });
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
    const std::size_t firstChild = tree_.Size();
    for (const std::size_t i : cells) {
        tree_.Split(i);
        for (std::size_t c = 0; c < 8; ++c) {
            OctreeCell &child = tree_[tree_[i].child + c];
            const bool open = in_.space.AnyOpen(lattice_.PositionOf(child.origin), lattice_.PositionOf(child.Corner(7)), kClearance);
            child.openFraction = open ? 1.0f : 0.0f;
            SetOpenFraction(child);
            if (open)
                children.push_back(tree_[i].child + c);
        }
    }
    samplesOfLeaf_.assign(tree_.Size(), 0);
    for (const NamedReceiver &sample : samples_)
        ++samplesOfLeaf_[tree_.LeafAt(CellAt(sample.at))];
    SampleLeafs(children, work);
    MeasureErrors(firstChild);
    return true;
}

} // namespace q3
