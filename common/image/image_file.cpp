// GPL-2.0-or-later. Image files of any format.
#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "common/image/image_dds.h"
#include "common/text/text.h"

#include <algorithm>
#include <array>
#include <string>

namespace q3 {

namespace {

constexpr std::array<std::uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::array<std::uint8_t, 2> kJpegSignature = {0xFF, 0xD8};
constexpr std::array<std::uint8_t, 4> kDdsSignature = {'D', 'D', 'S', ' '};

bool BeginsWith(std::span<const std::byte> file, std::span<const std::uint8_t> begin) {
    return file.size() >= begin.size() && std::ranges::equal(file.first(begin.size()), std::as_bytes(begin));
}

DeepImage Deepened(const Image &image) {
    DeepImage deep{image.width, image.height, 8, {}};
    deep.rgba.reserve(image.rgba.size());
    for (const std::uint8_t value : image.rgba)
        deep.rgba.push_back(std::uint16_t(value * 257));
    return deep;
}

} // namespace

Image DecodeImage(std::span<const std::byte> file, std::string_view name) {
    if (BeginsWith(file, kPngSignature))
        return DecodePng(file, name);
    if (BeginsWith(file, kJpegSignature))
        return DecodeJpeg(file, name);
    if (BeginsWith(file, kDdsSignature))
        return DecodeDds(file, name);
    if (EndsWithNoCase(name, ".tga"))
        return DecodeTga(file, name);
    throw Error("{}: expected an image: TGA, PNG, JPEG or DDS", name);
}

DeepImage ReadDeepImage(const std::filesystem::path &path) {
    const std::vector<std::byte> file = ReadFile(path);
    const std::string name = path.string();
    if (BeginsWith(file, kPngSignature))
        return DecodeDeepPng(file, name);
    if (BeginsWith(file, kJpegSignature))
        return Deepened(DecodeJpeg(file, name));
    if (BeginsWith(file, kDdsSignature))
        return Deepened(DecodeDds(file, name));
    if (EqualNoCase(path.extension().string(), ".tga"))
        return Deepened(DecodeTga(file, name));
    throw Error("{}: expected an image: TGA, PNG, JPEG or DDS", name);
}

} // namespace q3
