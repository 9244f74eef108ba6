// GPL-2.0-or-later. Stages for tools around maps, as a user runs them.
#include "common/files/files.h"
#include "common/image/image.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "tests/support/run_program.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

TEST_F(ProgramTest, MinimapGoesBesideTheMap) {
    const auto before = MapBytes();
    const Outcome outcome = RunWell("-minimap -size 32 MAP");
    EXPECT_TRUE(outcome.Printed("size_texcoords "));
    EXPECT_EQ(ReadFile(Map(".tga")).size(), 18u + 32u * 32u);
    EXPECT_EQ(MapBytes(), before);
    const std::string other = (folder_ / "pictures/plan.tga").string();
    RunWell("-minimap -size 32 -black -o " + other + " MAP");
    EXPECT_EQ(ReadFile(other).size(), 18u + 4u * 32u * 32u);
    RunWell("-game xonotic -fs_basegame baseq3 -minimap -size 32 MAP");
    EXPECT_TRUE(std::filesystem::exists(game_ / "gfx/demo_mini.tga"));
}

TEST_F(ProgramTest, ExportedEntitiesComeBack) {
    KeptLog quiet;
    const std::string entities = ReadBspFile(Map(".bsp"), {}, quiet.log).entities;
    RunWell("-exportents MAP");
    const std::string text = folder_.ReadBack("base/baseq3/maps/demo.ent");
    EXPECT_EQ(text, entities + "\n");
    const std::size_t at = text.find("Demo arena");
    ASSERT_NE(at, std::string::npos);
    folder_.Write("base/baseq3/maps/demo.ent", std::string(text).replace(at, 10, "Changed map"));
    RunWell("-onlyents " + Map(".ent").string());
    const Bsp changed = ReadBspFile(Map(".bsp"), {}, quiet.log);
    EXPECT_EQ(ParseEntities(changed.entities, "demo").front().Value("message"), "Changed map");
    EXPECT_EQ(ParseEntities(changed.entities, "demo").size(), ParseEntities(entities, "demo").size());
}

TEST_F(ProgramTest, AMapWithoutEntitiesHasNoneToExport) {
    KeptLog quiet;
    Bsp bsp = ReadBspFile(Map(".bsp"), {}, quiet.log);
    bsp.entities.clear();
    WriteBspFile(Map(".bsp"), bsp, {}, quiet.log);
    EXPECT_TRUE(RunWell("-exportents MAP").Printed("no entities"));
    EXPECT_FALSE(std::filesystem::exists(Map(".ent")));
}

TEST_F(ProgramTest, AnalyzeTakesAnyFile) {
    const Outcome outcome = RunWell("-analyze MAP");
    EXPECT_TRUE(outcome.Printed("ident   IBSP"));
    EXPECT_TRUE(outcome.Printed("may be entities"));
    folder_.Write("base/unknown.dat", "ABCD1234 and no directory at all");
    EXPECT_TRUE(RunWell("-analyze -lumpswap " + (folder_ / "base/unknown.dat").string()).Printed("without -lumpswap"));
    EXPECT_EQ(Run("-analyze " + (folder_ / "base/missing.bsp").string()).status, 1);
}

} // namespace

} // namespace q3::test
