// GPL-2.0-or-later. Texture coordinates of brush sides in the forms of the map language.
#include "tests/map/map_fixture.h"

#include <array>
#include <numbers>
#include <random>

namespace q3::test {

namespace {

/// Width and height of textures/small.tga, and of images that are not there.
constexpr double kSmallWidth = 16, kSmallHeight = 1, kMissing = 64;

std::array<double, 2> At(const TextureProjection &projection, const Vec3d &p) {
    std::array<double, 2> st{};
    for (std::size_t row = 0; row < 2; ++row)
        st[row] = projection.vecs[row][0] * p.x + projection.vecs[row][1] * p.y + projection.vecs[row][2] * p.z +
                  projection.vecs[row][3];
    return st;
}

/// A cube of 64 with `side` after the points of its upper side, or of those along x or y.
std::string Cube(std::size_t face, std::string_view side) {
    const std::vector<Plane> planes = BoxPlanes({0, 0, 0}, {64, 64, 64});
    std::string text = "{\n" + fmt::format("{} {}\n", PointsText(planes[face]), side);
    for (std::size_t i = 0; i < planes.size(); ++i)
        if (i != face)
            text +=
                fmt::format("{} wall {}\n", PointsText(planes[i]),
                            side.find('[') == std::string_view::npos ? "0 0 0 1 1" : "[ 1 0 0 0 ] [ 0 1 0 0 ] 0 1 1");
    return text + "}\n";
}

constexpr std::array<std::size_t, 3> kFaces{0, 2, 4}; // +x, +y, +z
/// Their numbers among the sides of a brush.
constexpr std::array<std::size_t, 3> kSides{1, 3, 5};

} // namespace

TEST_F(MapTest, ClassicTextureIsTurnedScaledAndShiftedOnItsAxisPlane) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> shift(-200, 200), angle(-360, 360), scale(0.1, 3), place(-500, 500);
    for (int i = 0; i < 24; ++i) {
        const std::size_t face = std::size_t(i) % 3;
        const double sShift = shift(random), tShift = shift(random), sScale = scale(random), tScale = -scale(random);
        const double degrees = i < 12 ? 90.0 * (i / 3) : angle(random), turn = degrees / 180 * std::numbers::pi;
        Map map = Read(WorldText(
            Cube(kFaces[face], fmt::format("small {} {} {} {} {}", sShift, tShift, degrees, sScale, tScale))));
        const BrushSide &side = map.World().brushes.at(0).sides[kSides[face]];
        const Vec3d p{place(random), place(random), place(random)};
        // Across and down on the face as an editor's axis view shows it.
        const double across = face == 0 ? p.y : p.x, up = face == 2 ? p.y : p.z;
        const double s = (across * std::cos(turn) + up * std::sin(turn)) / sScale + sShift;
        const double t = (across * std::sin(turn) - up * std::cos(turn)) / tScale + tShift;
        const auto found = At(side.texture, p);
        // Whole images make no difference.
        EXPECT_NEAR(std::remainder(found[0] - s / kSmallWidth, 1), 0, 1e-6);
        EXPECT_NEAR(std::remainder(found[1] - t / kSmallHeight, 1), 0, 1e-6);
    }
}

TEST_F(MapTest, ClassicShiftsAreWrappedUnlessTheTextureIsGlobal) {
    Map wrapped = Read(WorldText(Cube(4, "wall 130 -3 0 1 1")));
    const auto shift = At(wrapped.World().brushes.at(0).sides[5].texture, {});
    EXPECT_NEAR(shift[0], 2 / kMissing, 1e-9);
    EXPECT_NEAR(shift[1], 61 / kMissing, 1e-9);
    Map global = Read(WorldText(Cube(4, "global 130 -3 0 1 1")));
    EXPECT_NEAR(At(global.World().brushes.at(0).sides[5].texture, {})[0], 130 / kMissing, 1e-9);
}

TEST_F(MapTest, ScaleZeroCountsAsOne) {
    Map map = Read(WorldText(Cube(4, "wall 0 0 0 0 0")));
    const auto st = At(map.World().brushes.at(0).sides[5].texture, {32, 16, 0});
    EXPECT_NEAR(st[0], 32 / kMissing, 1e-9);
    EXPECT_NEAR(st[1], -16 / kMissing, 1e-9);
}

