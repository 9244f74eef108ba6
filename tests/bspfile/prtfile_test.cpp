// GPL-2.0-or-later. Portal files: what is read, and what is refused.
#include "common/error.h"
#include "q3map2/bspfile/prtfile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {

namespace {

const std::string kGood = "PRT1\n2\n1\n1\n"
                          "4 0 1 3 (128 0 0 ) (128 64.500000 0 ) (128 64 1e2 ) (128 -0.25 128 ) \n"
                          "3 1 (0 0 0 ) (0 64 0 ) (0 64 64 ) \n";

std::string ErrorOf(const std::string &text) {
    try {
        ParsePortalFile(text, "x.prt");
    } catch (const Error &error) {
        return error.what();
    }
    return "no error";
}

std::string Replaced(std::string_view part, std::string_view by) {
    std::string text = kGood;
    text.replace(text.find(part), part.size(), by);
    return text;
}

TEST(PortalFile, PortalsAndFacesAreRead) {
    const PortalFile file = ParsePortalFile(kGood, "x.prt");
    EXPECT_EQ(file.clusters, 2);
    ASSERT_EQ(file.portals.size(), 1u);
    ASSERT_EQ(file.faces.size(), 1u);
    EXPECT_THAT(file.portals[0].clusters, testing::ElementsAre(0, 1));
    EXPECT_TRUE(file.portals[0].isHint);
    EXPECT_TRUE(file.portals[0].isSky);
    EXPECT_EQ(file.portals[0].line, 5);
    EXPECT_THAT(file.Points(file.portals[0]), testing::ElementsAre(Vec3f(128, 0, 0), Vec3f(128, 64.5f, 0),
                                                                   Vec3f(128, 64, 100), Vec3f(128, -0.25f, 128)));
    EXPECT_THAT(file.faces[0].clusters, testing::ElementsAre(1, -1));
    EXPECT_THAT(file.Points(file.faces[0]), testing::ElementsAre(Vec3f(0, 0, 0), Vec3f(0, 64, 0), Vec3f(0, 64, 64)));
}

TEST(PortalFile, EmptyWorldHasNoPortals) {
    const PortalFile file = ParsePortalFile("PRT1\r\n1\r\n0\r\n0\r\n", "x.prt");
    EXPECT_EQ(file.clusters, 1);
    EXPECT_TRUE(file.portals.empty());
}

TEST(PortalFile, DamageIsNamedWithItsLine) {
    EXPECT_EQ(ErrorOf(""), "x.prt:1: the file ends, expected PRT1, which portal files begin with");
    EXPECT_EQ(ErrorOf("PRT2\n"), "x.prt:1: \"PRT2\", expected PRT1, which portal files begin with");
    EXPECT_EQ(ErrorOf("PRT1\nmany\n"), "x.prt:2: \"many\", expected a number of clusters of 0 to 16384");
    EXPECT_EQ(ErrorOf("PRT1\n2\n-1\n"), "x.prt:3: \"-1\", expected a number of portals of 0 to 65536");
    EXPECT_EQ(ErrorOf(Replaced("4 0 1 3", "4 0 2 3")), "x.prt:5: \"2\", expected a cluster of 0 to 1");
    EXPECT_EQ(ErrorOf(Replaced("4 0 1 3", "4 1 1 3")), "x.prt:5: \"1\", expected two different clusters");
    EXPECT_EQ(ErrorOf(Replaced("4 0 1 3", "4 0 1 4")), "x.prt:5: \"4\", expected flags of 0 to 3");
    EXPECT_EQ(ErrorOf(Replaced("4 0 1 3", "2 0 1 3")), "x.prt:5: \"2\", expected points of a portal of 3 to 512");
    EXPECT_EQ(ErrorOf(Replaced("4 0 1 3", "5 0 1 3")), "x.prt:6: \"3\", expected ( before a point");
    EXPECT_EQ(ErrorOf(Replaced("1e2", "nan")), "x.prt:5: \"nan\", expected a coordinate within 1048576 units");
    EXPECT_EQ(ErrorOf(Replaced("1e2", "1e9")), "x.prt:5: \"1e9\", expected a coordinate within 1048576 units");
    EXPECT_EQ(ErrorOf(Replaced("3 1 (0", "3 2 (0")), "x.prt:6: \"2\", expected a cluster of 0 to 1");
    EXPECT_EQ(ErrorOf(kGood + "7"), "x.prt:7: \"7\", expected the end after 1 portals and 1 faces");
}

TEST(PortalFile, EveryTruncationIsRefused) {
    const std::size_t end = kGood.find_last_of(')') + 1;
    for (std::size_t length = 0; length < end; ++length)
        EXPECT_THROW(ParsePortalFile(std::string_view(kGood).substr(0, length), "x.prt"), Error) << length;
}

} // namespace

} // namespace q3::test
