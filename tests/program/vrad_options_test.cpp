// GPL-2.0-or-later. Options of VRAD in the light stage.
#include "q3map2/cli/presets.h"
#include "tests/support/run_program.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class VradOptionsTest : public ProgramTest {
  protected:
    /// What is left of the words of a line; `printed` has the messages.
    std::vector<std::string> Translated(std::vector<std::string> words, std::string_view stage = "-light") {
        Log log([&](LogLevel, std::string_view text) { printed += text; });
        Arguments arguments(std::move(words));
        Stage chosen;
        chosen.word = stage;
        TranslateVradOptions(chosen, arguments, log);
        return arguments.Rest();
    }
    std::string printed;
};

TEST_F(VradOptionsTest, BecomeOptionsOfTheLightStage) {
    EXPECT_THAT(Translated({"-smooth", "35", "x.bsp"}), ElementsAre("-shade", "-shadeangle", "35", "x.bsp"));
    EXPECT_THAT(printed, HasSubstr("-smooth of VRAD: -shade -shadeangle 35"));
    EXPECT_THAT(Translated({"-Final", "x.bsp"}), ElementsAre("-preset", "final", "x.bsp"));
    EXPECT_THAT(Translated({"-extra", "x.map"}, "-bsp"), ElementsAre("-extra", "x.map")) << "of light alone";
}

TEST_F(VradOptionsTest, AreRefusedByNameWithTheirValues) {
    EXPECT_THAT(Translated({"-maxchop", "4", "-ambient", "1", "2", "3", "-low", "x.bsp"}), ElementsAre("x.bsp"));
    for (const std::string_view name : {"-maxchop", "-ambient", "-low"})
        EXPECT_THAT(printed, HasSubstr(fmt::format("{} is an option of VRAD", name)));
}

TEST_F(VradOptionsTest, LightAMap) {
    const Outcome run = RunWell("-light -extra -noextra -reflectivityscale 0.5 -smooth 40 -chop 8 MAP");
    EXPECT_THAT(run.text, HasSubstr("-bouncescale 0.5 (command line"));
    EXPECT_THAT(run.text, HasSubstr("-shadeangle 40 (command line"));
    EXPECT_THAT(run.text, HasSubstr("-chop is an option of VRAD without an effect in q3map2-sh"));
}

/// Every replacement is understood by the light stage.
TEST_F(VradOptionsTest, ReplacementsAreOptions) {
    std::string line = "-light";
    for (const VradOption &option : VradOptions())
        if (!option.replacement.empty() && option.name != "-final")
            line += fmt::format(" {}{}", option.name, option.values.empty() ? "" : " 1");
    const Outcome run = RunWell(line + " MAP");
    EXPECT_EQ(run.text.find("unknown"), std::string::npos) << run.text;
}

} // namespace

} // namespace q3::test
