// GPL-2.0-or-later. Plain readers of float images, and a writer of uncompressed OpenEXR files.
#include "tests/common/image/float_image_readers.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <map>
#include <stdexcept>

namespace q3 {

namespace {

constexpr std::uint32_t kExrMagic = 20000630, kExrVersion = 2;
constexpr int kExrZip = 3, kExrZipRows = 16;

/// Takes things off a file; std::out_of_range at its end.
class Taker {
  public:
    explicit Taker(const std::vector<std::byte> &file) : file_(file) {}
    std::uint8_t Byte() { return std::to_integer<std::uint8_t>(file_.at(at_++)); }
    std::int32_t Int() {
        std::uint32_t value = 0;
        for (int i = 0; i < 4; ++i)
            value |= std::uint32_t(Byte()) << 8 * i;
        return std::int32_t(value);
    }
    std::string Until(char end) {
        std::string text;
        for (char c = char(Byte()); c != end; c = char(Byte()))
            text += c;
        return text;
    }
    void Skip(std::size_t count) { at_ += count; }
    bool AtEnd() const { return at_ == file_.size(); }

  private:
    const std::vector<std::byte> &file_;
    std::size_t at_ = 0;
};

void Require(bool holds, const char *what) {
    if (!holds)
        throw std::runtime_error(what);
}

/// What the ZIP compression of OpenEXR does, undone: inflate, sums of differences, halves interleaved.
std::vector<std::uint8_t> Unzipped(const std::vector<std::uint8_t> &packed, std::size_t size) {
    std::vector<std::uint8_t> coded(size), bytes(size);
    uLongf length = uLongf(size);
    Require(uncompress(coded.data(), &length, packed.data(), uLong(packed.size())) == Z_OK && length == size, "zlib");
    for (std::size_t i = 1; i < size; ++i)
        coded[i] = std::uint8_t(coded[i - 1] + coded[i] - 128);
    for (std::size_t i = 0; i < size; ++i)
        bytes[i] = coded[i / 2 + (i % 2 == 0 ? 0 : (size + 1) / 2)];
    return bytes;
}

struct ExrHead {
    int width = 0, height = 0;
};

ExrHead TakeExrHead(Taker &file) {
    Require(std::uint32_t(file.Int()) == kExrMagic && std::uint32_t(file.Int()) == kExrVersion, "magic or version");
    ExrHead head;
    for (std::string name = file.Until('\0'); !name.empty(); name = file.Until('\0')) {
        const std::string type = file.Until('\0');
        const std::int32_t size = file.Int();
        if (name == "channels") {
            for (const char *expected : {"B", "G", "R"}) {
                Require(file.Until('\0') == expected && file.Int() == ExrFloat, "channels");
                file.Skip(4);
                Require(file.Int() == 1 && file.Int() == 1, "sampling");
            }
            Require(file.Byte() == 0, "end of channels");
        } else if (name == "compression") {
            Require(file.Byte() == kExrZip, "compression");
        } else if (name == "dataWindow") {
            Require(file.Int() == 0 && file.Int() == 0, "data window");
            head.width = file.Int() + 1;
            head.height = file.Int() + 1;
        } else {
            file.Skip(std::size_t(size));
        }
    }
    return head;
}

void PutInt(std::vector<std::byte> &file, std::int64_t value, int bytes = 4) {
    for (int i = 0; i < bytes; ++i)
        file.push_back(std::byte(value >> 8 * i & 255));
}
void PutText(std::vector<std::byte> &file, std::string_view text) {
    for (const char c : text)
        file.push_back(std::byte(c));
    file.push_back(std::byte(0));
}
void PutAttribute(std::vector<std::byte> &file, std::string_view name, std::string_view type,
                  const std::vector<std::byte> &value) {
    PutText(file, name);
    PutText(file, type);
    PutInt(file, std::int64_t(value.size()));
    file.insert(file.end(), value.begin(), value.end());
}

} // namespace

FloatImage ReadHdrPlainly(const std::vector<std::byte> &bytes) {
    Taker file(bytes);
    Require(file.Until('\n') == "#?RADIANCE" && file.Until('\n') == "FORMAT=32-bit_rle_rgbe" &&
                file.Until('\n').empty(),
            "header");
    FloatImage image;
    const std::string size = file.Until('\n');
    Require(std::sscanf(size.c_str(), "-Y %d +X %d", &image.height, &image.width) == 2, "size");
    const auto width = std::size_t(image.width);
    for (int row = 0; row < image.height; ++row) {
        std::array<std::vector<int>, 4> planes;
        if (width < 8) {
            for (std::size_t i = 0; i < 4 * width; ++i)
                planes[i % 4].push_back(file.Byte());
        } else {
            Require(file.Byte() == 2 && file.Byte() == 2, "row");
            const std::size_t high = file.Byte();
            Require(high * 256 + file.Byte() == width, "width of a row");
            for (auto &plane : planes)
                while (plane.size() < width) {
                    const int head = file.Byte();
                    Require(head != 0, "a count of 0");
                    if (head > 128)
                        plane.insert(plane.end(), std::size_t(head - 128), file.Byte());
                    else
                        for (int i = 0; i < head; ++i)
                            plane.push_back(file.Byte());
                }
        }
        for (std::size_t x = 0; x < width; ++x) {
            Require(planes[0].size() == width && planes[3].size() == width, "length of a row");
            const float unit = planes[3][x] == 0 ? 0.0f : float(std::pow(2.0, planes[3][x] - 136));
            image.texels.emplace_back(float(planes[0][x]) * unit, float(planes[1][x]) * unit,
                                      float(planes[2][x]) * unit);
        }
    }
    Require(file.AtEnd(), "bytes after the rows");
    return image;
}

FloatImage ReadExrPlainly(const std::vector<std::byte> &bytes) {
    Taker file(bytes);
    const ExrHead head = TakeExrHead(file);
    FloatImage image{head.width, head.height, std::vector<Vec3f>(std::size_t(head.width * head.height))};
    const int chunks = (head.height + kExrZipRows - 1) / kExrZipRows;
    file.Skip(8 * std::size_t(chunks)); // where they begin
    for (int chunk = 0; chunk < chunks; ++chunk) {
        const int first = file.Int(), rows = std::min(kExrZipRows, head.height - first);
        Require(first == chunk * kExrZipRows, "order of rows");
        std::vector<std::uint8_t> packed(std::size_t(file.Int()));
        for (std::uint8_t &byte : packed)
            byte = file.Byte();
        const std::size_t size = 12 * std::size_t(head.width) * std::size_t(rows);
        const std::vector<std::uint8_t> plain = packed.size() < size ? Unzipped(packed, size) : packed;
        for (std::size_t i = 0; i < size / 4; ++i) {
            const std::size_t width = std::size_t(head.width), row = i / (3 * width), channel = i / width % 3;
            float value = 0;
            std::memcpy(&value, plain.data() + 4 * i, 4);
            image.texels[(std::size_t(first) + row) * width + i % width][2 - channel] = value;
        }
    }
    Require(file.AtEnd(), "bytes after the rows");
    return image;
}

std::vector<std::byte> PlainExr(const ExrFile &exr) {
    std::vector<std::byte> file, channels, window, one;
    PutInt(file, kExrMagic);
    PutInt(file, kExrVersion);
    for (const ExrChannel &channel : exr.channels) {
        PutText(channels, channel.name);
        for (const int value : {int(channel.type), 0, channel.sampling, channel.sampling})
            PutInt(channels, value);
    }
    PutInt(channels, 0, 1);
    for (const int side : {0, exr.claimedSide - 1})
        for (const int corner : exr.windowMin)
            PutInt(window, corner + side);
    PutInt(one, 0x3F800000);
    std::vector<std::byte> center(8);
    PutAttribute(file, "channels", "chlist", channels);
    PutAttribute(file, "compression", "compression", {std::byte(0)});
    PutAttribute(file, "dataWindow", "box2i", window);
    PutAttribute(file, "displayWindow", "box2i", window);
    PutAttribute(file, "lineOrder", "lineOrder", {std::byte(0)});
    PutAttribute(file, "pixelAspectRatio", "float", one);
    PutAttribute(file, "screenWindowCenter", "v2f", center);
    PutAttribute(file, "screenWindowWidth", "float", one);
    PutInt(file, 0, 1);
    std::vector<std::vector<std::byte>> rows(2);
    for (int y = 0; y < 2; ++y)
        for (std::size_t c = 0; c < exr.channels.size(); ++c)
            for (int x = 0; x < 2; ++x) {
                const int exponent = int(c) - x - 2 * y; // biased by 15 or 127, above 10 or 23 bits of fraction
                exr.channels[c].type == ExrHalf ? PutInt(rows[std::size_t(y)], (exponent + 15) << 10, 2)
                                                : PutInt(rows[std::size_t(y)], std::int64_t(exponent + 127) << 23);
            }
    std::int64_t at = std::int64_t(file.size()) + 16;
    for (const auto &row : rows) {
        PutInt(file, at, 8);
        at += 8 + std::int64_t(row.size());
    }
    for (int y = 0; y < 2; ++y) {
        PutInt(file, exr.windowMin[1] + y);
        PutInt(file, std::int64_t(rows[std::size_t(y)].size()));
        file.insert(file.end(), rows[std::size_t(y)].begin(), rows[std::size_t(y)].end());
    }
    return file;
}

} // namespace q3
