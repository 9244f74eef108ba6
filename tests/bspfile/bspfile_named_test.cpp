// GPL-2.0-or-later. The BSPX lump of the SH grid that names lights: round trips, quantization, damaged lumps.
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_validate.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "tests/support/named_grid.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <random>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;

namespace {

using NamedLump = std::vector<std::byte>;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Two roots of two levels. Root 0 has an inner child 0 and stores its cells 1 and 6, which name two lights; the child
/// stores two cells without names; root 1 stores one cell that names three.
NamedGridSH TreeGrid() {
    NamedGridSH grid = SmallNamedGrid(1);
    grid.roots = {2, 1, 1}, grid.levels = 2;
    grid.nodes.assign(3, {});
    grid.nodes[0].inner = 1, grid.nodes[0].stored = 1 << 1 | 1 << 6, grid.nodes[0].nameCount = 2;
    grid.nodes[1].stored = 1 << 4, grid.nodes[1].nameCount = 3;
    grid.nodes[2].stored = 1 | 1 << 7, grid.nodes[2].hanging = 2;
    grid.names = {6, 0, 8, 7, 1};
    grid.points.resize(5);
    grid.shares = {255, 1, 2, 3, 4, 5, 6};
    NumberNamedNodes(grid);
    return grid;
}

/// The reader's verdict on a lump, through bytes of exactly that length, so that sanitizers see what is read beyond.
shgrid_result ResultOf(const NamedLump &lump, shgrid_grid &grid) {
    return shgrid_parse(lump.data(), lump.size(), &grid);
}

std::string FaultOfNamed(const NamedLump &lump) {
    return ErrorOf([&] { DecodeNamedGrid(lump); });
}

/// Calls everything that samples a grid, at positions inside and outside and at such that are no numbers.
void SampleEverywhere(const shgrid_grid &grid) {
    const float positions[][3] = {{-50, 20, 30},
                                  {-64, 8, 0},
                                  {-72, -20, 50},
                                  {-40, 20, 90},
                                  {-32, 40, 64},
                                  {1e4f, -1e4f, 1e4f},
                                  {3e38f, 0, -3e38f},
                                  {NAN, NAN, NAN},
                                  {-50, NAN, 50},
                                  {0, 0, 0},
                                  {kInfinity, -kInfinity, 0},
                                  {-48.5f, 24, 50}};
    for (const auto &position : positions) {
        shgrid_coeffs coeffs;
        shgrid_sample(&grid, position, &coeffs);
        shgrid_lighting lighting;
        shgrid_lights(&grid, position, nullptr, &lighting);
        ASSERT_GE(lighting.count, 0);
        ASSERT_LE(lighting.count, SHGRID_DIRECT_LIGHTS);
        for (int i = 0; i < lighting.count; ++i)
            ASSERT_NE(shgrid_light_name(&grid, lighting.direct[i].light), nullptr);
        const float normal[3] = {0, 0, 1};
        float rgb[3];
        shgrid_shade(&lighting, normal, rgb);
        float points[4][3];
        shgrid_points_near(&grid, position, 40, 4, points);
    }
    shgrid_coeffs corner;
    shgrid_point(&grid, grid.bounds[0] - 1, 0, grid.bounds[2] - 1, &corner);
}

TEST(NamedGridLump, GridsSurviveTheirBytes) {
    for (const NamedGridSH &grid : {SmallNamedGrid(3), TreeGrid()}) {
        const NamedLump lump = EncodeNamedGrid(grid);
        EXPECT_EQ(DecodeNamedGrid(lump), grid);
        EXPECT_EQ(EncodeNamedGrid(DecodeNamedGrid(lump)), lump);
        EXPECT_EQ(lump.size() % 4, 0u);
        EXPECT_EQ(IntAt(lump, 8), int(lump.size()));
    }
    NamedGridSH bare = TreeGrid(); // no lights, no points
    bare.table = {}, bare.names.clear(), bare.shares.clear(), bare.points.clear();
    for (NamedGridNode &node : bare.nodes)
        node.stored = 0, node.nameCount = 0;
    NumberNamedNodes(bare);
    EXPECT_EQ(DecodeNamedGrid(EncodeNamedGrid(bare)), bare);
    shgrid_grid reader;
    const NamedLump lump = EncodeNamedGrid(bare);
    ASSERT_EQ(ResultOf(lump, reader), SHGRID_OK);
    SampleEverywhere(reader);
}

TEST(NamedGridLump, MapsKeepIt) {
    Bsp bsp = SampleBsp();
    bsp.namedGridSH = TreeGrid();
    KeptLog listener;
    const Bsp back = ReadBsp(WriteBsp(bsp, {}), "x.bsp", {}, listener.log);
    EXPECT_EQ(back.namedGridSH, bsp.namedGridSH);
    Bsp damaged = SampleBsp();
    damaged.bspx = {{"LIGHTGRID_SH_LIGHTS", EncodeNamedGrid(TreeGrid())}};
    damaged.bspx[0].data.pop_back();
    EXPECT_THAT(ErrorOf([&] { ReadBsp(WriteBsp(damaged, {}), "x.bsp", {}, listener.log); }),
                HasSubstr("x.bsp: BSPX lump LIGHTGRID_SH_LIGHTS: the data ends early"));
}

TEST(NamedGridLump, IndexesAreRunningSums) {
    const NamedGridSH grid = TreeGrid();
    EXPECT_EQ(grid.nodes[0], (NamedGridNode{2, 0, 1, 66, 0, 2, 0, 0}));
    EXPECT_EQ(grid.nodes[1], (NamedGridNode{3, 2, 0, 16, 0, 3, 2, 4}));
    EXPECT_EQ(grid.nodes[2], (NamedGridNode{3, 3, 0, 129, 2, 0, 5, 7}));
}

TEST(NamedGridLump, PointsAreRightToHalfAStep) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1, 1);
    for (int round = 0; round < 500; ++round) {
        bspGridPointSH_t value{};
        const float size = std::exp2(12 * unit(random)), band = std::abs(unit(random));
        for (std::size_t k = 0; k < 9; ++k)
            for (float &c : value.coeffs[k])
                c = size * unit(random) * (k == 0 ? 1 : band);
        const NamedGridPoint point = QuantizeNamed(value);
        const bspGridPointSH_t back = DequantizeNamed(point);
        float most = 0; // in limits
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const float step = SparseScale(point.scale) * NamedBandLimit(k) / 127;
                EXPECT_NEAR(back.coeffs[k][channel], value.coeffs[k][channel], 0.501f * step);
                most = std::max(most, std::abs(value.coeffs[k][channel]) / NamedBandLimit(k));
            }
        EXPECT_GE(SparseScale(point.scale) * 1.00001f, most);
        EXPECT_LT(SparseScale(std::uint8_t(point.scale - 1)), most) << "the smallest scale that holds the point";
    }
    EXPECT_EQ(DequantizeNamed(QuantizeNamed({})).coeffs, bspGridPointSH_t{}.coeffs);
    bspGridPointSH_t huge{};
    huge.coeffs[0] = {1e30f, -1e30f, 0};
    EXPECT_EQ(QuantizeNamed(huge).scale, 255);
    EXPECT_EQ(QuantizeNamed(huge).steps[1], -127);
}

