// GPL-2.0-or-later. Ambient cubes of the leafs of a map.
#include "q3map2/light/cubes/ambient_cubes.h"

#include "common/error.h"
#include "q3map2/light/cubes/cube_light.h"
#include "q3map2/light/cubes/leaf_positions.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>

namespace q3 {

namespace {

/// Leafs of one cluster are lit in groups of about this many places.
constexpr std::size_t kPlacesTogether = 256;
/// The tolerance is multiplied by kRaise while there are too many samples. Beyond kLastTolerance it becomes infinite,
/// which leaves one sample in each leaf.
constexpr float kRaise = 1.5f, kLastTolerance = 1e30f;

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
    std::size_t count = kPlacesTogether;
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
            gridCubes_ = std::make_unique<SHGridSides>(*grid, in.options.shRadiance);
    }

    void Run(GridStats &stats) {
        const LeafPolytopes polytopes(bsp_);
        in_.jobs.For(std::int64_t(bsp_.leafs.size()), [&](std::int64_t leaf, int) {
            if (bsp_.leafs[std::size_t(leaf)].cluster >= 0)
                places_[std::size_t(leaf)] = FindCubePlaces(in_.space, polytopes, std::size_t(leaf));
        });
        const std::vector<LeafGroup> groups = GroupLeafs(bsp_, places_);
        RunBricks(in_, std::int64_t(groups.size()), stats, [&](std::int64_t group, GridStats &work) {
            Light(groups[std::size_t(group)], std::uint64_t(group), work);
        });
        for (const std::vector<CubePlace> &places : places_)
            stats.points += std::int64_t(places.size()), stats.open += places.empty() ? 0 : 1;
    }

  private:
    void Light(const LeafGroup &group, std::uint64_t seed, GridStats &work) const {
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
        constexpr std::uint32_t kIndexes = 128; // indexes reserved for a leaf: the most places that it can have
        std::vector<ReceiverBatch> blocks;
        for (const std::size_t leaf : group)
            for (std::uint32_t i = 0; i < places_[leaf].size(); ++i) {
                const Vec3f &p = places_[leaf][i].position;
                BatchWithRoom(blocks).Add(p, p, bsp_.leafs[leaf].cluster, std::uint32_t(leaf) * kIndexes + i);
            }
        return integrator_.Sides(blocks, seed, work);
    }

    const GridInputs &in_;
    const Bsp &bsp_;
    CubeIntegrator integrator_;
    std::unique_ptr<const SHGridSides> gridCubes_;
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
void CheckLeafCount(const LeafCubes &leafs, std::size_t most) {
    std::size_t count = 0;
    for (std::size_t leaf = 0; leaf < leafs.size(); ++leaf)
        if (!leafs[leaf].empty() && ++count > most)
            throw Error("-ambientcubes: leaf {} is the {}th with light, but the format holds {} samples: make detail "
                        "brushes of structural ones, or bake -sh instead",
                        leaf, count, most);
}

LeafCubes ThinToFit(const LeafCubes &leafs, float tolerance, const JobPool &jobs, Log &log, std::size_t most) {
    LeafCubes thin = ThinnedOut(leafs, tolerance, jobs);
    const std::size_t asked = CountSamples(thin);
    if (asked <= most)
        return thin;
    CheckLeafCount(leafs, most);
    float raised = std::max(tolerance, 1.0f);
    while (CountSamples(thin) > most) {
        raised = raised > kLastTolerance ? std::numeric_limits<float>::infinity() : raised * kRaise;
        thin = ThinnedOut(leafs, raised, jobs);
    }
    log.Warn("ambient cubes",
             "{} ambient cubes within a tolerance of {:g}, but the format holds {}: a tolerance of {:g} leaves {}",
             asked, tolerance, most, raised, CountSamples(thin));
    return thin;
}

/// Squared distance between the bounds of two leafs.
double LeafDistance(const bspLeaf_t &a, const bspLeaf_t &b) {
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
        const double distance = LeafDistance(here, there);
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
                                       const JobPool &jobs, Log &log, std::size_t most) {
    const LeafCubes thin = ThinToFit(leafs, tolerance, jobs, log, most);
    AmbientCubes cubes;
    cubes.leafs.resize(thin.size());
    std::vector<std::size_t> lit;
    for (std::size_t leaf = 0; leaf < thin.size(); ++leaf) {
        if (thin[leaf].empty())
            continue;
        if (leaf <= UINT16_MAX)
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
