// GPL-2.0-or-later. Image decoders.
#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "tests/support/game_folder.h"

#include <turbojpeg.h>
#include <zlib.h>

#include <cmath>
#include <functional>
#include <initializer_list>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

using testing::ElementsAre;

using Bytes = std::vector<std::uint8_t>;

std::span<const std::byte> AsFile(const Bytes &bytes) {
    return std::as_bytes(std::span(bytes));
}

struct TgaHead {
    int type = 2, depth = 24, descriptor = 0x20, width = 2, height = 2;
    int mapType = 0, mapFirst = 0, mapCount = 0, mapBits = 0;
};

Bytes Tga(const TgaHead &h, const Bytes &body, const Bytes &comment = {}) {
    const auto low = [](int v) { return std::uint8_t(v & 255); };
    const auto high = [](int v) { return std::uint8_t(v >> 8); };
    Bytes file = {std::uint8_t(comment.size()),
                  low(h.mapType),
                  low(h.type),
                  low(h.mapFirst),
                  high(h.mapFirst),
                  low(h.mapCount),
                  high(h.mapCount),
                  low(h.mapBits),
                  0,
                  0,
                  0,
                  0,
                  low(h.width),
                  high(h.width),
                  low(h.height),
                  high(h.height),
                  low(h.depth),
                  low(h.descriptor)};
    file.insert(file.end(), comment.begin(), comment.end());
    file.insert(file.end(), body.begin(), body.end());
    return file;
}

Image DecodeTga(const Bytes &file) {
    return q3::DecodeTga(AsFile(file), "a.tga");
}

using Row = std::initializer_list<std::uint8_t>;

TEST(Tga, ColorIsStoredBlueFirstAndTopDownByBit) {
    const Bytes body = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    const Image top = DecodeTga(Tga({.descriptor = 0x20}, body));
    EXPECT_THAT(top.rgba, ElementsAre(3, 2, 1, 255, 6, 5, 4, 255, 9, 8, 7, 255, 12, 11, 10, 255));
    const Image bottom = DecodeTga(Tga({.descriptor = 0}, body));
    EXPECT_THAT(bottom.rgba, ElementsAre(9, 8, 7, 255, 12, 11, 10, 255, 3, 2, 1, 255, 6, 5, 4, 255));
}

TEST(Tga, AlphaCountsOnlyWithAttributeBits) {
    const Bytes body = {1, 2, 3, 40, 5, 6, 7, 80};
    const TgaHead with{.depth = 32, .descriptor = 0x28, .width = 2, .height = 1};
    const TgaHead without{.depth = 32, .descriptor = 0x20, .width = 2, .height = 1};
    EXPECT_THAT(DecodeTga(Tga(with, body)).rgba, ElementsAre(3, 2, 1, 40, 7, 6, 5, 80));
    EXPECT_THAT(DecodeTga(Tga(without, body)).rgba, ElementsAre(3, 2, 1, 255, 7, 6, 5, 255));
}

TEST(Tga, GreyAndPalette) {
    EXPECT_THAT(DecodeTga(Tga({.type = 3, .depth = 8, .width = 2, .height = 1}, {7, 200})).rgba,
                ElementsAre(7, 7, 7, 255, 200, 200, 200, 255));
    const TgaHead palette{.type = 1, .depth = 8, .width = 2, .height = 1, .mapType = 1, .mapCount = 2, .mapBits = 24};
    EXPECT_THAT(DecodeTga(Tga(palette, {1, 2, 3, 4, 5, 6, 1, 0})).rgba, ElementsAre(6, 5, 4, 255, 3, 2, 1, 255));
    TgaHead alpha = palette;
    alpha.mapBits = 32;
    alpha.descriptor = 0x28;
    EXPECT_THAT(DecodeTga(Tga(alpha, {1, 2, 3, 9, 4, 5, 6, 8, 1, 0})).rgba, ElementsAre(6, 5, 4, 8, 3, 2, 1, 9));
}

