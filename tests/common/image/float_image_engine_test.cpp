// GPL-2.0-or-later. HDR light as engines load it.
#include "common/image/float_image.h"

#include "common/error.h"
#include "tests/common/image/float_image_readers.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

FloatImage Page(int side) {
    FloatImage page{side, side, {}};
    for (int i = 0; i < side * side; ++i)
        page.texels.emplace_back(float(i % side) / 32, float(i / side) / 32, 4.0f);
    return page;
}

/// What the loader of ioquake3 does: skips to the first empty line, then one line more, and takes floats from there,
/// after it compared the length of the whole file with that of the floats.
std::vector<float> LoadAsIoquake3(std::vector<std::byte> file) {
    EXPECT_EQ(file.size(), 128u * 128 * 3 * 4);
    file.resize(file.size() + 16, std::byte(0xFF)); // what happens to lie behind it in memory
    const auto newline = [&](std::size_t at) { return file[at] == std::byte('\n'); };
    std::size_t at = 0;
    while (!(newline(at) && newline(at + 1)))
        ++at;
    at += 2;
    while (!newline(at))
        ++at;
    std::vector<float> floats(128 * 128 * 3);
    std::memcpy(floats.data(), file.data() + at + 1, 4 * floats.size());
    return floats;
}

TEST(Ioquake3HdrTest, LoadsOnTheByteScaleWithRowZeroFirst) {
    const FloatImage page = Page(128);
    const std::vector<float> loaded = LoadAsIoquake3(EncodeIoquake3Hdr(page));
    for (std::size_t i = 0; i + 1 < loaded.size(); ++i)
        ASSERT_EQ(loaded[i], 255 * page.texels[i / 3][i % 3]) << i;
    EXPECT_EQ(loaded[2], 1020.0f);
}

TEST(Ioquake3HdrTest, ReadsBackAllButTheLastBlue) {
    FloatImage page = Page(128);
    page.texels[5] = {-1, std::numeric_limits<float>::quiet_NaN(), 1};
    const FloatImage back = DecodeIoquake3Hdr(EncodeIoquake3Hdr(page), "x");
    page.texels[5] = {0, 0, 1};
    page.texels.back().z = 0;
    ASSERT_EQ(back.texels.size(), page.texels.size());
    for (std::size_t i = 0; i < back.texels.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            ASSERT_NEAR(back.texels[i][k], page.texels[i][k], page.texels[i][k] * 0x1p-23f) << i;
    EXPECT_EQ(back.texels[0].z, 4.0f);
}

TEST(Ioquake3HdrTest, OnlyThatSize) {
    EXPECT_THROW(EncodeIoquake3Hdr(Page(64)), Error);
    std::vector<std::byte> file = EncodeIoquake3Hdr(Page(128));
    file[2] = std::byte('#');
    EXPECT_THROW(DecodeIoquake3Hdr(file, "x"), Error);
    file.pop_back();
    EXPECT_THROW(DecodeIoquake3Hdr(file, "x"), Error);
    EXPECT_THROW(DecodeIoquake3Hdr({}, "x"), Error);
}

TEST(Rend2HdrTest, RadianceWithTheLastRowOnTop) {
    const FloatImage page = Page(64), file = ReadHdrPlainly(EncodeRend2Hdr(page));
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            EXPECT_EQ(file.Texel(x, 63 - y).z, 4.0f);
            EXPECT_NEAR(file.Texel(x, 63 - y).y, page.Texel(x, y).y, 4.0f / 256);
        }
    EXPECT_EQ(DecodeRend2Hdr(EncodeRend2Hdr(page), "x").texels, FlippedRows(file).texels);
}

TEST(VertexLightTest, ThreeFloatsAVertex) {
    const std::vector<Vec3f> light = {{1, 4, 0}, {0.5f, -1, 2}};
    const std::vector<std::byte> bytes = EncodeVertexLight(light, kIoquake3VertexScale);
    ASSERT_EQ(bytes.size(), 24u);
    std::array<float, 6> floats{};
    std::memcpy(floats.data(), bytes.data(), bytes.size());
    EXPECT_THAT(floats, testing::ElementsAre(255, 1020, 0, 127.5f, 0, 510));
    EXPECT_THAT(DecodeVertexLight(bytes, 2, kIoquake3VertexScale, "x"),
                testing::ElementsAre(light[0], Vec3f(0.5f, 0, 2)));
    EXPECT_THAT(DecodeVertexLight(EncodeVertexLight(light, kRend2VertexScale), 2, kRend2VertexScale, "x"),
                testing::ElementsAre(light[0], Vec3f(0.5f, 0, 2)));
    EXPECT_THROW(DecodeVertexLight(bytes, 3, kIoquake3VertexScale, "x"), Error);
}

} // namespace
} // namespace q3
