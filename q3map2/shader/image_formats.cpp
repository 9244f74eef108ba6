// GPL-2.0-or-later. The formats of the game's images, their sizes from their headers, and color spaces.
#include "q3map2/shader/image_formats.h"

#include "common/image/image.h"
#include "common/text/text.h"
#include "libs/math/elementary.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- The formats of the game's images ----

namespace {

constexpr int kMaxSide = 16384; ///< texels, as in CheckImageSize

int Byte(std::span<const std::byte> file, std::size_t at) {
    return std::to_integer<int>(file[at]);
}

int BigEndian16(std::span<const std::byte> file, std::size_t at) {
    return Byte(file, at) << 8 | Byte(file, at + 1);
}

int LittleEndian16(std::span<const std::byte> file, std::size_t at) {
    return Byte(file, at) | Byte(file, at + 1) << 8;
}

/// Nothing if a side is 0 or over kMaxSide.
std::optional<std::array<int, 2>> SizeInRange(int width, int height) {
    if (std::min(width, height) < 1 || std::max(width, height) > kMaxSide)
        return std::nullopt;
    return std::array<int, 2>{width, height};
}

/// The header has the type of the image at byte 2, its width at 12 and its height at 14.
std::optional<std::array<int, 2>> TgaSize(std::span<const std::byte> file) {
    constexpr std::size_t kHeader = 18;
    if (file.size() < kHeader)
        return std::nullopt;
    // Palette, color, gray; then the same run-length encoded.
    constexpr std::array<int, 6> kTypes = {1, 2, 3, 9, 10, 11};
    if (std::find(kTypes.begin(), kTypes.end(), Byte(file, 2)) == kTypes.end())
        return std::nullopt;
    return SizeInRange(LittleEndian16(file, 12), LittleEndian16(file, 14));
}

/// The chunk IHDR, which comes first, has the width at byte 16 of the file and the height at 20, 32 bits each.
std::optional<std::array<int, 2>> PngSize(std::span<const std::byte> file) {
    constexpr std::size_t kHeader = 24;
    constexpr std::array<int, 8> kMark = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    if (file.size() < kHeader)
        return std::nullopt;
    for (std::size_t i = 0; i < kMark.size(); ++i)
        if (Byte(file, i) != kMark[i])
            return std::nullopt;
    if (BigEndian16(file, 16) != 0 || BigEndian16(file, 20) != 0)
        return std::nullopt;
    return SizeInRange(BigEndian16(file, 18), BigEndian16(file, 22));
}

/// Segments follow each other: FF, a code, and a length of 16 bits, which counts itself. Start-of-frame segments, C0 to
/// CF but for C4, C8 and CC, have the height at byte 5 and the width at byte 7; 01 and D0 to D8 stand without a length.
std::optional<std::array<int, 2>> JpegSize(std::span<const std::byte> file) {
    if (file.size() < 4 || BigEndian16(file, 0) != 0xFFD8)
        return std::nullopt;
    std::size_t at = 2;
    while (at + 9 <= file.size() && Byte(file, at) == 0xFF) {
        const int code = Byte(file, at + 1);
        if (code == 0xFF) { // padding
            ++at;
            continue;
        }
        const bool isFrame = code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC;
        if (isFrame)
            return SizeInRange(BigEndian16(file, at + 7), BigEndian16(file, at + 5));
        const bool isBare = code == 0x01 || (code >= 0xD0 && code <= 0xD8);
        at += isBare ? 2 : 2 + std::size_t(std::max(2, BigEndian16(file, at + 2)));
    }
    return std::nullopt;
}

/// The header has the height at byte 12 and the width at 16, 32 bits each.
std::optional<std::array<int, 2>> DdsSize(std::span<const std::byte> file) {
    constexpr std::size_t kHeader = 128;
    constexpr std::string_view kMark = "DDS ";
    if (file.size() < kHeader || !AsText(file).starts_with(kMark))
        return std::nullopt;
    if (LittleEndian16(file, 14) != 0 || LittleEndian16(file, 18) != 0)
        return std::nullopt;
    return SizeInRange(LittleEndian16(file, 16), LittleEndian16(file, 12));
}

constexpr std::array<ImageFormat, 7> kFormats = {{{".tga", DecodeTga, TgaSize},
                                                  {".png", DecodePng, PngSize},
                                                  {".jpg", DecodeJpeg, JpegSize},
                                                  {".dds", DecodeDds, DdsSize},
                                                  {".ktx", DecodeKtx, KtxSize},
                                                  {".crn", DecodeCrn, CrnSize},
                                                  {".webp", DecodeWebp, WebpSize}}};

} // namespace

std::span<const ImageFormat> ImageFormats() {
    return kFormats;
}

const ImageFormat *FindImageFormat(std::string_view fileName) {
    const auto found = std::ranges::find_if(
        kFormats, [&](const ImageFormat &format) { return EndsWithNoCase(fileName, format.extension); });
    return found == kFormats.end() ? nullptr : &*found;
}

std::vector<std::string> ImageFileNames(std::string_view image, std::string_view patterns) {
    std::vector<std::string> names;
    for (std::string_view rest = patterns; !rest.empty();) {
        const std::size_t end = std::min(rest.find(' '), rest.size());
        std::string name(rest.substr(0, end));
        if (const std::size_t star = name.find('*'); star != std::string::npos)
            name.replace(star, 1, image);
        names.push_back(std::move(name));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return names;
}

// ---- Color spaces: sRGB as in IEC 61966-2-1 ----

float LinearFromSrgb(float c) {
    return c <= 0.04045f ? c / 12.92f : Pow((c + 0.055f) / 1.055f, 2.4f);
}

float SrgbFromLinear(float c) {
    return c <= 0.0031308f ? c * 12.92f : 1.055f * Pow(c, 1 / 2.4f) - 0.055f;
}

Vec3f NormalizeColor(const Vec3f &c) {
    const float largest = MaxComponent(c);
    const Vec3f normal = c / largest;
    return largest > 0 && IsFinite(normal) ? normal : Vec3f{1, 1, 1};
}

} // namespace q3
