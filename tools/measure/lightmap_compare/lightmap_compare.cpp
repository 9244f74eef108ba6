// GPL-2.0-or-later. lightmap_compare: two lit files of one map, surface by surface.
#include "common/arguments.h"
#include "common/error.h"
#include "common/files/files.h"
#include "common/tool_main.h"
#include "q3map2/cli/global_options.h"
#include "tools/measure/lightmap_compare/compare.h"

#include <optional>

namespace q3::compare {

namespace {

constexpr std::string_view kUsage = R"(usage: lightmap_compare [options] A.bsp B.bsp
  --samples N     points on each surface (1000)
  --worst N       surfaces to list (10)
  --pagesize N    side of the pages in the files (128)
  --json FILE     the same as JSON
Both files must be of one map. Pages are those of the file, or lm_NNNN.tga in the folder of its name. Samples that are
black in one file, in solids where nobody sees them, or on texels that no luxel of their surface covers, are counted, not
compared. Every surface has as many samples; the line "by area" weighs them by the area of their surface. Vertex colors
of skies and of surfaces that no engine draws have a line of their own, and with the game's files,
-fs_basepath DIR [-fs_game MOD] [-game NAME], so have those that the shader does not draw.
)";

int Run(const std::vector<std::string> &words) {
    Arguments arguments(words);
    if (arguments.TakeFlag({"--help", "-h"}) || arguments.Empty()) {
        fmt::print("{}", kUsage);
        return 0;
    }
    const int samples = arguments.TakeInteger("--samples", 1000, 1), worst = arguments.TakeInteger("--worst", 10, 0);
    const int side = arguments.TakeInteger("--pagesize", 128, 2);
    const auto jsonFile = arguments.TakeValue("--json");
    Log log(PrintWarnings);
    const GlobalOptions game = ParseGlobalOptions(arguments, log);
    if (arguments.Rest().size() != 2)
        throw Error("expected two files, got {} words", arguments.Rest().size());
    std::optional<VirtualFileSystem> files; // the library keeps a reference
    std::optional<ShaderLibrary> shaders;
    if (!game.basePaths.empty()) {
        files.emplace(OpenGameFiles(game, GameFolders(game, {}, {}), log));
        shaders.emplace(*files, *game.game, ShaderOptions{}, log);
    }
    const LitMap a = LitMap::Load(arguments.Rest()[0], side, log), b = LitMap::Load(arguments.Rest()[1], side, log);
    const Comparison comparison = Compare(a, b, samples, std::size_t(worst), shaders ? &*shaders : nullptr);
    fmt::print("{}", ToText(comparison));
    if (jsonFile) {
        const std::string json = ToJson(comparison);
        ReplaceTextFile(*jsonFile, json);
    }
    return 0;
}

} // namespace

} // namespace q3::compare

int main(int count, char **words) {
    return q3::RunTool("lightmap_compare", count, words, q3::compare::Run);
}
