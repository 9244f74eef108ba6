// GPL-2.0-or-later. PNG through libpng.
#include "common/image/image.h"

#include "common/files/files.h"

#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <string>

namespace q3 {

namespace {

/// All that the reader owns, kept outside the functions to which libpng's errors jump back.
struct PngReader {
    std::span<const std::byte> file;
    std::string_view name;
    std::size_t at = 0;
    std::string message{}; ///< of libpng
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::size_t width = 0, height = 0;
    std::vector<png_bytep> rows{};

    PngReader(std::span<const std::byte> file_, std::string_view name_) : file(file_), name(name_) {}
    PngReader(const PngReader &) = delete;
    PngReader &operator=(const PngReader &) = delete;
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

void OnError(png_structp png, png_const_charp text) {
    static_cast<PngReader *>(png_get_error_ptr(png))->message = text;
    png_longjmp(png, 1);
}

void OnWarning(png_structp, png_const_charp) {}

void OnRead(png_structp png, png_bytep out, std::size_t count) {
    auto &reader = *static_cast<PngReader *>(png_get_io_ptr(png));
    if (reader.file.size() - reader.at < count)
        png_error(png, "the file ends too early");
    std::memcpy(out, reader.file.data() + reader.at, count);
    reader.at += count;
}

// The functions with setjmp hold no object with a destructor: libpng's errors jump back into them and would skip it.

bool ReadInfo(PngReader &reader) {
    if (setjmp(png_jmpbuf(reader.png)))
        return false;
    png_read_info(reader.png, reader.info);
    return true;
}

bool SetUpIndexes(PngReader &reader) {
    if (setjmp(png_jmpbuf(reader.png)))
        return false;
    png_set_packing(reader.png); // one byte per index, whatever the bit depth
    png_set_interlace_handling(reader.png);
    return true;
}

bool SetUpRgba(PngReader &reader) {
    if (setjmp(png_jmpbuf(reader.png)))
        return false;
    png_set_expand(reader.png);
    png_set_scale_16(reader.png);
    png_set_gray_to_rgb(reader.png);
    png_set_add_alpha(reader.png, 255, PNG_FILLER_AFTER);
    png_set_interlace_handling(reader.png);
    return true;
}

bool SetUpDeepRgba(PngReader &reader) {
    if (setjmp(png_jmpbuf(reader.png)))
        return false;
    png_set_expand_16(reader.png);
    if constexpr (std::endian::native == std::endian::little)
        png_set_swap(reader.png);
    png_set_gray_to_rgb(reader.png);
    png_set_add_alpha(reader.png, 65535, PNG_FILLER_AFTER);
    png_set_interlace_handling(reader.png);
    return true;
}

bool ReadRows(PngReader &reader, std::size_t texelBytes) {
    if (setjmp(png_jmpbuf(reader.png)))
        return false;
    png_read_update_info(reader.png, reader.info);
    if (png_get_rowbytes(reader.png, reader.info) != texelBytes * reader.width)
        png_error(reader.png, "the rows have an unexpected size");
    png_read_image(reader.png, reader.rows.data());
    return true;
}

/// Reads the chunks before the pixel data, and checks the image size.
void Begin(PngReader &reader) {
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, OnError, OnWarning);
    reader.info = reader.png ? png_create_info_struct(reader.png) : nullptr;
    if (!reader.info)
        throw Error("{}: PNG: out of memory", reader.name);
    png_set_read_fn(reader.png, &reader, OnRead);
    constexpr png_alloc_size_t kMaxChunkBytes = 8 << 20; // of a text or a color profile, unpacked
    png_set_chunk_malloc_max(reader.png, kMaxChunkBytes);
    if (!ReadInfo(reader))
        throw Error("{}: PNG: {}", reader.name, reader.message);
    reader.width = png_get_image_width(reader.png, reader.info);
    reader.height = png_get_image_height(reader.png, reader.info);
    CheckImageSize(reader.width, reader.height, reader.name);
    if (png_get_rowbytes(reader.png, reader.info) * reader.height > kMaxDeflateRatio * reader.file.size())
        throw Error("{}: PNG: {} bytes cannot hold {} x {} texels", reader.name, reader.file.size(), reader.width,
                    reader.height);
}

/// `setUp` asks libpng for a conversion to that many channels of type T.
template <typename T> std::vector<T> Texels(PngReader &reader, std::size_t channels, bool (*setUp)(PngReader &)) {
    std::vector<T> texels(channels * reader.width * reader.height);
    for (std::size_t row = 0; row < reader.height; ++row)
        reader.rows.push_back(reinterpret_cast<png_bytep>(texels.data() + channels * reader.width * row));
    if (!setUp(reader) || !ReadRows(reader, channels * sizeof(T)))
        throw Error("{}: PNG: {}", reader.name, reader.message);
    return texels;
}

} // namespace

Image DecodePng(std::span<const std::byte> file, std::string_view name) {
    PngReader reader(file, name);
    Begin(reader);
    return {int(reader.width), int(reader.height), Texels<std::uint8_t>(reader, 4, SetUpRgba)};
}

DeepImage DecodeDeepPng(std::span<const std::byte> file, std::string_view name) {
    PngReader reader(file, name);
    Begin(reader);
    const bool palette = png_get_color_type(reader.png, reader.info) == PNG_COLOR_TYPE_PALETTE;
    const int bits = palette ? 8 : png_get_bit_depth(reader.png, reader.info);
    return {int(reader.width), int(reader.height), bits, Texels<std::uint16_t>(reader, 4, SetUpDeepRgba)};
}

std::optional<IndexImage> DecodePngIndexes(std::span<const std::byte> file, std::string_view name) {
    PngReader reader(file, name);
    Begin(reader);
    if (png_get_color_type(reader.png, reader.info) != PNG_COLOR_TYPE_PALETTE)
        return std::nullopt;
    return IndexImage{int(reader.width), int(reader.height), Texels<std::uint8_t>(reader, 1, SetUpIndexes)};
}

std::vector<std::byte> EncodePng(std::span<const std::uint8_t> texels, int width, int height, int channels,
                                 std::string_view name) {
    CheckImageSize(std::uint64_t(width), std::uint64_t(height), name);
    if (channels != 3 && channels != 4)
        throw Error("{}: cannot write: {} channels per texel, expected 3 or 4", name, channels);
    if (texels.size() != std::size_t(channels) * std::size_t(width) * std::size_t(height))
        throw Error("{}: cannot write: {} bytes of texels, expected {} x {} x {}", name, texels.size(), width, height,
                    channels);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = png_uint_32(width);
    png.height = png_uint_32(height);
    png.format = channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::vector<std::byte> file(size);
    if (!png_image_write_to_memory(&png, file.data(), &size, 0, texels.data(), 0, nullptr))
        throw Error("{}: cannot write: {}", name, png.message);
    file.resize(size);
    return file;
}

void WritePng(const std::filesystem::path &path, std::span<const std::uint8_t> texels, int width, int height,
              int channels) {
    ReplaceFile(path, EncodePng(texels, width, height, channels, path.string()));
}

void WritePng(const std::filesystem::path &path, const Image &image) {
    WritePng(path, image.rgba, image.width, image.height, 4);
}

} // namespace q3
