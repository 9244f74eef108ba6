// GPL-2.0-or-later. The archive in a report.
#include "common/files/archive.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "q3map2/shreport/report_page.h"
#include "tests/support/game_folder.h"
#include "tests/support/small_bsp.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

/// SmallBsp as base/maps/x.bsp. It draws the shader textures/base/wall and a fog without a script.
class ReportPackageTest : public testing::Test {
  protected:
    void Put(std::string_view name, std::string_view text) { folder_.Write("base/" + std::string(name), text); }
    /// A TGA of one color.
    void PutImage(std::string_view name, int width, int height, int alpha = 255) {
        std::vector<std::uint8_t> texels;
        for (int i = 0; i < width * height; ++i)
            for (const int value : {200, 100, 50, alpha})
                texels.push_back(std::uint8_t(value));
        folder_.Write("base/" + std::string(name), EncodeTga(texels, width, height, 4, TgaRows::TopFirst));
    }

    std::vector<std::byte> Package(int textureSize = 128, int threads = 1) {
        folder_.Write("base/maps/x.bsp", Bytes(bsp_));
        VirtualFileSystem vfs(log_.log);
        vfs.Mount(folder_ / "base", "pk3");
        const PackageSource source(vfs, {folder_ / "base"}, {});
        const EngineScripts scripts = ReadScripts(source, Quake3(), log_.log);
        return MakeReportPackage({folder_ / "base/maps/x.bsp", bsp_, Quake3(), source, scripts}, textureSize,
                                 JobPool(threads), log_.log);
    }
    Archive Opened(const std::vector<std::byte> &package) {
        folder_.Write("x.pk3", package);
        return Archive(folder_ / "x.pk3");
    }
    static Image Texture(const Archive &archive, const std::string &name) {
        return DecodeImage(archive.Read(name), name);
    }

    GameFolder folder_;
    KeptLog log_;
    Bsp bsp_ = SmallBsp();
};

TEST_F(ReportPackageTest, HoldsTheMapAndWhatIsBesideIt) {
    Put("maps/x.prt", "PRT1");
    Put("maps/x.lin", "0 0 0");
    Put("maps/x.sherror.json", "{}");
    Put("maps/x.unexplained.json", "{}");
    Put("maps/x.aas", "EAAS");
    Put("maps/x/lm_0000.tga", "page");
    Put("maps/x/vertlight.raw", "light");
    const Archive archive = Opened(Package());
    std::vector<std::string> names = archive.Names();
    std::ranges::sort(names);
    EXPECT_THAT(names, ElementsAre("maps/x.bsp", "maps/x.lin", "maps/x.prt", "maps/x.sherror.json",
                                   "maps/x.unexplained.json", "maps/x/lm_0000.tga"));
    EXPECT_EQ(archive.Read("maps/x.bsp"), Bytes(bsp_));
    EXPECT_EQ(AsText(archive.Read("maps/x/lm_0000.tga")), "page");
}

TEST_F(ReportPackageTest, ShadersAreThoseOfTheMapAlone) {
    Put("scripts/my.shader", "textures/base/wall\n{\n\t{\n\t\tmap textures/brick.jpg\n\t}\n}\n"
                             "textures/base/floor\n{\n\t{\n\t\tmap textures/stone.tga\n\t}\n}\n");
    PutImage("textures/brick.tga", 8, 8);
    PutImage("textures/stone.tga", 8, 8);
    const Archive archive = Opened(Package());
    const auto bytes = archive.Read("scripts/x.shader");
    EXPECT_THAT(std::string(AsText(bytes)), HasSubstr("textures/base/wall\n{"));
    EXPECT_THAT(std::string(AsText(bytes)), HasSubstr("map textures/brick.tga"));
    EXPECT_THAT(std::string(AsText(bytes)), Not(HasSubstr("floor")));
    EXPECT_TRUE(archive.Contains("textures/brick.jpg"));
    EXPECT_FALSE(archive.Contains("textures/stone.jpg"));
}

TEST_F(ReportPackageTest, ExternalLightmapsOfShadersAreNotReduced) {
    Put("scripts/q3map2_x.shader", "textures/base/wall\n{\n\t{\n\t\tmap maps/x/lm_0000.tga\n\t}\n}\n");
    PutImage("maps/x/lm_0000.tga", 512, 512);
    const Archive archive = Opened(Package());
    EXPECT_EQ(Texture(archive, "maps/x/lm_0000.tga").width, 512);
    EXPECT_FALSE(archive.Contains("maps/x/lm_0000.jpg"));
}

TEST_F(ReportPackageTest, TexturesAreReduced) {
    PutImage("textures/base/wall.tga", 512, 256);
    PutImage("textures/fog.tga", 64, 300, 128);
    const Archive archive = Opened(Package());
    const Image wall = Texture(archive, "textures/base/wall.jpg"), fog = Texture(archive, "textures/fog.png");
    EXPECT_EQ(wall.width, 128);
    EXPECT_EQ(wall.height, 64);
    EXPECT_NEAR(wall.Texel(5, 5)[0], 200, 3);
    EXPECT_NEAR(wall.Texel(5, 5)[2], 50, 3);
    EXPECT_EQ(fog.height, 128);
    EXPECT_EQ(fog.width, 27);
    EXPECT_THAT(fog.Texel(9, 9), ElementsAre(200, 100, 50, 128)) << "alpha is kept";
    EXPECT_EQ(Texture(Opened(Package(32)), "textures/base/wall.jpg").width, 32);
    EXPECT_EQ(Texture(Opened(Package(1024)), "textures/base/wall.jpg").width, 512) << "not enlarged";
    EXPECT_FALSE(Opened(Package(0)).Contains("textures/base/wall.jpg"));
}

TEST_F(ReportPackageTest, MissingAndDamagedTexturesAreWarnings) {
    Put("textures/base/wall.tga", "no image");
    const Archive archive = Opened(Package());
    EXPECT_THAT(archive.Names(), ElementsAre("maps/x.bsp"));
    EXPECT_EQ(log_.log.WarningTotals()["damaged texture"], 1);
    EXPECT_EQ(log_.log.WarningTotals()["missing texture"], 1);
    EXPECT_THAT(log_.text, HasSubstr("textures/base/wall.tga"));
    EXPECT_THAT(log_.text, HasSubstr("textures/fog"));
}

TEST_F(ReportPackageTest, BytesDoNotDependOnThreads) {
    std::string script = "textures/base/wall\n{\n";
    for (int i = 0; i < 20; ++i) {
        PutImage(fmt::format("textures/stage{}.tga", i), 100 + 7 * i, 90, i % 3 == 0 ? 100 : 255);
        script += fmt::format("\t{{\n\t\tmap textures/stage{}.tga\n\t}}\n", i);
    }
    Put("scripts/my.shader", script + "}\n");
    const auto package = Package(64, 1);
    EXPECT_THAT(Opened(package).Names(), IsSupersetOf({"textures/stage0.png", "textures/stage19.jpg"}));
    EXPECT_EQ(Package(64, 1), package);
    for (const int threads : {2, 5})
        EXPECT_EQ(Package(64, threads), package) << threads;
}

} // namespace

} // namespace q3::test
