// GPL-2.0-or-later. Options of -watch that hold options.
#include "common/error.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/watch/options/watch_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

namespace q3::test {

namespace {

using testing::ElementsAre;

WatchOptions Parsed(std::vector<std::string> words) {
    Log log(Log::Nowhere());
    Arguments arguments(std::move(words));
    return ParseWatchOptions(arguments, log);
}

TEST(WatchOptions, QuotesKeepBlanks) {
    EXPECT_THAT(WordsOf("  -a 1  -b\t2 "), ElementsAre("-a", "1", "-b", "2"));
    EXPECT_THAT(WordsOf(R"(-f "my file.rad" x"y z"w "")"), ElementsAre("-f", "my file.rad", "xy zw", ""));
    EXPECT_THAT(WordsOf(""), ElementsAre());
}

TEST(WatchOptions, ValuesMayBeginWithADash) {
    EXPECT_EQ(Parsed({"-lightoptions", "-fast"}).light, "-fast");
    EXPECT_EQ(Parsed({"-bspoptions", ""}).bsp, "");
}

TEST(WatchOptions, OtherFilesAreRefused) {
    EXPECT_THROW(Parsed({"-bspoptions", "-meta -BSPFILE x.bsp"}), Error);
    EXPECT_THROW(Parsed({"-visoptions", "-prtfile x.prt"}), Error);
    EXPECT_THROW(Parsed({"-port", "65536"}), Error);
}

TEST(WatchOptions, GlobalWordsAreThoseOfAllStages) {
    const std::vector<std::string> words{"-v",    "-fs_game",   "-watch",   "-watch",   "-LOG",
                                         "x.txt", "-fs_game",   "my mod",   "-meta",    "-threads",
                                         "2",     "maps/x.map", "-connect", "1.2.3.4:5"};
    EXPECT_THAT(GlobalWords(words, std::array<std::string_view, 2>{"-connect", "-log"}),
                ElementsAre("-v", "-fs_game", "-watch", "-fs_game", "my mod", "-threads", "2"));
    EXPECT_THAT(GlobalWords({"-threads"}, {}), ElementsAre("-threads"));
}

} // namespace

} // namespace q3::test
