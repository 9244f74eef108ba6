// GPL-2.0-or-later. Editors that do not behave: the compile is that of a run without one.
#include "common/files/files.h"
#include "tests/program/editor_listener.h"
#include "tests/support/run_program.h"
#include "tests/support/this_system.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

class EditorFaultTest : public ProgramTest {
  protected:
    EditorFaultTest() : original_(MapBytes()) {
        EXPECT_EQ(RunWell(kLight).status, 0);
        expected_ = MapBytes();
    }

    /// Lights the map with an editor at that address, and expects the file of a run without one.
    void ExpectSameFile(const std::string &address) {
        folder_.Write("base/baseq3/maps/demo.bsp", original_);
        RunWell(fmt::format("-connect {} {}", address, kLight));
        EXPECT_EQ(MapBytes(), expected_);
    }

    static constexpr std::string_view kLight = "-light -sh -gridsh 64 64 64 MAP";
    std::vector<std::byte> original_, expected_;
};

TEST_F(EditorFaultTest, AnEditorThatReadsNothingHoldsNothingUp) {
    // Over 5 MB, more than systems buffer: a run that waited for the editor would never end. A command line of Windows
    // has room for a tenth of that.
    const int maps = kIsWindows ? 400 : 4000;
    EditorListener editor({.reads = false, .smallBuffer = true});
    std::string words = "-connect " + editor.Address() + " -info";
    for (int i = 0; i < maps; ++i)
        words += " MAP";
    EXPECT_GT(RunWell(words).text.size(), 1250u * std::size_t(maps));
    editor.Payloads();
    EditorListener next({.reads = false, .smallBuffer = true});
    ExpectSameFile(next.Address());
}

TEST_F(EditorFaultTest, AnEditorMayVanishAtAnyMessage) {
    for (const std::size_t messages : {1u, 2u, 4u}) {
        EditorListener editor({.resetAfter = messages});
        ExpectSameFile(editor.Address());
        EXPECT_EQ(editor.Payloads().size(), messages);
    }
}

TEST_F(EditorFaultTest, AnEditorThatNeverAcceptsIsNoMatter) {
    EditorListener editor({.accepts = false});
    ExpectSameFile(editor.Address());
}

TEST_F(EditorFaultTest, AWrongAddressIsNoMatter) {
    for (const char *address : {"127.0.0.1:1", "127.0.0.1:", "nonsense", "255.255.255.255:39000"})
        ExpectSameFile(address);
}

TEST_F(EditorFaultTest, AnAddressThatNobodyAnswersIsNoMatter) {
    // TEST-NET-1: packets get lost, or there is no way there.
    ExpectSameFile("192.0.2.1:39000");
}

TEST_F(EditorFaultTest, AnEditorThatAcceptsLateGetsEverything) {
    EditorListener editor({.acceptAfter = milliseconds(1500)});
    const Outcome outcome = RunWell(fmt::format("-connect {} {}", editor.Address(), kLight));
    EXPECT_EQ(TextOfLevel(ParseFeedback(editor.Text()), "1"), outcome.text);
}

TEST_F(EditorFaultTest, OutputThatCannotBeWrittenIsNoMatter) {
    folder_.Write("base/baseq3/maps/demo.bsp", original_);
    EditorListener editor;
    const Ending ending = RunWithoutOutput({"-fs_basepath", (folder_ / "base").string(), "-connect", editor.Address(),
                                            "-light", "-sh", "-gridsh", "64", "64", "64", Map(".bsp").string()},
                                           folder_.Root());
    EXPECT_EQ(ending.status, 0);
    EXPECT_EQ(MapBytes(), expected_);
    const auto elements = ParseFeedback(editor.Text());
    EXPECT_THAT(TextOfLevel(elements, "1"), HasSubstr("--- TraceGridSH ---"));
    EXPECT_THAT(TextOfLevel(elements, "1"), HasSubstr("done: no warnings"));
}

} // namespace

} // namespace q3::test
