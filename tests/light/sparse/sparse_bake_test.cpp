// GPL-2.0-or-later. Baked sparse SH grids: error, size, dark and lit rooms, continuity, threads.
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sparse/sparse_bake.h"
#include "tests/support/sparse_view.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace q3::test {

namespace {

class SparseBakeTest : public LightTest {
  protected:
    SparseGridSH Baked(const SceneBuilder &scene, std::string_view options = "", int threads = 1) {
        lit = Lit(scene, "-shadaptive " + std::string(options), threads);
        EXPECT_TRUE(lit.sparseGridSH);
        return lit.sparseGridSH.value_or(SparseGridSH{});
    }
    Bsp lit;
};

std::vector<Vec3d> RandomPositions(const Boundsf &box, double margin, int count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit;
    std::vector<Vec3d> positions;
    while (int(positions.size()) < count) {
        const Vec3d size = Vec3d(box.maxs) - Vec3d(box.mins) - Vec3d{2 * margin, 2 * margin, 2 * margin};
        positions.push_back(Vec3d(box.mins) + Vec3d{margin, margin, margin} +
                            size * Vec3d{unit(random), unit(random), unit(random)});
    }
    return positions;
}

double MeanOf(const Coefficients &c) {
    return 255 * std::max({c[0].x, c[0].y, c[0].z}) / std::sqrt(4 * std::numbers::pi);
}

/// Squared difference on a screen that dims light to what it shows: mean over all normals and channels, bytes^2.
double Displayed(const Coefficients &a, const Coefficients &b) {
    const auto dim = [](const Coefficients &c) { return 1 / std::max(1.0, 2.2 * MeanOf(c) / 255); };
    double sum = 0;
    for (std::size_t k = 0; k < 9; k++) {
        const Vec3d off = a[k] * dim(a) - b[k] * dim(b);
        sum += Dot(off, off);
    }
    return 255 * 255 * sum / (3 * 4 * std::numbers::pi);
}

template <typename Grid, typename Exact>
double ErrorAt(const std::vector<Vec3d> &positions, const Grid &grid, const Exact &exact) {
    double sum = 0;
    for (const Vec3d &p : positions)
        sum += Displayed(grid.Sample(p), exact(p));
    return std::sqrt(sum / double(positions.size()));
}

Entity Lamp(const Vec3f &origin, std::string_view intensity) {
    return MakeEntity("light", {{"origin", fmt::format("{} {} {}", origin.x, origin.y, origin.z)},
                                {"light", std::string(intensity)}});
}

constexpr Vec3f kSmallLamp{10, 20, 100};

SceneBuilder OneLamp() {
    SceneBuilder scene = Room();
    scene.AddEntity(Lamp(kSmallLamp, "300"));
    return scene;
}

Coefficients FromTheLamp(const Vec3d &p) {
    return FromPoint(p, Vec3d(kSmallLamp), 300);
}

TEST_F(SparseBakeTest, KeepsItsTargetAndBeatsAUniformGridOfMoreBytes) {
    const std::vector<Vec3d> positions = RandomPositions(RoomBounds(), 1, 500);
    for (const double target : {4.0, 6.0}) {
        const SparseView sparse(Baked(OneLamp(), fmt::format("-sherrortarget {}", target)));
        const double error = ErrorAt(positions, sparse, FromTheLamp);
        EXPECT_LT(error, 1.5 * target) << sparse.Bytes();
        const GridView uniform(lit);
        EXPECT_GT(uniform.Count() * sizeof(bspGridPointSH_t), sparse.Bytes());
        EXPECT_GT(ErrorAt(positions, uniform, FromTheLamp), error);
    }
}

TEST_F(SparseBakeTest, SmallerTargetsTakeMoreBytesAndBudgetsAreKept) {
    const std::vector<Vec3d> positions = RandomPositions(RoomBounds(), 1, 500);
    double before = 0;
    std::size_t bytes = std::size_t(-1);
    for (const double target : {3.5, 5.0, 7.0, 10.0}) {
        const SparseView sparse(Baked(OneLamp(), fmt::format("-sherrortarget {}", target)));
        const double error = ErrorAt(positions, sparse, FromTheLamp);
        EXPECT_GT(error, before) << target;
        EXPECT_LT(sparse.Bytes(), bytes) << target;
        before = error, bytes = sparse.Bytes();
    }
    before = 0;
    for (const double budget : {0.1, 0.03, 0.01}) {
        const SparseView sparse(Baked(OneLamp(), fmt::format("-shbudget {}", budget)));
        const double error = ErrorAt(positions, sparse, FromTheLamp);
        EXPECT_LE(double(sparse.Bytes()), 1e6 * budget);
        EXPECT_GT(double(sparse.Bytes()), 0.6e6 * budget) << "what is allowed is used";
        EXPECT_GT(error, before) << budget;
        before = error;
    }
    EXPECT_FALSE(Printed("more than the"));
    const SceneBuilder large = [] {
        SceneBuilder scene = Room({-3000, -3000, 0}, {3000, 3000, 500});
        scene.AddEntity(Lamp(kSmallLamp, "3000"));
        return scene;
    }();
    const SparseView sparse(Baked(large, "-shbudget 0.01 -gridsh 64 64 64"));
    EXPECT_EQ(double(sparse.Bytes()) > 1e4, Printed("more than the 0.01 of -shbudget")) << sparse.Bytes();
}

TEST_F(SparseBakeTest, TheNumberOfThreadsDoesNotMatter) {
    SceneBuilder scene = OneLamp();
    scene.AddBox({40, -80, 4}, {120, 30, 170}, TestShader("textures/test/wall"));
    const std::vector<std::byte> one = SparseView(Baked(scene, "-sherrortarget 0.7", 1)).Lump();
    for (const int threads : {2, 7})
        EXPECT_TRUE(SparseView(Baked(scene, "-sherrortarget 0.7", threads)).Lump() == one) << threads;
}

// Beside a lamp no cell is small enough: without an end, refinement would fill the whole room with the smallest cells.
TEST_F(SparseBakeTest, TargetsOutOfReachDoNotTakeBytesWithoutGain) {
    const SparseView least(Baked(OneLamp(), "-sherrortarget 0.05"));
    EXPECT_TRUE(Printed("above the target of 0.05"));
    EXPECT_LE(least.Bytes(), 80000u) << "half of the bytes of the uniform grid are less than 0.08 MB here";
    Baked(OneLamp(), "-sherrortarget 8");
    EXPECT_FALSE(Printed("That is above the target"));
}

/// RMS of displayed light, cut off at black and white, over the normals.
template <typename Grid, typename Exact>
double ScreenErrorAt(const std::vector<Vec3d> &positions, const Grid &grid, const Exact &exact) {
    double sum = 0;
    int count = 0;
    for (const Vec3d &p : positions)
        for (const Vec3d &normal : Normals()) {
            const Vec3d shown = Evaluate(grid(p), normal), right = Evaluate(exact(p), normal);
            for (std::size_t channel = 0; channel < 3; channel++) {
                const double off = std::clamp(shown[channel], 0.0, 1.0) - std::clamp(right[channel], 0.0, 1.0);
                sum += 255 * 255 * off * off;
                count++;
            }
        }
    return std::sqrt(sum / count);
}

/// The interpolation between exact values at points every `step` units.
template <typename Exact> Coefficients Interpolated(const Vec3d &p, double step, const Exact &exact) {
    const Vec3d low{std::floor(p.x / step), std::floor(p.y / step), std::floor(p.z / step)}, t = p / step - low;
    Coefficients sum{};
    for (int corner = 0; corner < 8; corner++) {
        const Vec3d at{double(corner & 1), double(corner >> 1 & 1), double(corner >> 2)};
        const double weight = (at.x > 0 ? t.x : 1 - t.x) * (at.y > 0 ? t.y : 1 - t.y) * (at.z > 0 ? t.z : 1 - t.z);
        sum = sum + exact((low + at) * step) * Vec3d{weight, weight, weight};
    }
    return sum;
}

// No point of the uniform grid is level with the strip: one layer of them is below it, the next is above.
TEST_F(SparseBakeTest, AStripOfLightBetweenPointsIsNotMissed) {
    Script(R"(textures/test/strip
{
    q3map_lightRGB 1 0.5 0.25
    q3map_surfacelight 2000
    q3map_backsplash 0 0
    {
        map $whiteimage
        rgbGen const ( 1 0.5 0.25 )
    }
}
)");
    SceneBuilder scene = Room({-512, -512, 0}, {512, 512, 384});
    const int box = scene.AddBox({-512, -100, 24}, {-508, 100, 38}, TestShader("textures/test/wall"));
    scene.SetFaceShader(box, BoxFace::PlusX, TestShader("textures/test/strip"));
    const auto fromTheStrip = [](const Vec3d &p) {
        return FromRectangle(p, {-508, -100, 24}, {0, 200, 0}, {0, 0, 14}, {1, 0, 0}, 0.75 * 2000, {1, 0.5, 0.25});
    };
    const SparseView sparse(Baked(scene, "-sherrortarget 1"));
    const auto before = RandomPositions({{-492, -90, 24}, {-476, 90, 38}}, 0, 200);
    const auto sample = [&](const Vec3d &p) { return sparse.Sample(p); };
    const auto smallest = [&](const Vec3d &p) { return Interpolated(p, 8, fromTheStrip); };
    EXPECT_LT(ScreenErrorAt(before, sample, fromTheStrip), ScreenErrorAt(before, smallest, fromTheStrip))
        << "cells of 8 units are the smallest";
    EXPECT_TRUE(Printed("positions near lights"));
}

TEST_F(SparseBakeTest, AGridOfJoinedCellsSaysWhyItIsNotFiner) {
    const Bsp bsp = Lit(OneLamp());
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size()));
    const JobPool jobs(1);
    const SparseGoal goal{.error = 0.05f, .budget = {}};
    SparseStats stats;
    SparseFromUniform(space, *bsp.gridSH, false, goal, jobs, stats);
    KeptLog quiet;
    PrintSparseStats(stats, goal, quiet.log);
    EXPECT_NE(quiet.text.find(": no cell is smaller than those of the uniform grid"), std::string::npos)
        << quiet.text;
}

