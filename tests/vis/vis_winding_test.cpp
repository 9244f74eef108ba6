// GPL-2.0-or-later. Planes between two windings, and the order in which portals are followed.
#include "q3map2/vis/explored_chains.h"
#include "q3map2/vis/portal_flow.h"
#include "q3map2/vis/vis_map.h"
#include "q3map2/vis/vis_parts.h"
#include "q3map2/vis/vis_winding.h"
#include "tests/vis/portal_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {

namespace {

/// A regular polygon, counter-clockwise for who its normal points at.
struct Polygon {
    WindingBuffer buffer;
    WindingView view;
    Vec3f normal;

    Polygon(const Vec3f &center, const Vec3f &towards, float radius, int corners) : normal(Normalize(towards)) {
        const Vec3f right = Normalize(Cross(normal, std::abs(normal.z) < 0.9f ? Vec3f(0, 0, 1) : Vec3f(1, 0, 0)));
        const Vec3f up = Cross(normal, right);
        for (int i = 0; i < corners; ++i) {
            const float turn = 2 * std::numbers::pi_v<float> * (float(i) + 0.3f) / float(corners);
            buffer.Set(i, center + right * (radius * std::cos(turn)) + up * (radius * std::sin(turn)));
        }
        view = buffer.View(corners);
    }
    Polygon(const Polygon &) = delete;
    Polygon &operator=(const Polygon &) = delete;
};

/// Planes of SeparatorOfEdge, which tries point after point.
std::vector<VisPlane> SlowPlanes(const WindingView &s, const WindingView &t) {
    std::vector<VisPlane> planes;
    VisPlane plane;
    for (int edge = 0; edge < s.count; ++edge)
        if (SeparatorOfEdge(s, t, edge, InFront::T, plane))
            planes.push_back(plane);
    return planes;
}

void ExpectSamePlanes(const Polygon &s, const Polygon &t, NormalSide side) {
    std::array<VisPlane, 32> planes;
    const int count = TangentPlanes(s.view, s.normal, t.view, side, planes);
    const std::vector<VisPlane> slow = SlowPlanes(s.view, t.view);
    ASSERT_EQ(count, int(slow.size()));
    for (std::size_t i = 0; i < slow.size(); ++i) {
        EXPECT_NEAR(Length(planes[i].normal), 1, 1e-5);
        EXPECT_LT(PointDistances(s.view, planes[i]).max, 0.01f) << "the first polygon is behind";
        EXPECT_GT(PointDistances(t.view, planes[i]).min, -0.01f) << "the second one is in front";
        // One within 0.1 units may touch another corner.
        for (const WindingView *const view : {&s.view, &t.view})
            for (int k = 0; k < view->count; ++k)
                EXPECT_NEAR(planes[i].Distance(view->Point(k)), slow[i].Distance(view->Point(k)), 0.25f);
    }
}

TEST(Separators, OfTwoSquaresOppositeEachOther) {
    WindingBuffer a, b;
    const Vec3f corners[4] = {{0, 0, 0}, {0, 16, 0}, {0, 16, 16}, {0, 0, 16}};
    for (int i = 0; i < 4; ++i)
        a.Set(i, corners[i]), b.Set(i, corners[i] + Vec3f(64, 0, 0));
    std::array<VisPlane, 8> planes;
    ASSERT_EQ(TangentPlanes(a.View(4), {1, 0, 0}, b.View(4), NormalSide::Front, planes), 4);
    // Each goes through an edge of the first and the opposite one of the second: 16 units aside over 64.
    const float length = std::sqrt(1 + 16.0f);
    const Vec3f sides[4] = {{0, 0, -4}, {0, 4, 0}, {0, 0, 4}, {0, -4, 0}};
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3f expected = (Vec3f(1, 0, 0) + sides[i]) * (1 / length);
        EXPECT_LT(Length(planes[i].normal - expected), 1e-5f) << i;
        EXPECT_NEAR(planes[i].Distance(corners[i]), 0, 1e-4) << i;
    }
    EXPECT_EQ(TangentPlanes(a.View(4), {1, 0, 0}, b.View(4), NormalSide::Front, std::span(planes).first(3)), 3);
}

