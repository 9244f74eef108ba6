// GPL-2.0-or-later. Small scenes for tests of the benchmark.
#include "tests/tools/shbench/bench_fixture.h"

namespace q3::test {

SceneBuilder BenchTest::Room() {
    SceneBuilder scene;
    const float half = float(kRoom);
    scene.SetInterior({-half, -half, -half}, {half, half, half}, {"textures/test/wall"});
    scene.SetWorldKey("_keepLights", "1");
    return scene;
}

Entity BenchTest::PointLight(const Vec3f &origin, double intensity) {
    return {{{"classname", "light"},
             {"origin", fmt::format("{} {} {}", origin.x, origin.y, origin.z)},
             {"light", fmt::format("{}", intensity)}}};
}

std::unique_ptr<bench::BenchMap> BenchTest::Map(const SceneBuilder &scene, std::string_view options,
                                                const std::string &script) {
    const Game &game = *FindGame("quake3");
    if (!library_) {
        folder.Write("scripts/shaderlist.txt", std::string_view("test\n"));
        folder.Write("scripts/test.shader", std::string_view(script));
        vfs_ = std::make_unique<VirtualFileSystem>(log_.log);
        vfs_->Mount(folder.Root(), game.archiveExtension);
        library_ = std::make_unique<ShaderLibrary>(*vfs_, game, ShaderOptions{}, log_.log);
    }
    return std::make_unique<bench::BenchMap>(scene.Build(), LightInputs{"test", {}, {}},
                                             bench::LightOptionsFrom(options, game), *library_, log_.log);
}

} // namespace q3::test
