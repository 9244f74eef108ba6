// GPL-2.0-or-later. Fuzz target images: all formats of images, of bytes and of floats. What is read is written again in
// formats that this program writes, and reads equal.
#include "common/image/float_image.h"
#include "common/image/image.h"
#include "tests/fuzz/fuzz_target.h"

#include <bit>

namespace q3::fuzz {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::string_view kImageName = "x.tga";

// ---- Images of bytes ----

void CheckImage(const Image &image) {
    Require(image.width > 0 && image.height > 0, "an image without texels");
    const std::size_t texels = std::size_t(image.width) * std::size_t(image.height);
    Require(image.rgba.size() == 4 * texels, "an image of another size");
    image.Texel(image.width - 1, image.height - 1);
    const Image small = Reduced(image, 8);
    Require(small.width <= 8 && small.height <= 8, "an image that was not reduced");
    if (texels > 4096)
        return;
    MustSucceed("a written image", [&] {
        Require(DecodePng(EncodePng(image.rgba, image.width, image.height, 4, kImageName), "x.png").rgba == image.rgba,
                "a PNG changes");
        for (const TgaRows rows : {TgaRows::TopFirst, TgaRows::BottomFirst})
            DecodeTga(EncodeTga(image.rgba, image.width, image.height, 4, rows), kImageName);
        DecodeJpeg(EncodeJpeg(image, 80, kImageName), "x.jpg");
    });
}

template <Image (*Decode)(Bytes, std::string_view)> void ReadImage(Bytes file) {
    Image image;
    if (Accepts([&] { image = Decode(file, kImageName); }))
        CheckImage(image);
}

void ReadPng(Bytes file) {
    ReadImage<DecodePng>(file);
    Accepts([&] {
        const DeepImage deep = DecodeDeepPng(file, kImageName);
        Require(deep.rgba.size() == 4 * std::size_t(deep.width) * std::size_t(deep.height), "a deep image");
    });
    Accepts([&] {
        if (const auto indexes = DecodePngIndexes(file, kImageName))
            Require(indexes->indexes.size() == std::size_t(indexes->width) * std::size_t(indexes->height), "indexes");
    });
}

void ReadPcx(Bytes file) {
    Accepts([&] {
        const IndexImage image = DecodePcx(file, kImageName);
        Require(image.indexes.size() == std::size_t(image.width) * std::size_t(image.height), "indexes");
    });
}

/// Sizes from headers alone are those of the decoded image.
template <Image (*Decode)(Bytes, std::string_view), std::optional<std::array<int, 2>> (*SizeOf)(Bytes)>
void ReadSizedImage(Bytes file) {
    ReadImage<Decode>(file);
    const auto size = SizeOf(file);
    Accepts([&] {
        const Image image = Decode(file, kImageName);
        Require(!size || Decode == DecodeCrn || *size == std::array{image.width, image.height}, "another size");
    });
}

// ---- Images of floats ----

/// Equal, or both NaN.
bool SameTexels(const FloatImage &a, const FloatImage &b) {
    const auto same = [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return a.width == b.width && a.height == b.height &&
           std::ranges::equal(a.texels, b.texels, [&](const Vec3f &p, const Vec3f &q) {
               return same(p.x, q.x) && same(p.y, q.y) && same(p.z, q.z);
           });
}

void CheckFloatImage(const FloatImage &image) {
    Require(image.texels.size() == std::size_t(image.width) * std::size_t(image.height) && !image.texels.empty(),
            "an image of another size");
    if (image.texels.size() > 4096)
        return;
    MustSucceed("a written image of floats", [&] {
        Require(SameTexels(DecodePfm(EncodePfm(image), "x.pfm"), image), "a PFM changes");
        const FloatImage once = DecodeHdr(EncodeHdr(image), "x.hdr");
        Require(SameTexels(DecodeHdr(EncodeHdr(once), "x.hdr"), once), "a Radiance image changes");
        DecodeRend2Hdr(EncodeRend2Hdr(image), "x.hdr");
    });
}

template <FloatImage (*Decode)(Bytes, std::string_view)> void ReadFloats(Bytes file) {
    FloatImage image;
    if (Accepts([&] { image = Decode(file, "x.hdr"); }))
        CheckFloatImage(image);
}

void ReadVertexLight(Bytes file) {
    for (const float fullLight : {kIoquake3VertexScale, kRend2VertexScale})
        Accepts([&] { DecodeVertexLight(file, file.size() / 12, fullLight, "vertlight.raw"); });
}

/// Whatever the first bytes say.
void ReadAny(Bytes file) {
    ReadImage<DecodeImage>(file);
}

} // namespace
} // namespace q3::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3;
    using namespace q3::fuzz;
    constexpr void (*kReaders[])(Bytes) = {ReadImage<DecodeTga>,
                                           ReadPng,
                                           ReadImage<DecodeJpeg>,
                                           ReadImage<DecodeDds>,
                                           ReadSizedImage<DecodeKtx, KtxSize>,
                                           ReadSizedImage<DecodeWebp, WebpSize>,
                                           ReadSizedImage<DecodeCrn, CrnSize>,
                                           ReadPcx,
                                           ReadFloats<DecodeHdr>,
                                           ReadFloats<DecodeExr>,
                                           ReadFloats<DecodePfm>,
                                           ReadFloats<DecodeIoquake3Hdr>,
                                           ReadFloats<DecodeRend2Hdr>,
                                           ReadVertexLight,
                                           ReadAny};
    Input input(data, size);
    kReaders[input.Choose(std::size(kReaders))](input.Rest());
    return 0;
}
