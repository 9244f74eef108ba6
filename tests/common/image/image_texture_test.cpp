// GPL-2.0-or-later. Compressed blocks by their specifications; KTX, Crunch and WebP, and such files cut or changed.
#include "common/error.h"
#include "common/image/image.h"
#include "common/image/texture_data.h"

#include <functional>
#include <initializer_list>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;
using Rgba = std::array<std::uint8_t, 4>;
using Decoder = Image (*)(std::span<const std::byte>, std::string_view);

std::span<const std::byte> FileBytes(const Bytes &bytes) {
    return std::as_bytes(std::span(bytes));
}

std::string FaultOf(Decoder decode, const Bytes &file) {
    try {
        decode(FileBytes(file), "a.file");
    } catch (const Error &error) {
        return error.what();
    }
    return "";
}

/// The 4 x 4 image of one block.
Image Block(TextureBlocks format, const Bytes &block) {
    return {4, 4, DecodeBlocks(format, FileBytes(block), 4, 4)};
}

/// Fields of a block from the lowest bit on.
class BitWriter {
  public:
    BitWriter &Put(unsigned value, unsigned count, int times = 1) {
        for (int time = 0; time < times; ++time)
            for (unsigned i = 0; i < count; ++i, ++at_)
                block_[at_ / 8] = std::uint8_t(block_[at_ / 8] | (value >> i & 1) << (at_ % 8));
        return *this;
    }
    const Bytes &Block() const { return block_; }

  private:
    Bytes block_ = Bytes(16);
    std::size_t at_ = 0;
};

// ---- Blocks ----

TEST(TextureBlocksBc, GrayAndNormals) {
    const Bytes channel = {210, 70, 0x88, 0x06, 0, 0, 0, 0}; // indexes 0, 1, 2, 3, then 0
    EXPECT_EQ(Block(TextureBlocks::Bc4, channel).Texel(0, 0), (Rgba{210, 210, 210, 255}));
    EXPECT_EQ(Block(TextureBlocks::Bc4, channel).Texel(2, 0)[0], (6 * 210 + 70) / 7);
    const Bytes x = {255, 128, 0, 0, 0, 0, 0, 0}, y = {128, 0, 0, 0, 0, 0, 0, 0}, middle = y;
    Bytes sideways = x, upward = middle;
    sideways.insert(sideways.end(), y.begin(), y.end());
    upward.insert(upward.end(), middle.begin(), middle.end());
    EXPECT_EQ(Block(TextureBlocks::Bc5, sideways).Texel(1, 1), (Rgba{255, 128, 128, 255})) << "z is 0";
    EXPECT_EQ(Block(TextureBlocks::Bc5, upward).Texel(1, 1), (Rgba{128, 128, 255, 255})) << "z is 1";
}

TEST(TextureBlocksBc, OpaqueBc1HasBlackForTransparent) {
    const Bytes block = {0x1F, 0x00, 0x00, 0xF8, 0xFF, 0xFF, 0xFF, 0xFF}; // index 3, the first color less
    EXPECT_EQ(Block(TextureBlocks::Bc1, block).Texel(0, 0), (Rgba{0, 0, 0, 0}));
    EXPECT_EQ(Block(TextureBlocks::Bc1Opaque, block).Texel(0, 0), (Rgba{0, 0, 0, 255}));
}

TEST(TextureBlocksBc7, Mode6HasOneLineOfRgba) {
    BitWriter bits;
    bits.Put(0x40, 7);
    for (const unsigned channel : {10u, 100u, 20u, 90u, 30u, 80u, 127u, 0u}) // red, green, blue, alpha: two each
        bits.Put(channel, 7);
    bits.Put(1, 1).Put(0, 1).Put(0, 3).Put(15, 4).Put(8, 4); // lowest bits; indexes 0, 15, 8
    const Image image = Block(TextureBlocks::Bc7, bits.Block());
    EXPECT_EQ(image.Texel(0, 0), (Rgba{21, 41, 61, 255}));
    EXPECT_EQ(image.Texel(1, 0), (Rgba{200, 180, 160, 0}));
    const auto between = [](int a, int b) { return std::uint8_t((30 * a + 34 * b + 32) / 64); };
    EXPECT_EQ(image.Texel(2, 0), (Rgba{between(21, 200), between(41, 180), between(61, 160), between(255, 0)}));
}

