// GPL-2.0-or-later. Images in memory, decoding of the formats that games ship, and reduction.
#include "common/image/image.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"

#include <squish.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <string>

namespace q3 {

// ---- Image files of any format ----

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
        deep.rgba.push_back(std::uint16_t(value * 257)); // 255 * 257 = 65535
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

// ---- DDS (DirectDraw surface): the first image of the file, in blocks BC1 to BC3 or uncompressed ----

namespace {

constexpr std::size_t kDdsHeader = 128, kDx10Header = 20; ///< bytes
/// Bytes of the header where its fields begin, 32 bits each. Of the pixel format: its own size, flags, the FourCC, bits
/// of a texel, and the masks of red, green, blue and alpha.
constexpr std::size_t kSizeAt = 4, kHeightAt = 12, kWidthAt = 16, kFormatSizeAt = 76, kFlagsAt = 80, kFourCcAt = 84,
                      kBitsAt = 88, kMasksAt = 92;
constexpr std::size_t kFormatBytes = 32;
constexpr unsigned kHasAlpha = 0x1, kHasFourCc = 0x4, kIsLuminance = 0x20000; ///< flags of the pixel format

constexpr unsigned FourCc(const char (&text)[5]) {
    return unsigned(text[0]) | unsigned(text[1]) << 8 | unsigned(text[2]) << 16 | unsigned(text[3]) << 24;
}

/// Layout of an uncompressed texel: its bits and the masks of red, green, blue and alpha; 0: no such channel.
struct DdsMasks {
    unsigned bits = 0;
    std::array<unsigned, 4> masks{};
};

/// The squish format of a DXGI_FORMAT of the extended header; nullopt: not BC1 to BC3.
std::optional<int> BlocksOfDxgi(unsigned format) {
    constexpr unsigned kBc1 = 70, kBc2 = 73, kBc3 = 76, kKinds = 3; // typeless, linear, sRGB
    if (format >= kBc1 && format < kBc1 + kKinds)
        return squish::kDxt1;
    if (format >= kBc2 && format < kBc2 + kKinds)
        return squish::kDxt3;
    if (format >= kBc3 && format < kBc3 + kKinds)
        return squish::kDxt5;
    return std::nullopt;
}

/// The layout of a DXGI_FORMAT of the extended header; nullopt: not one of 8-bit RGB(A).
std::optional<DdsMasks> MasksOfDxgi(unsigned format) {
    constexpr std::array<unsigned, 4> kRgba = {0xFF, 0xFF00, 0xFF0000, 0xFF000000};
    constexpr std::array<unsigned, 4> kBgra = {0xFF0000, 0xFF00, 0xFF, 0xFF000000};
    constexpr std::array<unsigned, 4> kBgrx = {0xFF0000, 0xFF00, 0xFF, 0};
    switch (format) {
    case 28: // R8G8B8A8_UNORM, and the same as sRGB
    case 29:
        return DdsMasks{32, kRgba};
    case 87: // B8G8R8A8_UNORM, and the same as sRGB
    case 91:
        return DdsMasks{32, kBgra};
    case 88: // B8G8R8X8_UNORM, and the same as sRGB
    case 93:
        return DdsMasks{32, kBgrx};
    default:
        return std::nullopt;
    }
}

class DdsDecoder {
  public:
    DdsDecoder(std::span<const std::byte> file, std::string_view name) : file_(file), name_(name) {}

    Image Decode() {
        Need(kDdsHeader, "header");
        if (Word(0) != FourCc("DDS "))
            throw Error("{}: expected an image that begins with DDS", name_);
        Expect("header size", Word(kSizeAt), kDdsHeader - kSizeAt);
        Expect("size of the pixel format", Word(kFormatSizeAt), kFormatBytes);
        CheckImageSize(Word(kWidthAt), Word(kHeightAt), name_);
        image_.height = int(Word(kHeightAt));
        image_.width = int(Word(kWidthAt));
        at_ = kDdsHeader;
        if ((Word(kFlagsAt) & kHasFourCc) != 0)
            ReadByFormatCode(Word(kFourCcAt));
        else
            ReadMasked(MasksOfHeader());
        return std::move(image_);
    }

  private:
    unsigned Byte(std::size_t at) const { return std::to_integer<unsigned>(file_[at]); }
    unsigned Word(std::size_t at) const {
        return Byte(at) | Byte(at + 1) << 8 | Byte(at + 2) << 16 | Byte(at + 3) << 24;
    }
    std::size_t Texels() const { return std::size_t(image_.width) * std::size_t(image_.height); }

    void Need(std::size_t bytes, std::string_view what) const {
        if (file_.size() - at_ < bytes)
            throw Error("{}: DDS ends at byte {}, within its {} of {} bytes", name_, file_.size(), what, bytes);
    }
    void Expect(std::string_view what, unsigned found, std::size_t expected) const {
        if (found != expected)
            throw Error("{}: DDS with a {} of {}, expected {}", name_, what, found, expected);
    }

