// GPL-2.0-or-later. A game folder with scripts and models, and a small map made by hand.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/map/map_brush.h"
#include "tests/support/game_folder.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

class ExtraTest : public testing::Test {
  protected:
    ExtraTest() {
        map.entities.resize(1);
        map.entities[0].pairs.Set("classname", "worldspawn");
        Script("textures/test/wall\n{\n}\n");
    }
    /// Adds to the shader scripts; before anything looks a shader up.
    void Script(const std::string &text) {
        scripts += text;
        folder.Write(fmt::format("{}/test.shader", FindGame(gameName)->shaderDir), scripts);
    }
    const BspContext &Context() {
        if (!context) {
            vfs.emplace(out.log);
            vfs->Mount(folder.Root(), "pk3");
            library.emplace(*vfs, *FindGame(gameName), ShaderOptions{}, out.log);
            context.reset(new BspContext{options, *FindGame(gameName), *library, out.log, &*vfs});
        }
        return *context;
    }
    const ShaderInfo &Shader(std::string_view name) { return Context().shaders.Get(name); }
    MapEntity &AddEntity(std::initializer_list<std::pair<std::string, std::string>> pairs) {
        MapEntity &entity = map.entities.emplace_back();
        entity.number = int(map.entities.size()) - 1;
        entity.pairs.pairs = pairs;
        entity.origin = entity.pairs.Vector({"origin"}).value_or(Vec3f{});
        return entity;
    }
    /// A box of the world with this shader on all sides. Its index.
    int AddBox(const Vec3d &mins, const Vec3d &maxs, std::string_view shader) {
        Brush brush;
        for (std::size_t i = 0; i < 6; ++i) { // -x +x -y +y -z +z
            BrushSide side;
            Vec3d normal;
            normal[i / 2] = i % 2 == 0 ? -1 : 1;
            side.plane = {normal, i % 2 == 0 ? -mins[i / 2] : maxs[i / 2]};
            side.hasPlane = true;
            side.planeNum = map.planes.Find(normal, side.plane.dist);
            side.shader = &Shader(shader);
            side.compileFlags = side.shader->compileFlags;
            brush.sides.push_back(side);
        }
        SetBrushContents(brush, Context());
        EXPECT_TRUE(MakeBrushWindings(brush, map.planes));
        for (BrushSide &side : brush.sides)
            side.visibleHull = side.winding;
        map.World().brushes.push_back(brush);
        return int(map.World().brushes.size()) - 1;
    }
    /// A 3 x 3 patch in the plane z = height that faces up.
    static Patch FlatPatch(float x0, float y0, float x1, float y1, float height, const ShaderInfo &shader) {
        Patch patch;
        patch.shader = &shader;
        patch.width = patch.height = 3;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) {
                DrawVert vert;
                vert.xyz = {x0 + (x1 - x0) * float(column) / 2, y0 + (y1 - y0) * float(row) / 2, height};
                vert.normal = {0, 0, 1};
                vert.st = {float(column) / 2, float(row) / 2};
                patch.verts.push_back(vert);
            }
        return patch;
    }
    static Vec3d TriangleNormal(const DrawSurface &s, std::size_t triangle) {
        const auto at = [&](std::size_t k) { return Vec3d(s.verts[std::size_t(s.indexes[3 * triangle + k])].xyz); };
        return Normalize(Cross(at(2) - at(0), at(1) - at(0)));
    }
    static Boundsf BoundsOf(const DrawSurface &s) {
        Boundsf bounds;
        for (const DrawVert &vert : s.verts)
            bounds.Add(vert.xyz);
        return bounds;
    }

    KeptLog out;
    GameFolder folder;
    std::string scripts;
    std::string_view gameName = "quake3"; ///< before scripts are added
    BspOptions options;
    std::optional<VirtualFileSystem> vfs;
    std::optional<ShaderLibrary> library;
    std::unique_ptr<BspContext> context;
    Map map;
    Geometry geometry;
};

} // namespace q3::test
