// GPL-2.0-or-later. Images of floats in memory, and the list of their formats.
#include "common/image/float_image.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"

#include <algorithm>
#include <array>

namespace q3 {

namespace {

constexpr std::array<FloatImageFormat, 3> kFloatFormats = {
    {{"hdr", DecodeHdr, EncodeHdr}, {"exr", DecodeExr, EncodeExr}, {"pfm", DecodePfm, EncodePfm}}};

const FloatImageFormat &FormatOf(const std::filesystem::path &path) {
    const std::string extension = path.extension().string();
    const auto *format = FindFloatImageFormat(extension.empty() ? extension : extension.substr(1));
    if (!format)
        throw Error("{}: unknown extension \"{}\" of a float image, expected {}", path.string(), extension,
                    FloatImageExtensions());
    return *format;
}

} // namespace

FloatImage FlippedRows(const FloatImage &image) {
    FloatImage flipped{image.width, image.height, {}};
    flipped.texels.reserve(image.texels.size());
    for (int row = image.height - 1; row >= 0; --row) {
        const auto first = image.texels.begin() + std::ptrdiff_t(row) * image.width;
        flipped.texels.insert(flipped.texels.end(), first, first + image.width);
    }
    return flipped;
}

std::span<const FloatImageFormat> FloatImageFormats() {
    return kFloatFormats;
}

const FloatImageFormat *FindFloatImageFormat(std::string_view extension) {
    const auto found = std::ranges::find_if(
        kFloatFormats, [&](const FloatImageFormat &format) { return EqualNoCase(format.extension, extension); });
    return found == kFloatFormats.end() ? nullptr : &*found;
}

std::string FloatImageExtensions() {
    std::string text;
    for (std::size_t i = 0; i < kFloatFormats.size(); ++i)
        text.append(i == 0 ? "" : i + 1 == kFloatFormats.size() ? " or " : ", ").append(kFloatFormats[i].extension);
    return text;
}

FloatImage ReadFloatImage(const std::filesystem::path &path) {
    const FloatImageFormat &format = FormatOf(path);
    return format.decode(ReadFile(path), path.string());
}

void WriteFloatImage(const std::filesystem::path &path, const FloatImage &image) {
    const FloatImageFormat &format = FormatOf(path);
    ReplaceFile(path, format.encode(image));
}

} // namespace q3
