// GPL-2.0-or-later. Where and what a picture of light grids shows: open positions of a map, and the light of its grids
// there.
#include "q3map2/convert/preview/grid_preview_map.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/light_keys.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

namespace q3 {

// ---- Cells of the sparse SH grid by position ----

std::optional<SparseCell> SparseCellAt(const SparseGridSH &grid, const Vec3f &position) {
    SparseCell cell;
    std::size_t root = 0, stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at = (double(position[axis]) - double(grid.mins[axis])) / double(grid.cell[axis]);
        if (!(at >= 0 && at < double(grid.roots[axis] << grid.levels)))
            return std::nullopt;
        cell.low[axis] = std::int32_t(at);
        root += stride * std::size_t(cell.low[axis] >> grid.levels);
        stride *= std::size_t(grid.roots[axis]);
    }
    // A node's octants are nodes or cells. `inner` has the bit of each that is a node; these are stored in a row.
    const SparseGridNode *node = &grid.nodes[root];
    for (cell.size = grid.levels - 1;; --cell.size) {
        const auto bit = [&](std::size_t axis) { return unsigned(cell.low[axis] >> cell.size & 1); };
        const unsigned octant = bit(0) | bit(1) << 1 | bit(2) << 2, lowerOctants = (1u << octant) - 1;
        if ((node->inner >> octant & 1) == 0)
            break;
        node = &grid.nodes[node->children + std::size_t(std::popcount(node->inner & lowerOctants))];
    }
    for (std::int32_t &low : cell.low)
        low = low >> cell.size << cell.size;
    return cell;
}

Vec3f SparseCellColor(int size) {
    static constexpr std::array<Vec3f, 6> kColors = {Vec3f{1, 0.3f, 0.25f}, {1, 0.75f, 0.2f}, {0.45f, 0.9f, 0.3f},
                                                     {0.25f, 0.85f, 0.9f},  {0.35f, 0.5f, 1}, {0.8f, 0.45f, 1}};
    return kColors[std::size_t(size) % kColors.size()];
}

// ---- What the two light grids of a map show at a position ----

namespace {

constexpr float kRenormalizeBelow = 0.99f; ///< engines renormalize only smaller sums of weights

/// The unit direction that a point of the legacy grid stores as two angles in bytes.
Vec3f DirectionOf(const bspGridPoint_t &point) {
    constexpr float step = 2 * std::numbers::pi_v<float> / 256; // radians
    const float polar = float(point.latLong[0]) * step, around = float(point.latLong[1]) * step;
    return {std::cos(around) * std::sin(polar), std::sin(around) * std::sin(polar), std::cos(polar)};
}

Vec3f FromBytes(const std::array<std::uint8_t, 3> &bytes) {
    return Vec3f(float(bytes[0]), float(bytes[1]), float(bytes[2])) / 255.0f;
}

} // namespace

SHPreview::SHPreview(const Bsp &bsp) {
    if (bsp.namedGridSH) {
        lump_ = EncodeNamedGrid(*bsp.namedGridSH);
        grid_ = SparseReader(lump_);
    } else if (bsp.sparseGridSH) {
        lump_ = EncodeSparseGrid(*bsp.sparseGridSH);
        grid_ = SparseReader(lump_);
    } else if (bsp.gridSH && !bsp.gridSH->points.empty()) {
        grid_ = UniformReader(*bsp.gridSH);
    } else {
        throw Error("the map has no SH light grid to show: light it with -sh first");
    }
    const Entity world = StoredWorld(bsp.entities);
    needsConvolution_ = world.Value(kGridSHKey) == kRadiance;
    shgrid_tone tone;
    if (world.Has(kToneKey) && shgrid_parse_tone(std::string(world.Value(kToneKey)).c_str(), &tone) == SHGRID_OK)
        tone_ = tone;
}

SHSample SHPreview::At(const Vec3f &position) const {
    const float at[3] = {position.x, position.y, position.z};
    SHSample sample{{}, tone_};
    shgrid_lights(&grid_, at, nullptr, &sample.lighting);
    if (needsConvolution_)
        shgrid_convolve(&sample.lighting.rest);
    return sample;
}

