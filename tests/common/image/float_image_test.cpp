// GPL-2.0-or-later. Formats of float images, against readers written here from the descriptions of the formats.
#include "common/image/float_image.h"

#include "common/error.h"
#include "tests/common/image/float_image_readers.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

using FloatFile = std::vector<std::byte>;

FloatImage RandomImage(int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> exponent(-10, 8);
    FloatImage image{width, height, {}};
    for (int i = 0; i < width * height; ++i)
        image.texels.emplace_back(std::exp2(exponent(random)), std::exp2(exponent(random)),
                                  std::exp2(exponent(random)));
    return image;
}

/// Runs of all lengths, literals, and values that each format holds exactly.
FloatImage RunsImage(int width, int height) {
    FloatImage image{width, height, {}};
    for (int i = 0; i < width * height; ++i)
        image.texels.emplace_back(i % 300 < 200 ? 4.0f : float(i % 7), float(i / 130 % 2), i % 5 < 3 ? 1.0f : 0.5f);
    return image;
}

FloatFile FileOf(std::string_view text, std::initializer_list<int> binary = {}) {
    FloatFile file;
    for (const char c : text)
        file.push_back(std::byte(c));
    for (const int byte : binary)
        file.push_back(std::byte(byte));
    return file;
}

/// The one line of the Error that decoding throws; empty if it succeeds.
std::string Failure(FloatImage (*decode)(std::span<const std::byte>, std::string_view), const FloatFile &file) {
    try {
        decode(file, "a.file");
    } catch (const Error &error) {
        return error.what();
    }
    return {};
}

/// Every truncation of a good file, and files with changed bytes, give an image or one line of text.
void ExpectRobust(FloatImage (*decode)(std::span<const std::byte>, std::string_view), const FloatFile &good) {
    ASSERT_EQ(Failure(decode, good), "");
    for (std::size_t length = 0; length < good.size(); length += 1 + good.size() / 300) {
        const std::string failure = Failure(decode, FloatFile(good.begin(), good.begin() + std::ptrdiff_t(length)));
        EXPECT_THAT(failure, AllOf(StartsWith("a.file: "), Not(HasSubstr("\n")))) << length;
    }
    std::mt19937 random(7);
    for (int run = 0; run < 2000; ++run) {
        FloatFile bad = good;
        for (int i = 0; i < 1 + run % 4; ++i)
            bad[random() % (run % 2 == 0 ? bad.size() : std::min<std::size_t>(bad.size(), 400))] = std::byte(random());
        EXPECT_THAT(Failure(decode, bad), Not(HasSubstr("\n")));
    }
}

TEST(FloatImageTest, FormatsAreFoundByExtension) {
    EXPECT_EQ(FindFloatImageFormat("HDR")->decode, DecodeHdr);
    EXPECT_EQ(FindFloatImageFormat("pfm")->encode, EncodePfm);
    EXPECT_EQ(FindFloatImageFormat("exr")->encode, EncodeExr);
    EXPECT_EQ(FindFloatImageFormat("png"), nullptr);
    EXPECT_EQ(FloatImageExtensions(), "hdr, exr or pfm");
    EXPECT_THROW(ReadFloatImage("x.png"), Error);
    EXPECT_THROW(ReadFloatImage("x"), Error);
}

TEST(FloatImageTest, FourSurvivesEverywhere) {
    for (const FloatImageFormat &format : FloatImageFormats())
        for (const int width : {1, 3, 130}) {
            if (format.extension == "exr" && !HasOpenExr())
                continue;
            const FloatImage image = RunsImage(width, 9);
            const FloatImage back = format.decode(format.encode(image), "x");
            EXPECT_EQ(back.width, width);
            EXPECT_EQ(back.height, 9);
            EXPECT_EQ(back.texels[0].x, 4.0f) << format.extension;
            EXPECT_EQ(back.texels.size(), image.texels.size());
        }
}

