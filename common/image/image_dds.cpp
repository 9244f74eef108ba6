// GPL-2.0-or-later. DDS (DirectDraw surface): the first image of the file, as in Microsoft's "Programming Guide for
// DDS".
#include "common/image/image.h"
#include "common/image/texture_data.h"

#include <string>
#include <utility>

namespace q3 {

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

std::optional<TextureBlocks> BlocksOfFourCc(unsigned code) {
    constexpr std::array<std::pair<unsigned, TextureBlocks>, 9> kCodes = {{{FourCc("DXT1"), TextureBlocks::Bc1},
                                                                           {FourCc("DXT2"), TextureBlocks::Bc2},
                                                                           {FourCc("DXT3"), TextureBlocks::Bc2},
                                                                           {FourCc("DXT4"), TextureBlocks::Bc3},
                                                                           {FourCc("DXT5"), TextureBlocks::Bc3},
                                                                           {FourCc("ATI1"), TextureBlocks::Bc4},
                                                                           {FourCc("BC4U"), TextureBlocks::Bc4},
                                                                           {FourCc("ATI2"), TextureBlocks::Bc5},
                                                                           {FourCc("BC5U"), TextureBlocks::Bc5}}};
    for (const auto &[known, blocks] : kCodes)
        if (known == code)
            return blocks;
    return std::nullopt;
}

/// By DXGI_FORMAT of the extended header.
std::optional<TextureBlocks> BlocksOfDxgi(unsigned format) {
    switch (format) {
    case 70: // typeless, linear, sRGB
    case 71:
    case 72:
        return TextureBlocks::Bc1;
    case 73:
    case 74:
    case 75:
        return TextureBlocks::Bc2;
    case 76:
    case 77:
    case 78:
        return TextureBlocks::Bc3;
    case 79: // typeless, unsigned
    case 80:
        return TextureBlocks::Bc4;
    case 82:
    case 83:
        return TextureBlocks::Bc5;
    case 97: // typeless, linear, sRGB
    case 98:
    case 99:
        return TextureBlocks::Bc7;
    default:
        return std::nullopt;
    }
}

/// The layout of a DXGI_FORMAT of the extended header; nullopt: not one of up to 8 bits per channel.
std::optional<TexelMasks> MasksOfDxgi(unsigned format) {
    constexpr std::array<unsigned, 4> kRgba = {0xFF, 0xFF00, 0xFF0000, 0xFF000000};
    constexpr std::array<unsigned, 4> kBgra = {0xFF0000, 0xFF00, 0xFF, 0xFF000000};
    constexpr std::array<unsigned, 4> kBgrx = {0xFF0000, 0xFF00, 0xFF, 0};
    switch (format) {
    case 28: // R8G8B8A8_UNORM, and the same as sRGB
    case 29:
        return TexelMasks{32, kRgba};
    case 61: // R8_UNORM, as gray
        return TexelMasks{8, {0xFF, 0xFF, 0xFF, 0}};
    case 85: // B5G6R5_UNORM
        return TexelMasks{16, {0xF800, 0x7E0, 0x1F, 0}};
    case 86: // B5G5R5A1_UNORM
        return TexelMasks{16, {0x7C00, 0x3E0, 0x1F, 0x8000}};
    case 87: // B8G8R8A8_UNORM, and the same as sRGB
    case 91:
        return TexelMasks{32, kBgra};
    case 88: // B8G8R8X8_UNORM, and the same as sRGB
    case 93:
        return TexelMasks{32, kBgrx};
    case 115: // B4G4R4A4_UNORM
        return TexelMasks{16, {0xF00, 0xF0, 0xF, 0xF000}};
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
            throw Error("{}: DDS with DXGI format {}, expected BC1 to BC5, BC7 or up to 8 bits per channel", name_,
                        format);
        }
        if (const auto blocks = BlocksOfFourCc(fourCc))
            return ReadBlocks(*blocks);
        std::string shown;
        for (int shift = 0; shift < 32; shift += 8) {
            const char c = char(fourCc >> shift & 0xFF);
            shown += c >= ' ' && c <= '~' ? c : '?';
        }
        throw Error("{}: DDS with format {}, expected DXT1 to DXT5, ATI1, ATI2, DX10 or uncompressed RGB(A)", name_,
                    shown);
    }

    void ReadBlocks(TextureBlocks format) {
        Need(BytesOfBlocks(format, image_.width, image_.height), "blocks");
        image_.rgba = DecodeBlocks(format, file_.subspan(at_), image_.width, image_.height);
    }

    TexelMasks MasksOfHeader() const {
        TexelMasks layout{Word(kBitsAt), {Word(kMasksAt), Word(kMasksAt + 4), Word(kMasksAt + 8), Word(kMasksAt + 12)}};
        if ((Word(kFlagsAt) & kIsLuminance) != 0)
            layout.masks[1] = layout.masks[2] = layout.masks[0];
        if ((Word(kFlagsAt) & kHasAlpha) == 0)
            layout.masks[3] = 0;
        return layout;
    }

    void ReadMasked(const TexelMasks &layout) {
        const bool hasColor = layout.masks[0] != 0 && layout.masks[1] != 0 && layout.masks[2] != 0;
        if (!hasColor || !IsReadable(layout))
            throw Error(
                "{}: DDS with {} bits per texel and masks {:x}, {:x}, {:x}, {:x}, expected 8 to 32 bits and a run "
                "of them for each color",
                name_, layout.bits, layout.masks[0], layout.masks[1], layout.masks[2], layout.masks[3]);
        const std::size_t rowBytes = std::size_t(image_.width) * (layout.bits / 8);
        Need(std::size_t(image_.height) * rowBytes, "texels");
        image_.rgba =
            DecodeMasked(layout, file_.subspan(at_), image_.width, image_.height, rowBytes, TexelByteOrder::Little);
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
