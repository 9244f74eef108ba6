// GPL-2.0-or-later. Raw lightmaps made by hand, and the maps that they are stored in.
#pragma once

#include "q3map2/light/sources/light_entities.h"
#include "q3map2/lightmap/direct/lightmap_average.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/store/lightmap_store.h"
#include "tests/support/game_folder.h"
#include "tests/support/scene/scene_builder.h"

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace q3::test {

/// A room of six quads of the shaders textures/test/wall0 to wall5, with one raw lightmap each unless said otherwise.
class StoreTest : public testing::Test {
  protected:
    StoreTest();

    /// Adds a shader script. Before MakeLightmaps.
    void Script(std::string_view text);
    /// One raw lightmap of that size a surface, all luxels in cluster 0, not yet lit.
    void MakeLightmaps(int width, int height, int super = 1);
    /// Sets the light of a style's slot on all super luxels.
    void Fill(RawLightmap &lightmap, const std::function<Vec3f(int x, int y)> &color, std::size_t slot = 0);
    void FillNoise(RawLightmap &lightmap, std::uint32_t seed, std::size_t slot = 0);
    /// Takes the luxel away: no surface and no light there.
    static void Unmap(RawLightmap &lightmap, int x, int y);

    void Average(const SurfacePass &pass = {}, bool last = true, int threads = 1);
    StoredLightmaps Store(int threads = 1, std::string_view mapName = "room");
    /// Average and Store.
    StoredLightmaps Finish(int threads = 1, std::string_view mapName = "room");

    /// Color of the page at luxel (x, y) of a surface, found through its first vertex. Not for solid ones.
    std::array<int, 3> Shown(const StoredLightmaps &stored, std::size_t surface, int x, int y) const;
    std::array<int, 3> Direction(const StoredLightmaps &stored, std::size_t surface, int x, int y) const;
    const LightmapPage &PageOf(const StoredLightmaps &stored, std::size_t surface) const;
    std::string_view ShaderOf(std::size_t surface) const;
    static std::array<int, 3> Bytes(const Vec3f &color) { return {int(color.x), int(color.y), int(color.z)}; }

    GameFolder folder;
    std::string printed;
    Log log{[this](LogLevel, std::string_view text) { printed += text; }};
    LightOptions options;
    LightmapOptions lightmap;
    WorldLight world;
    Bsp bsp;
    std::unique_ptr<ShaderLibrary> library;
    SurfaceTable table;
    SurfaceLight surfaces;

  private:
    std::size_t Texel(const LightmapPage &page, std::size_t surface, int x, int y) const;
    void Use(int threads, const std::function<void(const SurfaceInputs &)> &body);

    std::string script_;
};

} // namespace q3::test
