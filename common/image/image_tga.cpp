// GPL-2.0-or-later. TGA and PCX, as games of this family read them.
#include "common/error.h"
#include "common/image/image.h"

#include <algorithm>
#include <string>

namespace q3 {

// ---- TGA, as games of this family read it ----

namespace {

constexpr std::size_t kTgaHeader = 18;  ///< bytes
constexpr std::size_t kMaxPacket = 128; ///< pixels of one run
/// Bytes of the header where its fields begin; Truevision TGA File Format Specification 2.0.
constexpr std::size_t kCommentBytesOffset = 0, kMapTypeOffset = 1, kTypeOffset = 2, kMapFirstOffset = 3,
                      kMapCountOffset = 5, kMapBitsOffset = 7, kWidthOffset = 12, kHeightOffset = 14, kDepthOffset = 16,
                      kDescriptorOffset = 17;
constexpr unsigned kPackedType = 8; ///< added to the type of an image in runs
/// Of the descriptor: number of alpha bits, and whether columns go from right to left and rows from top to bottom.
constexpr unsigned kAlphaBits = 0xF, kRightToLeft = 0x10, kTopDown = 0x20;
constexpr unsigned kFullAlpha = 8; ///< the number of alpha bits of RGBA

/// The type of an image without kPackedType.
enum class Kind { Palette = 1, Color = 2, Gray = 3 };

using Rgba = std::array<std::uint8_t, 4>;

class TgaDecoder {
  public:
    TgaDecoder(std::span<const std::byte> file, std::string_view name) : file_(file), name_(name) {}

    Image Decode() {
        ReadHeader();
        ReadPalette();
        const std::size_t pixels = std::size_t(image_.width) * std::size_t(image_.height);
        const std::size_t packets = (pixels + kMaxPacket - 1) / kMaxPacket;
        Need(packed_ ? packets * (1 + pixelBytes_) : pixels * pixelBytes_, "pixels");
        image_.rgba.resize(4 * pixels);
        BeginRow();
        if (packed_)
            ReadRuns(pixels);
        else if (kind_ == Kind::Color)
            ReadColors(pixels);
        else
            for (std::size_t i = 0; i < pixels; ++i)
                Append(ReadPixel());
        return std::move(image_);
    }

  private:
    std::uint8_t Byte(std::size_t at) const { return std::to_integer<std::uint8_t>(file_[at]); }
    unsigned Word(std::size_t at) const { return Byte(at) | unsigned(Byte(at + 1)) << 8; }

    void Need(std::size_t bytes, std::string_view what) const {
        if (file_.size() - at_ < bytes)
            throw Error("{}: TGA ends at byte {} in its {}", name_, file_.size(), what);
    }
    [[noreturn]] void Unsupported(std::string_view what, unsigned value, std::string_view expected) const {
        throw Error("{}: TGA with {} {}, expected {}", name_, what, value, expected);
    }

    void ReadHeader() {
        Need(kTgaHeader, "header");
        const unsigned type = Byte(kTypeOffset), depth = Byte(kDepthOffset), descriptor = Byte(kDescriptorOffset);
        const unsigned plainType = type & ~kPackedType, alphaBits = descriptor & kAlphaBits;
        if (plainType < 1 || plainType > 3)
            Unsupported("image type", type, "1, 2, 3, 9, 10 or 11");
        kind_ = Kind(plainType);
        packed_ = (type & kPackedType) != 0;
        if (kind_ == Kind::Color ? depth != 24 && depth != 32 : depth != 8)
            Unsupported("bits per pixel", depth, kind_ == Kind::Color ? "24 or 32" : "8");
        if (alphaBits != 0 && alphaBits != kFullAlpha)
            Unsupported("attribute bits", alphaBits, "0 or 8");
        if ((descriptor & kRightToLeft) != 0)
            Unsupported("descriptor", descriptor, "columns from left to right");
        hasAlpha_ = alphaBits == kFullAlpha;
        topDown_ = (descriptor & kTopDown) != 0;
        pixelBytes_ = depth / 8;
        CheckImageSize(Word(kWidthOffset), Word(kHeightOffset), name_);
        image_.width = int(Word(kWidthOffset));
        image_.height = int(Word(kHeightOffset));
        at_ = kTgaHeader;
        Need(Byte(kCommentBytesOffset), "comment");
        at_ += Byte(kCommentBytesOffset);
    }

