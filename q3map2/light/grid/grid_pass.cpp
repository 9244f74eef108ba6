// GPL-2.0-or-later. Statistics of a pass over a light grid.
#include "q3map2/light/grid/grid_pass.h"

namespace q3 {

void GridStats::Add(const GridStats &o) {
    open += o.open, moved += o.moved, filled += o.filled;
    skippedFaint += o.skippedFaint, skippedReach += o.skippedReach, skippedPvs += o.skippedPvs;
    skippedSmooth += o.skippedSmooth;
    counts += o.counts;
}

void GridStats::Print(Log &log) const {
    log.Count(open, "points in the open");
    if (moved > 0)
        log.Count(moved, "points in solids lit from the nearest open position");
    if (filled > 0)
        log.Count(filled, "points in solids filled from neighbors");
    log.Count((long long)(counts.rays), "rays");
    const auto count = [&](std::uint64_t number, const char *what) { log.VerboseCount((long long)(number), what); };
    count(skippedPvs, "pairs of brick and light hidden by visibility data, skipped (-noskippvs)");
    count(skippedReach, "pairs of brick and light out of reach, skipped (-noskipreach)");
    count(skippedFaint, "pairs of brick and light too faint, represented by others (-noskipfaint)");
    count(skippedSmooth, "points and samples with weak light interpolated (-noskipsmooth)");
    count(counts.pairs, "pairs of point and light");
    count(counts.skippedPvs, "hidden by visibility data, skipped (-noskippvs)");
    count(counts.skippedFacing, "out of reach, cone or side");
    count(counts.skippedFaint, "too faint, represented by others (-noskipfaint)");
    count(counts.skippedProbes, "with a faint area light, judged by one ray (-noskipprobes)");
    count(counts.skippedMoments, "with a far area light, approximated by points (-noskipmoments)");
    count(counts.skippedCoarse, "with visibility taken from neighbors that agree (-noskipcoarse)");
    count(counts.refined, "with an area light partly hidden, refined");
    if (seconds > 0)
        log.Verbose("{:9.2f} million rays per second of the pass\n", double(counts.rays) / seconds / 1e6);
}

} // namespace q3
