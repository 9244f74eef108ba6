// GPL-2.0-or-later. The BSPX lump of the sparse SH grid, against bytes put together here.
#include "q3map2/bspfile/bsp_validate.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;

namespace {

using SparseLump = std::vector<std::byte>;

constexpr std::size_t kHead = 64, kNode = 12, kPoint = 28;

void AddWord(SparseLump &lump, std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8)
        lump.push_back(std::byte(value >> shift & 255));
}
void AddFloat(SparseLump &lump, float value) {
    AddWord(lump, std::bit_cast<std::uint32_t>(value));
}
void AddNode(SparseLump &lump, std::uint32_t children, std::uint32_t points, int inner, int stored, int hanging,
             int scale) {
    AddWord(lump, children), AddWord(lump, points);
    for (const int value : {inner, stored, hanging, scale})
        lump.push_back(std::byte(value));
}

/// Two roots of two levels. Root 0 has an inner child 0 and stores its cells 1 and 6; the child stores its cells 0 and
/// 7, and cell 1 of it hangs. Root 1 stores cell 4.
SparseLump SmallLump() {
    SparseLump lump;
    for (const char c : {'S', 'H', 'G', 'S'})
        lump.push_back(std::byte(c));
    AddWord(lump, 1), AddWord(lump, kHead + 3 * kNode + 5 * kPoint);
    for (const float value : {-64.0f, 32.0f, 0.0f, 16.0f, 16.0f, 32.0f})
        AddFloat(lump, value);
    for (const std::uint32_t value : {2u, 1u, 1u, 2u, 3u, 5u, 0u})
        AddWord(lump, value);
    AddNode(lump, 2, 0, 1, 1 << 1 | 1 << 6, 0, 128);
    AddNode(lump, 3, 2, 0, 1 << 4, 0, 130);
    AddNode(lump, 3, 3, 0, 1 | 1 << 7, 2, 120);
    for (std::uint32_t point = 0; point < 5; ++point) {
        AddWord(lump, 256u | 128u << 9 | (point + 1) << 18 | 16u << 27); // 1, 0.5, (point + 1) / 256
        for (int i = 0; i < 24; ++i)
            lump.push_back(std::byte((i * 10 - 127 + int(point)) & 255));
    }
    return lump;
}

std::string FaultOf(const SparseLump &lump) {
    return ErrorOf([&] { DecodeSparseGrid(lump); });
}
std::string FaultWith(std::size_t at, std::uint32_t value) {
    SparseLump lump = SmallLump();
    SetInt(lump, at, std::int32_t(value));
    return FaultOf(lump);
}
std::string FaultWithByte(std::size_t at, int value) {
    SparseLump lump = SmallLump();
    lump[at] = std::byte(value);
    return FaultOf(lump);
}
std::string FaultWithFloat(std::size_t at, float value) {
    return FaultWith(at, std::bit_cast<std::uint32_t>(value));
}

TEST(SparseGridLump, FieldsAreThoseOfTheFormat) {
    const SparseGridSH grid = DecodeSparseGrid(SmallLump());
    EXPECT_EQ(grid.mins, (Float3{-64, 32, 0}));
    EXPECT_EQ(grid.cell, (Float3{16, 16, 32}));
    EXPECT_EQ(grid.roots, (Int3{2, 1, 1}));
    EXPECT_EQ(grid.levels, 2);
    ASSERT_EQ(grid.nodes.size(), 3u);
    EXPECT_EQ(grid.nodes[2], (SparseGridNode{3, 3, 0, 129, 2, 120}));
    ASSERT_EQ(grid.points.size(), 5u);
    EXPECT_EQ(grid.points[4].bands[23], 107);
    EXPECT_EQ(EncodeSparseGrid(grid), SmallLump());
}

TEST(SparseGridLump, PointsAreMeansTimesSharesOfALimit) {
    const SparseGridSH grid = DecodeSparseGrid(SmallLump());
    const std::vector<bspGridPointSH_t> values = DequantizePoints(grid);
    const std::array<int, 5> scales = {128, 128, 130, 120, 120};
    for (std::size_t i = 0; i < 5; ++i) {
        const std::array<double, 3> mean = {1, 0.5, double(i + 1) / 256};
        for (std::size_t channel = 0; channel < 3; ++channel) {
            EXPECT_EQ(double(values[i].coeffs[0][channel]), mean[channel]);
            for (std::size_t k = 1; k < 9; ++k) {
                const double q = double(3 * (k - 1) + channel) * 10 - 127 + double(i);
                const double limit = k < 4 ? 2 / std::sqrt(3) : std::sqrt(5) / 4;
                const double expected = q / 127 * limit * std::exp2((scales[i] - 128) / 8.0) * mean[channel];
                EXPECT_NEAR(double(values[i].coeffs[k][channel]), expected, 3e-7 * std::abs(expected));
            }
        }
    }
}

