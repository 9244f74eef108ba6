// GPL-2.0-or-later. Portals in compact form, and the passes over them: flood, passages, symmetry.
#include "q3map2/vis/vis_map.h"

#include "common/log.h"
#include "q3map2/vis/vis_parts.h"
#include "q3map2/vis/vis_winding.h"

#include <algorithm>
#include <array>
#include <numeric>

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

/// AnyPointInFront, decided for most portals by the bounding sphere. The center is the mean of the points: if it is in
/// front, some point is too.
inline bool ReachesFront(const VisPlane &plane, const FlowPortal &t, float sign) {
    constexpr float kRounding = 0.5f; // game units: more than the float error of the distance of the center
    const float center = sign * plane.Distance(t.center);
    if (center > kOnEpsilon + kRounding)
        return true;
    return center >= -t.radius - kRounding && AnyPointInFront(plane, t, double(sign));
}

void FloodFrom(const VisMap &map, const FarPlane &farPlane, std::size_t from, BitWord *seen, BitTable &tested,
               std::vector<int> &leafs) {
    const FlowPortal &p = map.Portal(from);
    std::fill_n(tested.Row(0), tested.Words(), BitWord(0));
    leafs.assign(1, p.leaf);
    while (!leafs.empty()) {
        const int leaf = leafs.back();
        leafs.pop_back();
        for (const int next : map.PortalsOf(leaf)) {
            const auto q = std::size_t(next);
            if (TestBit(tested.Row(0), q))
                continue;
            SetBit(tested.Row(0), q);
            const FlowPortal &t = map.Portal(q);
            if (q == from || IsTooFar(farPlane, p, t) || !ReachesFront(p.plane, t, 1) || !ReachesFront(t.plane, p, -1))
                continue;
            SetBit(seen, q);
            leafs.push_back(t.leaf);
        }
    }
}

/// Swaps bits 2 i and 2 i + 1, which belong to a portal and its twin.
BitWord SwapPairs(BitWord word) {
    constexpr BitWord kEven = 0x5555555555555555u;
    return (word & kEven) << 1 | (word >> 1 & kEven);
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
    MightSeeTable mightSee(count, count);
    struct Scratch {
        BitTable tested;
        std::vector<int> leafs;
    };
    std::vector<Scratch> scratch(std::size_t(jobs.Threads()));
    for (Scratch &one : scratch)
        one.tested = BitTable(1, count);
    const bool isPart = units.IsFirstPart();
    const std::vector<std::uint8_t> own = isPart ? OwnPortals(map, units) : std::vector<std::uint8_t>(),
                                    wanted = isPart ? FloodedPortals(map, units) : std::vector<std::uint8_t>(count, 1);
    Progress progress(log, std::int64_t(count));
    jobs.For(
        std::int64_t(count),
        [&](std::int64_t index, int worker) {
            const auto p = std::size_t(index);
            Scratch &mine = scratch[std::size_t(worker)];
            if (map.Portal(p).removed || wanted[p] == 0 ||
                units.Find(VisUnits::Row::Flood, p, {mightSee.Row(p), mightSee.Words()}))
                return;
            FloodFrom(map, farPlane, p, mightSee.Row(p), mine.tested, mine.leafs);
            if (isPart && own[p] != 0)
                units.Keep(VisUnits::Row::Flood, p, mightSee.Bits(p));
        },
        [&](std::int64_t done) { progress.Update(done, 0); });
    progress.Finish();
    return mightSee;
}