TEST_F(SparseBakeTest, ThePrintedErrorIsThatOfTheGrid) {
    const SparseView sparse(Baked(OneLamp(), "-sherrortarget 3"));
    const std::size_t line = printed.find(" levels: RMS error of displayed light at");
    ASSERT_NE(line, std::string::npos);
    const double said = std::stod(printed.substr(line - 9, 9));
    const double error = ScreenErrorAt(
        RandomPositions(RoomBounds(), 16, 2000), [&](const Vec3d &p) { return sparse.Sample(p); }, FromTheLamp);
    EXPECT_NEAR(error, said, 0.35 * said) << "both are measured at random positions, of which few are near the lamp";
}

/// Rooms of 120 units in a row, walls of 8 between them.
struct Rooms {
    static constexpr int kCount = 20;
    static constexpr float kStep = 128, kWall = 8, kHeight = 120;
    static Boundsf BoundsOf(int room) {
        const float x = kStep * float(room);
        return {{x, -60, 0}, {x + kStep - kWall, 60, kHeight}};
    }
    /// Slits of 3 units lead out of the rooms with lamps; a shaft of 6 x 6 units lets light into room 5 from above.
    SceneBuilder Scene() const {
        const SceneShader wall = TestShader("textures/test/wall");
        SceneBuilder scene = Room({0, -60, 0}, {kStep * kCount - kWall, 60, 3 * kHeight});
        for (int i = 0; i + 1 < kCount; i++) {
            const float x = kStep * float(i + 1) - kWall;
            const bool slit = i % 10 == 0;
            scene.AddBox({x, -60, 0}, {x + kWall, slit ? 7.0f : 60.0f, kHeight}, wall);
            if (slit)
                scene.AddBox({x, 10, 0}, {x + kWall, 60, kHeight}, wall);
        }
        const float end = kStep * kCount - kWall, x = 5 * kStep + 60, top = kHeight + 8;
        scene.AddBox({0, -60, kHeight}, {x, 60, top}, wall);
        scene.AddBox({x + 6, -60, kHeight}, {end, 60, top}, wall);
        scene.AddBox({x, -60, kHeight}, {x + 6, -3, top}, wall);
        scene.AddBox({x, 3, kHeight}, {x + 6, 60, top}, wall);
        scene.AddEntity(Lamp({x + 3, 0, 3 * kHeight - 8}, "900"));
        for (int i = 0; i < kCount; i += 10)
            scene.AddEntity(Lamp({kStep * float(i) + 37, 11, 50}, "20"));
        return scene;
    }
};

