// GPL-2.0-or-later. The BSPX lump of ambient cubes, against bytes put together here.
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;

namespace {

using CubeBytes = std::vector<std::byte>;

void Add16(CubeBytes &bytes, std::uint32_t value) {
    bytes.push_back(std::byte(value & 255)), bytes.push_back(std::byte(value >> 8 & 255));
}
void Add32(CubeBytes &bytes, std::uint32_t value) {
    Add16(bytes, value & 0xffff), Add16(bytes, value >> 16);
}

/// Leaf 1 has samples 0 and 1, the last leaf sample 2; others refer to leaf 1.
Bsp CubesBsp() {
    Bsp bsp = SampleBsp();
    AmbientCubes &cubes = bsp.ambientCubes.emplace();
    cubes.leafs.assign(bsp.leafs.size(), {0, 1});
    cubes.leafs[1] = {2, 0};
    cubes.leafs.back() = {1, 2};
    cubes.samples.resize(3);
    for (std::uint8_t i = 0; i < 3; ++i) {
        cubes.samples[i].position = {i, std::uint8_t(i + 1), 255};
        for (std::uint8_t side = 0; side < 6; ++side)
            cubes.samples[i].sides[side] = {std::uint8_t(200 + i), side, 7, std::int8_t(i - 1)};
    }
    return bsp;
}

/// The lump of CubesBsp by its format.
CubeBytes CubesLump(std::size_t leafs, std::uint32_t version = 1) {
    CubeBytes lump;
    for (const char c : {'A', 'C', 'U', 'B'})
        lump.push_back(std::byte(c));
    for (const std::uint32_t value : {version, std::uint32_t(leafs), 3u})
        Add32(lump, value);
    for (std::size_t leaf = 0; leaf < leafs; ++leaf) {
        Add16(lump, leaf == 1 ? 2 : leaf + 1 == leafs ? 1 : 0);
        Add16(lump, leaf == 1 ? 0 : leaf + 1 == leafs ? 2 : 1);
    }
    for (int i = 0; i < 3; ++i) {
        for (int side = 0; side < 6; ++side)
            for (const int value : {200 + i, side, 7, i - 1})
                lump.push_back(std::byte(value & 255));
        for (const int value : {i, i + 1, 255, 0})
            lump.push_back(std::byte(value));
    }
    return lump;
}

Bsp WithLump(const CubeBytes &lump) {
    Bsp bsp = SampleBsp();
    bsp.bspx = {{"AMBIENT_CUBES", lump}};
    return bsp;
}

Bsp ReadCubes(const Bsp &bsp, KeptLog &listener) {
    return ReadBsp(WriteBsp(bsp, {}), "x.bsp", {}, listener.log);
}

TEST(CubesLump, BytesAreThoseOfTheFormat) {
    const Bsp bsp = CubesBsp();
    const CubeBytes file = WriteBsp(bsp, {});
    EXPECT_EQ(IntAt(file, 4), 46) << "engines load it";
    EXPECT_EQ(file, WriteBsp(WithLump(CubesLump(bsp.leafs.size())), {}));
}

TEST(CubesLump, RoundTrip) {
    const Bsp bsp = CubesBsp();
    KeptLog listener;
    const Bsp back = ReadCubes(bsp, listener);
    ASSERT_TRUE(back.ambientCubes);
    EXPECT_TRUE(back.bspx.empty());
    EXPECT_EQ(back.ambientCubes->samples[2].sides[5], (ColorRgbExp32{202, 5, 7, 1}));
    EXPECT_EQ(back.ambientCubes->leafs[1].count, 2);
    EXPECT_EQ(WriteBsp(back, {}), WriteBsp(bsp, {}));
    EXPECT_EQ(listener.text.find("BSPX"), std::string::npos);
}

TEST(CubesLump, MalformedLumpsAreErrors) {
    const std::size_t leafs = SampleBsp().leafs.size();
    const auto fault = [](const CubeBytes &lump) {
        KeptLog listener;
        return ErrorOf([&] { ReadCubes(WithLump(lump), listener); });
    };
    EXPECT_EQ(fault(CubesLump(leafs)), "no error");
    EXPECT_THAT(fault(CubeBytes(15)), HasSubstr("AMBIENT_CUBES: length 15 is under the 16 of its head"));
    EXPECT_THAT(fault(CubeBytes(16)), HasSubstr("does not start with ACUB"));
    EXPECT_THAT(fault(CubesLump(leafs, 2)), HasSubstr("version 2, expected 1"));
    CubeBytes lump = CubesLump(leafs);
    lump.pop_back();
    EXPECT_THAT(fault(lump), HasSubstr(fmt::format("length {} is not 16 + {} leafs x 4 + 3 samples x 28",
                                                   16 + 4 * leafs + 83, leafs)));
    lump = CubesLump(leafs);
    SetInt(lump, 12, -1);
    EXPECT_THAT(fault(lump), HasSubstr("4294967295 samples"));
    lump = CubesLump(leafs);
    SetInt(lump, 16 + 4, 2 | 2 << 16); // leaf 1: samples 2 and 3
    EXPECT_THAT(fault(lump), HasSubstr("leaf 1: samples 2..3 are outside 0..2"));
    lump = CubesLump(leafs);
    SetInt(lump, 16, 0x7fff << 16);
    EXPECT_THAT(fault(lump), HasSubstr("leaf 0: refers to leaf 32767, which is outside"));
    SetInt(lump, 16, 0);
    EXPECT_THAT(fault(lump), HasSubstr("leaf 0: refers to leaf 0, which has no samples"));
    lump = CubesLump(leafs);
    lump.back() = std::byte(9);
    EXPECT_THAT(fault(lump), HasSubstr("sample 2: byte 27 is 9, expected 0"));
}

TEST(CubesLump, CubesOfOtherLeafsAreDropped) {
    const std::size_t leafs = SampleBsp().leafs.size();
    KeptLog listener;
    const Bsp back = ReadCubes(WithLump(CubesLump(leafs + 1)), listener);
    EXPECT_FALSE(back.ambientCubes);
    EXPECT_THAT(listener.text,
                HasSubstr(fmt::format("AMBIENT_CUBES is dropped: {} leafs, but the map has {}", leafs + 1, leafs)));
}

TEST(CubesLump, ProgramsErrorsAreFoundBeforeWriting) {
    Bsp bsp = CubesBsp();
    bsp.ambientCubes->leafs.pop_back();
    EXPECT_THAT(ErrorOf([&] { WriteBsp(bsp, {}); }), HasSubstr("leafs, but the map has"));
    Bsp named = WithLump({});
    KeptLog listener;
    EXPECT_THAT(ErrorOf([&] { ValidateBsp(named, "x", listener.log); }), HasSubstr("belongs to ambient cubes"));
}

TEST(CubesLump, PositionsAreSharesOfTheLeaf) {
    bspLeaf_t leaf{};
    leaf.mins = {-100, 0, 8}, leaf.maxs = {155, 510, 8};
    bspCubeSample_t sample;
    sample.position = EncodeCubePosition(leaf, {-37.4f, 400.9f, 8});
    EXPECT_EQ(sample.position, (std::array<std::uint8_t, 3>{63, 200, 0}));
    EXPECT_EQ(CubePosition(leaf, sample), Vec3f(-37, 400, 8));
    EXPECT_EQ(EncodeCubePosition(leaf, {-1e9f, 1e9f, 0}), (std::array<std::uint8_t, 3>{0, 255, 0}));
}

} // namespace