TEST(Tga, PackedTypesGiveTheSamePixels) {
    // A run of three, one literal packet of two; the run crosses the row.
    const TgaHead color{.type = 10, .depth = 24, .width = 2, .height = 2};
    EXPECT_THAT(DecodeTga(Tga(color, {0x82, 1, 2, 3, 0x00, 4, 5, 6})).rgba,
                ElementsAre(3, 2, 1, 255, 3, 2, 1, 255, 3, 2, 1, 255, 6, 5, 4, 255));
    const TgaHead grey{.type = 11, .depth = 8, .width = 3, .height = 1};
    EXPECT_THAT(DecodeTga(Tga(grey, {0x01, 5, 6, 0x80, 7})).rgba,
                ElementsAre(5, 5, 5, 255, 6, 6, 6, 255, 7, 7, 7, 255));
    const TgaHead palette{.type = 9, .depth = 8, .width = 2, .height = 1, .mapType = 1, .mapCount = 1, .mapBits = 24};
    EXPECT_THAT(DecodeTga(Tga(palette, {1, 2, 3, 0x81, 0})).rgba, ElementsAre(3, 2, 1, 255, 3, 2, 1, 255));
}

TEST(Tga, CommentAndUnusedPaletteAreSkipped) {
    const TgaHead head{.width = 1, .height = 1, .mapType = 1, .mapCount = 2, .mapBits = 24};
    EXPECT_THAT(DecodeTga(Tga(head, {9, 9, 9, 9, 9, 9, 1, 2, 3}, {'h', 'i'})).rgba, ElementsAre(3, 2, 1, 255));
}

TEST(Tga, WhatIsNotSupportedIsAnError) {
    const Bytes body(64, 0);
    const TgaHead good{.width = 2, .height = 2};
    EXPECT_NO_THROW(DecodeTga(Tga(good, body)));
    const std::vector<std::function<void(TgaHead &)>> changes = {
        [](TgaHead &h) { h.type = 0; },
        [](TgaHead &h) { h.type = 4; },
        [](TgaHead &h) { h.type = 8; },
        [](TgaHead &h) { h.type = 32; },
        [](TgaHead &h) { h.depth = 16; },
        [](TgaHead &h) { h.depth = 8; },
        [](TgaHead &h) { h.descriptor = 0x10; },
        [](TgaHead &h) { h.descriptor = 1; },
        [](TgaHead &h) { h.width = 0; },
        [](TgaHead &h) { h.height = 0; },
        [](TgaHead &h) { h = {.type = 3, .depth = 24}; },
        [](TgaHead &h) { h = {.type = 1, .depth = 8}; },
        [](TgaHead &h) { h = {.type = 1, .depth = 8, .mapType = 1, .mapFirst = 1, .mapCount = 1, .mapBits = 24}; },
        [](TgaHead &h) { h = {.type = 1, .depth = 8, .mapType = 1, .mapCount = 1, .mapBits = 16}; },
        [](TgaHead &h) { h = {.type = 1, .depth = 8, .mapType = 1, .mapCount = 0, .mapBits = 24}; },
        [](TgaHead &h) { h = {.type = 1, .depth = 8, .mapType = 1, .mapCount = 257, .mapBits = 24}; },
    };
    for (std::size_t i = 0; i < changes.size(); ++i) {
        TgaHead head = good;
        changes[i](head);
        EXPECT_THROW(DecodeTga(Tga(head, Bytes(2000, 0))), Error) << "change " << i;
    }
}

TEST(Tga, TruncatedAtEveryLengthIsAnError) {
    const std::vector<Bytes> files = {
        Tga({}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, {'x'}),
        Tga({.type = 10}, {0x82, 1, 2, 3, 0x00, 4, 5, 6}),
        Tga({.type = 9, .depth = 8, .mapType = 1, .mapCount = 2, .mapBits = 32},
            {1, 2, 3, 4, 5, 6, 7, 8, 0x02, 0, 1, 0, 0x80, 1}),
        Tga({.type = 3, .depth = 8}, {1, 2, 3, 4}),
    };
    for (const Bytes &file : files) {
        EXPECT_NO_THROW(DecodeTga(file));
        for (std::size_t size = 0; size < file.size(); ++size)
            EXPECT_THROW(DecodeTga(Bytes(file.begin(), file.begin() + std::ptrdiff_t(size))), Error) << size;
    }
}

