// GPL-2.0-or-later. Draw surfaces made by hand, and what steps of the bsp stage need to work on them.
#pragma once

#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/geometry/faces/meta.h"
#include "tests/support/game_folder.h"

#include <deque>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

class FaceTest : public testing::Test {
  protected:
    FaceTest() {
        shader.name = "textures/test/wall";
        options.meta = true;
    }
    /// A face of the polygon, clockwise seen from its front; texture coordinates are x / 64 and y / 64.
    DrawSurface &AddFace(const Polygon &w, const ShaderInfo &of) {
        DrawSurface surface;
        surface.kind = SurfaceKind::Face;
        surface.shader = &of;
        const Vec3d normal = Normalize(-WindingAreaVector(w));
        surface.planeNum = planes.Find(normal, Dot(normal, Vec3d(w.front())));
        for (const Vec3f &p : w) {
            DrawVert v;
            v.xyz = p, v.normal = Vec3f(planes[surface.planeNum].normal);
            v.st = {p.x / 64, p.y / 64};
            surface.verts.push_back(v);
        }
        geometry.surfaces.push_back(surface);
        return geometry.surfaces.back();
    }
    DrawSurface &AddFace(const Polygon &w) { return AddFace(w, shader); }
    /// The rectangle of the plane z = height, facing up.
    DrawSurface &AddFloor(float x0, float y0, float x1, float y1, float height = 0) {
        return AddFace({{x0, y0, height}, {x0, y1, height}, {x1, y1, height}, {x1, y0, height}});
    }
    /// Classification and the meta step; what they made.
    std::vector<DrawSurface> Meta() {
        ClassifySurfaces(geometry, 0, planes, context);
        MakeMetaSurfaces(geometry, 0, planes, context);
        std::vector<DrawSurface> made;
        for (const DrawSurface &s : geometry.surfaces)
            if (!s.Empty())
                made.push_back(s);
        return made;
    }
    /// Sum of the triangles' area vectors, turned to point to the front.
    static Vec3d AreaVector(const DrawSurface &s) {
        Vec3d sum;
        for (std::size_t i = 0; i + 2 < s.indexes.size(); i += 3) {
            const auto at = [&](std::size_t k) { return Vec3d(s.verts[std::size_t(s.indexes[i + k])].xyz); };
            sum += Cross(at(2) - at(0), at(1) - at(0)) * 0.5;
        }
        return sum;
    }
    static double Area(const std::vector<DrawSurface> &surfaces) {
        double sum = 0;
        for (const DrawSurface &s : surfaces)
            sum += Length(AreaVector(s));
        return sum;
    }

    KeptLog out;
    GameFolder folder;
    const Game &game = *FindGame("quake3");
    VirtualFileSystem vfs{out.log};
    ShaderLibrary library{vfs, game, {}, out.log};
    BspOptions options;
    BspContext context{options, game, library, out.log};
    PlaneTable planes{0.00005, 0.005};
    Geometry geometry;
    ShaderInfo shader;
};

} // namespace q3::test
