// GPL-2.0-or-later. What goes into a package, and what is missing.
#include "tests/pk3/package_fixture.h"

#include "common/error.h"
#include "common/files/archive.h"

#include <gmock/gmock.h>

#include <cstring>

namespace q3::test {

namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr std::string_view kScript = "textures/base/wall\n{\n\tqer_editorimage textures/editor.tga\n\t{\n"
                                     "\t\tmap $lightmap\n\t}\n\t{\n\t\tmap textures\\base\\stone.jpg\n"
                                     "\t\tanimMap 2 textures/f1.tga textures/f2\n\t}\n}\n";

TEST_F(PackageTest, AShaderBringsItsScriptAndImages) {
    Put("scripts/my.shader", kScript);
    for (const std::string name : {"base/stone.tga", "f1.tga", "f2.jpg", "editor.tga", "unused.tga"})
        Put("textures/" + name);
    const PackagePlan plan = Plan(MapWith(""));
    EXPECT_THAT(Names(plan), ElementsAre("textures/base/stone.tga", "textures/f1.tga", "textures/f2.jpg",
                                         "scripts/my.shader", "maps/x.bsp"));
    EXPECT_THAT(plan.missing, IsEmpty());
}

TEST_F(PackageTest, ATextureWithoutAScriptIsAnImage) {
    Put("textures/base/wall.jpg");
    EXPECT_THAT(Names(Plan(MapWith(""))), ElementsAre("textures/base/wall.jpg", "maps/x.bsp"));
}

TEST_F(PackageTest, WhatIsMissingIsNamedWithWhoWantsIt) {
    const auto missing = Plan(MapWith("{\n\"classname\" \"target_speaker\"\n\"noise\" \"sound/hum\"\n}\n")).missing;
    ASSERT_EQ(missing.size(), 2u);
    EXPECT_EQ(missing[0], "textures/base/wall (.tga, .jpg, .dds, .ktx, .crn or .webp): wanted by surfaces of x");
    EXPECT_EQ(missing[1], "sound/hum.wav: wanted by entity 1 of x, target_speaker");
}

TEST_F(PackageTest, PngIsTakenWhenAsked) {
    Put("textures/base/wall.png");
    EXPECT_THAT(Plan(MapWith("")).missing, ElementsAre(HasSubstr("-png")));
    EXPECT_THAT(Names(Plan(MapWith(""), {}, true)), Contains("textures/base/wall.png"));
}

TEST_F(PackageTest, OtherFormatsAreTakenWhereThereIsNoOtherImage) {
    for (const char *name : {"webp", "crn", "ktx", "dds"}) {
        Put(fmt::format("textures/base/wall.{}", name));
        EXPECT_THAT(Names(Plan(MapWith(""))), ElementsAre(fmt::format("textures/base/wall.{}", name), "maps/x.bsp"));
    }
    Put("textures/base/wall.jpg");
    EXPECT_THAT(Names(Plan(MapWith(""))), ElementsAre("textures/base/wall.jpg", "maps/x.bsp"));
}

TEST_F(PackageTest, OpenExrIsNoImageOfAGame) {
    Put("textures/base/wall.exr");
    EXPECT_THAT(Plan(MapWith("")).missing, ElementsAre(HasSubstr("textures/base/wall (.tga")));
}

TEST_F(PackageTest, ScriptsThatEnginesIgnoreAreNamed) {
    const auto warning = [this](std::string_view script) {
        Put("scripts/my.shader", script);
        vfs_ = std::make_unique<VirtualFileSystem>(log_.log);
        vfs_->Mount(folder_ / "base", "pk3");
        log_.text.clear();
        log_.log.FlushWarnings();
        ReadScripts(PackageSource(*vfs_, {}, {}), Quake3(), log_.log);
        return log_.text;
    };
    const std::string shader = "textures/base/wall\n{\n\t{\n\t\tmap textures/base/wall.tga\n\t}\n}\n";
    EXPECT_THAT(warning("// a; b # c\n/* # */" + shader), Not(HasSubstr("ignore")));
    EXPECT_THAT(warning("# my shaders\n" + shader),
                AllOf(HasSubstr("scripts/my.shader:1: #: expected '{' after the name of a shader, found my"),
                      HasSubstr("engines know only // and"), HasSubstr("ignore the whole script")));
    EXPECT_THAT(warning(shader + "textures/base/floor\n" + shader),
                HasSubstr("scripts/my.shader:7: textures/base/floor: expected '{' after the name of a shader, found "
                          "textures/base/wall"));
    EXPECT_THAT(warning(shader + "textures/base/floor\n{\n"), HasSubstr("textures/base/floor: this shader has no "
                                                                        "closing brace"));
    EXPECT_THAT(warning(shader + "textures/base/floor\n"), HasSubstr("found the end of the file"));
}

TEST_F(PackageTest, DefinitionsForCompilersAloneAreNone) {
    Put("scripts/my.shader", "textures/base/wall:q3map\n{\n\tmap textures/other.tga\n}\n");
    EXPECT_THAT(Plan(MapWith("")).missing, ElementsAre(StartsWith("textures/base/wall ")));
}

// Which one an engine takes depends on the engine.
TEST_F(PackageTest, OfSeveralDefinitionsTheFirstCompleteOneCounts) {
    Put("scripts/a.shader", "textures/base/wall\n{\n\t{\n\t\tmap textures/gone.tga\n\t}\n}\n");
    Put("scripts/b.shader", "textures/base/wall\n{\n\t{\n\t\tmap textures/here.tga\n\t}\n}\n");
    Put("textures/here.tga");
    EXPECT_THAT(Names(Plan(MapWith(""))), ElementsAre("textures/here.tga", "scripts/b.shader", "maps/x.bsp"));
}

TEST_F(PackageTest, ShadersThatNeedNoImage) {
    Put("scripts/my.shader", "textures/base/wall\n{\n\t{\n\t\tmap $whiteimage\n\t}\n}\n");
    EXPECT_THAT(Plan(MapWith("")).missing, IsEmpty());
    Put("scripts/my.shader", "textures/base/wall\n{\n\tsurfaceparm fog\n\tfogparms ( 1 1 1 ) 64\n}\n");
    EXPECT_THAT(Plan(MapWith("")).missing, IsEmpty());
}

TEST_F(PackageTest, SkiesHaveSixSides) {
    Put("scripts/my.shader", "textures/base/wall\n{\n\tskyParms env/s 512 -\n\t{\n\t\tmap env/clouds.tga\n\t}\n}\n");
    for (const std::string side : {"up", "lf", "rt", "bk", "ft"})
        Put("env/s_" + side + ".jpg");
    Put("env/clouds.tga");
    const PackagePlan plan = Plan(MapWith(""));
    EXPECT_THAT(plan.missing, ElementsAre(StartsWith("env/s_dn ")));
    EXPECT_THAT(Names(plan), Contains("env/clouds.tga"));
}

TEST_F(PackageTest, EntitiesBringMusicSoundsAndShaders) {
    Bsp bsp = MapWith("{\n\"classname\" \"target_speaker\"\n\"noise\" \"*falling1.wav\"\n}\n"
                      "{\n\"classname\" \"trigger_multiple\"\n\"targetShaderNewName\" \"textures/on\"\n}\n"
                      "{\n\"classname\" \"target_push\"\n}\n");
    bsp.entities.insert(bsp.entities.find('}'), "\"music\" \"music/intro music/loop.wav\"\n"
                                                "\"vertexremapshader1\" \"a;textures/remapped\"\n");
    for (const std::string name :
         {"textures/base/wall.tga", "textures/on.tga", "textures/remapped.tga", "music/intro.wav", "music/loop.ogg"})
        Put(name);
    const PackagePlan plan = Plan(bsp);
    EXPECT_THAT(plan.missing, IsEmpty());
    EXPECT_THAT(plan.absent, Contains(StartsWith("sound/misc/windfly.wav"))) << "of the game, not of the map";
    EXPECT_THAT(Names(plan), ElementsAre("textures/base/wall.tga", "textures/remapped.tga", "textures/on.tga",
                                         "music/intro.wav", "music/loop.ogg", "maps/x.bsp"));
}

// Flag 1 of a target_push: its sound is that of a bounce pad.
TEST_F(PackageTest, FlagsMayBeMoreThanAnIntHolds) {
    const auto absentWith = [&](const std::string &flags) {
        return Plan(MapWith("{\n\"classname\" \"target_push\"\n\"spawnflags\" \"" + flags + "\"\n}\n")).absent;
    };
    EXPECT_THAT(absentWith("2"), Contains(StartsWith("sound/misc/windfly.wav")));
    for (const std::string flags : {"1", "3", "4294967295", "99999999999999999999"})
        EXPECT_THAT(absentWith(flags), Not(Contains(StartsWith("sound/misc/windfly.wav")))) << flags;
}

/// One surface with one shader.
std::string Md3(std::string_view shader) {
    std::string file(108 + 108 + 68, '\0');
    const auto put = [&](std::size_t at, std::int32_t value) { std::memcpy(file.data() + at, &value, 4); };
    file.replace(0, 4, "IDP3");
    put(84, 1);
    put(100, 108);
    file.replace(108, 4, "IDP3");
    put(108 + 76, 1);
    put(108 + 92, 108);
    put(108 + 104, 108 + 68);
    file.replace(216, shader.size(), shader);
    return file;
}

TEST_F(PackageTest, ModelsOfStaticPropsArePacked) {
    const Bsp bsp = MapWith("{\n\"classname\" \"misc_model\"\n\"model\" \"models/prop.md3\"\n"
                            "\"_staticprop\" \"1\"\n}\n");
    Put("textures/base/wall.tga");
    EXPECT_THAT(Plan(bsp).missing, ElementsAre(StartsWith("models/prop.md3: wanted by")));
}

TEST_F(PackageTest, ModelsThatTheGameShowsComeWithTheirShaders) {
    const Bsp bsp = MapWith("{\n\"classname\" \"func_bobbing\"\n\"model2\" \"models/lamp.md3\"\n}\n"
                            "{\n\"classname\" \"misc_model\"\n\"model\" \"models/built_in.md3\"\n}\n");
    Put("textures/base/wall.tga");
    Put("models/lamp.md3", Md3("models/lamp_skin.tga"));
    Put("models/lamp_1.md3", Md3("models/far.tga"));
    EXPECT_THAT(Plan(bsp).missing, ElementsAre(StartsWith("models/lamp_skin "), StartsWith("models/far ")));
    Put("models/lamp_skin.jpg");
    Put("models/far.jpg");
    const PackagePlan plan = Plan(bsp);
    EXPECT_THAT(plan.missing, IsEmpty());
    EXPECT_THAT(Names(plan), ElementsAre("textures/base/wall.tga", "models/lamp_skin.jpg", "models/far.jpg",
                                         "models/lamp.md3", "models/lamp_1.md3", "maps/x.bsp"));
}

TEST_F(PackageTest, DamagedModelsNameNoShaders) {
    const std::string whole = Md3("a");
    for (const std::size_t size : {0u, 4u, 107u, 150u, 283u})
        EXPECT_THAT(ShadersOfMd3(std::as_bytes(std::span(whole).first(size))), IsEmpty()) << size;
    std::string far = Md3("a");
    std::memset(far.data() + 100, 0xff, 4);
    EXPECT_THAT(ShadersOfMd3(std::as_bytes(std::span(far))), IsEmpty());
}

TEST_F(PackageTest, LightmapFilesBesideTheMapComeToo) {
    Put("textures/base/wall.tga");
    Bsp bsp = MapWith("");
    bsp.drawSurfaces[0].lightmapNum[0] = 2;
    bsp.lightmaps.clear();
    Put("maps/x/lm_0000.tga");
    Put("maps/x/lm_0002.tga");
    Put("maps/x/lightmap_0000.tga");
    const PackagePlan plan = Plan(bsp);
    EXPECT_THAT(Names(plan),
                ElementsAre("textures/base/wall.tga", "maps/x/lm_0000.tga", "maps/x/lm_0002.tga", "maps/x.bsp"));
    EXPECT_THAT(plan.missing, ElementsAre(StartsWith("maps/x/lm_0001.tga: ")));
}

TEST_F(PackageTest, FilesOfPropLightBesideTheMapComeToo) {
    Put("textures/base/wall.tga");
    for (const std::string name : {"maps/x/sp_0.vhv", "maps/x/sp_12.VHV", "maps/x/proplight.raw", "maps/x/sp_one.vhv",
                                   "maps/x/sp_3.txt", "maps/x/sp_.vhv", "maps/x/other.raw", "maps/y/sp_0.vhv"})
        Put(name);
    EXPECT_THAT(Names(Plan(MapWith(""))), ElementsAre("textures/base/wall.tga", "maps/x/proplight.raw",
                                                      "maps/x/sp_0.vhv", "maps/x/sp_12.VHV", "maps/x.bsp"));
}

TEST_F(PackageTest, BotAndMenuFilesComeIfTheyAreThere) {
    Put("textures/base/wall.tga");
    EXPECT_THAT(Plan(MapWith("")).absent, Contains(StartsWith("maps/x.aas: bots")));
    for (const std::string name : {"maps/x.aas", "scripts/x.arena", "scripts/x.defi", "levelshots/x.jpg"})
        Put(name);
    const PackagePlan plan = Plan(MapWith(""));
    EXPECT_THAT(Names(plan), ElementsAre("textures/base/wall.tga", "levelshots/x.jpg", "maps/x.bsp", "maps/x.aas",
                                         "scripts/x.arena", "scripts/x.defi"));
    EXPECT_THAT(plan.absent, IsEmpty());
}

TEST_F(PackageTest, ExcludedFilesStayOut) {
    Put("scripts/my.shader", kScript);
    Put("textures/f1.tga");
    Put("textures/f2.tga");
    const Exclusions exclusions = ReadExclusions("textures { textures/base/stone }\n", "quake3.exclude");
    const PackagePlan plan = Plan(MapWith(""), exclusions);
    EXPECT_THAT(plan.missing, IsEmpty());
    EXPECT_THAT(Names(plan), Not(Contains(HasSubstr("stone"))));
    EXPECT_THAT(Names(Plan(MapWith(""), ReadExclusions("shaders { textures/base/wall }\n", "e"))),
                ElementsAre("maps/x.bsp"));
}

TEST_F(PackageTest, AScriptWithExcludedShadersCannotBePacked) {
    Put("scripts/my.shader", std::string(kScript) + "textures/of_the_game\n{\n}\n");
    const Exclusions exclusions = ReadExclusions("shaders { textures/of_the_game }\n", "e");
    EXPECT_THAT(Plan(MapWith(""), exclusions).missing,
                ElementsAre(testing::AllOf(StartsWith("textures/base/wall: "), HasSubstr("textures/of_the_game"))));
}

TEST(Exclusions, OtherBlocksAreErrors) {
    EXPECT_THROW(ReadExclusions("models { a }", "e"), Error);
    EXPECT_THROW(ReadExclusions("textures { a", "e"), Error);
    EXPECT_THROW(ReadExclusions("textures a", "e"), Error);
    try {
        ReadExclusions("\"two\nlines\" { a }", "e");
        ADD_FAILURE() << "no error";
    } catch (const Error &error) {
        EXPECT_STREQ(error.what(), "e:1: two is not one of textures, shaders, shaderfiles, sounds and videos");
    }
    const Exclusions all = ReadExclusions("Textures { /a\\B.tga }\nshaderfiles { scripts/c.shader }", "e");
    EXPECT_TRUE(all.HasTexture("a/b"));
    EXPECT_TRUE(all.HasShaderFile("scripts/C.shader"));
}

TEST_F(PackageTest, ArchivesThatPlayersHaveAreLeftOut) {
    folder_.WriteArchive("base/pak0.pk3", {{"textures/base/wall.tga", "a"}, {"scripts/base.shader", ""}});
    EXPECT_THAT(Names(Plan(MapWith(""))), Contains("textures/base/wall.tga"));
    const PackagePlan plan = Plan(MapWith(""), {}, false, true, {"PAK?.pk3"});
    EXPECT_THAT(Names(plan), ElementsAre("maps/x.bsp"));
    EXPECT_THAT(plan.missing, IsEmpty());
}

TEST_F(PackageTest, StrippedShadersAreTidy) {
    Put("scripts/my.shader", "textures/unused\n{\n}\ntextures/base/wall // wall\n{\n  {\n clampMap textures\\a.jpg\n"
                             "map   $lightmap\n animmap 2 b c.png\n }\n}\n");
    const PackagePlan plan = Plan(MapWith(""), {}, false, false);
    ASSERT_EQ(plan.strippedShaders.size(), 1u);
    EXPECT_EQ(StrippedText(*plan.strippedShaders[0]),
              "textures/base/wall\n{\n\t{\n\t\tclampMap textures/a.tga\n\t\tmap $lightmap\n"
              "\t\tanimmap 2 b.tga c.tga\n\t}\n}\n");
    EXPECT_THAT(Names(plan), Not(Contains("scripts/my.shader")));
}

TEST_F(PackageTest, TheArchiveHoldsThePlan) {
    Put("textures/base/wall.tga", std::string(100000, 'x'));
    PackagePlan plan = Plan(MapWith(""));
    const auto write = [&](std::string_view name, int level) {
        FileSet files;
        WritePackage(folder_ / name, folder_ / "bad.pk3", level, *source_, plan, files, log_.log);
        return folder_.ReadBack(name);
    };
    const std::string packed = write("a.pk3", 9);
    EXPECT_EQ(write("b.pk3", 9), packed) << "the same bytes every time";
    EXPECT_GT(write("c.pk3", 0).size(), 100000u);
    for (const int level : {-1, 1, 6})
        EXPECT_LT(write("d.pk3", level).size(), 10000u);
    const Archive archive(folder_ / "a.pk3");
    EXPECT_EQ(archive.Names().size(), 2u);
    EXPECT_EQ(archive.Read("textures/base/wall.tga").size(), 100000u);
    EXPECT_EQ(archive.Read("maps/x.bsp"), Bytes(MapWith("")));
    // The date of each entry: 1980-01-01, 00:00.
    EXPECT_EQ(packed.substr(10, 4), std::string("\x00\x00\x21\x00", 4));
}

TEST_F(PackageTest, AnIncompletePackageHasAnotherName) {
    PackagePlan plan = Plan(MapWith(""));
    Put("good.pk3", "an older package");
    FileSet files;
    files.AddText(folder_ / "list.txt", "of the package");
    WritePackage(folder_ / "good.pk3", folder_ / "bad.pk3", 9, *source_, plan, files, log_.log);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "bad.pk3"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "good.pk3"));
    EXPECT_EQ(folder_.ReadBack("list.txt"), "of the package");
}

} // namespace

} // namespace q3::test
