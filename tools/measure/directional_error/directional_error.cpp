// GPL-2.0-or-later. directional_error: error and size of the directional encodings of lightmaps.
#include "common/arguments.h"
#include "common/error.h"
#include "common/files/files.h"
#include "common/tool_main.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "q3map2/stages/light_files.h"
#include "tools/measure/directional_error/measure.h"

#include <map>
#include <optional>

namespace q3::directional {

namespace {

constexpr std::string_view kUsage = R"(usage: directional_error [options] MAP.bsp...
  --luxels N      luxels of each map (1000)
  --normals N     normals within 60 degrees of each (32)
  --rays N        rays of bounced light for each reference value (4096)
  --bounce N      bounces (2)
  -fs_basepath DIR, -fs_game MOD, -game NAME, -threads N   as for q3map2
Prints a table: displayed RMSE in bytes of 255 over normals, by map; the same at the luxel's own normal, over all maps;
bytes a luxel; and CPU time of baking over that of flat light. The reference is the light that the light stage would
store in a luxel of that normal.
)";

void Print(const std::vector<std::string> &names, const std::vector<MapErrors> &maps) {
    std::string head = "| encoding | bytes |", line = "|---|---|";
    for (const std::string &name : names)
        head += fmt::format(" {} |", name), line += "---|";
    fmt::print("{} own normal |\n{}---|\n", head, line);
    for (std::size_t e = 0; e < maps.front().encodings.size(); ++e) {
        const EncodingError &first = maps.front().encodings[e];
        fmt::print("| {} | {} |", first.name, first.bytes);
        double atOwnNormal = 0;
        for (const MapErrors &map : maps) {
            fmt::print(" {:.2f} |", map.encodings[e].rmse);
            atOwnNormal += map.encodings[e].atOwnNormal / double(maps.size());
        }
        fmt::print(" {:.2f} |\n", atOwnNormal);
    }
    fmt::print("| stored light of the own normal against the reference | |");
    for (const MapErrors &map : maps)
        fmt::print(" {:.2f} |", map.flatAgainstTraced);
    fmt::print(" |\n\n| CPU time over flat |");
    for (const std::string &name : names)
        fmt::print(" {} |", name);
    fmt::print("\n|---|");
    for (std::size_t i = 0; i < names.size(); ++i)
        fmt::print("---|");
    for (std::size_t t = 0; t < maps.front().times.size(); ++t) {
        fmt::print("\n| {} |", maps.front().times[t].name);
        for (const MapErrors &map : maps)
            fmt::print(" {:.2f} |", map.times[t].overFlat);
    }
    fmt::print("\n");
}

int Run(const std::vector<std::string> &words) {
    Arguments arguments(words);
    if (arguments.TakeFlag({"--help", "-h"}) || arguments.Empty()) {
        fmt::print("{}", kUsage);
        return 0;
    }
    const int luxels = arguments.TakeInteger("--luxels", 1000, 1), normals = arguments.TakeInteger("--normals", 32, 1);
    const int rays = arguments.TakeInteger("--rays", 4096, 1), bounces = arguments.TakeInteger("--bounce", 2, 0);
    Log log(PrintWarnings);
    const GlobalOptions game = ParseGlobalOptions(arguments, log);
    const VirtualFileSystem files = OpenGameFiles(game, GameFolders(game, {}, {}), log);
    LightmapOptions options;
    options.bounces = bounces;
    options.bounceGrid = true; // LuxelBake::LightOn needs it
    options.rnmAll = true;     // for all surfaces, where Measure turns rnm on
    options.gamePageSize = options.pageSize = {game.game->lightmapSize, game.game->lightmapSize};
    const JobPool jobs(game.threads);
    std::vector<std::string> names;
    std::vector<MapErrors> maps;
    if (arguments.Rest().empty())
        throw Error("expected a .bsp");
    for (const std::string &map : arguments.Rest()) {
        const Bsp bsp = ReadBspFile(map, game.Format(), log);
        const LightInputs inputs = ReadLightInputs(FilesOf(map), log);
        LightOptions light;
        ShaderLibrary library(files, *game.game, light.shader, log);
        for (const bspShader_t &shader : bsp.shaders)
            library.SetDefaultFlags(FieldName(shader.shader), shader.surfaceFlags, shader.contentFlags);
        const LightSetup setup(bsp, inputs, light, SurfaceDefaultsOf(options), library, log);
        library.ReleaseImages(bounces > 0 ? KeptImages::OfReflectors : KeptImages::SeeThrough);
        names.push_back(inputs.name);
        maps.push_back(Measure(setup, options, std::size_t(luxels), normals, rays, jobs, log));
    }
    Print(names, maps);
    return 0;
}

} // namespace

} // namespace q3::directional

int main(int count, char **words) {
    return q3::RunTool("directional_error", count, words, q3::directional::Run);
}
