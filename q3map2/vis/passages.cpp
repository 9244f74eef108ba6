// GPL-2.0-or-later. Passages: the portals that are seen through a pair of successive portals.
#include "q3map2/vis/passages.h"

#include "common/log.h"
#include "q3map2/vis/vis_parts.h"
#include "q3map2/vis/vis_winding.h"

#include <algorithm>
#include <atomic>

namespace q3 {

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
    /// Whether a part of a box may be in front of all planes. False: MaySee is false for all portals in it.
    bool MayReach(const PortalBounds &box) const {
        for (int i = 0; i < count; ++i)
            if (planes[i].Distance(box.center) + Reach(box, planes[i]) < 0)
                return false;
        return true;
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

/// Sets `scratch` to the portals that both rows have and that are seen through both portals.
void SeenThrough(const VisMap &map, const MightSeeTable &mightSee, std::size_t first, std::size_t second,
                 std::span<BitWord> scratch) {
    const PassagePlanes planes(map.Portal(first).winding, map.Portal(second).winding);
    std::ranges::fill(scratch, BitWord(0));
    const SparseBits &beyond = mightSee[second];
    mightSee[first].ForEachWord([&](std::size_t word, BitWord portals) {
        portals &= beyond.Word(word);
        if (portals == 0 || !planes.MayReach(map.BoundsOfWord(word)))
            return;
        ForEachBitOf(portals, [&](std::size_t bit) {
            if (planes.MaySee(map.Portal(map.PortalAt(kBitsPerWord * word + bit))))
                scratch[word] |= BitWord(1) << bit;
        });
    });
}

/// Clears the bits of a dense row that another row does not have.
void Intersect(const SparseBits &other, std::span<BitWord> dense) {
    for (std::size_t word = 0; word < dense.size(); ++word)
        if (dense[word] != 0)
            dense[word] &= other.Word(word);
}

/// Portals whose rows are made between two looks at the memory that they take. Constant, so that the rows that are left
/// out do not depend on the number of threads.
constexpr std::size_t kPassageChunk = 256;

std::size_t RowsOf(const VisMap &map, std::size_t p) {
    return map.Portal(p).removed ? 0 : map.PortalsAfter(p).size();
}

} // namespace

std::size_t Passages::NumRows(const VisMap &map) {
    return Passages(map).start_.back();
}

Passages::Passages(const VisMap &map) {
    start_.push_back(0);
    for (std::size_t p = 0; p < map.NumPortals(); ++p)
        start_.push_back(start_.back() + RowsOf(map, p));
}

Passages::Passages(const VisMap &map, SparseBitTable rows, std::size_t made) : Passages(map) {
    rows_ = std::move(rows);
    made_ = made;
}

Passages::Passages(const VisMap &map, const MightSeeTable &mightSee, std::uint64_t limit, const VisUnits &units,
                   const JobPool &jobs, Log &log)
    : Passages(map) {
    const std::size_t count = map.NumPortals();
    std::atomic<std::uint64_t> bytes = sizeof(SparseBits) * std::uint64_t(start_.back()); // before any row is made
    if (bytes >= limit)
        return;
    rows_ = SparseBitTable(start_.back(), jobs.Threads());
    const bool isPart = units.IsFirstPart();
    const std::vector<std::uint8_t> own = isPart ? OwnPortals(map, units) : std::vector<std::uint8_t>(count, 1);
    std::vector<std::vector<BitWord>> scratch(std::size_t(jobs.Threads()));
    const auto make = [&](std::size_t p, int worker) {
        const auto after = map.PortalsAfter(p);
        std::vector<BitWord> &dense = scratch[std::size_t(worker)];
        const std::size_t stride = units.HasStore() ? map.Words() : 0; // the store has all rows of a portal together
        dense.resize(units.HasStore() ? map.Words() * after.size() : map.Words());
        const bool known = units.FindPassages(p, dense);
        for (std::size_t next = 0; next < after.size(); ++next) {
            const auto t = std::size_t(after[next]);
            const std::span<BitWord> row(dense.data() + next * stride, map.Words());
            // A part did not know yet what symmetry has cleared.
            if (known) {
                Intersect(mightSee[p], row);
                Intersect(mightSee[t], row);
            } else {
                SeenThrough(map, mightSee, p, t, row);
            }
            rows_.Set(start_[p] + next, row, worker);
            bytes += rows_[start_[p] + next].Bytes() - sizeof(SparseBits);
        }
        if (isPart && !known)
            units.KeepPassages(p, dense);
    };
    Progress progress(log, std::int64_t(count));
    for (; made_ < count && bytes < limit; made_ = std::min(count, made_ + kPassageChunk))
        jobs.For(
            std::int64_t(std::min(count - made_, kPassageChunk)),
            [&](std::int64_t index, int worker) {
                const std::size_t p = made_ + std::size_t(index);
                if (!map.Portal(p).removed && own[p] != 0)
                    make(p, worker);
            },
            [&](std::int64_t done) { progress.Update(std::int64_t(made_) + done, 0); });
    progress.Finish();
}

void Passages::TightenMightSee(const VisMap &map, MightSeeTable &mightSee, const JobPool &jobs) const {
    constexpr int kRounds = 4; // later ones find little
    std::vector<std::vector<BitWord>> scratch(std::size_t(jobs.Threads()), std::vector<BitWord>(map.Words()));
    for (int round = 0; round < kRounds; ++round) {
        MightSeeTable tighter(map.NumPortals(), jobs.Threads());
        jobs.For(std::int64_t(map.NumPortals()), [&](std::int64_t index, int worker) {
            const auto p = std::size_t(index);
            if (map.Portal(p).removed)
                return;
            const std::span<BitWord> row = scratch[std::size_t(worker)];
            std::ranges::fill(row, BitWord(0));
            const auto after = map.PortalsAfter(p);
            for (std::size_t next = 0; next < after.size(); ++next) {
                const auto t = std::size_t(after[next]);
                if (!mightSee.Test(p, map.Column(t)))
                    continue;
                SetBit(row.data(), map.Column(t));
                const SparseBits &beyond = mightSee[t], *const passage = Row(p, next);
                const SparseBits &through = passage ? *passage : beyond;
                through.ForEachWord([&](std::size_t i, BitWord word) { row[i] |= word & beyond.Word(i); });
            }
            Intersect(mightSee[p], row);
            tighter.Set(p, row, worker);
        });
        mightSee = std::move(tighter);
        ApplySymmetry(map, jobs, mightSee);
    }
}

} // namespace q3