TEST(NamedGridLump, ThePointsThatEnginesReadAreThese) {
    NamedGridSH grid = SmallNamedGrid(1);
    grid.points[5].steps[20] = -128; // counts as -127
    std::ranges::fill(grid.shares, std::uint8_t(0));
    const NamedLump lump = EncodeNamedGrid(grid);
    shgrid_grid reader;
    ASSERT_EQ(ResultOf(lump, reader), SHGRID_OK);
    for (int i = 0; i < 8; ++i) {
        shgrid_coeffs read;
        shgrid_point(&reader, i & 1, i >> 1 & 1, i >> 2, &read);
        const bspGridPointSH_t value = DequantizeNamed(grid.points[std::size_t(i)]);
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(read.c[k][channel], value.coeffs[k][channel], 1e-6f * SparseScale(grid.points[0].scale));
    }
}

TEST(NamedGridLump, TruncatedLumpsAreRefused) {
    for (const NamedGridSH &grid : {SmallNamedGrid(1), TreeGrid()}) {
        const NamedLump lump = EncodeNamedGrid(grid);
        shgrid_grid reader;
        for (std::size_t length = 0; length < lump.size(); ++length) {
            NamedLump cut(lump.begin(), lump.begin() + std::ptrdiff_t(length));
            const shgrid_result result = ResultOf(cut, reader);
            ASSERT_NE(result, SHGRID_OK) << length;
            ASSERT_STRNE(shgrid_message(result), "unknown result");
            EXPECT_EQ(reader.points, nullptr);
            if (length < 12)
                continue;
            SetInt(cut, 8, int(length)); // the head says so, but the counts do not
            ASSERT_NE(ResultOf(cut, reader), SHGRID_OK) << length;
        }
        NamedLump longer = lump;
        longer.push_back({});
        EXPECT_THAT(FaultOfNamed(longer), HasSubstr("number of points disagrees"));
    }
}

