// GPL-2.0-or-later. Lightmap pages and generated shaders as files beside the map, and the options of -export and
// -import.
#include "q3map2/lightmap/store/lightmap_pages.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "libs/math/packed_color.h"
#include "q3map2/lightmap/store/hdr_store.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <system_error>

namespace q3 {

// ---- Options of the stages -export and -import ----

std::vector<SettingGroup<ExportOptions>> ExportSettings() {
    return {
        {"HDR light",
         "This option concerns maps with the BSPX lumps `LIGHTING_E5BGR9` or `LIGHTING_RNM`, see "
         "[BSP format](bsp_format.md).",
         {{{.name = "-hdrformat",
            .values = "exr|pfm|hdr|exp32|rend2|ioquake3",
            .kind = SettingKind::Choice,
            .initial = "-export: exr, or pfm if built without OpenEXR; -import: each format that exists",
            .help = "Selects the format of the images of HDR lightmaps",
            .details =
                "The formats `exr` and `pfm` hold the values of a map exactly. The Radiance format `hdr` holds them "
                "to 1/256 of the largest channel. In these three, 1 is full light, and the picture is upside down, "
                "as the `.tga` is. The formats `rend2` and `ioquake3` are the files `lm_NNNN.hdr` and "
                "`vertlight.raw` that OpenJK and ioquake3 load. The format `exp32` is JSON for tools of Source, "
                "with `width`, `height` and `texels`. Each texel is `[r, g, b, exponent]`, where a channel is byte * "
                "2^exponent, and 255 is full light. Row 0 of the page comes first.",
            .since = "0.2.0",
            .example = "pfm"},
           &ExportOptions::hdrFormat}}}};
}

ExportOptions ParseExportOptions(Arguments &arguments, Log &log) {
    ExportOptions options;
    TakeSettings(ExportSettings(), options, arguments, log);
    return options;
}

// ---- Lightmaps as JSON of ColorRGBExp32 ----

namespace {

using nlohmann::json;

/// The value as an integer in low..high; `what` names it in the error.
int IntegerOf(const json &value, int low, int high, std::string_view what, std::string_view name) {
    if (!value.is_number_integer() || value < low || value > high)
        throw Error("{}: {}: expected an integer in {}..{}", name, what, low, high);
    return value.get<int>();
}

const json &MemberOf(const json &object, const char *member, std::string_view name) {
    if (!object.is_object() || !object.contains(member))
        throw Error("{}: {}: missing", name, member);
    return object.at(member);
}

} // namespace

std::vector<std::byte> EncodeExp32Json(const FloatImage &image) {
    std::string text =
        fmt::format("{{\n    \"width\": {},\n    \"height\": {},\n    \"texels\": [\n", image.width, image.height);
    for (std::size_t i = 0; i < image.texels.size(); ++i) {
        const ColorRgbExp32 code = EncodeRgbExp32(image.texels[i]);
        fmt::format_to(std::back_inserter(text), "        [{}, {}, {}, {}]{}\n", code.r, code.g, code.b,
                       int(code.exponent), i + 1 < image.texels.size() ? "," : "");
    }
    text += "    ]\n}\n";
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

FloatImage DecodeExp32Json(std::span<const std::byte> file, std::string_view name) {
    const json document = json::parse(AsText(file), nullptr, false);
    if (document.is_discarded())
        throw Error("{}: not valid JSON", name);
    constexpr int kMaxSide = 16384; // texels
    FloatImage image;
    image.width = IntegerOf(MemberOf(document, "width", name), 1, kMaxSide, "width", name);
    image.height = IntegerOf(MemberOf(document, "height", name), 1, kMaxSide, "height", name);
    const json &texels = MemberOf(document, "texels", name);
    const std::size_t count = std::size_t(image.width) * std::size_t(image.height);
    if (!texels.is_array() || texels.size() != count)
        throw Error("{}: texels: expected an array of {} x {}", name, image.width, image.height);
    for (const json &texel : texels) {
        if (!texel.is_array() || texel.size() != 4)
            throw Error("{}: texels: expected [r, g, b, exponent] for each", name);
        const auto byte = [&](std::size_t i) { return std::uint8_t(IntegerOf(texel[i], 0, 255, "texels", name)); };
        image.texels.push_back(
            DecodeRgbExp32({byte(0), byte(1), byte(2), std::int8_t(IntegerOf(texel[3], -128, 127, "texels", name))}));
    }
    return image;
}

// ---- Lightmap pages and generated shaders as files beside the map ----

namespace {

std::filesystem::path PageFile(const std::filesystem::path &folder, int number) {
    return folder / (PageImageName(number) + ".tga");
}

std::filesystem::path ExportedFile(const std::filesystem::path &folder, std::size_t number) {
    return folder / fmt::format("lightmap_{:04}.tga", number);
}

bool HasHdrPages(const Bsp &bsp) {
    return !bsp.lightmapsE5bgr9.empty() || bsp.rnm;
}

std::size_t PageBytes(int side) {
    return 3 * std::size_t(side) * std::size_t(side);
}

} // namespace

void AddPages(const std::filesystem::path &folder, const StoredLightmaps &stored, FileSet &written, Log &log) {
    int next = 0;
    long long count = 0;
    for (const LightmapPage &page : stored.pages) {
        next = page.file + (page.directions.empty() ? 1 : 2);
        if (!page.needsImage)
            continue;
        if (count == 0)
            written.AddFolder(folder);
        if (!page.colors.empty())
            written.AddFile(PageFile(folder, page.file),
                            EncodeTga(page.colors, page.width, page.height, 3, TgaRows::TopFirst));
        if (!page.directions.empty())
            written.AddFile(PageFile(folder, page.file + 1),
                            EncodeTga(page.directions, page.width, page.height, 3, TgaRows::TopFirst));
        count += page.directions.empty() ? 1 : 2;
    }
    if (count == 0)
        return;
    written.AddLine(log, fmt::format("Wrote {} to {}\n", Counted(count, "lightmaps"), folder.string()));
    std::error_code ignored;
    for (; std::filesystem::exists(PageFile(folder, next), ignored); ++next)
        written.AddRemoval(PageFile(folder, next));
}

std::filesystem::path ScriptPath(const std::filesystem::path &bspPath, const Game &game) {
    const auto name = fmt::format("q3map2_{}.shader", bspPath.stem().string());
    return bspPath.parent_path().parent_path() / game.shaderDir / name;
}

void AddScript(const std::filesystem::path &script, const StoredLightmaps &stored, FileSet &written, Log &log) {
    if (stored.scripts.empty())
        return written.AddRemoval(script);
    std::string text = "// Made by the light stage for this map, and replaced when it is lit again.\n";
    for (const StoredLightmaps::Script &one : stored.scripts)
        text += fmt::format("\n{}\n{}{}", one.shader, one.text, one.text.ends_with('\n') ? "" : "\n");
    written.AddFolder(script.parent_path());
    written.AddText(script, text);
    written.AddLine(log, fmt::format("Wrote {} to {}\n", Counted(stored.scripts.size(), "shaders"), script.string()));
}

void ExportLightmaps(const Bsp &bsp, int side, const std::filesystem::path &folder, Log &log,
                     const ExportOptions &options) {
    const std::size_t bytes = PageBytes(side), pages = bsp.lightmaps.size() / bytes;
    if (pages == 0 && !HasHdrPages(bsp)) {
        log.Warn("no lightmaps", "the map has no lightmaps to export");
        return;
    }
    FileSet written;
    written.AddFolder(folder);
    for (std::size_t i = 0; i < pages; ++i)
        written.AddFile(ExportedFile(folder, i), EncodeTga(std::span(bsp.lightmaps).subspan(i * bytes, bytes), side,
                                                           side, 3, TgaRows::BottomFirst));
    if (pages > 0)
        written.AddLine(log, fmt::format("Wrote {} to {}\n", Counted(pages, "lightmaps"), folder.string()));
    AddHdrExport(bsp, side, folder, options.hdrFormat, written, log);
    written.Commit();
}

void ImportLightmaps(Bsp &bsp, int side, const std::filesystem::path &folder, Log &log, const ExportOptions &options) {
    const std::size_t bytes = PageBytes(side), pages = bsp.lightmaps.size() / bytes;
    if (pages == 0 && !HasHdrPages(bsp))
        throw Error("the map has no lightmaps to replace");
    ImportHdrLight(bsp, side, folder, options.hdrFormat, log);
    if (pages == 0)
        return;
    std::size_t replaced = 0;
    for (std::size_t i = 0; i < pages; ++i) {
        const auto path = ExportedFile(folder, i);
        std::error_code ignored;
        if (!std::filesystem::exists(path, ignored)) {
            log.Warn("lightmap image missing", "{}: not found; this lightmap stays", path.string());
            continue;
        }
        const Image image = DecodeTga(ReadFile(path), path.string());
        if (image.width != side || image.height != side) {
            log.Warn("lightmap image size", "{}: {} x {}, expected {} x {}; this lightmap stays", path.string(),
                     image.width, image.height, side, side);
            continue;
        }
        // The bottom row of the picture is the first one of the page.
        std::uint8_t *to = bsp.lightmaps.data() + i * bytes;
        for (int y = side - 1; y >= 0; --y)
            for (int x = 0; x < side; ++x, to += 3) {
                const auto texel = image.Texel(x, y);
                std::copy_n(texel.begin(), 3, to);
            }
        ++replaced;
    }
    log.Print("Read {} of {} from {}\n", replaced, Counted(pages, "lightmaps"), folder.string());
}

} // namespace q3
