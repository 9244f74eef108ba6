// GPL-2.0-or-later. Baked SH grids that name lights: light between points against closed forms, styles, threads.
#include "tests/support/sparse_view.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace q3::test {

namespace {

class NamedBakeTest : public LightTest {
  protected:
    NamedGridSH Baked(const SceneBuilder &scene, std::string_view options = "", int threads = 1) {
        lit = Lit(scene, "-shlights " + std::string(options), threads);
        EXPECT_TRUE(lit.namedGridSH);
        return lit.namedGridSH.value_or(NamedGridSH{});
    }
    Bsp lit;
};

std::vector<Vec3d> PositionsIn(const Boundsf &box, int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit;
    std::vector<Vec3d> positions;
    for (int i = 0; i < count; i++) {
        const Vec3d part{unit(random), unit(random), unit(random)};
        positions.push_back(Vec3d(box.mins) + (Vec3d(box.maxs) - Vec3d(box.mins)) * part);
    }
    return positions;
}

/// Light on a surface, from its position and normal. 1 = byte 255.
using LightAt = std::function<Vec3d(const Vec3d &, const Vec3d &)>;

/// RMS difference of displayed light over positions, normals and channels. Bytes.
double ErrorAt(const std::vector<Vec3d> &positions, const LightAt &grid, const LightAt &exact) {
    double sum = 0;
    int count = 0;
    for (const Vec3d &p : positions)
        for (const Vec3d &n : Normals()) {
            const Vec3d shown = grid(p, n), right = exact(p, n);
            for (std::size_t channel = 0; channel < 3; channel++, count++)
                sum += std::pow(255 * (std::min(1.0, shown[channel]) - std::min(1.0, right[channel])), 2);
        }
    return std::sqrt(sum / count);
}

Entity Lamp(const Vec3f &origin, std::string_view intensity, std::string_view style = "0") {
    return MakeEntity("light", {{"origin", fmt::format("{} {} {}", origin.x, origin.y, origin.z)},
                                {"light", std::string(intensity)},
                                {"style", std::string(style)}});
}

/// Light of a point light at `light` on a surface at p with normal n, without SH: 7500 photons per unit of intensity
/// over the squared distance, which counts as at least 16 units. 1 = byte 255.
Vec3d FromPointOn(const Vec3d &p, const Vec3d &n, const Vec3d &light, double intensity) {
    const Vec3d to = light - p;
    const double d = std::max(16.0, Length(to)), photons = 7500 * intensity;
    const double cosine = std::max(0.0, Dot(to, n) / std::max(1e-9, Length(to)));
    return Vec3d{1, 1, 1} * (photons / (d * d) * cosine / 255);
}

// With L2 coefficients alone the error would be 3 % of such a light, and far more between points close to it.
TEST_F(NamedBakeTest, ALampIsExactBetweenPointsAndForEveryNormal) {
    SceneBuilder scene = Room();
    scene.AddEntity(Lamp({10, 20, 100}, "40"));
    const NamedView grid(Baked(scene));
    const Boundsf inside{RoomBounds().mins + Vec3f{20, 20, 20}, RoomBounds().maxs - Vec3f{20, 20, 20}};
    EXPECT_LT(ErrorAt(
                  PositionsIn(inside, 300), [&](const Vec3d &p, const Vec3d &n) { return grid.Light(p, n); },
                  [](const Vec3d &p, const Vec3d &n) {
                      return FromPointOn(p, n, {10, 20, 100}, 40);
                  }),
              0.5);
}

// Readers bound the names at a place, so cells among hundreds of lamps name fewer of them; others do not.
TEST_F(NamedBakeTest, ManyLampsInOnePlaceTakeNoNamesFromOthers) {
    SceneBuilder scene = Room({-512, -128, 0}, {512, 128, 256});
    std::vector<std::pair<Vec3f, double>> lamps;
    for (const float x : {-472.0f, -456.0f, -440.0f, -424.0f, -408.0f, -392.0f})
        for (const float y : {-40.0f, -24.0f, -8.0f, 8.0f, 24.0f, 40.0f})
            for (const float z : {40.0f, 56.0f, 72.0f, 88.0f, 104.0f, 120.0f, 136.0f, 152.0f, 168.0f, 184.0f})
                lamps.push_back({{x, y, z}, 0.2});
    for (const Vec3f &far : {Vec3f{300, -30, 60}, Vec3f{300, 30, 120}, Vec3f{340, 30, 60}, Vec3f{340, -30, 120}})
        lamps.push_back({far, 6});
    for (const auto &[origin, intensity] : lamps)
        scene.AddEntity(Lamp(origin, fmt::format("{}", intensity)));
    const NamedView grid(Baked(scene));
    EXPECT_LT(ErrorAt(
                  PositionsIn({{270, -60, 30}, {370, 60, 150}}, 300),
                  [&](const Vec3d &p, const Vec3d &n) { return grid.Light(p, n); },
                  [&](const Vec3d &p, const Vec3d &n) {
                      Vec3d sum;
                      for (const auto &[origin, intensity] : lamps)
                          sum += FromPointOn(p, n, Vec3d(origin), intensity);
                      return sum;
                  }),
              0.25)
        << "0.35 with two names in each of these cells";
}

/// A room with a lamp on its lower x side: a box with an emitting face toward +x.
class NamedLampTest : public NamedBakeTest {
  protected:
    NamedLampTest() {
        Script(R"(textures/test/lamp
{
    q3map_surfacelight 2000
    q3map_backsplash 0 0
    {
        map $whiteimage
    }
}
)");
    }
    static SceneBuilder RoomWithLamp(const Boundsf &box) {
        SceneBuilder scene = Room({-512, -512, 0}, {512, 512, 384});
        const int lamp = scene.AddBox(box.mins, box.maxs, TestShader("textures/test/wall"));
        scene.SetFaceShader(lamp, BoxFace::PlusX, TestShader("textures/test/lamp"));
        return scene;
    }
    /// RMS error of the grid in a part of the room as L2 coefficients, bytes.
    static double ErrorIn(const Boundsf &part, const NamedView &grid, const Boundsf &box) {
        const Vec3d corner(box.maxs.x, box.mins.y, box.mins.z), size(box.maxs - box.mins);
        return ErrorAt(
            PositionsIn(part, 300), [&](const Vec3d &p, const Vec3d &n) { return Evaluate(grid.Sample(p), n); },
            [&](const Vec3d &p, const Vec3d &n) {
                return Evaluate(
                    FromRectangle(p, corner, {0, size.y, 0}, {0, 0, size.z}, {1, 0, 0}, 0.75 * 2000, {1, 1, 1}), n);
            });
    }
};

TEST_F(NamedLampTest, SmallLampsBetweenTwoLayersOfPointsAreNotMissed) {
    const Boundsf strip{{-512, -100, 24}, {-508, 100, 38}};
    const NamedView grid(Baked(RoomWithLamp(strip), "-shadaptive -sherrortarget 1"));
    EXPECT_LT(ErrorIn({{-492, -90, 24}, {-476, 90, 38}}, grid, strip), 2.2)
        << "16 to 32 units in front of the strip, about twice the target; compared as L2 coefficients";
    EXPECT_LT(ErrorIn({{-480, -400, 30}, {400, 400, 350}}, grid, strip), 1);
}

// There the light of the lamp ends, and a traced point has all of it or nothing.
TEST_F(NamedLampTest, PointsInThePlaneOfALampDoNotSpoilTheCellsAround) {
    for (const float front : {-480.0f, -448.0f}) {
        const Boundsf panel{{-512, -64, 64}, {front, 64, 192}};
        const NamedView grid(Baked(RoomWithLamp(panel), "-shadaptive -sherrortarget 0.5"));
        EXPECT_LT(ErrorIn({{front + 8, -90, 40}, {front + 40, 90, 220}}, grid, panel), 6) << front;
        EXPECT_LT(ErrorIn({{front + 40, -400, 30}, {400, 400, 350}}, grid, panel), 1) << front;
    }
}

/// A room with a pillar in the middle and lamps on both sides of it: one that is steady, and one of style 5. A faint
/// third one is always there.
SceneBuilder TwoLamps(bool steady, bool styled) {
    SceneBuilder scene = Room({-256, -256, 0}, {256, 256, 192});
    scene.AddBox({-20, -20, 0}, {20, 20, 192}, TestShader("textures/test/wall"));
    if (steady)
        scene.AddEntity(Lamp({-150, -120, 150}, "60"));
    if (styled)
        scene.AddEntity(Lamp({140, 100, 120}, "60", "5"));
    scene.AddEntity(Lamp({0, 200, 100}, "1"));
    return scene;
}

TEST_F(NamedBakeTest, ALightWithAStyleIsSwitched) {
    const NamedView both(Baked(TwoLamps(true, true)));
    const NamedView without(Baked(TwoLamps(true, false)));
    std::array<float, 64> off;
    off.fill(1), off[5] = 0;
    std::array<float, 64> half = off;
    half[5] = 0.5f;
    double worstOff = 0, onSquares = 0, halfSquares = 0;
    int compared = 0;
    for (const Vec3d &p : PositionsIn({{-230, -230, 24}, {230, 230, 170}}, 400)) {
        if (std::abs(p.x) < 40 && std::abs(p.y) < 40)
            continue;
        // Neither is true within about 3 units of a shadow edge.
        const bool seesLamp = !SegmentMeets(p, {140, 100, 120}, {{-20, -20, 0}, {20, 20, 192}}, 3);
        const bool isShadowed = SegmentMeets(p, {140, 100, 120}, {{-20, -20, 0}, {20, 20, 192}}, -3);
        for (const Vec3d &n : Normals()) {
            const Vec3d steady = without.Light(p, n), dark = both.Light(p, n, off.data());
            worstOff = std::max(worstOff, 255 * Length(dark - steady));
            if (!seesLamp && !isShadowed)
                continue;
            const Vec3d lamp = seesLamp ? FromPointOn(p, n, {140, 100, 120}, 60) : Vec3d{};
            onSquares += std::pow(255 * Length(both.Light(p, n) - steady - lamp), 2);
            halfSquares += std::pow(255 * Length(both.Light(p, n, half.data()) - steady - lamp * 0.5), 2);
            compared++;
        }
    }
    EXPECT_LT(worstOff, 1.5) << "no light of style 5 is part of the rest";
    EXPECT_LT(std::sqrt(onSquares / compared), 8) << "light is interpolated across shadow edges";
    EXPECT_LT(std::sqrt(halfSquares / compared), 4);
    EXPECT_EQ(both.CountOfStyle(5, {200, 150, 100}), 1);
    EXPECT_EQ(without.CountOfStyle(5, {200, 150, 100}), 0);
}

TEST_F(NamedBakeTest, ADarkRoomBesideALitOneStaysDark) {
    SceneBuilder scene = Room({-256, -128, 0}, {256, 128, 128});
    scene.AddBox({-4, -128, 0}, {4, 128, 128}, TestShader("textures/test/wall"));
    scene.AddEntity(Lamp({-60, 10, 64}, "50"));
    for (const char *options : {"", "-shadaptive", "-gridsh 64 64 64"}) {
        const NamedView grid(Baked(scene, options));
        double most = 0;
        for (const Vec3d &p : PositionsIn({{24, -100, 30}, {230, 100, 100}}, 300))
            for (const Vec3d &n : Normals())
                most = std::max(most, 255 * grid.Light(p, n).x);
        EXPECT_LT(most, 2) << options;
    }
}

TEST_F(NamedBakeTest, TheNumberOfThreadsDoesNotMatter) {
    for (const char *options : {"", "-shadaptive -sherrortarget 0.7"}) {
        const std::vector<std::byte> one = NamedView(Baked(TwoLamps(true, true), options, 1)).Lump();
        for (const int threads : {2, 7})
            EXPECT_TRUE(NamedView(Baked(TwoLamps(true, true), options, threads)).Lump() == one) << options << threads;
    }
}

TEST_F(NamedBakeTest, BudgetsAreKept) {
    SceneBuilder scene = TwoLamps(true, true);
    for (const double budget : {0.03, 0.01})
        EXPECT_LE(double(NamedView(Baked(scene, fmt::format("-shadaptive -shbudget {}", budget))).Bytes()),
                  1e6 * budget);
}

} // namespace

} // namespace q3::test