TEST(Separators, OfSquaresThatShareAnEdge) {
    // Two squares at a right angle with an edge in common.
    WindingBuffer a, b;
    const Vec3f floor[4] = {{0, 0, 0}, {16, 0, 0}, {16, 16, 0}, {0, 16, 0}};
    const Vec3f wall[4] = {{0, 0, 0}, {0, 16, 0}, {0, 16, 16}, {0, 0, 16}};
    for (int i = 0; i < 4; ++i)
        a.Set(i, floor[i]), b.Set(i, wall[i]);
    std::array<VisPlane, 8> planes;
    const int count = TangentPlanes(a.View(4), {0, 0, 1}, b.View(4), NormalSide::Front, planes);
    for (int i = 0; i < count; ++i) {
        const VisPlane &plane = planes[std::size_t(i)];
        EXPECT_LE(PointDistances(a.View(4), plane).max, kOnEpsilon);
        EXPECT_GE(PointDistances(b.View(4), plane).min, -kOnEpsilon);
    }
    EXPECT_EQ(count, int(SlowPlanes(a.View(4), b.View(4)).size()));
}

TEST(Separators, AreThoseOfTheSlowSearch) {
    std::mt19937 random(7);
    const auto unit = [&] { return float(random()) / 4294967296.0f * 2 - 1; };
    for (int i = 0; i < 2000; ++i) {
        const Vec3f away(200 + 100 * unit(), 60 * unit(), 60 * unit());
        const Polygon s({}, {1, 0.3f * unit(), 0.3f * unit()}, 30 + 20 * unit(), 3 + int(random() % 6));
        const Polygon t(away, {1, 0.5f * unit(), 0.5f * unit()}, 30 + 20 * unit(), 3 + int(random() % 6));
        ExpectSamePlanes(s, t, NormalSide::Front);
        ExpectSamePlanes(t, s, NormalSide::Behind);
    }
}

TEST(VisMapOrder, PortalsWithLeastInFrontComeFirst) {
    const RoomGrid grid(8);
    const PortalGraph graph = BuildPortalGraph(ParsePortalFile(grid.Prt(), "grid.prt"), "grid.prt");
    const VisMap map(graph, false);
    Log log(Log::Nowhere());
    const MightSeeTable sight = FloodMightSee(map, {}, VisUnits(nullptr), JobPool(1), log);
    const std::vector<int> sorted = OrderPortals(map, sight, true), asInFile = OrderPortals(map, sight, false);
    ASSERT_EQ(sorted.size(), map.NumPortals());
    bool differs = false;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        EXPECT_EQ(asInFile[i], int(i));
        differs |= sorted[i] != int(i);
    }
    const auto fewer = [&](int a, int b) { return sight[std::size_t(a)].Count() < sight[std::size_t(b)].Count(); };
    EXPECT_TRUE(std::is_sorted(sorted.begin(), sorted.end(), fewer));
    EXPECT_TRUE(differs);
}

TEST(VisMapOrder, WidePortalsOfALeafComeFirstOnDemand) {
    const RoomGrid grid(8);
    const PortalGraph graph = BuildPortalGraph(ParsePortalFile(grid.Prt(), "grid.prt"), "grid.prt");
    const VisMap asInFile(graph, false), widest(graph, true);
    for (int leaf = 0; leaf < RoomGrid::kRooms; ++leaf) {
        const auto plain = asInFile.PortalsOf(leaf), sorted = widest.PortalsOf(leaf);
        EXPECT_TRUE(std::is_sorted(plain.begin(), plain.end()));
        EXPECT_TRUE(std::is_sorted(sorted.begin(), sorted.end(), [&](int a, int b) {
            return widest.Portal(std::size_t(a)).radius > widest.Portal(std::size_t(b)).radius;
        }));
        EXPECT_THAT(std::vector(sorted.begin(), sorted.end()), testing::UnorderedElementsAreArray(plain));
    }
}

/// What passages narrow is part of the flood, holds all that the flow finds, and is the same on more threads.
TEST(Passages, NarrowSightBetweenFloodAndFlow) {
    const RoomGrid grid(9);
    const PortalGraph graph = BuildPortalGraph(ParsePortalFile(grid.Prt(), "grid.prt"), "grid.prt");
    const VisMap map(graph, true);
    Log log(Log::Nowhere());
    const auto narrowed = [&](int threads) {
        MightSeeTable sight = FloodMightSee(map, {}, VisUnits(nullptr), JobPool(threads), log);
        const Passages passages(map, sight, std::uint64_t(1) << 30, VisUnits(nullptr), JobPool(threads), log);
        passages.TightenMightSee(map, sight, JobPool(threads));
        return sight;
    };
    const MightSeeTable flood = FloodMightSee(map, {}, VisUnits(nullptr), JobPool(1), log), one = narrowed(1),
                        three = narrowed(3);
    MightSeeTable flow = FloodMightSee(map, {}, VisUnits(nullptr), JobPool(1), log);
    PortalFlow(map, OrderPortals(map, flood, true), {}, VisUnits(nullptr), JobPool(1), log, flow);
    std::size_t fewer = 0;
    for (std::size_t p = 0; p < map.NumPortals(); ++p)
        for (std::size_t q = 0; q < map.NumPortals(); ++q) {
            const std::size_t column = map.Column(q);
            EXPECT_EQ(one.Test(p, column), three.Test(p, column));
            EXPECT_LE(one.Test(p, column), flood.Test(p, column));
            EXPECT_LE(flow.Test(p, column), one.Test(p, column)) << p << " sees " << q;
            fewer += flood.Test(p, column) && !one.Test(p, column);
        }
    EXPECT_GT(fewer, 0u);
}