Vec3f LightOn(const SHSample &sample, const Vec3f &normal) {
    const float along[3] = {normal.x, normal.y, normal.z};
    float rgb[3];
    shgrid_shade(&sample.lighting, along, rgb);
    if (sample.tone)
        shgrid_apply_tone(&*sample.tone, rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

Vec3f LightOn(const LegacySample &sample, const Vec3f &normal) {
    return sample.ambient + sample.directed * std::max(0.0f, Dot(normal, sample.direction));
}

std::optional<LegacyPreview> LegacyPreview::Make(const Bsp &bsp) {
    LegacyPreview preview;
    const auto given = keys::kGridSize.Vector(StoredWorld(bsp.entities));
    const Float3 size = given ? given->Array() : kDefaultGridSize;
    try {
        preview.layout_ = LayoutGrid(bsp.models[0].mins, bsp.models[0].maxs, size);
    } catch (const Error &) {
        return std::nullopt; // ReadBsp has warned
    }
    if (bsp.gridPoints.empty() || preview.layout_.Count() != std::int64_t(bsp.gridPoints.size()))
        return std::nullopt;
    preview.points_ = bsp.gridPoints;
    return preview;
}

LegacySample LegacyPreview::At(const Vec3f &position) const {
    std::array<int, 3> low;
    Vec3f fraction;
    for (std::size_t axis = 0; axis < 3; axis++) {
        const float last = float(layout_.bounds[axis] - 1);
        const float at = (position[axis] - layout_.mins[axis]) / layout_.size[axis];
        const float cell = std::clamp(std::floor(at), 0.0f, last);
        low[axis] = std::min(int(cell), layout_.bounds[axis] - 1);
        fraction[axis] = std::clamp(at - cell, 0.0f, 1.0f);
    }
    LegacySample sum;
    float total = 0;
    for (unsigned corner = 0; corner < 8; corner++) {
        float weight = 1;
        std::int64_t index = 0, stride = 1;
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; axis++) {
            const bool upper = corner >> axis & 1;
            inside = inside && low[axis] + upper < layout_.bounds[axis];
            weight *= upper ? fraction[axis] : 1 - fraction[axis];
            index += stride * (low[axis] + upper);
            stride *= layout_.bounds[axis];
        }
        if (!inside)
            continue;
        const bspGridPoint_t &point = points_[std::size_t(index)];
        if (point.ambient[0] == std::array<std::uint8_t, 3>{}) // inside a wall
            continue;
        total += weight;
        sum.ambient += FromBytes(point.ambient[0]) * weight;
        sum.directed += FromBytes(point.directed[0]) * weight;
        sum.direction += DirectionOf(point) * weight;
    }
    if (total > 0 && total < kRenormalizeBelow) {
        sum.ambient = sum.ambient / total;
        sum.directed = sum.directed / total;
    }
    sum.direction = Normalize(sum.direction);
    return sum;
}

// ---- Open space of a map, and sample positions in it ----

namespace {

constexpr std::uint32_t kContentsSolid = 1, kSurfSky = 4, kRbspSurfSky = 0x2000; ///< CONTENTS_SOLID, SURF_SKY
constexpr std::int32_t kTopSide = 5;        ///< number of the brush side that faces up
constexpr std::int32_t kPlaneBudget = 4096; ///< planes tested per position, so that damaged brush lists stay cheap
constexpr Vec3f kWorldLimit{131072, 131072, 131072}; ///< coordinates that engines allow
constexpr float kFloorDepth = 128, kFloorStep = 16;  ///< range and step of the search for a floor, game units
constexpr float kClearance = 24;                     ///< free distance around a position, game units
constexpr int kHeights = 96, kHeightSamples = 64;    ///< heights that are compared, and probes of each, per axis
constexpr int kAreaSamples = 256;                    ///< probes of the open area, per axis
constexpr int kCandidateColumns = 40, kCandidateLevels = 24; ///< possible positions, per horizontal axis and along z
constexpr std::array<std::string_view, 6> kPlaceClasses = {"info_player_", "team_", "item_",
                                                           "weapon_",      "ammo_", "holdable_"};
constexpr Vec3f kPlayMargin{384, 384, 160}; ///< around entities of these classes, game units
constexpr float kBaseWeight = 0.6f;         ///< weight of a dark position; light adds up to 1
constexpr float kFarthest = 1e18f;          ///< distance that counts where no position is chosen yet

/// Middle of cell i of n between two bounds.
float Middle(float low, float high, int i, int n) {
    return low + (high - low) * ((float(i) + 0.5f) / float(n));
}

/// Bounds of the world model, clipped to kWorldLimit and at least one unit wide.
Boundsf WorldBounds(const Bsp &bsp) {
    Boundsf bounds{Max(Vec3f(bsp.models[0].mins), -kWorldLimit), Min(Vec3f(bsp.models[0].maxs), kWorldLimit)};
    for (std::size_t axis = 0; axis < 3; axis++)
        if (bounds.maxs[axis] - bounds.mins[axis] < 1) {
            bounds.mins[axis] = std::min(bounds.mins[axis], kWorldLimit[axis] - 1);
            bounds.maxs[axis] = bounds.mins[axis] + 1;
        }
    return bounds;
}

/// Positions of player starts and items.
std::vector<Vec3f> Places(const Bsp &bsp) {
    std::vector<Vec3f> places;
    try {
        for (const Entity &entity : ParseEntities(bsp.entities, "entities")) {
            const auto isPlace = [&](std::string_view prefix) { return StartsWithNoCase(entity.ClassName(), prefix); };
            const auto origin = entity.Vector({"origin"});
            if (origin && std::ranges::any_of(kPlaceClasses, isPlace))
                places.push_back(*origin);
        }
    } catch (const Error &) { // ReadBsp has warned
    }
    return places;
}

/// Clusters that a place sees; empty without places in the open, or without visibility data.
std::vector<bool> ClustersSeenFrom(const Bsp &bsp, const std::vector<Vec3f> &places) {
    constexpr std::size_t kHead = 8; // the numbers of clusters and of bytes in a row
    if (bsp.visibility.size() < kHead)
        return {};
    std::array<std::int32_t, 2> head;
    std::memcpy(head.data(), bsp.visibility.data(), kHead);
    std::vector<bool> seen(static_cast<std::size_t>(head[0]));
    bool any = false;
    for (const Vec3f &place : places) {
        const std::int32_t cluster = bsp.leafs[std::size_t(LeafAt(bsp, place))].cluster;
        if (cluster < 0)
            continue;
        any = true;
        const std::uint8_t *row = bsp.visibility.data() + kHead + std::size_t(cluster) * std::size_t(head[1]);
        for (std::size_t other = 0; other < seen.size(); other++)
            if (row[other / 8] >> (other % 8) & 1)
                seen[other] = true;
    }
    return any ? seen : std::vector<bool>{};
}

/// The box of player starts and items with kPlayMargin around it; that of the world if there are none.
Boundsf PlaySpace(const Bsp &bsp) {
    const Boundsf world = WorldBounds(bsp);
    Boundsf entities;
    for (const Vec3f &place : Places(bsp))
        entities.Add(place);
    if (entities.Empty())
        return world;
    const Boundsf space{Max(world.mins, entities.mins - kPlayMargin), Min(world.maxs, entities.maxs + kPlayMargin)};
    return space.Empty() ? world : space;
}

struct Candidate {
    Vec3f position;
    float weight = 0;
    float distance = std::numeric_limits<float>::max(); ///< to the nearest chosen one
};

/// Positions with their weights: kBaseWeight + min(1, strength / upper quartile of all strengths).
std::vector<Candidate> Weigh(const std::vector<Vec3f> &positions, const std::function<float(const Vec3f &)> &strength) {
    std::vector<Candidate> candidates;
    std::vector<float> sorted;
    for (const Vec3f &position : positions) {
        candidates.push_back({position, strength(position)});
        sorted.push_back(candidates.back().weight);
    }
    const auto high = sorted.begin() + std::ptrdiff_t(sorted.size() * 3 / 4);
    std::nth_element(sorted.begin(), high, sorted.end());
    const float strong = *high;
    for (Candidate &candidate : candidates)
        candidate.weight = kBaseWeight + (strong > 0 ? std::min(1.0f, candidate.weight / strong) : 0);
    return candidates;
}

} // namespace

PreviewMap::PreviewMap(const Bsp &bsp)
    : bsp_(bsp), seenByPlayers_(ClustersSeenFrom(bsp, Places(bsp))), space_(PlaySpace(bsp)) {}

bool PreviewMap::InBrush(const bspBrush_t &brush, const Vec3f &position, std::int32_t &budget) const {
    if (!(bsp_.shaders[std::size_t(brush.shaderNum)].contentFlags & kContentsSolid))
        return false;
    for (std::int32_t side = 0; side < brush.numSides; side++) {
        const auto plane = std::size_t(bsp_.brushSides[std::size_t(brush.firstSide + side)].planeNum);
        if (--budget < 0 || Dot(Vec3f(bsp_.planes[plane].normal), position) - bsp_.planes[plane].dist > 0)
            return false;
    }
    return true;
}

const bspLeaf_t &PreviewMap::LeafAt(const Vec3f &position) const {
    return bsp_.leafs[std::size_t(q3::LeafAt(bsp_, position))];
}

const bspBrush_t *PreviewMap::BrushAt(const bspLeaf_t &leaf, const Vec3f &position) const {
    std::int32_t budget = kPlaneBudget;
    for (std::int32_t i = 0; i < std::min(leaf.numBSPLeafBrushes, kPlaneBudget); i++) {
        const auto number = std::size_t(bsp_.leafBrushes[std::size_t(leaf.firstBSPLeafBrush + i)]);
        if (InBrush(bsp_.brushes[number], position, budget))
            return &bsp_.brushes[number];
    }
    return nullptr;
}

bool PreviewMap::IsOpen(const Vec3f &position) const {
    const bspLeaf_t &leaf = LeafAt(position);
    if (leaf.cluster < 0 || (!seenByPlayers_.empty() && !seenByPlayers_[std::size_t(leaf.cluster)]))
        return false;
    return !BrushAt(leaf, position);
}

bool PreviewMap::IsOverFloor(const Vec3f &position) const {
    if (!IsOpen(position))
        return false;
    for (float down = kFloorStep; down <= kFloorDepth; down += kFloorStep) {
        const Vec3f below = position - Vec3f(0, 0, down);
        const bspLeaf_t &leaf = LeafAt(below);
        const bspBrush_t *brush = BrushAt(leaf, below);
        if (!brush && leaf.cluster >= 0)
            continue;
        if (!brush)
            return true;
        const auto top = std::size_t(bsp_.brushSides[std::size_t(brush->firstSide + kTopSide)].shaderNum);
        return !(bsp_.shaders[top].surfaceFlags & (bsp_.ident == kRbspIdent ? kRbspSurfSky : kSurfSky));
    }
    return false;
}

bool PreviewMap::HasClearance(const Vec3f &position) const {
    for (std::size_t axis = 0; axis < 3; axis++)
        for (const float side : {-kClearance, kClearance}) {
            Vec3f beside = position;
            beside[axis] += side;
            if (!IsOpen(beside))
                return false;
        }
    return true;
}

float PreviewMap::BestHeight() const {
    const auto [mins, maxs] = space_;
    float best = (mins.z + maxs.z) / 2;
    int most = 0;
    for (int level = 0; level < kHeights; level++) {
        const float height = Middle(mins.z, maxs.z, level, kHeights);
        int open = 0;
        for (int row = 0; row < kHeightSamples; row++)
            for (int column = 0; column < kHeightSamples; column++) {
                const Vec3f position(Middle(mins.x, maxs.x, column, kHeightSamples),
                                     Middle(mins.y, maxs.y, row, kHeightSamples), height);
                open += IsOverFloor(position) && IsOpen(position + Vec3f(0, 0, kClearance));
            }
        if (open > most)
            most = open, best = height;
    }
    return best;
}

Boundsf PreviewMap::OpenArea(float height) const {
    const auto [mins, maxs] = space_;
    Boundsf area;
    for (int row = 0; row < kAreaSamples; row++)
        for (int column = 0; column < kAreaSamples; column++) {
            const Vec3f position(Middle(mins.x, maxs.x, column, kAreaSamples),
                                 Middle(mins.y, maxs.y, row, kAreaSamples), height);
            if (IsOpen(position))
                area.Add(position);
        }
    if (area.Empty())
        return space_;
    const Vec3f cell = (maxs - mins) / float(kAreaSamples);
    return {area.mins - cell, area.maxs + cell};
}

std::vector<Vec3f> PreviewMap::Candidates() const {
    const auto [mins, maxs] = space_;
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
                if (HasClearance(position) && IsOverFloor(position))
                    standing.push_back(position);
            }
    return standing.empty() ? open : standing;
}

std::vector<Vec3f> PreviewMap::ChoosePositions(std::size_t count,
                                               const std::function<float(const Vec3f &)> &strength) const {
    const std::vector<Vec3f> positions = Candidates();
    if (positions.empty())
        return {space_.Center()};
    std::vector<Candidate> candidates = Weigh(positions, strength);
    std::vector<Vec3f> chosen;
    // Weighted farthest-point sampling. The first choice goes by weight alone, since all distances are alike.
    while (chosen.size() < std::min(count, candidates.size())) {
        const auto best = std::ranges::max_element(
            candidates, {}, [](const Candidate &c) { return std::min(c.distance, kFarthest) * c.weight; });
        chosen.push_back(best->position);
        for (Candidate &candidate : candidates)
            candidate.distance = std::min(candidate.distance, Length(candidate.position - chosen.back()));
    }
    std::ranges::stable_sort(chosen, [](const Vec3f &a, const Vec3f &b) { return a.y != b.y ? a.y > b.y : a.x < b.x; });
    return chosen;
}

} // namespace q3
