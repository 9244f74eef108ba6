// GPL-2.0-or-later. A map of one brush and one face, and helpers for tests of the convert stages.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/shader/games.h"
#include "tests/support/kept_log.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

namespace q3::test {

template <std::size_t N> std::array<char, N> Field(std::string_view text) {
    std::array<char, N> field{};
    std::copy(text.begin(), text.end(), field.begin());
    return field;
}

/// Box (0 0 0) to (64 64 64), one lit face, solid below x = 64 and open space above, two light grid points.
inline Bsp SmallBsp() {
    Bsp bsp;
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"message\" \"a \\ b\"\n}\n{\n\"classname\" \"light\"\n}\n";
    // Surface flags and contents; any will do. CONTENTS_SOLID is 1, CONTENTS_DETAIL 0x8000000.
    bsp.shaders = {{Field<64>("textures/base/wall"), 0x1C00, 1}, {Field<64>("noshader"), 0, 0x8000001}};
    for (std::size_t axis = 0; axis < 3; axis++)
        for (const float dist : {64.0f, 0.0f})
            for (const float sign : {1.0f, -1.0f}) {
                bspPlane_t plane{{sign * 0.0f, sign * 0.0f, sign * 0.0f}, sign * dist};
                plane.normal[axis] = sign;
                bsp.planes.push_back(plane);
            }
    bsp.nodes = {{0, {-2, -3}, {-8, -8, -8}, {108, 28, 38}}};
    bsp.leafs = {{}, {0, 0, {64, 0, 0}, {100, 20, 30}, 0, 1, 0, 0}, {-1, -1, {0, 0, 0}, {64, 20, 30}, 0, 0, 0, 1}};
    bsp.leafSurfaces = {0};
    bsp.leafBrushes = {0};
    bsp.models = {{{0, 0, 0}, {100, 20, 30}, 0, 1, 0, 1}};
    bsp.brushes = {{0, 6, 0}};
    for (const int plane : {3, 0, 7, 4, 11, 8})
        bsp.brushSides.push_back({plane, 1});
    for (int i = 0; i < 4; i++) {
        const float u = float(i / 2), v = float((i + 1) / 2 % 2);
        bsp.drawVerts.push_back({{64, 64 * u, 64 * v}, {u, v}, {0.1f * u, 0.25f * v}, {1, 0, 0}, {1, 2, 3, 255}});
    }
    bsp.drawIndexes = {0, 1, 2, 0, 2, 3};
    bsp.fogs = {{Field<64>("textures/fog"), 0, 5}};
    bspDrawSurface_t surface{};
    surface.surfaceType = MST_PLANAR;
    surface.fogNum = -1;
    surface.numVerts = 4;
    surface.numIndexes = 6;
    surface.lightmapNum[0] = kLightmapByVertex;
    surface.lightmapVecs[2] = {1, 0, 0};
    bsp.drawSurfaces = {surface};
    bsp.gridPoints = {{{{1, 2, 3}}, {{4, 5, 6}}, kOnlyStyle0, {7, 8}},
                      {{{9, 10, 11}}, {{12, 13, 14}}, kOnlyStyle0, {15, 16}}};
    bsp.visibility = {1, 0, 0, 0, 8, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}; // 1 cluster, rows of 8 bytes, it sees itself
    return bsp;
}

/// 2 x 1 x 2 points: the first in solid and void, the second in the open, the third in solid and filled.
inline LightGridSH SmallGridSH() {
    LightGridSH grid;
    grid.header = {{0, 0, 0}, {70, 32, 64}, {2, 1, 2}, 4};
    grid.points.resize(4);
    for (std::size_t i = 1; i < 4; i++)
        for (std::size_t k = 0; k < 9; k++)
            grid.points[i].coeffs[k] = {float(i), -float(k) / 8, 1e-7f};
    return grid;
}

/// The map with one of everything, foreign lumps and all.
inline Bsp FullBsp(GridSHContainer container) {
    Bsp bsp = SmallBsp();
    bsp.gridSH = SmallGridSH();
    bsp.gridSHContainer = container;
    bsp.bspx = {{"RGBLIGHTING", {std::byte(0), std::byte(0xAB)}}, {"EMPTY", {}}};
    bsp.lightmaps.resize(kLightmapPageBytes);
    for (std::size_t i = 0; i < bsp.lightmaps.size(); i++)
        bsp.lightmaps[i] = std::uint8_t(i * 7);
    bsp.advertisements = {{7, {1, 0, 0}, {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}}}, Field<64>("*0")}};
    return bsp;
}

/// All bytes of a map in a format that has room for everything.
inline std::vector<std::byte> Bytes(const Bsp &bsp) {
    return WriteBsp(bsp, {.version = 47, .advertisements = true});
}

inline const Game &Quake3() {
    return *FindGame("quake3");
}

/// An empty folder that goes when the test ends.
class TempFolder {
  public:
    TempFolder() {
        const auto *test = testing::UnitTest::GetInstance()->current_test_info();
        std::string name = fmt::format("q3convert_{}_{}_{}", test->test_suite_name(), test->name(), getpid());
        std::replace(name.begin(), name.end(), '/', '_'); // of parameterised tests
        path_ = std::filesystem::temp_directory_path() / name;
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TempFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TempFolder(const TempFolder &) = delete;
    TempFolder &operator=(const TempFolder &) = delete;

    const std::filesystem::path &Path() const { return path_; }
    std::string Text(std::string_view file) const {
        std::ifstream stream(path_ / file, std::ios::binary);
        EXPECT_TRUE(stream.is_open()) << file;
        std::ostringstream text;
        text << stream.rdbuf();
        return text.str();
    }
    void Put(std::string_view file, std::string_view text) const {
        std::ofstream(path_ / file, std::ios::binary) << text;
    }
    bool Has(std::string_view file) const { return std::filesystem::exists(path_ / file); }
    /// Replaces the only occurrence of `from`.
    void Edit(std::string_view file, std::string_view from, std::string_view to) const {
        std::string text = Text(file);
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << file << " has no " << from;
        ASSERT_EQ(text.find(from, at + 1), std::string::npos) << file << " has more than one " << from;
        Put(file, text.replace(at, from.size(), to));
    }
    std::vector<std::string> Files() const {
        std::vector<std::string> names;
        for (const auto &entry : std::filesystem::directory_iterator(path_))
            names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }

  private:
    std::filesystem::path path_;
};

} // namespace q3::test
