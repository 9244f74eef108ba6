// GPL-2.0-or-later. q3map2 -vis: the .bsp and its .prt in, visibility data into the .bsp.
#include "common/error.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/command_record.h"
#include "q3map2/stages.h"
#include "q3map2/vis/vis.h"

#include <algorithm>
#include <system_error>

namespace q3 {

namespace {

struct VisSwitches {
    VisOptions options;
    bool savePrt = false, histogram = false;
};

VisSwitches ParseVisOptions(Arguments &arguments, Log &log) {
    VisSwitches switches;
    VisOptions &options = switches.options;
    const auto take = [&](std::string_view name, bool &to) {
        if (!arguments.TakeFlag(name))
            return;
        to = true;
        log.Print("{} = true\n", name == "-fast" ? "fastvis" : LowerCase(name.substr(1)));
    };
    take("-fast", options.fast);
    take("-merge", options.merge);
    take("-mergeportals", options.mergePortals);
    take("-nopassage", options.noPassage);
    take("-passageOnly", options.passageOnly);
    take("-nosort", options.noSort);
    take("-saveprt", switches.savePrt);
    take("-hint", options.keepHints);
    take("-plain", options.plain);
    options.merge |= options.keepHints;
    options.passageOnly &= !options.noPassage;
    if (arguments.TakeFlag("-v")) {
        switches.histogram = true;
        log.Print("Extra verbose mode enabled\n");
    }
    for (const std::string &word : arguments.Rest())
        log.Warn("unknown argument", "Unknown option \"{}\"", word);
    return switches;
}

void CheckClusters(const Bsp &bsp, const std::filesystem::path &bspPath, const PortalFile &portals,
                   const std::filesystem::path &prtPath) {
    int clusters = 0;
    for (const bspLeaf_t &leaf : bsp.leafs)
        clusters = std::max(clusters, leaf.cluster + 1);
    if (clusters != portals.clusters)
        throw Error("{}:2: {} clusters, expected the {} of {}; compile the map again", prtPath.string(),
                    portals.clusters, clusters, bspPath.string());
}

void RemovePrt(const std::filesystem::path &path, Log &log) {
    std::error_code failed;
    if (!std::filesystem::remove(path, failed) && failed)
        log.Warn("file not removed", "{}: cannot be removed: {}", path.string(), failed.message());
}

} // namespace

int VisStage(const StageContext &context, Arguments arguments) {
    Log &log = context.log;
    const std::string file = arguments.TakeLast();
    if (file.empty())
        throw Error("usage: q3map2 [global options] -vis [options] maps/x.bsp");
    log.Section("Vis");
    const std::vector<std::string> recorded = arguments.Rest();
    VisSwitches switches = ParseVisOptions(arguments, log);
    const auto bspPath = WithExtension(std::filesystem::absolute(file), ".bsp");
    const auto prtPath = WithExtension(bspPath, ".prt");

    log.Print("Loading {}\n", bspPath.string());
    const BspFormat format = context.options.Format();
    Bsp bsp = ReadBspFile(bspPath, format, log);
    log.Print("Loading {}\n", prtPath.string());
    const PortalFile portals = ReadPortalFile(prtPath);
    log.Print("{:6} portalclusters\n{:6} numportals\n{:6} numfaces\n", portals.clusters, portals.portals.size(),
              portals.faces.size());
    if (portals.portals.empty()) {
        log.Print("No portals means no vis, exiting.\n");
        return 0;
    }
    CheckClusters(bsp, bspPath, portals, prtPath);
    const std::string name = bspPath.string();
    RecordCommand(bsp, "-vis", name, recorded);
    switches.options.farPlane = FarPlaneOf(ParseEntities(bsp.entities, name).front());

    const JobPool jobs(context.options.threads);
    const Visibility visibility = ComputeVisibility(portals, prtPath.string(), switches.options, jobs, log);
    PrintStatistics(visibility, switches.histogram, log);
    bsp.visibility = visibility.Lump();
    WriteBspFile(bspPath, bsp, format, log);
    if (!switches.savePrt)
        RemovePrt(prtPath, log);
    return 0;
}

} // namespace q3