TEST(FloatImageTest, RowsAreFlipped) {
    const FloatImage image = RandomImage(3, 4, 1), flipped = FlippedRows(image);
    for (int row = 0; row < 4; ++row)
        for (int x = 0; x < 3; ++x)
            EXPECT_EQ(flipped.Texel(x, row), image.Texel(x, 3 - row));
}

TEST(HdrTest, HeaderAndRunsByTheFormat) {
    FloatImage image{9, 1, std::vector<Vec3f>(9, Vec3f(1, 0.5f, 0))};
    image.texels[8] = {4, 4, 4};
    const FloatFile expected =
        FileOf("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 9\n",
               {2, 2, 0, 9, 128 + 9, 128, 128 + 8, 64, 1, 128, 128 + 8, 0, 1, 128, 128 + 8, 129, 1, 131});
    EXPECT_EQ(EncodeHdr(image), expected);
}

TEST(HdrTest, AnotherReaderFindsTheSameRows) {
    for (const auto &[width, height] : {std::pair(7, 3), {8, 2}, {127, 5}, {128, 128}, {700, 11}})
        for (const FloatImage &image : {RandomImage(width, height, 5), RunsImage(width, height)}) {
            const FloatImage read = ReadHdrPlainly(EncodeHdr(image));
            ASSERT_EQ(read.width, width);
            ASSERT_EQ(read.height, height);
            for (std::size_t i = 0; i < image.texels.size(); ++i) {
                const float largest = MaxComponent(read.texels[i]);
                for (std::size_t k = 0; k < 3; ++k)
                    ASSERT_LE(std::abs(read.texels[i][k] - image.texels[i][k]), largest / 256);
            }
            EXPECT_EQ(DecodeHdr(EncodeHdr(image), "x").texels, read.texels);
        }
}

TEST(HdrTest, FlatRowsAndOldRuns) {
    const std::string_view head = "#?RGBE\n# a comment\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 9\n";
    FloatFile flat = FileOf(head), old = FileOf(head, {128, 64, 32, 129, 1, 1, 1, 7, 0, 0, 0, 0});
    for (int i = 0; i < 9; ++i)
        for (const int byte : i < 8 ? std::array{128, 64, 32, 129} : std::array{0, 0, 0, 0})
            flat.push_back(std::byte(byte));
    const FloatImage image = DecodeHdr(flat, "flat");
    EXPECT_EQ(image.texels[0], Vec3f(1, 0.5f, 0.25f));
    EXPECT_EQ(image.texels[8], Vec3f(0, 0, 0));
    EXPECT_EQ(DecodeHdr(old, "old").texels, image.texels);
    // Two repeat codes in a row: 2 + 1 * 256.
    const FloatFile longRun = FileOf("#?RGBE\n\n-Y 1 +X 259\n", {128, 128, 128, 130, 1, 1, 1, 2, 1, 1, 1, 1});
    EXPECT_EQ(DecodeHdr(longRun, "x").texels, std::vector<Vec3f>(259, Vec3f(2, 2, 2)));
}

TEST(HdrTest, TheLeastColorOfFlatRowsIsNoRepeat) {
    // 2^-135 is mantissa 1 at the lowest exponent, and 1 1 1 means a repeat.
    const float least = std::ldexp(1.0f, -135);
    const FloatImage image{2, 1, {{least, least, least}, {least, 0, 0}}};
    EXPECT_EQ(DecodeHdr(EncodeHdr(image), "x").texels, (std::vector<Vec3f>{{0, 0, 0}, {least, 0, 0}}));
}

TEST(HdrTest, ExposureAndBottomFirst) {
    const FloatFile file =
        FileOf("#?RADIANCE\nEXPOSURE= 2\nEXPOSURE=4.0\n\n+Y 2 +X 1\n", {128, 0, 0, 132, 0, 128, 0, 129});
    const FloatImage image = DecodeHdr(file, "x");
    EXPECT_EQ(image.texels, (std::vector<Vec3f>{{0, 0.125f, 0}, {1, 0, 0}}));
}

