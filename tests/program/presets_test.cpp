// GPL-2.0-or-later. -preset, -shsmall, and the line about the size of the SH grid.
#include "q3map2/cli/presets.h"
#include "q3map2/stages/light_files.h"
#include "tests/support/run_program.h"

#include "common/files/files.h"

#include <gmock/gmock.h>

#include <random>

namespace q3::test {

namespace {

using testing::HasSubstr;
using testing::Not;

using PresetTest = ProgramTest;

TEST_F(PresetTest, StandsForOptionsThatTheLineOverrides) {
    const Outcome plain = RunWell("-light -preset draft -gridsh 128 128 128 -sh MAP");
    EXPECT_THAT(plain.text, HasSubstr("preset draft: -faster -gridsh 64 64 128\n"));
    EXPECT_THAT(plain.text, HasSubstr("  -gridsh 128 128 128 (command line"));
    EXPECT_EQ(IntOf(LumpOf(MapBytes(), 18), 12), 0x43000000) << "cell of 128 units";
}

TEST_F(PresetTest, SparseGridsGetTheCellToo) {
    for (const std::string_view grid : {"-shadaptive", "-shbudget 2"}) {
        const Outcome run = RunWell(fmt::format("-light -preset draft {} MAP", grid));
        EXPECT_THAT(run.text, HasSubstr("preset draft: -faster -gridsh 64 64 128\n")) << grid;
    }
}

TEST_F(PresetTest, SHSmallKeepsItsOwnGrid) {
    const Outcome run = RunWell("-light -preset draft -sh -shsmall MAP");
    EXPECT_THAT(run.text, HasSubstr("preset draft: -faster\n"));
    EXPECT_EQ(IntOf(LumpOf(MapBytes(), 18), 12), 0x42800000) << "cell of 64 units";
    EXPECT_EQ(IntOf(LumpOf(MapBytes(), 18), 20), 0x42800000) << "64 high, where draft has 128";
}

TEST_F(PresetTest, GivesNoGridOptionsWithoutAGrid) {
    const Outcome run = RunWell("-light -preset draft MAP");
    EXPECT_THAT(run.text, HasSubstr("preset draft: -faster\n"));
    EXPECT_THAT(run.text, Not(HasSubstr("without effect")));
}

TEST_F(PresetTest, TheMapRecordsItsOptions) {
    RunWell("-light -preset draft MAP");
    const std::string text = ReadTextFile(Map(".bsp"));
    EXPECT_THAT(text, HasSubstr("-light -faster\""));
}

TEST_F(PresetTest, TheGridAloneIsThatOfAFullRun) {
    RunWell("-light -preset normal -sh MAP");
    const std::vector<std::byte> full = MapBytes();
    RunWell("-light -sh -onlygrid MAP");
    EXPECT_NE(LumpOf(full, 18), LumpOf(MapBytes(), 18)) << "no bounced light";
    RunWell("-light -preset normal -sh -onlygrid MAP");
    for (std::size_t lump = 1; lump < 19; ++lump)
        EXPECT_EQ(LumpOf(full, lump), LumpOf(MapBytes(), lump)) << "lump " << lump;
}

TEST_F(PresetTest, UnknownNamesAreErrorsWithTheNearest) {
    ExpectError("-light -preset finel MAP", "-preset finel: expected one of draft, normal, final; did you mean final?");
    ExpectError("-light -preset draft -preset final MAP", "-preset: expected once, found twice");
    ExpectError("-preset draft -ligth MAP", "did you mean -light?");
}

TEST_F(PresetTest, SHSmallIsAFittedGridOfSixtyFour) {
    const Outcome run = RunWell("-light -shsmall MAP");
    EXPECT_THAT(run.text, HasSubstr("SH grid: "));
    EXPECT_THAT(run.text, HasSubstr("-gridsh 80 80 80 would take about half"));
    const std::vector<std::byte> small = MapBytes();
    RunWell("-light -sh -gridsh 64 64 64 -shfit MAP");
    EXPECT_EQ(LumpOf(small, 18), LumpOf(MapBytes(), 18));
}

TEST_F(PresetTest, GridsThatNameLightsAreNotFitted) {
    EXPECT_FALSE(RunWell("-light -preset final -shlights -shadaptive MAP").Printed("-shfit"));
    EXPECT_TRUE(RunWell("-light -preset final -sherrortarget 3 MAP").Printed("-gridsh 64 64 64 -shfit"));
}

TEST(PresetTable, IsInTheDocumentation) {
    const std::string page = ReadTextFile(std::filesystem::path(SOURCE) / "docs/guide/releasing.md");
    for (const Preset &preset : Presets())
        for (const std::string_view options : {preset.bsp, preset.vis, preset.light, preset.gridSH}) {
            if (!options.empty()) {
                EXPECT_THAT(page, HasSubstr(fmt::format("`{}`", options)));
            }
        }
}

TEST(GridSize, OfBytesThatDoNotCompressIsTheirNumber) {
    std::mt19937 random(5);
    std::vector<std::byte> noise(9000000), zeros(9000000);
    for (std::byte &b : noise)
        b = std::byte(random());
    EXPECT_NEAR(double(EstimateDeflated(noise)), 9e6, 9e3);
    EXPECT_LT(EstimateDeflated(zeros), 20000u);
    std::copy_n(noise.begin(), 4500000, zeros.begin());
    EXPECT_NEAR(double(EstimateDeflated(zeros)), 4.5e6, 4e5) << "half noise, half zeros";
    EXPECT_EQ(EstimateDeflated({}), 0u);
}

/// A large grid is a warning only where -shsmall would bake a smaller one.
TEST(GridSizeReport, SmallGridsNeedNoSmallerOne) {
    const auto text = [](float cell) {
        Bsp bsp;
        bsp.gridSH.emplace();
        bsp.gridSH->header.gridSize = {cell, cell, cell};
        bsp.gridSH->points.resize(20000);
        KeptLog out;
        PrintGridSHSize(bsp, 3000000, JobPool(2), out.log);
        return out.text;
    };
    EXPECT_THAT(text(32), HasSubstr("72 % of the file; -shsmall"));
    EXPECT_THAT(text(64), Not(HasSubstr("-shsmall")));
    EXPECT_THAT(text(100), Not(HasSubstr("-shsmall")));
}

} // namespace

} // namespace q3::test
