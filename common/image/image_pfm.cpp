// GPL-2.0-or-later. Portable float maps: three lines of text, then floats, bottom row first.
#include "common/error.h"
#include "common/image/float_image.h"
#include "common/image/image.h"
#include "common/text/text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>

namespace q3 {

namespace {

constexpr std::size_t kMaxWord = 32;      ///< bytes of a word; the rest of a longer one is skipped
constexpr std::size_t kMaxSideDigits = 9; ///< such numbers fit 32 bits; CheckImageSize has the limit

class PfmReader {
  public:
    PfmReader(std::span<const std::byte> file, std::string_view name) : file_(file), name_(name) {}

    FloatImage Read() {
        const std::string kind = Word("mark");
        if (kind != "PF" && kind != "Pf")
            throw Error("{}: PFM that starts with \"{}\", expected PF or Pf", name_, kind);
        const std::size_t channels = kind == "PF" ? 3 : 1;
        const std::uint64_t width = Side("width"), height = Side("height");
        CheckImageSize(width, height, name_);
        const bool isBigEndian = Scale() > 0; // the sign says so; the size of the scale has no effect here
        const std::size_t bytes = 4 * channels * std::size_t(width * height);
        if (file_.size() - at_ < bytes)
            throw Error("{}: PFM of {} x {} with {} bytes of texels, expected {}", name_, width, height,
                        file_.size() - at_, bytes);
        FloatImage image{int(width), int(height), {}};
        image.texels.reserve(std::size_t(width * height));
        for (std::size_t i = 0; i < width * height; ++i) {
            Vec3f texel;
            for (std::size_t channel = 0; channel < 3; ++channel)
                texel[channel] = channel < channels ? Float(isBigEndian) : texel.x;
            image.texels.push_back(texel);
        }
        return FlippedRows(image);
    }

  private:
    /// Reads the next word and skips one blank after it.
    std::string Word(std::string_view what) {
        while (at_ < file_.size() && IsBlank(char(file_[at_])))
            ++at_;
        std::string word;
        for (; at_ < file_.size() && !IsBlank(char(file_[at_])); ++at_)
            if (const char c = char(file_[at_]); word.size() < kMaxWord)
                word += c > ' ' && c < 127 ? c : '?';
        if (at_ >= file_.size())
            throw Error("{}: PFM ends at byte {} in its {}", name_, file_.size(), what);
        ++at_;
        return word;
    }

    std::uint64_t Side(std::string_view what) {
        const std::string word = Word(what);
        if (word.empty() || word.size() > kMaxSideDigits || word.find_first_not_of("0123456789") != word.npos)
            throw Error("{}: PFM of {} \"{}\", expected a whole number", name_, what, word);
        return std::stoull(word);
    }

    double Scale() {
        const std::string word = Word("scale");
        const std::optional<double> scale = StrictNumber(word);
        if (!scale || *scale == 0)
            throw Error("{}: PFM of scale \"{}\", expected a number other than 0", name_, word);
        return *scale;
    }

    float Float(bool isBigEndian) {
        std::array<std::byte, 4> bytes{};
        std::copy_n(file_.begin() + std::ptrdiff_t(at_), 4, bytes.begin());
        at_ += 4;
        if (isBigEndian)
            std::ranges::reverse(bytes);
        return std::bit_cast<float>(bytes);
    }

    std::span<const std::byte> file_;
    std::string_view name_;
    std::size_t at_ = 0;
};

} // namespace

static_assert(std::endian::native == std::endian::little, "floats are copied as they lie in the file");

FloatImage DecodePfm(std::span<const std::byte> file, std::string_view name) {
    return PfmReader(file, name).Read();
}

std::vector<std::byte> EncodePfm(const FloatImage &image) {
    const std::string head = fmt::format("PF\n{} {}\n-1.0\n", image.width, image.height);
    const FloatImage flipped = FlippedRows(image);
    const auto texels = std::as_bytes(std::span(flipped.texels));
    static_assert(sizeof(Vec3f) == 12);
    std::vector<std::byte> file(head.size() + texels.size());
    std::memcpy(file.data(), head.data(), head.size());
    std::ranges::copy(texels, file.begin() + std::ptrdiff_t(head.size()));
    return file;
}

} // namespace q3
