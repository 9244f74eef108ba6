// GPL-2.0-or-later. Small scenes for tests of the benchmark.
#pragma once

#include "tests/support/game_folder.h"
#include "tests/support/scene/scene_builder.h"
#include "tools/measure/shbench/truth.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace q3::test {

/// A scene as the benchmark sees it, with shaders of the test's own.
class BenchTest : public testing::Test {
  protected:
    static constexpr double kRoom = 512; ///< the room is that cube around the origin, times 2

    /// A room without anything in it.
    static SceneBuilder Room();
    static Entity PointLight(const Vec3f &origin, double intensity);
    /// Keep the result no longer than the test. `script` of shaders, if any, counts from the first call on.
    std::unique_ptr<bench::BenchMap> Map(const SceneBuilder &scene, std::string_view options = "",
                                         const std::string &script = "");
    ShaderLibrary &Library() { return *library_; }

    GameFolder folder;

  private:
    KeptLog log_;
    std::unique_ptr<VirtualFileSystem> vfs_;
    std::unique_ptr<ShaderLibrary> library_;
};

} // namespace q3::test
