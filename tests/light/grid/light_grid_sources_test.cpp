// GPL-2.0-or-later. Both grids: curves and cones of light entities, light_environment, and what no light may depend on.
#include "tests/support/light_fixture.h"

#include <cmath>

namespace q3::test {

namespace {

constexpr double kRadian = std::numbers::pi / 180;

class SourceGridsTest : public LightTest {
  protected:
    /// Lights of all kinds, brighter by a factor and elsewhere: turned by quarters around z, then moved.
    static std::vector<Entity> LightsOfAllKinds(int factor, int quarters = 0, const Vec3f &moved = {}) {
        const auto place = [&](Vec3f p) {
            for (int i = 0; i < quarters; ++i)
                p = {-p.y, p.x, p.z};
            return fmt::format("{} {} {}", p.x + moved.x, p.y + moved.y, p.z + moved.z);
        };
        const auto angles = [&](int pitch, int yaw) { return fmt::format("{} {} 0", pitch, yaw + 90 * quarters); };
        const auto white = [&](int value) { return fmt::format("255 255 255 {}", value * factor); };
        return {MakeEntity("light", {{"origin", place({-150, 40, 90})},
                                     {"_light", white(60)},
                                     {"_constant_attn", "3"},
                                     {"_linear_attn", "0.5"}}),
                MakeEntity("light", {{"origin", place({155, -90, 70})},
                                     {"_light", white(50)},
                                     {"_fifty_percent_distance", "60"},
                                     {"_zero_percent_distance", "150"},
                                     {"_hardfalloff", "1"}}),
                MakeEntity("light", {{"origin", place({20, 120, 110})}, {"_light", white(90)}, {"_radius", "170"}}),
                MakeEntity("light_spot", {{"origin", place({-20, -30, 200})},
                                          {"angles", angles(-60, 20)},
                                          {"_light", white(100)},
                                          {"_inner_cone", "20"},
                                          {"_cone", "50"}})};
    }
    static SceneBuilder With(SceneBuilder scene, const std::vector<Entity> &entities) {
        for (const Entity &entity : entities)
            scene.AddEntity(entity);
        return scene;
    }
    static Coefficients Arriving(const Vec3d &p, const Vec3d &light, double value) {
        return FromDirection(Normalize(light - p), Vec3d{value, value, value} / 255);
    }
};

TEST_F(SourceGridsTest, PolynomialFalloff) {
    const Vec3d light{33, -65, 129};
    const SceneBuilder scene = With(Room(), {MakeEntity("light", {{"origin", "33 -65 129"},
                                                                  {"_light", "80"},
                                                                  {"_constant_attn", "2"},
                                                                  {"_linear_attn", "0.1"},
                                                                  {"_quadratic_attn", "0.003"}})});
    ExpectPoints(LitGrid(scene), 1e-5, 400, [&](const Vec3d &p, Coefficients &c) {
        const double d = std::max(1.0, Length(light - p));
        c = Arriving(p, light, 80 * (2 + 10 + 30) / (2 + 0.1 * d + 0.003 * d * d));
        return Inside(p, RoomBounds());
    });
}

TEST_F(SourceGridsTest, HardFalloffAndRadiusAreDarkBeyondTheirEnd) {
    const Vec3d light{33, -65, 129};
    for (const bool hard : {true, false}) {
        Entity entity = MakeEntity("light", {{"origin", "33 -65 129"}, {"_light", "80"}});
        if (hard) {
            entity.Set("_fifty_percent_distance", "64");
            entity.Set("_zero_percent_distance", "128");
            entity.Set("_hardfalloff", "1");
        } else
            entity.Set("_radius", "128");
        int dark = 0;
        ExpectPoints(
            LitGrid(With(Room(), {entity}), "-gridsh 32 32 32"), 1e-4, 1000, [&](const Vec3d &p, Coefficients &c) {
                const double d = Length(light - p), s = std::clamp((128 - d) / 16, 0.0, 1.0);
                const double fade = s * s * s * (6 * s * s - 15 * s + 10), window = 1 - std::pow(d / 128, 4);
                const double polynomial = 4.7331547e-4 * d * d + 4.7892720e-4 * d + 0.030651341;
                if (d < 128)
                    c = Arriving(p, light, hard ? 80 / polynomial * fade : 80 * 7500 / (d * d) * window * window);
                dark += d > 128;
                return d > 16 && Inside(p, RoomBounds());
            });
        EXPECT_GT(dark, 500);
    }
}

TEST_F(SourceGridsTest, ConesByAngles) {
    const Vec3d light{-101, -43, 240}, axis{std::cos(-50 * kRadian) * std::cos(30 * kRadian),
                                            std::cos(-50 * kRadian) * std::sin(30 * kRadian), std::sin(-50 * kRadian)};
    const SceneBuilder scene = With(Room(), {MakeEntity("light_spot", {{"origin", "-101 -43 240"},
                                                                       {"_light", "255 255 255 100"},
                                                                       {"angles", "-50 30 0"},
                                                                       {"_inner_cone", "15"},
                                                                       {"_cone", "35"},
                                                                       {"_exponent", "2"}})});
    const double inner = std::cos(15 * kRadian), outer = std::cos(35 * kRadian);
    std::array<int, 3> points{};
    ExpectPoints(LitGrid(scene, "-gridsh 16 16 16"), 1e-4, 4000, [&](const Vec3d &p, Coefficients &c) {
        const double d = Length(p - light), cosine = Dot(p - light, axis) / d;
        const double fringe = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
        c = Arriving(p, light, 1e6 / (d * d) * cosine * fringe * fringe);
        ++points[fringe == 0 ? 0 : fringe == 1 ? 1 : 2];
        return d > 1 && Inside(p, RoomBounds());
    });
    for (const int count : points)
        EXPECT_GT(count, 100);
}

TEST_F(SourceGridsTest, ABrightnessIsAPlainLightOfOtherUnits) {
    const auto lit = [&](std::string_view value) {
        return Lit(With(Room(), {MakeEntity("light", {{"origin", "17 15 33"}, {"_light", std::string(value)}})}));
    };
    const Bsp source = lit("255 255 255 75"), plain = lit("100");
    ASSERT_EQ(source.gridPoints.size(), plain.gridPoints.size());
    int lights = 0;
    for (std::size_t i = 0; i < plain.gridPoints.size(); ++i) {
        EXPECT_EQ(source.gridPoints[i].ambient[0], plain.gridPoints[i].ambient[0]);
        EXPECT_EQ(source.gridPoints[i].directed[0], plain.gridPoints[i].directed[0]);
        EXPECT_EQ(source.gridPoints[i].latLong, plain.gridPoints[i].latLong);
        lights += plain.gridPoints[i].directed[0][0] > 0;
    }
    EXPECT_GT(lights, 50);
    const GridView a(source), b(plain);
    for (std::size_t i = 0; i < a.Count(); ++i)
        if (Inside(a.Position(i), RoomBounds())) {
            EXPECT_LE(Difference(a.At(i), b.At(i)), 1e-5 * (0.01 + Largest(b.At(i))));
        }
}

TEST_F(SourceGridsTest, TheLegacyGridKnowsTheCurves) {
    const auto brightest = [&](std::string_view key, std::string_view value) {
        Entity entity = MakeEntity("light", {{"origin", "33 31 60"}, {"_light", "100"}});
        entity.Set(key, value);
        int most = 0;
        for (const bspGridPoint_t &point : Lit(With(Room(), {entity})).gridPoints)
            most = std::max(most, int(point.directed[0][0]));
        return most;
    };
    EXPECT_EQ(brightest("_constant_attn", "1"), brightest("delay", "3"));
    EXPECT_GT(brightest("_constant_attn", "1"), 50);
    EXPECT_EQ(brightest("_radius", "40"), 0) << "no grid point is so near";
    EXPECT_GT(brightest("_radius", "200"), 50);
}

TEST_F(SourceGridsTest, DoubleIntensitiesAreExactlyDoubleLight) {
    const GridView once = LitGrid(With(Room(), LightsOfAllKinds(1))),
                   twice = LitGrid(With(Room(), LightsOfAllKinds(2)));
    ASSERT_EQ(once.Count(), twice.Count());
    double most = 0;
    for (std::size_t i = 0; i < once.Count(); ++i) {
        if (!Inside(once.Position(i), RoomBounds())) // others are fitted
            continue;
        EXPECT_EQ(Difference(once.At(i) * Vec3d{2, 2, 2}, twice.At(i)), 0) << i;
        most = std::max(most, Largest(once.At(i)));
    }
    EXPECT_GT(most, 0.1);
}

TEST_F(SourceGridsTest, LightsAddUp) {
    const std::vector<Entity> all = LightsOfAllKinds(1);
    const GridView sum = LitGrid(With(Room(), all));
    std::vector<Coefficients> parts(sum.Count());
    for (const Entity &entity : all) {
        const GridView one = LitGrid(With(Room(), {entity}));
        for (std::size_t i = 0; i < parts.size(); ++i)
            parts[i] = parts[i] + one.At(i);
    }
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (Inside(sum.Position(i), RoomBounds())) {
            EXPECT_LE(Difference(parts[i], sum.At(i)), 1e-5 * (0.01 + Largest(parts[i])));
        }
}

TEST_F(SourceGridsTest, LightDoesNotDependOnWhereTheMapIs) {
    const GridView here = LitGrid(With(Room(), LightsOfAllKinds(1)), "-gridsh 32 32 32");
    const Vec3f away{4096, -4096, 0};
    const GridView moved =
        LitGrid(With(Room(Vec3f{-250, -186, 4} + away, Vec3f{250, 186, 252} + away), LightsOfAllKinds(1, 0, away)),
                "-gridsh 32 32 32");
    const GridView turned =
        LitGrid(With(Room({-186, -250, 4}, {186, 250, 252}), LightsOfAllKinds(1, 1)), "-gridsh 32 32 32");
    for (std::size_t i = 0; i < here.Count(); ++i) {
        const Vec3d p = here.Position(i);
        if (!Inside(p, RoomBounds(), 32))
            continue;
        const Coefficients c = here.At(i);
        EXPECT_LE(Difference(c, moved.Sample(p + Vec3d(away))), 1e-4 * (0.01 + Largest(c)));
        const Coefficients t = turned.Sample({-p.y, p.x, p.z});
        for (const Vec3d &n : Normals())
            EXPECT_LE(std::abs(Evaluate(c, n).x - Evaluate(t, {-n.y, n.x, n.z}).x), 1e-4 * (0.01 + Largest(c)));
    }
}

TEST_F(SourceGridsTest, SunAndSkyOfAnEnvironment) {
    // Over a floor with sky on all other sides, too far away to be seen below the horizon.
    SceneBuilder scene = Room({-1000, -1000, 0}, {1000, 1000, 400});
    for (const BoxFace wall : {BoxFace::MinusX, BoxFace::PlusX, BoxFace::MinusY, BoxFace::PlusY, BoxFace::PlusZ})
        scene.SetWallShader(wall, TestShader("textures/vec/sky_plain"));
    scene.AddEntity(MakeEntity("light_environment",
                               {{"_light", "255 255 255 120"}, {"_ambient", "255 255 255 50"}, {"angles", "-90 0 0"}}));
    for (const std::string_view options : {"-noskip", ""}) {
        const GridView grid = LitGrid(scene, options);
        int checked = 0;
        for (std::size_t i = 0; i < grid.Count(); ++i) {
            const Vec3d p = grid.Position(i);
            if (std::abs(p.x) > 200 || std::abs(p.y) > 200 || p.z < 20 || p.z > 100)
                continue;
            ++checked;
            const double tolerance = options.empty() ? 0.8 : 0.4;
            // The sun straight above; the L2 cosine is 1/4 + 1/2 + 5/16 there and 1/4 - 5/32 at the horizon. The half
            // sphere of the sky: 1/2 + 1/2 cos, and no band 2.
            EXPECT_NEAR(Evaluate(grid.At(i), {0, 0, 1}).x * 255, 120 * 17 / 16.0 + 50, tolerance);
            EXPECT_NEAR(Evaluate(grid.At(i), {1, 0, 0}).x * 255, 120 * 3 / 32.0 + 25, tolerance);
            EXPECT_NEAR(Evaluate(grid.At(i), {0, 0, -1}).x * 255, 120 / 16.0, tolerance);
        }
        EXPECT_GE(checked, 9);
    }
}

} // namespace

} // namespace q3::test
