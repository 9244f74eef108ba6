// GPL-2.0-or-later. Point and box queries: what boxes say holds for the points in them.
#include "tests/support/compiled_map.h"
#include "tests/support/light_fixture.h"

#include "q3map2/light/light_setup.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/open_parts.h"
#include "q3map2/light/scene/shadow_casters.h"

#include <algorithm>
#include <random>

namespace q3::test {

namespace {

/// A room with detail brushes of many sizes, which do not cut the tree into solid leafs.
class SpaceTest : public ::testing::Test {
  protected:
    SpaceTest() : vfs(quiet.log), bsp(Compiled()) {}

    Bsp Compiled() {
        vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
        SceneBuilder scene = Room({-512, -512, -512}, {512, 512, 512});
        std::mt19937 random(23);
        const auto below = [&](int most) { return float(random() % unsigned(most)); };
        for (int i = 0; i < 12; ++i) {
            const Vec3f from{below(800) - 512, below(800) - 512, below(800) - 512};
            scene.AddBox(from, from + Vec3f{64 + below(300), 64 + below(300), 64 + below(300)},
                         TestShader("textures/test/wall"), BoxKind::Detail);
        }
        return CompiledScene(scene, vfs);
    }

    KeptLog quiet;
    VirtualFileSystem vfs;
    Bsp bsp;
};

TEST_F(SpaceTest, BoxesWithoutOpenPlacesHaveNone) {
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size(), true));
    std::mt19937 random(29);
    std::uniform_real_distribution<float> place(-520, 520), size(0, 30), share(-1, 1);
    int inBrushes = 0, open = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3f center{std::round(place(random)), std::round(place(random)), std::round(place(random))};
        const Vec3f half{size(random), size(random), size(random)};
        for (const float epsilon : {-0.125f, 0.0f, 0.125f}) {
            const bool any = space.AnyOpen(center - half, center + half, epsilon);
            open += any ? 1 : 0;
            inBrushes += !any && !space.InSolidLeaf(center) ? 1 : 0;
            for (int k = 0; k < 30 && !any; ++k) {
                // Corners and edges of the box too.
                const auto within = [&] { return std::round(share(random) * 3) / 2; };
                const Vec3f at{std::clamp(within(), -1.0f, 1.0f), std::clamp(within(), -1.0f, 1.0f), share(random)};
                ASSERT_LT(space.ClusterAt(center + half * at, epsilon), 0);
            }
        }
    }
    EXPECT_GT(inBrushes, 100);
    EXPECT_GT(open, 100);
}

/// Area of w, and whether each of its pieces is about the leaf that it comes with.
double AreaOfPieces(const Bsp &bsp, TreeWalk<double> &tree, const Winding<double> &w) {
    double area = 0;
    tree.Walk(
        tree.Root(), w, 0.01, [](const bspPlane_t &) { return CoplanarSide::Front; },
        [&](const Winding<double> &piece, std::size_t number) {
            const bspLeaf_t &leaf = bsp.leafs[number];
            for (const Vec3d &p : piece)
                for (std::size_t axis = 0; axis < 3 && leaf.cluster >= 0; ++axis) {
                    EXPECT_GE(p[axis], leaf.mins[axis] - 1);
                    EXPECT_LE(p[axis], leaf.maxs[axis] + 1);
                }
            area += WindingArea(piece);
            return true;
        });
    return area;
}