void ApplySymmetry(const VisMap &map, const JobPool &jobs, MightSeeTable &mightSee) {
    const std::size_t count = map.NumPortals(), words = mightSee.Words();
    std::vector<BitWord> twins(words);
    for (std::size_t p = 0; p < count; ++p)
        if (map.Portal(p).hasTwin)
            SetBit(twins.data(), p);
    // Compares bit q of row p with bit p ^ 1 of row q ^ 1: each block of 64 x 64 bits with its mirror image.
    const auto load = [&](std::size_t row, std::size_t word, std::array<BitWord, 64> &into) {
        for (std::size_t k = 0; k < 64; ++k)
            into[k] = 64 * row + k < count ? mightSee.Row(64 * row + k)[word] : 0;
    };
    const auto restrict = [&](std::size_t row, std::size_t word, const std::array<BitWord, 64> &by) {
        for (std::size_t k = 0; k < 64 && 64 * row + k < count; ++k)
            if (TestBit(twins.data(), 64 * row + k))
                mightSee.Row(64 * row + k)[word] &= SwapPairs(by[k ^ 1]) | ~twins[word];
    };
    jobs.For(std::int64_t(words), [&](std::int64_t index, int) {
        std::array<BitWord, 64> block, across;
        const auto row = std::size_t(index);
        for (std::size_t word = row; word < words; ++word) {
            load(row, word, block);
            load(word, row, across);
            Transpose64(block);
            Transpose64(across);
            restrict(row, word, across);
            restrict(word, row, block);
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
        cost[p] = CountBits(mightSee.Bits(p));
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return cost[std::size_t(a)] < cost[std::size_t(b)]; });
    return order;
}

// ---- Passages: the portals seen through a pair of consecutive portals ----

namespace {

constexpr int kMaxPlanes = 64; ///< with fewer planes more is seen, which is safe

/// Separators of a pair of consecutive portals: the region seen through both is in front of all of them.
struct PassagePlanes {
    VisPlane planes[kMaxPlanes];
    int count = 0;

    PassagePlanes(const WindingView &first, const WindingView &second) {
        AddSeparators(first, second, InFront::T);
        AddSeparators(second, first, InFront::S);
    }
    void AddSeparators(const WindingView &s, const WindingView &t, InFront inFront) {
        for (int edge = 0; edge < s.count && count < kMaxPlanes; ++edge)
            count += SeparatorOfEdge(s, t, edge, inFront, planes[count]);
    }
    /// Whether a part of the portal is in front of all planes.
    bool MaySee(const FlowPortal &q) const {
        WindingBuffer buffers[2];
        const VisPlane *cutting[kMaxPlanes];
        int cuts = 0;
        for (int i = 0; i < count; ++i) {
            const float d = planes[i].Distance(q.center);
            if (d < -q.radius + kOnEpsilon)
                return false;
            if (d <= q.radius)
                cutting[cuts++] = &planes[i];
        }
        for (int i = 0; i < cuts; ++i)
            if (PointDistances(q.winding, *cutting[i]).max < kOnEpsilon)
                return false;
        WindingView winding = q.winding;
        for (int i = 0; i < cuts; ++i)
            if (!ChopInFront(winding, *cutting[i], buffers[i & 1]))
                return false;
        return true;
    }
};

} // namespace

std::uint64_t Passages::BytesFor(const VisMap &map) {
    std::uint64_t rows = 0;
    for (std::size_t p = 0; p < map.NumPortals(); ++p)
        rows += map.Portal(p).removed ? 0 : map.PortalsAfter(p).size();
    return rows * WordsOf(map.NumPortals()) * sizeof(BitWord);
}

Passages::Passages(const VisMap &map) {
    const std::size_t count = map.NumPortals();
    start_.resize(count);
    std::size_t rows = 0;
    for (std::size_t p = 0; p < count; ++p) {
        start_[p] = rows;
        rows += map.Portal(p).removed ? 0 : map.PortalsAfter(p).size();
    }
    rows_ = rows, words_ = WordsOf(count);
    // Workers set their rows first: the system gives each the memory that it uses.
    table_ = std::make_unique_for_overwrite<BitWord[]>(rows_ * words_);
}

/// Makes the rows of a portal.
void Passages::Make(const VisMap &map, const MightSeeTable &mightSee, std::size_t p) {
    const auto after = map.PortalsAfter(p);
    for (std::size_t next = 0; next < after.size(); ++next) {
        const auto t = std::size_t(after[next]);
        BitWord *const row = &table_[(start_[p] + next) * words_];
        const BitWord *const a = mightSee.Row(p), *const b = mightSee.Row(t);
        for (std::size_t i = 0; i < words_; ++i)
            row[i] = a[i] & b[i];
        const PassagePlanes planes(map.Portal(p).winding, map.Portal(t).winding);
        ForEachBit(std::span<const BitWord>(row, words_), [&](std::size_t q) {
            if (!planes.MaySee(map.Portal(q)))
                ClearBit(row, q);
        });
    }
}

Passages::Passages(const VisMap &map, const MightSeeTable &mightSee, const VisUnits &units, const JobPool &jobs,
                   Log &log)
    : Passages(map) {
    const std::size_t count = map.NumPortals();
    const bool isPart = units.IsFirstPart();
    const std::vector<std::uint8_t> own = isPart ? OwnPortals(map, units) : std::vector<std::uint8_t>(count, 1);
    Progress progress(log, std::int64_t(count));
    jobs.For(
        std::int64_t(count),
        [&](std::int64_t index, int) {
            const auto p = std::size_t(index);
            if (map.Portal(p).removed || own[p] == 0)
                return;
            const auto after = map.PortalsAfter(p);
            const std::span<BitWord> rows(table_.get() + start_[p] * words_, after.size() * words_);
            if (!units.Find(VisUnits::Row::Passage, p, rows)) {
                Make(map, mightSee, p);
                if (isPart)
                    units.Keep(VisUnits::Row::Passage, p, rows);
                return;
            }
            // The part did not know yet what symmetry has cleared.
            for (std::size_t next = 0; next < after.size(); ++next)
                for (std::size_t i = 0; i < words_; ++i)
                    rows[next * words_ + i] &= mightSee.Row(p)[i] & mightSee.Row(std::size_t(after[next]))[i];
        },
        [&](std::int64_t done) { progress.Update(done, 0); });
    progress.Finish();
}

void Passages::TightenMightSee(const VisMap &map, MightSeeTable &mightSee, const JobPool &jobs) const {
    constexpr int kRounds = 4; // later ones find little
    const std::size_t words = mightSee.Words();
    for (int round = 0; round < kRounds; ++round) {
        const MightSeeTable before = mightSee;
        jobs.For(std::int64_t(map.NumPortals()), [&](std::int64_t index, int) {
            const auto p = std::size_t(index);
            if (map.Portal(p).removed)
                return;
            BitWord *const row = mightSee.Row(p);
            std::fill_n(row, words, BitWord(0));
            const auto after = map.PortalsAfter(p);
            for (std::size_t next = 0; next < after.size(); ++next) {
                const auto t = std::size_t(after[next]);
                if (!before.Test(p, t))
                    continue;
                SetBit(row, t);
                const BitWord *const through = Row(p, next), *const beyond = before.Row(t);
                for (std::size_t i = 0; i < words; ++i)
                    row[i] |= through[i] & beyond[i];
            }
            for (std::size_t i = 0; i < words; ++i)
                row[i] &= before.Row(p)[i];
        });
        ApplySymmetry(map, jobs, mightSee);
    }
}

} // namespace q3
