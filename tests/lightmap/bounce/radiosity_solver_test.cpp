// GPL-2.0-or-later. The radiosity solver against closed forms and a matrix solution; both orders of shooting; limits.
#include "common/error.h"
#include "tests/support/light_fixture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace q3::test {

namespace {

/// Reflectance of a white texture at -bouncescale 1.
constexpr double kWhite = 187.5 * 3 * 0.25 / 255;

class RadiosityTest : public LightTest {
  protected:
    RadiosityTest() {
        surfaces = true;
        std::string script;
        for (const auto &[name, scale] : {std::pair{"black", 0.0}, {"gray", 0.5}, {"bright", 1.6}})
            script += fmt::format("textures/test/{}\n{{\n\tq3map_bounceScale {}\n\t{{\n\t\tmap $whiteimage\n\t}}\n}}\n",
                                  name, scale);
        Script(script);
    }
    /// A closed box with ambient light; by default all walls are white.
    static SceneBuilder Box(const Vec3f &half, double ambient, std::string_view shader = "textures/test/wall") {
        SceneBuilder scene;
        scene.SetInterior(-half, half, TestShader(shader));
        scene.SetWorldKey("_ambient", fmt::format("{}", ambient));
        return scene;
    }
    /// Red value of the texel nearest to `place` on a surface that faces `normal`: byte + 0.5, since bytes are rounded
    /// down.
    static double TexelAt(const Bsp &bsp, const Vec3f &place, const Vec3f &normal) {
        double best = 1e30, value = -1;
        for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
            const bspDrawVert_t *v = bsp.drawVerts.data() + surface.firstVert;
            if (surface.lightmapNum[0] < 0 || surface.numVerts < 3 || Dot(Vec3f(v[0].normal), normal) < 0.9f)
                continue;
            for (int k = 0; k + 2 < surface.numIndexes; k += 3) {
                const bspDrawVert_t *t[3];
                for (int i = 0; i < 3; ++i)
                    t[i] = v + bsp.drawIndexes[std::size_t(surface.firstIndex + k + i)];
                for (int a = 0; a <= 64; ++a)
                    for (int b = 0; a + b <= 64; ++b) {
                        const float w[3] = {1 - float(a + b) / 64, float(a) / 64, float(b) / 64};
                        Vec3f p;
                        float s = 0, q = 0;
                        for (int i = 0; i < 3; ++i) {
                            p += Vec3f(t[i]->xyz) * w[i];
                            s += t[i]->lightmap[0][0] * w[i], q += t[i]->lightmap[0][1] * w[i];
                        }
                        if (const double d = double(Length(p - place)); d < best)
                            best = d,
                            value = bsp.lightmaps[3 * std::size_t((surface.lightmapNum[0] * 128 + int(q * 128)) * 128 +
                                                                  int(s * 128))];
                    }
            }
        }
        return value + 0.5;
    }
};

TEST_F(RadiosityTest, EndlessBouncesFillAFurnace) {
    for (const std::string_view options : {"", "-reflectivity linear -bouncescale 0.7"}) {
        const double r = options.empty() ? kWhite : 0.7;
        const Bsp lit = Lit(Box({256, 256, 128}, 60), fmt::format("-nogrid -bounce inf {}", options));
        for (const Vec3f &normal : {Vec3f{0, 0, 1}, Vec3f{-1, 0, 0}})
            EXPECT_NEAR(TexelAt(lit, -Vec3f{normal.x * 256, 40, normal.z * 128}, normal), 60 / (1 - r),
                        0.01 * 60 / (1 - r))
                << options;
        EXPECT_TRUE(Printed(", remaining "));
    }
}

/// Weak light, so that the solver stops while a share of it is still to come.
TEST_F(RadiosityTest, WeakLightIsWhole) {
    for (const double r : {0.5, 0.75})
        for (const std::string_view bounces : {"12", "inf"}) {
            const Bsp lit = Lit(Box({256, 256, 128}, 7),
                                fmt::format("-bouncegrid -bounce {} -bouncescale {}", bounces, r / kWhite));
            const double expected = 7 * (1 - (bounces == "inf" ? 0 : std::pow(r, 13))) / (1 - r);
            const Coefficients found = GridView(lit).Sample({20, 40, -30});
            double mean = 0;
            for (const Vec3d &normal : Normals())
                mean += Evaluate(found, normal).x * 255 / double(Normals().size());
            EXPECT_NEAR(mean, expected, 0.002 * expected) << r << " " << bounces;
        }
}