TEST_F(SpaceTest, WaysAreAsOpenAsTheirPoints) {
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size(), true));
    std::mt19937 random(31);
    std::uniform_real_distribution<float> place(-540, 540);
    std::array<int, 3> seen{};
    for (int i = 0; i < 800; ++i) {
        const Vec3f a{place(random), place(random), place(random)}, b{place(random), place(random), place(random)};
        // From point to point: how often a solid begins, and whether one ends the way. Deeper than the slack of ways,
        // and farther from edges, than what they may pass over.
        int entered = 0;
        bool inside = space.ClusterAt(a, -0.5f) < 0, startsInside = inside, sure = true;
        for (int k = 0; k <= 2000; ++k) {
            const Vec3f p = a + (b - a) * (float(k) / 2000);
            const bool deep = space.ClusterAt(p, -0.5f) < 0;
            sure = sure && deep == (space.ClusterAt(p, 0.5f) < 0 || space.InSolidLeaf(p));
            entered += deep && !inside;
            inside = deep;
        }
        const SegmentState state = StateOfSegment(space, a, b);
        ++seen[std::size_t(state)];
        if (entered > 0 || inside) {
            EXPECT_EQ(state, SegmentState::Blocked) << i;
        } else if (startsInside) {
            EXPECT_NE(state, SegmentState::Open) << i;
        } else if (sure) {
            EXPECT_EQ(state, SegmentState::Open) << i;
        }
    }
    for (const int count : seen)
        EXPECT_GT(count, 10);
}

TEST(Ways, ThinWallsBlockAndFacesDoNot) {
    KeptLog quiet;
    VirtualFileSystem vfs(quiet.log);
    vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
    for (const BoxKind kind : {BoxKind::Structural, BoxKind::Detail}) {
        SceneBuilder scene = Room({-128, -128, 0}, {128, 128, 128});
        scene.AddBox({0, -128, 0}, {2, 64, 128}, TestShader("textures/test/wall"), kind);
        const Bsp bsp = CompiledScene(scene, vfs);
        const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size(), true));
        EXPECT_EQ(StateOfSegment(space, {-5, 0, 1}, {5, 0, 1}), SegmentState::Blocked);
        EXPECT_EQ(StateOfSegment(space, {0, 0, 1}, {5, 0, 1}), SegmentState::Blocked) << "from its face";
        EXPECT_EQ(StateOfSegment(space, {1, 0, 1}, {5, 0, 1}), SegmentState::LeavesSolid);
        EXPECT_EQ(StateOfSegment(space, {1, 0, 1}, {2, 0, 1}), SegmentState::LeavesSolid) << "to its face";
        EXPECT_EQ(StateOfSegment(space, {5, 0, 1}, {1, 0, 1}), SegmentState::Blocked) << "into it";
        EXPECT_EQ(StateOfSegment(space, {0, -50, 1}, {0, 50, 1}), SegmentState::Open) << "along its face";
        EXPECT_EQ(StateOfSegment(space, {2, -50, 0}, {2, 50, 0}), SegmentState::Open)
            << "along the edge of wall and floor";
        EXPECT_EQ(StateOfSegment(space, {-5, 70, 1}, {5, 70, 1}), SegmentState::Open) << "beside it";
    }
}

TEST(Ways, AWallOfTwoBrushesIsOne) {
    KeptLog quiet;
    VirtualFileSystem vfs(quiet.log);
    vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
    SceneBuilder scene = Room({-128, -128, 0}, {128, 128, 128});
    scene.AddBox({0, -128, 0}, {4, 64, 128}, TestShader("textures/test/wall"), BoxKind::Detail);
    scene.AddBox({4, -128, 0}, {8, 64, 128}, TestShader("textures/test/wall"), BoxKind::Detail);
    const Bsp bsp = CompiledScene(scene, vfs);
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size(), true));
    EXPECT_EQ(StateOfSegment(space, {2, 0, 1}, {10, 0, 1}), SegmentState::LeavesSolid);
    EXPECT_EQ(StateOfSegment(space, {2, 0, 1}, {10, 6, 1}), SegmentState::LeavesSolid) << "oblique";
    EXPECT_EQ(StateOfSegment(space, {-2, 0, 1}, {10, 0, 1}), SegmentState::Blocked);
}