TEST(Tga, HugeHeaderWithFewBytesIsAnError) {
    EXPECT_THROW(DecodeTga(Tga({.width = 16384, .height = 4096}, Bytes(100, 0))), Error);
    EXPECT_THROW(DecodeTga(Tga({.type = 10, .width = 16384, .height = 4096}, Bytes(100, 0x81))), Error);
    EXPECT_THROW(DecodeTga(Tga({.type = 3, .depth = 8, .width = 16385, .height = 1}, Bytes(20000, 0))), Error);
    EXPECT_THROW(DecodeTga(Tga({.type = 10, .width = 65535, .height = 65535}, Bytes(100, 0x81))), Error);
}

// PNG files are put together here chunk by chunk, so that the reader is not tested against libpng's own writer.

void Chunk(Bytes &file, const char *type, const Bytes &data) {
    const auto word = [&](std::size_t v) {
        for (int shift = 24; shift >= 0; shift -= 8)
            file.push_back(std::uint8_t(v >> shift));
    };
    word(data.size());
    const std::size_t begin = file.size();
    file.insert(file.end(), type, type + 4);
    file.insert(file.end(), data.begin(), data.end());
    word(crc32(0, file.data() + begin, unsigned(file.size() - begin)));
}

/// `rows` have a filter byte before each row.
Bytes Png(int width, int height, int depth, int colorType, const Bytes &rows, const Bytes &palette = {},
          const Bytes &transparency = {}) {
    Bytes file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    const auto byte = [](int v, int shift) { return std::uint8_t(v >> shift); };
    Chunk(file, "IHDR",
          {byte(width, 24), byte(width, 16), byte(width, 8), byte(width, 0), byte(height, 24), byte(height, 16),
           byte(height, 8), byte(height, 0), std::uint8_t(depth), std::uint8_t(colorType), 0, 0, 0});
    if (!palette.empty())
        Chunk(file, "PLTE", palette);
    if (!transparency.empty())
        Chunk(file, "tRNS", transparency);
    uLongf size = compressBound(uLong(rows.size()));
    Bytes packed(size);
    compress(packed.data(), &size, rows.data(), uLong(rows.size()));
    packed.resize(size);
    Chunk(file, "IDAT", packed);
    Chunk(file, "IEND", {});
    return file;
}

Image DecodePng(const Bytes &file) {
    return q3::DecodePng(AsFile(file), "a.png");
}

