// GPL-2.0-or-later. Portals in compact form, and the first passes over them: flood, symmetry.
#include "q3map2/vis/vis_map.h"

#include "common/log.h"
#include "common/simd.h"
#include "q3map2/vis/vis_parts.h"
#include "q3map2/vis/vis_winding.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

namespace q3 {

// ---- Portals in compact form, the flood and symmetry ----

namespace {

std::size_t Padded(std::size_t count) {
    return (count + kPointGroup - 1) / kPointGroup * kPointGroup;
}

double DistanceOf(const VisPlane &plane, const Vec3f &p) {
    return double(Dot(p, plane.normal)) - double(plane.dist);
}

/// Whether the far plane hides two portals from each other.
bool IsTooFar(const FarPlane &farPlane, const FlowPortal &p, const FlowPortal &t) {
    if (farPlane.distance <= 0 || p.sky || t.sky)
        return false;
    const Vec3f away = p.center - t.center;
    const double length = std::sqrt(double(Dot(away, away)));
    const double radii = double(p.radius) + double(t.radius);
    switch (farPlane.mode) {
    case FarPlaneMode::Origins:
        return length > farPlane.distance;
    case FarPlaneMode::Farthest:
        return length + radii > 2 * farPlane.distance;
    case FarPlaneMode::RadiusOnly:
        return radii > farPlane.distance;
    case FarPlaneMode::Nearest:
        break;
    }
    return length - radii > farPlane.distance;
}

/// Whether a point of `t` is in front of the plane (with sign -1: behind it) by more than kEpsilon.
bool AnyPointInFront(const VisPlane &plane, const FlowPortal &t, double sign) {
    constexpr double kEpsilon = 0.1; // game units
    for (int i = 0; i < t.winding.count; ++i)
        if (sign * DistanceOf(plane, t.winding.Point(i)) > kEpsilon)
            return true;
    return false;
}

/// What the bounding spheres of two portals say of FacesFrom.
enum Facing : std::uint8_t { kNever, kPerhaps, kAlways };

/// Whether a part of `t` is in front of `p` and a part of `p` is behind `t`.
bool FacesFrom(const FlowPortal &p, const FlowPortal &t) {
    return AnyPointInFront(p.plane, t, 1) && AnyPointInFront(t.plane, p, -1);
}

/// Planes and bounding spheres of all portals, as a structure of arrays.
struct PortalArrays {
    std::vector<float> x, y, z, radius, normalX, normalY, normalZ, dist;

