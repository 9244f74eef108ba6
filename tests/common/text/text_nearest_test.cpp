// GPL-2.0-or-later. Names like a misspelt one.
#include "common/text/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

TEST(NearestNames, DistanceCountsInsertionsDeletionsAndReplacements) {
    EXPECT_EQ(EditDistance("", ""), 0u);
    EXPECT_EQ(EditDistance("", "abc"), 3u);
    EXPECT_EQ(EditDistance("abc", ""), 3u);
    EXPECT_EQ(EditDistance("kitten", "sitting"), 3u);
    EXPECT_EQ(EditDistance("lihgt", "light"), 1u); // neighbors swapped
}

TEST(NearestNames, OnlyTheNearestAndNoneFarOff) {
    const std::vector<std::string> names{"wolf", "quakelive", "quake3", "quakes"};
    EXPECT_THAT(NearestNames("-QUAKE", names), testing::ElementsAre("quake3", "quakes"));
    EXPECT_THAT(NearestNames("wlof", names), testing::ElementsAre("wolf"));
    EXPECT_TRUE(NearestNames("tetris", names).empty());

    EXPECT_EQ(DidYouMean("x", names), "");
}

TEST(NearestNames, SwappedMissingAndWrongLetters) {
    const std::vector<std::string> names{"-light", "-vis", "-bsp", "-sky", "-skyscale"};
    EXPECT_THAT(NearestNames("-lihgt", names), testing::ElementsAre("-light"));
    EXPECT_THAT(NearestNames("lght", names), testing::ElementsAre("-light"));
    EXPECT_THAT(NearestNames("-SKYSCLAE", names), testing::ElementsAre("-skyscale"));
    EXPECT_THAT(NearestNames("-vos", names), testing::ElementsAre("-vis"));
    EXPECT_TRUE(NearestNames("-frobnicate", names).empty());
    EXPECT_EQ(DidYouMean("-lihgt", names), "; did you mean -light?");
}

} // namespace
} // namespace q3
