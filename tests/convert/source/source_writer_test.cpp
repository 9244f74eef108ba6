// GPL-2.0-or-later. Map sources from one form of brushes to another.
#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/convert/source/source_from_bsp.h"
#include "q3map2/convert/source/source_writer.h"
#include "q3map2/map/map_parse.h"
#include "tests/support/library_fixture.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>
#include <random>

namespace q3::test {

namespace {

constexpr std::array kForms{MapForm::Classic, MapForm::Primitive, MapForm::Valve};
constexpr double kTexels = 64; ///< of images that are not there

/// A roof and a box, detail and not, of the three forms of sides; a group, an entity with an origin brush and a patch.
constexpr std::string_view kTown = R"(
// entity 0
{
"classname" "worldspawn"
"message" "a \ b; // c"
{
( -64 0 0 ) ( -64 128 0 ) ( 0 0 96 ) roof 16 -24 30 0.5 -0.25 134217728 0 0
( 64 0 0 ) ( 0 0 96 ) ( 64 128 0 ) roof 3.5 7 0 0.5 0.5 134217728 0 0
( 0 0 0 ) ( 0 0 96 ) ( 64 0 0 ) side 0 0 180 1 1 134217728 0 0
( 0 128 0 ) ( 64 128 0 ) ( 0 128 96 ) side 0 0 -90 1 2 134217728 0 0
( 0 0 0 ) ( 64 0 0 ) ( 0 128 0 ) side 200 300 45 0.3 0.7 134217728 0 0
}
{
brushDef
{
( 300 300 64 ) ( 300 0 64 ) ( 0 300 64 ) ( ( 0.03 0.01 5.25 ) ( -0.01 0.03 -7.5 ) ) top 0 4 5
( 300 300 0 ) ( 0 300 0 ) ( 300 0 0 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) top 0 0 0
( 300 0 0 ) ( 300 0 64 ) ( 300 300 0 ) ( ( 0.0625 0 0 ) ( 0 0.03125 0.5 ) ) top 0 0 0
( 200 0 0 ) ( 200 300 0 ) ( 200 0 64 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) top 0 0 0
( 0 300 0 ) ( 300 300 0 ) ( 0 300 64 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) top 0 0 0
( 0 200 0 ) ( 0 200 64 ) ( 300 200 0 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) top 0 0 0
}
}
{
patchDef2
{
bend
( 3 3 0 7 0 )
(
( ( 0 0 0 0 0 ) ( 0 32 8.1 0 0.5 ) ( 0 64 0 0 1 ) )
( ( 32 0 8 0.5 0 ) ( 32 32 16 0.5 0.5 ) ( 32 64 8 0.5 1 ) )
( ( 64 0 0 1 0 ) ( 64 32 8 1 0.5 ) ( 64 64 0.0000001 1 1 ) )
)
}
}
}
{
"classname" "func_group"
"target" "kept"
{
( -500 0 0 ) ( -500 64 0 ) ( -500 0 64 ) group [ 0 0.8 0.6 12 ] [ 0.6 0 -0.8 -90 ] 0 0.5 0.25 0 0 0
( -400 0 0 ) ( -400 0 64 ) ( -400 64 0 ) group [ 0 1 0 0 ] [ 0 0 -1 0 ] 0 1 1 0 0 0
( 0 0 0 ) ( 0 0 64 ) ( 64 0 0 ) group [ 1 0 0 0 ] [ 0 0 -1 0 ] 0 1 1 0 0 0
( 0 64 0 ) ( 64 64 0 ) ( 0 64 64 ) group [ 1 0 0 0 ] [ 0 0 -1 0 ] 0 1 1 0 0 0
( 0 0 0 ) ( 64 0 0 ) ( 0 64 0 ) group [ 1 0 0 0 ] [ 0 -1 0 0 ] 0 1 1 0 0 0
( 0 0 64 ) ( 0 64 64 ) ( 64 0 64 ) group [ 1 0 0 0 ] [ 0 -1 0 0 ] 0 1 1 0 0 0
}
}
{
"classname" "light"
"origin" "1 2 3"
}
)";

/// Sides of all brushes, with what a reader makes of them.
std::vector<const BrushSide *> SidesOf(const Map &map) {
    std::vector<const BrushSide *> sides;
    for (const MapEntity &entity : map.entities)
        for (const Brush &brush : entity.brushes)
            for (const BrushSide &side : brush.sides)
                if (!side.winding.empty())
                    sides.push_back(&side);
    return sides;
}

double CoordinateAt(const std::array<double, 4> &row, const Vec3f &p) {
    return row[0] * double(p.x) + row[1] * double(p.y) + row[2] * double(p.z) + row[3];
}

/// Largest difference of texture coordinates at the corners of a side but for whole images, texels.
double TextureDifference(const BrushSide &a, const BrushSide &b) {
    double largest = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const auto at = [&](const Vec3f &p) {
            return CoordinateAt(a.texture.vecs[i], p) - CoordinateAt(b.texture.vecs[i], p);
        };
        const double whole = std::round(at(a.winding.front()));
        for (const Vec3f &p : a.winding)
            largest = std::max(largest, std::abs(at(p) - whole) * kTexels);
    }
    return largest;
}

