// GPL-2.0-or-later. vis_check: whether the visibility data of a map hides something that can be seen.
#include "common/arguments.h"
#include "common/error.h"
#include "common/text/text.h"
#include "common/tool_main.h"
#include "q3map2/bspfile/bspfile.h"
#include "tools/measure/vis_check/sight_check.h"

namespace q3 {

namespace {

constexpr std::string_view kUsage = R"(usage: vis_check [options] A.bsp B.bsp ...
  --pairs N       pairs of points in open leafs (1000000)
  --margin F      a hidden pair is an error only if parallel lines this many units around are clear too (0.5)
  --seed N        of the random points (1)
Exit status 1: a map hides clusters that see each other, or an error.
)";

int Run(const std::vector<std::string> &words) {
    Arguments arguments(words);
    if (arguments.TakeFlag({"--help", "-h"}) || arguments.Empty()) {
        fmt::print("{}", kUsage);
        return 0;
    }
    const auto marginText = arguments.TakeValue("--margin").value_or("0.5");
    std::string_view rest = marginText;
    const std::optional<double> margin = TakeNumber(rest);
    if (!margin || *margin < 0 || !rest.empty())
        throw Error("--margin {}: expected a number from 0 up", marginText);
    const int pairs = arguments.TakeInteger("--pairs", 1000000, 1);
    const auto seed = std::uint32_t(arguments.TakeInteger("--seed", 1, 0));
    bool anyMissing = false;
    Log log(PrintWarnings);
    while (!arguments.Empty()) {
        const std::string path = arguments.TakeFirst();
        const SightCheck check = CheckSight(ReadBspFile(path, {}, log), pairs, float(*margin), seed);
        fmt::print("{}: {} pairs, {} with a clear line of sight, {} of them hidden by the PVS, {} of those with lines "
                   "{} units around clear too",
                   path, check.pairs, check.clear, check.hidden, check.missing, *margin);
        if (check.missing > 0)
            fmt::print(" (the first: clusters {} and {})", check.from, check.to);
        fmt::print("\n");
        anyMissing |= check.missing > 0;
    }
    return anyMissing ? 1 : 0;
}

} // namespace

} // namespace q3

int main(int count, char **words) {
    return q3::RunTool("vis_check", count, words, q3::Run);
}