TEST_F(SparseBakeTest, RoomsThatAreLitStayLitAndDarkOnesDark) {
    const Rooms rooms;
    for (const std::string_view goal : {"-sherrortarget 1", "-sherrortarget 4"}) {
        const SparseView sparse(Baked(rooms.Scene(), goal));
        const GridView uniform(lit);
        int litRooms = 0, darkRooms = 0;
        for (int room = 0; room < Rooms::kCount; room++) {
            double most = 0, mostSparse = 0, mean = 0, meanSparse = 0;
            const std::vector<Vec3d> positions = RandomPositions(Rooms::BoundsOf(room), 1, 300);
            for (const Vec3d &p : positions) {
                const double a = MeanOf(uniform.Sample(p)), b = MeanOf(sparse.Sample(p));
                most = std::max(most, a), mostSparse = std::max(mostSparse, b);
                mean += a / 300, meanSparse += b / 300;
            }
            SCOPED_TRACE(fmt::format("{} room {}: uniform {} at most {}, sparse {} at most {}", goal, room, mean, most,
                                     meanSparse, mostSparse));
            const bool hasLight = room % 10 <= 1 || room == 5;
            if (!hasLight) {
                EXPECT_LT(mostSparse, 2);
                darkRooms++;
            }
            if (most > 2) {
                EXPECT_GT(mostSparse, most / 2);
                EXPECT_GT(meanSparse, mean / 3);
                litRooms++;
            }
        }
        EXPECT_GE(litRooms, 2);
        EXPECT_GE(darkRooms, 14);
    }
}

