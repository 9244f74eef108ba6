// GPL-2.0-or-later. Images in memory, decoding of the formats that games ship, and reduction.
#include "common/image/image.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

namespace q3 {

// ---- Image files of any format ----

namespace {

constexpr std::array<std::uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::array<std::uint8_t, 2> kJpegSignature = {0xFF, 0xD8};
constexpr std::array<std::uint8_t, 4> kDdsSignature = {'D', 'D', 'S', ' '};
constexpr std::array<std::uint8_t, 4> kKtxSignature = {0xAB, 'K', 'T', 'X'};
constexpr std::array<std::uint8_t, 4> kRiffSignature = {'R', 'I', 'F', 'F'};

bool BeginsWith(std::span<const std::byte> file, std::span<const std::uint8_t> begin) {
    return file.size() >= begin.size() && std::ranges::equal(file.first(begin.size()), std::as_bytes(begin));
}

/// The decoder of a format that its first bytes tell; null: none. A decoder that finds another format reports it.
Image (*DecoderOf(std::span<const std::byte> file))(std::span<const std::byte>, std::string_view) {
    return BeginsWith(file, kPngSignature)    ? DecodePng
           : BeginsWith(file, kJpegSignature) ? DecodeJpeg
           : BeginsWith(file, kDdsSignature)  ? DecodeDds
           : BeginsWith(file, kKtxSignature)  ? DecodeKtx
           : BeginsWith(file, kRiffSignature) ? DecodeWebp
                                              : nullptr;
}

DeepImage Deepened(const Image &image) {
    DeepImage deep{image.width, image.height, 8, {}};
    deep.rgba.reserve(image.rgba.size());
    for (const std::uint8_t value : image.rgba)
        deep.rgba.push_back(std::uint16_t(value * 257)); // 255 * 257 = 65535
    return deep;
}

} // namespace

Image DecodeImage(std::span<const std::byte> file, std::string_view name) {
    if (const auto decode = DecoderOf(file))
        return decode(file, name);
    if (EndsWithNoCase(name, ".tga"))
        return DecodeTga(file, name);
    throw Error("{}: expected an image: TGA, PNG, JPEG, WebP, DDS or KTX", name);
}

DeepImage ReadDeepImage(const std::filesystem::path &path) {
    const std::vector<std::byte> file = ReadFile(path);
    const std::string name = path.string();
    return BeginsWith(file, kPngSignature) ? DecodeDeepPng(file, name) : Deepened(DecodeImage(file, name));
}

// ---- Images of fewer texels ----

namespace {

/// What a texel of the small image covers along one axis, in texels of the large one.
struct Interval {
    double low = 0, high = 0;

    int First() const { return int(low); }
    /// One past the last, where the large image has `size`.
    int End(int size) const { return std::min(size, int(std::ceil(high))); }
    double Overlap(int texel) const { return std::min(high, double(texel + 1)) - std::max(low, double(texel)); }
};

std::array<std::uint8_t, 4> Mean(const Image &image, const Interval &columns, const Interval &rows) {
    std::array<double, 4> sums{};
    double weights = 0;
    for (int row = rows.First(); row < rows.End(image.height); ++row)
        for (int column = columns.First(); column < columns.End(image.width); ++column) {
            const double weight = rows.Overlap(row) * columns.Overlap(column);
            const auto texel = image.Texel(column, row);
            for (std::size_t channel = 0; channel < 4; ++channel)
                sums[channel] += weight * texel[channel];
            weights += weight;
        }
    std::array<std::uint8_t, 4> mean{};
    for (std::size_t channel = 0; channel < 4; ++channel)
        mean[channel] = std::uint8_t(std::lround(sums[channel] / weights));
    return mean;
}

} // namespace

Image Reduced(const Image &image, int longestSide) {
    const double scale = double(std::max(image.width, image.height)) / longestSide;
    if (scale <= 1)
        return image;
    const auto side = [&](int size) { return std::max(1, int(std::lround(size / scale))); };
    Image small{side(image.width), side(image.height), {}};
    small.rgba.reserve(4 * std::size_t(small.width) * std::size_t(small.height));
    const double perColumn = double(image.width) / small.width, perRow = double(image.height) / small.height;
    for (int row = 0; row < small.height; ++row)
        for (int column = 0; column < small.width; ++column) {
            const auto mean =
                Mean(image, {column * perColumn, (column + 1) * perColumn}, {row * perRow, (row + 1) * perRow});
            small.rgba.insert(small.rgba.end(), mean.begin(), mean.end());
        }
    return small;
}

} // namespace q3