    explicit PortalArrays(const VisMap &map) {
        for (std::size_t q = 0; q < map.NumPortals(); ++q) {
            const FlowPortal &t = map.Portal(q);
            x.push_back(t.center.x), y.push_back(t.center.y), z.push_back(t.center.z), radius.push_back(t.radius);
            normalX.push_back(t.plane.normal.x), normalY.push_back(t.plane.normal.y);
            normalZ.push_back(t.plane.normal.z), dist.push_back(t.plane.dist);
        }
    }
    /// Sets facing[q] for FacesFrom(p, q) of the portals in a range. A center is the mean of the points: if it is in
    /// front of a plane, some point is too.
    void Compare(const FlowPortal &p, std::size_t first, std::size_t end, std::uint8_t *facing) const {
        constexpr float kRounding = 0.5f; // game units: more than the float error of a distance
        const Vec3f n = p.plane.normal, c = p.center;
        const float planeDist = p.plane.dist, farBehind = -p.radius - kRounding, inFront = kOnEpsilon + kRounding;
        const float *const cx = x.data(), *const cy = y.data(), *const cz = z.data(), *const r = radius.data(),
                           *const nx = normalX.data(), *const ny = normalY.data(), *const nz = normalZ.data(),
                           *const d = dist.data();
        Vectorize([=]() Q3_INLINE {
            Q3_INDEPENDENT
            for (std::size_t q = first; q < end; ++q) {
                const float ahead = cx[q] * n.x + cy[q] * n.y + cz[q] * n.z - planeDist;
                const float behind = d[q] - (nx[q] * c.x + ny[q] * c.y + nz[q] * c.z);
                const bool never = (ahead < -r[q] - kRounding) | (behind < farBehind);
                const bool always = (ahead > inFront) & (behind > inFront);
                facing[q] = std::uint8_t(never ? kNever : always ? kAlways : kPerhaps);
            }
        });
    }
};

/// Storage of a worker for floods.
struct FloodScratch {
    std::vector<std::uint8_t> facing; ///< of kFloodTile portals, one after another: by portal
    std::vector<BitWord> seen, reached;
    std::vector<int> leafs;
};
/// Portals that are compared with all others at once, and those of the others that stay in the cache meanwhile.
constexpr std::size_t kFloodTile = 8, kFloodChunk = 512;

/// Sets mine.seen from what `facing` says of portal `from` and the others.
void FloodFrom(const VisMap &map, const FarPlane &farPlane, std::size_t from, const std::uint8_t *facing,
               FloodScratch &mine) {
    const FlowPortal &p = map.Portal(from);
    std::ranges::fill(mine.seen, BitWord(0));
    std::ranges::fill(mine.reached, BitWord(0));
    SetBit(mine.reached.data(), std::size_t(p.leaf));
    mine.leafs.assign(1, p.leaf);
    while (!mine.leafs.empty()) {
        const int leaf = mine.leafs.back();
        mine.leafs.pop_back();
        for (const int next : map.PortalsOf(leaf)) {
            const auto q = std::size_t(next);
            if (facing[q] == kNever || q == from)
                continue;
            const FlowPortal &t = map.Portal(q);
            if (IsTooFar(farPlane, p, t) || (facing[q] == kPerhaps && !FacesFrom(p, t)))
                continue;
            SetBit(mine.seen.data(), t.column);
            if (!TestBit(mine.reached.data(), std::size_t(t.leaf))) {
                SetBit(mine.reached.data(), std::size_t(t.leaf));
                mine.leafs.push_back(t.leaf);
            }
        }
    }
}

/// Transposes a 64 x 64 bit matrix (Warren, Hacker's Delight, 7-3).
void Transpose64(std::array<BitWord, 64> &block) {
    BitWord mask = 0x00000000ffffffffu;
    for (std::size_t step = 32; step != 0; step >>= 1, mask ^= mask << step)
        for (std::size_t k = 0; k < 64; k = (k + step + 1) & ~step) {
            const BitWord exchanged = (block[k] >> step ^ block[k + step]) & mask;
            block[k] ^= exchanged << step;
            block[k + step] ^= exchanged;
        }
}

PortalBounds BoundsOf(const VisMap &map, std::size_t word) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Vec3f low(kInfinity, kInfinity, kInfinity), high = -low;
    for (std::size_t column = kBitsPerWord * word; column < kBitsPerWord * (word + 1); ++column) {
        const WindingView winding = map.HasPortal(column) ? map.Portal(map.PortalAt(column)).winding : WindingView();
        for (int i = 0; i < winding.count; ++i)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], winding.Point(i)[axis]);
                high[axis] = std::max(high[axis], winding.Point(i)[axis]);
            }
    }
    return {(low + high) * 0.5f, (high - low) * 0.5f};
}

} // namespace

VisMap::VisMap(const PortalGraph &graph, bool widestFirst) {
    std::size_t floats = 0;
    for (const GraphPortal &portal : graph.portals)
        floats += portal.removed ? 0 : 3 * Padded(portal.winding.size());
    points_.reserve(floats); // windings point into it, so it must not reallocate
    for (std::size_t i = 0; i < graph.portals.size(); ++i) {
        const GraphPortal &portal = graph.portals[i], &twin = graph.portals[i ^ 1];
        FlowPortal flow;
        flow.plane = portal.plane, flow.center = portal.center, flow.radius = portal.radius;
        flow.leaf = portal.leaf, flow.sky = portal.sky, flow.removed = portal.removed;
        flow.hasTwin = !portal.removed && !twin.removed && !portal.joined && !twin.joined;
        if (!portal.removed) {
            const std::size_t count = portal.winding.size(), padded = Padded(count);
            const float *const at = points_.data() + points_.size();
            for (std::size_t axis = 0; axis < 3; ++axis)
                for (std::size_t k = 0; k < padded; ++k)
                    points_.push_back(portal.winding[k < count ? k : 0][axis]);
            flow.winding = {at, at + padded, at + 2 * padded, int(count)};
        }
        portals_.push_back(flow);
    }
    for (const GraphLeaf &leaf : graph.leafs) {
        leafFirst_.push_back(int(leafPortals_.size()));
        for (const int p : leaf.portals)
            if (!graph.portals[std::size_t(p)].removed)
                leafPortals_.push_back(p);
        // Wide portals first: what they show need not be searched again through narrow ones.
        if (widestFirst)
            std::stable_sort(leafPortals_.begin() + leafFirst_.back(), leafPortals_.end(), [&](int a, int b) {
                return portals_[std::size_t(a)].radius > portals_[std::size_t(b)].radius;
            });
    }
    leafFirst_.push_back(int(leafPortals_.size()));
    SetColumns();
}

