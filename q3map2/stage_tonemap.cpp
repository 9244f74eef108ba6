// GPL-2.0-or-later. q3map2 -tonemap.
#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "libs/math/packed_color.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/convert/preview/tone_picture.h"
#include "q3map2/file_guard.h"
#include "q3map2/stage_words.h"

namespace q3 {

namespace {

/// A page of LIGHTING_E5BGR9 in the row order of -export.
FloatImage HdrPageOf(const std::filesystem::path &path, const StageContext &context, int page) {
    const Bsp bsp = ReadBspFile(path, context.options.Format(), context.log);
    const int side = context.options.game->lightmapSize;
    const std::size_t texels = std::size_t(side) * std::size_t(side), pages = bsp.lightmapsE5bgr9.size() / texels;
    if (pages == 0)
        throw Error("{}: the map has no HDR lightmaps", path.string());
    if (std::size_t(page) >= pages)
        throw Error("{}: the map has no HDR lightmap {}, expected one of 0 to {}", path.string(), page, pages - 1);
    const auto codes = std::span(bsp.lightmapsE5bgr9).subspan(std::size_t(page) * texels, texels);
    return FlippedRows({side, side, DecodeE5bgr9(codes)});
}

void WritePicture(const std::filesystem::path &path, const Image &picture) {
    const std::string extension = path.extension().string();
    if (EqualNoCase(extension, ".png"))
        return WritePng(path, picture);
    if (!EqualNoCase(extension, ".tga"))
        throw Error("{}: unknown picture extension \"{}\", expected .png or .tga", path.string(), extension);
    std::vector<std::uint8_t> colors;
    for (std::size_t i = 0; i < picture.rgba.size(); ++i)
        if (i % 4 != 3)
            colors.push_back(picture.rgba[i]);
    ReplaceFile(path, EncodeTga(colors, picture.width, picture.height, 3, TgaRows::TopFirst));
}

} // namespace

int ToneMapStage(const StageContext &context, Arguments arguments) {
    const ToneMapOptions options = ParseToneMapOptions(arguments, context.log);
    const std::vector<std::string> files = TakeFiles(context, arguments);
    if (files.size() != 2)
        throw Error("usage: q3map2 {}", context.stage.usage);
    const std::filesystem::path from = std::filesystem::absolute(files[0]), to = std::filesystem::absolute(files[1]);
    FileGuard guard(context);
    guard.Needs(from);
    guard.Writes(to);
    const FloatImage image =
        EqualNoCase(from.extension().string(), ".bsp") ? HdrPageOf(from, context, options.page) : ReadFloatImage(from);
    WritePicture(to, ToneMapped(image, options));
    context.log.Print("Wrote {}\n", to.string());
    return 0;
}

} // namespace q3
