// GPL-2.0-or-later. A small valid map for the tests.
#include "tests/support/sample_bsp.h"
#include "common/error.h"

#include <algorithm>

namespace q3::test {

namespace {

template <std::size_t N> std::array<char, N> Name(std::string_view text) {
    std::array<char, N> field{};
    std::ranges::copy(text, field.begin());
    return field;
}

bspDrawVert_t Vert(float x, float y, float z) {
    return {{x, y, z}, {x / 64, y / 64}, {0.5f, 0.5f}, {0, 0, 1}, {10, 20, 30, 255}};
}

bspDrawSurface_t Surface(BspSurfaceType type, std::int32_t firstVert, std::int32_t numVerts, std::int32_t firstIndex,
                         std::int32_t numIndexes) {
    bspDrawSurface_t surface{};
    surface.fogNum = -1;
    surface.surfaceType = type;
    surface.firstVert = firstVert;
    surface.numVerts = numVerts;
    surface.firstIndex = firstIndex;
    surface.numIndexes = numIndexes;
    surface.lightmapNum[0] = kLightmapByVertex;
    return surface;
}

void AddPlanes(Bsp &bsp) {
    const auto pair = [&bsp](Float3 normal, float dist) {
        bsp.planes.push_back({normal, dist});
        bsp.planes.push_back({{-normal[0], -normal[1], -normal[2]}, -dist});
    };
    pair({1, 0, 0}, 64);
    pair({1, 0, 0}, -64);
    pair({0, 1, 0}, 64);
    pair({0, 1, 0}, -64);
    pair({0, 0, 1}, 0);
    pair({0, 0, 1}, -16);
}

void AddSurfaces(Bsp &bsp) {
    for (const auto &[x, y] : {std::pair{-64.0f, -64.0f}, {-64.0f, 64.0f}, {64.0f, 64.0f}, {64.0f, -64.0f}})
        bsp.drawVerts.push_back(Vert(x, y, 0));
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            bsp.drawVerts.push_back(Vert(float(column) * 16, float(row) * 16, 32));
    for (const float x : {0.0f, 8.0f, 16.0f})
        bsp.drawVerts.push_back(Vert(x, x * x, 64));
    bsp.drawIndexes = {0, 1, 2, 0, 2, 3};
    bsp.drawSurfaces = {Surface(MST_PLANAR, 0, 4, 0, 6), Surface(MST_PATCH, 4, 9, 6, 0),
                        Surface(MST_TRIANGLE_SOUP, 13, 3, 0, 3), Surface(MST_FLARE, 0, 0, 0, 0)};
    bsp.drawSurfaces[1].patchWidth = bsp.drawSurfaces[1].patchHeight = 3;
}

} // namespace

Bsp SampleBsp() {
    Bsp bsp;
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n}\n{\n\"classname\" \"func_door\"\n\"model\" \"*1\"\n}\n";
    bsp.shaders = {{Name<64>("textures/base/floor"), 0, 1}, {Name<64>("noshader"), 0, 1}};
    AddPlanes(bsp);
    bsp.nodes = {{8, {-2, 1}, {-64, -64, -16}, {64, 64, 128}}, {10, {-3, -4}, {-64, -64, -64}, {64, 64, 0}}};
    bsp.leafs = {{0, 0, {}, {}, 0, 0, 0, 0},
                 {0, 0, {-64, -64, 0}, {64, 64, 128}, 0, 4, 0, 0},
                 {-1, -1, {INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}, 0, 0, 0, 2},
                 {1, 0, {}, {}, 4, 0, 2, 0}};
    bsp.leafSurfaces = {0, 1, 2, 3};
    bsp.leafBrushes = {0, 1};
    bsp.models = {{{-64, -64, -16}, {64, 64, 128}, 0, 4, 0, 1}, {{-64, -64, -16}, {64, 64, 0}, 4, 0, 1, 1}};
    bsp.brushes = {{0, 6, 0}, {6, 6, 0}};
    for (int brush = 0; brush < 2; brush++)
        for (const int plane : {3, 0, 7, 4, 11, 8})
            bsp.brushSides.push_back({plane, 1});
    AddSurfaces(bsp);
    bsp.fogs = {{Name<64>("textures/fog"), 0, 5}};
    for (std::uint8_t i = 0; i < 18; i++)
        bsp.gridPoints.push_back({{{i, 2, 3}}, {{4, 5, 6}}, kOnlyStyle0, {7, 8}});
    // A header of two integers, then the rows: two clusters that see both.
    constexpr std::uint8_t kClusters = 2, kRowBytes = 8;
    bsp.visibility.assign(8 + kClusters * kRowBytes, 0);
    bsp.visibility[0] = kClusters;
    bsp.visibility[4] = kRowBytes;
    bsp.visibility[8] = bsp.visibility[8 + kRowBytes] = 3;
    return bsp;
}

LightGridSH SampleGridSH() {
    LightGridSH grid{{{-64, -64, 0}, {64, 64, 128}, {2, 3, 1}, 6}, {}};
    for (int i = 0; i < 6; i++) {
        bspGridPointSH_t point{};
        for (std::size_t k = 0; k < 9; k++)
            point.coeffs[k] = {float(i) + 0.25f, -float(k), float(i) * float(k)};
        grid.points.push_back(point);
    }
    return grid;
}

std::vector<std::byte> GridLump(const LightGridSH &grid) {
    std::vector<std::byte> lump(40 + 108 * grid.points.size());
    std::memcpy(lump.data(), &grid.header, 40);
    std::memcpy(lump.data() + 40, grid.points.data(), 108 * grid.points.size());
    return lump;
}

bspAdvertisement_t SampleAdvertisement() {
    return {7, {0, 0, 1}, {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, Name<64>("*1")};
}

std::string ErrorOf(const std::function<void()> &action) {
    try {
        action();
    } catch (const Error &error) {
        return error.what();
    }
    return "no error";
}

std::int32_t IntAt(const std::vector<std::byte> &file, std::size_t at) {
    std::int32_t value = 0;
    std::memcpy(&value, &file.at(at), sizeof value);
    return value;
}

void SetInt(std::vector<std::byte> &file, std::size_t at, std::int32_t value) {
    std::memcpy(&file.at(at), &value, sizeof value);
}

} // namespace q3::test
