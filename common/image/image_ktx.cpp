// GPL-2.0-or-later. KTX as in Khronos' "KTX File Format Specification" 1 and 2, and the header of Crunch files.
#include "common/image/image.h"
#include "common/image/texture_data.h"

#include <algorithm>
#include <utility>

namespace q3 {

// ---- KTX ----

namespace {

constexpr std::array<std::uint8_t, 12> kKtx1Mark = {0xAB, 'K', 'T', 'X', ' ', '1', '1', 0xBB, '\r', '\n', 0x1A, '\n'};
constexpr std::array<std::uint8_t, 12> kKtx2Mark = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
/// Bytes of the headers. That of version 2 ends where the index of mipmaps begins, with 24 bytes for each.
constexpr std::size_t kKtx1Header = 64, kKtx2Header = 80, kKtx2LevelBytes = 24;

/// How the texels of a file are stored: as blocks or by masks.
struct KtxLayout {
    std::optional<TextureBlocks> blocks;
    TexelMasks masks{};
    bool isPacked = false; ///< masks of 16-bit words, in the byte order of the file
};

constexpr std::array<unsigned, 4> kRgbaMasks = {0xFF, 0xFF00, 0xFF0000, 0xFF000000};
constexpr std::array<unsigned, 4> kBgraMasks = {0xFF0000, 0xFF00, 0xFF, 0xFF000000};
constexpr std::array<unsigned, 4> kRgbMasks = {0xFF, 0xFF00, 0xFF0000, 0};
constexpr std::array<unsigned, 4> kBgrMasks = {0xFF0000, 0xFF00, 0xFF, 0};
constexpr std::array<unsigned, 4> kGrayMasks = {0xFF, 0xFF, 0xFF, 0};
constexpr std::array<unsigned, 4> kGrayAlphaMasks = {0xFF, 0xFF, 0xFF, 0xFF00};
constexpr std::array<unsigned, 4> k4444Masks = {0xF000, 0xF00, 0xF0, 0xF};
constexpr std::array<unsigned, 4> k5551Masks = {0xF800, 0x7C0, 0x3E, 0x1};
constexpr std::array<unsigned, 4> k565Masks = {0xF800, 0x7E0, 0x1F, 0};

struct BlockCode {
    unsigned code;
    TextureBlocks blocks;
};

std::optional<TextureBlocks> FindBlocks(std::span<const BlockCode> codes, unsigned code) {
    const auto found = std::ranges::find(codes, code, &BlockCode::code);
    return found == codes.end() ? std::nullopt : std::optional(found->blocks);
}

/// Values of OpenGL for glInternalFormat: linear and sRGB, of RGTC also LATC.
constexpr std::array<BlockCode, 21> kGlBlocks = {{{0x83F0, TextureBlocks::Bc1Opaque},
                                                  {0x8C4C, TextureBlocks::Bc1Opaque},
                                                  {0x83F1, TextureBlocks::Bc1},
                                                  {0x8C4D, TextureBlocks::Bc1},
                                                  {0x83F2, TextureBlocks::Bc2},
                                                  {0x8C4E, TextureBlocks::Bc2},
                                                  {0x83F3, TextureBlocks::Bc3},
                                                  {0x8C4F, TextureBlocks::Bc3},
                                                  {0x8DBB, TextureBlocks::Bc4},
                                                  {0x8C70, TextureBlocks::Bc4},
                                                  {0x8DBD, TextureBlocks::Bc5},
                                                  {0x8C72, TextureBlocks::Bc5},
                                                  {0x8E8C, TextureBlocks::Bc7},
                                                  {0x8E8D, TextureBlocks::Bc7},
                                                  {0x8D64, TextureBlocks::Etc2}, // ETC1
                                                  {0x9274, TextureBlocks::Etc2},
                                                  {0x9275, TextureBlocks::Etc2},
                                                  {0x9276, TextureBlocks::Etc2PunchThrough},
                                                  {0x9277, TextureBlocks::Etc2PunchThrough},
                                                  {0x9278, TextureBlocks::Etc2Alpha},
                                                  {0x9279, TextureBlocks::Etc2Alpha}}};

/// Values of Vulkan for vkFormat: linear and sRGB.
constexpr std::array<BlockCode, 18> kVkBlocks = {{{131, TextureBlocks::Bc1Opaque},
                                                  {132, TextureBlocks::Bc1Opaque},
                                                  {133, TextureBlocks::Bc1},
                                                  {134, TextureBlocks::Bc1},
                                                  {135, TextureBlocks::Bc2},
                                                  {136, TextureBlocks::Bc2},
                                                  {137, TextureBlocks::Bc3},
                                                  {138, TextureBlocks::Bc3},
                                                  {139, TextureBlocks::Bc4},
                                                  {141, TextureBlocks::Bc5},
                                                  {145, TextureBlocks::Bc7},
                                                  {146, TextureBlocks::Bc7},
                                                  {147, TextureBlocks::Etc2},
                                                  {148, TextureBlocks::Etc2},
                                                  {149, TextureBlocks::Etc2PunchThrough},
                                                  {150, TextureBlocks::Etc2PunchThrough},
                                                  {151, TextureBlocks::Etc2Alpha},
                                                  {152, TextureBlocks::Etc2Alpha}}};

/// By glType and glFormat.
std::optional<TexelMasks> MasksOfGl(unsigned type, unsigned format) {
    constexpr unsigned kBytes = 0x1401, k4444 = 0x8033, k5551 = 0x8034, k565 = 0x8363;
    constexpr unsigned kRed = 0x1903, kAlpha = 0x1906, kRgb = 0x1907, kRgba = 0x1908, kLuminance = 0x1909,
                       kLuminanceAlpha = 0x190A, kBgr = 0x80E0, kBgra = 0x80E1;
    if (type == k4444 && format == kRgba)
        return TexelMasks{16, k4444Masks};
    if (type == k5551 && format == kRgba)
        return TexelMasks{16, k5551Masks};
    if (type == k565 && format == kRgb)
        return TexelMasks{16, k565Masks};
    if (type != kBytes)
        return std::nullopt;
    switch (format) {
    case kRed:
    case kLuminance:
        return TexelMasks{8, kGrayMasks};
    case kAlpha:
        return TexelMasks{8, {0, 0, 0, 0xFF}};
    case kLuminanceAlpha:
        return TexelMasks{16, kGrayAlphaMasks};
    case kRgb:
        return TexelMasks{24, kRgbMasks};
    case kBgr:
        return TexelMasks{24, kBgrMasks};
    case kRgba:
        return TexelMasks{32, kRgbaMasks};
    case kBgra:
        return TexelMasks{32, kBgraMasks};
    default:
        return std::nullopt;
    }
}

/// By vkFormat.
std::optional<TexelMasks> MasksOfVk(unsigned format) {
    switch (format) {
    case 2: // R4G4B4A4_UNORM_PACK16
        return TexelMasks{16, k4444Masks};
    case 4: // R5G6B5_UNORM_PACK16
        return TexelMasks{16, k565Masks};
    case 6: // R5G5B5A1_UNORM_PACK16
        return TexelMasks{16, k5551Masks};
    case 9: // R8, UNORM and SRGB, as gray
    case 15:
        return TexelMasks{8, kGrayMasks};
    case 23: // R8G8B8
    case 29:
        return TexelMasks{24, kRgbMasks};
    case 30: // B8G8R8
    case 36:
        return TexelMasks{24, kBgrMasks};
    case 37: // R8G8B8A8
    case 43:
        return TexelMasks{32, kRgbaMasks};
    case 44: // B8G8R8A8
    case 50:
        return TexelMasks{32, kBgraMasks};
    default:
        return std::nullopt;
    }
}

bool HasMark(std::span<const std::byte> file, const std::array<std::uint8_t, 12> &mark) {
    return file.size() >= mark.size() && std::ranges::equal(file.first(mark.size()), std::as_bytes(std::span(mark)));
}

class KtxDecoder {
  public:
    KtxDecoder(std::span<const std::byte> file, std::string_view name) : file_(file), name_(name) {}

