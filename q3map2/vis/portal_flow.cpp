// GPL-2.0-or-later. Portal flow: what is seen through a portal, chain by chain of the portals behind it.
#include "common/progress.h"
#include "q3map2/vis/chain_link.h"
#include "q3map2/vis/separators.h"
#include "q3map2/vis/vis_map.h"

#include <algorithm>
#include <atomic>
#include <barrier>
#include <chrono>
#include <memory>
#include <numeric>

namespace q3 {

namespace {

/// Portals that are followed from the same state of the table, on all threads. Fixed, so that no result depends on how
/// many threads there are.
constexpr std::size_t kBatch = 64;
/// Portals of a chain up to which the first one is cut as well. It makes results tighter; later in a chain it costs
/// more time than it is worth.
constexpr int kSourceCuts = 5;

/// Follows portals, one at a time.
class Follower {
  public:
    Follower(const VisMap &map, const SightTable &sight, const FlowSettings &settings)
        : map_(map), sight_(sight), settings_(settings) {}

    /// Adds to `seen` the portals that are seen through portal `base`. Those in it already are known to be.
    void Follow(std::size_t base, BitWord *seen) {
        base_ = &map_.Portal(base);
        seen_ = seen;
        ChainLink &first = Link(0);
        first.might = sight_.Row(base);
        first.low = 0, first.high = sight_.Words();
        std::iota(first.newStorage.begin(), first.newStorage.end(), 0u);
        first.newWords = first.newStorage;
        first.length = 1;
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
        if (settings_.alone || !link.HasPass())
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
        if (!(ahead > portal.radius) && !next.CutPass(base_->plane))
            return false;
        next.source = last.source;
        if (!(behind < -base_->radius) && !next.CutSource(portal.plane.Flipped()))
            return false;
        if (last.HasPass() && !(settings_.alone ? ClipAsNeeded(last, portal, next) : Clip(last, portal, next)))
            return false;
        next.length = last.length + 1;
        if (goesOn && !settings_.alone && last.HasPass() && next.length <= kSourceCuts &&
            !ClipSource(last, portal, next))
            return false;
        SetBit(seen_, q);
        if (!goesOn)
            return false;
        Narrow(last, place, q, next);
        return settings_.alone || Foresee(next, portal);
    }

    /// Takes portals that are not seen yet out of what a chain may see, if they are not in front of all its separators.
    /// `portal` is the last of the chain. True: some are left.
    bool Foresee(ChainLink &link, const FlowPortal &portal) const {
        link.MakeSeparators(base_->plane.normal, portal.plane.normal);
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
        if (!last.HasPass() || settings_.alone)
            return false;
        for (const Separators &list : last.separators)
            for (int i = 0; i < list.count; ++i)
                if (list.planes[i].Distance(portal.centre) < -portal.radius)
                    return true;
        return false;
    }

    static bool Clip(const ChainLink &last, const FlowPortal &portal, ChainLink &next) {
        for (const Separators &list : last.separators)
            for (int i = 0; i < list.count; ++i)
                if (!(list.planes[i].Distance(portal.centre) > portal.radius) && !next.CutPass(list.planes[i]))
                    return false;
        return true;
    }

