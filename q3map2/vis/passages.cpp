// GPL-2.0-or-later. Passages: the portals seen through a pair of consecutive portals.
#include "common/progress.h"
#include "q3map2/vis/separators.h"
#include "q3map2/vis/vis_map.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr int kMaxPlanes = 64;

/// Separators of a pair of consecutive portals: the region seen through both is in front of all of them.
struct PassagePlanes {
    VisPlane planes[kMaxPlanes];
    int count = 0;

    PassagePlanes(const WindingView &first, const WindingView &second) {
        AddSeparators(first, second, false);
        AddSeparators(second, first, true);
    }
    void AddSeparators(const WindingView &s, const WindingView &t, bool flip) {
        for (int edge = 0; edge < s.count && count < kMaxPlanes; ++edge)
            count += SeparatorOfEdge(s, t, edge, flip, planes[count]);
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

Passages::Passages(const VisMap &map, const MightSeeTable &mightSee, const JobPool &jobs, Log &log) {
    const std::size_t count = map.NumPortals();
    start_.resize(count);
    std::size_t rows = 0;
    for (std::size_t p = 0; p < count; ++p) {
        start_[p] = rows;
        rows += map.Portal(p).removed ? 0 : map.PortalsAfter(p).size();
    }
    table_ = BitTable(rows, count);
    Progress progress(log, std::int64_t(count));
    jobs.For(
        std::int64_t(count),
        [&](std::int64_t index, int) {
            const auto p = std::size_t(index);
            if (map.Portal(p).removed)
                return;
            const auto after = map.PortalsAfter(p);
            for (std::size_t next = 0; next < after.size(); ++next) {
                const auto t = std::size_t(after[next]);
                BitWord *const row = table_.Row(start_[p] + next);
                const BitWord *const a = mightSee.Row(p), *const b = mightSee.Row(t);
                for (std::size_t i = 0; i < table_.Words(); ++i)
                    row[i] = a[i] & b[i];
                const PassagePlanes planes(map.Portal(p).winding, map.Portal(t).winding);
                ForEachBit(table_.Bits(start_[p] + next), [&](std::size_t q) {
                    if (!planes.MaySee(map.Portal(q)))
                        ClearBit(row, q);
                });
            }
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
        ApplySymmetry(map, mightSee);
    }
}

} // namespace q3
