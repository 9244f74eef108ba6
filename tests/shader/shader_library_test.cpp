// GPL-2.0-or-later. Finding scripts, shaders, images and colors.
#include "common/files/files.h"
#include "q3map2/shader/image_formats.h"
#include "tests/support/library_fixture.h"

#include <turbojpeg.h>

#include <gmock/gmock.h>

namespace q3 {
namespace {

using test::kDust, test::kSlick;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

using ScriptDiscovery = test::LibraryTest;
using ShaderLookUp = test::LibraryTest;
using ShaderImages = test::LibraryTest;
using ShaderColors = test::LibraryTest;

std::string Entry(std::string_view name, std::string_view parm) {
    return fmt::format("{}\n{{\nsurfaceparm {}\n}}\n", name, parm);
}

TEST_F(ScriptDiscovery, ListsOfAllFoldersAreReadAndNothingElse) {
    folder.Write("scripts/shaderlist.txt", "one // comment\nOne.shader\ntwo.shader\n");
    folder.WriteArchive("a.pk3", {{"scripts/shaderlist.txt", "three"}, {"scripts/three.shader", Entry("c", "slick")}});
    folder.Write("scripts/one.shader", Entry("a", "slick"));
    folder.Write("scripts/two.shader", Entry("b", "slick"));
    folder.Write("scripts/four.shader", Entry("d", "slick"));
    Load();
    EXPECT_TRUE(Get("a").defined && Get("b").defined && Get("c").defined);
    EXPECT_FALSE(Get("d").defined);
    EXPECT_EQ(library->DefinedCount(), 3u);
}

TEST_F(ScriptDiscovery, AShaderOfAnUnlistedScriptIsNamedWithIt) {
    folder.Write("scripts/shaderlist.txt", "one\n");
    folder.Write("scripts/one.shader", Entry("textures/a", "slick"));
    folder.Write("scripts/Mine.shader", Entry("textures/b", "slick"));
    folder.Write("scripts/q3map2_x.shader", Entry("textures/c", "slick"));
    Load();
    for (const char *name : {"textures/a", "textures/c", "textures/none"})
        Get(name);
    EXPECT_EQ(Warnings("script not listed"), 0);
    Get("Textures/B");
    EXPECT_THAT(out.text,
                HasSubstr("shader Textures/B: scripts/Mine.shader defines it, but that script is not read, because "
                          "scripts/shaderlist.txt does not list it"));
}

TEST_F(ScriptDiscovery, WithoutAListAllScriptsAreReadByName) {
    folder.Write("scripts/b.shader", Entry("x", "dust"));
    folder.WriteArchive("a.pk3",
                        {{"scripts/a.shader", Entry("x", "slick")}, {"scripts/deep/c.shader", Entry("y", "slick")}});
    Load();
    EXPECT_EQ(Get("x").surfaceFlags, kSlick);
    EXPECT_FALSE(Get("y").defined);
    EXPECT_THAT(out.text, HasSubstr("shaderlist.txt"));
}

TEST_F(ScriptDiscovery, MissingScriptIsAWarningOfOneKind) {
    folder.Write("scripts/shaderlist.txt", "gone\nalsogone\nhere\n");
    folder.Write("scripts/here.shader", Entry("a", "slick"));
    Load();
    EXPECT_TRUE(Get("a").defined);
    EXPECT_EQ(Warnings("shader script not found"), 2);
}

TEST_F(ScriptDiscovery, OfADamagedListTheNamesBeforeTheDamageCount) {
    folder.Write("scripts/shaderlist.txt", "here\n" + std::string(2000, 'x') + "\ngone\n");
    folder.Write("scripts/here.shader", Entry("a", "slick"));
    folder.Write("scripts/unlisted.shader", Entry("b", "slick"));
    Load();
    EXPECT_TRUE(Get("a").defined);
    EXPECT_FALSE(Get("b").defined);
    EXPECT_EQ(Warnings("damaged shader list"), 1);
    EXPECT_THAT(out.text, HasSubstr("shaderlist.txt:2: a token of 2000 bytes"));
}

TEST_F(ScriptDiscovery, NothingAtAllIsFine) {
    Load();
    EXPECT_EQ(library->DefinedCount(), 0u);
    EXPECT_EQ(Get("textures/a").name, "textures/a");
}

TEST_F(ShaderLookUp, CaseAndExtensionDoNotMatter) {
    LoadScript(Entry("textures/Base/Wall", "slick"));
    EXPECT_EQ(Get("TEXTURES/base/wall.tga").surfaceFlags, kSlick);
    EXPECT_EQ(&Get("textures/base/WALL"), &Get("textures/Base/Wall.jpg"));
    EXPECT_EQ(Get("textures/base/wall").name, "textures/Base/Wall");
}

TEST_F(ShaderLookUp, FirstDefinitionWins) {
    LoadScript(Entry("a", "slick") + Entry("A", "dust"));
    EXPECT_EQ(Get("a").surfaceFlags, kSlick);
    EXPECT_EQ(library->DefinedCount(), 1u);
}

TEST_F(ShaderLookUp, DefinitionWithAnExtensionIsNeverFound) {
    LoadScript(Entry("foo.tga", "slick"));
    EXPECT_FALSE(Get("foo.tga").defined);
    EXPECT_FALSE(Get("foo").defined);
}

TEST_F(ShaderLookUp, DotInAFolderNameIsNoExtension) {
    LoadScript(Entry("a.b/c", "slick"));
    EXPECT_TRUE(Get("a.b/c").defined);
    EXPECT_TRUE(Get("a.b/c.tga").defined);
}

TEST_F(ShaderLookUp, UnknownNamesGiveImplicitShadersAsFirstSpelled) {
    Load();
    const ShaderInfo &first = Get("textures/New.tga");
    EXPECT_EQ(first.name, "textures/New");
    EXPECT_FALSE(first.defined);
    EXPECT_EQ(first.compileFlags, std::uint32_t(C_SOLID));
    EXPECT_EQ(&Get("TEXTURES/NEW"), &first);
    EXPECT_EQ(Get("").name, "missing");
    EXPECT_EQ(Warnings("shader without a name"), 1);
}

TEST_F(ShaderLookUp, ReferencesStayValid) {
    Load();
    const ShaderInfo &first = Get("first");
    for (int i = 0; i < 1000; ++i)
        Get(fmt::format("other{}", i));
    EXPECT_EQ(&Get("first"), &first);
    EXPECT_EQ(first.name, "first");
}

// One image per color, so that the color tells which file was taken.
class LightImage : public test::LibraryTest {
  protected:
    void SetUp() override {
        WriteTga("red.tga", {{200, 0, 0, 255}});
        WriteTga("green.tga", {{0, 200, 0, 255}});
        WriteTga("blue.tga", {{0, 0, 200, 255}});
        WriteTga("env/sky_up.tga", {{200, 200, 0, 255}});
    }
    Vec3f ColorOf(std::string_view body) { return LoadShader(body).color; }

