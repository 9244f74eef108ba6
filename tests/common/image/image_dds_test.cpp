// GPL-2.0-or-later. DDS images: blocks by the formulas of S3TC, masks, and files that are cut or changed.
#include "common/error.h"
#include "common/image/image.h"

#include <functional>
#include <initializer_list>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;
using Texel = std::array<std::uint8_t, 4>;

struct DdsHead {
    int width = 4, height = 4;
    unsigned flags = 4; ///< of the pixel format: 1 alpha, 4 FourCC, 0x40 RGB, 0x20000 luminance
    std::string_view fourCc = "DXT1";
    unsigned bits = 0;
    std::array<unsigned, 4> masks{};
    unsigned dxgi = 0; ///< of the extended header, with FourCC DX10
};

void Put(Bytes &file, std::size_t at, std::size_t value) {
    for (std::size_t i = 0; i < 4; ++i)
        file[at + i] = std::uint8_t(value >> (8 * i));
}

Bytes Dds(const DdsHead &head, const Bytes &body) {
    Bytes file(128);
    std::copy_n("DDS ", 4, file.begin());
    Put(file, 4, 124), Put(file, 8, 0x1007);
    Put(file, 12, std::size_t(head.height)), Put(file, 16, std::size_t(head.width));
    Put(file, 28, 3); // mipmaps
    Put(file, 76, 32), Put(file, 80, head.flags), Put(file, 88, head.bits);
    if ((head.flags & 4) != 0)
        std::copy_n(head.fourCc.begin(), 4, file.begin() + 84);
    for (std::size_t i = 0; i < 4; ++i)
        Put(file, 92 + 4 * i, head.masks[i]);
    if (head.fourCc == "DX10") {
        file.resize(148);
        Put(file, 128, head.dxgi);
    }
    file.insert(file.end(), body.begin(), body.end());
    return file;
}

Image Decode(const Bytes &file) {
    return DecodeDds(std::as_bytes(std::span(file)), "a.dds");
}

std::string ErrorOf(const Bytes &file) {
    try {
        Decode(file);
    } catch (const Error &error) {
        return error.what();
    }
    return "";
}

/// Pure red and pure blue in 565, and a row of the indexes 0 to 3 four times.
const Bytes kRedOverBlue = {0x00, 0xF8, 0x1F, 0x00, 0xE4, 0xE4, 0xE4, 0xE4};
const Bytes kBlueUnderRed = {0x1F, 0x00, 0x00, 0xF8, 0xE4, 0xE4, 0xE4, 0xE4};

