// GPL-2.0-or-later. Portal flow: the portals seen through a portal, by depth-first search over chains of portals.
#include "q3map2/vis/portal_flow.h"

#include "common/log.h"
#include "q3map2/vis/chain_link.h"
#include "q3map2/vis/explored_chains.h"
#include "q3map2/vis/vis_map.h"
#include "q3map2/vis/vis_parts.h"
#include "q3map2/vis/vis_winding.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <numeric>

namespace q3 {

namespace {

/// Number of portals that are searched in parallel, from the same state of the table. Constant, so that the result does
/// not depend on the number of threads.
constexpr std::size_t kBatch = 64;
/// Length of chains up to which the first portal is clipped too. That tightens the result; in longer chains it costs
/// more time than it saves.
constexpr int kMaxSourceClipLength = 5;

/// Searches the chains from one portal at a time.
class ChainSearch {
  public:
    ChainSearch(const VisMap &map, const MightSeeTable &mightSee, const FlowSettings &settings)
        : map_(map), mightSee_(mightSee), settings_(settings), blockWords_(BlockWordsOf(map.Words())) {}

    /// Adds the portals that are seen through portal `base` to `seen`, which may hold portals known to be seen.
    void Run(std::size_t base, BitWord *seen) {
        base_ = &map_.Portal(base);
        seen_ = seen;
        ChainLink &first = Link(0);
        const SparseBits &row = mightSee_[base];
        first.blocks = row.Blocks();
        first.blocks.ForEach(
            [&](std::size_t block) { std::fill_n(&first.mightSee[blockWords_ * block], blockWords_, BitWord(0)); });
        row.ForEachWord([&](std::size_t i, BitWord word) { first.mightSee[i] = word; });
        FindUnseen(first, first.blocks);
        first.length = 1;
        first.source = base_->winding;
        StartLink(first, base);
        explored_.Clear();
        tried_ = 0;
        for (std::size_t depth = 0;;) {
            ChainLink &last = *links_[depth];
            if (last.nextCandidate == last.candidates.size()) {
                if (depth == 0)
                    return;
                --depth;
                continue;
            }
            const std::size_t candidate = last.nextCandidate++, q = std::size_t(last.candidates[candidate]);
            if (!MaySee(last, q))
                continue;
            ChainLink &next = Link(depth + 1);
            ++tried_;
            if (settings_.clip ? ExtendClipped(last, candidate, q, next) : Extend(last, candidate, q, next)) {
                StartLink(next, q);
                ++depth;
            }
        }
    }

  private:
    ChainLink &Link(std::size_t depth) {
        if (depth == links_.size())
            links_.push_back(std::make_unique<ChainLink>(map_.Words()));
        return *links_[depth];
    }

    void StartLink(ChainLink &link, std::size_t portal) const {
        link.lastPortal = portal;
        link.candidates = map_.PortalsAfter(portal);
        link.nextCandidate = 0;
        if (settings_.reference || !link.HasPass())
            link.separators[0].count = link.separators[1].count = 0;
    }

    /// Portals that may be seen through the last portal of the chain and then q, which is candidate number `candidate`,
    /// here and below.
    const SparseBits &PassageRow(const ChainLink &last, std::size_t candidate, std::size_t q) const {
        const SparseBits *const row =
            settings_.passages ? settings_.passages->Row(last.lastPortal, candidate) : nullptr;
        return row ? *row : mightSee_[q];
    }

    bool MaySee(const ChainLink &link, std::size_t q) const {
        const std::size_t column = map_.Column(q);
        return link.blocks.Has(column / (kBitsPerWord * blockWords_)) && TestBit(link.mightSee.data(), column);
    }

    /// Whether a portal not seen yet may be seen through the chain and q.
    bool HasUnseen(const ChainLink &last, std::size_t candidate, std::size_t q) const {
        const SparseBits &seenThroughQ = mightSee_[q], &passage = PassageRow(last, candidate, q);
        return (last.unseenBlocks & passage.Blocks() & seenThroughQ.Blocks()).Any([&](std::size_t block) {
            const BitWord *const through = passage[block], *const beyond = seenThroughQ[block];
            const BitWord *const mightSee = &last.mightSee[blockWords_ * block];
            const BitWord *const seen = seen_ + blockWords_ * block;
            BitWord any = 0;
            for (std::size_t i = 0; i < blockWords_; ++i)
                any |= mightSee[i] & ~seen[i] & through[i] & beyond[i];
            return any != 0;
        });
    }
    /// Sets unseenBlocks: which of some blocks of link.mightSee hold portals not seen yet.
    void FindUnseen(ChainLink &link, const BlockSet &blocks) const {
        BlockSet unseen;
        blocks.ForEach([&](std::size_t block) {
            const BitWord *const mightSee = &link.mightSee[blockWords_ * block];
            const BitWord *const seen = seen_ + blockWords_ * block;
            BitWord any = 0;
            for (std::size_t i = 0; i < blockWords_; ++i)
                any |= mightSee[i] & ~seen[i];
            if (any != 0)
                unseen.Insert(block);
        });
        link.unseenBlocks = unseen;
    }