    void ReadPalette() {
        const unsigned mapType = Byte(kMapTypeOffset), first = Word(kMapFirstOffset), count = Word(kMapCountOffset),
                       bits = Byte(kMapBitsOffset);
        if (kind_ != Kind::Palette) {
            const std::size_t size = mapType == 0 ? 0 : std::size_t(count) * ((bits + 7) / 8);
            Need(size, "palette");
            at_ += size;
            return;
        }
        if (mapType != 1)
            Unsupported("palette type", mapType, "1");
        if (first != 0 || count > 256)
            Unsupported("palette end", first + count, "a palette of at most 256 entries from 0");
        if (bits != 24 && bits != 32)
            Unsupported("palette bits", bits, "24 or 32");
        Need(std::size_t(count) * (bits / 8), "palette");
        for (unsigned i = 0; i < count; ++i)
            palette_.push_back(ReadColor(bits / 8));
    }

    Rgba ReadColor(std::size_t bytes) {
        const Rgba color{Byte(at_ + 2), Byte(at_ + 1), Byte(at_),
                         hasAlpha_ && bytes == 4 ? Byte(at_ + 3) : std::uint8_t(255)};
        at_ += bytes;
        return color;
    }

    /// The caller has checked that the bytes are there.
    Rgba ReadPixel() {
        if (kind_ == Kind::Color)
            return ReadColor(pixelBytes_);
        const std::uint8_t value = Byte(at_++);
        if (kind_ == Kind::Gray)
            return {value, value, value, 255};
        if (value >= palette_.size())
            Unsupported("palette index", value, "one of its " + std::to_string(palette_.size()) + " entries");
        return palette_[value];
    }

    /// Most images of games are of this kind.
    void ReadColors(std::size_t pixels) {
        const std::size_t bytes = pixelBytes_;
        const std::byte *from = file_.data() + at_;
        const bool alpha = hasAlpha_ && bytes == 4;
        for (std::size_t left = pixels; left > 0; BeginRow())
            for (; out_ != rowEnd_; out_ += 4, from += bytes, --left) {
                out_[0] = std::to_integer<std::uint8_t>(from[2]);
                out_[1] = std::to_integer<std::uint8_t>(from[1]);
                out_[2] = std::to_integer<std::uint8_t>(from[0]);
                out_[3] = alpha ? std::to_integer<std::uint8_t>(from[3]) : std::uint8_t(255);
            }
    }

    void ReadRuns(std::size_t pixels) {
        constexpr unsigned kPacketLength = 0x7F, kPacketRepeats = 0x80; // its length less 1; one pixel for all of it
        for (std::size_t i = 0; i < pixels;) {
            Need(1, "pixels");
            const unsigned head = Byte(at_++);
            // Some writers let the last run pass the end of the image.
            const std::size_t length = std::min<std::size_t>((head & kPacketLength) + 1, pixels - i);
            const bool isRepeat = (head & kPacketRepeats) != 0;
            Need((isRepeat ? 1 : length) * pixelBytes_, "pixels");
            Rgba pixel = ReadPixel();
            for (std::size_t k = 0; k < length; ++k) {
                if (k > 0 && !isRepeat)
                    pixel = ReadPixel();
                Append(pixel), ++i;
            }
        }
    }

    /// Sets out_ to the start of the next row; after the last one it is not used any more.
    void BeginRow() {
        const std::size_t width = std::size_t(image_.width), height = std::size_t(image_.height);
        if (row_ >= height)
            return;
        out_ = image_.rgba.data() + 4 * width * (topDown_ ? row_ : height - 1 - row_);
        rowEnd_ = out_ + 4 * width;
        ++row_;
    }

    void Append(const Rgba &pixel) {
        out_ = std::copy(pixel.begin(), pixel.end(), out_);
        if (out_ == rowEnd_)
            BeginRow();
    }

