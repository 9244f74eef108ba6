// GPL-2.0-or-later. Portal flow: what is seen through a portal, chain by chain of the portals behind it.
#include "common/progress.h"
#include "q3map2/vis/vis_map.h"

#include <algorithm>
#include <atomic>
#include <barrier>
#include <memory>
#include <numeric>

namespace q3 {

namespace {

/// Portals that are followed from the same state of the table, on all threads. Fixed, so that no result depends on how
/// many threads there are.
constexpr std::size_t kBatch = 32;
constexpr int kMaxSeparators = 32; ///< of each kind; more cut a little less

/// Planes that bound what can be seen from one winding through another.
struct Separators {
    VisPlane planes[kMaxSeparators];
    int count = 0;

    /// Whether nearly the same plane is there: parallel edges give one twice.
    bool Has(const VisPlane &plane) const {
        constexpr float kSameDirection = 1e-5f, kSameDistance = 0.01f;
        for (int i = 0; i < count; ++i) {
            const Vec3f turn = planes[i].normal - plane.normal;
            if (std::abs(turn.x) < kSameDirection && std::abs(turn.y) < kSameDirection &&
                std::abs(turn.z) < kSameDirection && std::abs(planes[i].dist - plane.dist) < kSameDistance)
                return true;
        }
        return false;
    }
};

/// One portal of a chain: what is left of the first and the last portal, and which portals may follow.
struct ChainLink {
    explicit ChainLink(std::size_t words) : storage(words), newStorage(words), might(storage.data()) {}

    std::vector<BitWord> storage;
    std::vector<std::uint32_t> newStorage;
    const BitWord *might;                    ///< portals that may be seen through the chain
    std::size_t low = 0, high = 0;           ///< words of `might` that are not all zero, and nothing outside is read
    std::span<const std::uint32_t> newWords; ///< words of it that may hold portals not seen yet
    std::size_t entry = 0;                   ///< the last portal of the chain
    std::span<const int> after;              ///< portals that could follow
    std::size_t place = 0;                   ///< the next of them
    bool hasPass = false;                    ///< more than one portal in the chain
    WindingView source, pass;                ///< what is left of the first portal and of the last
    WindingBuffer sourceBuffer, passBuffers[2];
    Separators separators[2]; ///< source against pass, pass against source

    /// Whether nothing of a portal is in front of all separators, as far as each of them tells.
    bool Hides(const FlowPortal &portal) const {
        for (const Separators &list : separators)
            for (int i = 0; i < list.count; ++i) {
                const float d = list.planes[i].Distance(portal.centre);
                if (d > portal.radius)
                    continue;
                if (d < -portal.radius)
                    return true;
                const PointDistances distances(portal.winding, list.planes[i]);
                if (distances.greatest < kOnEpsilon && distances.least <= -kOnEpsilon)
                    return true;
            }
        return false;
    }
    bool MaySee(std::size_t q) const { return q >> 6 >= low && q >> 6 < high && TestBit(might, q); }
    void MakeSeparators() {
        for (int side = 0; side < 2; ++side) {
            const WindingView &s = side == 0 ? source : pass, &t = side == 0 ? pass : source;
            Separators &list = separators[side];
            list.count = 0;
            for (int edge = 0; edge < s.count && list.count < kMaxSeparators; ++edge)
                if (SeparatorOfEdge(s, t, edge, side == 1, list.planes[list.count]) &&
                    !(side == 1 && separators[0].Has(list.planes[list.count])))
                    list.count++;
        }
    }
};

/// Follows portals, one at a time.
class Follower {
  public:
    Follower(const VisMap &map, const SightTable &sight, const FlowSettings &settings)
        : map_(map), sight_(sight), settings_(settings) {}

    /// Sets in `seen`, all clear before, the portals that are seen through portal `base`.
    void Follow(std::size_t base, BitWord *seen) {
        base_ = &map_.Portal(base);
        seen_ = seen;
        ChainLink &first = Link(0);
        first.might = sight_.Row(base);
        first.low = 0, first.high = sight_.Words();
        std::iota(first.newStorage.begin(), first.newStorage.end(), 0u);
        first.newWords = first.newStorage;
        first.hasPass = false;
        first.source = base_->winding;
        Enter(first, base);
        for (std::size_t depth = 0;;) {
            ChainLink &last = *links_[depth];
            if (last.place == last.after.size()) {
                if (depth == 0)
                    return;
                --depth;
                continue;
            }
            const std::size_t place = last.place++, q = std::size_t(last.after[place]);
            if (!last.MaySee(q))
                continue;
            ChainLink &next = Link(depth + 1);
            if (settings_.clip ? StepClipped(last, place, q, next) : Step(last, place, q, next)) {
                Enter(next, q);
                ++depth;
            }
        }
    }

