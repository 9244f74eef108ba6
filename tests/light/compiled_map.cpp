// GPL-2.0-or-later. The map sources of tests/data/maps through the bsp stage.
#include "tests/light/compiled_map.h"

#include "common/files.h"
#include "q3map2/geometry/compile_map.h"
#include "tests/common/game_folder.h"

#include <gtest/gtest.h>

namespace q3::test {

Bsp CompiledMapOf(std::string_view name, std::initializer_list<std::pair<std::string, std::string>> keys) {
    QuietLog out;
    VirtualFileSystem vfs(out.log);
    vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
    BspOptions options;
    options.meta = options.keepLights = true;
    const Game &game = *FindGame("quake3");
    ShaderLibrary library(vfs, game, {}, out.log);
    const BspContext context{options, game, library, out.log, &vfs};
    const std::string file = fmt::format("{}/maps/{}.map", TEST_DATA, name);
    const std::vector<std::byte> bytes = ReadFile(file);
    Map map = ReadMap({reinterpret_cast<const char *>(bytes.data()), bytes.size()}, file, context);
    for (const auto &[key, value] : keys)
        map.World().pairs.Set(key, value);
    CompiledMap compiled = CompileMap(map, context);
    EXPECT_TRUE(compiled.leakLine.empty()) << file << " leaks";
    return std::move(compiled.bsp);
}

} // namespace q3::test
