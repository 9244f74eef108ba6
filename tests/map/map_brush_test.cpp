// GPL-2.0-or-later. Brushes: windings, contents, bevels.
#include "q3map2/map/map_brush.h"
#include "tests/map/map_fixture.h"

#include <algorithm>
#include <random>

namespace q3::test {

namespace {

int Bevels(const Brush &brush, std::size_t first, std::size_t last) {
    int count = 0;
    for (std::size_t i = first; i < std::min(last, brush.sides.size()); ++i)
        count += brush.sides[i].bevel;
    return count;
}

double SurfaceArea(const Brush &brush) {
    double area = 0;
    for (const BrushSide &side : brush.sides)
        area += WindingArea(side.winding);
    return area;
}

/// Volume by the divergence theorem.
double VolumeOf(const Brush &brush, const PlaneTable &planes) {
    double volume = 0;
    for (const BrushSide &side : brush.sides)
        volume += WindingArea(side.winding) * planes[side.planeNum].dist / 3;
    return volume;
}

/// A solid around the origin with faces in random directions.
std::vector<Plane> RandomSolid(std::mt19937 &random, int faces) {
    std::normal_distribution<double> component;
    std::uniform_real_distribution<double> distance(60, 90);
    std::vector<Plane> planes = BoxPlanes({-100, -100, -100}, {100, 100, 100});
    for (int i = 0; i < faces; ++i)
        planes.push_back({Normalize(Vec3d{component(random), component(random), component(random)}), distance(random)});
    return planes;
}

/// Whether some plane keeps the convex solid of these points apart from a box; the planes that can: axes, faces, and
/// those of an edge of the one and an edge of the other.
bool BoxTouches(const Brush &brush, const PlaneTable &planes, const Vec3d &center, const Vec3d &half) {
    std::vector<Vec3d> points, directions{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const BrushSide &side : brush.sides) {
        const Polygon &w = side.winding;
        if (!w.empty())
            directions.push_back(planes[side.planeNum].normal);
        for (std::size_t i = 0; i < w.size(); ++i) {
            points.push_back(Vec3d(w[i]));
            const Vec3d edge = Vec3d(w[(i + 1) % w.size()]) - Vec3d(w[i]);
            for (const Vec3d &axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
                if (Length(Cross(edge, axis)) > 1e-3)
                    directions.push_back(Normalize(Cross(edge, axis)));
        }
    }
    return std::ranges::none_of(directions, [&](const Vec3d &d) {
        const double reach = std::abs(d.x) * half.x + std::abs(d.y) * half.y + std::abs(d.z) * half.z;
        double low = 1e9, high = -1e9;
        for (const Vec3d &p : points)
            low = std::min(low, Dot(d, p - center)), high = std::max(high, Dot(d, p - center));
        return low > reach || high < -reach;
    });
}

/// As an engine has it: all planes moved out by the box, the middle of the box inside all of them.
bool InsideMovedPlanes(const Brush &brush, const PlaneTable &planes, const Vec3d &center, const Vec3d &half) {
    return std::ranges::all_of(brush.sides, [&](const BrushSide &side) {
        const Plane &plane = planes[side.planeNum];
        const Vec3d &n = plane.normal;
        return plane.Distance(center) <= std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
    });
}

} // namespace

TEST_F(MapTest, BoxHasItsWindings) {
    Map map = Read(WorldText(BoxText({-8, 0, 16}, {24, 64, 80})));
    const Brush &brush = map.World().brushes.at(0);
    EXPECT_EQ(brush.bounds.mins, (Vec3f{-8, 0, 16}));
    EXPECT_EQ(brush.bounds.maxs, (Vec3f{24, 64, 80}));
    ASSERT_EQ(brush.sides.size(), 6u);
    EXPECT_NEAR(SurfaceArea(brush), 2 * (32 * 64 + 32 * 64 + 64 * 64), 1e-3);
    for (const BrushSide &side : brush.sides) {
        EXPECT_EQ(side.winding.size(), 4u);
        EXPECT_EQ(PlaneOf(side.winding).normal, map.planes[side.planeNum].normal) << "clockwise from outside";
    }
}

TEST_F(MapTest, SidesOneToSixAreTheAxialOnesInOrder) {
    std::mt19937 random(5);
    for (int i = 0; i < 20; ++i) {
        std::vector<Plane> planes = RandomSolid(random, 5);
        std::ranges::shuffle(planes, random);
        Map map = Read(WorldText(BrushText(planes)));
        const Brush &brush = map.World().brushes.at(0);
        for (std::size_t side = 0; side < 6; ++side)
            EXPECT_EQ(map.planes[brush.sides[side].planeNum].normal[side / 2], side % 2 == 0 ? -1 : 1);
    }
}

TEST_F(MapTest, WedgeGetsOneAxialAndThreeEdgeBevels) {
    std::vector<Plane> planes = BoxPlanes({0, 0, 0}, {64, 64, 64});
    const Vec3d slope = Normalize(Vec3d{1, 1, 1});
    planes[4] = {slope, Dot(slope, Vec3d{0, 0, 96})};
    Map map = Read(WorldText(BrushText(planes)));
    const Brush &wedge = map.World().brushes.at(0);
    EXPECT_EQ(Bevels(wedge, 0, 6), 1);
    EXPECT_EQ(Bevels(wedge, 6, 99), 3);
    EXPECT_EQ(map.planes[wedge.sides[5].planeNum].dist, 96);
    EXPECT_TRUE(wedge.sides[5].winding.empty());
    EXPECT_EQ(wedge.sides[5].shader, nullptr);
}

TEST_F(MapTest, BevelsMakeBoxesCollideExactly) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> place(-180, 180);
    const Vec3d half{15, 15, 28};
    int inside = 0, wrong = 0;
    for (int solid = 0; solid < 30; ++solid) {
        Map map = Read(WorldText(BrushText(RandomSolid(random, 4))));
        const Brush &brush = map.World().brushes.at(0);
        for (int i = 0; i < 300; ++i) {
            const Vec3d center{place(random), place(random), place(random)};
            // Within half a unit of touching either answer is right.
            const bool surely = BoxTouches(brush, map.planes, center, half - Vec3d{0.5, 0.5, 0.5});
            const bool maybe = BoxTouches(brush, map.planes, center, half + Vec3d{0.5, 0.5, 0.5});
            if (surely != maybe)
                continue;
            inside += surely;
            wrong += InsideMovedPlanes(brush, map.planes, center, half) != surely;
        }
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(inside, 1000);
}

TEST_F(MapTest, BevelsInheritWhatPlayersFeel) {
    std::vector<Plane> planes = BoxPlanes({0, 0, 0}, {64, 64, 64});
    const Vec3d slope = Normalize(Vec3d{1, 0, 1});
    planes[4] = {slope, Dot(slope, Vec3d{0, 0, 64})};
    std::string text = "{\n";
    for (std::size_t i = 0; i < planes.size(); ++i)
        text += SideText(planes[i], i == 4 ? "slick" : "wall");
    Map map = Read(WorldText(text + "}\n"));
    const Brush &brush = map.World().brushes.at(0);
    ASSERT_TRUE(brush.sides[5].bevel);
    EXPECT_EQ(brush.sides[5].surfaceFlags, 2u) << "the slick slope touches the bevel on top";
}

TEST_F(MapTest, BevelsInheritTheFlagsOfTheGame) {
    constexpr std::uint32_t kSnow = 0x100000; // of Quake Live
    library->SetDefaultFlags("textures/snow", kSnow, 1);
    std::vector<Plane> planes = BoxPlanes({0, 0, 0}, {64, 64, 64});
    const Vec3d slope = Normalize(Vec3d{1, 0, 1});
    planes[4] = {slope, Dot(slope, Vec3d{0, 0, 64})};
    for (const auto &[name, flags] : {std::pair("quake3", 0u), std::pair("quakelive", kSnow)}) {
        gameName = name;
        Map map = Read(WorldText(BrushText(planes, "snow")));
        EXPECT_EQ(map.World().brushes.at(0).sides[5].surfaceFlags, flags) << name;
    }
}

TEST_F(MapTest, BevelSnapMovesAxialBevelsInward) {
    bspOptions.bevelSnap = 8;
    std::vector<Plane> planes = BoxPlanes({0, 0, 0}, {64, 64, 64});
    const Vec3d slope = Normalize(Vec3d{1, 0, 1});
    planes[4] = {slope, Dot(slope, Vec3d{0, 0, 61})};
    Map map = Read(WorldText(BrushText(planes)));
    EXPECT_EQ(map.planes[map.World().brushes.at(0).sides[5].planeNum].dist, 56);
}

TEST_F(MapTest, VolumeFarFromTheOriginIsThatAtTheOrigin) {
    std::mt19937 random(7);
    const Vec3d far{60000, -60000, 50000};
    for (int i = 0; i < 20; ++i) {
        std::vector<Plane> planes = RandomSolid(random, 6);
        Map here = Read(WorldText(BrushText(planes)));
        const double volume = VolumeOf(here.World().brushes.at(0), here.planes);
        for (Plane &plane : planes)
            plane.dist += Dot(plane.normal, far);
        Map there = Read(WorldText(BrushText(planes)));
        const Brush &brush = there.World().brushes.at(0);
        EXPECT_NEAR(brush.bounds.mins.x - 60000, here.World().brushes.at(0).bounds.mins.x, 0.05);
        EXPECT_NEAR(SurfaceArea(brush) / SurfaceArea(here.World().brushes.at(0)), 1, 1e-3);
        EXPECT_GT(volume, 100 * 100 * 100);
    }
}

TEST_F(MapTest, BrushOfAThousandSidesIsACylinder) {
    std::vector<Plane> planes{{{0, 0, 1}, 64}, {{0, 0, -1}, 0}};
    constexpr int sides = 1000;
    for (int i = 0; i < sides; ++i) {
        const double angle = 2 * 3.14159265358979 * (i + 0.5) / sides;
        planes.push_back({{std::cos(angle), std::sin(angle), 0}, 2000});
    }
    Map map = Read(WorldText(BrushText(planes)));
    const double expected = 3.14159265 * 2000 * 2000 * 64;
    EXPECT_NEAR(VolumeOf(map.World().brushes.at(0), map.planes) / expected, 1, 0.001);
}

TEST_F(MapTest, ShortEdgesAreWelded) {
    std::vector<Plane> planes = BoxPlanes({0, 0, 0}, {64, 64, 64});
    const Vec3d corner = Normalize(Vec3d{1, 1, 0});
    planes.push_back({corner, Dot(corner, Vec3d{64, 63.95, 0})}); // cuts 0.05 off an edge
    Map map = Read(WorldText(BrushText(planes)));
    for (const BrushSide &side : map.World().brushes.at(0).sides)
        for (std::size_t i = 0; i < side.winding.size(); ++i)
            EXPECT_GE(Length(side.winding[i] - side.winding[(i + 1) % side.winding.size()]), 0.1f);
}

TEST_F(MapTest, OpaqueBrushesComeFirstInReverseThenTheOthers) {
    std::string text;
    for (const char *shader : {"wall", "see", "wall", "see", "wall"})
        text += BoxText({0, 0, 0}, {64, 64, 64}, shader);
    std::vector<int> order;
    Map map = Read(WorldText(text));
    for (const Brush &brush : map.World().brushes)
        order.push_back(brush.primitive);
    EXPECT_THAT(order, testing::ElementsAre(4, 2, 0, 1, 3));
}

TEST_F(MapTest, ContentsDecideDetailAndOpaque) {
    struct Case {
        const char *shader, *flags;
        bool detail, opaque;
    };
    for (const Case &c : {Case{"wall", "0 0 0", false, true}, Case{"wall", "134217728 0 0", true, true},
                          Case{"wall", "134217729 4 7", true, true}, Case{"see", "0 0 0", true, false},
                          Case{"water", "0 0 0", true, false}, Case{"clip", "0 0 0", true, false},
                          Case{"portal", "0 0 0", false, false}, Case{"structure", "134217728 0 0", false, true}}) {
        Map map = Read(WorldText(BoxText({0, 0, 0}, {64, 64, 64}, c.shader, c.flags)));
        const Brush &brush = map.World().brushes.at(0);
        EXPECT_EQ(brush.detail, c.detail) << c.shader << c.flags;
        EXPECT_EQ(brush.opaque, c.opaque) << c.shader << c.flags;
    }
    EXPECT_GT(Warnings("mixed detail and structural"), 0);
}

TEST_F(MapTest, ContentShaderIsThatOfTheHighestClass) {
    const auto contentShader = [this](std::vector<std::string> shaders) {
        const std::vector<Plane> planes = BoxPlanes({0, 0, 0}, {64, 64, 64});
        std::string text = "{\n";
        for (std::size_t i = 0; i < planes.size(); ++i)
            text += SideText(planes[i], i < shaders.size() ? shaders[i] : shaders.back());
        return Read(WorldText(text + "}\n")).World().brushes.at(0).contentShader->name;
    };
    EXPECT_EQ(contentShader({"wall", "see"}), "textures/wall");
    EXPECT_EQ(contentShader({"wall", "water", "wall"}), "textures/water");
    EXPECT_EQ(contentShader({"water", "fogged"}), "textures/water");
    EXPECT_EQ(contentShader({"wall", "fogged", "water", "wall"}), "textures/water");
    EXPECT_EQ(contentShader({"clip", "fogged"}), "textures/fogged");
    EXPECT_EQ(contentShader({"wall", "clip", "wall"}), "textures/clip");
}

TEST_F(MapTest, OptionsLeaveBrushesOut) {
    const std::string text = WorldText(
        BoxText({0, 0, 0}, {8, 8, 8}) + BoxText({0, 0, 0}, {8, 8, 8}, "wall", "134217728 0 0") +
        BoxText({0, 0, 0}, {8, 8, 8}, "water") + BoxText({0, 0, 0}, {8, 8, 8}, "hint") + FlatPatchText(3, 3, {}));
    const auto left = [&] { return Read(text).World().brushes.size(); };
    EXPECT_EQ(left(), 4u);
    bspOptions.noDetail = true;
    EXPECT_EQ(left(), 2u) << "liquids without structural are detail too";
    bspOptions = {};
    bspOptions.noWater = true;
    EXPECT_EQ(left(), 3u);
    bspOptions = {};
    bspOptions.noHint = true;
    EXPECT_EQ(left(), 3u);
    bspOptions = {};
    bspOptions.fullDetail = true;
    Map map = Read(text);
    for (const Brush &brush : map.World().brushes)
        EXPECT_EQ(brush.detail, !brush.opaque && brush.primitive == 2);
    bspOptions = {};
    bspOptions.noCurves = true;
    EXPECT_TRUE(Read(text).World().patches.empty());
}

TEST_F(MapTest, ColorVolumesAreKeptApart) {
    Map map = Read(WorldText(BoxText({0, 0, 0}, {8, 8, 8}, "volume") + BoxText({0, 0, 0}, {8, 8, 8})));
    EXPECT_EQ(map.World().brushes.size(), 1u);
    ASSERT_EQ(map.World().colorVolumes.size(), 1u);
    EXPECT_EQ(map.World().colorVolumes[0].primitive, 0);
}

TEST_F(MapTest, OnlyTheLargestAreaPortalSideCounts) {
    Map map = Read(WorldText(BoxText({0, 0, 0}, {8, 128, 64}, "portal")));
    EXPECT_EQ(Warnings("area portal sides"), 1);
    int portals = 0;
    for (const BrushSide &side : map.World().brushes.at(0).sides)
        if (side.compileFlags & C_AREAPORTAL) {
            ++portals;
            EXPECT_EQ(std::abs(map.planes[side.planeNum].normal.x), 1);
        }
    EXPECT_EQ(portals, 1);
    Map door = Read(WorldText("") + EntityText("func_door", BoxText({0, 0, 0}, {8, 8, 8}, "portal")));
    EXPECT_TRUE(door.entities.at(1).brushes.empty());
    EXPECT_EQ(Warnings("area portal outside the world"), 1);
    Map group = Read(WorldText("") + EntityText("func_group", BoxText({0, 0, 0}, {8, 8, 8}, "portal")));
    EXPECT_EQ(group.World().brushes.size(), 1u);
}

TEST_F(MapTest, BrushFromPlanesHasItsShaderInFront) {
    Map map = Read(WorldText(""));
    const std::vector<Plane> planes = BoxPlanes({0, 0, 0}, {8, 8, 8});
    const ShaderInfo &shader = library->Get("textures/wall");
    const auto brush = BrushFromPlanes(planes, &shader, Context(), map.planes);
    ASSERT_NE(brush, nullptr);
    EXPECT_EQ(brush->sides.size(), 6u);
    EXPECT_EQ(brush->sides[0].shader, &shader);
    EXPECT_EQ(brush->sides[1].shader, nullptr);
    EXPECT_NEAR(SurfaceArea(*brush), 6 * 64, 1e-3);
    EXPECT_EQ(BrushFromPlanes(std::span(planes).first(4), &shader, Context(), map.planes), nullptr);
}

} // namespace q3::test
