// GPL-2.0-or-later. The vis stage: from portals to what every cluster may see.
#include "q3map2/vis/vis.h"

#include "common/text/text.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/vis/passages.h"
#include "q3map2/vis/portal_flow.h"
#include "q3map2/vis/vis_map.h"
#include "q3map2/vis/vis_parts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <optional>

namespace q3 {

// ---- Options of the vis stage ----

VisStageOptions ParseVisOptions(Arguments &arguments, Log &log) {
    VisStageOptions options;
    TakeSettings(VisSettings(), options, arguments, log);
    options.vis.merge |= options.vis.keepHints;
    options.vis.passageOnly &= !options.vis.noPassage;
    return options;
}

// ---- The options of the vis stage, declared ----

namespace {

/// A setting of this field of VisStageOptions::vis.
template <typename Field> auto VisField(Field VisOptions::*field) {
    return [field](auto &o) -> auto & {
        return o.vis.*field;
    };
}

} // namespace

std::vector<SettingGroup<VisStageOptions>> VisSettings() {
    return {
        {"Visibility",
         "Use no option for a final build. Of `-fast`, `-nopassage` and `-passageOnly`, the first one in this order "
         "counts. [Compiling](../guide/compiling.md) explains how to make a map that needs little time.",
         {{{.name = "-saveprt",
            .help = "Keeps the portal file x.prt, which is deleted otherwise",
            .details = "Without this option it is deleted as soon as the `.bsp` is written.",
            .since = "q3map2"},
           &VisStageOptions::savePrt},
          {{.name = "-fast",
            .help = "Computes rough visibility quickly, only from which way portals face",
            .details = "Use it for test builds. Little is hidden, so the game runs slower.",
            .since = "q3map2"},
           VisField(&VisOptions::fast)},
          {{.name = "-merge",
            .help = "Merges leafs that are convex together, and then their portals",
            .details = "The stage takes less time and hides less. Leafs are merged through hint portals too.",
            .since = "q3map2"},
           VisField(&VisOptions::merge)},
          {{.name = "-hint",
            .help = "Merges leafs as -merge does, except across hint brushes",
            .details = "Implies `-merge`.",
            .since = "q3map2"},
           VisField(&VisOptions::keepHints)},
          {{.name = "-mergeportals", .help = "Merges portals only between the same two leafs", .since = "q3map2"},
           VisField(&VisOptions::mergePortals)},
          {{.name = "-nopassage",
            .help = "Computes portal flow without passages, which takes longer and is less exact",
            .details = "Overrides `-passageOnly`.",
            .since = "q3map2"},
           VisField(&VisOptions::noPassage)},
          {{.name = "-passageOnly",
            .help = "Computes passages without portal flow, which takes less time and is less exact",
            .since = "q3map2"},
           VisField(&VisOptions::passageOnly)},
          {{.name = "-nosort",
            .help = "Processes portals in the order of the file instead of the cheapest first",
            .since = "q3map2"},
           VisField(&VisOptions::noSort)},
          {{.name = "-flowrounds",
            .values = "N",
            .initial = "64 portals a round; with -part and -join 4",
            .range = {.low = 1, .high = 100},
            .help = "Follows the portals in N rounds of the same size",
            .details = "A round starts from what the rounds before have found. With few rounds more chains are "
                       "followed in vain, which takes more time, and a few more clusters may count as visible. Runs "
                       "in parts need few rounds, since all parts wait for each other between two rounds. The result "
                       "depends on N, but not on the number of parts.",
            .since = "0.2.0",
            .example = "4"},
           VisField(&VisOptions::flowRounds)},
          {{.name = "-vismemory",
            .values = "MB",
            .initial = "4096",
            .range = {.low = 1, .high = 1000000},
            .help = "Bounds the memory of passages, in megabytes",
            .details =
                "The rows of the portals count towards it, but are always kept, so the stage may take more if the "
                "number is small. Once that much memory is taken, the passages of the other portals are left out. The "
                "stage then takes longer and hides less, and warns. A map of 961 rooms and 32,253 portals takes "
                "1.15 GB in all.",
            .since = "0.2.0",
            .example = "1024"},
           VisField(&VisOptions::memory)},
          {{.name = "-plain",
            .help = "Computes visibility as NetRadiant's q3map2 does, one portal after the other on one thread",
            .details = "Each direction is computed separately, and the lump has the same bytes as that of "
                       "NetRadiant's q3map2 on one thread.",
            .since = "0.1.0"},
           VisField(&VisOptions::plain)},
          {{.name = "-v",
            .help = "Prints how many clusters see how many others, if it is given a second time",
            .details = "The first `-v` of a line is the [global option](command_line.md#-v).",
            .since = "q3map2"},
           &VisStageOptions::histogram}}}};
}

// ---- The vis stage as a whole, and its statistics ----

namespace {

constexpr std::uint64_t kMegabyte = 1 << 20; ///< bytes
/// The lump begins with two 32-bit numbers: of clusters, and of bytes of a row.
constexpr std::size_t kVisHeaderBytes = 8;

std::string_view PluralEnd(int count) {
    return count == 1 ? "" : "s";
}

void Merge(PortalGraph &graph, const VisOptions &options, Log &log) {
    if (options.merge) {
        const auto merged = MergeLeafs(graph, options.keepHints);
        log.Print("{:6} {} merged\n", merged, merged == 1 ? "leaf" : "leaves");
    }
    if (options.merge || options.mergePortals) {
        const MergedPortals merged = MergePortals(graph);
        log.Print("{:6} portal{} merged\n{:6} hint portal{} merged\n", merged.pairs, PluralEnd(merged.pairs),
                  merged.hintPairs, PluralEnd(merged.hintPairs));
    }
    log.Print("{:6} active portals\n{:6} hint portals\n", graph.ActivePortals(), graph.HintPortals());
}

void LogFarPlane(const FarPlane &farPlane, Log &log) {
    if (farPlane.distance <= 0)
        return;
    log.Print("farplane distance = {:.1f}\n", farPlane.distance);
    if (farPlane.mode == FarPlaneMode::Origins)
        log.Print("farplane Origin2Origin mode on\n");
    if (farPlane.mode == FarPlaneMode::RadiusOnly)
        log.Print("farplane Radius+Radius mode on\n");
    if (farPlane.mode == FarPlaneMode::Farthest)
        log.Print("farplane Exact distance mode on\n");
}

/// Passages, if the options ask for them. mightSee: what may be seen, and then tightened by them.
std::optional<Passages> MakePassages(const VisMap &map, const VisOptions &options, const VisUnits &units,
                                     const JobPool &jobs, Log &log, MightSeeTable &mightSee) {
    if (options.noPassage)
        return std::nullopt;
    const std::size_t count = map.NumPortals(), rows = Passages::NumRows(map);
    log.Print("{:7} average number of passages per leaf\n", rows / std::max<std::size_t>(1, count));
    log.Section(fmt::format("CreatePassages ({})", count));
    // The rounds that tighten the table hold a second one.
    const std::uint64_t limit = std::uint64_t(options.memory) * kMegabyte, tables = 2 * mightSee.Bytes();
    Passages passages(map, mightSee, limit - std::min(limit, tables), units, jobs, log);
    log.Print("{:7} MB required passage memory\n", passages.Bytes() / kMegabyte);
    if (passages.NumMade() < count && !units.IsFirstPart())
        log.Warn(
            "too many passages",
            "passages of {} of {} portals are left out, since all would take more than {} MB (-vismemory): vis takes "
            "longer and hides less; -merge makes fewer portals",
            count - passages.NumMade(), count, options.memory);
    if (!options.plain && !units.IsFirstPart())
        passages.TightenMightSee(map, mightSee, jobs);
    return passages;
}

/// What the portal flow starts from: the flood, symmetry and passages, computed or from the store.
struct FlowStart {
    MightSeeTable mightSee;
    std::optional<Passages> passages;
};
FlowStart StartFlow(const VisMap &map, const VisOptions &options, const VisUnits &units, const JobPool &jobs,
                    Log &log) {
    if (units.HasFirstRound()) {
        FlowStart known{MightSeeTable(map.NumPortals()), std::nullopt};
        if (units.FindState(known.mightSee, known.passages))
            return known;
    }
    log.Section(fmt::format("BasePortalVis ({})", map.NumPortals()));
    FlowStart start{FloodMightSee(map, options.farPlane, units, jobs, log), {}};
    if (!options.plain && !units.IsFirstPart())
        ApplySymmetry(map, jobs, start.mightSee);
    if (!options.fast)
        start.passages = MakePassages(map, options, units, jobs, log, start.mightSee);
    return start;
}

/// Runs the passes that the options select. Each pass clears bits in the table of the previous one. Nothing: the run
/// ends with results of units.
std::optional<MightSeeTable> PortalVisibility(const VisMap &map, const VisOptions &options, const VisUnits &units,
                                              const JobPool &jobs, Log &log) {
    log.Print("\n");
    FlowStart start = StartFlow(map, options, units, jobs, log);
    if (units.IsFirstPart())
        return std::nullopt;
    if (units.EndsBeforeFlow()) {
        units.KeepState(start.mightSee, start.passages ? &*start.passages : nullptr);
        return std::nullopt;
    }
    if (options.fast)
        return std::move(start.mightSee);
    const FlowSettings settings{.passages = start.passages ? &*start.passages : nullptr,
                                .clip = !start.passages || !options.passageOnly,
                                .reference = options.plain,
                                .rounds = options.flowRounds,
                                .triesBeforeKeeping = options.triesBeforeKeeping};
    if (start.passages)
        log.Section(fmt::format("{} ({})", settings.clip ? "PassagePortalFlow" : "PassageFlow", map.NumPortals()));
    const std::vector<int> order = OrderPortals(map, start.mightSee, !options.noSort);
    if (units.IsFlowPart()) {
        PartOfPortalFlow(map, order, settings, units, jobs, log, start.mightSee);
        return std::nullopt;
    }
    PortalFlow(map, order, settings, units, jobs, log, start.mightSee);
    return std::move(start.mightSee);
}

/// By cluster, the clusters that it sees: those behind all portals that are seen through a portal of its leaf.
BitTable ClusterRows(const PortalGraph &graph, const VisMap &map, const MightSeeTable &mightSee) {
    const std::size_t clusters = graph.leafs.size();
    std::vector<std::size_t> root(clusters);
    for (std::size_t c = 0; c < clusters; ++c)
        root[c] = std::size_t(graph.Root(int(c)));
    BitTable leafRows(clusters, clusters), rows(clusters, clusters);
    std::vector<BitWord> seen(map.Words());
    for (std::size_t leaf = 0; leaf < clusters; ++leaf) {
        if (root[leaf] != leaf)
            continue;
        std::fill(seen.begin(), seen.end(), BitWord(0));
        for (const int p : map.PortalsOf(int(leaf))) {
            SetBit(seen.data(), map.Column(std::size_t(p)));
            mightSee[std::size_t(p)].ForEachWord([&](std::size_t i, BitWord word) { seen[i] |= word; });
        }
        SetBit(leafRows.Row(leaf), leaf);
        ForEachBit(seen, [&](std::size_t column) {
            SetBit(leafRows.Row(leaf), std::size_t(map.Portal(map.PortalAt(column)).leaf));
        });
    }
    for (std::size_t c = 0; c < clusters; ++c)
        for (std::size_t other = 0; other < clusters; ++other)
            if (leafRows.Test(root[c], root[other]))
                SetBit(rows.Row(c), other);
    return rows;
}

/// Clears both bits of a pair of clusters unless both are set.
void MakeSymmetric(BitTable &rows, std::size_t clusters) {
    for (std::size_t a = 0; a < clusters; ++a)
        for (std::size_t b = 0; b < a; ++b)
            if (rows.Test(a, b) != rows.Test(b, a)) {
                ClearBit(rows.Row(a), b);
                ClearBit(rows.Row(b), a);
            }
}

} // namespace

FarPlane FarPlaneOf(const Entity &world) {
    const std::string_view value = keys::kFarPlaneDist.Text(world);
    FarPlane farPlane;
    farPlane.distance = std::max(0.0, NumberFromText(value));
    if (value.ends_with('o'))
        farPlane.mode = FarPlaneMode::Origins;
    else if (value.ends_with('e'))
        farPlane.mode = FarPlaneMode::Farthest;
    else if (value.ends_with('r'))
        farPlane.mode = FarPlaneMode::RadiusOnly;
    return farPlane;
}

int Visibility::Count(int from) const {
    int count = 0;
    for (std::size_t i = 0; i < rowBytes; ++i)
        count += std::popcount(rows[std::size_t(from) * rowBytes + i]);
    return count;
}

std::vector<std::uint8_t> Visibility::Lump() const {
    std::vector<std::uint8_t> lump(kVisHeaderBytes + rows.size());
    const std::int32_t head[2] = {std::int32_t(clusters), std::int32_t(rowBytes)};
    for (std::size_t i = 0; i < kVisHeaderBytes; ++i)
        lump[i] = std::uint8_t(std::uint32_t(head[i / 4]) >> 8 * (i % 4) & 255);
    std::copy(rows.begin(), rows.end(), lump.begin() + kVisHeaderBytes);
    return lump;
}

int PartRounds(const VisOptions &options) {
    // The reference mode follows one portal after another, from what those before have found.
    return options.fast || options.plain ? 1 : 1 + options.flowRounds;
}

std::optional<Visibility> ComputeVisibility(const PortalFile &file, std::string_view name, const VisOptions &options,
                                            UnitStore *units, const JobPool &jobs, Log &log) {
    PortalGraph graph = BuildPortalGraph(file, name);
    Merge(graph, options, log);
    Visibility result;
    result.clusters = file.clusters;
    result.rowBytes = sizeof(BitWord) * WordsOf(std::size_t(file.clusters));
    log.Print("visdatasize:{}\n", kVisHeaderBytes + std::size_t(result.clusters) * result.rowBytes);
    LogFarPlane(options.farPlane, log);
    const VisMap map(graph, !options.plain);
    const std::optional<MightSeeTable> mightSee = PortalVisibility(map, options, VisUnits(units, &map), jobs, log);
    if (!mightSee)
        return std::nullopt;
    log.Print("creating leaf vis...\n");
    BitTable rows = ClusterRows(graph, map, *mightSee);
    if (!options.plain)
        MakeSymmetric(rows, graph.leafs.size());
    result.rows.resize(std::size_t(result.clusters) * result.rowBytes);
    for (std::size_t c = 0; c < graph.leafs.size(); ++c)
        for (std::size_t i = 0; i < result.rowBytes; ++i)
            result.rows[c * result.rowBytes + i] = std::uint8_t(rows.Row(c)[i / 8] >> 8 * (i % 8) & 255);
    return result;
}

void PrintStatistics(const Visibility &visibility, bool histogram, Log &log) {
    if (visibility.clusters == 0)
        return;
    std::map<int, int> clustersOf; // number of clusters by number of clusters that they see
    double total = 0, squares = 0;
    for (int c = 0; c < visibility.clusters; ++c) {
        const int count = visibility.Count(c);
        clustersOf[count]++;
        total += count;
        squares += double(count) * count;
    }
    if (histogram)
        for (const auto &[count, seeing] : clustersOf)
            log.Verbose("{:4} cluster{} exactly {:4} visible cluster{}\n", seeing, seeing == 1 ? " has" : "s have",
                        count, PluralEnd(count));
    const double clusters = visibility.clusters, average = total / clusters;
    const double deviation = std::sqrt(std::max(0.0, squares / clusters - average * average));
    const int least = clustersOf.begin()->first, most = clustersOf.rbegin()->first;
    log.Print("Total clusters: {}\nTotal visible clusters: {:.0f}\n", visibility.clusters, total);
    log.Print("Average clusters visible: {:.2f} ({:.3f}%/total)\n", average, 100 * average / clusters);
    const auto line = [&](std::string_view what, std::string_view value, double number) {
        log.Print("  {}: {} ({:.3f}%/total)\n", what, value, 100 * number / clusters);
    };
    line("Standard deviation", fmt::format("{:.2f}", deviation), deviation);
    line("Minimum", fmt::format("{}", least), least);
    line("Maximum", fmt::format("{}", most), most);
}

} // namespace q3
