// GPL-2.0-or-later. Maps of loose convex brushes, drawn as minimaps.
#pragma once

#include "q3map2/minimap/minimap.h"
#include "tests/support/library_fixture.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace q3::test {

/// Brushes without a tree or surfaces. The world is a box of 128 x 128 x 256 game units from 0 0 0 on.
class MinimapTest : public LibraryTest {
  protected:
    MinimapTest() {
        bsp.models = {{{0, 0, 0}, {128, 128, 256}, 0, 0, 0, 0}};
        AddShader("textures/wall", 1);
        options.sharpen = -1;
    }

    int AddShader(std::string_view name, std::uint32_t contents) {
        bspShader_t shader{{}, 0, contents};
        std::ranges::copy(name, shader.shader.begin());
        bsp.shaders.push_back(shader);
        return int(bsp.shaders.size()) - 1;
    }
    void AddBrush(const std::vector<bspPlane_t> &planes, int shader = 0) {
        bsp.brushes.push_back({int(bsp.brushSides.size()), int(planes.size()), shader});
        for (const bspPlane_t &plane : planes) {
            bsp.brushSides.push_back({int(bsp.planes.size()), shader});
            bsp.planes.push_back(plane);
        }
        ++bsp.models.front().numBSPBrushes;
    }
    /// Sides in the order of compiled brushes: -x, +x, -y, +y, -z, +z.
    static std::vector<bspPlane_t> BoxPlanes(const Float3 &mins, const Float3 &maxs) {
        std::vector<bspPlane_t> planes;
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const float sign : {-1.0f, 1.0f}) {
                bspPlane_t plane{{0, 0, 0}, sign < 0 ? -mins[axis] : maxs[axis]};
                plane.normal[axis] = sign;
                planes.push_back(plane);
            }
        return planes;
    }
    void AddBox(const Float3 &mins, const Float3 &maxs, int shader = 0) { AddBrush(BoxPlanes(mins, maxs), shader); }

    Minimap Draw(int size, std::string_view game = "quake3", int threads = 1) {
        if (!library)
            Load();
        options.size = size;
        return DrawMinimap(bsp, *library, options, MinimapStyleOf(game), JobPool(threads), out.log);
    }
    std::vector<float> Values(int size) { return Draw(size).image.values; }

    Bsp bsp;
    MinimapOptions options;
};

} // namespace q3::test