TEST_F(SparseBakeTest, LightIsContinuousBetweenCells) {
    SceneBuilder scene = OneLamp();
    const Boundsf box{{40, -80, 4}, {120, 30, 170}};
    scene.AddBox(box.mins, box.maxs, TestShader("textures/test/wall"));
    const SparseGridSH grid = Baked(scene, "-sherrortarget 1.5");
    const SparseView sparse(grid);
    std::mt19937 random(9);
    constexpr double kBeside = 1.0 / 1024;
    int checked = 0;
    for (Vec3d p : RandomPositions(RoomBounds(), 1, 6000)) {
        const std::size_t axis = random() % 3;
        const auto cell = double(grid.cell[axis]), first = double(grid.mins[axis]);
        p[axis] = first + cell * std::round((p[axis] - first) / cell);
        if (!Inside(p, RoomBounds(), 1) || Inside(p, box, -1) || Length(p - Vec3d(kSmallLamp)) < 48)
            continue;
        Vec3d a = p, b = p;
        a[axis] -= kBeside, b[axis] += kBeside;
        const Coefficients left = sparse.Sample(a), right = sparse.Sample(b);
        // Within a cell of 8 units the light changes by no more than what a corner 28 units nearer to the lamp has.
        ASSERT_LT(Difference(left, right), 6 * Largest(FromTheLamp(p)) * 2 * kBeside / 8 + 1e-5)
            << p.x << ' ' << p.y << ' ' << p.z << " axis " << axis;
        checked++;
    }
    EXPECT_GT(checked, 4000);
}

