// GPL-2.0-or-later. JPEG through TurboJPEG.
#include "common/image/image.h"

#include <turbojpeg.h>

#include <memory>

namespace q3 {

namespace {

/// A block of 8 x 8 texels takes at least one bit.
constexpr std::uint64_t kMaxJpegTexelsPerByte = 8 * 64;

struct Destroy {
    void operator()(void *decoder) const { tjDestroy(decoder); }
};

/// Whether a warning says that texels are missing. TurboJPEG tells warnings apart by libjpeg's text alone:
/// JWRN_JPEG_EOF where the file ends before its end marker, JWRN_HIT_MARKER where a marker ends the data of a scan too
/// early.
bool IsTruncation(std::string_view warning) {
    return warning.find("Premature end of JPEG file") != std::string_view::npos ||
           warning.find("premature end of data segment") != std::string_view::npos;
}

} // namespace

Image DecodeJpeg(std::span<const std::byte> file, std::string_view name) {
    const std::unique_ptr<void, Destroy> decoder(tjInitDecompress());
    if (!decoder)
        throw Error("{}: JPEG: out of memory", name);
    const auto *data = reinterpret_cast<const unsigned char *>(file.data());
    const auto size = static_cast<unsigned long>(file.size());
    Image image;
    int subsampling = 0, colorSpace = 0;
    if (tjDecompressHeader3(decoder.get(), data, size, &image.width, &image.height, &subsampling, &colorSpace) != 0)
        throw Error("{}: JPEG: {}", name, tjGetErrorStr2(decoder.get()));
    CheckImageSize(std::uint64_t(image.width), std::uint64_t(image.height), name);
    const std::uint64_t texels = std::uint64_t(image.width) * std::uint64_t(image.height);
    if (texels > kMaxJpegTexelsPerByte * file.size())
        throw Error("{}: JPEG: {} bytes cannot hold {} x {} texels", name, file.size(), image.width, image.height);

    image.rgba.resize(4 * texels);
    // The accurate DCT, so that the bytes do not depend on the vector unit of the machine; a limit of scans, of which a
    // small file could hold so many that decoding takes very long.
    const int flags = TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS;
    if (tjDecompress2(decoder.get(), data, size, image.rgba.data(), image.width, 0, image.height, TJPF_RGBA, flags) !=
        0) {
        const std::string_view message = tjGetErrorStr2(decoder.get());
        // Games show files with odd markers, so those are accepted.
        if (tjGetErrorCode(decoder.get()) != TJERR_WARNING || IsTruncation(message))
            throw Error("{}: JPEG: {}", name, message);
    }
    return image;
}

std::vector<std::byte> EncodeJpeg(const Image &image, int quality, std::string_view name) {
    CheckImageSize(std::uint64_t(image.width), std::uint64_t(image.height), name);
    const std::unique_ptr<void, Destroy> encoder(tjInitCompress());
    if (!encoder)
        throw Error("{}: JPEG: out of memory", name);
    constexpr int kSubsampling = TJSAMP_420;
    unsigned long size = tjBufSize(image.width, image.height, kSubsampling);
    std::vector<std::byte> file(size);
    auto *into = reinterpret_cast<unsigned char *>(file.data());
    // The accurate DCT for the reason given above.
    const int flags = TJFLAG_ACCURATEDCT | TJFLAG_NOREALLOC;
    if (tjCompress2(encoder.get(), image.rgba.data(), image.width, 0, image.height, TJPF_RGBX, &into, &size,
                    kSubsampling, quality, flags) != 0)
        throw Error("{}: JPEG: {}", name, tjGetErrorStr2(encoder.get()));
    file.resize(size);
    return file;
}

} // namespace q3