void VisMap::SetColumns() {
    // By axis: the portals whose normals are closest to it. Of a portal and its twin, only the one that faces the
    // positive side.
    std::array<std::vector<std::size_t>, 3> facing;
    for (std::size_t p = 0; p < NumPortals(); p += 2) {
        const Vec3f n = portals_[p].plane.normal;
        const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
        const std::size_t axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
        facing[axis].push_back(n[axis] > 0 ? p : p + 1);
    }
    for (const std::vector<std::size_t> &group : facing) {
        const std::size_t first = portalAt_.size(), size = WordsOf(group.size()) * kBitsPerWord;
        portalAt_.resize(first + 2 * size, -1);
        for (std::size_t i = 0; i < group.size(); ++i) {
            const std::size_t p = group[i];
            portals_[p].column = std::uint32_t(first + i);
            portals_[p ^ 1].column = std::uint32_t(first + size + i);
            portalAt_[first + i] = int(p), portalAt_[first + size + i] = int(p ^ 1);
        }
        for (std::size_t word = 0; word < WordsOf(2 * size); ++word)
            twinWord_.push_back((first + (word * kBitsPerWord + size) % std::max<std::size_t>(1, 2 * size)) /
                                kBitsPerWord);
    }
    const std::size_t block = BlockWordsOf(Words()) * kBitsPerWord;
    portalAt_.resize((Columns() + block - 1) / block * block, -1);
    while (twinWord_.size() < Words())
        twinWord_.push_back(twinWord_.size());
    for (std::size_t word = 0; word < Words(); ++word)
        bounds_.push_back(BoundsOf(*this, word));
}

std::vector<std::uint8_t> OwnPortals(const VisMap &map, const VisUnits &units) {
    std::vector<double> costs(map.NumPortals());
    for (std::size_t p = 0; p < costs.size(); ++p)
        costs[p] = map.Portal(p).removed ? 0 : double(map.PortalsAfter(p).size());
    return units.Own(costs, UnitStore::Division::Ranges);
}

namespace {

/// The portals whose rows of the flood a part of the first round needs.
std::vector<std::uint8_t> FloodedPortals(const VisMap &map, const VisUnits &units) {
    const std::vector<std::uint8_t> own = OwnPortals(map, units);
    std::vector<std::uint8_t> flooded = own;
    for (std::size_t p = 0; p < own.size(); ++p)
        if (own[p] != 0 && !map.Portal(p).removed)
            for (const int next : map.PortalsAfter(p))
                flooded[std::size_t(next)] = 1;
    return flooded;
}

} // namespace

