// GPL-2.0-or-later. Where a map is open, and which places stand for it.
#include "q3map2/convert/grid_preview_map.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

constexpr std::uint32_t kContentsSolid = 1;
constexpr float kFloorBelow = 128, kFloorStep = 16; ///< how far down a floor is looked for
constexpr float kRoom = 24;                         ///< free distance around a place
constexpr int kHeights = 96, kHeightSamples = 64;   ///< probes for the best height, per axis
constexpr int kAreaSamples = 256;
constexpr int kCandidateColumns = 40, kCandidateLevels = 24;
constexpr float kWeakWeight = 0.6f; ///< of a dark place, against 1.6 of a strongly lit one

// Middle of cell i of n between two bounds.
float Middle(float low, float high, int i, int n) {
    return low + (high - low) * ((float(i) + 0.5f) / float(n));
}

struct Candidate {
    Vec3f position;
    float weight = 0;
    float distance = std::numeric_limits<float>::max(); ///< to the nearest chosen one
};

std::vector<Candidate> Weigh(const std::vector<Vec3f> &positions, const std::function<float(const Vec3f &)> &strength) {
    std::vector<Candidate> candidates;
    std::vector<float> sorted;
    for (const Vec3f &position : positions) {
        candidates.push_back({position, strength(position)});
        sorted.push_back(candidates.back().weight);
    }
    const auto high = sorted.begin() + std::ptrdiff_t(sorted.size() * 9 / 10);
    std::nth_element(sorted.begin(), high, sorted.end());
    const float strong = *high;
    for (Candidate &candidate : candidates)
        candidate.weight = kWeakWeight + (strong > 0 ? std::min(1.0f, candidate.weight / strong) : 0);
    return candidates;
}

} // namespace

bool PreviewMap::InBrush(const bspBrush_t &brush, const Vec3f &position) const {
    if (!(bsp_.shaders[std::size_t(brush.shaderNum)].contentFlags & kContentsSolid))
        return false;
    for (std::int32_t side = 0; side < brush.numSides; side++) {
        const auto plane = std::size_t(bsp_.brushSides[std::size_t(brush.firstSide + side)].planeNum);
        if (Dot(Vec3f(bsp_.planes[plane].normal), position) - bsp_.planes[plane].dist > 0)
            return false;
    }
    return true;
}

bool PreviewMap::IsOpen(const Vec3f &position) const {
    std::int32_t at = 0;
    while (at >= 0) {
        const bspNode_t &node = bsp_.nodes[std::size_t(at)];
        const bspPlane_t &plane = bsp_.planes[std::size_t(node.planeNum)];
        at = node.children[Dot(Vec3f(plane.normal), position) - plane.dist > 0 ? 0 : 1];
    }
    const bspLeaf_t &leaf = bsp_.leafs[std::size_t(-1 - at)];
    if (leaf.cluster < 0)
        return false;
    for (std::int32_t i = 0; i < leaf.numBSPLeafBrushes; i++)
        if (InBrush(bsp_.brushes[std::size_t(bsp_.leafBrushes[std::size_t(leaf.firstBSPLeafBrush + i)])], position))
            return false;
    return true;
}

bool PreviewMap::IsOverFloor(const Vec3f &position) const {
    if (!IsOpen(position))
        return false;
    for (float down = kFloorStep; down <= kFloorBelow; down += kFloorStep)
        if (!IsOpen(position - Vec3f(0, 0, down)))
            return true;
    return false;
}

bool PreviewMap::HasRoom(const Vec3f &position) const {
    for (std::size_t axis = 0; axis < 3; axis++)
        for (const float side : {-kRoom, kRoom}) {
            Vec3f beside = position;
            beside[axis] += side;
            if (!IsOpen(beside))
                return false;
        }
    return true;
}

Boundsf PreviewMap::WorldBounds() const {
    Boundsf bounds{Vec3f(bsp_.models[0].mins), Vec3f(bsp_.models[0].maxs)};
    for (std::size_t axis = 0; axis < 3; axis++)
        if (!(bounds.maxs[axis] - bounds.mins[axis] >= 1))
            bounds.maxs[axis] = bounds.mins[axis] + 1;
    return bounds;
}

float PreviewMap::BestHeight() const {
    const auto [mins, maxs] = WorldBounds();
    float best = (mins.z + maxs.z) / 2;
    int most = 0;
    for (int level = 0; level < kHeights; level++) {
        const float height = Middle(mins.z, maxs.z, level, kHeights);
        int open = 0;
        for (int row = 0; row < kHeightSamples; row++)
            for (int column = 0; column < kHeightSamples; column++) {
                const Vec3f position(Middle(mins.x, maxs.x, column, kHeightSamples),
                                     Middle(mins.y, maxs.y, row, kHeightSamples), height);
                open += IsOverFloor(position) && IsOpen(position + Vec3f(0, 0, kRoom));
            }
        if (open > most)
            most = open, best = height;
    }
    return best;
}

Boundsf PreviewMap::OpenArea(float height) const {
    const auto [mins, maxs] = WorldBounds();
    Boundsf area;
    for (int row = 0; row < kAreaSamples; row++)
        for (int column = 0; column < kAreaSamples; column++) {
            const Vec3f position(Middle(mins.x, maxs.x, column, kAreaSamples),
                                 Middle(mins.y, maxs.y, row, kAreaSamples), height);
            if (IsOpen(position))
                area.Add(position);
        }
    if (area.Empty())
        return WorldBounds();
    const Vec3f cell = (maxs - mins) / float(kAreaSamples);
    return {area.mins - cell, area.maxs + cell};
}

std::vector<Vec3f> PreviewMap::Candidates() const {
    const auto [mins, maxs] = WorldBounds();
    std::vector<Vec3f> standing, open;
    for (int level = 0; level < kCandidateLevels; level++)
        for (int row = 0; row < kCandidateColumns; row++)
            for (int column = 0; column < kCandidateColumns; column++) {
                const Vec3f position(Middle(mins.x, maxs.x, column, kCandidateColumns),
                                     Middle(mins.y, maxs.y, row, kCandidateColumns),
                                     Middle(mins.z, maxs.z, level, kCandidateLevels));
                if (!IsOpen(position))
                    continue;
                open.push_back(position);
                if (HasRoom(position) && IsOverFloor(position))
                    standing.push_back(position);
            }
    return standing.empty() ? open : standing;
}

std::vector<Vec3f> PreviewMap::ChoosePlaces(std::size_t count,
                                            const std::function<float(const Vec3f &)> &strength) const {
    const std::vector<Vec3f> positions = Candidates();
    if (positions.empty())
        return {WorldBounds().Center()};
    std::vector<Candidate> candidates = Weigh(positions, strength);
    std::vector<Vec3f> chosen;
    // The first is the strongest, since all distances are alike.
    while (chosen.size() < std::min(count, candidates.size())) {
        const auto best = std::ranges::max_element(
            candidates, {}, [](const Candidate &c) { return std::min(c.distance, 1e18f) * c.weight; });
        chosen.push_back(best->position);
        for (Candidate &candidate : candidates)
            candidate.distance = std::min(candidate.distance, Length(candidate.position - chosen.back()));
    }
    std::ranges::sort(chosen, [](const Vec3f &a, const Vec3f &b) { return a.y != b.y ? a.y > b.y : a.x < b.x; });
    return chosen;
}

} // namespace q3