TEST(HdrTest, Malformed) {
    const std::string good = "#?RADIANCE\n\n-Y 1 +X 8\n";
    EXPECT_THAT(Failure(DecodeHdr, FileOf("P6\n")), HasSubstr("does not start with #?"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 8\n")),
                HasSubstr("32-bit_rle_xyze, expected 32-bit_rle_rgbe"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf("#?RADIANCE\n\n+X 8 -Y 1\n")), HasSubstr("expected \"-Y height +X width\""));
    EXPECT_THAT(Failure(DecodeHdr, FileOf("#?RADIANCE\n\n-Y 0 +X 8\n")), HasSubstr("an image of 8 x 0"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf("#?RADIANCE\n\n-Y 99999999 +X 99999999\n")), HasSubstr("an image of"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 8\n")), HasSubstr("exposure"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf("#?RADIANCE\nEXPOSURE=1e-300\nEXPOSURE=1e-300\n\n-Y 1 +X 8\n")),
                HasSubstr("exposure"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf(good, {2, 2, 0, 8, 128 + 9, 0})), HasSubstr("a run of 9 texels"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf(good, {2, 2, 0, 8, 0})), HasSubstr("a run of 0 texels"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf(good, {2, 2, 0, 7, 128 + 7, 0})), HasSubstr("a row of 7 texels, expected 8"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf(good, {1, 1, 1, 4})), HasSubstr("a repeat before the first texel of a row"));
    EXPECT_THAT(Failure(DecodeHdr, FileOf(good, {2, 2, 0, 8, 4, 0})), HasSubstr("ends at byte"));
    ExpectRobust(DecodeHdr, EncodeHdr(RunsImage(130, 3)));
}

TEST(PfmTest, BytesOfTheFormat) {
    FloatImage image{1, 2, {{1, 2, 4}, {-1, 0, std::numeric_limits<float>::infinity()}}};
    const FloatFile little = FileOf("PF\n1 2\n-1.0\n", {0, 0, 0x80, 0xBF, 0, 0, 0, 0,    0, 0, 0x80, 0x7F, //
                                                        0, 0, 0x80, 0x3F, 0, 0, 0, 0x40, 0, 0, 0x80, 0x40});
    EXPECT_EQ(EncodePfm(image), little) << "the lower row comes first";
    EXPECT_EQ(DecodePfm(little, "x").texels, image.texels);
    const FloatFile big = FileOf("PF 1 2 1\n", {0xBF, 0x80, 0, 0, 0,    0, 0, 0, 0x7F, 0x80, 0, 0, //
                                                0x3F, 0x80, 0, 0, 0x40, 0, 0, 0, 0x40, 0x80, 0, 0});
    EXPECT_EQ(DecodePfm(big, "x").texels, image.texels);
    const FloatFile gray = FileOf("Pf\n1 1\n-2.5\n", {0, 0, 0x80, 0x40});
    EXPECT_EQ(DecodePfm(gray, "x").texels, (std::vector<Vec3f>{{4, 4, 4}}));
}

TEST(PfmTest, ALongScaleIsOneWord) {
    const FloatFile file = FileOf("Pf\n1 1\n-1." + std::string(40, '0') + "\n", {0, 0, 0x80, 0x40});
    EXPECT_EQ(DecodePfm(file, "x").texels, (std::vector<Vec3f>{{4, 4, 4}}));
}

TEST(PfmTest, RoundTripIsExact) {
    const FloatImage image = RandomImage(33, 17, 9);
    EXPECT_EQ(DecodePfm(EncodePfm(image), "x").texels, image.texels);
}

TEST(PfmTest, Malformed) {
    EXPECT_THAT(Failure(DecodePfm, FileOf("P6\n1 1\n255\n")), HasSubstr("starts with \"P6\", expected PF or Pf"));
    EXPECT_THAT(Failure(DecodePfm, FileOf("PF\n-1 1\n-1\n")), HasSubstr("width \"-1\", expected a whole number"));
    EXPECT_THAT(Failure(DecodePfm, FileOf("PF\n99999999 99999999\n-1\n")), HasSubstr("an image of"));
    EXPECT_THAT(Failure(DecodePfm, FileOf("PF\n1 1\n0\n")), HasSubstr("scale \"0\""));
    EXPECT_THAT(Failure(DecodePfm, FileOf("PF\n1 1\nnan\n")), HasSubstr("scale \"nan\""));
    EXPECT_THAT(Failure(DecodePfm, FileOf("PF\n16384 4096\n-1\n", {0, 0})),
                HasSubstr("with 2 bytes of texels, expected 805306368"));
    ExpectRobust(DecodePfm, EncodePfm(RunsImage(5, 3)));
}

/// Without OpenEXR there is one line that says so, and nothing else to test.
bool IsRefusedWithoutOpenExr() {
    if (HasOpenExr())
        return false;
    EXPECT_THAT(Failure(DecodeExr, FileOf("x")), HasSubstr("built without OpenEXR"));
    EXPECT_THROW(EncodeExr(RunsImage(1, 1)), Error);
    return true;
}

TEST(ExrTest, AnotherReaderFindsTheSameFloats) {
    if (IsRefusedWithoutOpenExr())
        return;
    for (const FloatImage &image : {RandomImage(5, 3, 11), RunsImage(128, 128), RandomImage(64, 33, 2)}) {
        const FloatImage read = ReadExrPlainly(EncodeExr(image));
        ASSERT_EQ(read.width, image.width);
        ASSERT_EQ(read.height, image.height);
        EXPECT_EQ(read.texels, image.texels);
        EXPECT_EQ(DecodeExr(EncodeExr(image), "x").texels, image.texels);
    }
}

TEST(ExrTest, ReadsFilesOfOthers) {
    if (IsRefusedWithoutOpenExr())
        return;
    // Uncompressed half floats with alpha, a data window away from the origin.
    const ExrFile file{.channels = {{"A", ExrHalf, 1}, {"B", ExrHalf, 1}, {"G", ExrHalf, 1}, {"R", ExrHalf, 1}},
                       .windowMin = {-3, 10}};
    const FloatImage image = DecodeExr(PlainExr(file), "x");
    EXPECT_EQ(image.width, 2);
    EXPECT_EQ(image.height, 2);
    // The sample of channel c (in the order of the file) at column x of row y is 2^(c - x - 2 y).
    EXPECT_EQ(image.Texel(0, 0), Vec3f(8, 4, 2));
    EXPECT_EQ(image.Texel(1, 0), Vec3f(4, 2, 1));
    EXPECT_EQ(image.Texel(1, 1), Vec3f(1, 0.5f, 0.25f));
    const ExrFile floats{.channels = {{"B", ExrFloat, 1}, {"G", ExrHalf, 1}, {"R", ExrFloat, 1}}};
    EXPECT_EQ(DecodeExr(PlainExr(floats), "x").Texel(0, 0), Vec3f(4, 2, 1));
}

TEST(ExrTest, AttributesLargerThanTheFileAreRefused) {
    if (IsRefusedWithoutOpenExr())
        return;
    // The library alone takes the memory first.
    std::vector<std::byte> file = EncodeExr(RunsImage(1, 1));
    constexpr std::string_view kAttribute("channels\0chlist\0", 16);
    const auto attribute = std::as_bytes(std::span(kAttribute));
    const auto found = std::search(file.begin(), file.end(), attribute.begin(), attribute.end());
    ASSERT_NE(found, file.end());
    const std::uint32_t size = 1u << 30;
    std::memcpy(&*found + kAttribute.size(), &size, sizeof size);
    EXPECT_THAT(Failure(DecodeExr, file), HasSubstr("EXR: an attribute of 1073741824 bytes, but "));
    // A box of 3 bytes: the library would read 16, and take what follows for attributes.
    const std::string_view box("box\0box2i\0\3\0\0\0abc", 17);
    file = EncodeExr(RunsImage(1, 1));
    const auto bytes = std::as_bytes(std::span(box));
    file.insert(file.begin() + 8, bytes.begin(), bytes.end());
    EXPECT_THAT(Failure(DecodeExr, file), HasSubstr("an attribute of 3 bytes, which do not fit its type box2i"));
}

TEST(ExrTest, AttributesThatDoNotFitTheirTypesAreRefused) {
    if (IsRefusedWithoutOpenExr())
        return;
    const auto with = [](std::string_view type, const std::vector<int> &value) {
        std::string attribute = "x" + std::string(1, '\0') + std::string(type) + std::string(1, '\0');
        attribute += char(value.size());
        attribute.append(3, '\0');
        for (const int byte : value)
            attribute += char(byte);
        std::vector<std::byte> file = EncodeExr(RunsImage(1, 1));
        const auto bytes = std::as_bytes(std::span(attribute));
        file.insert(file.begin() + 8, bytes.begin(), bytes.end());
        return Failure(DecodeExr, file);
    };
    // The bytes that are put in move the rows, so even a sound attribute leaves a file that cannot be read.
    for (const auto &[type, value] :
         {std::pair<std::string_view, std::vector<int>>{"preview", {1, 0, 0, 0, 1, 0, 0, 0, 10, 20, 30, 255}},
          {"floatvector", {0, 0, 0x80, 0x3F}},
          {"stringvector", {2, 0, 0, 0, 'a', 'b', 0, 0, 0, 0}}})
        EXPECT_THAT(with(type, value), Not(HasSubstr("attribute"))) << type;
    for (const auto &[type, value] : {std::pair<std::string_view, std::vector<int>>{"preview", {1, 0, 0, 0}},
                                      {"preview", {2, 0, 0, 0, 1, 0, 0, 0, 10, 20, 30, 255}},
                                      {"preview", {255, 255, 255, 255, 255, 255, 255, 255}},
                                      {"floatvector", {0, 0, 0x80}},
                                      {"stringvector", {2, 0}},
                                      {"stringvector", {3, 0, 0, 0, 'a', 'b'}},
                                      {"chlist", {'R', 0}}})
        EXPECT_THAT(with(type, value), HasSubstr(fmt::format("which do not fit its type {}", type)));
}

TEST(ExrTest, Malformed) {
    if (IsRefusedWithoutOpenExr())
        return;
    EXPECT_THAT(Failure(DecodeExr, FileOf("#?RADIANCE\n")), StartsWith("a.file: EXR: "));
    const ExrFile gray{.channels = {{"Y", ExrFloat, 1}}};
    EXPECT_THAT(Failure(DecodeExr, PlainExr(gray)), HasSubstr("EXR without a channel R, expected R, G and B"));
    const ExrFile two{.channels = {{"G", ExrFloat, 1}, {"R", ExrFloat, 1}}};
    EXPECT_THAT(Failure(DecodeExr, PlainExr(two)), HasSubstr("EXR without a channel B"));
    const ExrFile coarse{.channels = {{"B", ExrFloat, 2}, {"G", ExrFloat, 1}, {"R", ExrFloat, 1}}};
    EXPECT_THAT(Failure(DecodeExr, PlainExr(coarse)), HasSubstr("channel B has one sample per 2 x 2 texels"));
    for (const int side : {17000, 16384, 1 << 30}) {
        const ExrFile large{.channels = {{"B", ExrFloat, 1}, {"G", ExrFloat, 1}, {"R", ExrFloat, 1}},
                            .claimedSide = side};
        EXPECT_THAT(Failure(DecodeExr, PlainExr(large)), StartsWith("a.file: ")) << side;
    }
    ExpectRobust(DecodeExr, EncodeExr(RunsImage(40, 20)));
}

} // namespace
} // namespace q3
