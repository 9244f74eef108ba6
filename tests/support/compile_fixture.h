// GPL-2.0-or-later. A room as map text, and the bsp stage run on such text.
#pragma once

#include "common/error.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/map/map_parse.h"
#include "tests/support/game_folder.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {

inline constexpr std::string_view kScript = R"(
textures/test/wall
{
	q3map_textureSize 64 32
}
textures/test/sky
{
	surfaceparm sky
	surfaceparm nolightmap
	skyparms env/dawn 512 -
}
textures/test/glass
{
	surfaceparm trans
	q3map_remapShader textures/test/panes
}
textures/test/caulk
{
	surfaceparm nodraw
}
textures/test/back
{
	surfaceparm detail
	q3map_invert
}
textures/test/moved
{
	surfaceparm detail
	q3map_tcMod scale 2 3
	q3map_tcMod translate 40 0.25
	q3map_alphaMod set 0.5
	q3map_rgbMod scale ( 0.5 1 0 )
	q3map_offset 3
}
textures/test/dim
{
	surfaceparm detail
	surfaceparm trans
	q3map_rgbMod volume
	q3map_rgbMod set ( 0 0 1 )
}
textures/test/mist
{
	surfaceparm fog
	surfaceparm nonsolid
	surfaceparm trans
	fogparms ( 0.5 0.5 0.5 ) 300
}
)";

/// One side of a box: axis 0..2, outwards to less or to more.
inline std::string SideText(int axis, bool more, double dist, std::string_view shader) {
    Vec3d corner, u, v;
    corner[std::size_t(axis)] = dist;
    u[std::size_t((axis + 1) % 3)] = 64;
    v[std::size_t((axis + 2) % 3)] = 64;
    const Vec3d second = corner + (more ? v : u), third = corner + (more ? u : v);
    std::string text;
    for (const Vec3d &p : {corner, second, third})
        text += fmt::format("( {} {} {} ) ", p.x, p.y, p.z);
    return text + fmt::format("{} 0 0 0 0.5 0.5 0 0 0\n", shader);
}

inline std::string Box(const Vec3d &mins, const Vec3d &maxs, std::string_view shader = "test/wall") {
    std::string text = "{\n";
    for (int axis = 0; axis < 3; ++axis) {
        text += SideText(axis, false, mins[std::size_t(axis)], shader);
        text += SideText(axis, true, maxs[std::size_t(axis)], shader);
    }
    return text + "}\n";
}

/// Walls of 16 units around a room 256 x 256 x 128; `hole`: without its top.
inline std::string RoomText(bool hole = false) {
    std::string text = Box({-144, -144, -16}, {-128, 144, 144}) + Box({128, -144, -16}, {144, 144, 144}) +
                       Box({-128, -144, -16}, {128, -128, 144}) + Box({-128, 128, -16}, {128, 144, 144}) +
                       Box({-128, -128, -16}, {128, 128, 0});
    return hole ? text : text + Box({-128, -128, 128}, {128, 128, 144});
}

inline constexpr std::string_view kStart = "{\n\"classname\" \"info_player_start\"\n\"origin\" \"0 0 32\"\n}\n";
inline constexpr std::string_view kLight = "{\n\"classname\" \"light\"\n\"origin\" \"0 0 96\"\n\"light\" \"300\"\n}\n";

inline std::string WorldText(const std::string &brushes, std::string_view keys = "") {
    return fmt::format("{{\n\"classname\" \"worldspawn\"\n{}{}}}\n", keys, brushes);
}
inline std::string MapText(const std::string &brushes, std::string_view keys = "") {
    return WorldText(brushes, keys) + std::string(kStart) + std::string(kLight);
}

/// Compiles map text with -meta and the shaders of kScript and of scripts that a test writes.
class CompileTest : public testing::Test {
  protected:
    CompileTest() {
        options.meta = true;
        folder.Write("scripts/test.shader", kScript);
        vfs.Mount(folder.Root(), "pk3");
    }
    CompiledMap Compile(const std::string &text) {
        ShaderOptions shaderOptions;
        shaderOptions.imageSizes = true;
        library = std::make_unique<ShaderLibrary>(vfs, game, shaderOptions, out.log);
        const BspContext context{options, game, *library, out.log, &vfs};
        Map map = ReadMap(text, "test.map", context);
        CompiledMap result = CompileMap(map, context);
        if (!result.abandoned && result.caulkFile.empty()) {
            const BspFormat format;
            EXPECT_NO_THROW(ReadBsp(WriteBsp(result.bsp, format), "test.bsp", format, out.log));
        }
        return result;
    }
    std::string ShaderOf(const Bsp &bsp, const bspDrawSurface_t &surface) const {
        return std::string(FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader));
    }
    std::vector<bspDrawSurface_t> SurfacesOf(const Bsp &bsp, std::string_view shader) const {
        std::vector<bspDrawSurface_t> found;
        std::ranges::copy_if(bsp.drawSurfaces, std::back_inserter(found),
                             [&](const auto &surface) { return ShaderOf(bsp, surface) == shader; });
        return found;
    }

    GameFolder folder;
    KeptLog out;
    VirtualFileSystem vfs{out.log};
    Game game = *FindGame("quake3");
    BspOptions options;
    std::unique_ptr<ShaderLibrary> library;
};

} // namespace q3::test