TEST(TextureBlocksBc7, PartitionsOfTwoAndThree) {
    BitWriter two; // mode 1, partition 13: the lower half is the second subset
    two.Put(2, 2).Put(13, 6);
    for (const unsigned channel : {63u, 0u, 0u}) // red, green, blue of the first subset twice, then of the second
        two.Put(channel, 6, 2).Put(63 - channel, 6, 2);
    const Image halves = Block(TextureBlocks::Bc7, two.Put(1, 1).Put(1, 1).Block());
    EXPECT_EQ(halves.Texel(3, 1), (Rgba{255, 2, 2, 255})); // 7 bits, 1, with their highest bit below them
    EXPECT_EQ(halves.Texel(0, 2), (Rgba{2, 255, 255, 255}));
    BitWriter three; // mode 0, partition 8: rows 0 and 1, row 2, row 3
    three.Put(1, 1).Put(8, 4);
    for (const auto &channel : {std::array<unsigned, 3>{15, 0, 0}, {0, 15, 0}, {0, 0, 15}})
        for (const unsigned subset : channel)
            three.Put(subset, 4, 2);
    const Image rows = Block(TextureBlocks::Bc7, three.Block());
    EXPECT_EQ(rows.Texel(0, 1), (Rgba{247, 0, 0, 255})); // 11110 with its high bits below: 11110111
    EXPECT_EQ(rows.Texel(2, 2), (Rgba{0, 247, 0, 255}));
    EXPECT_EQ(rows.Texel(3, 3), (Rgba{0, 0, 247, 255}));
}

TEST(TextureBlocksBc7, AlphaMayChangePlacesAndHaveIndexesOfItsOwn) {
    BitWriter bits; // mode 5, rotation 1: alpha and red
    bits.Put(32, 6).Put(1, 2);
    for (const unsigned channel : {0u, 127u, 64u}) // the same at both ends
        bits.Put(channel, 7, 2);
    bits.Put(0, 8).Put(255, 8).Put(0, 31).Put(0, 1).Put(3, 2).Put(2, 2);
    const Image image = Block(TextureBlocks::Bc7, bits.Block());
    EXPECT_EQ(image.Texel(0, 0), (Rgba{0, 255, 129, 0})); // 64 of 127
    EXPECT_EQ(image.Texel(1, 0), (Rgba{255, 255, 129, 0}));
    EXPECT_EQ(image.Texel(2, 0)[0], (43 * 255 + 32) / 64);
    EXPECT_EQ(Block(TextureBlocks::Bc7, Bytes(16)).Texel(0, 0), (Rgba{0, 0, 0, 0})) << "the reserved mode";
}

TEST(TextureBlocksEtc, HalvesWithTwoBaseColors) {
    // 8 and 4 of 15 in red, modifiers 2 and 8, then 5 and 17; side by side; texel (0, 0) has index 1, (0, 1) 2.
    const Bytes individual = {0x84, 0, 0, 1 << 2, 0, 2, 0, 1};
    const Image image = Block(TextureBlocks::Etc2, individual);
    EXPECT_EQ(image.Texel(0, 0), (Rgba{136 + 8, 8, 8, 255}));
    EXPECT_EQ(image.Texel(0, 1), (Rgba{136 - 2, 0, 0, 255}));
    EXPECT_EQ(image.Texel(1, 3), (Rgba{136 + 2, 2, 2, 255}));
    EXPECT_EQ(image.Texel(2, 0), (Rgba{68 + 5, 5, 5, 255}));
    // 16 of 31 in red, and 2 less; one above the other.
    const Image above = Block(TextureBlocks::Etc2, {16 << 3 | 6, 0, 0, 3, 0, 0, 0, 0});
    EXPECT_EQ(above.Texel(3, 1), (Rgba{132 + 2, 2, 2, 255})); // 10000 with its high bits below: 10000100
    EXPECT_EQ(above.Texel(0, 2), (Rgba{115 + 2, 2, 2, 255})); // 01110011
}