TEST(SparseGridLump, MapsKeepItBesideOtherLumps) {
    Bsp bsp = SampleBsp();
    bsp.bspx = {{"OTHER", std::vector<std::byte>(7)}};
    bsp.sparseGridSH = DecodeSparseGrid(SmallLump());
    for (int form = 0; form < 3; ++form) {
        if (form > 0)
            bsp.gridSH = SampleGridSH();
        bsp.gridSHContainer = form == 1 ? GridSHContainer::Lump : GridSHContainer::Bspx;
        KeptLog listener;
        const Bsp back = ReadBsp(WriteBsp(bsp, {}), "x.bsp", {}, listener.log);
        EXPECT_EQ(back.sparseGridSH, bsp.sparseGridSH);
        EXPECT_EQ(back.gridSH.has_value(), form > 0);
        EXPECT_EQ(back.bspx.size(), 1u);
        EXPECT_EQ(WriteBsp(back, {}), WriteBsp(bsp, {}));
        EXPECT_EQ(listener.text.find("BSPX"), std::string::npos);
    }
}

TEST(SparseGridLump, BytesInAMapAreThoseOfTheLump) {
    Bsp bsp = SampleBsp(), plain = SampleBsp();
    bsp.sparseGridSH = DecodeSparseGrid(SmallLump());
    plain.bspx = {{"LIGHTGRID_SH_SPARSE", SmallLump()}};
    EXPECT_EQ(IntAt(WriteBsp(bsp, {}), 4), 46) << "engines load it";
    EXPECT_EQ(WriteBsp(bsp, {}), WriteBsp(plain, {}));
    KeptLog listener;
    EXPECT_THAT(ErrorOf([&] { ValidateBsp(plain, "x", listener.log); }), HasSubstr("belongs to the sparse SH"));
}

TEST(SparseGridLump, SamplersRefuseADamagedLump) {
    EXPECT_EQ(SparseReader(SmallLump()).count, 5u);
    SparseLump lump = SmallLump();
    lump.pop_back();
    EXPECT_THAT(ErrorOf([&] { SparseReader(lump); }), HasSubstr("sparse SH light grid: "));
}

TEST(SparseGridLump, DamagedMapsNameTheLump) {
    Bsp bsp = SampleBsp();
    bsp.bspx = {{"LIGHTGRID_SH_SPARSE", SmallLump()}};
    bsp.bspx[0].data.pop_back();
    KeptLog listener;
    EXPECT_THAT(ErrorOf([&] { ReadBsp(WriteBsp(bsp, {}), "x.bsp", {}, listener.log); }),
                HasSubstr("x.bsp: BSPX lump LIGHTGRID_SH_SPARSE: bytes is 240, but the length is 239"));
}

TEST(SparseGridLump, TruncatedLumpsAreRefused) {
    const SparseLump lump = SmallLump();
    for (std::size_t length = 0; length < lump.size(); ++length)
        EXPECT_NE(FaultOf(SparseLump(lump.begin(), lump.begin() + std::ptrdiff_t(length))), "no error") << length;
    SparseLump longer = lump;
    longer.push_back({});
    EXPECT_THAT(FaultOf(longer), HasSubstr("bytes is 240, but the length is 241"));
}

TEST(SparseGridLump, BadHeadsAreRefused) {
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(FaultOf(SmallLump()), "no error");
    EXPECT_THAT(FaultWith(0, 0), HasSubstr("does not start with SHGS"));
    EXPECT_THAT(FaultWith(4, 2), HasSubstr("version 2, expected 1"));
    EXPECT_THAT(FaultWith(8, 0), HasSubstr("bytes is 0"));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t at = 12 + 4 * axis;
        EXPECT_THAT(FaultWithFloat(at, infinity), HasSubstr(fmt::format("mins[{}] is inf", axis)));
        EXPECT_THAT(FaultWithFloat(at + 12, 0), HasSubstr(fmt::format("cell[{}] is 0", axis)));
        EXPECT_THAT(FaultWithFloat(at + 12, -1), HasSubstr(fmt::format("cell[{}] is -1", axis)));
        EXPECT_THAT(FaultWithFloat(at + 12, NAN), HasSubstr(fmt::format("cell[{}] is nan", axis)));
        EXPECT_THAT(FaultWithFloat(at + 12, 3e38f), HasSubstr(fmt::format("ends at inf on axis {}", axis)));
        EXPECT_THAT(FaultWith(at + 24, 0), HasSubstr(fmt::format("roots[{}] is 0, expected 1 to", axis)));
        EXPECT_THAT(FaultWith(at + 24, UINT32_MAX), HasSubstr(fmt::format("roots[{}] is -1", axis)));
        EXPECT_THAT(FaultWith(at + 24, 1 << 23), HasSubstr(fmt::format("roots[{}] is 8388608", axis)));
        EXPECT_THAT(FaultWith(at + 24, 4), HasSubstr("3 nodes, but roots are"));
    }
    EXPECT_THAT(FaultWith(48, 0), HasSubstr("levels is 0, expected 1 to 12"));
    EXPECT_THAT(FaultWith(48, 13), HasSubstr("levels is 13"));
    EXPECT_THAT(FaultWith(48, UINT32_MAX), HasSubstr("levels is 4294967295"));
    EXPECT_THAT(FaultWith(52, 4), HasSubstr("length 240 is not 64 + 4 nodes x 12 + 5 points x 28"));
    EXPECT_THAT(FaultWith(52, UINT32_MAX), HasSubstr("4294967295 nodes"));
    EXPECT_THAT(FaultWith(56, 6), HasSubstr("6 points"));
    EXPECT_THAT(FaultWith(60, 1), HasSubstr("reserved is 1, expected 0"));
}

