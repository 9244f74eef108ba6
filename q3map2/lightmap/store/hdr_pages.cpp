// GPL-2.0-or-later. HDR light of lightmap pages as images beside the map.
#include "q3map2/lightmap/store/hdr_pages.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/image/engine_hdr.h"
#include "common/text/counted.h"
#include "libs/math/packed_color.h"
#include "q3map2/lightmap/store/exp32_json.h"

#include <algorithm>
#include <span>
#include <system_error>
#include <vector>

namespace q3 {

namespace {

using FileBytes = std::vector<std::byte>;

/// A format of -hdrformat. Images in exr, pfm and hdr have the last row of the page on top, as in ExportLightmaps.
struct HdrForm {
    std::string_view name, prefix, extension;
    FileBytes (*encode)(const FloatImage &page);
    FloatImage (*decode)(std::span<const std::byte> file, std::string_view name);
    float fullVertexLight = 0; ///< full light in vertlight.raw; 0: the format has no such file
};

constexpr HdrForm kForms[] = {
    {"exr", "lightmap", "exr", [](const FloatImage &page) { return EncodeExr(FlippedRows(page)); },
     [](std::span<const std::byte> file, std::string_view name) { return FlippedRows(DecodeExr(file, name)); }},
    {"pfm", "lightmap", "pfm", [](const FloatImage &page) { return EncodePfm(FlippedRows(page)); },
     [](std::span<const std::byte> file, std::string_view name) { return FlippedRows(DecodePfm(file, name)); }},
    {"hdr", "lightmap", "hdr", [](const FloatImage &page) { return EncodeHdr(FlippedRows(page)); },
     [](std::span<const std::byte> file, std::string_view name) { return FlippedRows(DecodeHdr(file, name)); }},
    {"exp32", "lightmap", "exp32.json", EncodeExp32Json, DecodeExp32Json},
    {"rend2", "lm", "hdr", EncodeRend2Hdr, DecodeRend2Hdr, kRend2VertexScale},
    {"ioquake3", "lm", "hdr", EncodeIoquake3Hdr, DecodeIoquake3Hdr, kIoquake3VertexScale}};
/// Formats that -import looks for without -hdrformat. Their file names differ; rend2 and ioquake3 share theirs.
constexpr std::span<const HdrForm> kNamedForms(kForms, 4);

const HdrForm &FormOf(std::string_view name) {
    return *std::ranges::find(kForms, name, &HdrForm::name);
}

/// The E5BGR9 codes of one image: a page, or the map of one basis normal.
struct HdrPart {
    std::span<std::uint32_t> codes;
    int side = 0;
    std::string name; ///< NNNN or NNNN_b1
};

std::vector<HdrPart> HdrParts(Bsp &bsp, int side) {
    std::vector<HdrPart> parts;
    const std::size_t texels = std::size_t(side) * std::size_t(side);
    if (bsp.lightmapsE5bgr9.size() % texels != 0)
        throw Error("the HDR lightmaps have {} texels, not a whole number of {} x {} pages", bsp.lightmapsE5bgr9.size(),
                    side, side);
    for (std::size_t i = 0; i * texels < bsp.lightmapsE5bgr9.size(); ++i)
        parts.push_back({std::span(bsp.lightmapsE5bgr9).subspan(i * texels, texels), side, fmt::format("{:04}", i)});
    if (bsp.rnm)
        for (RnmPage &page : bsp.rnm->pages)
            for (std::size_t i = 0; i < page.maps.size(); ++i)
                parts.push_back(
                    {page.maps[i], int(bsp.rnm->header.side), fmt::format("{:04}_b{}", page.lightmapNum, i + 1)});
    return parts;
}

std::filesystem::path FileOfPart(const std::filesystem::path &folder, const HdrPart &part, const HdrForm &form) {
    return folder / fmt::format("{}_{}.{}", form.prefix, part.name, form.extension);
}

FloatImage ImageOf(const HdrPart &part) {
    return {part.side, part.side, DecodeE5bgr9(part.codes)};
}

/// The first format whose file exists; null: none.
const HdrForm *FirstExistingForm(const std::filesystem::path &folder, const HdrPart &part, const std::string &wanted,
                                 Log &log) {
    const HdrForm *found = nullptr;
    int count = 0;
    std::error_code ignored;
    for (const HdrForm &form : wanted.empty() ? kNamedForms : std::span<const HdrForm>(&FormOf(wanted), 1))
        if ((HasOpenExr() || form.extension != "exr" || !wanted.empty()) &&
            std::filesystem::exists(FileOfPart(folder, part, form), ignored)) {
            ++count;
            found = found ? found : &form;
        }
    if (count > 1)
        log.Warn("HDR lightmap images", "{} has images in {} formats: {} is taken; -hdrformat chooses", part.name,
                 count, found->name);
    return found;
}

void ImportVertexLight(const std::filesystem::path &path, float fullLight, Bsp &bsp, Log &log) {
    std::error_code ignored;
    if (bsp.vertexE5bgr9.empty() || !std::filesystem::exists(path, ignored))
        return;
    const std::vector<Vec3f> light = DecodeVertexLight(ReadFile(path), bsp.drawVerts.size(), fullLight, path.string());
    bsp.vertexE5bgr9 = EncodeE5bgr9(light);
    log.Print("Read the HDR light of {} from {}\n", Counted((long long)(light.size()), "vertices"), path.string());
}

} // namespace

void ExportHdrLight(const Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &format,
                    Log &log) {
    Bsp light; // a copy: HdrParts returns mutable spans
    light.lightmapsE5bgr9 = bsp.lightmapsE5bgr9;
    light.rnm = bsp.rnm;
    const std::vector<HdrPart> parts = HdrParts(light, side);
    const HdrForm &form = FormOf(!format.empty() ? std::string_view(format) : HasOpenExr() ? "exr" : "pfm");
    for (const HdrPart &part : parts)
        ReplaceFile(FileOfPart(folder, part, form), form.encode(ImageOf(part)));
    if (form.fullVertexLight > 0 && !bsp.vertexE5bgr9.empty()) {
        const std::vector<Vec3f> vertices = DecodeE5bgr9(bsp.vertexE5bgr9);
        ReplaceFile(folder / kVertexLightFile, EncodeVertexLight(vertices, form.fullVertexLight));
    }
    if (!parts.empty())
        log.Print("Wrote {} to {}\n", Counted((long long)(parts.size()), "HDR lightmaps"), folder.string());
}

void ImportHdrLight(Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &format, Log &log) {
    const std::vector<HdrPart> parts = HdrParts(bsp, side);
    std::size_t replaced = 0;
    for (const HdrPart &part : parts) {
        const HdrForm *form = FirstExistingForm(folder, part, format, log);
        if (!form)
            continue;
        const auto path = FileOfPart(folder, part, *form);
        const FloatImage image = form->decode(ReadFile(path), path.string());
        if (image.width != part.side || image.height != part.side) {
            log.Warn("lightmap image size", "{}: {} x {}, expected {} x {}; this lightmap stays", path.string(),
                     image.width, image.height, part.side, part.side);
            continue;
        }
        std::ranges::copy(EncodeE5bgr9(image.texels), part.codes.begin());
        ++replaced;
    }
    if (!parts.empty())
        log.Print("Read {} of {} from {}\n", replaced, Counted((long long)(parts.size()), "HDR lightmaps"),
                  folder.string());
    if (const float full = format.empty() ? 0 : FormOf(format).fullVertexLight; full > 0)
        ImportVertexLight(folder / kVertexLightFile, full, bsp, log);
}

} // namespace q3
