// GPL-2.0-or-later. Parts of the bake of the sparse SH grid: lattice, pruning, hanging corners, fit, tree of the file.
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/sparse/corner_fit.h"
#include "q3map2/light/sparse/octree.h"
#include "q3map2/light/sparse/sparse_tree.h"
#include "tests/support/sparse_view.h"

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <random>

namespace q3::test {

namespace {

bspGridSHHeader_t HeaderOf(const Float3 &mins, const Float3 &size, const Int3 &bounds) {
    return {mins, size, bounds, bounds[0] * bounds[1] * bounds[2]};
}

Vec3d InCells(const SparseLattice &lattice, const Vec3d &p) {
    Vec3d cells = p - Vec3d(lattice.Mins());
    for (std::size_t axis = 0; axis < 3; axis++)
        cells[axis] /= double(lattice.Cell()[axis]);
    return cells;
}

// Grids of maps that were moved begin beside the multiples of their cell.
TEST(SparseLattice, PointsOfTheUniformGridAreItsPoints) {
    const Float3 sizes[] = {{32, 32, 64}, {8, 8, 8}, {9, 100, 50}, {64, 64, 64}, {24, 40, 17.5f}, {1024, 16, 8192}};
    const Float3 origins[] = {{0, 0, 0}, {-1, -1, -1}, {0.4f, 0.5f, -0.5f}, {3.3f, -7.7f, 1000.2f}};
    const Int3 bounds{5, 4, 1};
    for (const Float3 &size : sizes)
        for (const Float3 &origin : origins) {
            const Vec3f mins = Vec3f(origin) * Vec3f(size);
            SCOPED_TRACE(fmt::format("{} {} {}, cells {} {} {}", mins.x, mins.y, mins.z, size[0], size[1], size[2]));
            const SparseLattice lattice(HeaderOf(mins.Array(), size, bounds));
            const int base = 1 << lattice.BaseLevel(), root = 1 << lattice.Levels();
            std::size_t index = 0;
            for (int z = 0; z < bounds[2]; z++)
                for (int y = 0; y < bounds[1]; y++)
                    for (int x = 0; x < bounds[0]; x++, index++) {
                        const Vec3d p = Vec3d(mins) + Vec3d{double(x), double(y), double(z)} * Vec3d(size);
                        const Vec3d cells = InCells(lattice, p);
                        LatticePoint at{};
                        for (std::size_t axis = 0; axis < 3; axis++) {
                            at[axis] = std::int32_t(std::lround(cells[axis]));
                            ASSERT_NEAR(cells[axis], at[axis], 1e-3);
                            ASSERT_EQ(at[axis] % base, 0) << "a corner of the cells as large as those of the grid";
                            ASSERT_GE(at[axis], base) << "room for the world beyond the first point";
                            ASSERT_LE(at[axis] + base, lattice.Roots()[axis] * root);
                        }
                        ASSERT_EQ(lattice.UniformIndex(at), index);
                    }
            for (std::size_t axis = 0; axis < 3; axis++) {
                EXPECT_GE(lattice.Cell()[axis], kMinCell);
                EXPECT_EQ(lattice.Cell()[axis] * float(base), size[axis]);
            }
        }
}

TEST(SparseLattice, CubicCellsHaveEqualEdgesWhereHalvingMakesThem) {
    for (const Float3 &size : {Float3{32, 32, 64}, Float3{64, 64, 64}, Float3{8, 8, 8}, Float3{64, 64, 128}}) {
        const Int3 bounds{5, 4, 3};
        const SparseLattice lattice = SparseLattice::Cubic(HeaderOf({-size[0], 0, 2 * size[2]}, size, bounds));
        EXPECT_EQ(lattice.Cell(), (Vec3f{4, 4, 4})) << size[0] << ' ' << size[1] << ' ' << size[2];
        const Vec3d cells = InCells(lattice, {double(size[0]), double(size[1]), double(3 * size[2])});
        LatticePoint at{};
        for (std::size_t axis = 0; axis < 3; axis++) {
            at[axis] = std::int32_t(std::lround(cells[axis]));
            EXPECT_EQ(at[axis] % (1 << lattice.UniformLevel(axis)), 0);
        }
        EXPECT_EQ(lattice.UniformIndex(at), 2u + 5u * (1u + 4u * 1u)) << "the point (2, 1, 1) of the uniform grid";
    }
}

/// A lattice of one root that holds a tree, in units of its cells: of edge 16, at the origin.
SparseLattice SmallLattice() {
    return SparseLattice(HeaderOf({32, 32, 32}, {8, 8, 8}, {4, 4, 4}));
}

/// A tree with random leafs, some without open space.
Octree RandomOctree(const SparseLattice &lattice, std::mt19937 &random, double split, double closed) {
    std::uniform_real_distribution<double> unit;
    Octree tree(lattice);
    for (std::size_t i = 0; i < tree.Size(); i++) {
        tree[i].openFraction = unit(random) < closed && i > 0 ? 0 : 1;
        if ((i < tree.RootCount() && tree[i].openFraction > 0) ||
            (tree[i].openFraction > 0 && tree[i].level > 1 && unit(random) < split))
            tree.Split(i);
    }
    return tree;
}

struct BruteForce {
    const Octree &tree;
    float price;
    std::vector<std::size_t> inner; ///< that may become leafs