class SourceFormsTest : public LibraryTest {
  protected:
    SourceFormsTest() {
        options.imageSizes = true;
        folder.Write("scripts/test.shader", "textures/common/origin\n{\nsurfaceparm origin\nsurfaceparm nodraw\n}\n");
        Load();
    }
    BspContext Context() { return {bspOptions, *FindGame("quake3"), *library, out.log, vfs.get()}; }
    std::string Converted(std::string_view text, MapForm form) {
        return ConvertedSource(text, "maps/test.map", form, Context());
    }
    Map Read(std::string_view text) { return ReadMap(text, "maps/test.map", Context()); }
    std::string World(std::string_view body) { return fmt::format("{{\n\"classname\" \"worldspawn\"\n{}}}\n", body); }

    BspOptions bspOptions;
};

} // namespace

TEST_F(SourceFormsTest, EveryFormReadsAsTheSourceDid) {
    const Map before = Read(kTown);
    for (const MapForm form : kForms) {
        const Map after = Read(Converted(kTown, form));
        const auto old = SidesOf(before), made = SidesOf(after);
        ASSERT_EQ(made.size(), old.size());
        for (std::size_t i = 0; i < old.size(); ++i) {
            EXPECT_EQ(made[i]->plane.normal, old[i]->plane.normal);
            EXPECT_EQ(made[i]->plane.dist, old[i]->plane.dist);
            EXPECT_EQ(made[i]->shader->name, old[i]->shader->name);
            EXPECT_EQ(made[i]->compileFlags, old[i]->compileFlags);
            // The group has a texture that is sheared, which the classic form cannot hold.
            if (form != MapForm::Classic || old[i]->shader->name != "textures/group") {
                EXPECT_LT(TextureDifference(*old[i], *made[i]), 0.001) << int(form) << ' ' << old[i]->shader->name;
            }
        }
        ASSERT_EQ(after.entities.size(), before.entities.size());
        for (std::size_t i = 0; i < before.entities.size(); ++i)
            EXPECT_EQ(after.entities[i].pairs.pairs, before.entities[i].pairs.pairs);
    }
    EXPECT_EQ(Warnings("sheared texture"), 1);
}

TEST_F(SourceFormsTest, FormsThroughEachOtherGiveTheFirst) {
    const Map before = Read(kTown);
    for (const MapForm first : {MapForm::Primitive, MapForm::Valve})
        for (const MapForm second : {MapForm::Primitive, MapForm::Valve}) {
            const Map after = Read(Converted(Converted(kTown, first), second));
            const auto old = SidesOf(before), made = SidesOf(after);
            ASSERT_EQ(made.size(), old.size());
            for (std::size_t i = 0; i < old.size(); ++i)
                EXPECT_LT(TextureDifference(*old[i], *made[i]), 0.001);
        }
}

TEST_F(SourceFormsTest, ClassicNumbersComeBackAsTheyWere) {
    const std::string text = Converted(kTown, MapForm::Classic);
    EXPECT_THAT(text, testing::HasSubstr("( -64 0 0 ) ( -64 128 0 ) ( 0 0 96 ) roof 16 40 30 0.5 -0.25 134217728 0 0"));
    EXPECT_THAT(text, testing::HasSubstr("side 8 44 45 0.3 0.7 134217728 0 0"));
    // A half turn is the same as negative scales.
    EXPECT_THAT(text, testing::HasSubstr("side 0 0 0 -1 -1 134217728 0 0"));
}