    Image Decode() {
        if (HasMark(file_, kKtx1Mark))
            return DecodeVersion1();
        if (HasMark(file_, kKtx2Mark))
            return DecodeVersion2();
        Need(0, kKtx1Mark.size(), "mark");
        throw Error("{}: expected an image that begins with the mark of KTX 1 or 2", name_);
    }

    /// Of a file that begins with a mark.
    std::array<unsigned, 2> Size() {
        if (HasMark(file_, kKtx2Mark)) {
            Need(0, kKtx2Header, "header");
            return {Word(20), Word(24)};
        }
        Need(0, kKtx1Header, "header");
        ReadByteOrder();
        return {Word(36), Word(40)};
    }

  private:
    unsigned Byte(std::uint64_t at) const { return std::to_integer<unsigned>(file_[at]); }
    unsigned Word(std::uint64_t at) const {
        return order_ == TexelByteOrder::Little
                   ? Byte(at) | Byte(at + 1) << 8 | Byte(at + 2) << 16 | Byte(at + 3) << 24
                   : Byte(at + 3) | Byte(at + 2) << 8 | Byte(at + 1) << 16 | Byte(at) << 24;
    }
    std::uint64_t LongWord(std::uint64_t at) const { return Word(at) | std::uint64_t(Word(at + 4)) << 32; }