TEST(NamedGridLump, MutantsAreRefusedOrSampled) {
    std::mt19937 random(2000);
    const NamedLump lumps[] = {EncodeNamedGrid(SmallNamedGrid(1)), EncodeNamedGrid(TreeGrid())};
    int sampled = 0;
    for (int round = 0; round < 2000; ++round) {
        NamedLump lump = lumps[round % 2];
        const std::size_t from = round % 4 < 2 ? 0 : 96; // half of them have a good head
        for (int change = 0; change <= round % 3; ++change) {
            const std::size_t at = std::uniform_int_distribution<std::size_t>(from, lump.size() - 1)(random);
            lump[at] = std::byte(random() & 255);
        }
        shgrid_grid grid;
        const shgrid_result result = ResultOf(lump, grid);
        EXPECT_EQ(FaultOfNamed(lump) == "no error", result == SHGRID_OK);
        SampleEverywhere(grid);
        sampled += result == SHGRID_OK;
    }
    EXPECT_GT(sampled, 200);
    EXPECT_LT(sampled, 1900);
}

/// A change of the grid, its bytes or both, and what the message then says.
struct Damage {
    std::string_view name;
    std::function<void(NamedGridSH &)> change;
    std::string_view message;
};

TEST(NamedGridLump, BadGridsAreRefused) {
    const std::string_view lights = "a light that the grid names is out of range", tree = "tree contradicts itself";
    const auto light = [](std::size_t number, const std::function<void(GridLight &)> &change) {
        return [number, change](NamedGridSH &grid) { change(grid.table.lights[number]); };
    };
    const auto panel = [](const std::function<void(GridPolygon &)> &change) {
        return [change](NamedGridSH &grid) { change(grid.table.polygons[0]); };
    };
    const Damage damages[] = {
        {"mins", [](NamedGridSH &grid) { grid.mins[1] = kInfinity; }, "origin is not finite"},
        {"cell 0", [](NamedGridSH &grid) { grid.cell[2] = 0; }, "cell size is not above zero"},
        {"cell nan", [](NamedGridSH &grid) { grid.cell[0] = NAN; }, "cell size is not above zero"},
        {"far end", [](NamedGridSH &grid) { grid.cell[0] = 3e38f; }, "cell size is not above zero"},
        {"no roots", [](NamedGridSH &grid) { grid.roots[1] = 0; }, "less than one point"},
        {"many roots", [](NamedGridSH &grid) { grid.roots[1] = 1 << 23; }, "less than one point"},
        {"other roots", [](NamedGridSH &grid) { grid.roots[1] = 2; }, tree},
        {"no levels", [](NamedGridSH &grid) { grid.levels = 0; }, "number of levels"},
        {"many levels", [](NamedGridSH &grid) { grid.levels = 13; }, "number of levels"},
        {"too few levels", [](NamedGridSH &grid) { grid.levels = 1; }, tree},
        {"children", [](NamedGridSH &grid) { grid.nodes[1].children = 2; }, tree},
        {"points", [](NamedGridSH &grid) { grid.nodes[1].points = 0; }, tree},
        {"names", [](NamedGridSH &grid) { grid.nodes[2].names = 0; }, tree},
        {"shares", [](NamedGridSH &grid) { grid.nodes[1].shares = 3; }, tree},
        {"count of names", [](NamedGridSH &grid) { grid.nodes[0].nameCount = 3; }, tree},
        {"masks", [](NamedGridSH &grid) { grid.nodes[0].hanging = 2; }, tree},
        {"hanging root", [](NamedGridSH &grid) { grid.nodes[1].hanging = 1; }, tree},
        {"one more share", [](NamedGridSH &grid) { grid.shares.push_back(0); }, tree},
        {"one more name", [](NamedGridSH &grid) { grid.names.push_back(0); }, tree},
        {"one more point", [](NamedGridSH &grid) { grid.points.emplace_back(); }, tree},
        {"one node less", [](NamedGridSH &grid) { grid.nodes.pop_back(); }, tree},
        {"name", [](NamedGridSH &grid) { grid.names[2] = std::uint16_t(grid.table.lights.size()); }, lights},
        {"type", light(0, [](GridLight &one) { one.type = 4; }), lights},
        {"curve", light(0, [](GridLight &one) { one.curve = 4; }), lights},
        {"style", light(0, [](GridLight &one) { one.style = 64; }), lights},
        {"flags", light(0, [](GridLight &one) { one.flags = 4; }), lights},
        {"color", light(2, [](GridLight &one) { one.color[2] = NAN; }), lights},
        {"last number", light(2, [](GridLight &one) { one.coneFade = -kInfinity; }), lights},
        {"text", light(8, [](GridLight &one) { one.name = 1000; }), lights},
        {"first polygon", light(8, [](GridLight &one) { one.firstPolygon = 3; }), lights},
        {"last polygon", light(8, [](GridLight &one) { one.polygonCount = 2; }), lights},
        {"no polygon", light(8, [](GridLight &one) { one.polygonCount = 0; }), lights},
        {"many polygons",
         [](NamedGridSH &grid) {
             grid.table.polygons.resize(65, grid.table.polygons[0]);
             grid.table.lights[8].firstPolygon = 0, grid.table.lights[8].polygonCount = 65;
         },
         lights},
        {"polygon of a sun", light(6, [](GridLight &one) { one.polygonCount = 1; }), lights},
        {"sum that wraps", light(8, [](GridLight &one) { one.firstPolygon = 2, one.polygonCount = UINT32_MAX; }),
         lights},
        {"first vertex", panel([](GridPolygon &polygon) { polygon.firstVertex = 100; }), lights},
        {"last vertex", panel([](GridPolygon &polygon) { polygon.vertexCount = 8; }), lights},
        {"two vertices", panel([](GridPolygon &polygon) { polygon.vertexCount = 2; }), lights},
        {"normal", panel([](GridPolygon &polygon) { polygon.normal[0] = NAN; }), lights},
        {"radius", panel([](GridPolygon &polygon) { polygon.radius = kInfinity; }), lights},
        {"vertex", [](NamedGridSH &grid) { grid.table.vertices.back()[2] = NAN; }, lights},
        {"many vertices",
         [](NamedGridSH &grid) {
             grid.table.vertices.resize(65);
             grid.table.polygons[0].vertexCount = 65;
         },
         lights},
        {"text without an end", [](NamedGridSH &grid) { grid.table.text.back() = 'x'; }, lights},
        {"no text", [](NamedGridSH &grid) { grid.table.text.clear(); }, lights},
        {"many lights", [](NamedGridSH &grid) { grid.table.lights.resize(65536, grid.table.lights[0]); },
         "number of points disagrees"},
    };
    EXPECT_EQ(FaultOfNamed(NamedRanges(TreeGrid()).Bytes()), "no error");
    for (const Damage &damage : damages) {
        NamedGridSH grid = TreeGrid();
        damage.change(grid);
        EXPECT_THAT(FaultOfNamed(NamedRanges(grid).Bytes()), HasSubstr(damage.message)) << damage.name;
        EXPECT_THAT(ErrorOf([&] { CheckNamedGrid(grid, "x.bsp"); }),
                    testing::AllOf(HasSubstr("x.bsp: BSPX lump LIGHTGRID_SH_LIGHTS: "), HasSubstr(damage.message)))
            << damage.name;
    }
}

TEST(NamedGridLump, BadHeadsAreRefused) {
    const auto fault = [](std::size_t at, std::int32_t value) {
        NamedLump lump = EncodeNamedGrid(TreeGrid());
        SetInt(lump, at, value);
        return FaultOfNamed(lump);
    };
    EXPECT_THAT(fault(0, 0), HasSubstr("does not start with SHGL"));
    EXPECT_THAT(fault(4, 2), HasSubstr("another version"));
    EXPECT_THAT(fault(8, 0), HasSubstr("disagrees"));
    EXPECT_THAT(fault(8, -1), HasSubstr("ends early"));
    for (std::size_t at = 52; at < sizeof(bspNamedGridHeader_t); at += 4) // counts and reserved words
        for (const std::int32_t value : {1000, -1})
            EXPECT_THAT(fault(at, value), HasSubstr("disagrees")) << at;
}

} // namespace
