// GPL-2.0-or-later. The stream that an editor gets (-connect).
#include "common/files/files.h"
#include "tests/program/editor_listener.h"
#include "tests/support/run_program.h"
#include "tests/support/this_system.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace q3::test {

namespace {

using testing::HasSubstr;

TEST_F(ProgramTest, EditorGetsEverythingThatIsPrinted) {
    EditorListener editor;
    const Outcome outcome = RunWell("-connect " + editor.Address() + " -light -sh -gridsh 64 64 64 -zork<&\"> MAP");
    const auto messages = ParseFeedback(editor.Text());
    std::string all;
    for (const FeedbackElement &message : messages) {
        EXPECT_EQ(message.name, "message");
        EXPECT_TRUE(message.level == "1" || message.level == "2") << message.level;
        all += message.text;
    }
    EXPECT_EQ(all, outcome.text);
    EXPECT_NE(TextOfLevel(messages, "1").find("--- TraceGridSH ---"), std::string::npos);
    EXPECT_NE(TextOfLevel(messages, "2").find("Unknown argument \"-zork<&\">\""), std::string::npos);
}

TEST_F(ProgramTest, EditorGetsErrors) {
    EditorListener editor;
    const std::string nowhere = (folder_ / "nowhere/x.bsp").string();
    EXPECT_EQ(Run("-light -connect " + editor.Address() + " " + nowhere).status, 1);
    EXPECT_NE(Slashed(TextOfLevel(ParseFeedback(editor.Text()), "3")).find(Slashed(nowhere)), std::string::npos);
}

TEST_F(ProgramTest, EditorGetsErrorsInOptions) {
    for (const std::string options :
         {"-game tetris -light MAP", "-fs_basepath /nope -light MAP", "-light MAP -threads"}) {
        EditorListener editor;
        const Outcome outcome = Run("-connect " + editor.Address() + " " + options);
        EXPECT_EQ(outcome.status, 1) << options;
        const std::string errors = TextOfLevel(ParseFeedback(editor.Text()), "3");
        EXPECT_NE(errors.find("ERROR"), std::string::npos) << options;
        ASSERT_EQ(outcome.ErrorLines().size(), 1u) << outcome.text;
        EXPECT_NE(errors.find(outcome.ErrorLines().front()), std::string::npos) << errors;
    }
}

TEST_F(ProgramTest, EditorGetsNoLiveLineOfATerminal) {
    if (kIsWindows)
        GTEST_SKIP() << kNoTerminals;
    EditorListener editor;
    const Outcome outcome = RunOnTerminal({"-connect", editor.Address(), "-fs_basepath", (folder_ / "base").string(),
                                           "-light", "-sh", "-samplesize", "4", Map(".bsp").string()},
                                          folder_.Root());
    ASSERT_EQ(outcome.status, 0) << outcome.text;
    ASSERT_TRUE(outcome.Printed("\r          ")) << "the terminal has its live line: " << outcome.text;
    const std::string payload = editor.Text();
    EXPECT_EQ(payload.find('\r'), std::string::npos);
    EXPECT_EQ(payload.find("&#13;"), std::string::npos) << payload;
    EXPECT_EQ(payload.find(" s left"), std::string::npos);
    EXPECT_NE(payload.find("0...1...2...3...4...5...6...7...8...9... ("), std::string::npos) << payload;
}

TEST_F(ProgramTest, EditorIsShownLeaksAndBrushes) {
    // A floor with a side twice, so that brush 0 of entity 0 is worth a look; nothing around it.
    constexpr std::string_view kMap = R"({
"classname" "worldspawn"
{
( 0 0 0 ) ( 0 64 0 ) ( 64 0 0 ) a 0 0 0 1 1
( 0 0 0 ) ( 0 64 0 ) ( 64 0 0 ) a 0 0 0 1 1
( 0 0 -8 ) ( 64 0 -8 ) ( 0 64 -8 ) a 0 0 0 1 1
( 0 0 0 ) ( 0 64 0 ) ( 0 0 64 ) a 0 0 0 1 1
( 64 0 0 ) ( 64 0 64 ) ( 64 64 0 ) a 0 0 0 1 1
( 0 0 0 ) ( 0 0 64 ) ( 64 0 0 ) a 0 0 0 1 1
( 0 64 0 ) ( 64 64 0 ) ( 0 64 64 ) a 0 0 0 1 1
}
}
{
"classname" "info_player_start"
"origin" "32 32 32"
}
)";
    folder_.Write("leak.map", kMap);
    EditorListener editor;
    const Outcome outcome = RunWell("-connect " + editor.Address() + " -v " + (folder_ / "leak.map").string());
    EXPECT_TRUE(outcome.Printed("Entity 0, Brush 0: "));
    const auto elements = ParseFeedback(editor.Text());
    const auto find = [&](const auto &isIt) { return std::ranges::find_if(elements, isIt); };
    const auto brush = find([](const FeedbackElement &e) { return e.childText == "0 0"; });
    ASSERT_NE(brush, elements.end());
    EXPECT_EQ(brush->name + brush->level + brush->childName, "select2brush");
    EXPECT_TRUE(brush->text.starts_with("Entity 0, Brush 0: ")) << brush->text;
    // The editor closes at the trail: what leaked, and from where, comes before it.
    const auto cause = find([](const FeedbackElement &e) { return e.childText == "1 0"; });
    const auto banner = find([](const FeedbackElement &e) { return e.text.find("** leaked **") != std::string::npos; });
    const auto trail = find([](const FeedbackElement &e) { return e.childName == "polyline"; });
    ASSERT_NE(trail, elements.end());
    ASSERT_LT(cause, trail);
    EXPECT_LT(banner, trail);
    EXPECT_EQ(cause->text, "Entity 1, Brush 0: the info_player_start at 32 32 32 can be reached from outside the map");
    EXPECT_EQ(trail->name + trail->level + trail->text, "message3MAP LEAKED\n");
    EXPECT_EQ(std::ranges::count(elements, std::string("3"), &FeedbackElement::level), 1);
    // Its points are those of the leak file.
    std::string points;
    for (const auto &[name, text] : trail->innermost) {
        EXPECT_EQ(name, "point");
        points += text + "\n";
    }
    EXPECT_EQ(points, ReadTextFile(folder_ / "leak.lin"));
    EXPECT_THAT(points, testing::EndsWith("\n32.000000 32.000000 32.000000\n"));
}

TEST_F(ProgramTest, LongTextComesInManyMessages) {
    EditorListener editor;
    const Outcome outcome = RunWell("-connect " + editor.Address() + " -help all");
    ASSERT_GT(outcome.text.size(), 40000u);
    EXPECT_EQ(TextOfLevel(ParseFeedback(editor.Text()), "1"), outcome.text);
}

TEST_F(ProgramTest, NoEditorThereIsNoError) {
    for (const char *address : {"127.0.0.1:1", "nonsense", "300.1.1.1:39000", ":", "127.0.0.1:999999"})
        RunWell(fmt::format("-connect {} -info MAP", address));
    for (const char *address : {"localhost:39000", "127.0.0.1", "127.0.0.1:70000"})
        EXPECT_THAT(RunWell(fmt::format("-connect {} -info MAP", address)).text,
                    HasSubstr(fmt::format("WARNING: -connect {}: expected an address", address)));
}

} // namespace

} // namespace q3::test