Bytes operator+(Bytes a, const Bytes &b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

TEST(Dds, BlocksOfDxt1HaveTwoColorsAndTwoBetween) {
    const Image four = Decode(Dds({}, kRedOverBlue));
    ASSERT_EQ(four.width, 4);
    ASSERT_EQ(four.height, 4);
    EXPECT_EQ(four.Texel(0, 0), (Texel{255, 0, 0, 255}));
    EXPECT_EQ(four.Texel(1, 3), (Texel{0, 0, 255, 255}));
    EXPECT_EQ(four.Texel(2, 1), (Texel{170, 0, 85, 255}));
    EXPECT_EQ(four.Texel(3, 2), (Texel{85, 0, 170, 255}));
    const Image three = Decode(Dds({}, kBlueUnderRed));
    EXPECT_EQ(three.Texel(2, 0), (Texel{127, 0, 127, 255}));
    EXPECT_EQ(three.Texel(3, 0), (Texel{0, 0, 0, 0})) << "the fourth is transparent";
}

TEST(Dds, AlphaOfDxt3AndDxt5) {
    const Bytes alpha4 = {0x10, 0xF8, 0, 0, 0, 0, 0, 0}; // 0, 1, 8 and 15 of 15
    const Image dxt3 = Decode(Dds({.fourCc = "DXT3"}, alpha4 + kRedOverBlue));
    EXPECT_EQ(dxt3.Texel(0, 0), (Texel{255, 0, 0, 0}));
    EXPECT_EQ(dxt3.Texel(1, 0)[3], 17);
    EXPECT_EQ(dxt3.Texel(2, 0)[3], 136);
    EXPECT_EQ(dxt3.Texel(3, 0)[3], 255);
    const Bytes alpha8 = {210, 70, 0x88, 0x06, 0, 0, 0, 0}; // indexes 0, 1, 2, 3
    const Image dxt5 = Decode(Dds({.fourCc = "DXT5"}, alpha8 + kRedOverBlue));
    EXPECT_EQ(dxt5.Texel(0, 0)[3], 210);
    EXPECT_EQ(dxt5.Texel(1, 0)[3], 70);
    EXPECT_EQ(dxt5.Texel(2, 0)[3], (6 * 210 + 70) / 7);
    EXPECT_EQ(dxt5.Texel(3, 0)[3], (5 * 210 + 2 * 70) / 7);
}

TEST(Dds, BlocksMayReachBeyondTheImage) {
    const Image image =
        Decode(Dds({.width = 6, .height = 5}, kRedOverBlue + kBlueUnderRed + kBlueUnderRed + kRedOverBlue + Bytes(8)));
    EXPECT_EQ(image.rgba.size(), 4u * 6 * 5);
    EXPECT_EQ(image.Texel(0, 3), (Texel{255, 0, 0, 255}));
    EXPECT_EQ(image.Texel(4, 0), (Texel{0, 0, 255, 255}));
    EXPECT_EQ(image.Texel(0, 4), (Texel{0, 0, 255, 255}));
    EXPECT_EQ(image.Texel(4, 4), (Texel{255, 0, 0, 255}));
    EXPECT_EQ(Decode(Dds({.width = 1, .height = 2}, kRedOverBlue)).Texel(0, 1), (Texel{255, 0, 0, 255}));
}

TEST(Dds, MasksSayWhereTheColorsAre) {
    const auto one = [](DdsHead head, const Bytes &body) {
        head.width = head.height = 1;
        return Decode(Dds(head, body)).rgba;
    };
    const std::array<unsigned, 4> bgra = {0xFF0000, 0xFF00, 0xFF, 0xFF000000};
    const std::array<unsigned, 4> rgba = {0xFF, 0xFF00, 0xFF0000, 0xFF000000};
    EXPECT_THAT(one({.flags = 0x41, .bits = 32, .masks = bgra}, {1, 2, 3, 64}), ElementsAre(3, 2, 1, 64));
    EXPECT_THAT(one({.flags = 0x40, .bits = 32, .masks = bgra}, {1, 2, 3, 64}), ElementsAre(3, 2, 1, 255));
    EXPECT_THAT(one({.flags = 0x41, .bits = 32, .masks = rgba}, {1, 2, 3, 64}), ElementsAre(1, 2, 3, 64));
    EXPECT_THAT(one({.flags = 0x40, .bits = 24, .masks = bgra}, {1, 2, 3}), ElementsAre(3, 2, 1, 255));
    EXPECT_THAT(one({.flags = 0x40, .bits = 16, .masks = {0xF800, 0x7E0, 0x1F, 0}}, {0x10, 0x84}),
                ElementsAre(16 * 255 / 31 + 1, 32 * 255 / 63 + 1, 16 * 255 / 31 + 1, 255)); // rounded
    EXPECT_THAT(one({.flags = 0x41, .bits = 16, .masks = {0x7C00, 0x3E0, 0x1F, 0x8000}}, {0xFF, 0x7F}),
                ElementsAre(255, 255, 255, 0));
    EXPECT_THAT(
        one({.flags = 0x41, .bits = 32, .masks = {0x3FF, 0xFFC00, 0x3FF00000, 0xC0000000}}, {0xFF, 0x03, 0, 0x40}),
        ElementsAre(255, 0, 0, 85));
    EXPECT_THAT(one({.flags = 0x20000, .bits = 8, .masks = {0xFF, 0, 0, 0}}, {77}), ElementsAre(77, 77, 77, 255));
    EXPECT_THAT(one({.flags = 0x20001, .bits = 16, .masks = {0xFF, 0, 0, 0xFF00}}, {77, 9}),
                ElementsAre(77, 77, 77, 9));
}

TEST(Dds, TheExtendedHeaderNamesTheSameFormats) {
    EXPECT_EQ(Decode(Dds({.fourCc = "DX10", .dxgi = 71}, kRedOverBlue)).rgba, Decode(Dds({}, kRedOverBlue)).rgba);
    EXPECT_EQ(Decode(Dds({.width = 1, .height = 1, .fourCc = "DX10", .dxgi = 87}, {1, 2, 3, 4})).rgba,
              (std::vector<std::uint8_t>{3, 2, 1, 4}));
    EXPECT_EQ(Decode(Dds({.width = 1, .height = 1, .fourCc = "DX10", .dxgi = 115}, {0x4F, 0x08})).rgba,
              (std::vector<std::uint8_t>{8 * 17, 4 * 17, 15 * 17, 0}));
    EXPECT_THAT(ErrorOf(Dds({.fourCc = "DX10", .dxgi = 10}, Bytes(16))), HasSubstr("DXGI format 10"));
}

TEST(Dds, EveryNumberOfDxgiIsItsFormat) {
    struct Family {
        std::string_view fourCc;
        Bytes body;
        std::initializer_list<unsigned> numbers;
    };
    const Bytes alpha = {210, 70, 0x88, 0x06, 0, 0, 0, 0};
    for (const Family &family : {Family{"DXT1", kRedOverBlue, {70, 71, 72}},
                                 {"DXT3", alpha + kRedOverBlue, {73, 74, 75}},
                                 {"DXT5", alpha + kRedOverBlue, {76, 77, 78}},
                                 {"ATI1", alpha, {79, 80}},
                                 {"ATI2", alpha + alpha, {82, 83}}})
        for (const unsigned number : family.numbers)
            EXPECT_EQ(Decode(Dds({.fourCc = "DX10", .dxgi = number}, family.body)).rgba,
                      Decode(Dds({.fourCc = family.fourCc}, family.body)).rgba)
                << number;
    const Bytes white = Bytes{0xC0} + Bytes(7, 0xFF) + Bytes{0x01} + Bytes(7);
    for (const unsigned number : {97u, 98u, 99u})
        EXPECT_EQ(Decode(Dds({.fourCc = "DX10", .dxgi = number}, white)).Texel(2, 1), (Texel{255, 255, 255, 255}));
    struct Masked {
        unsigned number;
        Bytes body;
        Texel texel;
    };
    for (const Masked &masked : {Masked{28, {1, 2, 3, 4}, {1, 2, 3, 4}},
                                 {29, {1, 2, 3, 4}, {1, 2, 3, 4}},
                                 {61, {77}, {77, 77, 77, 255}},
                                 {85, {0x00, 0xF8}, {255, 0, 0, 255}},
                                 {86, {0xE0, 0x83}, {0, 255, 0, 255}},
                                 {87, {1, 2, 3, 4}, {3, 2, 1, 4}},
                                 {91, {1, 2, 3, 4}, {3, 2, 1, 4}},
                                 {88, {1, 2, 3, 4}, {3, 2, 1, 255}},
                                 {93, {1, 2, 3, 4}, {3, 2, 1, 255}}}) {
        const DdsHead head{.width = 1, .height = 1, .fourCc = "DX10", .dxgi = masked.number};
        EXPECT_EQ(Decode(Dds(head, masked.body)).Texel(0, 0), masked.texel) << masked.number;
    }
}

TEST(Dds, OneAndTwoChannelsAndBc7) {
    const Bytes channel = {210, 70, 0, 0, 0, 0, 0, 0};
    for (const std::string_view code : {"ATI1", "BC4U"})
        EXPECT_EQ(Decode(Dds({.fourCc = code}, channel)).Texel(3, 3), (Texel{210, 210, 210, 255})) << code;
    EXPECT_EQ(Decode(Dds({.fourCc = "DX10", .dxgi = 80}, channel)).Texel(0, 0), (Texel{210, 210, 210, 255}));
    for (const std::string_view code : {"ATI2", "BC5U"})
        EXPECT_EQ(Decode(Dds({.fourCc = code}, Bytes{255, 0, 0, 0, 0, 0, 0, 0} + Bytes{128, 0, 0, 0, 0, 0, 0, 0}))
                      .Texel(0, 0),
                  (Texel{255, 128, 128, 255}))
            << code;
    const Bytes white = Bytes{0xC0} + Bytes(7, 0xFF) + Bytes{0x01} + Bytes(7); // mode 6, all ends 127 and 1, indexes 0
    EXPECT_EQ(Decode(Dds({.fourCc = "DX10", .dxgi = 98}, white)).Texel(2, 1), (Texel{255, 255, 255, 255}));
    EXPECT_EQ(Decode(Dds({.fourCc = "DXT2"}, Bytes(8) + kRedOverBlue)).Texel(1, 0), (Texel{0, 0, 255, 0}));
}

TEST(Dds, WhatIsNotSupportedIsNamed) {
    EXPECT_THAT(ErrorOf(Dds({.fourCc = "BC4S"}, Bytes(16))), HasSubstr("a.dds: DDS with format BC4S, expected DXT1"));
    EXPECT_THAT(ErrorOf(Dds({.flags = 0x40, .bits = 12, .masks = {1, 2, 4, 0}}, Bytes(64))), HasSubstr("12 bits"));
    EXPECT_THAT(ErrorOf(Dds({.flags = 0x40, .bits = 8, .masks = {0x100, 2, 4, 0}}, Bytes(64))), HasSubstr("masks 100"));
    EXPECT_THAT(ErrorOf(Dds({.flags = 0x40, .bits = 8, .masks = {5, 2, 8, 0}}, Bytes(64))), HasSubstr("masks 5"));
    EXPECT_THAT(ErrorOf(Dds({.flags = 2, .bits = 8, .masks = {0, 0, 0, 0xFF}}, Bytes(64))), HasSubstr("masks 0"));
    EXPECT_THAT(ErrorOf(Dds({.width = 0}, Bytes(64))), HasSubstr("0 x 4"));
    Bytes file = Dds({}, kRedOverBlue);
    file[4] = 0;
    EXPECT_THAT(ErrorOf(file), HasSubstr("header size of 0"));
}

TEST(Dds, TruncatedAtEveryLengthIsAnError) {
    for (const Bytes &file :
         {Dds({}, kRedOverBlue), Dds({.fourCc = "DXT5"}, Bytes(8) + kRedOverBlue),
          Dds({.fourCc = "DX10", .dxgi = 77}, Bytes(8) + kRedOverBlue), Dds({.fourCc = "ATI1"}, kRedOverBlue),
          Dds({.fourCc = "ATI2"}, Bytes(8) + kRedOverBlue), Dds({.fourCc = "DX10", .dxgi = 99}, Bytes(16, 0x40)),
          Dds({.width = 3, .height = 2, .flags = 0x40, .bits = 24, .masks = {0xFF0000, 0xFF00, 0xFF, 0}}, Bytes(18))}) {
        EXPECT_EQ(ErrorOf(file), "");
        for (std::size_t size = 0; size < file.size(); ++size)
            EXPECT_THAT(ErrorOf(Bytes(file.begin(), file.begin() + std::ptrdiff_t(size))), HasSubstr("a.dds: DDS ends"))
                << size;
    }
}

TEST(Dds, NoChangedByteDoesHarm) {
    const Bytes file = Dds({}, kRedOverBlue);
    for (std::size_t i = 0; i < file.size(); ++i)
        for (const int mask : {1, 0x40, 0x80, 0xFF}) {
            Bytes bytes = file;
            bytes[i] = std::uint8_t(bytes[i] ^ mask);
            try {
                const Image image = Decode(bytes);
                EXPECT_EQ(image.rgba.size(), 4 * std::size_t(image.width) * std::size_t(image.height));
            } catch (const Error &) { // as good
            }
        }
    for (const int side : {8000, 16384, 65536})
        EXPECT_NE(ErrorOf(Dds({.width = side, .height = side}, kRedOverBlue)), "") << side;
}

} // namespace
} // namespace q3