    void ReadByFormatCode(unsigned fourCc) {
        if (fourCc == FourCc("DX10")) {
            Need(kDx10Header, "extended header");
            const unsigned format = Word(at_);
            at_ += kDx10Header;
            if (const auto blocks = BlocksOfDxgi(format))
                return ReadBlocks(*blocks);
            if (const auto masks = MasksOfDxgi(format))
                return ReadMasked(*masks);
            throw Error("{}: DDS with DXGI format {}, expected BC1 to BC3 or 8-bit RGB(A)", name_, format);
        }
        if (fourCc == FourCc("DXT1"))
            return ReadBlocks(squish::kDxt1);
        if (fourCc == FourCc("DXT3"))
            return ReadBlocks(squish::kDxt3);
        if (fourCc == FourCc("DXT5"))
            return ReadBlocks(squish::kDxt5);
        std::string shown;
        for (int shift = 0; shift < 32; shift += 8) {
            const char c = char(fourCc >> shift & 0xFF);
            shown += c >= ' ' && c <= '~' ? c : '?';
        }
        throw Error("{}: DDS with format {}, expected DXT1, DXT3, DXT5 or uncompressed RGB(A)", name_, shown);
    }

    /// Blocks of 4 x 4 texels; those at the right and lower edge may reach beyond the image.
    void ReadBlocks(int format) {
        constexpr std::size_t kSide = 4;
        const std::size_t width = std::size_t(image_.width), height = std::size_t(image_.height);
        const std::size_t across = (width + kSide - 1) / kSide, down = (height + kSide - 1) / kSide;
        const std::size_t bytes = format == squish::kDxt1 ? 8 : 16;
        Need(across * down * bytes, "blocks");
        image_.rgba.resize(4 * Texels());
        for (std::size_t block = 0; block < across * down; ++block, at_ += bytes) {
            std::array<std::uint8_t, 4 * kSide * kSide> texels{};
            squish::Decompress(texels.data(), file_.data() + at_, format);
            const std::size_t left = block % across * kSide, top = block / across * kSide;
            const std::size_t columns = std::min(kSide, width - left), rows = std::min(kSide, height - top);
            for (std::size_t row = 0; row < rows; ++row)
                std::copy_n(texels.begin() + std::ptrdiff_t(4 * kSide * row), 4 * columns,
                            image_.rgba.begin() + std::ptrdiff_t(4 * ((top + row) * width + left)));
        }
    }

    DdsMasks MasksOfHeader() const {
        DdsMasks layout{Word(kBitsAt), {Word(kMasksAt), Word(kMasksAt + 4), Word(kMasksAt + 8), Word(kMasksAt + 12)}};
        if ((Word(kFlagsAt) & kIsLuminance) != 0)
            layout.masks[1] = layout.masks[2] = layout.masks[0];
        if ((Word(kFlagsAt) & kHasAlpha) == 0)
            layout.masks[3] = 0;
        return layout;
    }

    void ReadMasked(const DdsMasks &layout) {
        const std::size_t bytes = layout.bits / 8;
        const unsigned all = layout.bits >= 32 ? ~0u : (1u << layout.bits) - 1;
        const bool isWhole = layout.bits % 8 == 0 && bytes >= 1 && bytes <= 4;
        const bool hasColor = layout.masks[0] != 0 && layout.masks[1] != 0 && layout.masks[2] != 0;
        const auto isGood = [all](unsigned mask) {
            const unsigned low = mask == 0 ? 0 : mask >> std::countr_zero(mask);
            return (mask & ~all) == 0 && (low & (low + 1)) == 0; // one run of bits
        };
        if (!isWhole || !hasColor || !std::ranges::all_of(layout.masks, isGood))
            throw Error(
                "{}: DDS with {} bits per texel and masks {:x}, {:x}, {:x}, {:x}, expected 8 to 32 bits and a run "
                "of them for each color",
                name_, layout.bits, layout.masks[0], layout.masks[1], layout.masks[2], layout.masks[3]);
        Need(Texels() * bytes, "texels");
        image_.rgba.reserve(4 * Texels());
        for (std::size_t i = 0; i < Texels(); ++i, at_ += bytes) {
            unsigned texel = 0;
            for (std::size_t k = 0; k < bytes; ++k)
                texel |= Byte(at_ + k) << (8 * k);
            for (const unsigned mask : layout.masks)
                image_.rgba.push_back(Channel(texel, mask));
        }
    }

    /// The bits of the mask, scaled to 0 to 255; 255 without a mask.
    static std::uint8_t Channel(unsigned texel, unsigned mask) {
        if (mask == 0)
            return 255;
        const int shift = std::countr_zero(mask);
        const std::uint64_t most = mask >> shift, value = (texel & mask) >> shift;
        return std::uint8_t((2 * 255 * value + most) / (2 * most));
    }

    std::span<const std::byte> file_;
    std::string_view name_;
    std::size_t at_ = 0;
    Image image_;
};

} // namespace

Image DecodeDds(std::span<const std::byte> file, std::string_view name) {
    return DdsDecoder(file, name).Decode();
}

} // namespace q3