TEST_F(SourceFormsTest, ValveAndPrimitiveNumbersAreThoseOfTheClassicSide) {
    // s = x / 0.5 + 16, t = -y / 0.25 + 8 texels, on a face that looks up.
    const std::string text = World("{\n( 0 0 64 ) ( 0 64 64 ) ( 64 0 64 ) wall 16 8 0 0.5 0.25 0 0 0\n}\n");
    EXPECT_THAT(Converted(text, MapForm::Valve), testing::HasSubstr("wall [ 1 0 0 16 ] [ 0 -1 0 8 ] 0 0.5 0.25 0 0 0"));
    // In images: s = y' / 32 + 0.25 with y' = x, and t = -x' / 16 + 0.125 with x' = y.
    EXPECT_THAT(Converted(text, MapForm::Primitive),
                testing::HasSubstr("( ( 0 0.03125 0.25 ) ( -0.0625 0 0.125 ) ) wall 0 0 0"));
}

TEST_F(SourceFormsTest, GroupsFlagsPatchesAndOrderStay) {
    for (const MapForm form : kForms) {
        const std::string text = Converted(kTown, form);
        EXPECT_THAT(text, testing::HasSubstr("\"classname\" \"func_group\"\n\t\"target\" \"kept\""));
        EXPECT_THAT(text, testing::HasSubstr("\"message\" \"a \\ b; // c\""));
        EXPECT_THAT(text, testing::HasSubstr(" 0 4 5\n"));
        EXPECT_THAT(text, testing::HasSubstr("( 3 3 0 7 0 )"));
        EXPECT_THAT(text, testing::HasSubstr("( 0 32 8.1 0 0.5 )"));
        EXPECT_THAT(text, testing::HasSubstr("0.0000001 1 1 )"));
        EXPECT_LT(text.find(" roof "), text.find(" top "));
        EXPECT_LT(text.find(" top "), text.find("patchDef2"));
    }
}

TEST_F(SourceFormsTest, PlaneNumbersOfBrushDef3BecomePoints) {
    const std::string cube = World("{\nbrushDef3\n{\n"
                                   "( 0 0 1 -64 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) \"textures/wall\" 0 0 0\n"
                                   "( 0 0 -1 0 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) \"textures/wall\" 0 0 0\n"
                                   "( 1 0 0 -64 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) \"textures/wall\" 0 0 0\n"
                                   "( -1 0 0 0 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) \"textures/wall\" 0 0 0\n"
                                   "( 0 1 0 -64 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) \"textures/wall\" 0 0 0\n"
                                   "( 0 -1 0 0 ) ( ( 0.0625 0 0 ) ( 0 0.0625 0 ) ) \"textures/wall\" 0 0 0\n}\n}\n");
    for (const MapForm form : kForms) {
        const Map map = Read(Converted(cube, form));
        ASSERT_EQ(map.entities[0].brushes.size(), 1u);
        const Brush &brush = map.entities[0].brushes[0];
        EXPECT_EQ(brush.bounds.mins, (Vec3f{0, 0, 0}));
        EXPECT_EQ(brush.bounds.maxs, (Vec3f{64, 64, 64}));
        EXPECT_EQ(brush.sides[0].shader->name, "textures/wall");
    }
}

TEST_F(SourceFormsTest, NamesThatNeedQuotesGetThem) {
    const std::string text = World("{\n( 0 0 64 ) ( 0 64 64 ) ( 64 0 64 ) \"my wall\" 0 0 0 1 1 0 0 0\n}\n");
    EXPECT_THAT(Converted(text, MapForm::Valve), testing::HasSubstr(" \"my wall\" [ "));
    for (const std::string_view name : {"//a", "/*a", "#a"}) {
        const std::string side = fmt::format("( 0 0 64 ) ( 0 64 64 ) ( 64 0 64 ) \"{}\" 0 0 0 1 1 0 0 0", name);
        EXPECT_THAT(Converted(World("{\n" + side + "\n}\n"), MapForm::Valve),
                    testing::HasSubstr(fmt::format(" \"{}\" [ ", name)));
    }
}

