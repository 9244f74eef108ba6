// GPL-2.0-or-later. The engine-side reader on sparse SH grids, against the definition of their field.
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile.h"
#include "tests/libs/shgrid/random_tree.h"
#include "tests/support/sample_bsp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

using namespace q3;
using namespace q3::test;

namespace {

/// A tree as the reader sees it. Values of the tree become those that are stored.
struct ReadTree {
    RandomTree tree;
    std::vector<std::byte> lump;
    shgrid_grid grid{};

    ReadTree(const TreeShape &shape, unsigned seed) : tree(shape, seed) { Pack(); }
    void Pack() {
        const SparseGridSH packed = PackSparseGrid(tree.Tree());
        tree.SetValues(DequantizePoints(packed));
        lump = EncodeSparseGrid(packed);
        ASSERT_EQ(shgrid_parse(lump.data(), lump.size(), &grid), SHGRID_OK);
    }
    shgrid_coeffs Sample(const std::array<double, 3> &at) const {
        float position[3];
        for (std::size_t axis = 0; axis < 3; ++axis)
            position[axis] = float(double(grid.mins[axis]) + at[axis] * double(grid.cell[axis]));
        shgrid_coeffs coeffs;
        shgrid_sample(&grid, position, &coeffs);
        return coeffs;
    }
};

/// A position in smallest cells that float holds exactly: on a point, an edge, a face, or inside a cell.
std::array<double, 3> RandomPlace(std::mt19937 &random, const Int3 &bounds) {
    std::array<double, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int sixteenth = std::uniform_int_distribution(0, 16 * bounds[axis])(random);
        at[axis] = (random() & 1) != 0 ? sixteenth / 16.0 : sixteenth / 16;
    }
    return at;
}

const TreeShape kReadShapes[] = {{{1, 1, 1}, 1, 0, 0, 0.25f},     {{2, 1, 1}, 2, 0.5, 0, 0.25f},
                                 {{1, 2, 1}, 3, 0.6, 0, 0.25f},   {{1, 1, 1}, 4, 0.4, 0, 0.25f},
                                 {{2, 2, 1}, 3, 0.5, 0.3, 0.25f}, {{1, 1, 2}, 4, 0.5, 0.5, 0.25f},
                                 {{3, 1, 1}, 2, 1, 0.1, 0.25f},   {{1, 1, 1}, 5, 0.35, 0.2, 0.25f}};

TEST(SparseReader, SamplesAreTheFieldOfTheDefinition) {
    std::mt19937 random(11);
    int hanging = 0, partial = 0;
    for (const TreeShape &shape : kReadShapes)
        for (unsigned seed = 0; seed < 4; ++seed) {
            const ReadTree read(shape, seed);
            for (const SparseGridNode &node : read.tree.Tree().nodes)
                hanging += std::popcount(node.hanging);
            for (int i = 0; i < 1500; ++i) {
                const std::array<double, 3> at = RandomPlace(random, read.tree.Bounds());
                const SlowValue slow = read.tree.Blend(at);
                if (!(slow.weight > 1e-6))
                    continue;
                partial += slow.weight < 0.999;
                const shgrid_coeffs fast = read.Sample(at);
                for (std::size_t n = 0; n < 27; ++n)
                    ASSERT_NEAR(fast.c[n / 3][n % 3], slow.sum[n] / slow.weight, 3e-6)
                        << at[0] << " " << at[1] << " " << at[2];
            }
        }
    EXPECT_GT(hanging, 500);
    EXPECT_GT(partial, 1000);
}

TEST(SparseReader, PointsAreTheFieldAtTheLattice) {
    const ReadTree read({{1, 2, 1}, 3, 0.5, 0.3, 0.25f}, 3);
    const Int3 bounds = read.tree.Bounds();
    for (int z = 0; z < bounds[2]; ++z)
        for (int y = 0; y < bounds[1]; ++y)
            for (int x = 0; x < bounds[0]; ++x) {
                shgrid_coeffs point;
                shgrid_point(&read.grid, x, y, z, &point);
                const SlowValue slow = read.tree.Blend({double(x), double(y), double(z)});
                for (std::size_t n = 0; n < 27; ++n)
                    ASSERT_NEAR(point.c[n / 3][n % 3], slow.weight > 0 ? slow.sum[n] / slow.weight : 0, 3e-6);
            }
}

