// GPL-2.0-or-later. Small scenes for tests of the path tracer.
#pragma once

#include "tests/support/game_folder.h"
#include "tests/support/scene/scene_builder.h"
#include "tools/measure/bounce_error/reference.h"

#include "q3map2/light/light_setup.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"

#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace q3::test {

/// A scene ready for tracing. Neither copied nor moved, since its parts refer to each other.
class TracedScene {
  public:
    TracedScene(Bsp map, ShaderLibrary &library, const LightmapOptions &options, int threads);
    /// To be called once the table is as it should be.
    void Prepare();
    /// Gives surfaces whose shader has that name ambient light: the light that they reflect.
    void Shine(std::string_view shader, float light);
    bounce::Estimate At(const Vec3f &position, const Vec3f &normal, int paths, std::uint64_t seed = 0) const {
        return tracer->OnSurface({&position, 1}, normal, paths, seed);
    }

    KeptLog log;
    const Bsp bsp;
    const LightmapOptions lightmap;
    const LightSetup setup;
    SurfaceTable table;
    const JobPool jobs;
    const SurfaceInputs in;
    SurfaceLight surfaces;
    std::optional<bounce::DirectLights> lights;
    std::optional<bounce::PathTracer> tracer;
};

class PathTest : public testing::Test {
  protected:
    static constexpr float kHalf = 256; ///< of the room, a cube around the origin
    /// A room whose six walls have shaders textures/test/wall.
    static SceneBuilder Room();
    /// Shaders of the test, before the first Make.
    void Script(std::string_view text) { script_ += text; }
    /// The gray of textures/test/wall, a byte.
    void WallGray(std::uint8_t gray) { gray_ = gray; }
    /// reflectance: of a white texture.
    std::unique_ptr<TracedScene> Make(const SceneBuilder &scene, float reflectance, int threads = 1);
    /// Places even over a wall and on it: side x side.
    static std::vector<Vec3f> PlacesOn(BoxFace wall, int side);
    static Vec3f InwardOf(BoxFace wall);

    /// Scripts and images, written at the first call.
    const VirtualFileSystem &Files();

    GameFolder folder;
    LightmapOptions options;

  private:
    std::string script_;
    std::uint8_t gray_ = 255;
    KeptLog log_;
    std::unique_ptr<VirtualFileSystem> vfs_;
    std::unique_ptr<ShaderLibrary> library_;
};

} // namespace q3::test