TEST(Png, EveryColorTypeBecomesRgba) {
    EXPECT_THAT(DecodePng(Png(1, 1, 8, 2, {0, 1, 2, 3})).rgba, ElementsAre(1, 2, 3, 255));
    EXPECT_THAT(DecodePng(Png(1, 1, 8, 6, {0, 1, 2, 3, 4})).rgba, ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(DecodePng(Png(1, 2, 8, 0, {0, 9, 0, 200})).rgba, ElementsAre(9, 9, 9, 255, 200, 200, 200, 255));
    EXPECT_THAT(DecodePng(Png(1, 1, 8, 4, {0, 50, 60})).rgba, ElementsAre(50, 50, 50, 60));
    EXPECT_THAT(DecodePng(Png(4, 1, 1, 0, {0, 0b01010000})).rgba,
                ElementsAre(0, 0, 0, 255, 255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255));
    EXPECT_THAT(DecodePng(Png(2, 1, 4, 3, {0, 0x10}, {1, 2, 3, 4, 5, 6}, {77})).rgba,
                ElementsAre(4, 5, 6, 255, 1, 2, 3, 77));
    EXPECT_THAT(DecodePng(Png(2, 1, 8, 0, {0, 7, 8}, {}, {0, 7})).rgba, ElementsAre(7, 7, 7, 0, 8, 8, 8, 255));
}

TEST(Png, PaletteNumbersComeAsTheyAre) {
    const Bytes palette = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    const auto indexes = [](const Bytes &file) { return DecodePngIndexes(AsFile(file), "a.png"); };
    EXPECT_THAT(indexes(Png(3, 1, 8, 3, {0, 2, 0, 1}, palette))->indexes, ElementsAre(2, 0, 1));
    const auto packed = indexes(Png(3, 2, 2, 3, {0, 0b10000100, 0, 0b01100000}, palette));
    ASSERT_TRUE(packed);
    EXPECT_EQ(packed->width, 3);
    EXPECT_EQ(packed->height, 2);
    EXPECT_THAT(packed->indexes, ElementsAre(2, 0, 1, 1, 2, 0));
    EXPECT_FALSE(indexes(Png(1, 1, 8, 0, {0, 9})));
}

/// `texels` as they stand in the file: runs and single values.
Bytes Pcx(int width, int height, int stride, const Bytes &texels) {
    Bytes file(128);
    file[0] = 10, file[1] = 5, file[2] = 1, file[3] = 8, file[65] = 1;
    file[4] = 7, file[6] = 3; // first column and row
    file[8] = std::uint8_t(7 + width - 1), file[10] = std::uint8_t(3 + height - 1);
    file[66] = std::uint8_t(stride);
    file.insert(file.end(), texels.begin(), texels.end());
    return file;
}

IndexImage DecodePcx(const Bytes &file) {
    return q3::DecodePcx(AsFile(file), "a.pcx");
}

TEST(Pcx, RunsAndValuesAreRowsFromTheTop) {
    const IndexImage image = DecodePcx(Pcx(3, 2, 4, {0xC3, 7, 0, 1, 0xC1, 200, 0xC2, 9}));
    EXPECT_EQ(image.width, 3);
    EXPECT_EQ(image.height, 2);
    EXPECT_THAT(image.indexes, ElementsAre(7, 7, 7, 1, 200, 9));
}

TEST(Pcx, RunsMayPassTheEndOfARow) {
    EXPECT_THAT(DecodePcx(Pcx(2, 2, 2, {0xC3, 5, 6})).indexes, ElementsAre(5, 5, 5, 6));
    EXPECT_THAT(DecodePcx(Pcx(2, 1, 2, {0xFF, 5})).indexes, ElementsAre(5, 5)); // and that of the image
}

TEST(Pcx, WhatIsNotSupportedIsAnError) {
    for (const std::size_t at : {0, 2, 3, 65}) {
        Bytes file = Pcx(2, 2, 2, {1, 2, 3, 4});
        file[at] = 24;
        EXPECT_THROW(DecodePcx(file), Error) << at;
    }
    EXPECT_THROW(DecodePcx(Pcx(0, 2, 2, {1, 2, 3, 4})), Error);
    EXPECT_THROW(DecodePcx(Pcx(3, 2, 2, {1, 2, 3, 4})), Error); // rows of two bytes
    Bytes large = Pcx(2, 2, 2, {1, 2, 3, 4});
    large[9] = large[11] = 0x3F; // 16 k a side
    large[67] = 0x40;
    EXPECT_THROW(DecodePcx(large), Error);
}

TEST(Pcx, TruncatedAtEveryLengthIsAnError) {
    const Bytes file = Pcx(3, 2, 4, {0xC3, 7, 0, 1, 0xC1, 200, 0xC2, 9});
    for (std::size_t size = 0; size < file.size(); ++size)
        EXPECT_THROW(DecodePcx(Bytes(file.begin(), file.begin() + std::ptrdiff_t(size))), Error) << size;
}

TEST(Png, SixteenBitsAreScaledWithoutGamma) {
    EXPECT_THAT(DecodePng(Png(1, 1, 16, 2, {0, 0xFF, 0xFF, 0x80, 0x80, 0, 0})).rgba, ElementsAre(255, 128, 0, 255));
    EXPECT_THAT(DecodePng(Png(1, 1, 16, 4, {0, 0x40, 0x40, 0x20, 0x20})).rgba, ElementsAre(64, 64, 64, 32));
}

TEST(Png, DeepTexelsKeepAllBits) {
    const auto deep = [](const Bytes &file) { return DecodeDeepPng(AsFile(file), "a.png"); };
    const DeepImage color = deep(Png(1, 1, 16, 2, {0, 0xFF, 0xFF, 0x12, 0x34, 0, 1}));
    EXPECT_THAT(color.rgba, ElementsAre(65535, 0x1234, 1, 65535));
    EXPECT_EQ(color.bits, 16);
    EXPECT_THAT(deep(Png(1, 1, 16, 4, {0, 0x40, 0x41, 0x20, 0x21})).rgba, ElementsAre(0x4041, 0x4041, 0x4041, 0x2021));
    const DeepImage gray = deep(Png(2, 1, 8, 0, {0, 9, 255}));
    EXPECT_THAT(gray.rgba, ElementsAre(9 * 257, 9 * 257, 9 * 257, 65535, 65535, 65535, 65535, 65535));
    EXPECT_EQ(gray.bits, 8);
    const DeepImage few = deep(Png(2, 1, 4, 0, {0, 0x1F}));
    EXPECT_EQ(few.rgba[0], 65535 / 15);
    EXPECT_EQ(few.bits, 4);
    EXPECT_EQ(deep(Png(2, 1, 4, 3, {0, 0x10}, {1, 2, 3, 4, 5, 6}, {77})).rgba[7], 77 * 257);
    EXPECT_THROW(deep(Png(16384, 16384, 1, 0, Bytes(100, 0))), Error);
}

TEST(ImageFile, TheContentsTellTheFormatButForTga) {
    const test::GameFolder folder;
    const auto write = [&](std::string_view name, const Bytes &bytes) {
        folder.Write(name, std::string_view(reinterpret_cast<const char *>(bytes.data()), bytes.size()));
        return ReadDeepImage(folder / name);
    };
    EXPECT_EQ(write("a.jpg", Png(1, 1, 16, 0, {0, 0x12, 0x34})).rgba[0], 0x1234);
    EXPECT_EQ(write("b.TGA", Tga({.width = 1, .height = 1}, {3, 2, 1})).rgba,
              (DeepImage{1, 1, 8, {257, 514, 771, 65535}}).rgba);
    for (const char *name : {"c.txt", "c.png"})
        EXPECT_THROW(write(name, {'t', 'e', 'x', 't'}), Error) << name;
    EXPECT_THROW(write("d.tga", {'t', 'e', 'x', 't'}), Error);
    EXPECT_THROW(ReadDeepImage(folder / "none.png"), Error);
}

TEST(Png, ThreeChannelsAreWrittenAsSuch) {
    const test::GameFolder folder;
    const Bytes rgb = {1, 2, 3, 4, 5, 6};
    WritePng(folder / "a.png", rgb, 1, 2, 3);
    const auto file = ReadFile(folder / "a.png");
    EXPECT_EQ(std::to_integer<int>(file.at(25)), 2) << "color type: RGB";
    EXPECT_THAT(q3::DecodePng(file, "a.png").rgba, ElementsAre(1, 2, 3, 255, 4, 5, 6, 255));
    EXPECT_THROW(WritePng(folder / "b.png", rgb, 1, 2, 4), Error);
}

TEST(Png, TruncatedIsAnErrorUntilAllPixelsAreThere) {
    Bytes rows;
    for (int y = 0; y < 8; ++y) {
        rows.push_back(0);
        for (int x = 0; x < 8 * 3; ++x)
            rows.push_back(std::uint8_t(37 * (x + 24 * y)));
    }
    const Bytes file = Png(8, 8, 8, 2, rows);
    const Image whole = DecodePng(file);
    int errors = 0;
    for (std::size_t size = 0; size < file.size(); ++size) {
        try {
            EXPECT_EQ(DecodePng(Bytes(file.begin(), file.begin() + std::ptrdiff_t(size))).rgba, whole.rgba);
        } catch (const Error &) {
            ++errors;
        }
    }
    // All but the last chunk, the checksum before it and the end of the deflate stream.
    EXPECT_GE(errors, int(file.size()) - 12 - 4 - 6);
}

TEST(Png, NoChangedByteDoesHarm) {
    const Bytes file = Png(2, 2, 8, 3, {0, 0, 1, 0, 1, 0}, {1, 2, 3, 4, 5, 6}, {9});
    int errors = 0;
    for (std::size_t i = 0; i < file.size(); ++i)
        for (const int mask : {1, 0x80, 0xFF}) {
            Bytes bytes = file;
            bytes[i] = std::uint8_t(bytes[i] ^ mask);
            try {
                const Image image = DecodePng(bytes);
                EXPECT_EQ(image.rgba.size(), 4 * std::size_t(image.width) * std::size_t(image.height));
            } catch (const Error &) {
                ++errors;
            }
        }
    EXPECT_GT(errors, int(file.size()));
}

TEST(Png, HugeHeaderWithFewBytesIsAnError) {
    EXPECT_THROW(DecodePng(Png(8000, 8000, 8, 6, {0, 1, 2, 3, 4})), Error);
    EXPECT_THROW(DecodePng(Png(100000, 1, 1, 0, Bytes(20000, 0))), Error);
    EXPECT_THROW(DecodePng(Png(16384, 16384, 1, 0, Bytes(100, 0))), Error);
}

TEST(Png, WrittenImageReadsBackTheSame) {
    const test::GameFolder folder;
    Image image{3, 2, {}};
    for (int i = 0; i < 4 * 3 * 2; ++i)
        image.rgba.push_back(std::uint8_t(i * 10));
    WritePng(folder / "a.png", image);
    const auto file = ReadFile(folder / "a.png");
    const Image back = q3::DecodePng(file, "a.png");
    EXPECT_EQ(back.width, 3);
    EXPECT_EQ(back.height, 2);
    EXPECT_EQ(back.rgba, image.rgba);
    EXPECT_THROW(WritePng(folder / "b.png", Image{}), Error);
    EXPECT_THROW(WritePng(folder / "b.png", Image{2, 2, Bytes(4)}), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "b.png"));
    EXPECT_THROW(WritePng(folder / "none/b.png", image), Error);
}

