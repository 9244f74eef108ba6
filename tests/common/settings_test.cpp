// GPL-2.0-or-later. Settings declared in a table: what is taken, refused, clamped and described.
#include "common/settings.h"

#include "common/error.h"
#include "tests/support/game_folder.h"

#include <gmock/gmock.h>

#include <sstream>

namespace q3::test {

namespace {

struct Options {
    bool flag = false, shown = true;
    int count = 3;
    float ratio = 0.5f;
    std::optional<int> maybe;
    std::string name, color = "red";
    std::vector<std::string> list, idle;
    double product = 1;
};

std::vector<SettingGroup<Options>> Table() {
    const auto multiply = [](Options &o, const SettingValues &v) { o.product *= v.numbers[0]; };
    const auto optional = [](Options &o, const SettingValues &v) {
        o.maybe = v.numbers.empty() ? 6 : int(v.numbers[0]);
    };
    return {
        {"First",
         "",
         {{{.name = "-flag", .help = "Flag"}, &Options::flag},
          {{.name = "-hide", .help = "Hide"}, Off(&Options::shown)},
          {{.name = "-count", .aliases = {"-n"}, .values = "N", .range = {1, 8}, .help = "Count"}, &Options::count},
          {{.name = "-ratio",
            .values = "F",
            .range = {.low = 0, .aboveLow = true},
            .outside = OutOfRange::UseDefault,
            .outsideValue = 2,
            .help = "Ratio"},
           &Options::ratio}}},
        {"Second",
         "",
         {{{.name = "-name", .values = "NAME", .help = "Name"}, &Options::name},
          {{.name = "-list", .values = "NAME", .help = "List"}, &Options::list},
          {{.name = "-color", .values = "red|Blue", .kind = SettingKind::Choice, .help = "Color"}, &Options::color},
          {{.name = "-maybe", .values = "[N]", .kind = SettingKind::Integer, .help = "Maybe"}, Do<Options>(optional)},
          {{.name = "-scale", .values = "F", .kind = SettingKind::Number, .initial = "1", .help = "Scale"},
           Do<Options>(multiply)},
          {{.name = "-fine", .values = "N", .range = {1, 8}, .limitReason = "time grows with it", .help = "Fine"},
           &Options::count},
          WithoutEffect(&Options::idle, "-old", "Always so")}}};
}

class SettingsTest : public testing::Test {
  protected:
    Options Take(const std::string &text) {
        std::istringstream in(text);
        arguments = Arguments({std::istream_iterator<std::string>(in), {}});
        Options options;
        TakeSettings(Table(), options, arguments, log.log);
        WarnWithoutEffect(options.idle, log.log);
        return options;
    }
    std::string ErrorOf(const std::string &text) {
        try {
            Take(text);
        } catch (const Error &error) {
            return error.what();
        }
        return {};
    }
    KeptLog log;
    Arguments arguments{{}};
};

TEST_F(SettingsTest, TakesEveryKindWhereverItStands) {
    const Options o =
        Take("maps/x -N 5 -flag -HIDE -list a -name b -list c -ratio +.25 -maybe -scale 2 -scale -3 rest");
    EXPECT_TRUE(o.flag && !o.shown);
    EXPECT_EQ(o.count, 5);
    EXPECT_EQ(o.ratio, 0.25f);
    EXPECT_EQ(o.name, "b");
    EXPECT_THAT(o.list, testing::ElementsAre("a", "c"));
    EXPECT_EQ(o.maybe, 6);
    EXPECT_EQ(o.product, -6);
    EXPECT_THAT(arguments.Rest(), testing::ElementsAre("maps/x", "rest"));
    EXPECT_EQ(Take("-maybe 4 x").maybe, 4);
    EXPECT_EQ(Take("-count 1 -count 2").count, 2) << "the last one counts";
}

TEST_F(SettingsTest, ValuesThatAreNoNumbersAreRefusedByName) {
    for (const char *word : {"x", "1x", "1.5", "0x2", "1e0", "--1"})
        EXPECT_EQ(ErrorOf(std::string("-count ") + word),
                  fmt::format("-count {}: expected a whole number from 1 to 8", word));
    for (const char *word : {"nan", "inf", "-inf", "1e400", "1.5x", "1,5"})
        EXPECT_NE(ErrorOf(std::string("-scale ") + word), "") << word;
    EXPECT_NE(ErrorOf("-count 9").find("-count 9"), std::string::npos);
    EXPECT_NE(ErrorOf("-n").find("-n needs a value"), std::string::npos);
    EXPECT_NE(ErrorOf("-name -flag").find("-name needs a value"), std::string::npos);
}

/// Stages compare the words exactly.
TEST_F(SettingsTest, AChoiceInAnyCaseIsTakenAsItIsSpelled) {
    EXPECT_EQ(Take("-color blue").color, "Blue");
    EXPECT_EQ(Take("-color RED").color, "red");
    EXPECT_EQ(ErrorOf("-color green"), "-color green: expected red|Blue");
}

TEST_F(SettingsTest, ANumberOutsideCanHaveAValueOfItsOwn) {
    EXPECT_EQ(Take("-ratio 0").ratio, 2);
    EXPECT_NE(log.text.find("-ratio 0: expected a number over 0 up to 1000000; 2 is used"), std::string::npos)
        << log.text;
}

TEST_F(SettingsTest, ChangesAreNotedWithWhatTheyReplace) {
    Take("-count 3 -ratio 0.25 -scale 4");
    ASSERT_EQ(arguments.Changes().size(), 2u) << "3 is the default";
    EXPECT_EQ(arguments.Changes()[0].name, "-ratio");
    EXPECT_EQ(arguments.Changes()[0].values, "0.25");
    EXPECT_EQ(arguments.Changes()[0].before, "0.5");
    EXPECT_EQ(arguments.Changes()[1].name, "-scale");
}

TEST_F(SettingsTest, ChangesAreWhatIsUsed) {
    Take("-ratio 0 -old");
    ASSERT_EQ(arguments.Changes().size(), 1u) << "-old has no effect";
    EXPECT_EQ(arguments.Changes()[0].values, "2");
    EXPECT_NE(log.text.find("-old (Always so)"), std::string::npos) << "the warning says why";
}

TEST_F(SettingsTest, ErrorsSayTheWholeRangeAndWhyItEnds) {
    EXPECT_EQ(ErrorOf("-scale 2000000"), "-scale 2000000: expected a number from -1000000 to 1000000");
    EXPECT_EQ(ErrorOf("-fine 9"), "-fine 9: expected a whole number from 1 to 8; time grows with it");
}

TEST(ArgumentsTest, TakeInteger) {
    Arguments arguments({"-n", "3", "a.bsp", "-N", "5", "-low", "1"});
    EXPECT_EQ(arguments.TakeInteger("-n", 7, 1), 5) << "the last counts";
    EXPECT_EQ(arguments.TakeInteger("-n", 7, 1), 7) << "all are taken";
    EXPECT_THROW(arguments.TakeInteger("-low", 7, 2), Error);
    EXPECT_EQ(arguments.Rest(), std::vector<std::string>{"a.bsp"});
}

TEST_F(SettingsTest, DescriptionHasTheDefaultsOfTheFields) {
    const auto sections = Describe(Table());
    ASSERT_EQ(sections.size(), 2u);
    EXPECT_EQ(sections[0].entries[2].initial, "3");
    EXPECT_EQ(sections[0].entries[3].initial, "0.5");
    EXPECT_EQ(sections[0].entries[2].info.kind, SettingKind::Integer);
    EXPECT_EQ(sections[1].entries[0].info.kind, SettingKind::Text);
}

} // namespace

} // namespace q3::test
