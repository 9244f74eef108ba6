// GPL-2.0-or-later. Radiance pictures: RGBE in rows, flat or in runs.
#include "common/error.h"
#include "common/image/float_image.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "libs/math/packed_color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>

namespace q3 {

namespace {

constexpr std::string_view kHdrFormat = "FORMAT=", kHdrExposure = "EXPOSURE=", kHdrRgbe = "32-bit_rle_rgbe";
constexpr std::size_t kMinRunWidth = 8, kMaxRunWidth = 32767; ///< rows of other widths have no runs by channel
constexpr unsigned kRunMark = 2;                              ///< a row in runs by channel begins with it twice
constexpr std::size_t kMaxHdrRun = 127, kMaxLiteral = 128;    ///< bytes of a channel
constexpr unsigned kRunBias = 128;    ///< the head of a run is this plus its length; that of a literal its length
constexpr std::size_t kLeastRun = 4;  ///< chosen: shorter ones go into literals
constexpr unsigned kMaxRunShift = 24; ///< a repeat with a larger shift is longer than any row

/// Whether a flat code is no color, but repeats the one before.
bool IsRepeat(const Rgbe &code) {
    return code[0] == 1 && code[1] == 1 && code[2] == 1;
}

class HdrReader {
  public:
    HdrReader(std::span<const std::byte> file, std::string_view name) : file_(file), name_(name) {}

    FloatImage Read() {
        ReadHeader();
        ReadSize();
        const auto width = std::size_t(image_.width);
        row_.resize(width);
        for (int row = 0; row < image_.height; ++row) { // memory grows with the rows that are there
            ReadRow();
            for (const Rgbe &code : row_)
                image_.texels.push_back(DecodeRgbe(code) * float(1 / exposure_));
        }
        return bottomFirst_ ? FlippedRows(image_) : std::move(image_);
    }

  private:
    [[noreturn]] void FailTruncated(std::string_view what) const {
        throw Error("{}: Radiance picture ends at byte {} in its {}", name_, file_.size(), what);
    }

    unsigned Byte() {
        if (at_ >= file_.size())
            FailTruncated("texels");
        return std::to_integer<unsigned>(file_[at_++]);
    }
    Rgbe Code() {
        if (file_.size() - at_ < 4)
            FailTruncated("texels");
        Rgbe code{};
        for (std::uint8_t &byte : code)
            byte = std::uint8_t(Byte());
        return code;
    }

    std::string Line() {
        const auto first = file_.begin() + std::ptrdiff_t(at_), end = std::find(first, file_.end(), std::byte('\n'));
        if (end == file_.end())
            FailTruncated("header");
        at_ += std::size_t(end - first) + 1;
        return {reinterpret_cast<const char *>(&*first), std::size_t(end - first)};
    }

    void ReadHeader() {
        if (file_.size() < 2 || file_[0] != std::byte('#') || file_[1] != std::byte('?'))
            throw Error("{}: Radiance picture that does not start with #?", name_);
        for (std::string line = Line(); !line.empty(); line = Line()) {
            if (line.starts_with(kHdrFormat) && line.substr(kHdrFormat.size()) != kHdrRgbe)
                throw Error("{}: Radiance picture of format {}, expected {}", name_, line.substr(kHdrFormat.size(), 40),
                            kHdrRgbe);
            if (line.starts_with(kHdrExposure))
                exposure_ *= Exposure(std::string_view(line).substr(kHdrExposure.size()));
        }
        if (exposure_ <= 0 || !std::isfinite(exposure_) || !std::isfinite(1 / exposure_))
            throw Error("{}: Radiance picture of exposure {}, expected a number above 0", name_, exposure_);
    }

    double Exposure(std::string_view text) const {
        std::string_view rest = text;
        const std::optional<double> value = TakeNumber(rest);
        if (!value || *value <= 0)
            throw Error("{}: Radiance picture of exposure \"{}\", expected a number above 0", name_,
                        text.substr(0, 40));
        return *value;
    }

    void ReadSize() {
        const std::string line = Line();
        char ySign = 0, xSign = 0;
        unsigned long long height = 0, width = 0;
        if (std::sscanf(line.c_str(), "%cY %9llu %cX %9llu", &ySign, &height, &xSign, &width) != 4 ||
            (ySign != '-' && ySign != '+') || xSign != '+')
            throw Error("{}: Radiance picture of size \"{}\", expected \"-Y height +X width\" or \"+Y ...\"", name_,
                        line.substr(0, 40));
        CheckImageSize(width, height, name_);
        image_.width = int(width);
        image_.height = int(height);
        bottomFirst_ = ySign == '+';
    }

    void ReadRow() {
        const std::size_t width = row_.size();
        if (width < kMinRunWidth || width > kMaxRunWidth || !IsRowByChannel())
            return ReadOldRow();
        at_ += 4;
        for (std::size_t channel = 0; channel < 4; ++channel)
            ReadChannel(channel);
    }

