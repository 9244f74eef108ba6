// GPL-2.0-or-later. The lumps LIGHTGRID_OCTREE and LIGHTGRIDS: bytes, and what engines read.
#include "q3map2/gridformats/grid_octree.h"
#include "q3map2/gridformats/grid_source.h"
#include "tests/gridformats/sample_grid.h"
#include "tests/support/grid_readers/octree_reader.h"

#include "common/error.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::ElementsAreArray;

GridSource Source(const StoredGridSH &stored, const std::function<bool(std::size_t)> &solid) {
    std::vector<bool> isSolid(stored.grid.points.size());
    for (std::size_t i = 0; i < isSolid.size(); ++i)
        isSolid[i] = solid(i);
    return {stored, isSolid};
}

bool Nowhere(std::size_t) {
    return false;
}

/// Byte n of 255 on all sides, n = 10 times the point's number of the 2 x 2 x 2 points, plus 5.
StoredGridSH Numbered() {
    int number = 0;
    return SampleGrid({2, 2, 2}, {-32, 0, 64}, [&](const Vec3f &) {
        const double value = (10 * number++ + 5) / 255.0;
        return ConstantLight({value, 0, 1});
    });
}

class Bytes {
  public:
    Bytes &Floats(std::initializer_list<float> values) {
        for (const float value : values)
            Add(value);
        return *this;
    }
    Bytes &Ints(std::initializer_list<std::uint32_t> values) {
        for (const std::uint32_t value : values)
            Add(value);
        return *this;
    }
    Bytes &Plain(std::initializer_list<int> values) {
        for (const int value : values)
            all.push_back(std::byte(value));
        return *this;
    }
    std::vector<std::byte> all;

  private:
    template <typename T> void Add(const T &value) {
        const auto bytes = std::as_bytes(std::span(&value, 1));
        all.insert(all.end(), bytes.begin(), bytes.end());
    }
};

OctreeReader Read(const std::vector<std::byte> &lump, bool sixSides) {
    std::string fault;
    const auto reader = OctreeReader::Load(lump, sixSides, fault);
    if (!reader)
        throw Error("{}", fault);
    return *reader;
}

TEST(OctreeLump, BytesOfTwoByTwoByTwoPoints) {
    Bytes expected;
    expected.Floats({32, 32, 32}).Ints({2, 2, 2}).Floats({-32, 0, 64});
    expected.Plain({1});             // styles
    expected.Ints({0x80000000u, 0}); // root: leaf 0; no nodes
    expected.Ints({1, 0, 0, 0, 2, 2, 2});
    for (int i = 0; i < 8; ++i)
        if (i == 3)
            expected.Plain({255}); // occluded
        else
            expected.Plain({1, 0, 10 * i + 5, 0, 255});
    StoredGridSH stored = Numbered();
    stored.grid.points[3] = {};
    const auto lump = EncodeOctreeLump(Source(stored, [](std::size_t i) { return i == 3; }), GridTone());
    EXPECT_THAT(lump, ElementsAreArray(expected.all));
}

TEST(GridsLump, BytesOfTwoByTwoByTwoPoints) {
    // Point 0 has light from above alone: red 255 on +z, and by the second band on other sides.
    StoredGridSH stored = Numbered();
    stored.grid.points[0] = LightFrom({0, 0, 1}, {16 / 17.0, 0, 0});
    const int up = int(std::lround(255 * 1.0625 * 16 / 17)), side = int(std::lround(255 * 0.09375 * 16 / 17)),
              down = int(std::lround(255 * 0.0625 * 16 / 17));
    Bytes grid;
    grid.Floats({32, 32, 32}).Ints({2, 2, 2}).Floats({-32, 0, 64}).Plain({1}).Ints({0x80000000u, 0});
    grid.Ints({1, 0, 0, 0, 2, 2, 2}).Plain({1}); // styles of the leaf
    grid.Plain({1, 0, 0x3f}).Plain({side, 0, 0, side, 0, 0, side, 0, 0, side, 0, 0, up, 0, 0, down, 0, 0});
    for (int i = 1; i < 8; ++i) {
        grid.Plain({1, 0, 0x3f});
        for (int s = 0; s < 6; ++s)
            grid.Plain({10 * i + 5, 0, 255});
    }
    Bytes expected;
    expected.Ints({std::uint32_t(grid.all.size())});
    expected.all.insert(expected.all.end(), grid.all.begin(), grid.all.end());
    EXPECT_THAT(EncodeGridsLump(Source(stored, Nowhere), GridTone()), ElementsAreArray(expected.all));
}

TEST(GridsLump, BlackSidesAreLeftOut) {
    const auto stored = SampleGrid({1, 1, 1}, {}, [](const Vec3f &) {
        bspGridPointSH_t light = ConstantLight({0.5, 0.5, 0.5});
        light.coeffs[3] = {-1.2f, -1.2f, -1.2f}; // -x is bright, +x below 0
        return light;
    });
    const auto lump = EncodeGridsLump(Source(stored, Nowhere), GridTone());
    const std::size_t sample = lump.size() - 3 - 5 * 3;
    EXPECT_EQ(std::to_integer<int>(lump[sample + 2]), 0x3e);
}