TEST_F(SparseBakeTest, RadianceGivesTheSameCells) {
    const SparseGridSH irradiance = Baked(OneLamp()), radiance = Baked(OneLamp(), "-shradiance");
    const auto sparseBytes = double(EncodeSparseGrid(irradiance).size());
    EXPECT_NEAR(double(EncodeSparseGrid(radiance).size()), sparseBytes, 0.02 * sparseBytes);
    const SparseView convolved(irradiance), plain(radiance);
    const auto shown = [&](const Vec3d &p) {
        Coefficients c = plain.Sample(p);
        for (std::size_t k = 0; k < 9; ++k)
            c[k] = c[k] * kCosineLobe[k];
        return c;
    };
    EXPECT_LT(ErrorAt(RandomPositions(RoomBounds(), 1, 200), convolved, shown), 0.5);
}

TEST_F(SparseBakeTest, DeringedValuesAreNotNegative) {
    const auto lowest = [&](std::string_view options) {
        const SparseView sparse(Baked(OneLamp(), options));
        double least = 0;
        for (const Vec3d &p : RandomPositions(RoomBounds(), 1, 500)) {
            const Coefficients c = sparse.Sample(p);
            for (const Vec3d &normal : Normals())
                least = std::min(least, Evaluate(c, normal).x / (MeanOf(c) / 255));
        }
        return least;
    };
    EXPECT_LT(lowest(""), -0.1);
    // Rounding of coefficients 1 to 8, by at most half of 1/127 of the limits of their bands.
    EXPECT_GT(lowest("-shdering"), -0.03);
    EXPECT_TRUE(Printed("points rid of negative lobes"));
}

TEST_F(SparseBakeTest, ItsErrorIsMeasuredByTheReaderForEngines) {
    Baked(OneLamp(), "-sherror");
    EXPECT_TRUE(Printed("--- CheckGridSH ---") && Printed("--- CheckSparseGridSH ---"));
    const std::size_t at = printed.find("CheckSparseGridSH");
    const std::size_t line = printed.find(" levels: RMS error of displayed light", at);
    ASSERT_NE(line, std::string::npos);
    const double error = std::stod(printed.substr(line - 9, 9));
    EXPECT_GT(error, 0.05);
    EXPECT_LT(error, 4);
}

TEST_F(SparseBakeTest, WithoutLightItIsBlackAndSmall) {
    const SparseView sparse(Baked(Room()));
    for (const Vec3d &p : RandomPositions(RoomBounds(), 1, 100))
        ASSERT_EQ(Largest(sparse.Sample(p)), 0);
    EXPECT_LT(sparse.Bytes(), 5000u) << "corners of larger cubes than 64 or 128 units would be outside the room";
}

// Counting the steps of cells to it gives numbers that no int holds.
TEST_F(SparseBakeTest, ALightFarOutsideTheWorldIsHarmless) {
    SceneBuilder scene = OneLamp();
    scene.AddEntity(Lamp({1e12f, 0, 0}, "300"));
    EXPECT_EQ(Baked(scene).points.size(), Baked(OneLamp()).points.size());
}

TEST_F(SparseBakeTest, WithoutOpenSpaceItHasNoPoints) {
    Bsp bsp = OneLamp().Build();
    for (bspLeaf_t &leaf : bsp.leafs)
        leaf.cluster = -1;
    lit = Lit(bsp, "-shadaptive");
    ASSERT_TRUE(lit.sparseGridSH);
    EXPECT_TRUE(lit.sparseGridSH->points.empty());
}

} // namespace

} // namespace q3::test