TEST(TextureBlocksEtc, ModesOfEtc2) {
    // T: red beyond 31; colors 15, 0, 0 and 0, 8, 0, distance 6; indexes 0, 1, 2, 3 down the first column.
    const Image t = Block(TextureBlocks::Etc2, {0xFB, 0, 0x08, 0x03, 0, 0x0C, 0, 0x0A});
    EXPECT_EQ(t.Texel(0, 0), (Rgba{255, 0, 0, 255}));
    EXPECT_EQ(t.Texel(0, 1), (Rgba{6, 142, 6, 255}));
    EXPECT_EQ(t.Texel(0, 2), (Rgba{0, 136, 0, 255}));
    EXPECT_EQ(t.Texel(0, 3), (Rgba{0, 130, 0, 255}));
    // H: green below 0; colors 8, 15, 0 and 0, 0, 8, distance number 1 for their order.
    const Image h = Block(TextureBlocks::Etc2, {0x47, 0x14, 0, 0x42, 0, 0x0C, 0, 0x0A});
    EXPECT_EQ(h.Texel(0, 0), (Rgba{142, 255, 6, 255}));
    EXPECT_EQ(h.Texel(0, 1), (Rgba{130, 249, 0, 255}));
    EXPECT_EQ(h.Texel(0, 2), (Rgba{6, 6, 142, 255}));
    EXPECT_EQ(h.Texel(0, 3), (Rgba{0, 0, 130, 255}));
    // Planar: blue below 0; origin black, to the right white, below black.
    const Image planar = Block(TextureBlocks::Etc2, {0, 0, 0x07, 0x7F, 0xFF, 0xF8, 0, 0});
    for (int x = 0; x < 4; ++x) {
        const auto gray = std::uint8_t((x * 255 + 2) / 4);
        EXPECT_EQ(planar.Texel(x, 3)[0], gray) << x;
        EXPECT_EQ(planar.Texel(x, 0)[1], gray) << x;
    }
}

TEST(TextureBlocksEtc, AlphaOfBothKinds) {
    // Without the bit for opaque: index 2 is transparent, index 0 the base color.
    const Image punched = Block(TextureBlocks::Etc2PunchThrough, {16 << 3, 0, 0, 0, 0, 1, 0, 0});
    EXPECT_EQ(punched.Texel(0, 0), (Rgba{0, 0, 0, 0}));
    EXPECT_EQ(punched.Texel(0, 1), (Rgba{132, 0, 0, 255}));
    // Base 100, factor 2, table 13: -1 for index 0, -10 for 3, 9 for 7.
    const Image eac = Block(TextureBlocks::Etc2Alpha, {100, 0x2D, 0x0F, 0x80, 0, 0, 0, 0, 0x84, 0, 0, 0, 0, 0, 0, 0});
    EXPECT_EQ(eac.Texel(0, 0), (Rgba{138, 2, 2, 98}));
    EXPECT_EQ(eac.Texel(0, 1)[3], 100 - 2 * 10);
    EXPECT_EQ(eac.Texel(0, 2)[3], 100 + 2 * 9);
}

// ---- KTX ----

struct KtxHead {
    int width = 4, height = 4;
    unsigned type = 0, format = 0, internalFormat = 0;
    bool isBig = false;
    std::size_t keyBytes = 8;
};

Bytes Ktx(const KtxHead &head, const Bytes &body) {
    Bytes file = {0xAB, 'K', 'T', 'X', ' ', '1', '1', 0xBB, '\r', '\n', 0x1A, '\n'};
    const auto word = [&](std::size_t value) {
        for (int i = 0; i < 4; ++i)
            file.push_back(std::uint8_t(value >> 8 * (head.isBig ? 3 - i : i)));
    };
    for (const std::size_t value :
         {std::size_t(0x04030201), std::size_t(head.type), std::size_t(1), std::size_t(head.format),
          std::size_t(head.internalFormat), std::size_t(head.format), std::size_t(head.width), std::size_t(head.height),
          std::size_t(0), std::size_t(0), std::size_t(1), std::size_t(1), head.keyBytes})
        word(value);
    file.resize(file.size() + head.keyBytes);
    word(body.size());
    file.insert(file.end(), body.begin(), body.end());
    return file;
}