  private:
    ChainLink &Link(std::size_t depth) {
        if (depth == links_.size())
            links_.push_back(std::make_unique<ChainLink>(sight_.Words()));
        return *links_[depth];
    }

    void Enter(ChainLink &link, std::size_t portal) const {
        link.entry = portal;
        link.after = map_.PortalsAfter(portal);
        link.place = 0;
        if (settings_.alone || !link.hasPass)
            link.separators[0].count = link.separators[1].count = 0;
    }

    const BitWord *PassageRow(const ChainLink &last, std::size_t place, std::size_t q) const {
        return settings_.passages ? settings_.passages->Row(last.entry, place) : sight_.Row(q);
    }

    /// Whether something that has not been seen yet may be seen beyond q.
    bool AnyNew(const ChainLink &last, std::size_t place, std::size_t q) const {
        const BitWord *const sight = sight_.Row(q), *const passage = PassageRow(last, place, q);
        for (const std::uint32_t i : last.newWords)
            if ((last.might[i] & sight[i] & passage[i] & ~seen_[i]) != 0)
                return true;
        return false;
    }

    /// What may be seen beyond q.
    void Narrow(const ChainLink &last, std::size_t place, std::size_t q, ChainLink &next) const {
        const BitWord *const might = last.might, *const sight = sight_.Row(q);
        const BitWord *const passage = PassageRow(last, place, q);
        BitWord *const into = next.storage.data();
        for (std::size_t i = last.low; i < last.high; ++i)
            into[i] = might[i] & sight[i] & passage[i];
        next.might = into;
        next.low = last.low, next.high = last.high;
        while (next.low < next.high && into[next.low] == 0)
            ++next.low;
        while (next.high > next.low && into[next.high - 1] == 0)
            --next.high;
        std::size_t count = 0;
        for (const std::uint32_t i : last.newWords) {
            next.newStorage[count] = i;
            count += (into[i] & ~seen_[i]) != 0;
        }
        next.newWords = {next.newStorage.data(), count};
    }

    bool Step(const ChainLink &last, std::size_t place, std::size_t q, ChainLink &next) {
        SetBit(seen_, q);
        if (!AnyNew(last, place, q))
            return false;
        Narrow(last, place, q, next);
        return true;
    }

    bool StepClipped(ChainLink &last, std::size_t place, std::size_t q, ChainLink &next) {
        const FlowPortal &portal = map_.Portal(q);
        const float ahead = base_->plane.Distance(portal.centre), behind = portal.plane.Distance(base_->centre);
        if (ahead < -portal.radius || behind > base_->radius || IsBehindSeparators(last, portal))
            return false;
        const bool goesOn = AnyNew(last, place, q);
        if (!goesOn && TestBit(seen_, q))
            return false;
        next.pass = portal.winding;
        if (!(ahead > portal.radius) && !ChopInFront(next.pass, base_->plane, next.passBuffers[0]))
            return false;
        next.source = last.source;
        if (!(behind < -base_->radius) && !ChopInFront(next.source, portal.plane.Flipped(), next.sourceBuffer))
            return false;
        if (last.hasPass && !(settings_.alone ? ClipAsNeeded(last, portal, next) : Clip(last, portal, next)))
            return false;
        SetBit(seen_, q);
        if (!goesOn)
            return false;
        next.hasPass = true;
        Narrow(last, place, q, next);
        return settings_.alone || Foresee(next);
    }

    /// Takes portals that are not seen yet out of what a chain may see, if they are not in front of all its separators.
    /// True: some are left.
    bool Foresee(ChainLink &link) const {
        link.MakeSeparators();
        std::size_t count = 0;
        for (const std::uint32_t i : link.newWords) {
            for (BitWord word = link.might[i] & ~seen_[i]; word != 0; word &= word - 1) {
                const std::size_t t = 64 * i + std::size_t(std::countr_zero(word));
                if (link.Hides(map_.Portal(t)))
                    ClearBit(link.storage.data(), t);
            }
            link.newStorage[count] = i;
            count += (link.might[i] & ~seen_[i]) != 0;
        }
        link.newWords = {link.newStorage.data(), count};
        return count > 0;
    }

    /// Whether the sphere of a portal says at once that nothing of it is in front of all separators.
    bool IsBehindSeparators(const ChainLink &last, const FlowPortal &portal) const {
        if (!last.hasPass || settings_.alone)
            return false;
        for (const Separators &list : last.separators)
            for (int i = 0; i < list.count; ++i)
                if (list.planes[i].Distance(portal.centre) < -portal.radius)
                    return true;
        return false;
    }