TEST_F(RadiosityTest, NothingReflectsAllLight) {
    const Bsp lit = Lit(Box({128, 128, 128}, 1), "-nogrid -bounce inf -bouncescale 20");
    EXPECT_NEAR(TexelAt(lit, {0, 0, -128}, {0, 0, 1}), 1 / (1 - 0.99), 1.5);
}

TEST_F(RadiosityTest, ParallelPlates) {
    SceneBuilder scene = Box({1024, 1024, 32}, 60, "textures/test/black");
    scene.SetWallShader(BoxFace::MinusZ, TestShader("textures/test/wall"));
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/test/gray"));
    const Bsp lit = Lit(scene, "-nogrid -bounce inf");
    // E0 = e + r1 E1, E1 = e + r0 E0 for infinite plates; each of these covers all but 0.2 % of the other's hemisphere.
    const double r0 = kWhite, r1 = kWhite * 0.5;
    EXPECT_NEAR(TexelAt(lit, {0, 0, -32}, {0, 0, 1}), 60 * (1 + r1) / (1 - r0 * r1), 0.01 * 80);
    EXPECT_NEAR(TexelAt(lit, {0, 0, 32}, {0, 0, -1}), 60 * (1 + r0) / (1 - r0 * r1), 0.01 * 100);
}

/// Form factor of a rectangle at a point, by Lambert's formula: a sum over its edges.
double RectangleFormFactor(const Vec3d &p, const Vec3d &normal, const std::array<Vec3d, 4> &corners) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3d a = Normalize(corners[i] - p), b = Normalize(corners[(i + 1) % 4] - p);
        sum += std::acos(std::clamp(Dot(a, b), -1.0, 1.0)) * Dot(Normalize(Cross(a, b)), normal);
    }
    return std::abs(sum) / (2 * std::numbers::pi);
}

/// Solves the radiosity equation by Gauss-Seidel for a box, one reflectance for each wall, the walls cut into squares.
class BoxSolution {
  public:
    static constexpr int kSide = 12;
    BoxSolution(double half, const std::array<double, 6> &reflectance, double direct) {
        const double step = 2 * half / kSide;
        for (int wall = 0; wall < 6; ++wall)
            for (int y = 0; y < kSide; ++y)
                for (int x = 0; x < kSide; ++x) {
                    const auto at = [&](double u, double v) {
                        Vec3d p;
                        p[std::size_t(wall / 2)] = wall % 2 == 0 ? -half : half;
                        p[std::size_t((wall / 2 + 1) % 3)] = -half + u * step;
                        p[std::size_t((wall / 2 + 2) % 3)] = -half + v * step;
                        return p;
                    };
                    Patch patch{at(x + 0.5, y + 0.5), {}, {at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)}};
                    patch.normal[std::size_t(wall / 2)] = wall % 2 == 0 ? 1 : -1;
                    patch.reflectance = reflectance[std::size_t(wall)], patch.light = direct;
                    patches_.push_back(patch);
                }
        Solve(direct);
    }
    /// Light at a place on the wall that faces `normal`, from the radiosity of all patches.
    double At(const Vec3d &place, const Vec3d &normal, double direct) const {
        double light = direct;
        for (const Patch &from : patches_)
            if (Dot(from.normal, place - from.center) > 1e-6)
                light += from.reflectance * from.light * RectangleFormFactor(place, normal, from.corners);
        return light;
    }

  private:
    struct Patch {
        Vec3d center, normal;
        std::array<Vec3d, 4> corners;
        double reflectance = 0, light = 0;
    };
    void Solve(double direct) {
        const std::size_t n = patches_.size();
        std::vector<double> factors(n * n);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j)
                if (Dot(patches_[j].normal, patches_[i].center - patches_[j].center) > 1e-6)
                    factors[i * n + j] =
                        RectangleFormFactor(patches_[i].center, patches_[i].normal, patches_[j].corners);
        for (int sweep = 0; sweep < 60; ++sweep)
            for (std::size_t i = 0; i < n; ++i) {
                double light = direct;
                for (std::size_t j = 0; j < n; ++j)
                    light += factors[i * n + j] * patches_[j].reflectance * patches_[j].light;
                patches_[i].light = light;
            }
    }
    std::vector<Patch> patches_;
};