    /// Sets next.mightSee: the portals that may be seen through the chain and q.
    void RestrictMightSee(const ChainLink &last, std::size_t candidate, std::size_t q, ChainLink &next) const {
        const SparseBits &seenThroughQ = mightSee_[q], &passage = PassageRow(last, candidate, q);
        next.blocks = BlockSet();
        (last.blocks & passage.Blocks() & seenThroughQ.Blocks()).ForEach([&](std::size_t block) {
            const BitWord *const through = passage[block], *const beyond = seenThroughQ[block];
            const BitWord *const mightSee = &last.mightSee[blockWords_ * block];
            BitWord *const into = &next.mightSee[blockWords_ * block];
            BitWord any = 0;
            for (std::size_t i = 0; i < blockWords_; ++i)
                any |= into[i] = mightSee[i] & through[i] & beyond[i];
            if (any != 0)
                next.blocks.Insert(block);
        });
        FindUnseen(next, last.unseenBlocks & next.blocks);
    }

    /// Makes `next` the chain with q at its end. False: no portal that is not seen yet can be seen through it.
    bool Extend(const ChainLink &last, std::size_t candidate, std::size_t q, ChainLink &next) {
        SetBit(seen_, map_.Column(q));
        if (!HasUnseen(last, candidate, q))
            return false;
        RestrictMightSee(last, candidate, q, next);
        return true;
    }

    /// The same with clipped windings: q counts as seen only if something of it is left.
    bool ExtendClipped(ChainLink &last, std::size_t candidate, std::size_t q, ChainLink &next) {
        const FlowPortal &portal = map_.Portal(q);
        const float ahead = base_->plane.Distance(portal.center), behind = portal.plane.Distance(base_->center);
        if (ahead < -portal.radius || behind > base_->radius)
            return false;
        const bool continues = HasUnseen(last, candidate, q);
        if (!continues && TestBit(seen_, portal.column))
            return false;
        next.pass = portal.winding;
        if (!(ahead > portal.radius) && !next.ClipPass(base_->plane))
            return false;
        next.source = last.source;
        if (!(behind < -base_->radius) && !next.ClipSource(portal.plane.Flipped()))
            return false;
        if (last.HasPass() && !(settings_.reference ? ClipAsNeeded(last, portal, next) : Clip(last, portal, next)))
            return false;
        next.length = last.length + 1;
        if (continues && !settings_.reference && last.HasPass() && next.length <= kMaxSourceClipLength &&
            !ClipSourceBackwards(last, portal, next))
            return false;
        SetBit(seen_, portal.column);
        if (!continues)
            return false;
        RestrictMightSee(last, candidate, q, next);
        if (settings_.reference)
            return true;
        if (tried_ > settings_.triesBeforeKeeping) {
            if (explored_.Covers(next, portal, blockWords_))
                return false;
            explored_.Keep(next, *base_, portal, blockWords_);
        }
        return PruneMightSee(next, portal);
    }

    /// Removes portals not seen yet that are behind a separator of the chain from its mightSee, before any of them is
    /// visited. `portal` is the last of the chain. True: some are left that are not seen yet.
    bool PruneMightSee(ChainLink &link, const FlowPortal &portal) const {
        link.MakeSeparators(base_->plane.normal, portal.plane.normal);
        link.unseenBlocks.ForEach([&](std::size_t block) {
            for (std::size_t i = blockWords_ * block; i < blockWords_ * (block + 1); ++i)
                ForEachBitOf(link.mightSee[i] & ~seen_[i], [&](std::size_t bit) {
                    if (link.Hides(map_.Portal(map_.PortalAt(kBitsPerWord * i + bit))))
                        ClearBit(&link.mightSee[i], bit);
                });
        });
        FindUnseen(link, link.unseenBlocks);
        return !link.unseenBlocks.IsEmpty();
    }

    static bool Clip(const ChainLink &last, const FlowPortal &portal, ChainLink &next) {
        for (const Separators &list : last.separators)
            for (int i = 0; i < list.count; ++i)
                if (!(list.planes[i].Distance(portal.center) > portal.radius) && !next.ClipPass(list.planes[i]))
                    return false;
        return true;
    }

