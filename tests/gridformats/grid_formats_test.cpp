// GPL-2.0-or-later. The words of -gridformats.
#include "q3map2/gridformats/grid_formats.h"

#include "common/error.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace {

std::string ErrorOf(std::string_view list) {
    try {
        ParseGridFormats(list);
    } catch (const Error &error) {
        return error.what();
    }
    return "";
}

TEST(GridFormatWords, EachIsExplained) {
    for (const GridFormat &format : AllGridFormats()) {
        EXPECT_NE(kGridFormatsDetails.find("`" + std::string(format.word) + "`"), std::string_view::npos)
            << format.word;
        EXPECT_EQ(ParseGridFormats(format.word), GridFormats{&format});
    }
}

TEST(GridFormatWords, Lists) {
    const GridFormats formats = ParseGridFormats("shbspx,legacy-ioq3,RAW-rend2,octree,grids");
    EXPECT_EQ(formats.size(), 5u);
    EXPECT_TRUE(AnyConvertible(formats) && AnyWritesLegacyGrid(formats));
    EXPECT_FALSE(AnyConvertible(ParseGridFormats("octree,grids")));
    EXPECT_FALSE(AnyWritesLegacyGrid(ParseGridFormats("octree,sh")));
    EXPECT_TRUE(AnyWritesLegacyGrid(ParseGridFormats("raw-ioq3"))) << "the direction stays in lump 15";
}

TEST(GridFormatWords, Faults) {
    EXPECT_NE(ErrorOf("legacy,cubes").find("\"cubes\" is not a format"), std::string::npos);
    EXPECT_NE(ErrorOf("legacy,").find("\"\" is not a format"), std::string::npos);
    EXPECT_NE(ErrorOf("sh,shbspx").find("sh and shbspx exclude each other"), std::string::npos);
    EXPECT_NE(ErrorOf("legacy,octree,legacy-daemon").find("exclude"), std::string::npos);
    EXPECT_NE(ErrorOf("raw-ioq3,raw-rend2").find("exclude"), std::string::npos);
    EXPECT_NE(ErrorOf("octree,octree").find("exclude"), std::string::npos);
}

} // namespace

} // namespace q3::test