/// Like the Cornell box: walls of three reflectances.
TEST_F(RadiosityTest, BoxOfDifferentWalls) {
    SceneBuilder scene = Box({256, 256, 256}, 60);
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/test/gray"));
    scene.SetWallShader(BoxFace::PlusX, TestShader("textures/test/bright"));
    const Bsp lit = Lit(scene, "-nogrid -bounce inf");
    const BoxSolution expected(256, {kWhite * 0.5, kWhite * 1.6, kWhite, kWhite, kWhite, kWhite}, 60);
    const auto check = [&](const Vec3f &place, const Vec3f &normal) {
        double mean = 0;
        int count = 0;
        for (int u = -1; u <= 1; ++u) // mean of nine luxels, since each has noise
            for (int v = -1; v <= 1; ++v) {
                const Vec3f aside = normal.x != 0 ? Vec3f{0, float(u), float(v)} : Vec3f{float(u), float(v), 0};
                mean += TexelAt(lit, place + aside * 16, normal), ++count;
            }
        const double light = expected.At(Vec3d(place), Vec3d(normal), 60);
        EXPECT_NEAR(mean / count, light, 0.01 * light);
    };
    check({-256, 8, 8}, {1, 0, 0});
    check({256, 8, 8}, {-1, 0, 0});
    check({8, 8, -256}, {0, 0, 1});
    check({168, -120, -256}, {0, 0, 1});
}

/// Walls of a cube see each other by known form factors, whatever the number of rays.
TEST_F(RadiosityTest, FewRaysSeeWallsInTheirShares) {
    SceneBuilder scene = Box({256, 256, 256}, 1000, "textures/test/black");
    scene.SetWallShader(BoxFace::PlusX, TestShader("textures/test/wall"));
    for (const int rays : {16, 64, 256}) {
        const Bsp lit = Lit(scene, fmt::format("-nogrid -bounce 1 -bounceonly -bouncerays {}", rays));
        const auto meanOn = [&](const Vec3f &normal) {
            double sum = 0;
            for (int u = 0; u < 16; ++u)
                for (int v = 0; v < 16; ++v) {
                    const float a = float(u) * 32 - 240, b = float(v) * 32 - 240;
                    sum += TexelAt(lit, normal * -256 + (normal.x != 0 ? Vec3f{0, a, b} : Vec3f{a, b, 0}), normal);
                }
            return sum / 256;
        };
        // The mean of as many independent rays, 16 of each of 256 luxels, has a standard error of 3 percent.
        const double within = 0.2 * (rays < 64 ? 0.03 : 0.01);
        EXPECT_NEAR(meanOn({1, 0, 0}) / (1000 * kWhite), 0.199825, within) << rays;
        EXPECT_NEAR(meanOn({0, 0, 1}) / (1000 * kWhite), 0.200044, within) << rays;
    }
}

/// A small closed room with bright walls beside a large dim hall: after some steps only the room has light left to
/// shoot.
TEST_F(RadiosityTest, BothOrdersOfShootingAgree) {
    SceneBuilder scene;
    scene.SetInterior({0, -512, 0}, {2048, 512, 512}, TestShader("textures/test/gray"));
    scene.AddBox({0, -512, 128}, {144, 512, 512}, TestShader("textures/test/gray"));
    scene.AddBox({128, -512, 0}, {144, 512, 128}, TestShader("textures/test/bright"));
    scene.AddBox({0, -512, 0}, {128, -64, 128}, TestShader("textures/test/bright"));
    scene.AddBox({0, 64, 0}, {128, 512, 128}, TestShader("textures/test/bright"));
    scene.AddBox({0, -64, 0}, {128, 64, 8}, TestShader("textures/test/bright"));
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/test/bright"));
    scene.AddEntity(MakeEntity("light", {{"origin", "64 0 64"}, {"light", "10"}}));
    scene.AddEntity(MakeEntity("light", {{"origin", "1024 0 256"}, {"light", "60"}}));
    const std::string options = "-nogrid -bouncescale 1.1 ";
    const Bsp jacobi = Lit(scene, options + "-bounce 1000");
    EXPECT_FALSE(Printed("brightest surfaces"));
    const Bsp refined = Lit(scene, options + "-bounce inf");
    EXPECT_TRUE(Printed("brightest surfaces"));
    ASSERT_EQ(jacobi.lightmaps.size(), refined.lightmaps.size());
    int most = 0;
    for (std::size_t i = 0; i < jacobi.lightmaps.size(); ++i)
        most = std::max(most, std::abs(int(jacobi.lightmaps[i]) - int(refined.lightmaps[i])));
    EXPECT_LE(most, 1);
}

