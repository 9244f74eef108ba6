// GPL-2.0-or-later. Lightmap pages and generated shaders as files beside the map.
#include "q3map2/lightmap/store/lightmap_pages.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "common/text/counted.h"
#include "q3map2/lightmap/store/hdr_pages.h"

#include <algorithm>
#include <system_error>

namespace q3 {

namespace {

std::filesystem::path PageFile(const std::filesystem::path &folder, int number) {
    return folder / fmt::format("lm_{:04}.tga", number);
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

void WritePages(const std::filesystem::path &folder, const StoredLightmaps &stored, Log &log) {
    int next = 0;
    long long written = 0;
    for (const LightmapPage &page : stored.pages) {
        next = page.file + (page.directions.empty() ? 1 : 2);
        if (!page.needsImage)
            continue;
        if (written == 0)
            MakeFolder(folder);
        if (!page.colors.empty())
            ReplaceFile(PageFile(folder, page.file),
                        EncodeTga(page.colors, page.width, page.height, 3, TgaRows::TopFirst));
        if (!page.directions.empty())
            ReplaceFile(PageFile(folder, page.file + 1),
                        EncodeTga(page.directions, page.width, page.height, 3, TgaRows::TopFirst));
        written += page.directions.empty() ? 1 : 2;
    }
    if (written == 0)
        return;
    log.Print("Wrote {} to {}\n", Counted((long long)(written), "lightmaps"), folder.string());
    std::error_code ignored;
    while (std::filesystem::remove(PageFile(folder, next), ignored))
        ++next;
}

std::filesystem::path ScriptPath(const std::filesystem::path &bspPath, const Game &game) {
    const auto name = fmt::format("q3map2_{}.shader", bspPath.stem().string());
    return bspPath.parent_path().parent_path() / game.shaderDir / name;
}

void WriteScript(const std::filesystem::path &script, const StoredLightmaps &stored, Log &log) {
    if (stored.scripts.empty()) {
        std::error_code ignored;
        std::filesystem::remove(script, ignored);
        return;
    }
    std::string text = "// Made by the light stage for this map, and replaced when it is lit again.\n";
    for (const StoredLightmaps::Script &one : stored.scripts)
        text += fmt::format("\n{}\n{}{}", one.shader, one.text, one.text.ends_with('\n') ? "" : "\n");
    MakeFolder(script.parent_path());
    ReplaceTextFile(script, text);
    log.Print("Wrote {} to {}\n", Counted((long long)(stored.scripts.size()), "shaders"), script.string());
}

void ExportLightmaps(const Bsp &bsp, int side, const std::filesystem::path &folder, Log &log,
                     const ExportOptions &options) {
    const std::size_t bytes = PageBytes(side), pages = bsp.lightmaps.size() / bytes;
    if (pages == 0 && !HasHdrPages(bsp)) {
        log.Warn("no lightmaps", "the map has no lightmaps to export");
        return;
    }
    MakeFolder(folder);
    for (std::size_t i = 0; i < pages; ++i)
        ReplaceFile(ExportedFile(folder, i),
                    EncodeTga(std::span(bsp.lightmaps).subspan(i * bytes, bytes), side, side, 3, TgaRows::BottomFirst));
    if (pages > 0)
        log.Print("Wrote {} to {}\n", Counted((long long)(pages), "lightmaps"), folder.string());
    ExportHdrLight(bsp, side, folder, options.hdrFormat, log);
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
    log.Print("Read {} of {} from {}\n", replaced, Counted((long long)(pages), "lightmaps"), folder.string());
}

} // namespace q3
