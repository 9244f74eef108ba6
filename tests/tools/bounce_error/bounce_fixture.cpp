// GPL-2.0-or-later. Small scenes for tests of the path tracer.
#include "tests/tools/bounce_error/bounce_fixture.h"

#include "q3map2/light/sources/light_sources.h"
#include "q3map2/lightmap/raw/luxel_map.h"

namespace q3::test {

TracedScene::TracedScene(Bsp map, ShaderLibrary &library, const LightmapOptions &options, int threads)
    : bsp(std::move(map)), lightmap(options),
      setup(bsp, LightInputs{"test", {}, {}}, LightOptions{}, SurfaceDefaultsOf(options), library, log.log),
      table(setup.table),
      jobs(threads), in{bsp, setup.space, setup.scene, table, setup.options, lightmap, setup.world, jobs, log.log} {
    library.ReleaseImages(KeptImages::OfReflectors);
}

void TracedScene::Prepare() {
    surfaces = SetupSurfaceLight(in);
    MapLuxels(in, surfaces);
    int culled = 0;
    lights.emplace(in, SetupEnvelopes(setup.lights, LightPass::Surfaces, in.options, in.space, setup.skySeenFrom,
                                      culled, lightmap.fastPoint));
    tracer.emplace(in, surfaces, *lights);
}

void TracedScene::Shine(std::string_view shader, float light) {
    for (SurfaceEntry &entry : table)
        if (entry.shader->name == shader)
            entry.ambient = {light, light, light};
}

SceneBuilder PathTest::Room() {
    SceneBuilder scene;
    scene.SetInterior({-kHalf, -kHalf, -kHalf}, {kHalf, kHalf, kHalf}, {"textures/test/wall"});
    scene.SetWorldKey("_keepLights", "1");
    return scene;
}

const VirtualFileSystem &PathTest::Files() {
    if (!vfs_) {
        folder.Write("scripts/shaderlist.txt", std::string_view("test\n"));
        folder.Write("scripts/test.shader", std::string_view(script_));
        const std::vector<std::uint8_t> white(3, 255), wall(3, gray_);
        for (const char *name : {"bright", "panel", "lamp"})
            folder.Write(fmt::format("textures/test/{}.tga", name), EncodeTga(white, 1, 1, 3, TgaRows::TopFirst));
        folder.Write("textures/test/wall.tga", EncodeTga(wall, 1, 1, 3, TgaRows::TopFirst));
        vfs_ = std::make_unique<VirtualFileSystem>(log_.log);
        vfs_->Mount(folder.Root(), FindGame("quake3")->archiveExtension);
    }
    return *vfs_;
}

std::unique_ptr<TracedScene> PathTest::Make(const SceneBuilder &scene, float reflectance, int threads) {
    if (!library_)
        library_ = std::make_unique<ShaderLibrary>(Files(), *FindGame("quake3"), ShaderOptions{}, log_.log);
    options.bounceScale = reflectance / (187.5f * 3 / 255);
    return std::make_unique<TracedScene>(scene.Build(), *library_, options, threads);
}

std::vector<Vec3f> PathTest::PlacesOn(BoxFace wall, int side) {
    const auto axis = std::size_t(wall) / 2;
    std::vector<Vec3f> places;
    for (int v = 0; v < side; ++v)
        for (int u = 0; u < side; ++u) {
            Vec3f at;
            at[axis] = std::size_t(wall) % 2 == 0 ? -kHalf : kHalf;
            at[(axis + 1) % 3] = kHalf * ((2 * float(u) + 1) / float(side) - 1);
            at[(axis + 2) % 3] = kHalf * ((2 * float(v) + 1) / float(side) - 1);
            places.push_back(at + InwardOf(wall) * 0.01f);
        }
    return places;
}

Vec3f PathTest::InwardOf(BoxFace wall) {
    Vec3f inward;
    inward[std::size_t(wall) / 2] = std::size_t(wall) % 2 == 0 ? 1.0f : -1.0f;
    return inward;
}

} // namespace q3::test
