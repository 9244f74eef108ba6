// GPL-2.0-or-later. Images of floats in memory, the formats that hold them, and the HDR light that engines load from
// files beside a map.
#include "common/image/float_image.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace q3 {

// ---- Images of floats in memory, and the list of their formats ----

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

// ---- HDR light as engines load it from files beside a map ----

static_assert(std::endian::native == std::endian::little && sizeof(Vec3f) == 12, "floats are copied as they lie");

namespace {

constexpr float kByteScale = 255;
constexpr std::size_t kIoquake3Newlines = 3; ///< bytes at the start of the file; the last float lacks as many
constexpr std::size_t kIoquake3Texels = std::size_t(kIoquake3PageSide) * kIoquake3PageSide;
constexpr std::size_t kIoquake3Bytes = kIoquake3Texels * sizeof(Vec3f);

std::vector<Vec3f> Scaled(std::span<const Vec3f> light, float factor) {
    std::vector<Vec3f> scaled;
    scaled.reserve(light.size());
    const auto channel = [factor](float value) { return value > 0 ? value * factor : 0.0f; };
    for (const Vec3f &color : light)
        scaled.emplace_back(channel(color.x), channel(color.y), channel(color.z));
    return scaled;
}

} // namespace

std::vector<std::byte> EncodeIoquake3Hdr(const FloatImage &page) {
    if (page.width != kIoquake3PageSide || page.height != kIoquake3PageSide)
        throw Error("ioquake3 loads HDR lightmaps of {} x {}, not of {} x {}", kIoquake3PageSide, kIoquake3PageSide,
                    page.width, page.height);
    const std::vector<Vec3f> texels = Scaled(page.texels, kByteScale);
    std::vector<std::byte> file(kIoquake3Bytes, std::byte('\n'));
    std::memcpy(file.data() + kIoquake3Newlines, texels.data(), kIoquake3Bytes - kIoquake3Newlines);
    return file;
}

FloatImage DecodeIoquake3Hdr(std::span<const std::byte> file, std::string_view name) {
    if (file.size() != kIoquake3Bytes)
        throw Error("{}: HDR lightmap of ioquake3 with {} bytes, expected {}", name, file.size(), kIoquake3Bytes);
    if (!std::ranges::all_of(file.first(kIoquake3Newlines), [](std::byte byte) { return byte == std::byte('\n'); }))
        throw Error("{}: HDR lightmap of ioquake3 that does not start with {} newlines", name, kIoquake3Newlines);
    FloatImage page{kIoquake3PageSide, kIoquake3PageSide, std::vector<Vec3f>(kIoquake3Texels)};
    std::memcpy(static_cast<void *>(page.texels.data()), file.data() + kIoquake3Newlines,
                kIoquake3Bytes - kIoquake3Newlines);
    page.texels.back().z = 0; // the file has one byte of it
    for (Vec3f &texel : page.texels)
        texel = texel / kByteScale;
    return page;
}

std::vector<std::byte> EncodeRend2Hdr(const FloatImage &page) {
    return EncodeHdr(FlippedRows(page));
}

FloatImage DecodeRend2Hdr(std::span<const std::byte> file, std::string_view name) {
    return FlippedRows(DecodeHdr(file, name));
}

std::vector<std::byte> EncodeVertexLight(std::span<const Vec3f> light, float fullLight) {
    const std::vector<Vec3f> scaled = Scaled(light, fullLight);
    const auto bytes = std::as_bytes(std::span(scaled));
    return {bytes.begin(), bytes.end()};
}

std::vector<Vec3f> DecodeVertexLight(std::span<const std::byte> file, std::size_t vertices, float fullLight,
                                     std::string_view name) {
    if (file.size() != vertices * sizeof(Vec3f))
        throw Error("{}: light of vertices with {} bytes, expected {} for {} vertices", name, file.size(),
                    vertices * sizeof(Vec3f), vertices);
    std::vector<Vec3f> light(vertices);
    if (!light.empty())
        std::memcpy(static_cast<void *>(light.data()), file.data(), file.size());
    for (Vec3f &color : light)
        color = color / fullLight;
    return light;
}

} // namespace q3
