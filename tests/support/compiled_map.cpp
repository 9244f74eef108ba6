// GPL-2.0-or-later. The map sources of tests/data/maps through the bsp stage.
#include "tests/support/compiled_map.h"

#include "common/files/files.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/map/map_parse.h"
#include "tests/support/game_folder.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace {

using Keys = std::initializer_list<std::pair<std::string, std::string>>;

Bsp Compiled(std::string_view text, const std::string &name, const Keys &keys, VirtualFileSystem &vfs, Log &log) {
    BspOptions options;
    options.meta = options.keepLights = true;
    const Game &game = *FindGame("quake3");
    ShaderLibrary library(vfs, game, {}, log);
    const BspContext context{options, game, library, log, &vfs};
    Map map = ReadMap(text, name, context);
    for (const auto &[key, value] : keys)
        map.World().pairs.Set(key, value);
    CompiledMap compiled = CompileMap(map, context);
    EXPECT_TRUE(compiled.leakLine.empty()) << name << " leaks";
    return std::move(compiled.bsp);
}

} // namespace

Bsp CompiledMapOf(std::string_view name, std::initializer_list<std::pair<std::string, std::string>> keys) {
    KeptLog out;
    VirtualFileSystem vfs(out.log);
    vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
    const std::string file = fmt::format("{}/maps/{}.map", TEST_DATA, name);
    return Compiled(ReadTextFile(file), file, keys, vfs, out.log);
}

Bsp CompiledText(std::string_view text, VirtualFileSystem &vfs) {
    KeptLog out;
    return Compiled(text, "text", {}, vfs, out.log);
}

Bsp CompiledScene(const SceneBuilder &scene, VirtualFileSystem &vfs) {
    if (!scene.HasMapText())
        return scene.Build();
    return CompiledText(scene.MapText(), vfs);
}

} // namespace q3::test