TEST(SparseReader, LinearLightStaysLinearAcrossCellsOfAllSizes) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        ReadTree read({{2, 1, 1}, 4, 0.5, 0, 0.25f}, seed);
        std::vector<bspGridPointSH_t> values;
        for (const Int3 &at : read.tree.Places()) {
            bspGridPointSH_t value{};
            const float linear = float(1024 + 8 * at[0] + 16 * at[1] - 4 * at[2]) / 4096; // exact as RGB9E5
            value.coeffs[0] = {linear, linear, linear};
            values.push_back(value);
        }
        read.tree.SetValues(values);
        read.Pack();
        std::mt19937 random(seed);
        for (int i = 0; i < 1000; ++i) {
            std::array<double, 3> at{};
            const Int3 bounds = read.tree.Bounds();
            for (std::size_t axis = 0; axis < 3; ++axis)
                at[axis] = std::uniform_real_distribution<>(0, bounds[axis])(random);
            if (read.tree.Blend(at).weight < 0.9999)
                continue; // at the far border
            const double expected = (1024 + 8 * at[0] + 16 * at[1] - 4 * at[2]) / 4096;
            EXPECT_NEAR(read.Sample(at).c[0][1], expected, 1e-6);
        }
    }
}

TEST(SparseReader, IsContinuousAcrossFacesOfCellsOfDifferentSizes) {
    constexpr double apart = 1.0 / 1024;
    std::mt19937 random(17);
    int unequal = 0;
    for (unsigned seed = 0; seed < 8; ++seed) {
        const ReadTree read({{2, 1, 1}, 4, 0.5, 0, 0.25f}, seed);
        const Int3 bounds = read.tree.Bounds();
        for (int i = 0; i < 3000; ++i) {
            const std::size_t axis = random() % 3;
            std::array<double, 3> at{};
            for (std::size_t other = 0; other < 3; ++other)
                at[other] = std::uniform_int_distribution(16, 64 * bounds[other] - 64)(random) / 64.0;
            at[axis] = std::floor(at[axis]) + 1;
            if (at[axis] >= bounds[axis])
                continue;
            std::array<double, 3> below = at;
            below[axis] -= apart;
            const auto size = [&](const std::array<double, 3> &place) {
                return read.tree.SizeAt({int(place[0]), int(place[1]), int(place[2])});
            };
            if (read.tree.Blend(at).weight < 0.9999 || read.tree.Blend(below).weight < 0.9999)
                continue; // at the far border
            unequal += size(at) != size(below);
            const shgrid_coeffs a = read.Sample(at), b = read.Sample(below);
            for (std::size_t n = 0; n < 27; ++n) // values are within 1 of each other, cells at least 1 wide
                ASSERT_NEAR(a.c[n / 3][n % 3], b.c[n / 3][n % 3], 1.5 * apart);
        }
    }
    EXPECT_GT(unequal, 1000);
}

TEST(SparseReader, ExpandsToAnyLattice) {
    const ReadTree read({{1, 1, 1}, 3, 0.5, 0.2, 0.25f}, 5);
    const float mins[3] = {-60, 12, 90}, cell[3] = {12.5f, 40, 9};
    const std::int32_t bounds[3] = {9, 3, 5};
    std::vector<shgrid_coeffs> all(9 * 3 * 5);
    shgrid_expand(&read.grid, mins, cell, bounds, all.data());
    for (int i = 0; i < 9 * 3 * 5; ++i) {
        const float position[3] = {mins[0] + float(i % 9) * cell[0], mins[1] + float(i / 9 % 3) * cell[1],
                                   mins[2] + float(i / 27) * cell[2]};
        shgrid_coeffs coeffs;
        shgrid_sample(&read.grid, position, &coeffs);
        EXPECT_EQ(std::memcmp(&coeffs, &all[std::size_t(i)], sizeof coeffs), 0);
    }
}