TEST_F(MapTest, AxesWithoutExtentAreReplacedAndNamed) {
    constexpr std::string_view bad[] = {
        "[ 1 0 0 0 ] [ 1 0 0 0 ] 0 1 1",   // equal
        "[ 1 0 0 0 ] [ -3 0 7 9 ] 0 1 1",  // in one line on the side
        "[ 1 0 0 0 ] [ 0 0 -1 0 ] 0 1 1",  // along the normal
        "[ 0 0 0 5 ] [ 0 1 0 0 ] 0 1 1",   // of no length
        "[ 1 0 0 0 ] [ 0 1 0 0 ] 0 1 1e40" // beyond all measure
    };
    for (const std::string_view axes : bad) {
        out.text.clear();
        out.log.FlushWarnings();
        Map map = Read(WorldText(Cube(4, fmt::format("wall {}", axes))));
        const auto &vecs = map.World().brushes.at(0).sides[5].texture.vecs;
        const double perUnit = 1 / (0.5 * kMissing); // the scale of editors
        EXPECT_DOUBLE_EQ(std::abs(vecs[0][0] * vecs[1][1] - vecs[0][1] * vecs[1][0]), perUnit * perUnit) << axes;
        EXPECT_THAT(out.text, testing::HasSubstr("Entity 0, Brush 0: maps/test.map:4: the texture wall has no extent"));
    }
    for (const std::string_view matrix : {"( ( 0 0 0 ) ( 0 0 0 ) )", "( ( 1 2 0 ) ( -2 -4 0 ) )"}) {
        std::string text = "{\nbrushDef\n{\n";
        for (const Plane &plane : BoxPlanes({0, 0, 0}, {64, 64, 64}))
            text += fmt::format("{} {} wall 0 0 0\n", PointsText(plane), matrix);
        Map map = Read(WorldText(text + "}\n}\n"));
        for (std::size_t side = 0; side < 6; ++side) {
            const auto &vecs = map.World().brushes.at(0).sides[side].texture.vecs;
            const Vec3d s{vecs[0][0], vecs[0][1], vecs[0][2]}, t{vecs[1][0], vecs[1][1], vecs[1][2]};
            EXPECT_NEAR(Length(Cross(s, t)), 1 / (0.25 * kMissing * kMissing), 1e-9) << side;
        }
    }
}

TEST_F(MapTest, ValveAxesAreTakenAsTheyAre) {
    Map map = Read(WorldText(Cube(4, "small [ 0.6 0.8 0.1 130 ] [ -0.8 0.6 0 -7 ] 33 2 0.5")));
    const auto st = At(map.World().brushes.at(0).sides[5].texture, {10, 20, 30});
    EXPECT_NEAR(st[0], ((0.6 * 10 + 0.8 * 20 + 0.1 * 30) / 2 + 130) / kSmallWidth, 1e-9);
    EXPECT_NEAR(st[1], ((-0.8 * 10 + 0.6 * 20) / 0.5 - 7) / kSmallHeight, 1e-9);
}

TEST_F(MapTest, BrushPrimitiveMatrixActsOnTheAxesOfThePlane) {
    std::string text = "{\nbrushDef\n{\n\"key\" \"value\"\n";
    for (const Plane &plane : BoxPlanes({0, 0, 0}, {64, 64, 64}))
        text += PointsText(plane) + " ( ( 0.5 0.25 3 ) ( 0.125 2 -1 ) ) small 0 0 0\n";
    Map map = Read(WorldText(text + "}\n}\n"));
    const Brush &brush = map.World().brushes.at(0);
    const Vec3d p{7, 11, 13};
    const auto expect = [&](std::size_t side, double x, double y) {
        const auto st = At(brush.sides[side].texture, p);
        EXPECT_NEAR(st[0], 0.5 * x + 0.25 * y + 3, 1e-9) << side;
        EXPECT_NEAR(st[1], 0.125 * x + 2 * y - 1, 1e-9) << side;
    };
    expect(1, p.y, -p.z);  // +x
    expect(0, -p.y, -p.z); // -x
    expect(3, -p.x, -p.z); // +y
    expect(5, p.y, p.x);   // +z
    expect(4, p.y, -p.x);  // -z
}

TEST_F(MapTest, PlaneFormOfBrushesGivesTheSameBrush) {
    std::string text = "{\nbrushDef3\n{\n";
    for (const Plane &plane : BoxPlanes({0, 16, 0}, {64, 64, 64}))
        text += fmt::format("( {} {} {} {} ) ( ( 1 0 0 ) ( 0 1 0 ) ) \"textures/wall\" 0 0 0\n", plane.normal.x * 2,
                            plane.normal.y * 2, plane.normal.z * 2, -plane.dist * 2);
    Map map = Read(WorldText(text + "}\n}\n"));
    const Brush &brush = map.World().brushes.at(0);
    EXPECT_EQ(brush.bounds.mins, (Vec3f{0, 16, 0}));
    EXPECT_EQ(brush.bounds.maxs, (Vec3f{64, 64, 64}));
    EXPECT_EQ(brush.sides[0].shader->name, "textures/wall");
}

TEST_F(MapTest, VectorsOfTheShaderReplaceAxes) {
    Map map = Read(WorldText(Cube(4, "vectors 5 5 45 2 2")));
    const auto st = At(map.World().brushes.at(0).sides[5].texture, {64, 64, 64});
    EXPECT_NEAR(st[0], 0.5, 1e-6);
    EXPECT_NEAR(st[1], 0.25, 1e-6);
}

TEST_F(MapTest, FlatOptionUsesOneTexel) {
    bspOptions.flat = true;
    Map map = Read(WorldText(Cube(4, "small 5 5 45 2 2")));
    const TextureProjection &texture = map.World().brushes.at(0).sides[5].texture;
    EXPECT_EQ(At(texture, {0, 0, 0}), At(texture, {64, 5, 64}));
}

TEST_F(MapTest, AbsurdAxesGiveFiniteCoordinates) {
    Map map = Read(WorldText(Cube(4, "wall 1e300 0 0 1e-300 1")));
    const auto st = At(map.World().brushes.at(0).sides[5].texture, {65536, 65536, 65536});
    EXPECT_LT(std::abs(st[0]), 1e38);
    EXPECT_LT(std::abs(st[1]), 1e38);
}

} // namespace q3::test