TEST(SparseGridLump, BadNodesAreRefused) {
    for (std::size_t node = 0; node < 3; ++node) {
        const std::size_t at = kHead + kNode * node;
        EXPECT_THAT(FaultWith(at, 7), HasSubstr(fmt::format("node {}: children is 7, expected", node)));
        EXPECT_THAT(FaultWith(at + 4, 9), HasSubstr(fmt::format("node {}: points is 9, expected", node)));
    }
    EXPECT_THAT(FaultWithByte(kHead + 8, 0), HasSubstr("node 1: children is 3, expected 2"));
    EXPECT_THAT(FaultWithByte(kHead + 8, 2), HasSubstr("share bits"));
    EXPECT_THAT(FaultWithByte(kHead + 9, 1), HasSubstr("share bits"));
    EXPECT_THAT(FaultWithByte(kHead + 2 * kNode + 10, 128), HasSubstr("share bits"));
    EXPECT_THAT(FaultWithByte(kHead + 10, 4), HasSubstr("node 0: hanging is 4, expected 0"));
    EXPECT_THAT(FaultWithByte(kHead + kNode + 8, 1), HasSubstr("node 2: children is 3, expected 4"));
    EXPECT_THAT(FaultWithByte(kHead + 2 * kNode + 8, 4), HasSubstr("node 2: inner is 4, expected 0 in the last"));
    EXPECT_THAT(FaultWithByte(kHead + 2 * kNode + 9, 1), HasSubstr("5 points, but the nodes have 4"));
    EXPECT_THAT(FaultWith(48, 1), HasSubstr("node 0: inner is 1"));
    SparseLump lump = SmallLump(); // node 1 gets a child that does not exist
    SetInt(lump, kHead + 2 * kNode, 4);
    lump[kHead + kNode + 8] = std::byte(1);
    EXPECT_THAT(FaultOf(lump), HasSubstr("3 nodes, but the tree has 4"));
    lump = SmallLump(); // no node has the last as its child
    SetInt(lump, kHead + kNode, 2);
    lump[kHead + 8] = std::byte(0);
    EXPECT_THAT(FaultOf(lump), HasSubstr("3 nodes, but the tree has 2"));
}

/// The grid of SmallLump with values of that spread around a mean that is not black.
SparseGridTree TreeOf(std::mt19937 &random, float spread) {
    const SparseGridSH small = DecodeSparseGrid(SmallLump());
    SparseGridTree tree{small.mins, small.cell, small.roots, small.levels, small.nodes, {}};
    std::uniform_real_distribution<float> unit(-1, 1);
    for (int i = 0; i < 5; ++i) {
        bspGridPointSH_t value{};
        for (std::size_t channel = 0; channel < 3; ++channel) {
            value.coeffs[0][channel] = std::exp2(3 * unit(random));
            for (std::size_t k = 1; k < 9; ++k)
                value.coeffs[k][channel] = value.coeffs[0][channel] * unit(random) * spread;
        }
        tree.values.push_back(value);
    }
    return tree;
}

