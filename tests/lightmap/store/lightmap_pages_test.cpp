// GPL-2.0-or-later. Pages and made shaders as files.
#include "q3map2/lightmap/store/lightmap_pages.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "tests/support/game_folder.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

LightmapPage Page(int file, int width, int height, bool deluxe, bool needsImage = true) {
    LightmapPage page;
    page.width = width, page.height = height, page.file = file, page.needsImage = needsImage;
    for (int i = 0; i < 3 * width * height; ++i)
        page.colors.push_back(std::uint8_t(i * 7 + file));
    if (deluxe)
        page.directions.assign(page.colors.rbegin(), page.colors.rend());
    return page;
}

std::vector<std::uint8_t> ReadPage(const std::filesystem::path &path, int &width, int &height) {
    const Image image = DecodeTga(ReadFile(path), path.string());
    width = image.width, height = image.height;
    std::vector<std::uint8_t> rgb;
    for (std::size_t i = 0; i < image.rgba.size(); ++i)
        if (i % 4 != 3)
            rgb.push_back(image.rgba[i]);
    return rgb;
}

/// Calls add(set of files), and writes the set.
template <typename Add> void Write(const Add &add) {
    FileSet files;
    add(files);
    files.Commit();
}

TEST(Pages, ImagesShowThePageAndOlderOnesGo) {
    const GameFolder game;
    KeptLog log;
    for (const auto *stale : {"room/lm_0004.tga", "room/lm_0005.tga", "room/lm_0007.tga"})
        game.Write(stale, "old");
    StoredLightmaps stored;
    stored.pages = {Page(0, 64, 16, true), Page(2, 32, 32, true)};
    Write([&](FileSet &files) { AddPages(game / "room", stored, files, log.log); });
    for (const LightmapPage &page : stored.pages) {
        int width = 0, height = 0;
        EXPECT_EQ(ReadPage(game / fmt::format("room/lm_{:04}.tga", page.file), width, height), page.colors);
        EXPECT_EQ(ReadPage(game / fmt::format("room/lm_{:04}.tga", page.file + 1), width, height), page.directions);
        EXPECT_EQ(width, page.width);
        EXPECT_EQ(height, page.height);
    }
    EXPECT_FALSE(std::filesystem::exists(game / "room/lm_0004.tga"));
    EXPECT_FALSE(std::filesystem::exists(game / "room/lm_0005.tga"));
    EXPECT_TRUE(std::filesystem::exists(game / "room/lm_0007.tga")) << "behind a gap: not ours";
}

TEST(Pages, PagesOfTheFileAreNoImages) {
    const GameFolder game;
    KeptLog log;
    game.Write("room/lm_0000.tga", "mine");
    StoredLightmaps stored;
    stored.pages = {Page(0, 128, 128, false, false)};
    Write([&](FileSet &files) { AddPages(game / "room", stored, files, log.log); });
    EXPECT_EQ(game.ReadBack("room/lm_0000.tga"), "mine");
    Write([&](FileSet &files) { AddPages(game / "other", stored, files, log.log); });
    EXPECT_FALSE(std::filesystem::exists(game / "other"));
}

TEST(Pages, ScriptIsBesideTheMapAndGoesWhenNotNeeded) {
    const GameFolder game;
    KeptLog log;
    const auto path = ScriptPath(game / "maps/room.bsp", *FindGame("quake3"));
    EXPECT_EQ(path, game / "scripts/q3map2_room.shader");
    StoredLightmaps stored;
    stored.scripts = {{"room/A", "{\n\tcull none\n}\n"}, {"room/B", "{\n}"}};
    Write([&](FileSet &files) { AddScript(path, stored, files, log.log); });
    const std::string text = game.ReadBack("scripts/q3map2_room.shader");
    EXPECT_TRUE(text.starts_with("//"));
    EXPECT_THAT(text, testing::HasSubstr("\nroom/A\n{\n\tcull none\n}\n\nroom/B\n{\n}\n"));
    Write([&](FileSet &files) { AddScript(path, {}, files, log.log); });
    EXPECT_FALSE(std::filesystem::exists(path));
    Write([&](FileSet &files) { AddScript(path, {}, files, log.log); });
}

Bsp WithPages(std::size_t bytes) {
    Bsp bsp;
    for (std::size_t i = 0; i < bytes; ++i)
        bsp.lightmaps.push_back(std::uint8_t(i * 2654435761u >> 13));
    return bsp;
}

TEST(Pages, ExportThenImportChangesNothing) {
    const GameFolder game;
    KeptLog log;
    const Bsp before = WithPages(3 * 128 * 128 * 3);
    ExportLightmaps(before, 128, game / "room", log.log);
    Bsp after = before;
    std::fill(after.lightmaps.begin(), after.lightmaps.end(), std::uint8_t(0));
    ImportLightmaps(after, 128, game / "room", log.log);
    EXPECT_EQ(before.lightmaps, after.lightmaps);
    // 18 bytes of header: uncompressed color, 128 x 128, 24 bit; then rows as they are in the file, blue first.
    const std::string file = game.ReadBack("room/lightmap_0002.tga");
    EXPECT_EQ(file.substr(0, 18), std::string("\0\0\2\0\0\0\0\0\0\0\0\0\200\0\200\0\30\0", 18));
    EXPECT_EQ(std::uint8_t(file[18]), before.lightmaps[2 * 128 * 128 * 3 + 2]);
}

TEST(Pages, ImportKeepsWhatHasNoFittingImage) {
    const GameFolder game;
    KeptLog log;
    Bsp bsp = WithPages(3 * 16 * 16 * 3);
    const Bsp before = bsp;
    ExportLightmaps(WithPages(3 * 32 * 32), 32, game / "room", log.log); // lightmap_0000 of another size
    ExportLightmaps(WithPages(3 * 16 * 16), 16, game / "small", log.log);
    std::filesystem::copy(game / "small/lightmap_0000.tga", game / "room/lightmap_0001.tga");
    std::fill(bsp.lightmaps.begin(), bsp.lightmaps.end(), std::uint8_t(9));
    ImportLightmaps(bsp, 16, game / "room", log.log);
    EXPECT_EQ(bsp.lightmaps[0], 9);
    EXPECT_EQ(bsp.lightmaps[2 * 16 * 16 * 3], 9);
    EXPECT_TRUE(std::equal(before.lightmaps.begin(), before.lightmaps.begin() + 16 * 16 * 3,
                           bsp.lightmaps.begin() + 16 * 16 * 3));
    EXPECT_EQ(log.log.WarningCount("lightmap image size"), 1);
    EXPECT_EQ(log.log.WarningCount("lightmap image missing"), 1);
}

TEST(Pages, NothingToExportWarnsAndNothingToReplaceFails) {
    const GameFolder game;
    KeptLog log;
    Bsp bsp;
    ExportLightmaps(bsp, 128, game / "room", log.log);
    EXPECT_EQ(log.log.WarningCount("no lightmaps"), 1);
    EXPECT_FALSE(std::filesystem::exists(game / "room"));
    EXPECT_THROW(ImportLightmaps(bsp, 128, game / "room", log.log), Error);
}

} // namespace

} // namespace q3::test