    /// Cuts next.pass by a plane, in the buffer that it is not in.
    static bool CutPass(ChainLink &next, const VisPlane &plane) {
        WindingBuffer &buffer = next.passBuffers[next.pass.x == next.passBuffers[0].x ? 1 : 0];
        return ChopInFront(next.pass, plane, buffer);
    }

    static bool Clip(const ChainLink &last, const FlowPortal &portal, ChainLink &next) {
        for (const Separators &list : last.separators)
            for (int i = 0; i < list.count; ++i)
                if (!(list.planes[i].Distance(portal.centre) > portal.radius) && !CutPass(next, list.planes[i]))
                    return false;
        return true;
    }

    /// Separators are looked for until one hides the portal; those found so far serve the next portals.
    static bool ClipAsNeeded(ChainLink &last, const FlowPortal &portal, ChainLink &next) {
        for (int side = 0; side < 2; ++side) {
            Separators &list = last.separators[side];
            const WindingView &s = side == 0 ? last.source : last.pass, &t = side == 0 ? last.pass : last.source;
            if (list.count > 0) {
                for (int i = 0; i < list.count; ++i)
                    if (!CutPass(next, list.planes[i]))
                        return false;
                continue;
            }
            for (int edge = 0; edge < s.count && list.count < kMaxSeparators; ++edge) {
                VisPlane &plane = list.planes[list.count];
                if (!SeparatorOfEdge(s, t, edge, side == 1, plane))
                    continue;
                list.count++;
                const float d = plane.Distance(portal.centre);
                if (d < -portal.radius || (!(d > portal.radius) && !CutPass(next, plane)))
                    return false;
            }
        }
        return true;
    }

    const VisMap &map_;
    const SightTable &sight_;
    const FlowSettings &settings_;
    const FlowPortal *base_ = nullptr;
    BitWord *seen_ = nullptr;
    std::vector<std::unique_ptr<ChainLink>> links_; ///< by depth; kept from portal to portal
};

/// Puts what was found for a portal into the table; what is not seen one way is not seen the other way.
void StoreSight(const VisMap &map, std::size_t p, std::span<const BitWord> seen, bool symmetric, SightTable &sight) {
    BitWord *const row = sight.Row(p);
    for (std::size_t word = 0; word < seen.size(); ++word) {
        BitWord gone = row[word] & ~seen[word];
        row[word] = symmetric ? row[word] & seen[word] : seen[word];
        if (!symmetric || !map.Portal(p).hasTwin)
            continue;
        for (; gone != 0; gone &= gone - 1) {
            const std::size_t q = 64 * word + std::size_t(std::countr_zero(gone));
            if (map.Portal(q).hasTwin)
                ClearBit(sight.Row(q ^ 1), p ^ 1);
        }
    }
}

} // namespace

void PortalFlow(const VisMap &map, std::span<const int> order, const FlowSettings &settings, const JobPool &jobs,
                Log &log, SightTable &sight) {
    std::vector<Follower> followers;
    for (int worker = 0; worker < jobs.Threads(); ++worker)
        followers.emplace_back(map, sight, settings);
    const std::size_t batch = settings.alone ? 1 : kBatch;
    BitTable found(batch, map.NumPortals());
    Progress progress(log, std::int64_t(order.size()));
    std::size_t first = 0;
    std::atomic<std::size_t> next{0};
    const auto batchNow = [&] { return order.subspan(first, std::min(batch, order.size() - first)); };
    const auto store = [&]() noexcept {
        const std::span<const int> portals = batchNow();
        for (std::size_t i = 0; i < portals.size(); ++i)
            StoreSight(map, std::size_t(portals[i]), found.Bits(i), !settings.alone, sight);
        first += portals.size();
        next = 0;
    };
    // Workers stay for all batches: to start threads for each would cost more than most batches.
    const int workers = settings.alone ? 1 : jobs.Threads();
    std::barrier allDone(workers, store);
    jobs.For(workers, [&](std::int64_t index, int worker) {
        try {
            while (first < order.size()) {
                const std::span<const int> portals = batchNow();
                for (std::size_t i = 0; (i = next.fetch_add(1)) < portals.size();) {
                    // The last ones take longest: they start first, so that no thread waits long for the others.
                    const std::size_t slot = portals.size() - 1 - i, p = std::size_t(portals[slot]);
                    std::fill_n(found.Row(slot), found.Words(), BitWord(0));
                    if (!map.Portal(p).removed)
                        followers[std::size_t(worker)].Follow(p, found.Row(slot));
                }
                allDone.arrive_and_wait();
                if (index == 0)
                    progress.Update(std::int64_t(first), 0);
            }
        } catch (...) {
            allDone.arrive_and_drop();
            throw;
        }
    });
    progress.Finish();
}

} // namespace q3
