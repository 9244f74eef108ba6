// GPL-2.0-or-later. WebP through libwebp.
#include "common/image/image.h"

#include <webp/decode.h>

namespace q3 {

namespace {

/// An image may have kFreeWebpTexels texels, and more if its file is as large as they need: a lossless image of one
/// color takes no bits for its texels, so its header alone could claim any amount of memory. Limits of this program.
constexpr std::uint64_t kFreeWebpTexels = std::uint64_t(1) << 22, kMaxWebpTexelsPerByte = 8192;

/// Nothing if the header is damaged or cut.
std::optional<WebPBitstreamFeatures> WebpFeatures(std::span<const std::byte> file) {
    WebPBitstreamFeatures features{};
    if (WebPGetFeatures(reinterpret_cast<const std::uint8_t *>(file.data()), file.size(), &features) != VP8_STATUS_OK)
        return std::nullopt;
    return features;
}

} // namespace

Image DecodeWebp(std::span<const std::byte> file, std::string_view name) {
    const auto features = WebpFeatures(file);
    if (!features)
        throw Error("{}: WebP: the header is damaged or cut, or this is another format", name);
    if (features->has_animation != 0)
        throw Error("{}: WebP with an animation, expected a single image", name);
    Image image{features->width, features->height, {}};
    CheckImageSize(std::uint64_t(image.width), std::uint64_t(image.height), name);
    const std::uint64_t texels = std::uint64_t(image.width) * std::uint64_t(image.height);
    if (texels > kFreeWebpTexels && texels > kMaxWebpTexelsPerByte * file.size())
        throw Error("{}: WebP: {} bytes cannot hold {} x {} texels", name, file.size(), image.width, image.height);
    image.rgba.resize(4 * texels);
    if (WebPDecodeRGBAInto(reinterpret_cast<const std::uint8_t *>(file.data()), file.size(), image.rgba.data(),
                           image.rgba.size(), 4 * image.width) == nullptr)
        throw Error("{}: WebP: the image is damaged or cut", name);
    return image;
}

std::optional<std::array<int, 2>> WebpSize(std::span<const std::byte> file) {
    const auto features = WebpFeatures(file);
    if (!features || features->width < 1 || features->height < 1)
        return std::nullopt;
    return std::array<int, 2>{features->width, features->height};
}

} // namespace q3