TEST_F(SourceFormsTest, QuotesInKeysBecomeApostrophes) {
    const std::string text = Converted(World("a\"b \"x\"\n\"c\" d\"e\n"), MapForm::Valve);
    EXPECT_THAT(text, testing::HasSubstr("\t\"a'b\" \"x\"\n\t\"c\" \"d'e\"\n"));
    Read(text);
}

TEST_F(SourceFormsTest, WhatIsNoMapIsAnError) {
    EXPECT_THROW(Converted("", MapForm::Valve), Error);
    EXPECT_THROW(Converted(World("{\n( 0 0 64 ) ( 0 64 64 ) 64 0 64 ) wall 0 0 0 1 1\n}\n"), MapForm::Valve), Error);
    EXPECT_THROW(Converted(World("{\nbrushDef4\n{\n}\n}\n"), MapForm::Valve), Error);
}

TEST_F(SourceFormsTest, FlatSidesAndFlatTexturesStayReadable) {
    // Points in one line, and a texture that does not change along the face.
    const std::string text =
        World("{\n( 0 0 0 ) ( 1 0 0 ) ( 2 0 0 ) wall 0 0 0 1 1 0 0 0\n}\n"
              "{\n( 0 0 64 ) ( 0 64 64 ) ( 64 0 64 ) wall [ 0 0 1 0 ] [ 0 -1 0 0 ] 0 1 1 0 0 0\n}\n");
    EXPECT_THAT(Converted(text, MapForm::Classic), testing::HasSubstr("( 0 0 0 ) ( 1 0 0 ) ( 2 0 0 ) wall"));
    EXPECT_EQ(Warnings("texture without extent"), 1);
}

TEST(PlanePoints, ReadAsTheStoredPlane) {
    std::mt19937 random(7);
    std::normal_distribution<double> direction;
    std::uniform_real_distribution<double> place(-4096, 4096);
    for (int i = 0; i < 2000; ++i) {
        Vec3d exact = Normalize(Vec3d{direction(random), direction(random), i % 3 == 0 ? 0 : direction(random)});
        if (i % 10 == 0)
            exact = {0, i % 20 == 0 ? 1.0 : -1.0, 0};
        const Vec3f normal(exact);
        const float dist = float(place(random));
        const PlanePoints points = PointsOfPlane({Vec3d(normal), double(dist)}, {});
        std::array<Vec3d, 3> read;
        for (std::size_t k = 0; k < 3; ++k) {
            std::string_view rest = points.points[k];
            ASSERT_TRUE(rest.starts_with("( "));
            rest.remove_prefix(2);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::optional<double> number = TakeNumber(rest);
                ASSERT_TRUE(number) << points.points[k];
                read[k][axis] = *number;
            }
        }
        const Plane plane = PlaneThrough(read);
        EXPECT_EQ(Vec3f(plane.normal), normal) << i;
        EXPECT_EQ(float(plane.dist), dist) << i;
    }
}

TEST(PlanePoints, CornersServeWhereFewDigitsDo) {
    const Winding<double> square{{0, 0, 64}, {0, 64, 64}, {64, 64, 64}, {64, 0, 64}};
    for (const double sign : {1.0, -1.0}) {
        const PlanePoints points = PointsOfPlane({{0, 0, sign}, sign * 64}, square);
        EXPECT_EQ(points.plane.normal, (Vec3d{0, 0, sign}));
        EXPECT_EQ(points.plane.dist, sign * 64);
        EXPECT_EQ(points.points[0], "( 0 0 64 )");
    }
}

TEST(SourceNumbers, HaveNoExponent) {
    EXPECT_EQ(FixedText(0.5, 8), "0.5");
    EXPECT_EQ(FixedText(-1e-12, 6), "0");
    EXPECT_EQ(FixedText(120, 0), "120");
    EXPECT_EQ(ExactText(1e-7), "0.0000001");
    EXPECT_EQ(ExactText(0.1f), "0.1");
    EXPECT_EQ(ExactText(-1.5e22), "-15000000000000000000000");
    EXPECT_EQ(NumberFromText(ExactText(1.0 / 3 * 1e-9)), 1.0 / 3 * 1e-9);
}

} // namespace q3::test