TEST_F(RadiosityTest, BouncesEndEarly) {
    const Bsp few = Lit(Box({128, 128, 128}, 10, "textures/test/gray"), "-nogrid -bounce 30");
    EXPECT_FALSE(Printed("in bounce 30"));
    const Bsp all = Lit(Box({128, 128, 128}, 10, "textures/test/gray"), "-nogrid -bounce inf");
    EXPECT_EQ(few.lightmaps, all.lightmaps);
}

TEST_F(RadiosityTest, BlackWallsKeepTheirBytes) {
    SceneBuilder scene = Box({256, 128, 128}, 0, "textures/test/black");
    scene.AddEntity(MakeEntity("light", {{"origin", "64 0 64"}, {"light", "100"}}));
    EXPECT_EQ(Lit(scene, "-nogrid -bounce inf").lightmaps, Lit(scene, "-nogrid").lightmaps);
}

/// Reciprocity: A_1 F_12 = A_2 F_21. All surfaces get the same ambient light and are black, except that first the top
/// of a small block reflects and the ceiling receives, then the other way around.
TEST_F(RadiosityTest, BlockAndCeilingGiveEachOtherTheSamePower) {
    const auto receivedPower = [&](std::string_view block, std::string_view ceiling, double side, const Vec3f &normal) {
        SceneBuilder scene = Box({128, 128, 64}, 600, "textures/test/black");
        scene.SetWallShader(BoxFace::PlusZ, TestShader(ceiling));
        const int box = scene.AddBox({-80, -16, -64}, {-16, 48, -32}, TestShader("textures/test/black"));
        scene.SetFaceShader(box, BoxFace::PlusZ, TestShader(block));
        const Bsp lit = Lit(scene, "-nogrid -bounce 1 -bounceonly -bouncerays 1024");
        const Vec3f center = normal.z > 0 ? Vec3f{-48, 16, -32} : Vec3f{0, 0, 64};
        double sum = 0;
        for (int u = 0; u < 16; ++u)
            for (int v = 0; v < 16; ++v) {
                const auto at = [&](int i) { return float(side * ((i + 0.5) / 16 - 0.5)); };
                sum += TexelAt(lit, center + Vec3f{at(u), at(v), 0}, normal);
            }
        return sum * side * side / 256;
    };
    const double onCeiling = receivedPower("textures/test/wall", "textures/test/black", 256, {0, 0, -1});
    const double onBlock = receivedPower("textures/test/black", "textures/test/wall", 64, {0, 0, 1});
    EXPECT_NEAR(onCeiling, onBlock, 0.03 * onBlock);
    EXPECT_GT(onBlock, 64 * 64 * 100.0);
}

TEST_F(RadiosityTest, StylesBounceOnTheirOwn) {
    SceneBuilder scene = Box({256, 128, 128}, 0);
    scene.AddEntity(MakeEntity("light", {{"origin", "64 0 64"}, {"light", "60"}, {"style", "3"}}));
    Lit(scene, "-nogrid -bounce 3");
    EXPECT_TRUE(Printed("Light style 3"));
}

TEST_F(RadiosityTest, TimeLimitLeavesLight) {
    const Bsp lit = Lit(Box({256, 256, 128}, 60), "-nogrid -bounce inf -bouncetime 1e-9");
    EXPECT_TRUE(Printed("-bouncetime 1e-09 is over after 2 bounces"));
    EXPECT_NEAR(TexelAt(lit, {0, 0, -128}, {0, 0, 1}), 60 * (1 + kWhite + kWhite * kWhite), 1.5);
}

TEST_F(RadiosityTest, WordsThatAreNoNumbersOfBounces) {
    for (const std::string_view word : {"-1", "many", "1001", "2.5"})
        EXPECT_THROW(Lit(Box({128, 128, 128}, 10), fmt::format("-bounce {}", word)), Error) << word;
}

} // namespace

} // namespace q3::test