TEST(SparseGridPacking, ErrorsAreBelowHalfASteps) {
    std::mt19937 random(7);
    for (const float spread : {0.004f, 0.1f, 0.55f, 3.0f, 200.0f})
        for (int round = 0; round < 50; ++round) {
            const SparseGridTree tree = TreeOf(random, spread);
            const SparseGridSH grid = PackSparseGrid(tree);
            const std::vector<bspGridPointSH_t> values = DequantizePoints(grid);
            for (const SparseGridNode &node : grid.nodes)
                for (std::size_t i = node.points; i < node.points + std::size_t(std::popcount(node.stored)); ++i) {
                    const Float3 &mean = tree.values[i].coeffs[0];
                    const double largest = double(std::max({mean[0], mean[1], mean[2]}));
                    for (std::size_t channel = 0; channel < 3; ++channel) {
                        const double meanError = largest / 512;
                        EXPECT_NEAR(values[i].coeffs[0][channel], mean[channel], meanError);
                        for (std::size_t k = 1; k < 9; ++k) {
                            const double limit =
                                (k < 4 ? 1.1547005384 : 0.5590169944) * std::exp2((int(node.scale) - 128) / 8.0);
                            const double step = limit * (double(mean[channel]) + meanError) / 127;
                            EXPECT_NEAR(values[i].coeffs[k][channel], tree.values[i].coeffs[k][channel],
                                        0.501 * step + limit * meanError);
                        }
                    }
                }
        }
}

TEST(SparseGridPacking, ScalesAreTheSmallestThatHoldTheirPoints) {
    std::mt19937 random(3);
    SparseGridTree tree = TreeOf(random, 0);
    for (bspGridPointSH_t &value : tree.values)
        value.coeffs[0] = {1, 0.5f, 0.25f}; // exact as RGB9E5
    for (int code = 1; code < 255; ++code) {
        const double limit = 1.1547005384 * std::exp2((code - 128) / 8.0);
        tree.values[4].coeffs[2][1] = float(0.5 * limit * 0.9999);
        EXPECT_EQ(PackSparseGrid(tree).nodes[2].scale, code);
        tree.values[4].coeffs[2][1] = float(-0.5 * limit * 1.0001);
        EXPECT_EQ(PackSparseGrid(tree).nodes[2].scale, code + 1);
    }
    EXPECT_EQ(PackSparseGrid(tree).nodes[0].scale, 0) << "without directions";
}

TEST(SparseGridPacking, LightFromASingleDirectionNeedsTheUsualScale) {
    SparseGridTree tree = [] {
        std::mt19937 random(1);
        return TreeOf(random, 0);
    }();
    for (bspGridPointSH_t &value : tree.values)
        value.coeffs = {{{0.886226925f, 0, 0}, {}, {1.02332671f, 0, 0}, {}, {}, {}, {0.495415912f, 0, 0}, {}, {}}};
    for (const SparseGridNode &node : PackSparseGrid(tree).nodes)
        EXPECT_NEAR(node.scale, 128, 1);
}

TEST(SparseGridPacking, OddLightIsClampedToWhatCanBeStored) {
    std::mt19937 random(5);
    SparseGridTree tree = TreeOf(random, 0);
    tree.values[2].coeffs[0] = {-1, 0, 1e9f};
    tree.values[2].coeffs[1] = {5, 5, 5};
    tree.values[3].coeffs[0] = {1e-3f, 1, 0};
    tree.values[3].coeffs[1] = {100, -1e30f, 0};
    const SparseGridSH grid = PackSparseGrid(tree);
    EXPECT_EQ(grid.nodes[2].scale, 255);
    for (const bspGridPointSH_t &value : DequantizePoints(grid))
        for (const Float3 &c : value.coeffs)
            for (const float channel : c)
                EXPECT_TRUE(std::isfinite(channel));
    const std::vector<bspGridPointSH_t> values = DequantizePoints(grid);
    EXPECT_EQ(values[2].coeffs[0], (Float3{0, 0, 65408}));
    EXPECT_EQ(values[2].coeffs[1][0], 0);
    EXPECT_NEAR(values[3].coeffs[1][1], -1.1547 * std::exp2(127 / 8.0), 20);
}

TEST(SparseGridPacking, ErrorsNameWhatIsWrong) {
    std::mt19937 random(5);
    const SparseGridTree good = TreeOf(random, 1);
    const auto fault = [](const SparseGridTree &tree) { return ErrorOf([&] { PackSparseGrid(tree); }); };
    EXPECT_EQ(fault(good), "no error");
    SparseGridTree tree = good;
    tree.values.pop_back();
    EXPECT_THAT(fault(tree), HasSubstr("4 points, but the nodes have 5"));
    tree = good;
    tree.values[3].coeffs[8][2] = NAN;
    EXPECT_THAT(fault(tree), HasSubstr("point 3: coefficient 8 is nan"));
    tree = good;
    tree.roots = {INT32_MAX, INT32_MIN, 0};
    EXPECT_THAT(fault(tree), HasSubstr("roots[0] is 2147483647"));
}

} // namespace