MightSeeTable FloodMightSee(const VisMap &map, const FarPlane &farPlane, const VisUnits &units, const JobPool &jobs,
                            Log &log) {
    const std::size_t count = map.NumPortals();
    MightSeeTable mightSee(count, jobs.Threads());
    const PortalArrays arrays(map);
    std::vector<FloodScratch> scratch(std::size_t(jobs.Threads()));
    for (FloodScratch &one : scratch) {
        one.facing.resize(kFloodTile * count);
        one.seen.resize(map.Words());
        one.reached.resize(WordsOf(map.NumLeafs()));
    }
    const bool isPart = units.IsFirstPart();
    const std::vector<std::uint8_t> own = isPart ? OwnPortals(map, units) : std::vector<std::uint8_t>(),
                                    wanted = isPart ? FloodedPortals(map, units) : std::vector<std::uint8_t>(count, 1);
    const auto flood = [&](std::size_t p, const std::uint8_t *facing, FloodScratch &mine, int worker) {
        FloodFrom(map, farPlane, p, facing, mine);
        if (isPart && own[p] != 0)
            units.Keep(VisUnits::Row::Flood, p, mine.seen);
        mightSee.Set(p, mine.seen, worker);
    };
    const std::size_t tiles = (count + kFloodTile - 1) / kFloodTile;
    Progress progress(log, std::int64_t(tiles));
    jobs.For(
        std::int64_t(tiles),
        [&](std::int64_t index, int worker) {
            FloodScratch &mine = scratch[std::size_t(worker)];
            std::vector<std::size_t> portals;
            const std::size_t tile = kFloodTile * std::size_t(index);
            for (std::size_t p = tile; p < std::min(count, tile + kFloodTile); ++p) {
                if (map.Portal(p).removed || wanted[p] == 0)
                    continue;
                if (units.Find(VisUnits::Row::Flood, p, mine.seen))
                    mightSee.Set(p, mine.seen, worker);
                else
                    portals.push_back(p);
            }
            for (std::size_t first = 0; first < count; first += kFloodChunk)
                for (std::size_t i = 0; i < portals.size(); ++i)
                    arrays.Compare(map.Portal(portals[i]), first, std::min(count, first + kFloodChunk),
                                   mine.facing.data() + i * count);
            for (std::size_t i = 0; i < portals.size(); ++i)
                flood(portals[i], mine.facing.data() + i * count, mine, worker);
        },
        [&](std::int64_t done) { progress.Update(done, 0); });
    progress.Finish();
    return mightSee;
}

void ApplySymmetry(const VisMap &map, const JobPool &jobs, MightSeeTable &mightSee) {
    const std::size_t words = map.Words();
    std::vector<BitWord> twins(words);
    for (std::size_t p = 0; p < map.NumPortals(); ++p)
        if (map.Portal(p).hasTwin)
            SetBit(twins.data(), map.Column(p));
    // Compares the bit of q in row p with that of p ^ 1 in row q ^ 1: each block of 64 rows, in the order of columns,
    // and 64 columns with its mirror image. False: all of its bits are 0.
    const auto load = [&](std::size_t rows, std::size_t word, std::array<BitWord, 64> &into) {
        BitWord any = 0;
        for (std::size_t k = 0; k < 64; ++k) {
            const std::size_t column = 64 * rows + k;
            any |= into[k] = map.HasPortal(column) ? mightSee[map.PortalAt(column)].Word(word) : 0;
        }
        return any != 0;
    };
    const auto restrict = [&](std::size_t rows, std::size_t word, const std::array<BitWord, 64> &by) {
        for (std::size_t k = 0; k < 64; ++k)
            if (TestBit(twins.data(), 64 * rows + k))
                if (BitWord *const bits = mightSee[map.PortalAt(64 * rows + k)].Find(word))
                    *bits &= by[k] | ~twins[word];
    };
    jobs.For(std::int64_t(words), [&](std::int64_t index, int) {
        std::array<BitWord, 64> block, across;
        const auto rows = std::size_t(index);
        for (std::size_t word = 0; word < words; ++word) {
            const std::size_t mirrorRows = map.TwinWord(word), mirrorWord = map.TwinWord(rows);
            // Of each pair of blocks, the one that comes first; a block may be its own mirror image.
            if (std::pair(mirrorRows, mirrorWord) < std::pair(rows, word))
                continue;
            const bool hasBlock = load(rows, word, block), hasAcross = load(mirrorRows, mirrorWord, across);
            if (!hasBlock && !hasAcross)
                continue;
            Transpose64(block);
            Transpose64(across);
            if (hasBlock)
                restrict(rows, word, across);
            if (hasAcross)
                restrict(mirrorRows, mirrorWord, block);
        }
    });
}

std::vector<int> OrderPortals(const VisMap &map, const MightSeeTable &mightSee, bool sorted) {
    std::vector<int> order(map.NumPortals());
    std::iota(order.begin(), order.end(), 0);
    if (!sorted)
        return order;
    std::vector<std::size_t> cost(order.size());
    for (std::size_t p = 0; p < cost.size(); ++p)
        cost[p] = mightSee[p].Count();
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return cost[std::size_t(a)] < cost[std::size_t(b)]; });
    return order;
}

} // namespace q3