TEST(SparseReader, OddPositionsReadTheBorder) {
    const ReadTree read({{1, 1, 1}, 3, 0.5, 0, 0.25f}, 5);
    const float low[3] = {-37, 12.5f, 100}, up[3] = {0, 0, 1};
    float expected[3], rgb[3];
    shgrid_light(&read.grid, low, up, expected);
    for (const float odd : {NAN, -INFINITY, -3e38f, -1e4f}) {
        const float position[3] = {odd, odd, odd};
        shgrid_light(&read.grid, position, up, rgb);
        EXPECT_EQ(std::memcmp(rgb, expected, sizeof rgb), 0) << odd;
    }
    for (const float odd : {INFINITY, 3e38f, 1e5f}) {
        const float position[3] = {odd, odd, odd};
        shgrid_coeffs coeffs;
        shgrid_sample(&read.grid, position, &coeffs);
        EXPECT_GE(coeffs.c[0][0], 0.249f) << odd;
    }
}

TEST(SparseReader, RightOnAPointWithoutAValueTheCellsOthersCount) {
    RandomTree tree({{1, 1, 1}, 1, 0, 0, 0.25f}, 1);
    SparseGridTree without = tree.Tree();
    without.nodes[0].stored = 0xFE;
    without.values.erase(without.values.begin());
    const std::vector<std::byte> lump = EncodeSparseGrid(PackSparseGrid(without));
    shgrid_grid grid;
    ASSERT_EQ(shgrid_parse(lump.data(), lump.size(), &grid), SHGRID_OK);
    const std::vector<bspGridPointSH_t> stored = DequantizePoints(DecodeSparseGrid(lump));
    double mean = 0;
    for (const bspGridPointSH_t &value : stored)
        mean += double(value.coeffs[0][0]) / 7;
    shgrid_coeffs coeffs;
    shgrid_sample(&grid, grid.mins, &coeffs);
    EXPECT_NEAR(coeffs.c[0][0], mean, 1e-6);
    shgrid_point(&grid, 0, 0, 0, &coeffs);
    EXPECT_EQ(coeffs.c[0][0], 0);
}

TEST(SparseReader, MapsWithBothFormsGiveTheOneAskedFor) {
    const ReadTree read({{1, 1, 1}, 2, 0.5, 0, 0.25f}, 2);
    for (const GridSHContainer container : {GridSHContainer::Lump, GridSHContainer::Bspx}) {
        Bsp bsp = SampleBsp();
        bsp.gridSHContainer = container;
        bsp.gridSH = SampleGridSH();
        shgrid_grid grid;
        const auto load = [&](shgrid_form form) {
            const std::vector<std::byte> file = WriteBsp(bsp, {});
            const shgrid_result result = shgrid_load_form(file.data(), file.size(), form, &grid);
            return std::pair{result, grid.levels};
        };
        EXPECT_EQ(load(SHGRID_ANY), std::pair(SHGRID_OK, 0));
        EXPECT_EQ(load(SHGRID_SPARSE), std::pair(SHGRID_ABSENT, 0));
        bsp.sparseGridSH = DecodeSparseGrid(read.lump);
        EXPECT_EQ(load(SHGRID_ANY), std::pair(SHGRID_OK, 2));
        EXPECT_EQ(load(SHGRID_SPARSE), std::pair(SHGRID_OK, 2));
        EXPECT_EQ(load(SHGRID_UNIFORM), std::pair(SHGRID_OK, 0));
        EXPECT_EQ(grid.count, 6);
        bsp.gridSH.reset();
        EXPECT_EQ(load(SHGRID_ANY), std::pair(SHGRID_OK, 2));
        EXPECT_EQ(load(SHGRID_UNIFORM), std::pair(SHGRID_ABSENT, 0));
    }
}

