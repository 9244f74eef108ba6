// GPL-2.0-or-later. The tree as a partition of space, against slow code that follows the definitions.
#include "q3map2/tree/portals.h"
#include "q3map2/tree/tree.h"
#include "tests/tree/tree_fixture.h"

#include <cmath>
#include <numbers>
#include <random>

namespace q3 {
namespace {

using test::Compiled;
using test::World;

/// A box turned about z and y, or a wedge, near the middle of the world. Angles are of all sizes.
std::vector<Plane> RandomSolid(std::mt19937 &random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const Vec3d center{unit(random) * 800 - 400, unit(random) * 800 - 400, unit(random) * 400};
    const double a = unit(random) < 0.5 ? 0 : unit(random) * std::numbers::pi;
    const double b = unit(random) < 0.5 ? 0 : unit(random) * std::numbers::pi;
    const Vec3d x{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
    const Vec3d y{-std::sin(a), std::cos(a), 0};
    std::vector<Plane> planes;
    for (const Vec3d &axis : {x, y, Cross(x, y)})
        for (const double sign : {-1.0, 1.0}) {
            const Vec3d normal = axis * sign;
            planes.push_back({normal, Dot(normal, center) + std::rint(8 + unit(random) * 100)});
        }
    if (unit(random) < 0.3) { // cut an edge off
        const Vec3d normal = Normalize(x + y);
        planes.push_back({normal, Dot(normal, center) + 4});
    }
    return planes;
}

/// A sealed room with solids in it, some of them detail.
void Furnish(World &world, unsigned seed, int solids) {
    std::mt19937 random(seed);
    world.AddRoom({-512, -512, -64}, {512, 512, 512});
    for (int i = 0; i < solids; i++)
        world.AddBrush(RandomSolid(random), i % 3 == 2 ? std::uint32_t(C_DETAIL) : 0u);
    // One of these is in the open, in a corner that no solid reaches.
    world.AddEntity("info_player_start", {-508, -508, -63});
    world.AddEntity("info_player_start", {508, 508, 508});
}

bool Finite(const Polygon &polygon) {
    return std::all_of(polygon.begin(), polygon.end(), [](const Vec3f &p) { return IsFinite(p); });
}

TEST(Tree, LeafsFillTheirBoxOnce) {
    for (unsigned seed = 0; seed < 12; seed++) {
        SCOPED_TRACE(seed);
        World world;
        Furnish(world, seed, 12);
        const Compiled made = world.Compile();
        for (const Tree *tree : {&made.first, &made.second}) {
            const Boundsf &box = tree->nodes[0].bounds;
            const Vec3d size = Vec3d(box.maxs) - Vec3d(box.mins);
            double sum = 0;
            for (const int leaf : test::Leafs(*tree)) {
                const double volume = test::VolumeOf(*tree, leaf);
                EXPECT_GE(volume, -1);
                sum += volume;
            }
            EXPECT_NEAR(sum / (size.x * size.y * size.z), 1, 1e-4);
        }
    }
}

TEST(Tree, PortalsAreFiniteAndLieInTheirPlane) {
    for (unsigned seed = 100; seed < 112; seed++) {
        World world;
        Furnish(world, seed, 12);
        const Compiled made = world.Compile();
        for (const TreePortal &portal : made.second.portals) {
            ASSERT_TRUE(Finite(portal.polygon));
            for (const Vec3f &p : portal.polygon)
                EXPECT_NEAR(portal.plane.Distance(Vec3d(p)), 0, 0.01);
            if (!portal.polygon.empty()) {
                EXPECT_GT(Dot(WindingAreaVector(Reversed(portal.polygon)), portal.plane.normal), 0);
            }
        }
        for (const Brush &brush : world.Brushes())
            for (const BrushSide &side : brush.sides)
                ASSERT_TRUE(Finite(side.visibleHull));
    }
}

TEST(Tree, PortalsAreListedByBothLeafs) {
    World world;
    Furnish(world, 7, 12);
    const Tree tree = world.Compile().second;
    std::vector<int> listed(tree.portals.size());
    for (int i = 0; i < int(tree.nodes.size()); i++)
        for (const int number : tree.nodes[std::size_t(i)].portals) {
            const TreePortal &portal = tree.portals.at(std::size_t(number));
            EXPECT_TRUE(tree.nodes[std::size_t(i)].IsLeaf());
            EXPECT_TRUE(portal.nodes[0] == i || portal.nodes[1] == i);
            EXPECT_FALSE(portal.polygon.empty());
            listed[std::size_t(number)]++;
        }
    for (std::size_t i = 0; i < listed.size(); i++)
        EXPECT_EQ(listed[i], tree.portals[i].polygon.empty() ? 0 : 2);
}

TEST(Tree, PointsOfSolidsAreInOpaqueLeafsAndOthersAreNot) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> across(-500, 500), up(-60, 500);
    World world;
    Furnish(world, 5, 15);
    const Compiled made = world.Compile();
    ASSERT_EQ(made.sealing, Sealing::Sealed);
    int solid = 0, open = 0;
    for (int i = 0; i < 20000; i++) {
        const Vec3f p{across(random), across(random), up(random)};
        double nearest = -1e9; // how far inside the solid that holds it most
        for (const Brush &brush : world.Brushes())
            if (!brush.detail) {
                double inside = 1e9;
                for (const BrushSide &side : brush.sides)
                    inside = std::min(inside, -world.map.planes[side.planeNum].Distance(Vec3d(p)));
                nearest = std::max(nearest, inside);
            }
        const TreeNode &leaf = made.first.nodes[std::size_t(made.first.LeafAt(p, world.map.planes))];
        if (nearest > 1) {
            solid++;
            EXPECT_TRUE(leaf.opaque);
        } else if (nearest < -1 && leaf.floodSteps > 0) {
            open++;
            EXPECT_FALSE(leaf.opaque);
        }
    }
    EXPECT_GT(solid, 300);
    EXPECT_GT(open, 1000);
}

/// Where all planes are axial the leafs are boxes, so what a brush should reach has a closed form.
TEST(Filter, BrushesAreInTheLeafsThatTheyOverlap) {
    std::mt19937 random(9);
    std::uniform_int_distribution<int> place(-30, 30), length(1, 20);
    World world;
    world.AddRoom({-512, -512, -512}, {512, 512, 512});
    world.AddEntity("info_player_start", {-508, -508, -508});
    for (int i = 0; i < 40; i++) {
        const Vec3d mins{place(random) * 12.0, place(random) * 12.0, place(random) * 12.0};
        world.AddBox(mins, mins + Vec3d(length(random) * 6.0, length(random) * 6.0, length(random) * 6.0),
                     i % 4 == 0 ? std::uint32_t(C_DETAIL) : 0u);
    }
    const Tree tree = world.Compile().second;
    for (std::size_t i = 0; i < world.Brushes().size(); i++) {
        const Boundsf &box = world.Brushes()[i].bounds;
        double held = 0;
        for (const int number : test::Leafs(tree)) {
            const TreeNode &leaf = tree.nodes[std::size_t(number)];
            Vec3f overlap = Min(box.maxs, leaf.bounds.maxs) - Max(box.mins, leaf.bounds.mins);
            const bool meets = overlap.x > 0 && overlap.y > 0 && overlap.z > 0;
            const double volume = meets ? double(overlap.x) * double(overlap.y) * double(overlap.z) : 0;
            const auto count = std::count(leaf.brushes.begin(), leaf.brushes.end(), int(i));
            EXPECT_LE(count, 1);
            held += count ? volume : 0;
            // The outermost leafs end before the walls do, so only what lies within them is known to overlap.
            EXPECT_TRUE(volume == 0 || count == 1);
        }
        const auto inside = [](float low, float high) { return low > -512 && high < 512; };
        if (inside(box.mins.x, box.maxs.x) && inside(box.mins.y, box.maxs.y) && inside(box.mins.z, box.maxs.z)) {
            const Vec3d size(box.maxs - box.mins);
            EXPECT_DOUBLE_EQ(held, size.x * size.y * size.z);
        }
    }
}

/// The choice by its definition: every face against every other.
int SlowChoice(const std::vector<TreeFace> &faces, const PlaneTable &planes) {
    int best = -1, bestValue = 0;
    for (std::size_t i = 0; i < faces.size(); i++) {
        int facing = 0, splits = 0;
        const Plane &plane = planes[faces[i].planeNum];
        for (const TreeFace &other : faces) {
            if (other.planeNum == faces[i].planeNum) {
                facing++;
                continue;
            }
            bool front = false, back = false;
            for (const Vec3f &p : other.polygon) {
                front = front || plane.Distance(Vec3d(p)) > 0.1;
                back = back || plane.Distance(Vec3d(p)) < -0.1;
            }
            splits += front && back;
        }
        const int value = 5 * facing - 5 * splits + (planes.IsAxial(faces[i].planeNum) ? 5 : 0) + faces[i].priority;
        if (best < 0 || value > bestValue)
            best = int(i), bestValue = value;
    }
    return best;
}

TEST(Tree, ChoosesThePlaneThatItsDefinitionSays) {
    for (unsigned seed = 0; seed < 40; seed++) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        World world;
        for (int i = 0; i < 2 + int(seed) % 12; i++)
            world.AddBrush(RandomSolid(random));
        const BspContext context = world.Context();
        std::vector<TreeFace> faces = StructuralFaces(world.map.World(), context);
        for (TreeFace &face : faces)
            if (random() % 10 == 0)
                face.priority = random() % 2 ? 1000 : -1000, face.compileFlags |= C_HINT;
        const int slow = SlowChoice(faces, world.map.planes);
        const Tree tree = BuildTree(faces, {0, 0, 0}, world.map.planes, context);
        EXPECT_EQ(tree.nodes[0].planeNum, faces[std::size_t(slow)].planeNum);
        EXPECT_EQ(tree.nodes[0].compileFlags, faces[std::size_t(slow)].compileFlags);
    }
}

TEST(Tree, OtherSplitWeightsGiveAnotherSoundTree) {
    World world, other;
    Furnish(world, 21, 12);
    Furnish(other, 21, 12);
    other.options.altSplit = true;
    const Compiled usual = world.Compile(), made = other.Compile();
    EXPECT_EQ(made.sealing, Sealing::Sealed);
    EXPECT_NE(test::Leafs(made.first).size(), test::Leafs(usual.first).size());
    double volume[2] = {0, 0};
    for (const int leaf : test::Leafs(usual.first))
        volume[0] += usual.first.nodes[std::size_t(leaf)].floodSteps > 0 ? test::VolumeOf(usual.first, leaf) : 0;
    for (const int leaf : test::Leafs(made.first))
        volume[1] += made.first.nodes[std::size_t(leaf)].floodSteps > 0 ? test::VolumeOf(made.first, leaf) : 0;
    EXPECT_NEAR(volume[1] / volume[0], 1, 1e-3);
}

TEST(Tree, LongStaircasesNeedNoStack) {
    World world;
    const BspContext context = world.Context();
    std::vector<TreeFace> faces;
    constexpr int kSteps = 3000;
    for (int i = 0; i < kSteps; i++) {
        const float x = float(i) * 4;
        TreeFace &face = faces.emplace_back();
        face.polygon = {{x, 0, 0}, {x, 0, 64}, {x, 64, 64}, {x, 64, 0}};
        face.planeNum = world.map.planes.Find({1, 0, 0}, double(x)) & ~1;
    }
    const Tree tree = BuildTree(faces, {0, 0, 0}, world.map.planes, context);
    EXPECT_EQ(test::Leafs(tree).size(), std::size_t(kSteps) + 1);
}

// Choosing among all planes at each node holds faces against planes nearly eight times for each pair of them.
TEST(Tree, ThousandsOfTiltedFacesTakeABoundedChoice) {
    World world;
    const BspContext context = world.Context();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<TreeFace> faces;
    constexpr std::int64_t kFaces = 5000;
    for (std::int64_t i = 0; i < kFaces; i++) {
        const Vec3d normal = Normalize(Vec3d{unit(random), unit(random), unit(random)});
        const Vec3d middle = Vec3d{unit(random), unit(random), unit(random)} * 4000;
        const Vec3d u = Normalize(Cross(normal, {0.6, 0.8, 0})) * 16, v = Cross(normal, u);
        TreeFace &face = faces.emplace_back();
        face.polygon = {Vec3f(middle - u - v), Vec3f(middle - u + v), Vec3f(middle + u + v), Vec3f(middle + u - v)};
        face.planeNum = world.map.planes.Find(normal, Dot(normal, middle)) & ~1;
    }
    const Tree tree = BuildTree(faces, {0, 0, 0}, world.map.planes, context);
    EXPECT_GT(test::Leafs(tree).size(), std::size_t(kFaces));
    EXPECT_LT(tree.sideTests, kFaces * kFaces * 5);
}

TEST(Tree, OfNoFacesIsOneLeaf) {
    World world;
    Tree tree = BuildTree({}, {1024, 1024, 1024}, world.map.planes, world.Context());
    EXPECT_EQ(tree.nodes.size(), 1u);
    MakePortals(tree, world.map.planes, world.Context());
    EXPECT_EQ(tree.nodes[0].portals.size(), 6u);
    for (const TreePortal &portal : tree.portals)
        EXPECT_FALSE(IsPassable(tree, portal));
}

} // namespace
} // namespace q3