/// Each portal has a column of its own, and the twins of the portals of a word are at the same bits of one other word.
TEST(VisMapColumns, TwinsAreAtTheSameBits) {
    const RoomGrid grid(10);
    const VisMap map(BuildPortalGraph(ParsePortalFile(grid.Prt(), "grid.prt"), "grid.prt"), true);
    ASSERT_GT(map.NumPortals(), 200u);
    for (std::size_t p = 0; p < map.NumPortals(); ++p) {
        const std::size_t column = map.Column(p), twin = map.Column(p ^ 1);
        EXPECT_EQ(map.PortalAt(column), p);
        EXPECT_EQ(map.TwinWord(column / kBitsPerWord), twin / kBitsPerWord);
        EXPECT_EQ(column % kBitsPerWord, twin % kBitsPerWord);
    }
}

/// A chain from a square of 128 units to one of some size behind it, moved along y, which may see some portals of a
/// block.
struct SquareChain {
    static constexpr std::size_t kWords = 8, kBlockWords = 4;
    ChainLink link{kWords};
    FlowPortal first, last;

    SquareChain(float offset, float radius, BitWord mightSee, std::size_t block = 0) {
        last.column = 5;
        for (auto *const portal : {&first, &last})
            portal->plane.normal = {1, 0, 0};
        constexpr float kTurn[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        for (int i = 0; i < 4; ++i) {
            link.sourceBuffers[0].Set(i, {0, 64 * kTurn[i][0], 64 * kTurn[i][1]});
            link.passBuffers[0].Set(i, {128, offset + radius * kTurn[i][0], radius * kTurn[i][1]});
        }
        link.source = link.sourceBuffers[0].View(4);
        link.pass = link.passBuffers[0].View(4);
        link.mightSee[kBlockWords * block] = mightSee;
        link.blocks.Insert(block);
    }
    SquareChain(const SquareChain &) = delete;
    SquareChain &operator=(const SquareChain &) = delete;

    bool IsCoveredBy(const ExploredChains &chains) const { return chains.Covers(link, last, kBlockWords); }
    void KeepIn(ExploredChains &chains) const { chains.Keep(link, first, last, kBlockWords); }
};

TEST(ExploredChains, CoverThoseThatCouldAddNoMore) {
    ExploredChains chains;
    EXPECT_FALSE(SquareChain(0, 32, 0b0111).IsCoveredBy(chains)) << "none is kept";
    SquareChain(0, 32, 0b0111).KeepIn(chains);
    EXPECT_TRUE(SquareChain(0, 32, 0b0111).IsCoveredBy(chains)) << "the same again";
    EXPECT_TRUE(SquareChain(16, 16, 0b0101).IsCoveredBy(chains)) << "a smaller window, fewer portals";
    EXPECT_FALSE(SquareChain(17, 16, 0b0101).IsCoveredBy(chains)) << "beyond the edge";
    EXPECT_FALSE(SquareChain(0, 32, 0b1101).IsCoveredBy(chains)) << "another portal";
    EXPECT_FALSE(SquareChain(0, 32, 0b0001, 1).IsCoveredBy(chains)) << "a portal of another block";
    SquareChain(17, 16, 0b0100, 1).KeepIn(chains);
    EXPECT_TRUE(SquareChain(17, 16, 0b0100, 1).IsCoveredBy(chains));
    chains.Clear();
    EXPECT_FALSE(SquareChain(0, 32, 0b0001).IsCoveredBy(chains));
}

TEST(ExploredChains, AnotherLastPortalOrALargerFirstOneIsNotCovered) {
    ExploredChains chains;
    SquareChain half(0, 32, 1), whole(0, 32, 1), other(0, 32, 1);
    for (int i = 0; i < 4; ++i)
        half.link.sourceBuffers[0].z[i] = std::min(0.0f, half.link.sourceBuffers[0].z[i]);
    half.KeepIn(chains);
    other.last.column = 6;
    EXPECT_FALSE(other.IsCoveredBy(chains));
    EXPECT_FALSE(whole.IsCoveredBy(chains));
    whole.KeepIn(chains);
    EXPECT_TRUE(half.IsCoveredBy(chains));
    EXPECT_TRUE(whole.IsCoveredBy(chains));
}

TEST(ExploredChains, TheOldestOfEightIsReplaced) {
    ExploredChains chains;
    for (int i = 0; i < 9; ++i)
        SquareChain(0, 32, BitWord(1) << i).KeepIn(chains);
    EXPECT_FALSE(SquareChain(0, 32, 1).IsCoveredBy(chains));
    for (int i = 1; i < 9; ++i)
        EXPECT_TRUE(SquareChain(0, 32, BitWord(1) << i).IsCoveredBy(chains)) << i;
}

/// Far from the origin too, and for both directions of their points.
TEST(WindingOutline, SliversContainThemselvesAndNotTheirNeighbors) {
    const auto sliver = [](WindingBuffer &buffer, float y, bool reversed) {
        constexpr float kFar = 60000;
        const Vec3f points[4] = {{kFar, y, 0}, {kFar, y + 0.25f, 0}, {kFar, y + 0.25f, 64}, {kFar, y, 64}};
        for (int i = 0; i < 4; ++i)
            buffer.Set(i, points[reversed ? 3 - i : i]);
        return buffer.View(4);
    };
    for (const bool reversed : {false, true}) {
        WindingBuffer own, neighbor;
        const WindingOutline outline(sliver(own, 50000, reversed), {1, 0, 0});
        EXPECT_TRUE(outline.Contains(sliver(neighbor, 50000, !reversed)));
        EXPECT_FALSE(outline.Contains(sliver(neighbor, 50000.25f, reversed)));
        EXPECT_FALSE(outline.Contains(sliver(neighbor, 49999.75f, reversed)));
    }
}

/// Rows with random words in a third of their blocks against dense rows, for small and for large maps.
TEST(SparseBits, AreWhatDenseRowsAre) {
    std::mt19937_64 random(11);
    for (const std::size_t words : {std::size_t(8), std::size_t(72), std::size_t(2304)}) {
        std::vector<BitWord> dense(words), kept(words);
        for (std::size_t i = 0; i < words; ++i) {
            dense[i] = i / BlockWordsOf(words) % 3 == 1 ? random() & random() : 0;
            kept[i] = random();
        }
        BitPool pool;
        SparseBits row(dense, pool);
        EXPECT_EQ(row.Count(), CountBits(dense));
        std::vector<BitWord> visited(words);
        row.ForEachWord([&](std::size_t i, BitWord word) { visited[i] = word; });
        EXPECT_EQ(visited, dense);
        for (std::size_t k = 0; k < 200; ++k) {
            const std::size_t bit = random() % (kBitsPerWord * words);
            row.Clear(bit);
            ClearBit(dense.data(), bit);
        }
        std::vector<BitWord> cleared = kept;
        row.Restrict(cleared);
        for (std::size_t i = 0; i < words; ++i) {
            EXPECT_EQ(row.Word(i), dense[i] & kept[i]);
            EXPECT_EQ(cleared[i], dense[i] & ~kept[i]);
        }
        EXPECT_LT(row.Bytes(), sizeof(BitWord) * words / 2 + 100) << "blocks that are 0 take no memory";
    }
}

TEST(SparseBits, ARowThatWasNeverSetHasNoBits) {
    SparseBits row;
    for (const std::size_t word : {std::size_t(0), std::size_t(1000), std::size_t(1) << 20})
        EXPECT_EQ(row.Find(word), nullptr);
    EXPECT_EQ(row.Count(), 0u);
}

/// Without memory for passages the result is that of -nopassage, on any number of threads.
TEST(Passages, BeyondTheBoundOfMemoryAreLeftOut) {
    const RoomGrid grid(12);
    const VisRun all = RunVis(grid.Prt()), one = RunVis(grid.Prt(), {.memory = 0}),
                 three = RunVis(grid.Prt(), {.memory = 0}, 3);
    EXPECT_FALSE(all.Printed("are left out"));
    EXPECT_TRUE(one.Printed("are left out, since all would take more than 0 MB (-vismemory)"));
    EXPECT_EQ(one.rows, three.rows);
    EXPECT_EQ(one.rows, RunVis(grid.Prt(), {.noPassage = true}).rows);
}

} // namespace

} // namespace q3::test