    double OpenVolume(std::size_t cell) const {
        if (tree[cell].child == 0 || tree[cell].openFraction <= 0)
            return double(tree[cell].Volume());
        double sum = 0;
        for (std::size_t c = 0; c < 8; c++)
            sum += OpenVolume(tree[cell].child + c);
        return sum;
    }
    double Cost(std::size_t cell, unsigned joined) const {
        const auto found = std::find(inner.begin(), inner.end(), cell);
        const bool isJoined = found != inner.end() && (joined >> (found - inner.begin()) & 1) != 0;
        if (tree[cell].openFraction <= 0)
            return 0;
        if (tree[cell].child == 0 || isJoined)
            return double(tree[cell].error) * OpenVolume(cell) + double(price);
        double sum = 0;
        for (std::size_t c = 0; c < 8; c++)
            sum += Cost(tree[cell].child + c, joined);
        return sum;
    }
};

TEST(PruneOctree, CostsAsLittleAsTheBestOfAllTrees) {
    const SparseLattice lattice = SmallLattice();
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit;
    int joinedCells = 0, splitCells = 0;
    for (int trial = 0; trial < 60; trial++) {
        Octree tree(lattice);
        ASSERT_EQ(tree.RootCount(), 1u);
        tree[0].openFraction = 1;
        std::vector<std::size_t> inner;
        tree.Split(0);
        while (inner.size() < 9) {
            const std::size_t cell = std::size_t(random()) % tree.Size();
            if (tree[cell].child != 0 || tree[cell].level < 2)
                continue;
            tree.Split(cell);
            inner.push_back(cell);
        }
        for (std::size_t i = 0; i < tree.Size(); i++) {
            if (tree[i].child == 0)
                tree[i].openFraction = unit(random) < 0.2f ? 0 : unit(random);
            tree[i].error = std::pow(unit(random), 4.0f) * float(1 << tree[i].level);
        }
        const BruteForce all{tree, 40 * unit(random), inner};
        double best = std::numeric_limits<double>::infinity();
        for (unsigned joined = 0; joined < 1u << inner.size(); joined++)
            best = std::min(best, all.Cost(0, joined));
        Octree result = tree;
        const PruningStats stats = PruneOctree(result, all.price);
        unsigned joined = 0;
        for (std::size_t i = 0; i < inner.size(); i++)
            joined |= unsigned(result[inner[i]].child == 0) << i;
        EXPECT_NEAR(all.Cost(0, joined), best, 1e-4 * best);
        EXPECT_EQ(stats.leafs, result.OpenLeafs().size());
        joinedCells += std::popcount(joined);
        splitCells += int(inner.size()) - std::popcount(joined);
    }
    EXPECT_GT(joinedCells, 50);
    EXPECT_GT(splitCells, 50);
}

TEST(PruneOctree, CellsThatLampsNeedAreNotJoined) {
    for (const float lamp : {9.0f, 1.0f}) {
        Octree tree(SmallLattice());
        tree[0].openFraction = 1;
        tree.Split(0);
        const std::size_t child = tree[0].child;
        tree.Split(child);
        tree[child].nearLightError = lamp;
        PruneOctree(tree, 1e9f, 4);
        EXPECT_EQ(tree[child].child != 0, lamp > 4) << lamp;
    }
}

TEST(PruneOctree, CellsBelowItsLeafsCanBeDropped) {
    std::mt19937 random(6);
    std::uniform_real_distribution<float> unit;
    Octree tree = RandomOctree(SmallLattice(), random, 0.6, 0.2);
    for (std::size_t i = 0; i < tree.Size(); i++)
        tree[i].error = unit(random);
    PruneOctree(tree, 30);
    const auto leafsOf = [](const Octree &of) {
        std::vector<std::pair<LatticePoint, int>> leafs;
        for (const std::size_t leaf : of.OpenLeafs())
            leafs.emplace_back(of[leaf].origin, of[leaf].level);
        return leafs;
    };
    Octree smaller = tree;
    smaller.DropUnused();
    EXPECT_LT(smaller.Size(), tree.Size());
    EXPECT_GT(smaller.Size(), 9u);
    EXPECT_EQ(leafsOf(smaller), leafsOf(tree));
    for (std::int32_t at = 0; at < 16; at++)
        EXPECT_EQ(smaller[smaller.LeafAt({at, 3, 9})].origin, tree[tree.LeafAt({at, 3, 9})].origin) << at;
}

TEST(LatticePoints, AllThatAreAddedAreFoundByTheirNumbers) {
    const SparseLattice lattice = SparseLattice::Cubic(HeaderOf({}, {32, 32, 64}, {50, 50, 20}));
    std::mt19937 random(4);
    std::uniform_int_distribution<std::int32_t> coordinate(0, 300);
    LatticePoints points(lattice);
    std::map<LatticePoint, std::uint32_t> numbers;
    const auto randomPoint = [&] { return LatticePoint{coordinate(random), coordinate(random), coordinate(random)}; };
    for (int i = 0; i < 50'000; i++) {
        const LatticePoint p = randomPoint();
        const auto number = numbers.emplace(p, std::uint32_t(numbers.size())).first->second;
        EXPECT_EQ(points.Add(p), number);
    }
    EXPECT_EQ(points.Size(), numbers.size());
    for (const auto &[p, number] : numbers)
        EXPECT_EQ(points.Find(p), number);
    for (int i = 0; i < 1000; i++) {
        const LatticePoint p = randomPoint();
        EXPECT_EQ(points.Find(p) == LatticePoints::kUnknown, !numbers.contains(p));
    }
}

/// A root of eight cells, the first of which is cut once more.
struct CutRoot {
    CutRoot() {
        for (std::size_t i = 0; i < tree.Size(); i++)
            tree[i].openFraction = 1;
        tree.Split(0);
        tree.Split(tree[0].child);
        AddCorners();
    }
    void AddCorners() {
        for (const std::size_t leaf : tree.OpenLeafs())
            for (std::size_t c = 0; c < 8; c++)
                light[light.Add(tree[leaf].Corner(c))].traced = true;
    }
    SparseLattice lattice = SmallLattice();
    Octree tree{lattice};
    LatticePoints light{lattice};
};

TEST(CornerWeights, CornersOnLargerCellsHang) {
    CutRoot cut;
    CornerWeights corners(cut.tree, cut.light);
    const std::int32_t edge = cut.tree[0].Edge(), half = edge / 2, quarter = edge / 4;
    // 27 corners of the eight cells, and of the 3 x 3 x 3 of the small ones those on none of the seven others.
    EXPECT_EQ(corners.Stored().size(), 27u + 7u);
    const OctreeCell first = cut.tree[cut.tree.LeafAt({0, 0, 0})];
    const auto terms = [&](const LatticePoint &p) {
        std::map<LatticePoint, float> found;
        for (const CornerTerm &term : corners.TermsIn(cut.tree[cut.tree.LeafAt({p[0] - 1, p[1] - 1, p[2] - 1})], p))
            found[cut.light[corners.Stored()[term.stored]].at] = term.weight;
        return found;
    };
    EXPECT_EQ(first.Edge(), quarter);
    EXPECT_FALSE(corners.IsStored(cut.light.Find({half, quarter, quarter})));
    EXPECT_EQ(
        terms({half, quarter, quarter}),
        (std::map<LatticePoint, float>{
            {{half, 0, 0}, 0.25f}, {{half, half, 0}, 0.25f}, {{half, 0, half}, 0.25f}, {{half, half, half}, 0.25f}}));
    EXPECT_EQ(terms({half, half, quarter}),
              (std::map<LatticePoint, float>{{{half, half, 0}, 0.5f}, {{half, half, half}, 0.5f}}));
    EXPECT_EQ(terms({quarter, quarter, quarter}), (std::map<LatticePoint, float>{{{quarter, quarter, quarter}, 1.0f}}));
    EXPECT_EQ(LeafHungOn(cut.tree, {half, half, half}), Octree::kNone);
}

/// A room around the whole lattice, without a solid in it.
Bsp OpenRoom() {
    return Room({-500, -500, -500}, {1000, 1000, 1000}).Build();
}

TEST(FitCorners, KeepsALinearField) {
    const SparseLattice lattice = SmallLattice();
    const Bsp room = OpenRoom();
    const BspSpace space(room, std::vector<bool>(room.brushes.size(), true));
    std::mt19937 random(3);
    const Octree tree = RandomOctree(lattice, random, 0.5, 0.1);
    std::array<std::array<float, 4>, kSHFloats> field{};
    for (auto &row : field)
        for (float &factor : row)
            factor = std::uniform_real_distribution<float>(0.5f, 1)(random);
    LatticePoints light(lattice);
    const auto fieldAt = [&](const LatticePoint &p) {
        SHFloats value;
        for (std::size_t k = 0; k < kSHFloats; k++)
            value[k] =
                field[k][0] + (field[k][1] * float(p[0]) + field[k][2] * float(p[1]) + field[k][3] * float(p[2])) / 16;
        return value;
    };
    for (std::int32_t z = 0; z <= 16; z++)
        for (std::int32_t y = 0; y <= 16; y++)
            for (std::int32_t x = 0; x <= 16; x++) {
                LatticeSample &point = light[light.Add({x, y, z})];
                point.traced = true;
                point.value = fieldAt(point.at);
            }
    CornerWeights corners(tree, light);
    const std::vector<SHFloats> values = FitCorners(SampleCorners(tree, light, corners, lattice, space), light);
    ASSERT_EQ(values.size(), corners.Stored().size());
    ASSERT_GT(values.size(), 50u);
    for (std::size_t i = 0; i < values.size(); i++)
        for (std::size_t k = 0; k < kSHFloats; k++)
            ASSERT_NEAR(values[i][k], fieldAt(light[corners.Stored()[i]].at)[k], 1e-4f);
}

TEST(FitCorners, HalvesTheErrorOfACurvedField) {
    const SparseLattice lattice = SmallLattice();
    const Bsp room = OpenRoom();
    const BspSpace space(room, std::vector<bool>(room.brushes.size(), true));
    Octree tree(lattice);
    tree[0].openFraction = 1;
    tree.Split(0);
    LatticePoints light(lattice);
    for (std::int32_t z = 0; z <= 16; z++)
        for (std::int32_t y = 0; y <= 16; y++)
            for (std::int32_t x = 0; x <= 16; x++) {
                LatticeSample &point = light[light.Add({x, y, z})];
                point.traced = true;
                point.value.fill(0.5f + float(x * x) / 1024); // interpolation errs to one side
            }
    CornerWeights corners(tree, light);
    const std::vector<SHFloats> values = FitCorners(SampleCorners(tree, light, corners, lattice, space), light);
    double fitted = 0, plain = 0;
    for (std::size_t i = 0; i < light.Size(); i++) {
        const LatticeSample &point = light[i];
        float fit = 0, own = 0;
        std::size_t leaf = Octree::kNone;
        for (const std::size_t around : tree.LeafsAround(point.at))
            leaf = around != Octree::kNone ? around : leaf;
        for (const CornerTerm &term : corners.TermsIn(tree[leaf], point.at)) {
            fit += term.weight * values[term.stored][0];
            own += term.weight * light[corners.Stored()[term.stored]].value[0];
        }
        fitted += double((fit - point.value[0]) * (fit - point.value[0]));
        plain += double((own - point.value[0]) * (own - point.value[0]));
    }
    // Of x^2 with corners as they are, the squares of x (h - x) have the mean h^4 / 30; the best line leaves h^4 / 180.
    EXPECT_LT(fitted, plain / 2);
}

TEST(SparseTree, ReadersGetWhatTheCornersSay) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit;
    for (int trial = 0; trial < 30; trial++) {
        SCOPED_TRACE(trial);
        const SparseLattice lattice(HeaderOf({128, 0, 0}, {8, 8, 8}, {20, 4, 4})); // several roots
        Octree tree = RandomOctree(lattice, random, 0.5, trial % 2 == 0 ? 0.5 : 0.1);
        const std::int32_t edge = 1 << lattice.Levels();
        for (const std::size_t leaf : tree.OpenLeafs()) // the lattice has room beyond all open space
            for (std::size_t axis = 0; axis < 3; axis++)
                if (tree[leaf].Corner(7)[axis] == lattice.Roots()[axis] * edge)
                    tree[leaf].openFraction = 0;
        LatticePoints light(lattice);
        for (const std::size_t leaf : tree.OpenLeafs())
            for (std::size_t c = 0; c < 8; c++) {
                LatticeSample &point = light[light.Add(tree[leaf].Corner(c))];
                point.traced = true;
                for (std::size_t k = 0; k < kSHFloats; k++)
                    point.value[k] = k < 3 ? 0.25f + 0.75f * unit(random) : 0.1f * (unit(random) - 0.5f);
            }
        CornerWeights corners(tree, light);
        std::vector<SHFloats> values;
        for (const std::uint32_t number : corners.Stored())
            values.push_back(light[number].value);
        const SparseView view(PackSparseGrid(MakeSparseTree(StoreTree(tree, light, corners), lattice, values)));
        const auto cornerValue = [&](const OctreeCell &leaf, const LatticePoint &p) {
            Coefficients sum{};
            for (const CornerTerm &term : corners.TermsIn(leaf, p))
                for (std::size_t k = 0; k < 9; k++)
                    for (std::size_t channel = 0; channel < 3; channel++)
                        sum[k][channel] += double(term.weight) * double(values[term.stored][3 * k + channel]);
            return sum;
        };
        for (const std::size_t leaf : tree.OpenLeafs()) {
            const OctreeCell cell = tree[leaf];
            Coefficients blend{};
            const Vec3f inside{unit(random), unit(random), unit(random)};
            const Vec3f at = LatticePosition(cell.origin) + inside * float(cell.Edge());
            for (std::size_t c = 0; c < 8; c++) {
                const Coefficients value = cornerValue(cell, cell.Corner(c));
                const auto weight = double(cell.Weight(c, at));
                blend = blend + value * Vec3d{weight, weight, weight};
                ASSERT_LT(Difference(view.Sample(Vec3d(lattice.PositionOf(cell.Corner(c)))), value), 0.004)
                    << "quantization; corner " << c << " of a cell of edge " << cell.Edge();
            }
            ASSERT_LT(Difference(view.Sample(Vec3d(lattice.Mins() + lattice.Cell() * at)), blend), 0.004);
        }
    }
}

} // namespace

} // namespace q3::test