TEST(Ways, APillarInWaterBlocks) {
    KeptLog quiet;
    VirtualFileSystem vfs(quiet.log);
    vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
    SceneBuilder scene = Room({-128, -128, 0}, {128, 128, 128});
    scene.AddBox({-2, -128, 0}, {2, 128, 128}, TestShader("textures/test/wall"), BoxKind::Detail);
    scene.AddBox({-2, -128, 0}, {60, 128, 96}, TestShader("textures/test/water"), BoxKind::Detail);
    scene.AddBox({28, -8, 0}, {32, 8, 128}, TestShader("textures/test/wall"), BoxKind::Detail);
    const Bsp bsp = CompiledScene(scene, vfs);
    std::vector<bool> opaque;
    for (const bspBrush_t &brush : bsp.brushes)
        opaque.push_back(FieldName(bsp.shaders[std::size_t(brush.shaderNum)].shader) != "textures/test/water");
    ASSERT_EQ(std::count(opaque.begin(), opaque.end(), false), 1);
    const BspSpace space(bsp, opaque);
    EXPECT_EQ(StateOfSegment(space, {0, 40, 64}, {70, 40, 64}), SegmentState::LeavesSolid) << "through the water";
    EXPECT_EQ(StateOfSegment(space, {0, 0, 64}, {70, 0, 64}), SegmentState::Blocked);
}

TEST_F(SpaceTest, PiecesInLeafsMakeUpThePolygon) {
    std::mt19937 random(31);
    std::uniform_real_distribution<double> place(-600, 600);
    TreeWalk<double> tree(bsp);
    for (int i = 0; i < 500; ++i) {
        const auto corner = [&] { return Vec3d{place(random), place(random), place(random)}; };
        const Winding<double> w{corner(), corner(), corner()};
        EXPECT_NEAR(AreaOfPieces(bsp, tree, w), WindingArea(w), 1e-6 * WindingArea(w));
    }
}

TEST_F(SpaceTest, PolygonsInAPlaneOfTheTreeGoWhereTheyAreSent) {
    const bspPlane_t &plane = bsp.planes[std::size_t(bsp.nodes[0].planeNum)];
    const Winding<double> w = WindingInPlane({Vec3d(plane.normal), plane.dist}, 4096);
    TreeWalk<double> tree(bsp);
    for (const CoplanarSide where : {CoplanarSide::Front, CoplanarSide::Back, CoplanarSide::Both}) {
        double area = 0;
        int asked = 0;
        tree.Walk(
            tree.Root(), w, 0.01, [&](const bspPlane_t &) { return ++asked == 1 ? where : CoplanarSide::Front; },
            [&](const Winding<double> &piece, std::size_t) {
                area += WindingArea(piece);
                return true;
            });
        EXPECT_NEAR(area, WindingArea(w) * (where == CoplanarSide::Both ? 2 : 1), 1);
    }
}

TEST_F(SpaceTest, AWalkEndsWhenItsVisitorHasSeenEnough) {
    const bspPlane_t &plane = bsp.planes[std::size_t(bsp.nodes[0].planeNum)];
    const Winding<double> w = WindingInPlane({Vec3d(plane.normal), plane.dist}, 4096);
    TreeWalk<double> tree(bsp);
    int seen = 0;
    const auto toFront = [](const bspPlane_t &) { return CoplanarSide::Front; };
    const auto visit = [&](const Winding<double> &, std::size_t) { return ++seen < 2; };
    EXPECT_FALSE(tree.Walk(tree.Root(), w, 0.01, toFront, visit));
    EXPECT_EQ(seen, 2);
    EXPECT_NEAR(AreaOfPieces(bsp, tree, w), WindingArea(w), 1);
}

TEST_F(SpaceTest, TheHullOfSolidsIsTheRoom) {
    SolidHull hull{SolidLeafs(bsp), {}};
    SolidHulls(bsp, {&hull, 1});
    Bounds<double> bounds;
    double area = 0;
    for (const Winding<double> &face : hull.faces) {
        for (const Vec3d &p : face)
            bounds.Add(p);
        area += WindingArea(face);
    }
    EXPECT_FALSE(hull.faces.empty());
    EXPECT_NEAR(area, 6.0 * 1024 * 1024, 1e-3 * 6 * 1024 * 1024);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(bounds.mins[axis], -512, 0.1);
        EXPECT_NEAR(bounds.maxs[axis], 512, 0.1);
    }
}

} // namespace

} // namespace q3::test