    /// Whether a row in runs by channel begins here. Flat codes cannot look like this: their largest mantissa is above
    /// 127.
    bool IsRowByChannel() const {
        if (file_.size() - at_ < 4)
            FailTruncated("texels");
        const auto byte = [this](std::size_t i) { return std::to_integer<unsigned>(file_[at_ + i]); };
        if (byte(0) != kRunMark || byte(1) != kRunMark || byte(2) > 127)
            return false;
        if ((byte(2) << 8 | byte(3)) != row_.size())
            throw Error("{}: Radiance picture with a row of {} texels, expected {}", name_, byte(2) << 8 | byte(3),
                        row_.size());
        return true;
    }

    void ReadChannel(std::size_t channel) {
        for (std::size_t x = 0; x < row_.size();) {
            const unsigned head = Byte();
            const bool isRun = head > kRunBias;
            const std::size_t count = isRun ? head - kRunBias : head;
            if (count == 0 || count > row_.size() - x)
                FailRunLength(count, row_.size() - x);
            unsigned value = isRun ? Byte() : 0;
            for (const std::size_t end = x + count; x < end; ++x)
                row_[x][channel] = std::uint8_t(isRun ? value : Byte());
        }
    }

    /// Flat codes; 1 1 1 n repeats the last code n * 256^k times, k: number of such codes right before.
    void ReadOldRow() {
        unsigned shift = 0;
        for (std::size_t x = 0; x < row_.size();) {
            const Rgbe code = Code();
            if (!IsRepeat(code)) {
                row_[x++] = code;
                shift = 0;
                continue;
            }
            const std::size_t count = shift > kMaxRunShift ? SIZE_MAX : std::size_t(code[3]) << shift;
            if (x == 0)
                throw Error("{}: Radiance picture with a repeat before the first texel of a row", name_);
            if (count > row_.size() - x)
                FailRunLength(count, row_.size() - x);
            std::fill_n(row_.begin() + std::ptrdiff_t(x), count, row_[x - 1]);
            x += count;
            shift += 8;
        }
    }

    [[noreturn]] void FailRunLength(std::size_t count, std::size_t room) const {
        throw Error("{}: Radiance picture with a run of {} texels at byte {}, expected 1 to {}", name_, count, at_,
                    room);
    }

    std::span<const std::byte> file_;
    std::string_view name_;
    std::size_t at_ = 0;
    double exposure_ = 1;
    bool bottomFirst_ = false;
    std::vector<Rgbe> row_;
    FloatImage image_;
};

void Append(std::vector<std::byte> &file, std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    file.insert(file.end(), bytes.begin(), bytes.end());
}

/// One channel of a row: runs of equal bytes, and literals between them.
void AppendRuns(std::vector<std::byte> &file, std::span<const std::uint8_t> bytes) {
    const auto runAt = [bytes](std::size_t first) {
        std::size_t end = first + 1;
        while (end < bytes.size() && bytes[end] == bytes[first] && end - first < kMaxHdrRun)
            ++end;
        return end - first;
    };
    for (std::size_t at = 0; at < bytes.size();) {
        if (const std::size_t run = runAt(at); run >= kLeastRun) {
            file.push_back(std::byte(kRunBias + run));
            file.push_back(std::byte(bytes[at]));
            at += run;
            continue;
        }
        std::size_t end = at + 1;
        while (end < bytes.size() && end - at < kMaxLiteral && runAt(end) < kLeastRun)
            ++end;
        file.push_back(std::byte(end - at));
        for (; at < end; ++at)
            file.push_back(std::byte(bytes[at]));
    }
}

} // namespace

FloatImage DecodeHdr(std::span<const std::byte> file, std::string_view name) {
    return HdrReader(file, name).Read();
}

std::vector<std::byte> EncodeHdr(const FloatImage &image) {
    std::vector<std::byte> file;
    Append(file, fmt::format("#?RADIANCE\nFORMAT={}\n\n-Y {} +X {}\n", kHdrRgbe, image.height, image.width));
    const auto width = std::size_t(image.width);
    const bool inRuns = width >= kMinRunWidth && width <= kMaxRunWidth;
    std::array<std::vector<std::uint8_t>, 4> channels;
    for (int row = 0; row < image.height; ++row) {
        for (auto &channel : channels)
            channel.clear();
        for (int x = 0; x < image.width; ++x) {
            Rgbe code = EncodeRgbe(image.Texel(x, row));
            // Only the least color that is not black, 2^-135, has these mantissas.
            if (!inRuns && IsRepeat(code))
                code = {};
            for (std::size_t i = 0; i < 4; ++i)
                inRuns ? channels[i].push_back(code[i]) : file.push_back(std::byte(code[i]));
        }
        if (!inRuns)
            continue;
        for (const std::size_t byte : {std::size_t(kRunMark), std::size_t(kRunMark), width >> 8, width & 255})
            file.push_back(std::byte(byte));
        for (const auto &channel : channels)
            AppendRuns(file, channel);
    }
    return file;
}

} // namespace q3