Bytes Jpeg(int width, int height, const std::function<std::array<int, 3>(int, int)> &color, int format = TJPF_RGB) {
    Bytes rgb;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const int channel : color(x, y))
                rgb.push_back(std::uint8_t(channel));
    unsigned char *out = nullptr;
    unsigned long size = 0;
    tjhandle encoder = tjInitCompress();
    EXPECT_EQ(tjCompress2(encoder, rgb.data(), width, 0, height, format, &out, &size, TJSAMP_444, 100, 0), 0);
    Bytes file(out, out + size);
    tjFree(out);
    tjDestroy(encoder);
    return file;
}

Image DecodeJpeg(const Bytes &file) {
    return q3::DecodeJpeg(AsFile(file), "a.jpg");
}

TEST(Jpeg, DecodesTopDownWithFullAlpha) {
    const Image image = DecodeJpeg(Jpeg(16, 32, [](int, int y) {
        return y < 16 ? std::array{250, 20, 30} : std::array{10, 240, 60};
    }));
    ASSERT_EQ(image.width, 16);
    ASSERT_EQ(image.height, 32);
    const auto top = image.Texel(3, 2), bottom = image.Texel(3, 29);
    EXPECT_NEAR(top[0], 250, 3);
    EXPECT_NEAR(top[1], 20, 3);
    EXPECT_NEAR(bottom[0], 10, 3);
    EXPECT_NEAR(bottom[1], 240, 3);
    EXPECT_EQ(top[3], 255);
}

