// GPL-2.0-or-later. Numbers of things, and sizes, as text.
#include "common/log.h"
#include "common/text/text.h"
#include "tests/support/game_folder.h"

namespace q3::test {

namespace {

TEST(CountedTest, OneThingIsSingular) {
    for (const auto &[plural, singular] : {std::pair{"threads", "thread"},
                                           {"entities", "entity"},
                                           {"vertices lit", "vertex lit"},
                                           {"brushes", "brush"},
                                           {"leafs with ambient cubes", "leaf with ambient cubes"},
                                           {"leaves", "leaf"},
                                           {"faces", "face"},
                                           {"bright patches", "bright patch"},
                                           {"meshes", "mesh"},
                                           {"textures", "texture"},
                                           {"SH grid points", "SH grid point"},
                                           {"diffuse (area) lights", "diffuse (area) light"},
                                           {"points in walls, lit from the open side", "point in walls, lit from the "
                                                                                       "open side"},
                                           {"can't order", "can't order"}}) {
        EXPECT_EQ(Counted(1, plural), std::string("1 ") + singular);
        EXPECT_EQ(Counted(2, plural), std::string("2 ") + plural);
        EXPECT_EQ(Counted(0, plural), std::string("0 ") + plural);
    }
}

TEST(CountedTest, LinesOfTheLogFollow) {
    KeptLog out;
    out.log.Count(1, "threads");
    out.log.Count(12, "entities");
    out.log.Warn("odd", "first");
    out.log.Warn("odd", "second");
    out.log.FlushWarnings();
    EXPECT_EQ(out.text, "        1 thread\n       12 entities\nWARNING: first\n"
                        "        1 more warning of this kind: odd (-v lists it)\n");
}

TEST(SizeTextTest, SmallFilesAreNotZero) {
    EXPECT_EQ(SizeText(1), "1 byte");
    EXPECT_EQ(SizeText(999), "999 bytes");
    EXPECT_EQ(SizeText(45678), "45.7 KB");
    EXPECT_EQ(SizeText(144200000), "144.2 MB");
}

} // namespace

} // namespace q3::test