Bytes Ktx2(int width, int height, unsigned format, const Bytes &body, unsigned supercompression = 0) {
    Bytes file = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
    file.resize(104);
    const auto put = [&](std::size_t at, std::size_t value) {
        for (std::size_t i = 0; i < 4; ++i)
            file[at + i] = std::uint8_t(value >> (8 * i));
    };
    put(12, format), put(16, 1), put(20, std::size_t(width)), put(24, std::size_t(height));
    put(36, 1), put(40, 1), put(44, supercompression);
    put(80, file.size()), put(88, body.size()), put(96, body.size());
    file.insert(file.end(), body.begin(), body.end());
    return file;
}

constexpr unsigned kBytes = 0x1401, kRgba = 0x1908, kRgb = 0x1907;

TEST(Ktx, UncompressedFormats) {
    const auto one = [](unsigned type, unsigned format, const Bytes &body, bool isBig = false) {
        return DecodeKtx(FileBytes(Ktx({1, 1, type, format, format, isBig}, body)), "a.ktx").rgba;
    };
    EXPECT_THAT(one(kBytes, kRgba, {1, 2, 3, 4}), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(one(kBytes, 0x80E1, {1, 2, 3, 4}), ElementsAre(3, 2, 1, 4)) << "BGRA";
    EXPECT_THAT(one(kBytes, kRgb, {1, 2, 3, 0}), ElementsAre(1, 2, 3, 255));
    EXPECT_THAT(one(kBytes, 0x80E0, {1, 2, 3, 0}), ElementsAre(3, 2, 1, 255)) << "BGR";
    EXPECT_THAT(one(kBytes, 0x1909, {7, 0, 0, 0}), ElementsAre(7, 7, 7, 255)) << "L";
    EXPECT_THAT(one(kBytes, 0x190A, {7, 9, 0, 0}), ElementsAre(7, 7, 7, 9)) << "LA";
    EXPECT_THAT(one(kBytes, 0x1906, {9, 0, 0, 0}), ElementsAre(255, 255, 255, 9)) << "A";
    EXPECT_THAT(one(0x8033, kRgba, {0x4F, 0x08, 0, 0}), ElementsAre(0, 8 * 17, 4 * 17, 255)) << "4444";
    EXPECT_THAT(one(0x8033, kRgba, {0x08, 0x4F, 0, 0}, true), ElementsAre(0, 8 * 17, 4 * 17, 255)) << "big-endian";
    EXPECT_THAT(one(kBytes, kRgba, {1, 2, 3, 4}, true), ElementsAre(1, 2, 3, 4)) << "bytes have no order";
    EXPECT_THAT(one(0x8034, kRgba, {0x01, 0xF8, 0, 0}), ElementsAre(255, 0, 0, 255)) << "5551";
    EXPECT_THAT(one(0x8363, kRgb, {0x1F, 0x00, 0, 0}), ElementsAre(0, 0, 255, 255)) << "565";
    const Bytes rows = {1, 2, 3, 0, 4, 5, 6, 0}; // a texel and a byte to the next multiple of 4
    EXPECT_THAT(DecodeKtx(FileBytes(Ktx({1, 2, kBytes, kRgb, kRgb}, rows)), "a.ktx").rgba,
                ElementsAre(1, 2, 3, 255, 4, 5, 6, 255));
}

TEST(Ktx, BlocksOfBothVersions) {
    const Bytes redBlue = {0x00, 0xF8, 0x1F, 0x00, 0xE4, 0xE4, 0xE4, 0xE4};
    const Image one = DecodeKtx(FileBytes(Ktx({3, 2, 0, 0, 0x83F1}, redBlue)), "a.ktx");
    EXPECT_EQ(one.rgba.size(), 4u * 3 * 2);
    EXPECT_EQ(one.Texel(1, 1), (Rgba{0, 0, 255, 255}));
    EXPECT_EQ(DecodeKtx(FileBytes(Ktx2(3, 2, 133, redBlue)), "a.ktx").rgba, one.rgba);
    const Bytes etc1 = {0x84, 0, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(DecodeKtx(FileBytes(Ktx({4, 4, 0, 0, 0x8D64}, etc1)), "a.ktx").Texel(0, 0), (Rgba{138, 2, 2, 255}));
    EXPECT_EQ(DecodeKtx(FileBytes(Ktx2(4, 4, 147, etc1)), "a.ktx").Texel(3, 3), (Rgba{70, 2, 2, 255}));
    EXPECT_THAT(DecodeKtx(FileBytes(Ktx2(1, 2, 23, {1, 2, 3, 4, 5, 6})), "a.ktx").rgba,
                ElementsAre(1, 2, 3, 255, 4, 5, 6, 255));
    EXPECT_THAT(*KtxSize(FileBytes(Ktx({300, 7}, {}))), ElementsAre(300, 7));
    EXPECT_THAT(*KtxSize(FileBytes(Ktx({.width = 300, .height = 7, .isBig = true}, {}))), ElementsAre(300, 7));
    EXPECT_THAT(*KtxSize(FileBytes(Ktx2(300, 7, 0, {}))), ElementsAre(300, 7));
}

TEST(Ktx, EveryNumberOfVulkanIsItsFormat) {
    struct Masked {
        unsigned linear, srgb; ///< equal: there is no sRGB format
        Bytes body;
        Rgba texel;
    };
    for (const Masked &masked : {Masked{2, 2, {0x4F, 0x08}, {0, 8 * 17, 4 * 17, 255}},
                                 {4, 4, {0x1F, 0x00}, {0, 0, 255, 255}},
                                 {6, 6, {0x01, 0xF8}, {255, 0, 0, 255}},
                                 {9, 15, {7}, {7, 7, 7, 255}},
                                 {23, 29, {1, 2, 3}, {1, 2, 3, 255}},
                                 {30, 36, {1, 2, 3}, {3, 2, 1, 255}},
                                 {37, 43, {1, 2, 3, 4}, {1, 2, 3, 4}},
                                 {44, 50, {1, 2, 3, 4}, {3, 2, 1, 4}}})
        for (const unsigned number : {masked.linear, masked.srgb})
            EXPECT_EQ(DecodeKtx(FileBytes(Ktx2(1, 1, number, masked.body)), "a.ktx").Texel(0, 0), masked.texel)
                << number;
    const Bytes block = {0x00, 0xF8, 0x1F, 0x00, 0xE4, 0xE4, 0xE4, 0xE4};
    for (const auto &[vulkan, openGl] : {std::array{131u, 0x83F0u}, {132u, 0x8C4Cu}, {133u, 0x83F1u}, {134u, 0x8C4Du}})
        EXPECT_EQ(DecodeKtx(FileBytes(Ktx2(4, 4, vulkan, block)), "a.ktx").rgba,
                  DecodeKtx(FileBytes(Ktx({4, 4, 0, 0, openGl}, block)), "a.ktx").rgba)
            << vulkan;
}

TEST(Ktx, WhatIsNotSupportedIsNamed) {
    EXPECT_THAT(FaultOf(DecodeKtx, Ktx({4, 4, 0x1406, kRgba, 0x8814}, Bytes(256))), HasSubstr("type 1406"));
    EXPECT_THAT(FaultOf(DecodeKtx, Ktx2(4, 4, 109, Bytes(256))), HasSubstr("Vulkan's format 109"));
    EXPECT_THAT(FaultOf(DecodeKtx, Ktx2(4, 4, 37, Bytes(64), 1)), HasSubstr("supercompression 1"));
    EXPECT_THAT(FaultOf(DecodeKtx, Ktx({0, 4, kBytes, kRgba, kRgba}, {})), HasSubstr("0 x 4"));
    EXPECT_THAT(FaultOf(DecodeKtx, Bytes(100)), HasSubstr("mark of KTX"));
    Bytes order = Ktx({1, 1, kBytes, kRgba, kRgba}, Bytes(4));
    order[12] = 9;
    EXPECT_THAT(FaultOf(DecodeKtx, order), HasSubstr("byte order"));
    EXPECT_EQ(KtxSize(FileBytes(Ktx({0, 4}, {}))), std::nullopt);
    EXPECT_EQ(KtxSize(FileBytes(Bytes(100))), std::nullopt);
}

// ---- Crunch and WebP ----

/// A header of 74 bytes and `body`; the numbers are big-endian.
Bytes Crn(int width, int height, std::size_t bodyBytes) {
    Bytes file(74 + bodyBytes);
    const auto put = [&](std::size_t at, std::size_t bytes, std::size_t value) {
        for (std::size_t i = 0; i < bytes; ++i)
            file[at + i] = std::uint8_t(value >> (8 * (bytes - 1 - i)));
    };
    file[0] = 'H', file[1] = 'x';
    put(2, 2, 74), put(6, 4, file.size()), put(12, 2, std::size_t(width)), put(14, 2, std::size_t(height));
    file[16] = 1, file[17] = 1;
    return file;
}

TEST(Crn, SizeFromTheHeaderAndGrayForTheColors) {
    EXPECT_THAT(*CrnSize(FileBytes(Crn(512, 256, 10))), ElementsAre(512, 256));
    EXPECT_THAT(DecodeCrn(FileBytes(Crn(512, 256, 10)), "a.crn").rgba, ElementsAre(128, 128, 128, 255));
    EXPECT_EQ(CrnSize(FileBytes(Crn(0, 256, 10))), std::nullopt);
    EXPECT_THAT(FaultOf(DecodeCrn, Crn(0, 256, 10)), HasSubstr("0 x 256"));
    EXPECT_THAT(FaultOf(DecodeCrn, Bytes(100)), HasSubstr("begins with Hx"));
}

/// 3 x 2 texels, made by cwebp -lossless -exact.
const Bytes kLosslessWebp = {0x52, 0x49, 0x46, 0x46, 0x46, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56,
                             0x50, 0x38, 0x4c, 0x3a, 0x00, 0x00, 0x00, 0x2f, 0x02, 0x40, 0x00, 0x10, 0x2f,
                             0x40, 0x90, 0x6d, 0x53, 0x89, 0x79, 0xdd, 0x5f, 0xe6, 0x1a, 0x64, 0xd2, 0x36,
                             0xed, 0x5b, 0xff, 0x7a, 0x66, 0x6d, 0x62, 0x1a, 0x62, 0x3a, 0xb8, 0xf5, 0x6f,
                             0x89, 0x60, 0x92, 0x26, 0x7a, 0x3c, 0x76, 0xf9, 0x02, 0xdf, 0xe1, 0x0c, 0x59,
                             0xd5, 0xa6, 0x10, 0x90, 0x90, 0x29, 0x79, 0xe4, 0x8b, 0x88, 0xfe, 0x47, 0x2c};
/// 16 x 16 texels of 200, 120, 40, made by cwebp -q 90.
const Bytes kLossyWebp = {0x52, 0x49, 0x46, 0x46, 0x3e, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50,
                          0x38, 0x20, 0x32, 0x00, 0x00, 0x00, 0xf0, 0x01, 0x00, 0x9d, 0x01, 0x2a, 0x10, 0x00,
                          0x10, 0x00, 0x00, 0xc0, 0x12, 0x25, 0xa0, 0x02, 0x74, 0xba, 0x01, 0xf8, 0x00, 0x05,
                          0xf4, 0x00, 0x00, 0xfe, 0xc0, 0xcf, 0xff, 0xc7, 0x36, 0xf8, 0xad, 0xff, 0x15, 0xbf,
                          0xfe, 0x39, 0xb7, 0xfe, 0xfa, 0x01, 0xef, 0x40, 0x3d, 0xe8, 0x07, 0xf5, 0xf0, 0x00};

TEST(Webp, LosslessAndLossy) {
    const Image exact = DecodeWebp(FileBytes(kLosslessWebp), "a.webp");
    EXPECT_THAT(*WebpSize(FileBytes(kLosslessWebp)), ElementsAre(3, 2));
    EXPECT_THAT(exact.rgba, ElementsAre(255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 255, 10, 20, 30, 255, 200, 100, 50,
                                        1, 255, 255, 255, 255));
    const Image lossy = DecodeImage(FileBytes(kLossyWebp), "any name");
    ASSERT_EQ(lossy.rgba.size(), 4u * 16 * 16);
    for (const auto &[channel, value] : {std::pair(0, 200), {1, 120}, {2, 40}, {3, 255}})
        EXPECT_NEAR(lossy.Texel(7, 7)[std::size_t(channel)], value, 2) << channel;
    EXPECT_THAT(FaultOf(DecodeWebp, Bytes(100)), HasSubstr("WebP: the header"));
}

TEST(Webp, AnAnimationIsNamedAsSuch) {
    // The header VP8X of 16 x 16 texels with the flag of animations, and their parameters.
    const Bytes file = {'R', 'I', 'F', 'F', 36, 0,  0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8', 'X', 10, 0, 0, 0, 2, 0,
                        0,   0,   15,  0,   0,  15, 0, 0, 'A', 'N', 'I', 'M', 6,   0,   0,   0,   0,  0, 0, 0, 0, 0};
    EXPECT_THAT(FaultOf(DecodeWebp, file), HasSubstr("WebP with an animation, expected a single image"));
}

TEST(Webp, SmallFilesOfManyTexelsAreRefused) {
    Bytes file = kLosslessWebp;
    file[21] = 0xFF, file[22] = 0xCF, file[23] = 0xFF, file[24] |= 0x0F; // 4096 x 16384: 14 bits each, less 1
    EXPECT_THAT(FaultOf(DecodeWebp, file), HasSubstr("cannot hold 4096 x 16384"));
}

// ---- All of them: cut and changed ----

struct Sample {
    const char *name;
    Decoder decode;
    Bytes file;
};

std::vector<Sample> Samples() {
    const auto number = [](std::size_t count) {
        Bytes bytes(count);
        for (std::size_t i = 0; i < count; ++i)
            bytes[i] = std::uint8_t(37 * i + 11);
        return bytes;
    };
    return {{"ktx rgba", DecodeKtx, Ktx({3, 2, kBytes, kRgba, kRgba}, number(24))},
            {"ktx rgb", DecodeKtx, Ktx({3, 2, kBytes, kRgb, kRgb}, number(24))},
            {"ktx bc1", DecodeKtx, Ktx({5, 5, 0, 0, 0x83F0}, number(32))},
            {"ktx bc7", DecodeKtx, Ktx({4, 4, 0, 0, 0x8E8C}, number(16))},
            {"ktx etc2", DecodeKtx, Ktx({4, 8, 0, 0, 0x9274}, number(16))},
            {"ktx big-endian", DecodeKtx, Ktx({4, 4, 0, 0, 0x9278, true}, number(16))},
            {"ktx2 rgb", DecodeKtx, Ktx2(3, 2, 23, number(18))},
            {"ktx2 bc5", DecodeKtx, Ktx2(4, 4, 141, number(16))},
            {"crn", DecodeCrn, Crn(64, 64, 20)},
            {"webp lossless", DecodeWebp, kLosslessWebp},
            {"webp lossy", DecodeWebp, kLossyWebp}};
}

TEST(TextureFiles, TruncatedAtEveryLengthIsAnError) {
    for (const Sample &sample : Samples()) {
        EXPECT_EQ(FaultOf(sample.decode, sample.file), "") << sample.name;
        for (std::size_t size = 0; size < sample.file.size(); ++size) {
            // A copy of that size: a sanitizer sees what is read behind it.
            const Bytes cut(sample.file.begin(), sample.file.begin() + std::ptrdiff_t(size));
            // The last byte of a lossy image of one color may be padding.
            if (sample.decode == DecodeWebp && size + 3 > sample.file.size())
                continue;
            EXPECT_THAT(FaultOf(sample.decode, cut), HasSubstr("a.file: ")) << sample.name << ' ' << size;
        }
    }
}

TEST(TextureFiles, NoChangedByteDoesHarm) {
    for (const Sample &sample : Samples())
        for (std::size_t i = 0; i < sample.file.size(); ++i)
            for (const int mask : {1, 0x40, 0x80, 0xFF}) {
                Bytes bytes = sample.file;
                bytes[i] = std::uint8_t(bytes[i] ^ mask);
                try {
                    const Image image = sample.decode(FileBytes(bytes), "a.file");
                    EXPECT_EQ(image.rgba.size(), 4 * std::size_t(image.width) * std::size_t(image.height));
                } catch (const Error &) { // as good
                }
                KtxSize(FileBytes(bytes));
                CrnSize(FileBytes(bytes));
                WebpSize(FileBytes(bytes));
            }
}

} // namespace
} // namespace q3
