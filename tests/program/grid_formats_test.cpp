// GPL-2.0-or-later. -gridformats and the stage -convertgrid, as a user runs them.
#include "common/files/files.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "tests/support/game_folder.h"
#include "tests/support/run_program.h"

#include <algorithm>
#include <numbers>
#include <utility>

namespace q3::test {

namespace {

class GridFormatsTest : public ProgramTest {
  protected:
    Bsp Read(const std::filesystem::path &path) { return ReadBspFile(path, {}, quiet_.log); }
    Bsp ReadMap() { return Read(Map(".bsp")); }
    static const BspxLump *Find(const Bsp &bsp, std::string_view name) {
        const auto found = std::ranges::find(bsp.bspx, name, &BspxLump::name);
        return found == bsp.bspx.end() ? nullptr : &*found;
    }
    static int Version(const std::vector<std::byte> &file) { return IntOf(file, 4); }
    std::filesystem::path Raw() const { return Map("") / "lightgrid.raw"; }

    KeptLog quiet_;
};

/// Mean of all ambient bytes of points that are not black.
double MeanAmbient(const std::vector<bspGridPoint_t> &points) {
    double sum = 0, count = 0;
    for (const bspGridPoint_t &point : points)
        if (point.ambient[0] != std::array<std::uint8_t, 3>{})
            sum += point.ambient[0][0] + point.ambient[0][1] + point.ambient[0][2], count += 3;
    return sum / count;
}

/// Mean over all normals of the light of points that are not black: a quarter of directed light is seen.
double MeanSeen(const std::vector<bspGridPoint_t> &points) {
    double sum = 0, count = 0;
    for (const bspGridPoint_t &point : points)
        if (point.ambient[0] != std::array<std::uint8_t, 3>{}) {
            for (std::size_t i = 0; i < 3; ++i)
                sum += point.ambient[0][i] + point.directed[0][i] / 4.0;
            count += 3;
        }
    return sum / count;
}

bool SamePoints(const Bsp &a, const Bsp &b) {
    return std::ranges::equal(a.gridPoints, b.gridPoints,
                              [](const bspGridPoint_t &p, const bspGridPoint_t &q) { return p == q; });
}

TEST_F(GridFormatsTest, ALitMapHasTheGridsOfTheList) {
    RunWell("-light -fast -sh MAP");
    const Bsp lit = ReadMap();
    EXPECT_EQ(Version(MapBytes()), 47);
    RunWell("-convertgrid -gridformats shbspx,legacy-ioq3,raw-ioq3,octree,grids MAP");
    const Bsp all = ReadMap();
    EXPECT_EQ(Version(MapBytes()), 46);
    ASSERT_TRUE(all.gridSH);
    EXPECT_EQ(all.gridSH->points.size(), lit.gridSH->points.size());
    EXPECT_TRUE(Find(all, "LIGHTGRID_OCTREE") && Find(all, "LIGHTGRIDS"));
    EXPECT_EQ(all.gridPoints.size(), lit.gridPoints.size());
    EXPECT_FALSE(SamePoints(all, lit));
    EXPECT_EQ(std::filesystem::file_size(Raw()), 24 * all.gridPoints.size());
    EXPECT_TRUE(all.lightmaps == lit.lightmaps) << "light is not computed";

    const Outcome outcome = RunWell("-convertgrid -gridformats sh MAP");
    const Bsp back = ReadMap();
    EXPECT_EQ(Version(MapBytes()), 47);
    EXPECT_TRUE(back.bspx.empty()) << "the list names all grids of the map";
    EXPECT_TRUE(SamePoints(back, all)) << "lump 15 stays, engines need it";
    EXPECT_TRUE(outcome.Printed("lightgrid.raw is of an earlier run"));
}

// The fit shows what was traced, but for what the two grids place and round in other ways.
TEST_F(GridFormatsTest, TheFittedGridIsAsBrightAsTheTracedOne) {
    for (const std::string tone : {"", "-gamma 1.6 -compensate 1.5 "}) {
        RunWell("-light -fast -sh " + tone + "MAP");
        const double traced = MeanSeen(ReadMap().gridPoints);
        RunWell("-convertgrid -gridformats sh,legacy MAP");
        const double fitted = MeanSeen(ReadMap().gridPoints);
        EXPECT_NEAR(fitted / traced, 1, 0.2) << tone << traced << ' ' << fitted;
    }
}

TEST_F(GridFormatsTest, OneBakeDoesTheSame) {
    const auto before = MapBytes();
    RunWell("-light -fast -shbspx MAP");
    RunWell("-convertgrid -gridformats shbspx,legacy,octree,raw-rend2 MAP");
    const Bsp converted = ReadMap();
    const auto raw = ReadFile(Raw());
    ReplaceFile(Map(".bsp"), before);
    std::filesystem::remove(Raw());
    RunWell("-light -fast -shbspx -gridformats legacy,octree,raw-rend2 MAP");
    const Bsp baked = ReadMap();
    EXPECT_TRUE(SamePoints(baked, converted));
    EXPECT_TRUE(ReadFile(Raw()) == raw);
    EXPECT_TRUE(Find(baked, "LIGHTGRID_OCTREE")->data == Find(converted, "LIGHTGRID_OCTREE")->data);
    EXPECT_TRUE(baked.gridSH && baked.gridSHContainer == GridSHContainer::Bspx);

    const Outcome relit = RunWell("-light -fast MAP");
    EXPECT_TRUE(ReadMap().bspx.empty()) << "new light makes the octree wrong";
    EXPECT_TRUE(relit.Printed("lightgrid.raw is of an earlier run"));
}

TEST_F(GridFormatsTest, TheSHGridOfABakeStaysOnlyIfAskedFor) {
    RunWell("-light -fast -gridformats legacy-daemon,grids MAP");
    const Bsp without = ReadMap();
    EXPECT_FALSE(without.gridSH);
    EXPECT_EQ(Version(MapBytes()), 46);
    EXPECT_TRUE(Find(without, "LIGHTGRIDS"));
    RunWell("-light -fast -shradiance -gridformats legacy MAP");
    EXPECT_TRUE(ReadMap().gridSH);
    EXPECT_EQ(StoredWorld(ReadMap().entities).Value("_q3map2_sh"), "radiance");
    RunWell("-convertgrid -gridformats octree -out " + (maps_ / "other.bsp").string() + " MAP");
    const Bsp other = Read(maps_ / "other.bsp");
    EXPECT_FALSE(other.gridSH || StoredWorld(other.entities).Has("_q3map2_sh"));
}

TEST_F(GridFormatsTest, AFileInPlaceOfTheFolderIsFoundFirst) {
    RunWell("-light -fast -sh MAP");
    std::filesystem::remove_all(Map(""));
    ReplaceTextFile(Map(""), "no folder");
    ExpectError("-convertgrid -gridformats sh,raw-ioq3 MAP", "cannot write to this folder");
}

TEST_F(GridFormatsTest, RadianceGivesTheSameGrids) {
    RunWell("-light -fast -sh MAP");
    Bsp lit = ReadMap();
    RunWell("-convertgrid -gridformats sh,octree MAP");
    const Bsp plain = ReadMap();
    for (bspGridPointSH_t &point : lit.gridSH->points)
        for (std::size_t k = 0; k < 9; ++k)
            for (float &value : point.coeffs[k])
                value = float(double(value) / (std::numbers::pi * (k == 0 ? 1 : k < 4 ? 2.0 / 3 : 0.25)));
    std::vector<Entity> entities = StoredEntities(lit.entities, "test");
    entities.front().Set("_q3map2_sh", "radiance");
    lit.entities = FormatEntities(entities);
    WriteBspFile(Map(".bsp"), lit, {}, quiet_.log);
    RunWell("-convertgrid -gridformats sh,octree MAP");
    const Bsp radiance = ReadMap();
    const auto &a = Find(plain, "LIGHTGRID_OCTREE")->data, &b = Find(radiance, "LIGHTGRID_OCTREE")->data;
    ASSERT_EQ(a.size(), b.size());
    int most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, std::abs(std::to_integer<int>(a[i]) - std::to_integer<int>(b[i])));
    EXPECT_LE(most, 1) << "rounding";
    EXPECT_EQ(StoredWorld(radiance.entities).Value("_q3map2_sh"), "radiance");
}

TEST_F(GridFormatsTest, AmbientFactor) {
    RunWell("-light -fast -sh MAP");
    RunWell("-convertgrid -gridformats sh,legacy MAP");
    const double full = MeanAmbient(ReadMap().gridPoints);
    RunWell("-convertgrid -gridformats sh,legacy -gridambientscale 0.5 MAP");
    EXPECT_NEAR(MeanAmbient(ReadMap().gridPoints), full / 2, 1.5);
    RunWell("-light -fast -gridformats legacy -gridambientscale 0.5 MAP");
    EXPECT_NEAR(MeanAmbient(ReadMap().gridPoints), full / 2, 1.5);
}

/// Mean over the points of two grids of the difference of coefficient 0, and of the first one's.
std::pair<double, double> MeanDifference(const LightGridSH &a, const LightGridSH &b) {
    double off = 0, sum = 0;
    for (std::size_t i = 0; i < a.points.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            off += std::abs(double(a.points[i].coeffs[0][c]) - double(b.points[i].coeffs[0][c]));
            sum += double(a.points[i].coeffs[0][c]);
        }
    return {off / double(a.points.size()), sum / double(a.points.size())};
}

TEST_F(GridFormatsTest, SparseAndBack) {
    RunWell("-light -fast -shbspx MAP");
    const Bsp lit = ReadMap();
    RunWell("-convertgrid -gridformats sparse,shbspx MAP");
    const Bsp both = ReadMap();
    ASSERT_TRUE(both.sparseGridSH && both.gridSH);
    EXPECT_EQ(MeanDifference(*lit.gridSH, *both.gridSH).first, 0);
    const Outcome sparseOnly = RunWell("-convertgrid -gridformats sparse MAP");
    const Bsp sparse = ReadMap();
    EXPECT_EQ(Version(MapBytes()), 46);
    ASSERT_TRUE(sparse.sparseGridSH && !sparse.gridSH);
    EXPECT_TRUE(*sparse.sparseGridSH == *both.sparseGridSH) << "it stays";
    EXPECT_LT(EncodeSparseGrid(*sparse.sparseGridSH).size(), lit.gridSH->points.size() * sizeof(bspGridPointSH_t) / 2);

    RunWell("-convertgrid -gridformats sh,sparse MAP");
    const Bsp back = ReadMap();
    ASSERT_TRUE(back.gridSH && back.sparseGridSH);
    EXPECT_TRUE(*back.sparseGridSH == *sparse.sparseGridSH);
    EXPECT_EQ(back.gridSH->header.gridBounds, lit.gridSH->header.gridBounds);
    EXPECT_EQ(back.gridSH->header.gridMins, lit.gridSH->header.gridMins);
    const auto [off, mean] = MeanDifference(*lit.gridSH, *back.gridSH);
    EXPECT_LT(off, 0.05 * mean);

    const Outcome coarse = RunWell("-convertgrid -gridformats sh,sparse -sherrortarget 8 MAP");
    EXPECT_LT(ReadMap().sparseGridSH->points.size(), sparse.sparseGridSH->points.size() * 3 / 4);
    EXPECT_TRUE(coarse.Printed("expected error of interpolation"));
    RunWell("-convertgrid -gridformats sh,octree MAP");
    EXPECT_FALSE(ReadMap().sparseGridSH) << "the list names all grids of the map";
}

TEST_F(GridFormatsTest, SparseOfABakeIsTheAdaptiveOne) {
    const auto before = MapBytes();
    RunWell("-light -fast -shadaptive MAP");
    const Bsp adaptive = ReadMap();
    ASSERT_TRUE(adaptive.sparseGridSH && !adaptive.gridSH);
    ReplaceFile(Map(".bsp"), before);
    RunWell("-light -fast -gridformats sparse,octree MAP");
    const Bsp listed = ReadMap();
    ASSERT_TRUE(listed.sparseGridSH && !listed.gridSH);
    EXPECT_TRUE(*listed.sparseGridSH == *adaptive.sparseGridSH);
    EXPECT_TRUE(Find(listed, "LIGHTGRID_OCTREE"));
    RunWell("-light -fast -shadaptive -sh -gridformats grids MAP");
    EXPECT_TRUE(ReadMap().sparseGridSH && ReadMap().gridSH) << "options that store grids say so too";
    const Outcome outcome =
        RunWell("-light -fast -shadaptive -shdering -sherror -shpreview " + (maps_ / "grid.png").string() + " MAP");
    EXPECT_TRUE(outcome.Printed("CheckSparseGridSH") && !outcome.Printed("CheckGridSH"));
    EXPECT_TRUE(outcome.Printed("Sparse SH grid: "));
    EXPECT_TRUE(std::filesystem::exists(maps_ / "grid.png"));
    EXPECT_TRUE(RunWell("-info MAP").Printed("sparse SH grid"));
    RunWell("-light -fast MAP");
    EXPECT_FALSE(ReadMap().sparseGridSH) << "its light would be that of the run before";
}

TEST_F(GridFormatsTest, RadianceAddsNoGridToThoseThatAreNamed) {
    const auto stored = [&](const std::string &options) {
        RunWell("-light -fast -nogrid " + options + " MAP");
        const Bsp bsp = ReadMap();
        std::string grids;
        if (bsp.gridSH)
            grids += bsp.gridSHContainer == GridSHContainer::Lump ? "sh " : "shbspx ";
        grids += bsp.sparseGridSH ? "sparse " : "";
        grids += Find(bsp, "LIGHTGRID_OCTREE") ? "octree " : "";
        const bool isRadiance = StoredEntities(bsp.entities, "").front().Value("_q3map2_sh") == "radiance";
        EXPECT_EQ(isRadiance, options.find("-shradiance") != std::string::npos) << options;
        return grids;
    };
    EXPECT_EQ(stored("-gridformats sparse"), "sparse ");
    EXPECT_EQ(stored("-shradiance -gridformats sparse"), "sparse ");
    EXPECT_EQ(stored("-shradiance -gridformats shbspx"), "shbspx ");
    EXPECT_EQ(stored("-shradiance -gridformats octree"), "sh octree ") << "it includes -sh";
    EXPECT_EQ(stored("-shradiance -shadaptive"), "sparse ");
    EXPECT_EQ(stored("-shradiance -shadaptive -gridformats octree"), "sparse octree ");
    EXPECT_EQ(stored("-shradiance -shadaptive -gridformats sh"), "sh sparse ");
    EXPECT_EQ(stored("-shradiance -shbspx -gridformats sparse"), "shbspx sparse ");
    EXPECT_EQ(stored("-shadaptive -gridformats octree"), "sparse octree ");
}

TEST_F(GridFormatsTest, Errors) {
    ExpectError("-convertgrid -gridformats shbspx,octree MAP", "no SH light grid");
    ExpectError("-convertgrid MAP", "-convertgrid needs -gridformats LIST");
    ExpectError("-convertgrid -gridformats sh,best MAP", "\"best\" is not a format");
    ExpectError("-light -gridformats sh -shbspx MAP", "sh and shbspx exclude each other");
    ExpectError("-light -gridformats octree -shpreview a.png MAP", "-shpreview needs sh, shbspx or sparse");
    ExpectError("-convertgrid -gridformats sh,octree -shbudget 1 MAP", "need sparse in -gridformats");
    RunWell("-light -fast -sh MAP");
    ExpectError("-convertgrid -gridformats octree MAP", "would lose its SH grid");
    ExpectError("-convertgrid -gridformats octree -out MAP MAP", "would lose its SH grid");
}

} // namespace

} // namespace q3::test