    void Need(std::uint64_t at, std::uint64_t bytes, std::string_view what) const {
        if (at > file_.size() || file_.size() - at < bytes)
            throw Error("{}: KTX ends at byte {}, within its {} of {} bytes", name_, file_.size(), what, bytes);
    }

    /// The word at byte 12 is 0x04030201 in the order of the file.
    void ReadByteOrder() {
        constexpr unsigned kSame = 0x04030201, kSwapped = 0x01020304;
        const unsigned found = Word(12);
        if (found != kSame && found != kSwapped)
            throw Error("{}: KTX with {:08x} for its byte order, expected {:08x}", name_, found, kSame);
        order_ = found == kSame ? TexelByteOrder::Little : TexelByteOrder::Big;
    }

    /// Words from byte 16: glType, glTypeSize, glFormat, glInternalFormat, glBaseInternalFormat, width, height, depth,
    /// array elements, faces, mipmaps, bytes of keys; then these, the size of the first mipmap, and its images. Rows of
    /// uncompressed texels begin at multiples of 4 bytes.
    Image DecodeVersion1() {
        const auto size = Size();
        const unsigned type = Word(16), format = Word(24), internalFormat = Word(28), keyBytes = Word(60);
        KtxLayout layout{FindBlocks(kGlBlocks, internalFormat)};
        constexpr unsigned kUnsignedBytes = 0x1401; // GL_UNSIGNED_BYTE
        layout.isPacked = type != kUnsignedBytes;
        if (const auto masks = MasksOfGl(type, format); masks && !layout.blocks)
            layout.masks = *masks;
        else if (!layout.blocks)
            throw Error("{}: KTX with type {:x}, format {:x} and internal format {:x}, expected BC1 to BC5, BC7, ETC1, "
                        "ETC2, or up to 8 bits per channel",
                        name_, type, format, internalFormat);
        constexpr std::uint64_t kSizeWord = 4, kRowAlignment = 4;
        const std::uint64_t at = kKtx1Header + std::uint64_t(keyBytes);
        Need(at, kSizeWord, "size of the first mipmap");
        return Texels(size, layout, at + kSizeWord, kRowAlignment);
    }

    /// Words from byte 12: vkFormat, size of a type, width, height, depth, layers, faces, mipmaps, supercompression;
    /// the index of mipmaps has the offset of each, the largest first.
    Image DecodeVersion2() {
        const auto size = Size();
        const unsigned format = Word(12), supercompression = Word(44);
        if (supercompression != 0)
            throw Error("{}: KTX 2 with supercompression {}, expected none", name_, supercompression);
        KtxLayout layout{FindBlocks(kVkBlocks, format)};
        if (const auto masks = MasksOfVk(format); masks && !layout.blocks)
            layout.masks = *masks;
        else if (!layout.blocks)
            throw Error(
                "{}: KTX 2 with Vulkan's format {}, expected BC1 to BC5, BC7, ETC2, or up to 8 bits per channel", name_,
                format);
        Need(kKtx2Header, kKtx2LevelBytes, "index of mipmaps");
        return Texels(size, layout, LongWord(kKtx2Header), 1);
    }

