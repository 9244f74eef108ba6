// GPL-2.0-or-later. Images of fewer texels, and images as files in memory.
#include "common/error.h"
#include "common/image/image.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

using testing::ElementsAre;

/// Texels that depend on their column and row by a smooth slope.
Image Slope(int width, int height) {
    Image image{width, height, {}};
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            for (const int value : {2 * column, 3 * row, 100, 255})
                image.rgba.push_back(std::uint8_t(value));
    return image;
}

TEST(Reduced, ATexelIsTheMeanOfWhatItCovers) {
    const Image image{4, 1, {0, 0, 0, 255, 100, 40, 0, 0, 10, 8, 4, 2, 30, 8, 8, 4}};
    const Image small = Reduced(image, 2);
    EXPECT_EQ(small.width, 2);
    EXPECT_EQ(small.height, 1);
    EXPECT_THAT(small.Texel(0, 0), ElementsAre(50, 20, 0, 128));
    EXPECT_THAT(small.Texel(1, 0), ElementsAre(20, 8, 6, 3));
    // A texel of 3 to 2 covers one and a half: (60 + 0.5 * 90) / 1.5.
    EXPECT_EQ(Reduced({3, 1, {60, 0, 0, 255, 90, 0, 0, 255, 0, 0, 0, 255}}, 2).Texel(0, 0)[0], 70);
}

TEST(Reduced, KeepsProportionsAndWhatFits) {
    const Image wide = Reduced(Slope(100, 50), 33);
    EXPECT_EQ(wide.width, 33);
    EXPECT_EQ(wide.height, 17);
    EXPECT_EQ(wide.rgba.size(), std::size_t(4 * 33 * 17));
    const Image strip = Reduced(Slope(2, 80), 16);
    EXPECT_EQ(strip.width, 1) << "never empty";
    EXPECT_EQ(strip.height, 16);
    EXPECT_EQ(Reduced(Slope(7, 5), 7).rgba, Slope(7, 5).rgba);
    EXPECT_EQ(Reduced(Slope(7, 5), 128).width, 7) << "never larger";
}

TEST(Reduced, KeepsTheMeanOfTheImage) {
    const auto mean = [](const Image &image) {
        double sum = 0;
        for (std::size_t i = 0; i < image.rgba.size(); i += 4)
            sum += image.rgba[i];
        return 4 * sum / double(image.rgba.size());
    };
    EXPECT_NEAR(mean(Reduced(Slope(97, 61), 13)), mean(Slope(97, 61)), 0.5);
}

TEST(EncodedImages, DecodeToTheSame) {
    const Image image = Slope(40, 24);
    const auto png = EncodePng(image.rgba, 40, 24, 4, "a.png");
    EXPECT_EQ(DecodeImage(png, "any name").rgba, image.rgba);
    const Image jpeg = DecodeImage(EncodeJpeg(image, 90, "a.jpg"), "any name");
    ASSERT_EQ(jpeg.rgba.size(), image.rgba.size());
    for (std::size_t i = 0; i < image.rgba.size(); ++i)
        EXPECT_NEAR(jpeg.rgba[i], image.rgba[i], 12) << i;
    EXPECT_LT(EncodeJpeg(image, 20, "a.jpg").size(), EncodeJpeg(image, 95, "a.jpg").size());
    const std::vector<std::uint8_t> texel = {1, 2, 3, 4};
    EXPECT_EQ(DecodeImage(EncodeTga(texel, 1, 1, 4, TgaRows::TopFirst), "A.TGA").rgba, texel);
    EXPECT_THROW(DecodeImage(EncodeTga(texel, 1, 1, 4, TgaRows::TopFirst), "a.dds"), Error);
    EXPECT_THROW(EncodePng(texel, 2, 1, 4, "a.png"), Error);
    EXPECT_THROW(EncodePng(texel, 4, 1, 1, "a.png"), Error) << "it writes RGB and RGBA only";
}

} // namespace
} // namespace q3