    static constexpr Vec3f kRed{1, 0, 0}, kGreen{0, 1, 0}, kBlue{0, 0, 1}, kYellow{1, 1, 0}, kWhite{1, 1, 1};
};

TEST_F(LightImage, FirstStageImageCountsUnlessAnotherWasNamed) {
    EXPECT_EQ(ColorOf("{\nmap $lightmap\n}\n{\nmap *white\n}\n{\nclampMap red.tga\n}\n{\nmap green.tga\n}"), kRed);
    EXPECT_EQ(ColorOf("{\nmap red.tga\n}\nqer_editorImage green.tga"), kRed);
    EXPECT_EQ(ColorOf("qer_editorImage green.tga\n{\nmap red.tga\n}"), kGreen);
    EXPECT_EQ(ColorOf("implicitMap blue.tga\n{\nmap red.tga\n}"), kBlue);
    EXPECT_EQ(ColorOf("{\nmap $whiteimage\n}\nqer_editorImage green.tga"), kGreen);
    EXPECT_EQ(ColorOf("{\nmap $lightmap\n}\n{\nrgbGen identity\n}\nqer_editorImage green.tga"), kGreen);
    EXPECT_EQ(ColorOf("{\nmap gone.tga\n}\nqer_editorImage green.tga"), kGreen);
    EXPECT_EQ(ColorOf("q3map_lightImage blue.tga\nqer_editorImage green.tga\n{\nmap red.tga\n}"), kBlue);
    EXPECT_EQ(ColorOf("{\nmap red.tga\n}\nq3map_lightImage blue.tga"), kBlue);
}

TEST_F(LightImage, AnimationsGiveTheirFirstFrame) {
    EXPECT_EQ(ColorOf("{\nanimMap 10 green.tga red.tga blue.tga\n}"), kGreen);
    EXPECT_EQ(ColorOf("{\nclampAnimMap 10 blue.tga red.tga\n}"), kBlue);
    EXPECT_EQ(ColorOf("{\nmapComp red.tga\n}"), kRed);
    EXPECT_EQ(ColorOf("{\nmapNoComp green.tga\n}"), kGreen);
}

TEST_F(LightImage, SkyGivesItsTopImage) {
    EXPECT_EQ(ColorOf("skyParms env/sky 512 -\n{\nmap red.tga\n}"), kYellow);
    EXPECT_EQ(Get("s").skyImageBase, "env/sky");
    EXPECT_EQ(ColorOf("q3map_lightImage blue.tga\nskyParms env/sky - -"), kBlue);
    EXPECT_EQ(ColorOf("skyParms - 512 -\n{\nmap red.tga\n}"), kRed);
    EXPECT_EQ(ColorOf("skyParms FULL 512 -\n{\nmap red.tga\n}"), kRed);
    EXPECT_EQ(Get("s").skyImageBase, "");
    EXPECT_EQ(ColorOf("skyParms env/sky 512\n{\nmap red.tga\n}"), kRed);
}

TEST_F(LightImage, ShaderImageStandsInForAMissingLightImage) {
    EXPECT_EQ(ColorOf("qer_editorImage green.tga\nq3map_lightImage gone.tga"), kGreen);
    EXPECT_EQ(ColorOf("qer_editorImage gone.tga"), kWhite);
    EXPECT_FALSE(Get("s").imageFound);
    WriteTga("s.tga", {{0, 200, 0, 255}});
    EXPECT_EQ(ColorOf("qer_editorImage gone.tga\nimplicitMap red"), kGreen);
    EXPECT_EQ(ColorOf("implicitMask -\n{\nmap red.tga\n}"), kGreen);
    EXPECT_TRUE(Get("s").imageFound);
    EXPECT_EQ(Get("red").color, kRed);
}

TEST_F(LightImage, NodrawShadersReadNone) {
    const ShaderInfo &shader = LoadShader("surfaceparm nodraw\nqer_editorImage red.tga");
    EXPECT_FALSE(shader.imageFound);
    EXPECT_EQ(shader.color, kWhite);
    ASSERT_NE(shader.lightImage, nullptr);
    EXPECT_EQ(shader.lightImage->width, 64);
}

TEST_F(LightImage, BaseShaderBringsItsImages) {
    LoadScript("base\n{\nqer_editorImage red.tga\n}\nnew\n{\nq3map_baseShader base\n{\nmap green.tga\n}\n}\n");
    EXPECT_EQ(Get("new").color, kRed);
}

TEST_F(ShaderImages, TgaBeforePngBeforeJpg) {
    Image image{1, 1, {0, 255, 0, 255}};
    WritePng(folder / "a.png", image);
    WritePng(folder / "b.png", image);
    WriteTga("a.tga", {{255, 0, 0, 255}});
    folder.Write("b.jpg", "no jpeg");
    folder.Write("c.tga", "no tga");
    WritePng(folder / "c.png", image);
    Load();
    EXPECT_THAT(library->LoadImage("a")->rgba, ElementsAre(255, 0, 0, 255));
    EXPECT_THAT(library->LoadImage("b")->rgba, ElementsAre(0, 255, 0, 255));
    EXPECT_EQ(library->LoadImage("A"), library->LoadImage("a"));
    EXPECT_EQ(library->LoadImage("c"), nullptr);
    EXPECT_EQ(library->LoadImage("c"), nullptr);
    EXPECT_EQ(Warnings("damaged image"), 1);
    EXPECT_EQ(library->LoadImage("d"), nullptr);
    EXPECT_EQ(library->LoadImage("../a"), nullptr);
}

/// A KTX file with one RGBA texel.
std::string Ktx(int red, int green, int blue) {
    std::string file("\xABKTX 11\xBB\r\n\x1A\n\1\2\3\4", 16);
    for (const int word : {0x1401, 1, 0x1908, 0x8058, 0x1908, 1, 1, 0, 0, 1, 1, 0, 4})
        file.append(reinterpret_cast<const char *>(&word), 4);
    for (const int channel : {red, green, blue, 255})
        file += char(channel);
    return file;
}

/// A Crunch file of that width and height, with a header alone.
std::string Crn(int side) {
    std::string file(74, '\0');
    file[0] = 'H', file[1] = 'x', file[9] = 74;
    file[12] = file[14] = char(side >> 8), file[13] = file[15] = char(side);
    return file;
}

TEST_F(ShaderImages, FormatsAreTriedInTheOrderOfTheGame) {
    const Image green{1, 1, {0, 255, 0, 255}};
    WriteTga("a.tga", {{255, 0, 0, 255}});
    WritePng(folder / "a.png", green);
    folder.Write("a.ktx", Ktx(0, 0, 255));
    folder.Write("dds/b.dds", "no dds");
    folder.Write("b.ktx", Ktx(0, 0, 255));
    Load();
    EXPECT_THAT(library->LoadImage("a")->rgba, ElementsAre(255, 0, 0, 255));
    EXPECT_THAT(library->LoadImage("b")->rgba, ElementsAre(0, 0, 255, 255));
    Load("unvanquished");
    EXPECT_THAT(library->LoadImage("a")->rgba, ElementsAre(0, 255, 0, 255)) << "PNG first";
    Load("xonotic");
    EXPECT_THAT(library->LoadImage("a")->rgba, ElementsAre(255, 0, 0, 255));
    EXPECT_EQ(library->LoadImage("b"), nullptr) << "the folder dds before";
    EXPECT_EQ(Warnings("damaged image"), 1);
}

TEST_F(ShaderImages, ReadAheadAreThoseThatGetReads) {
    const std::string sky = "sky\n{\nq3map_skylight 100 3\nskyparms env/dusk - -\n}\n";
    WriteTga("env/dusk_up.tga", {{0, 0, 255, 255}});
    WriteTga("lamp.tga", {{200, 100, 50, 255}});
    WriteTga("second.tga", {{0, 255, 0, 255}});
    folder.Write("broken.tga", "no tga");
    folder.Write("odd.crn", Crn(512));
    LoadScript(sky + "lamp\n{\nq3map_surfacelight 100\n}\nwall\n{\nqer_editorImage lamp\n}\n"
                     "other\n{\nq3map_surfacelight 100\nq3map_lightImage absent\nqer_editorImage second\n}\n"
                     "broken\n{\nq3map_surfacelight 100\n}\nodd\n{\nq3map_surfacelight 100\n}\n");
    const std::vector<std::string> names{"sky", "lamp", "wall", "other", "broken", "odd", "unknown"};
    library->ReadAhead(names, JobPool(3));
    EXPECT_EQ(out.text.find("WARNING"), std::string::npos) << "that is for Get";
    // What has been read is not read again.
    for (const char *file : {"env/dusk_up.tga", "lamp.tga", "second.tga"})
        std::filesystem::remove(folder / file);
    EXPECT_EQ(library->Get("lamp").averageColor, Vec3f(200, 100, 50));
    EXPECT_EQ(library->Get("other").averageColor, Vec3f(0, 255, 0));
    ASSERT_NE(library->LoadImage("env/dusk_up"), nullptr);
    EXPECT_FALSE(library->Get("broken").imageFound);
    EXPECT_EQ(Warnings("damaged image"), 1);
    EXPECT_EQ(library->Get("odd").averageColor, Vec3f(128, 128, 128));
    EXPECT_EQ(Warnings("colors of Crunch images"), 1);
}

TEST_F(ShaderImages, CrunchGivesItsSizeAndGray) {
    folder.Write("textures/c.crn", Crn(512));
    options.imageSizes = true;
    Load();
    EXPECT_EQ(library->Get("textures/c").geometry.textureWidth, 512);
    options.imageSizes = false;
    Load();
    EXPECT_EQ(Get("textures/c").averageColor, Vec3f(128, 128, 128));
    EXPECT_EQ(Warnings("colors of Crunch images"), 1);
    EXPECT_THAT(out.text, HasSubstr("c.crn: of .crn files only the size is read, middle gray (128)"));
}

TEST_F(ShaderImages, OpenExrIsNeverOpened) {
    folder.Write("loose.exr", "no matter what");
    folder.WriteArchive("a.pk3", {{"textures/packed.exr", "no matter what"}});
    Load();
    EXPECT_EQ(library->LoadImage("loose"), nullptr);
    EXPECT_FALSE(Get("textures/packed").imageFound);
    EXPECT_EQ(Warnings("OpenEXR image"), 2);
    EXPECT_EQ(Warnings("damaged image"), 0);
    EXPECT_THAT(out.text, HasSubstr("loose.exr: game files in this format are not read; save the image as"));
    EXPECT_EQ(FindImageFormat("a.exr"), nullptr);
    options.imageSizes = true;
    Load();
    EXPECT_EQ(library->Get("textures/packed").geometry.textureWidth, 64);
    EXPECT_EQ(Warnings("OpenEXR image"), 3);
}

TEST_F(ShaderImages, BuiltInDefaultIsWhite) {
    Load();
    const auto image = library->LoadImage("*default");
    ASSERT_NE(image, nullptr);
    EXPECT_EQ(image->width, 64);
    EXPECT_EQ(image->rgba, std::vector<std::uint8_t>(4 * 64 * 64, 255));
    EXPECT_EQ(Get("nothing").lightImage->rgba, image->rgba);
}

std::vector<std::byte> GreyJpeg(int side, int value) {
    const std::vector<unsigned char> rgb(std::size_t(3 * side * side), static_cast<unsigned char>(value));
    unsigned char *out = nullptr;
    unsigned long size = 0;
    tjhandle encoder = tjInitCompress();
    EXPECT_EQ(tjCompress2(encoder, rgb.data(), side, 0, side, TJPF_RGB, &out, &size, TJSAMP_444, 100, 0), 0);
    const auto bytes = std::as_bytes(std::span(out, size));
    std::vector<std::byte> file(bytes.begin(), bytes.end());
    tjFree(out);
    tjDestroy(encoder);
    return file;
}

TEST_F(ShaderImages, AlphaOfAJpegComesFromASecondFileOfTheSameSize) {
    folder.Write("a.jpg", GreyJpeg(8, 200));
    folder.Write("a_alpha.jpg", GreyJpeg(8, 64));
    folder.Write("b.jpg", GreyJpeg(8, 200));
    folder.Write("b_alpha.jpg", GreyJpeg(16, 64));
    Load();
    const auto a = library->LoadImage("a")->Texel(4, 4), b = library->LoadImage("b")->Texel(4, 4);
    EXPECT_NEAR(a[0], 200, 2);
    EXPECT_NEAR(a[3], 64, 2);
    EXPECT_EQ(b[3], 255);
}

TEST_F(ShaderImages, NothingIsReadBeforeTheLookUp) {
    folder.Write("broken.tga", "no tga");
    LoadScript("a\n{\nqer_editorImage broken.tga\n}\n");
    EXPECT_EQ(Warnings("damaged image"), 0);
    EXPECT_FALSE(Get("a").imageFound);
    EXPECT_EQ(Warnings("damaged image"), 1);
}

TEST_F(ShaderImages, MissingImageIsToldOnlyWhenVerbose) {
    Load();
    Get("quiet");
    EXPECT_THAT(out.text, Not(HasSubstr("quiet")));
    out.log.SetVerbose(true);
    Get("loud");
    EXPECT_THAT(out.text, HasSubstr("shader loud: couldn't find image"));
}

TEST_F(ShaderColors, MeanOfTheImageIsNotDecoded) {
    WriteTga("a.tga", {{100, 40, 0, 0}, {60, 40, 20, 255}});
    for (const bool sRgb : {false, true}) {
        options.sRgbColor = sRgb;
        Load();
        EXPECT_EQ(Get("a").averageColor, (Vec3f{80, 40, 10}));
        EXPECT_EQ(Get("a").color, (Vec3f{1, 0.5f, 0.125f}));
    }
}

TEST_F(ShaderColors, BlackEmitsWhite) {
    WriteTga("black.tga", {{0, 0, 0, 255}});
    LoadScript("s\n{\nq3map_lightRGB 0 0 0\nqer_editorImage black.tga\n}\n");
    EXPECT_EQ(Get("black").color, (Vec3f{1, 1, 1}));
    EXPECT_EQ(Get("black").averageColor, (Vec3f{0, 0, 0}));
    EXPECT_EQ(Get("s").color, (Vec3f{1, 1, 1}));
    EXPECT_EQ(Get("s").averageColor, (Vec3f{255, 255, 255}));
}

TEST_F(ShaderColors, GivenColorReplacesTheImages) {
    WriteTga("a.tga", {{100, 40, 0, 0}});
    EXPECT_EQ(LoadShader("q3map_lightRGB 2 1 0.5\nq3map_lightImage a").color, (Vec3f{1, 0.5f, 0.25f}));
    EXPECT_EQ(Get("s").averageColor, (Vec3f{255, 127.5f, 63.75f}));
    EXPECT_EQ(Get("s").lightImage->Texel(0, 0)[0], 100);
    options.sRgbColor = true;
    EXPECT_NEAR(LoadShader("q3map_lightRGB 1 0.5 0").color.y, 0.214041, 1e-5);
}

TEST(Color, SrgbCurve) {
    EXPECT_EQ(LinearFromSrgb(0), 0);
    EXPECT_NEAR(LinearFromSrgb(1), 1, 1e-6);
    EXPECT_NEAR(LinearFromSrgb(0.5f), 0.2140411, 1e-6);
    EXPECT_NEAR(LinearFromSrgb(0.04f), 0.04 / 12.92, 1e-7);
    for (int i = 0; i <= 255; ++i)
        EXPECT_NEAR(SrgbFromLinear(LinearFromSrgb(float(i) / 255)), float(i) / 255, 1e-5) << i;
}

TEST(Color, LargestComponentBecomesOne) {
    EXPECT_EQ(NormalizeColor({2, 4, 1}), (Vec3f{0.5f, 1, 0.25f}));
    EXPECT_EQ(NormalizeColor({0, 0, 0}), (Vec3f{1, 1, 1}));
    EXPECT_EQ(NormalizeColor({-1, -2, 0}), (Vec3f{1, 1, 1}));
}

class VectorGame : public testing::Test {
  protected:
    VectorGame() { vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3"); }

    test::KeptLog out;
    VirtualFileSystem vfs{out.log};
};

TEST_F(VectorGame, ScriptReadsAsItsLightsExpect) {
    ShaderLibrary library(vfs, *FindGame("quake3"), {}, out.log);
    EXPECT_EQ(library.DefinedCount(), 21u);
    EXPECT_THAT(out.text, Not(HasSubstr("WARNING")));

    const ShaderInfo &lite = library.Get("textures/vec/lite_sub");
    EXPECT_EQ(lite.surfaceLight, 600);
    EXPECT_EQ(lite.color, (Vec3f{1, 0.8f, 0.5f}));
    EXPECT_EQ(lite.lightSubdivide, 100);
    EXPECT_EQ(lite.backsplashFraction, 0);

    const ShaderInfo &textured = library.Get("textures/vec/lite_tex");
    EXPECT_TRUE(textured.imageFound);
    EXPECT_EQ(textured.averageColor, (Vec3f{204, 102, 255}));
    EXPECT_EQ(textured.color, (Vec3f{0.8f, 0.4f, 1}));
    EXPECT_FLOAT_EQ(textured.backsplashFraction, 0.1f);
    EXPECT_EQ(textured.lightImage->Texel(1, 2), (std::array<std::uint8_t, 4>{204, 102, 255, 64}));

    const ShaderInfo &sky = library.Get("textures/vec/sky_ext");
    EXPECT_EQ(sky.color, (Vec3f{1, 0.8f, 0.6f}));
    ASSERT_EQ(sky.suns.size(), 1u);
    EXPECT_EQ(sky.suns[0].color, (Vec3f{0.5f, 0.5f, 1}));
    ASSERT_EQ(sky.skyLights.size(), 1u);
    EXPECT_EQ(sky.skyLights[0].horizonMin, 30);
    EXPECT_FALSE(sky.skyLights[0].sampleColor);

    EXPECT_TRUE(library.Get("textures/vec/lite_sprite").autosprite);
    EXPECT_TRUE(library.Get("textures/vec/two_trans").twoSided);
    EXPECT_EQ(library.Get("textures/vec/tinted").bounceScale, 1.5f);
    EXPECT_EQ(library.Get("textures/vec/caulk").compileFlags, std::uint32_t(C_SOLID | C_NODRAW | C_NOMARKS));
    EXPECT_EQ(library.Get("textures/vec/sky_box").skyImageBase, "env/vecsky");
    for (const auto *side : {"_lf", "_rt", "_ft", "_bk", "_up", "_dn"})
        EXPECT_NE(library.LoadImage(std::string("env/vecsky") + side), nullptr) << side;
}

TEST_F(ShaderLookUp, FlagsOfAMapCountForShadersWithoutScript) {
    LoadScript("textures/scripted\n{\n\tsurfaceparm nomarks\n}\n");
    library->SetDefaultFlags("textures/Clip", 0x80, 0x10000);
    library->SetDefaultFlags("textures/cloth", 0xC80, 1); // that of a curve left for collision
    library->SetDefaultFlags("textures/Cloth", 0x20, 1);  // that of what is drawn
    library->SetDefaultFlags("textures/scripted", 0x80, 0x10000);
    library->SetDefaultFlags("noshader", 0, 0);
    EXPECT_EQ(Get("textures/clip").compileFlags, std::uint32_t(C_TRANSLUCENT | C_DETAIL | C_NODRAW));
    EXPECT_EQ(Get("textures/clip").surfaceFlags, 0x80u);
    EXPECT_EQ(Get("textures/clip").contentFlags, 0x10000u);
    EXPECT_FALSE(Get("textures/clip").defined);
    EXPECT_EQ(Get("textures/cloth").compileFlags, std::uint32_t(C_SOLID)) << "not all records are nodraw";
    EXPECT_EQ(Get("textures/scripted").compileFlags, std::uint32_t(C_SOLID | C_NOMARKS));
    EXPECT_EQ(Get("noshader").compileFlags, std::uint32_t(C_SOLID));
}

TEST_F(ShaderImages, SlashesInFrontDoNotMatter) {
    WriteTga("textures/red.tga", {{200, 0, 0, 255}});
    for (const char *name : {"/textures/red.tga", "\\textures\\red", "./textures/red", "textures//red.tga"})
        EXPECT_EQ(LoadShader(fmt::format("{{\nmap {}\n}}", name)).color, (Vec3f{1, 0, 0})) << name;
    EXPECT_TRUE(library->LoadImage("/textures/red"));
    folder.Write("scripts/shaderlist.txt", "/test\n");
    LoadScript(Entry("textures/s", "slick"));
    EXPECT_EQ(Get("/textures/s").surfaceFlags, kSlick);
    EXPECT_EQ(Get("/textures/s").name, "textures/s");
}

TEST_F(ShaderImages, DdsCountsAfterTheOtherFormats) {
    // 8 x 4 texels of 24 bits, green.
    std::string dds = "DDS ";
    dds.resize(128);
    dds[4] = 124, dds[12] = 4, dds[16] = 8, dds[76] = 32, dds[80] = 0x40, dds[88] = 24;
    dds[94] = dds[97] = dds[100] = char(0xFF);
    for (int i = 0; i < 32; ++i)
        dds += std::string("\0\xC8\0", 3);
    folder.Write("textures/t.dds", dds);
    options.imageSizes = true;
    const ShaderInfo &info = LoadShader("qer_editorImage textures/t.tga");
    EXPECT_EQ(info.geometry.textureWidth, 8);
    EXPECT_EQ(info.geometry.textureHeight, 4);
    EXPECT_EQ(library->ImageFile("s"), "textures/t.dds");
    EXPECT_EQ(library->GetWithImage("s").averageColor, (Vec3f{0, 200, 0}));
    folder.Write("textures/t_n.dds", dds);
    EXPECT_TRUE(library->HasNormalMap("textures/t"));
    WriteTga("textures/t.tga", {{200, 0, 0, 255}});
    EXPECT_EQ(LoadShader("qer_editorImage textures/t.dds").geometry.textureWidth, 1);
}

} // namespace
} // namespace q3
