// GPL-2.0-or-later. PNG through libpng.
#include "common/image.h"

#include "common/files.h"
#include "common/image_check.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <string>

namespace q3 {

namespace {

constexpr std::size_t kMaxDeflateRatio = 1032; // no deflate stream can expand further

/// All that the reader owns, outside the frame that libpng's errors jump out of.
struct PngReader {
    std::span<const std::byte> file;
    std::string_view name;
    std::size_t at = 0;
    std::string message{}; ///< of libpng
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::vector<png_bytep> rows{};
    Image image{};

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

// The two functions with setjmp hold no object with a destructor: libpng jumps over their frames.

bool ReadInfo(PngReader &reader) {
    if (setjmp(png_jmpbuf(reader.png)))
        return false;
    png_read_info(reader.png, reader.info);
    png_set_expand(reader.png);
    png_set_scale_16(reader.png);
    png_set_gray_to_rgb(reader.png);
    png_set_add_alpha(reader.png, 255, PNG_FILLER_AFTER);
    png_set_interlace_handling(reader.png);
    return true;
}

bool ReadRows(PngReader &reader) {
    if (setjmp(png_jmpbuf(reader.png)))
        return false;
    png_read_update_info(reader.png, reader.info);
    if (png_get_rowbytes(reader.png, reader.info) != 4 * std::size_t(reader.image.width))
        png_error(reader.png, "the rows have an unexpected size");
    png_read_image(reader.png, reader.rows.data());
    return true;
}

} // namespace

Image DecodePng(std::span<const std::byte> file, std::string_view name) {
    PngReader reader(file, name);
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, OnError, OnWarning);
    reader.info = reader.png ? png_create_info_struct(reader.png) : nullptr;
    if (!reader.info)
        throw Error("{}: PNG: out of memory", name);
    png_set_read_fn(reader.png, &reader, OnRead);
    png_set_chunk_malloc_max(reader.png, png_alloc_size_t(8) << 20);
    if (!ReadInfo(reader))
        throw Error("{}: PNG: {}", name, reader.message);

    const std::size_t width = png_get_image_width(reader.png, reader.info);
    const std::size_t height = png_get_image_height(reader.png, reader.info);
    CheckImageSize(width, height, name);
    if (png_get_rowbytes(reader.png, reader.info) * height > kMaxDeflateRatio * file.size())
        throw Error("{}: PNG: {} bytes cannot hold {} x {} texels", name, file.size(), width, height);
    reader.image.width = int(width);
    reader.image.height = int(height);
    reader.image.rgba.resize(4 * width * height);
    for (std::size_t row = 0; row < height; ++row)
        reader.rows.push_back(reader.image.rgba.data() + 4 * width * row);
    if (!ReadRows(reader))
        throw Error("{}: PNG: {}", name, reader.message);
    return std::move(reader.image);
}

void WritePng(const std::filesystem::path &path, const Image &image) {
    CheckImageSize(std::uint64_t(image.width), std::uint64_t(image.height), path.string());
    if (image.rgba.size() != 4 * std::size_t(image.width) * std::size_t(image.height))
        throw Error("{}: cannot write: {} bytes of texels, expected {} x {} x 4", path.string(), image.rgba.size(),
                    image.width, image.height);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = png_uint_32(image.width);
    png.height = png_uint_32(image.height);
    png.format = PNG_FORMAT_RGBA;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::vector<std::byte> file(size);
    if (!png_image_write_to_memory(&png, file.data(), &size, 0, image.rgba.data(), 0, nullptr))
        throw Error("{}: cannot write: {}", path.string(), png.message);
    ReplaceFile(path, std::span(file).first(size));
}

} // namespace q3
