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

// ---- Attributes of the header ----

/// Types of which the library reads so many bytes, whatever the attribute states.
struct FixedType {
    std::string_view name;
    std::size_t bytes;
};
constexpr FixedType kFixedTypes[] = {{"box2f", 16},
                                     {"box2i", 16},
                                     {"chromaticities", 32},
                                     {"compression", 1},
                                     {"deepImageState", 1},
                                     {"double", 8},
                                     {"envmap", 1},
                                     {"float", 4},
                                     {"int", 4},
                                     {"keycode", 28},
                                     {"lineOrder", 1},
                                     {"m33d", 72},
                                     {"m33f", 36},
                                     {"m44d", 128},
                                     {"m44f", 64},
                                     {"rational", 8},
                                     {"tiledesc", 9},
                                     {"timecode", 8},
                                     {"v2d", 16},
                                     {"v2f", 8},
                                     {"v2i", 8},
                                     {"v3d", 24},
                                     {"v3f", 12},
                                     {"v3i", 12}};

/// Checks attributes before the library reads them: it takes memory for the sizes that they state, and for some types
/// reads another number of bytes. What else is wrong, it finds itself.
class AttributeCheck {
  public:
    AttributeCheck(std::span<const std::byte> file, std::string_view name) : rest_(file), name_(name) {}

    void Run() {
        constexpr std::array kMagic{std::byte{0x76}, std::byte{0x2f}, std::byte{0x31}, std::byte{0x01}};
        constexpr std::uint32_t kSeveralParts = 0x1000; // of the version
        if (rest_.size() < kMagic.size() || !std::ranges::equal(Take(kMagic.size()), kMagic))
            return;
        const bool hasParts = (TakeWord() & kSeveralParts) != 0;
        // An attribute is its name, its type, a size, and so many bytes. A header ends with an empty name; after those
        // of several parts there is another one.
        for (bool wasEnd = false; !rest_.empty();) {
            const bool isEnd = TakeText().empty();
            if (isEnd && (wasEnd || !hasParts))
                return;
            wasEnd = isEnd;
            if (isEnd)
                continue;
            const std::string_view type = TakeText();
            const std::size_t size = TakeWord();
            if (size > rest_.size())
                throw Error("{}: EXR: an attribute of {} bytes, but {} follow", name_, size, rest_.size());
            if (!Fits(type, Take(size)))
                throw Error("{}: EXR: an attribute of {} bytes, which do not fit its type {}", name_, size,
                            type.substr(0, 40));
        }
    }

  private:
    std::span<const std::byte> Take(std::size_t bytes) {
        const auto taken = rest_.first(std::min(bytes, rest_.size()));
        rest_ = rest_.subspan(taken.size());
        return taken;
    }
    /// 0 at the end of the file.
    std::uint32_t TakeWord() {
        std::uint32_t word = 0;
        const auto bytes = Take(sizeof word);
        if (bytes.size() == sizeof word)
            std::memcpy(&word, bytes.data(), sizeof word);
        return word;
    }
    std::string_view TakeText() {
        const std::string_view all(reinterpret_cast<const char *>(rest_.data()), rest_.size());
        const std::string_view text = all.substr(0, all.find('\0'));
        Take(text.size() + 1);
        return text;
    }

    /// Whether the library reads exactly these bytes.
    static bool Fits(std::string_view type, std::span<const std::byte> value) {
        for (const FixedType &fixed : kFixedTypes)
            if (fixed.name == type)
                return value.size() == fixed.bytes;
        constexpr std::size_t kChannelBytes = 16, kColorBytes = 4;
        AttributeCheck in(value, {});
        if (type == "chlist") { // names with 16 bytes each, and an empty name
            for (; !in.rest_.empty(); in.Take(kChannelBytes))
                if (in.TakeText().empty())
                    return in.rest_.empty();
            return false;
        }
        if (type == "preview") { // width, height, colors
            if (value.size() < 2 * sizeof(std::uint32_t))
                return false;
            const std::uint64_t width = in.TakeWord(), height = in.TakeWord();
            return width * height <= value.size() && width * height * kColorBytes == in.rest_.size();
        }
        if (type == "floatvector")
            return value.size() % sizeof(float) == 0;
        while (type == "stringvector" && !in.rest_.empty()) { // lengths and texts
            if (in.rest_.size() < sizeof(std::uint32_t))
                return false;
            const std::size_t length = in.TakeWord();
            if (in.Take(length).size() != length)
                return false;
        }
        return true;
    }

    std::span<const std::byte> rest_;
    std::string_view name_;
};

FloatImage ReadExr(std::span<const std::byte> file, std::string_view name) {
    AttributeCheck(file, name).Run();
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