    Image Texels(const std::array<unsigned, 2> &size, const KtxLayout &layout, std::uint64_t at,
                 std::size_t rowAlignment) const {
        CheckImageSize(size[0], size[1], name_);
        Image image{int(size[0]), int(size[1]), {}};
        if (layout.blocks) {
            Need(at, BytesOfBlocks(*layout.blocks, image.width, image.height), "blocks");
            image.rgba = DecodeBlocks(*layout.blocks, file_.subspan(at), image.width, image.height);
            return image;
        }
        const std::size_t used = std::size_t(image.width) * (layout.masks.bits / 8);
        const std::size_t rowBytes = (used + rowAlignment - 1) / rowAlignment * rowAlignment;
        Need(at, rowBytes * std::size_t(image.height), "texels");
        image.rgba = DecodeMasked(layout.masks, file_.subspan(at), image.width, image.height, rowBytes,
                                  layout.isPacked ? order_ : TexelByteOrder::Little);
        return image;
    }

    std::span<const std::byte> file_;
    std::string_view name_;
    TexelByteOrder order_ = TexelByteOrder::Little;
};

/// The size if an image may have it.
std::optional<std::array<int, 2>> SizeIfValid(std::uint64_t width, std::uint64_t height) {
    try {
        CheckImageSize(width, height, "");
    } catch (const Error &) {
        return std::nullopt;
    }
    return std::array<int, 2>{int(width), int(height)};
}

} // namespace

Image DecodeKtx(std::span<const std::byte> file, std::string_view name) {
    return KtxDecoder(file, name).Decode();
}

std::optional<std::array<int, 2>> KtxSize(std::span<const std::byte> file) {
    if (!HasMark(file, kKtx1Mark) && !HasMark(file, kKtx2Mark))
        return std::nullopt;
    try {
        const auto size = KtxDecoder(file, "").Size();
        return SizeIfValid(size[0], size[1]);
    } catch (const Error &) {
        return std::nullopt;
    }
}

// ---- Crunch: the header, whose numbers are big-endian ----

namespace {

/// Bytes where fields begin: the mark, the size of the file (32 bits), width and height (16 bits each).
constexpr std::size_t kCrnFileSizeAt = 6, kCrnWidthAt = 12, kCrnHeightAt = 14;
constexpr std::size_t kCrnLeastHeader = 62; ///< bytes, up to the palettes' descriptions

struct CrnHeader {
    std::uint64_t fileSize = 0, width = 0, height = 0;
};

std::optional<CrnHeader> ReadCrnHeader(std::span<const std::byte> file) {
    if (file.size() < kCrnLeastHeader || file[0] != std::byte('H') || file[1] != std::byte('x'))
        return std::nullopt;
    const auto number = [&](std::size_t at, std::size_t bytes) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value = value << 8 | std::to_integer<std::uint64_t>(file[at + i]);
        return value;
    };
    return CrnHeader{number(kCrnFileSizeAt, 4), number(kCrnWidthAt, 2), number(kCrnHeightAt, 2)};
}

} // namespace

Image DecodeCrn(std::span<const std::byte> file, std::string_view name) {
    const auto header = ReadCrnHeader(file);
    if (!header)
        throw Error("{}: expected an image that begins with Hx and a header of {} bytes", name, kCrnLeastHeader);
    if (file.size() < header->fileSize)
        throw Error("{}: CRN ends at byte {}, expected {} bytes", name, file.size(), header->fileSize);
    CheckImageSize(header->width, header->height, name);
    return {1, 1, {128, 128, 128, 255}};
}

std::optional<std::array<int, 2>> CrnSize(std::span<const std::byte> file) {
    const auto header = ReadCrnHeader(file);
    return header ? SizeIfValid(header->width, header->height) : std::nullopt;
}

} // namespace q3