    /// Clips the first portal to the part that is seen looking back from `portal` through the portal before it. False:
    /// nothing is left.
    bool ClipSourceBackwards(const ChainLink &last, const FlowPortal &portal, ChainLink &next) const {
        VisPlane planes[kMaxSeparators];
        int count = TangentPlanes(next.pass, portal.plane.normal, last.pass, NormalSide::Behind, planes);
        for (int i = 0; i < count; ++i)
            if (!next.ClipSource(planes[i]))
                return false;
        count =
            TangentPlanes(last.pass, map_.Portal(last.lastPortal).plane.normal, next.pass, NormalSide::Front, planes);
        for (int i = 0; i < count; ++i)
            if (!next.ClipSource(planes[i].Flipped()))
                return false;
        return true;
    }

    /// Finds separators one by one until one hides the portal, and keeps them for the next candidates.
    static bool ClipAsNeeded(ChainLink &last, const FlowPortal &portal, ChainLink &next) {
        for (int side = 0; side < 2; ++side) {
            Separators &list = last.separators[side];
            const WindingView &s = side == 0 ? last.source : last.pass, &t = side == 0 ? last.pass : last.source;
            if (list.count > 0) {
                for (int i = 0; i < list.count; ++i)
                    if (!next.ClipPass(list.planes[i]))
                        return false;
                continue;
            }
            for (int edge = 0; edge < s.count && list.count < kMaxSeparators; ++edge) {
                VisPlane &plane = list.planes[list.count];
                if (!SeparatorOfEdge(s, t, edge, side == 0 ? InFront::T : InFront::S, plane))
                    continue;
                list.count++;
                const float d = plane.Distance(portal.center);
                if (d < -portal.radius || (!(d > portal.radius) && !next.ClipPass(plane)))
                    return false;
            }
        }
        return true;
    }

    const VisMap &map_;
    const MightSeeTable &mightSee_;
    const FlowSettings &settings_;
    const std::size_t blockWords_; ///< of rows
    const FlowPortal *base_ = nullptr;
    BitWord *seen_ = nullptr;
    std::int64_t tried_ = 0;                        ///< portals that this search has tried to add
    ExploredChains explored_;                       ///< of this search
    std::vector<std::unique_ptr<ChainLink>> links_; ///< by depth; kept from portal to portal
};

/// Follows all portals, batch after batch.
class FlowRun {
  public:
    FlowRun(const VisMap &map, std::span<const int> order, const FlowSettings &settings, const VisUnits &units,
            const JobPool &jobs, MightSeeTable &mightSee)
        : map_(map), order_(order), settings_(settings), units_(units), jobs_(jobs), mightSee_(mightSee),
          batch_(BatchOf(settings, order.size())), found_(batch_, map.Columns()), settled_(map.Words()),
          busy_(std::size_t(jobs.Threads())) {
        for (int worker = 0; worker < jobs.Threads(); ++worker)
            searches_.emplace_back(map, mightSee, settings);
    }

    /// Replaces rows by those that earlier rounds of parts found.
    void UseKnown(std::span<const int> portals) {
        std::vector<int> known;
        const auto store = [&] {
            Store(known);
            known.clear();
        };
        for (const int p : portals) {
            if (units_.Find(VisUnits::Row::Flow, std::size_t(p), found_.Bits(known.size())))
                known.push_back(p);
            if (known.size() == batch_)
                store();
        }
        store();
    }
    /// Searches some portals from the state of the table, and keeps what it finds.
    void RunPart(std::span<const int> portals) {
        BitTable found(std::size_t(jobs_.Threads()), map_.Columns());
        jobs_.For(std::int64_t(portals.size()), [&](std::int64_t index, int worker) {
            // The last portal is the most expensive one.
            const auto p = std::size_t(portals[portals.size() - 1 - std::size_t(index)]);
            Search(std::size_t(worker), p, found.Row(std::size_t(worker)));
            units_.Keep(VisUnits::Row::Flow, p, found.Bits(std::size_t(worker)));
        });
    }

    /// Calls report(portals done) after each batch.
    template <typename Report> void Run(Report &&report) {
        for (std::size_t first = 0; first < order_.size(); first += batch_) {
            const std::span<const int> portals = order_.subspan(first, std::min(batch_, order_.size() - first));
            jobs_.For(std::int64_t(portals.size()), [&](std::int64_t index, int worker) {
                // The last portal is the most expensive one. It starts first, which shortens the end of the batch.
                const std::size_t slot = portals.size() - 1 - std::size_t(index);
                const auto p = std::size_t(portals[slot]);
                if (!units_.Find(VisUnits::Row::Flow, p, found_.Bits(slot)))
                    Search(std::size_t(worker), p, found_.Row(slot));
            });
            Store(portals);
            report(first + portals.size());
        }
    }
    /// Seconds that workers spent on portals, summed over workers.
    double BusySeconds() const { return std::accumulate(busy_.begin(), busy_.end(), 0.0); }

