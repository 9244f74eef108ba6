// GPL-2.0-or-later. One small map with everything that steps over surfaces read.
#pragma once

#include "common/error.h"
#include "q3map2/light/light_setup.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_map.h"
#include "q3map2/lightmap/raw/luxel_normal.h"
#include "tests/support/compiled_map.h"
#include "tests/support/game_folder.h"
#include "tests/support/scene/scene_builder.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace q3::test {

/// Shaders of the surfaces under test; the room has others.
inline constexpr std::string_view kA = "textures/test/a", kB = "textures/test/b";

inline void ExpectVector(const Vec3f &got, const Vec3f &expected, float within = 1e-3f) {
    EXPECT_NEAR(got.x, expected.x, within);
    EXPECT_NEAR(got.y, expected.y, within);
    EXPECT_NEAR(got.z, expected.z, within);
}

/// What a case is made of, besides the map.
struct CaseSettings {
    LightmapOptions lightmap{};
    LightOptions light{};
    std::string script{};   ///< shaders
    std::string surfaces{}; ///< a surface file
    int threads = 1;
};

/// Reads shaders from `folder`, to which the script is written.
class SurfaceCase {
  public:
    SurfaceCase(Bsp map, const GameFolder &folder, CaseSettings given = {})
        : settings(WithScript(std::move(given), folder)), bsp(std::move(map)), vfs(Mounted(folder)),
          library(vfs, *FindGame("quake3"), settings.light.shader, quiet.log),
          entities(ParseEntities(bsp.entities, "test")), world(ReadWorldLight(entities.front(), settings.light)),
          table(MakeSurfaceTable(bsp, entities, settings.surfaces, "test.srf", library, quiet.log, Defaults())),
          space(bsp, OpaqueBrushes(bsp, library)), scene(bsp, table, settings.light, 64), jobs(settings.threads) {}

    /// The scene goes through the bsp stage first, if its parts allow.
    SurfaceCase(const SceneBuilder &parts, const GameFolder &folder, CaseSettings given = {})
        : SurfaceCase(Compiled(parts, folder, given.script), folder, given) {}

    SurfaceInputs Inputs() {
        return {bsp, space, scene, table, settings.light, settings.lightmap, world, jobs, quiet.log};
    }
    SurfaceLight Setup() { return SetupSurfaceLight(Inputs()); }
    /// Set up, smoothed and mapped.
    SurfaceLight Mapped() {
        SurfaceLight surfaces = Setup();
        SmoothNormals(Inputs(), surfaces);
        MapLuxels(Inputs(), surfaces);
        FindTangents(Inputs(), surfaces);
        return surfaces;
    }

    CaseSettings settings;
    KeptLog quiet;
    Bsp bsp;
    VirtualFileSystem vfs;
    ShaderLibrary library;
    std::vector<Entity> entities;
    WorldLight world;
    SurfaceTable table;
    BspSpace space;
    LightScene scene;
    JobPool jobs;

  private:
    static CaseSettings WithScript(CaseSettings given, const GameFolder &folder) {
        folder.Write("scripts/shaderlist.txt", "test\n");
        folder.Write("scripts/test.shader", given.script);
        return given;
    }
    static Bsp Compiled(const SceneBuilder &parts, const GameFolder &folder, const std::string &script) {
        KeptLog log;
        folder.Write("scripts/shaderlist.txt", "test\n");
        folder.Write("scripts/test.shader", script);
        VirtualFileSystem files(log.log);
        files.Mount(folder.Root(), "pk3");
        return CompiledScene(parts, files);
    }
    VirtualFileSystem Mounted(const GameFolder &folder) {
        VirtualFileSystem files(quiet.log);
        files.Mount(folder.Root(), "pk3");
        return files;
    }
    SurfaceDefaults Defaults() const {
        SurfaceDefaults defaults = SurfaceDefaultsOf(settings.lightmap);
        defaults.ambient = world.ambient;
        return defaults;
    }
};

inline SceneShader Shaded(std::string_view name) {
    return {std::string(name), 0, 1};
}

/// An empty room with walls of one shader, of which the tests take no notice.
inline SceneBuilder EmptyRoom(const Vec3f &mins = {-1024, -1024, -1024}, const Vec3f &maxs = {1024, 1024, 1024}) {
    SceneBuilder scene;
    scene.SetInterior(mins, maxs, Shaded("textures/test/wall"));
    return scene;
}

/// A rectangle at height z that faces up.
inline std::array<Vec3f, 4> Rectangle(float x0, float y0, float x1, float y1, float z) {
    return {{{x0, y1, z}, {x1, y1, z}, {x1, y0, z}, {x0, y0, z}}};
}

/// Draw surfaces of that shader.
inline std::vector<int> SurfacesOf(const SurfaceCase &c, std::string_view shader) {
    std::vector<int> numbers;
    for (std::size_t i = 0; i < c.table.size(); ++i)
        if (c.table[i].shader->name == shader)
            numbers.push_back(int(i));
    return numbers;
}

/// The raw lightmap of the only surface of that shader.
inline const RawLightmap &LightmapOf(const SurfaceCase &c, const SurfaceLight &surfaces, std::string_view shader) {
    const std::vector<int> numbers = SurfacesOf(c, shader);
    if (numbers.size() != 1 || surfaces.lightmapOf[std::size_t(numbers[0])] < 0)
        throw Error("{} surfaces of {}, or no lightmap", numbers.size(), shader);
    return surfaces.lightmaps[std::size_t(surfaces.lightmapOf[std::size_t(numbers[0])])];
}

} // namespace q3::test
