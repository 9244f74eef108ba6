// GPL-2.0-or-later. Names like a misspelt one.
#include "common/nearest_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

TEST(NearestNames, DistanceCountsInsertionsDeletionsAndReplacements) {
    EXPECT_EQ(EditDistance("", ""), 0u);
    EXPECT_EQ(EditDistance("", "abc"), 3u);
    EXPECT_EQ(EditDistance("abc", ""), 3u);
    EXPECT_EQ(EditDistance("kitten", "sitting"), 3u);
    EXPECT_EQ(EditDistance("-lihgt", "-light"), 2u);
    EXPECT_EQ(EditDistance("Quake3", "qUAKE3"), 0u);
}

TEST(NearestNames, NearestFirstThenInTheirOrder) {
    EXPECT_THAT(NearestNames("quake", {"wolf", "quakelive", "quake3", "quakes"}, 3),
                testing::ElementsAre("quake3", "quakes", "quakelive"));
    EXPECT_THAT(NearestNames("x", {"a", "b"}, 5), testing::ElementsAre("a", "b"));
    EXPECT_TRUE(NearestNames("x", {}, 5).empty());
}

} // namespace
} // namespace q3