/// What the reader makes of a lump in memory of exactly that size; samples and fills textures if it is good.
shgrid_result TryLump(const std::vector<std::byte> &lump) {
    shgrid_grid grid;
    const shgrid_result result = shgrid_parse(lump.data(), lump.size(), &grid);
    if (result != SHGRID_OK) {
        EXPECT_EQ(grid.nodes, nullptr);
        return result;
    }
    std::mt19937 random(1);
    for (int i = 0; i < 50; ++i) {
        float position[3];
        for (int axis = 0; axis < 3; ++axis)
            position[axis] = grid.mins[axis] + grid.cell[axis] * std::uniform_real_distribution<float>(-1, 20)(random);
        shgrid_coeffs coeffs;
        shgrid_sample(&grid, position, &coeffs);
        for (int n = 0; n < 27; ++n)
            EXPECT_TRUE(std::isfinite(coeffs.c[n / 3][n % 3]));
    }
    return result;
}

TEST(SparseReader, RefusesTruncatedLumps) {
    const ReadTree read({{2, 1, 1}, 2, 0.5, 0.1, 0.25f}, 9);
    for (std::size_t length = 0; length < read.lump.size(); ++length)
        EXPECT_NE(TryLump(std::vector(read.lump.begin(), read.lump.begin() + std::ptrdiff_t(length))), SHGRID_OK);
}

TEST(SparseReader, AgreesWithTheProgramAboutDamagedLumps) {
    std::mt19937 random(23);
    int good = 0, bad = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        const ReadTree read(kReadShapes[seed % std::size(kReadShapes)], seed);
        for (int round = 0; round < 400; ++round) {
            std::vector<std::byte> lump = read.lump;
            const std::size_t nodes = 12 * read.tree.Tree().nodes.size();
            for (unsigned change = 0; change <= random() % 2; ++change) {
                const std::size_t from = (random() & 3) != 0 ? 64 + nodes : 64; // nodes and head count most
                lump[random() % std::min(from, lump.size())] = std::byte(random() & 255);
            }
            const bool accepted = ErrorOf([&] { DecodeSparseGrid(lump); }) == "no error";
            const bool uniform = std::memcmp(lump.data(), "SHGS", 4) != 0;
            EXPECT_EQ(TryLump(lump) == SHGRID_OK, accepted && !uniform);
            (accepted ? good : bad)++;
        }
    }
    EXPECT_GT(good, 300);
    EXPECT_GT(bad, 2000);
}

TEST(SparseReader, NamesWhatIsWrong) {
    const ReadTree read({{1, 1, 1}, 2, 1, 0, 0.25f}, 1);
    const auto result = [&](std::size_t at, std::int32_t value) {
        std::vector<std::byte> lump = read.lump;
        SetInt(lump, at, value);
        return TryLump(lump);
    };
    const int inf = 0x7f800000;
    EXPECT_EQ(result(4, 2), SHGRID_BAD_VERSION);
    EXPECT_EQ(result(8, 0), SHGRID_BAD_COUNT);
    EXPECT_EQ(result(8, -1), SHGRID_TRUNCATED);
    for (std::size_t axis = 0; axis < 12; axis += 4) {
        EXPECT_EQ(result(12 + axis, inf), SHGRID_BAD_MINS);
        EXPECT_EQ(result(24 + axis, inf), SHGRID_BAD_CELL);
        EXPECT_EQ(result(24 + axis, 0), SHGRID_BAD_CELL);
        EXPECT_EQ(result(36 + axis, 0), SHGRID_BAD_BOUNDS);
        EXPECT_EQ(result(36 + axis, 1 << 23), SHGRID_BAD_BOUNDS);
        EXPECT_EQ(result(36 + axis, 10), SHGRID_BAD_NODES);
    }
    EXPECT_EQ(result(48, 0), SHGRID_BAD_LEVELS);
    EXPECT_EQ(result(48, 13), SHGRID_BAD_LEVELS);
    EXPECT_EQ(result(52, 8), SHGRID_BAD_COUNT);
    EXPECT_EQ(result(56, -1), SHGRID_BAD_COUNT);
    EXPECT_EQ(result(60, 1), SHGRID_BAD_COUNT);
    EXPECT_EQ(result(64, 2), SHGRID_BAD_NODES);
    EXPECT_EQ(result(68, 2), SHGRID_BAD_NODES);
    EXPECT_EQ(result(72, 0), SHGRID_BAD_NODES);
}

} // namespace