  private:
    static std::size_t BatchOf(const FlowSettings &settings, std::size_t portals) {
        if (settings.reference)
            return 1;
        const auto rounds = std::size_t(settings.rounds);
        return rounds == 0 ? kBatch : std::max<std::size_t>(1, (portals + rounds - 1) / rounds);
    }
    void Search(std::size_t worker, std::size_t p, BitWord *seen) {
        const auto start = std::chrono::steady_clock::now();
        const bool useTwins = !settings_.reference && map_.Portal(p).hasTwin;
        for (std::size_t word = 0; word < map_.Words(); ++word)
            seen[word] = useTwins ? mightSee_[p].Word(word) & settled_[word] : 0;
        if (!map_.Portal(p).removed)
            searches_[worker].Run(p, seen);
        busy_[worker] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    /// Restricts the rows of portals to what was found. Bits that this clears are cleared for the opposite direction
    /// too, except in reference mode.
    void Store(std::span<const int> portals) {
        const auto portalOf = [&](std::size_t slot) { return std::size_t(portals[slot]); };
        jobs_.For(std::int64_t(portals.size()), [&](std::int64_t index, int) {
            const auto slot = std::size_t(index);
            mightSee_[portalOf(slot)].Restrict(found_.Bits(slot));
        });
        if (settings_.reference)
            return;
        // A worker clears bits in the rows of the twins of some columns, for all portals.
        jobs_.For(std::int64_t(map_.Words()), [&](std::int64_t index, int) {
            const auto word = std::size_t(index);
            for (std::size_t slot = 0; slot < portals.size(); ++slot) {
                const BitWord cleared = map_.Portal(portalOf(slot)).hasTwin ? found_.Row(slot)[word] : 0;
                ForEachBitOf(cleared, [&](std::size_t bit) {
                    const std::size_t q = map_.PortalAt(kBitsPerWord * word + bit);
                    if (map_.Portal(q).hasTwin)
                        mightSee_[q ^ 1].Clear(map_.Column(portalOf(slot) ^ 1));
                });
            }
        });
        for (const int p : portals)
            if (map_.Portal(std::size_t(p)).hasTwin)
                SetBit(settled_.data(), map_.Column(std::size_t(p) ^ 1));
    }

    const VisMap &map_;
    std::span<const int> order_;
    const FlowSettings &settings_;
    const VisUnits &units_;
    const JobPool &jobs_;
    MightSeeTable &mightSee_;
    std::size_t batch_;
    BitTable found_;               ///< by portal of the batch: what its search found, then the bits that this clears
    std::vector<BitWord> settled_; ///< twins of finished portals: their bits in a row of mightSee_ are final
    std::vector<double> busy_;     ///< seconds, by worker
    std::vector<ChainSearch> searches_; ///< by worker
};

} // namespace

void PartOfPortalFlow(const VisMap &map, std::span<const int> order, const FlowSettings &settings,
                      const VisUnits &units, const JobPool &jobs, Log &log, MightSeeTable &mightSee) {
    const auto round = std::size_t(units.FlowRoundsBefore()), rounds = std::size_t(settings.rounds);
    const std::size_t size = (order.size() + rounds - 1) / rounds, first = std::min(order.size(), size * round),
                      end = std::min(order.size(), first + size);
    std::vector<double> costs;
    for (const int p : order.subspan(first, end - first)) {
        const auto seen = double(mightSee[std::size_t(p)].Count());
        costs.push_back(seen * seen); // about the time of a search
    }
    const std::vector<std::uint8_t> own = units.Own(costs, UnitStore::Division::BySize);
    std::vector<int> portals;
    for (std::size_t i = 0; i < own.size(); ++i)
        if (own[i] != 0)
            portals.push_back(order[first + i]);
    log.Count(portals.size(), "portals of this part");
    FlowRun run(map, order, settings, units, jobs, mightSee);
    run.UseKnown(order.first(first));
    run.RunPart(portals);
}

void PortalFlow(const VisMap &map, std::span<const int> order, const FlowSettings &settings, const VisUnits &units,
                const JobPool &jobs, Log &log, MightSeeTable &mightSee) {
    const int workers = settings.reference ? 1 : jobs.Threads();
    FlowRun run(map, order, settings, units, jobs, mightSee);
    Progress progress(log, std::int64_t(order.size()));
    run.Run([&](std::size_t done) { progress.Update(std::int64_t(done), 0); });
    constexpr double kShortest = 1e-9; // seconds; no division by zero
    const double workerSeconds = std::max(progress.Seconds(), kShortest) * workers;
    progress.Finish();
    log.Verbose("threads waited {:.1f} % of the time for each other\n",
                std::max(0.0, 100 * (1 - run.BusySeconds() / workerSeconds)));
}

} // namespace q3