    std::span<const std::byte> file_;
    std::string_view name_;
    std::size_t at_ = 0, pixelBytes_ = 0;
    Kind kind_ = Kind::Color;
    bool packed_ = false, hasAlpha_ = false, topDown_ = false;
    std::vector<Rgba> palette_;
    Image image_;
    std::uint8_t *out_ = nullptr, *rowEnd_ = nullptr; ///< where the next pixel goes, and the end of its row
    std::size_t row_ = 0;                             ///< that follows in the file
};

} // namespace

Image DecodeTga(std::span<const std::byte> file, std::string_view name) {
    return TgaDecoder(file, name).Decode();
}

std::vector<std::byte> EncodeTga(std::span<const std::uint8_t> texels, int width, int height, int channels,
                                 TgaRows rows) {
    constexpr std::array<std::size_t, 4> kBgra = {2, 1, 0, 3};
    std::vector<std::byte> file(kTgaHeader + texels.size());
    file[kTypeOffset] = std::byte(channels == 1 ? Kind::Gray : Kind::Color);
    file[kWidthOffset] = std::byte(width & 255), file[kWidthOffset + 1] = std::byte(width >> 8);
    file[kHeightOffset] = std::byte(height & 255), file[kHeightOffset + 1] = std::byte(height >> 8);
    file[kDepthOffset] = std::byte(8 * channels);
    file[kDescriptorOffset] = std::byte(channels == 4 ? kFullAlpha : 0);
    const auto count = std::size_t(channels), rowBytes = count * std::size_t(width);
    for (std::size_t y = 0; y < std::size_t(height); ++y) {
        const std::size_t from = (rows == TgaRows::TopFirst ? std::size_t(height) - 1 - y : y) * rowBytes;
        for (std::size_t i = 0; i < rowBytes; i += count)
            for (std::size_t k = 0; k < count; ++k)
                file[kTgaHeader + y * rowBytes + i + k] = std::byte(texels[from + i + (count == 1 ? 0 : kBgra[k])]);
    }
    return file;
}

// ---- PCX: runs of palette indexes, 8 bits a texel (ZSoft PCX File Format, revision 5) ----

namespace {

constexpr std::size_t kPcxHeader = 128;
constexpr unsigned kMark = 10, kRuns = 1; ///< the first byte of a file; the encoding in its third
/// A byte with both of kRunBits begins a run: the other bits are its length, the next byte its value.
constexpr unsigned kRunBits = 0xC0, kLengthBits = 0x3F;

class PcxReader {
  public:
    PcxReader(std::span<const std::byte> file, std::string_view name) : file_(file), name_(name) {}

    IndexImage Read() {
        if (file_.size() < kPcxHeader)
            TooShort();
        Expect("mark", Byte(0), kMark);
        Expect("encoding", Byte(2), kRuns);
        Expect("bits of a texel", Byte(3), 8);
        Expect("color planes", Byte(65), 1);
        // Words 4 to 10: the first column, the first row, the last column, the last row. Word 66: bytes of a row.
        const int width = int(Word(8)) - int(Word(4)) + 1, height = int(Word(10)) - int(Word(6)) + 1;
        CheckImageSize(width < 1 ? 0 : std::uint64_t(width), height < 1 ? 0 : std::uint64_t(height), name_);
        const std::size_t stride = Word(66), rows = std::size_t(height);
        if (stride < std::size_t(width))
            throw Error("{}: PCX with {} bytes per row, expected at least {}", name_, stride, width);
        if (stride * rows > kLengthBits * file_.size()) // a run is at most 63 texels; checked before allocating
            TooShort();
        ReadRuns(stride * rows);
        IndexImage image{width, height, {}};
        for (std::size_t row = 0; row < rows; ++row) {
            const auto first = texels_.begin() + std::ptrdiff_t(row * stride);
            image.indexes.insert(image.indexes.end(), first, first + width);
        }
        return image;
    }

  private:
    unsigned Byte(std::size_t at) const { return std::to_integer<unsigned>(file_[at]); }
    unsigned Word(std::size_t at) const { return Byte(at) | Byte(at + 1) << 8; }
    [[noreturn]] void TooShort() const { throw Error("{}: PCX: the file ends too early", name_); }

    void Expect(std::string_view what, unsigned found, unsigned expected) const {
        if (found != expected)
            throw Error("{}: PCX with {} {}, expected {}", name_, what, found, expected);
    }

    /// Some writers let runs go on into the next row.
    void ReadRuns(std::size_t count) {
        texels_.reserve(count);
        std::size_t at = kPcxHeader;
        while (texels_.size() < count) {
            if (at >= file_.size())
                TooShort();
            unsigned value = Byte(at++);
            std::size_t length = 1;
            if ((value & kRunBits) == kRunBits) {
                if (at >= file_.size())
                    TooShort();
                length = std::min<std::size_t>(value & kLengthBits, count - texels_.size());
                value = Byte(at++);
            }
            texels_.insert(texels_.end(), length, std::uint8_t(value));
        }
    }

    std::span<const std::byte> file_;
    std::string_view name_;
    std::vector<std::uint8_t> texels_; ///< with the padding at the ends of rows
};

} // namespace

IndexImage DecodePcx(std::span<const std::byte> file, std::string_view name) {
    return PcxReader(file, name).Read();
}

} // namespace q3
