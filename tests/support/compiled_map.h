// GPL-2.0-or-later. The map sources of tests/data/maps, and scenes, through the bsp stage.
#pragma once

#include "common/files/vfs.h"
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/scene/scene_builder.h"

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace q3::test {

/// tests/data/maps/NAME.map after -meta, lights kept, with the shaders of tests/data/vectors; milliseconds each time.
/// `keys` are added to those of its world. Fails the test when the map leaks.
Bsp CompiledMapOf(std::string_view name, std::initializer_list<std::pair<std::string, std::string>> keys = {});

/// The map source through the bsp stage, with the shaders of `vfs`.
Bsp CompiledText(std::string_view text, VirtualFileSystem &vfs);

/// The scene through the bsp stage, likewise, with the shaders of `vfs`; by Build if it has no map source.
Bsp CompiledScene(const SceneBuilder &scene, VirtualFileSystem &vfs);

} // namespace q3::test
