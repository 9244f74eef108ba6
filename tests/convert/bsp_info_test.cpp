// GPL-2.0-or-later. The table of -info.
#include "q3map2/convert/bsp_info.h"
#include "tests/support/small_bsp.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;
using testing::Not;

std::string Info(const Bsp &bsp, std::uintmax_t fileBytes = 3000000) {
    KeptLog log;
    PrintBspInfo("maps/small.bsp", bsp, fileBytes, log.log);
    return log.text;
}

TEST(BspInfo, PrintsTheEstablishedTable) {
    EXPECT_EQ(Info(SmallBsp()), R"(---------------------------------
maps/small.bsp
Abstracted BSP file components (*actual sizes may differ)
        1 models                40
        2 shaders              144
        1 brushes               12
        6 brushsides            72 * (48 in the file)
        1 fogs                  72
       12 planes               192
        2 entdata               72

        1 nodes                 36
        3 leafs                144
        1 leafsurfaces           4
        1 leafbrushes            4

        1 drawsurfaces         148 * (104 in the file)
        0   patch surfaces
        1   planar surfaces
        0   trisoup surfaces
        4 drawverts            320 * (176 in the file)
        6 drawindexes           24

        0 lightmaps              0
        2 lightgrid             60 * (16 in the file)
          visibility            16

          total            3000000
                              2929 KB
                                 2 MB
---------------------------------
)");
}

TEST(BspInfo, CountsFlaresOnlyWhenThereAreSome) {
    Bsp bsp = SmallBsp();
    EXPECT_THAT(Info(bsp), Not(HasSubstr("flare")));
    bsp.drawSurfaces.push_back(bsp.drawSurfaces[0]);
    bsp.drawSurfaces[1].surfaceType = MST_FLARE;
    EXPECT_THAT(Info(bsp), HasSubstr("        1   flare surfaces\n"));
}

TEST(BspInfo, CountsTheEntitiesOfEveryFile) {
    KeptLog log;
    Bsp bsp = SmallBsp();
    PrintBspInfo("a.bsp", bsp, 1, log.log);
    bsp.entities += "{\n\"classname\" \"light\"\n}\n";
    PrintBspInfo("b.bsp", bsp, 1, log.log);
    EXPECT_THAT(log.text, HasSubstr("        2 entdata               72\n"));
    EXPECT_THAT(log.text, HasSubstr("        3 entdata               96\n"));
}

TEST(BspInfo, ShowsTheGridSH) {
    const std::string text = Info(FullBsp(GridSHContainer::Bspx));
    EXPECT_THAT(text, HasSubstr("        4 SH light grid        472\n"));
    EXPECT_THAT(text, HasSubstr("cells of 70 x 32 x 64 units, 2 x 1 x 2 points\n"));
    EXPECT_THAT(text, HasSubstr("from ( 0 0 0 ) to ( 70 0 64 )\n"));
    EXPECT_THAT(text, HasSubstr("stored in BSPX lump LIGHTGRID_SH\n"));
    EXPECT_THAT(text, HasSubstr("coefficients are cosine-convolved\n"));
    EXPECT_THAT(Info(FullBsp(GridSHContainer::Lump)), HasSubstr("stored in lump 18\n"));
}

// The tree has one plane, x = 64, with solid behind it; points are at x = 0 and x = 70.
TEST(BspInfo, SharesFollowTheTree) {
    const std::string text = Info(FullBsp(GridSHContainer::Lump));
    EXPECT_THAT(text, HasSubstr("        2   lit points      50.0 %      0.00 MB\n"));
    EXPECT_THAT(text, HasSubstr("        1   filled points   25.0 %      0.00 MB\n"));
    EXPECT_THAT(text, HasSubstr("        1   void points     25.0 %      0.00 MB\n"));
}

TEST(BspInfo, NamesPlainProjection) {
    Bsp bsp = FullBsp(GridSHContainer::Lump);
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"_q3map2_sh\" \"radiance\"\n}\n";
    EXPECT_THAT(Info(bsp), HasSubstr("coefficients are radiance, not convolved (-shradiance)\n"));
}

TEST(BspInfo, NamesTheToneOfTheLightmaps) {
    Bsp bsp = SmallBsp();
    EXPECT_THAT(Info(bsp), Not(HasSubstr("tone")));
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"_q3map2_tone\" \"gamma 1.4 scale 0.5\"\n}\n";
    EXPECT_THAT(Info(bsp), HasSubstr("  tone: gamma 1.4 scale 0.5\n"));
}

TEST(BspInfo, ListsForeignLumpsAndAdvertisements) {
    const std::string text = Info(FullBsp(GridSHContainer::Lump));
    EXPECT_THAT(text, HasSubstr("        1 advertisements       128\n"));
    EXPECT_THAT(text, HasSubstr("     BSPX RGBLIGHTING            2\n"));
    EXPECT_THAT(Info(SmallBsp()), Not(HasSubstr("BSPX")));
}

TEST(BspInfo, BrokenEntityTextIsAWarning) {
    Bsp bsp = SmallBsp();
    bsp.entities = "{ broken";
    const std::string text = Info(bsp);
    EXPECT_THAT(text, HasSubstr("WARNING: "));
    EXPECT_THAT(text, HasSubstr("        0 entdata                9\n"));
}

} // namespace

} // namespace q3::test
