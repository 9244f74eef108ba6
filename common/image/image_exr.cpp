// GPL-2.0-or-later. OpenEXR through its library. Built with Q3MAP2_OPENEXR, else image_without_exr.cpp is.
#include "common/error.h"
#include "common/image/float_image.h"
#include "common/image/image.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <new>

namespace q3 {

namespace {

constexpr std::array<const char *, 3> kExrChannels = {"R", "G", "B"};
constexpr int kMaxExrSide = 16384; ///< texels, as in CheckImageSize
constexpr int kNoThreads = 0;      ///< of the library: it works in the calling thread
/// Keeps memory in proportion to the file. Limit of this program, chosen: only images of a single color come near it.
constexpr std::uint64_t kMaxExrTexelsPerByte = 2048;

class BytesIn : public Imf::IStream {
  public:
    explicit BytesIn(std::span<const std::byte> file) : IStream("memory"), file_(file) {}
    bool read(char to[], int count) override {
        if (count < 0 || file_.size() - at_ < std::size_t(count))
            throw Error("the file ends too early");
        std::memcpy(to, file_.data() + at_, std::size_t(count));
        at_ += std::size_t(count);
        return at_ < file_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t at) override {
        if (at > file_.size())
            throw Error("the file ends too early");
        at_ = std::size_t(at);
    }

  private:
    std::span<const std::byte> file_;
    std::size_t at_ = 0;
};

class BytesOut : public Imf::OStream {
  public:
    BytesOut() : OStream("memory") {}
    void write(const char from[], int count) override {
        file.resize(std::max(file.size(), at_ + std::size_t(count)));
        std::memcpy(file.data() + at_, from, std::size_t(count));
        at_ += std::size_t(count);
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t at) override { at_ = std::size_t(at); }

    std::vector<std::byte> file;

  private:
    std::size_t at_ = 0;
};

/// Slices of the three channels; `first` is the texel of the upper left corner of the data window.
Imf::FrameBuffer Slices(Vec3f *first, const Imath::Box2i &window, std::size_t width) {
    Imf::FrameBuffer buffer;
    const std::size_t step = sizeof(Vec3f), row = step * width;
    for (std::size_t i = 0; i < 3; ++i)
        buffer.insert(kExrChannels[i],
                      Imf::Slice::Make(Imf::FLOAT, reinterpret_cast<char *>(first) + sizeof(float) * i, window.min,
                                       std::int64_t(width), std::int64_t(window.max.y) - window.min.y + 1, step, row));
    return buffer;
}

FloatImage ReadExr(std::span<const std::byte> file, std::string_view name) {
    Imf::Header::setMaxImageSize(kMaxExrSide, kMaxExrSide);
    Imf::Header::setMaxTileSize(kMaxExrSide, kMaxExrSide);
    BytesIn stream(file);
    Imf::InputFile input(stream, kNoThreads);
    const Imath::Box2i window = input.header().dataWindow();
    const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1,
                       height = std::int64_t(window.max.y) - window.min.y + 1;
    CheckImageSize(std::uint64_t(std::max<std::int64_t>(width, 0)), std::uint64_t(std::max<std::int64_t>(height, 0)),
                   name);
    if (std::uint64_t(width * height) > kMaxExrTexelsPerByte * file.size())
        throw Error("{}: EXR: {} bytes cannot hold {} x {} texels", name, file.size(), width, height);
    for (const char *channel : kExrChannels) {
        const Imf::Channel *found = input.header().channels().findChannel(channel);
        if (!found)
            throw Error("{}: EXR without a channel {}, expected R, G and B", name, channel);
        if (found->xSampling != 1 || found->ySampling != 1)
            throw Error("{}: EXR whose channel {} has one sample per {} x {} texels, expected one per texel", name,
                        channel, found->xSampling, found->ySampling);
    }
    FloatImage image{int(width), int(height), std::vector<Vec3f>(std::size_t(width * height))};
    input.setFrameBuffer(Slices(image.texels.data(), window, std::size_t(width)));
    input.readPixels(window.min.y, window.max.y);
    return image;
}

} // namespace

bool HasOpenExr() {
    return true;
}

FloatImage DecodeExr(std::span<const std::byte> file, std::string_view name) {
    try {
        return ReadExr(file, name);
    } catch (const Error &error) {
        const std::string_view text = error.what();
        throw Error("{}{}", text.starts_with(name) ? std::string() : fmt::format("{}: EXR: ", name), text);
    } catch (const std::bad_alloc &) {
        throw;
    } catch (const std::exception &error) {
        std::string text = error.what();
        std::ranges::replace(text, '\n', ' ');
        throw Error("{}: EXR: {}", name, text);
    }
}

std::vector<std::byte> EncodeExr(const FloatImage &image) {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char *channel : kExrChannels)
        header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    BytesOut stream;
    {
        Imf::OutputFile output(stream, header, kNoThreads);
        // The library only reads them.
        output.setFrameBuffer(
            Slices(const_cast<Vec3f *>(image.texels.data()), header.dataWindow(), std::size_t(image.width)));
        output.writePixels(image.height);
    }
    return std::move(stream.file);
}

} // namespace q3