TEST(OctreeLump, BytesOfFiveByFiveByFivePoints) {
    // The lower half in x, two of five columns, is solid: 50 points, so the box is split at 2 2 2.
    const auto stored = SampleGrid({5, 5, 5}, {0, 0, 0}, [](const Vec3f &p) {
        return p.x < 64 ? bspGridPointSH_t{} : ConstantLight({0.2, 0.4, 0.6});
    });
    const auto lump = EncodeOctreeLump(Source(stored, [](std::size_t i) { return i % 5 < 2; }), GridTone());
    Bytes expected;
    expected.Floats({32, 32, 32}).Ints({5, 5, 5}).Floats({0, 0, 0}).Plain({1});
    expected.Ints({0, 1}); // root: node 0 of one
    constexpr std::uint32_t kOccluded = 0x40000000, kLeaf = 0x80000000;
    expected.Ints({2, 2, 2, kOccluded, kOccluded, kOccluded, kOccluded, kLeaf, kLeaf + 1, kLeaf + 2, kLeaf + 3});
    expected.Ints({4});
    for (std::uint32_t leaf = 0; leaf < 4; ++leaf) {
        const std::uint32_t y = leaf / 2, z = leaf % 2;
        expected.Ints({2, 2 * y, 2 * z, 3, 2 + y, 2 + z});
        for (std::uint32_t i = 0; i < 3 * (2 + y) * (2 + z); ++i)
            expected.Plain({1, 0, 51, 102, 153});
    }
    EXPECT_THAT(lump, ElementsAreArray(expected.all));
}

TEST(OctreeLump, FewOccludedPointsDoNotSplit) {
    auto stored = SampleGrid({5, 5, 5}, {}, [](const Vec3f &) { return ConstantLight({1, 1, 1}); });
    for (const std::size_t occluded : {7u, 8u}) {
        for (std::size_t i = 0; i < occluded; ++i)
            stored.grid.points[i] = {};
        const auto reader =
            Read(EncodeOctreeLump(Source(stored, [&](std::size_t i) { return i < occluded; }), GridTone()), false);
        EXPECT_EQ(reader.NodeCount(), occluded == 7 ? 0u : 1u);
        EXPECT_EQ(reader.LeafCount(), occluded == 7 ? 1u : 8u);
    }
}

TEST(OctreeLump, NoLightAtAllIsAnError) {
    const auto stored = SampleGrid({2, 2, 2}, {}, [](const Vec3f &) { return bspGridPointSH_t{}; });
    EXPECT_THROW(EncodeOctreeLump(Source(stored, [](std::size_t) { return true; }), GridTone()), Error);
    EXPECT_NO_THROW(EncodeOctreeLump(Source(stored, Nowhere), GridTone())) << "darkness in the open is known";
}

// Engines blend linearly, and so is the light: what is left is rounding to bytes.
TEST(OctreeLump, EnginesReadTheMeanBetweenPoints) {
    const auto light = [](const Vec3f &p) {
        return ConstantLight({0.1 + double(p.x) / 2000, 0.5 - double(p.y) / 2000, 0.25}) +
               LightFrom({1, 2, 3}, {double(p.z) / 1000, 0.2, 0.1});
    };
    const auto stored = SampleGrid({9, 12, 7}, {-128, -64, 32}, light);
    const auto isSolid = [](std::size_t i) { return i % 9 < 3; }; // their values keep them from being void
    const auto reader = Read(EncodeOctreeLump(Source(stored, isSolid), GridTone()), false);
    for (int i = 0; i < 500; ++i) {
        const Vec3f p{-120.0f + float(i * 37 % 240), -60.0f + float(i * 53 % 330), 40.0f + float(i * 29 % 180)};
        const auto read = reader.At(p);
        ASSERT_TRUE(read);
        const Vec3d mean = MeanLight(light(p)) * 255.0;
        for (std::size_t channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(double((*read)[0][channel]), mean[channel], 0.51);
    }
}

TEST(GridsLump, EnginesReadTheSidesBetweenPoints) {
    const auto light = [](const Vec3f &p) {
        return ConstantLight({0.2, 0.1 + double(p.y) / 3000, 0.25}) +
               LightFrom({1, 2, 3}, {double(p.x) / 1000, 0.2, 0.1});
    };
    const auto stored = SampleGrid({9, 6, 7}, {32, 0, 32}, light);
    const auto reader = Read(EncodeGridsLump(Source(stored, Nowhere), GridTone()), true);
    for (int i = 0; i < 200; ++i) {
        const Vec3f p{40.0f + float(i * 37 % 240), 4.0f + float(i * 53 % 150), 40.0f + float(i * 29 % 180)};
        const auto read = reader.At(p);
        ASSERT_TRUE(read);
        for (std::size_t side = 0; side < 6; ++side) {
            Vec3d normal;
            normal[side / 2] = side % 2 == 0 ? 1 : -1;
            const Vec3d exact = LightOn(light(p), normal) * 255.0;
            for (std::size_t channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(double((*read)[side][channel]), exact[channel], 0.51);
        }
    }
}

// Beside a wall the void corners count as the mean of the others.
TEST(OctreeLump, OccludedCornersDoNotDarken) {
    const auto stored = SampleGrid({6, 6, 6}, {}, [](const Vec3f &p) {
        return p.x < 64 ? bspGridPointSH_t{} : ConstantLight({1, 0.5, 0.25});
    });
    const auto reader =
        Read(EncodeOctreeLump(Source(stored, [](std::size_t i) { return i % 6 < 2; }), GridTone()), false);
    const auto beside = reader.At({40, 70, 70});
    ASSERT_TRUE(beside);
    EXPECT_NEAR((*beside)[0].x, 255, 1e-3);
    EXPECT_NEAR((*beside)[0].y, 128, 1e-3);
    EXPECT_FALSE(reader.At({10, 70, 70})) << "void";
}

} // namespace

} // namespace q3::test