TEST(Jpeg, TruncatedIsAnError) {
    const Bytes file = Jpeg(32, 32, [](int x, int y) {
        return std::array{(x * 57 + y * y * 31) & 255, (x * y) & 255, (x + y * 7) & 255};
    });
    EXPECT_NO_THROW(DecodeJpeg(file));
    for (std::size_t size = 0; size + 16 < file.size(); size += size < 700 ? 1 : 7)
        EXPECT_THROW(DecodeJpeg(Bytes(file.begin(), file.begin() + std::ptrdiff_t(size))), Error) << size;
}

TEST(Jpeg, HugeHeaderWithFewBytesIsAnError) {
    Bytes file = Jpeg(8, 8, [](int, int) { return std::array{1, 2, 3}; });
    const Bytes marker = {0xFF, 0xC0};
    const auto frame = std::search(file.begin(), file.end(), marker.begin(), marker.end());
    ASSERT_NE(frame, file.end());
    for (const int side : {8000, 16384, 65000}) {
        frame[5] = frame[7] = std::uint8_t(side >> 8);
        frame[6] = frame[8] = std::uint8_t(side & 255);
        EXPECT_THROW(DecodeJpeg(file), Error) << side;
    }
}

TEST(Jpeg, NoChangedByteDoesHarm) {
    const Bytes file = Jpeg(8, 8, [](int x, int y) { return std::array{x * 30, y * 30, 90}; });
    int errors = 0;
    for (std::size_t i = 0; i < file.size(); ++i) {
        Bytes bytes = file;
        bytes[i] = std::uint8_t(bytes[i] ^ 0xFF);
        try {
            const Image image = DecodeJpeg(bytes);
            EXPECT_EQ(image.rgba.size(), 4 * std::size_t(image.width) * std::size_t(image.height));
        } catch (const Error &) {
            ++errors;
        }
    }
    EXPECT_GT(errors, 0);
}

} // namespace
} // namespace q3
