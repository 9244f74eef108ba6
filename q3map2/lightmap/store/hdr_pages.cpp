// GPL-2.0-or-later. HDR light of lightmap pages as images beside the map.
#include "q3map2/lightmap/store/hdr_pages.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/image/float_image.h"
#include "libs/math/packed_color.h"
#include "q3map2/lightmap/store/exp32_json.h"

#include <algorithm>
#include <span>
#include <system_error>
#include <vector>

namespace q3 {

namespace {

constexpr std::string_view kExp32 = "exp32", kExp32Extension = "exp32.json";
constexpr std::string_view kImportOrder[] = {"exr", "pfm", "hdr", kExp32};

/// The codes of one image: a page, or a map of a basis vector.
struct HdrPart {
    std::span<std::uint32_t> codes;
    int side = 0;
    std::string name; ///< of its file, without extension
};

std::vector<HdrPart> HdrParts(Bsp &bsp, int side) {
    std::vector<HdrPart> parts;
    const std::size_t texels = std::size_t(side) * std::size_t(side);
    if (bsp.lightmapsE5bgr9.size() % texels != 0)
        throw Error("the HDR lightmaps have {} texels, which are no pages of {} x {}", bsp.lightmapsE5bgr9.size(), side,
                    side);
    for (std::size_t i = 0; i * texels < bsp.lightmapsE5bgr9.size(); ++i)
        parts.push_back(
            {std::span(bsp.lightmapsE5bgr9).subspan(i * texels, texels), side, fmt::format("lightmap_{:04}", i)});
    if (bsp.rnm)
        for (RnmPage &page : bsp.rnm->pages)
            for (std::size_t i = 0; i < page.maps.size(); ++i)
                parts.push_back({page.maps[i], int(bsp.rnm->header.side),
                                 fmt::format("lightmap_{:04}_b{}", page.lightmapNum, i + 1)});
    return parts;
}

std::filesystem::path FileOfPart(const std::filesystem::path &folder, const HdrPart &part, std::string_view format) {
    return folder / fmt::format("{}.{}", part.name, format == kExp32 ? kExp32Extension : format);
}

/// Pictures have the last row of the page on top, as those of ExportLightmaps; lists have row 0 first.
std::vector<std::byte> EncodedPart(const HdrPart &part, std::string_view format) {
    FloatImage image{part.side, part.side, {}};
    image.texels.reserve(part.codes.size());
    for (const std::uint32_t code : part.codes)
        image.texels.push_back(DecodeE5bgr9(code));
    return format == kExp32 ? EncodeExp32Json(image) : FindFloatImageFormat(format)->encode(FlippedRows(image));
}

FloatImage DecodedPart(const std::filesystem::path &path, std::string_view format) {
    const std::vector<std::byte> file = ReadFile(path);
    return format == kExp32 ? DecodeExp32Json(file, path.string())
                            : FlippedRows(FindFloatImageFormat(format)->decode(file, path.string()));
}

/// The format to read; empty: no file is there.
std::string_view FormatThere(const std::filesystem::path &folder, const HdrPart &part, const std::string &format,
                             Log &log) {
    std::vector<std::string_view> there;
    std::error_code ignored;
    for (const std::string_view one : kImportOrder)
        if ((format.empty() || one == format) && std::filesystem::exists(FileOfPart(folder, part, one), ignored))
            there.push_back(one);
    if (there.size() > 1)
        log.Warn("HDR lightmap images", "{} has images in {} formats: {} is taken; -hdrformat chooses", part.name,
                 there.size(), there[0]);
    return there.empty() ? std::string_view() : there[0];
}

} // namespace

void ExportHdrLight(const Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &format,
                    Log &log) {
    Bsp light; // parts are spans of what can be changed
    light.lightmapsE5bgr9 = bsp.lightmapsE5bgr9;
    light.rnm = bsp.rnm;
    const std::vector<HdrPart> parts = HdrParts(light, side);
    const std::string_view chosen = !format.empty() ? std::string_view(format) : HasOpenExr() ? "exr" : "pfm";
    for (const HdrPart &part : parts)
        ReplaceFile(FileOfPart(folder, part, chosen), EncodedPart(part, chosen));
    if (!parts.empty())
        log.Print("Wrote {} HDR lightmaps to {}\n", parts.size(), folder.string());
}

void ImportHdrLight(Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &format, Log &log) {
    const std::vector<HdrPart> parts = HdrParts(bsp, side);
    std::size_t replaced = 0;
    for (const HdrPart &part : parts) {
        const std::string_view found = FormatThere(folder, part, format, log);
        if (found.empty())
            continue;
        const auto path = FileOfPart(folder, part, found);
        const FloatImage image = DecodedPart(path, found);
        if (image.width != part.side || image.height != part.side) {
            log.Warn("lightmap image size", "{}: {} x {}, expected {} x {}; this lightmap stays", path.string(),
                     image.width, image.height, part.side, part.side);
            continue;
        }
        std::ranges::transform(image.texels, part.codes.begin(), EncodeE5bgr9);
        ++replaced;
    }
    if (!parts.empty())
        log.Print("Read {} of {} HDR lightmaps from {}\n", replaced, parts.size(), folder.string());
}

} // namespace q3
