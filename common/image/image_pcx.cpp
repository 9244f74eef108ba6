// GPL-2.0-or-later. PCX: runs of palette indexes, 8 bits a texel (ZSoft PCX File Format, revision 5).
#include "common/error.h"
#include "common/image/image.h"

#include <algorithm>

namespace q3 {

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
        const int width = int(Word(8)) - int(Word(4)) + 1, height = int(Word(10)) - int(Word(6)) + 1;
        CheckImageSize(width < 1 ? 0 : std::uint64_t(width), height < 1 ? 0 : std::uint64_t(height), name_);
        const std::size_t stride = Word(66), rows = std::size_t(height);
        if (stride < std::size_t(width))
            throw Error("{}: PCX with {} bytes a row, expected at least {}", name_, stride, width);
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