    /// Cuts the first portal to what can be seen of it from `portal` through the one before, as the way back would.
    /// False: nothing is left.
    bool ClipSource(const ChainLink &last, const FlowPortal &portal, ChainLink &next) const {
        VisPlane planes[kMaxSeparators];
        int count = TangentPlanes(next.pass, portal.plane.normal, last.pass, true, planes);
        for (int i = 0; i < count; ++i)
            if (!next.CutSource(planes[i]))
                return false;
        count = TangentPlanes(last.pass, map_.Portal(last.entry).plane.normal, next.pass, false, planes);
        for (int i = 0; i < count; ++i)
            if (!next.CutSource(planes[i].Flipped()))
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
                    if (!next.CutPass(list.planes[i]))
                        return false;
                continue;
            }
            for (int edge = 0; edge < s.count && list.count < kMaxSeparators; ++edge) {
                VisPlane &plane = list.planes[list.count];
                if (!SeparatorOfEdge(s, t, edge, side == 1, plane))
                    continue;
                list.count++;
                const float d = plane.Distance(portal.centre);
                if (d < -portal.radius || (!(d > portal.radius) && !next.CutPass(plane)))
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

/// All portals, batch after batch, on all threads.
class FlowRun {
  public:
    FlowRun(const VisMap &map, std::span<const int> order, const FlowSettings &settings, int workers, SightTable &sight)
        : map_(map), order_(order), settings_(settings), workers_(workers), sight_(sight),
          batch_(settings.alone ? 1 : kBatch), found_(batch_, map.NumPortals()), answered_(sight.Words()),
          waited_(std::size_t(workers)) {
        for (int worker = 0; worker < workers; ++worker)
            followers_.emplace_back(map, sight, settings);
    }

    /// To be called once on each of the threads, which stay for all batches: to start threads for each would cost more
    /// than most batches. `report` is called by worker 0 with the number of portals done.
    template <typename Report> void Work(std::size_t worker, Report &&report) {
        try {
            while (first_ < order_.size()) {
                const std::span<const int> portals = Batch();
                for (std::size_t i = 0; (i = next_.fetch_add(1)) < portals.size();) {
                    // The last ones take longest: they start first, so that no thread waits long for the others.
                    const std::size_t slot = portals.size() - 1 - i;
                    Follow(worker, std::size_t(portals[slot]), found_.Row(slot));
                }
                const auto start = std::chrono::steady_clock::now();
                allDone_.arrive_and_wait();
                waited_[worker] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
                if (worker == 0)
                    report(first_);
            }
        } catch (...) {
            allDone_.arrive_and_drop();
            throw;
        }
    }
    /// Seconds that the threads waited for each other, in total.
    double Waited() const { return std::accumulate(waited_.begin(), waited_.end(), 0.0); }

  private:
    std::span<const int> Batch() const { return order_.subspan(first_, std::min(batch_, order_.size() - first_)); }

    void Follow(std::size_t worker, std::size_t p, BitWord *seen) {
        const bool asks = !settings_.alone && map_.Portal(p).hasTwin;
        for (std::size_t word = 0; word < found_.Words(); ++word)
            seen[word] = asks ? sight_.Row(p)[word] & answered_[word] : 0;
        if (!map_.Portal(p).removed)
            followers_[worker].Follow(p, seen);
    }

    void Store() noexcept {
        const std::span<const int> portals = Batch();
        for (std::size_t i = 0; i < portals.size(); ++i) {
            const auto p = std::size_t(portals[i]);
            StoreSight(map_, p, found_.Bits(i), !settings_.alone, sight_);
            if (map_.Portal(p).hasTwin)
                SetBit(answered_.data(), p ^ 1);
        }
        first_ += portals.size();
        next_ = 0;
    }

    struct StoreAll {
        FlowRun *run;
        void operator()() const noexcept { run->Store(); }
    };

    const VisMap &map_;
    std::span<const int> order_;
    const FlowSettings &settings_;
    int workers_;
    SightTable &sight_;
    std::size_t batch_, first_ = 0;
    std::atomic<std::size_t> next_{0};
    BitTable found_;                ///< what the portals of the batch found
    std::vector<BitWord> answered_; ///< twins of portals that are done: what is left of these in a row is seen
    std::vector<Follower> followers_;
    std::vector<double> waited_; ///< seconds, by worker
    std::barrier<StoreAll> allDone_{workers_, StoreAll{this}};
};

} // namespace

void PortalFlow(const VisMap &map, std::span<const int> order, const FlowSettings &settings, const JobPool &jobs,
                Log &log, SightTable &sight) {
    const int workers = settings.alone ? 1 : jobs.Threads();
    FlowRun run(map, order, settings, workers, sight);
    Progress progress(log, std::int64_t(order.size()));
    jobs.For(workers, [&](std::int64_t index, int) {
        run.Work(std::size_t(index), [&](std::size_t done) { progress.Update(std::int64_t(done), 0); });
    });
    const double seconds = std::max(progress.Seconds(), 1e-9);
    progress.Finish();
    log.Verbose("threads waited {:.1f} % of the time for each other\n", 100 * run.Waited() / (seconds * workers));
}

} // namespace q3
