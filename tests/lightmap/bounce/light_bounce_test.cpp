// GPL-2.0-or-later. Bounced light: a closed white room knows the answer.
#include "tests/support/compiled_map.h"
#include "tests/support/light_fixture.h"

#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace q3::test {

namespace {

/// Red channel of the lightmap texels between the vertices of a surface, on the byte scale.
std::vector<double> RedTexels(const Bsp &bsp, const bspDrawSurface_t &surface) {
    std::size_t least[2] = {127, 127}, most[2] = {0, 0};
    for (int i = 0; i < surface.numVerts; ++i)
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const auto at = std::size_t(bsp.drawVerts[std::size_t(surface.firstVert + i)].lightmap[0][axis] * 128);
            least[axis] = std::min(least[axis], at), most[axis] = std::max(most[axis], at);
        }
    std::vector<double> texels;
    for (std::size_t y = least[1]; surface.lightmapNum[0] >= 0 && y <= most[1]; ++y)
        for (std::size_t x = least[0]; x <= most[0]; ++x)
            texels.push_back(bsp.lightmaps[3 * ((std::size_t(surface.lightmapNum[0]) * 128 + y) * 128 + x)]);
    return texels;
}

class BounceTest : public LightTest {
  protected:
    BounceTest() { surfaces = true; }

    /// Mean difference in bytes along the joint of two halves of a floor, which never share a lightmap, under bounced
    /// light alone.
    double StepBetweenHalves();

    /// The red channel of all lightmap texels at draw vertices, on the byte scale.
    static std::vector<double> AtVertices(const Bsp &bsp) {
        std::vector<double> light;
        for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
            if (surface.lightmapNum[0] < 0)
                continue;
            const std::size_t page = std::size_t(surface.lightmapNum[0]) * 128 * 128 * 3;
            for (int i = 0; i < surface.numVerts; ++i) {
                const auto &at = bsp.drawVerts[std::size_t(surface.firstVert + i)].lightmap[0];
                const auto x = std::size_t(at[0] * 128), y = std::size_t(at[1] * 128);
                light.push_back(bsp.lightmaps[page + 3 * (y * 128 + x)]);
            }
        }
        return light;
    }
    /// Mean of the texels of a shader's surfaces, red channel.
    static double MeanOn(const Bsp &bsp, std::string_view shader) {
        std::vector<double> light;
        for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
            if (FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader) == shader)
                for (const double byte : RedTexels(bsp, surface))
                    light.push_back(byte);
        EXPECT_FALSE(light.empty());
        return std::accumulate(light.begin(), light.end(), 0.0) / double(std::max<std::size_t>(light.size(), 1));
    }
};

/// White walls without lights; `_ambient` lights all surfaces alike.
Bsp WhiteRoom(double ambient) {
    return CompiledMapOf("furnace", {{"_ambient", fmt::format("{}", ambient)}});
}

/// What a wall of white sends on at -bouncescale 0.25: 187.5 * 3 * 0.25 / 255.
constexpr double kReflectance = 140.625 / 255;

TEST_F(BounceTest, AWhiteRoomFollowsTheGeometricSeries) {
    for (const int bounces : {1, 2, 5})
        for (const double scale : {0.25, 0.4}) {
            const double r = kReflectance * scale / 0.25;
            const Bsp lit =
                Lit(WhiteRoom(40), fmt::format("-nogrid -bounce {} -bouncescale {}", bounces, scale / 0.25));
            const double expected = 40 * (1 - std::pow(r, bounces + 1)) / (1 - r);
            const auto light = AtVertices(lit);
            ASSERT_GE(light.size(), 24u);
            for (const double one : light)
                EXPECT_NEAR(one + 0.5, std::min(255.0, expected), 0.02 * expected + 0.5) << bounces << " " << scale;
        }
}

TEST_F(BounceTest, BouncedLightReachesBothGrids) {
    const Bsp lit = Lit(WhiteRoom(40), "-bounce 1 -bouncegrid"), without = Lit(WhiteRoom(40), "-bounce 1");
    const Coefficients with = GridView(lit).Sample({10, 20, 70}), direct = GridView(without).Sample({10, 20, 70});
    for (const Vec3d &normal : Normals())
        EXPECT_NEAR((Evaluate(with, normal) - Evaluate(direct, normal)).x * 255, 40 * kReflectance, 1);
    const bspGridPoint_t &point = lit.gridPoints[lit.gridPoints.size() / 2];
    EXPECT_GT(int(point.ambient[0][0]), int(without.gridPoints[lit.gridPoints.size() / 2].ambient[0][0]) + 3);
}

TEST_F(BounceTest, NothingIsCreatedOrLost) {
    // One lamp in a closed white room: all light that the walls send on arrives on walls.
    const Bsp room = CompiledMapOf("white_lamp");
    const auto sum = [&](std::string_view options) {
        double total = 0;
        for (const std::uint8_t byte : Lit(room, fmt::format("-nogrid -nocollapse {}", options)).lightmaps)
            total += byte == 0 ? 0 : byte + 0.5; // bytes are cut off
        return total;
    };
    EXPECT_NEAR(sum("-bounce 1 -bounceonly") / sum(""), kReflectance, 0.05 * kReflectance);
}

TEST_F(BounceTest, AColorInPlaceOfAnImageTintsWhatIsSentOn) {
    const auto brightest = [&](std::size_t channel) {
        const Bsp lit = Lit(WhiteRoom(40), "-nogrid -bounce 1 -bounceonly");
        int most = 0;
        for (std::size_t i = channel; i < lit.lightmaps.size(); i += 3)
            most = std::max<int>(most, lit.lightmaps[i]);
        return most;
    };
    const int white = brightest(0);
    ASSERT_GT(white, 20);
    Script("textures/test/wall\n{\n\tq3map_lightRGB 1 0.5 0\n\t{\n\t\tmap $whiteimage\n\t}\n}\n");
    EXPECT_EQ(brightest(0), white);
    EXPECT_NEAR(brightest(1), white / 2., 1);
    EXPECT_EQ(brightest(2), 0);
}

TEST_F(BounceTest, ABlackTextureSendsNothingOn) {
    Script("textures/test/black\n{\n\tq3map_bouncescale 0\n\t{\n\t\tmap $whiteimage\n\t}\n}\n");
    SceneBuilder scene;
    scene.SetInterior({-160, -128, 0}, {160, 128, 192}, TestShader("textures/test/black"));
    scene.SetWorldKey("_ambient", "40");
    for (const double one : AtVertices(Lit(scene, "-nogrid -bounce 3")))
        EXPECT_EQ(one, 40);
}

TEST_F(BounceTest, VerticesAHairOverAFloorSeeIt) {
    // A plate half a unit over the floor, lit at its vertices. All that its underside sees is the floor.
    Script("textures/test/white\n{\n\t{\n\t\tmap $whiteimage\n\t}\n}\n"
           "textures/test/plate\n{\n\tsurfaceparm pointlight\n\t{\n\t\tmap $whiteimage\n\t}\n}\n");
    SceneBuilder scene;
    scene.SetInterior({-160, -128, 0}, {160, 128, 192}, TestShader("textures/test/white"));
    scene.SetWorldKey("_ambient", "40");
    scene.AddQuad({{{-64, -64, 0.5f}, {64, -64, 0.5f}, {64, 64, 0.5f}, {-64, 64, 0.5f}}},
                  TestShader("textures/test/plate"));
    const Bsp lit = Lit(scene, "-nogrid -bounce 1");
    int checked = 0;
    for (const bspDrawSurface_t &surface : lit.drawSurfaces)
        for (int i = 0; surface.lightmapNum[0] < 0 && i < surface.numVerts; ++i, ++checked) {
            const bspDrawVert_t &v = lit.drawVerts[std::size_t(surface.firstVert + i)];
            EXPECT_EQ(v.normal[2], -1);
            EXPECT_NEAR(v.color[0][0] + 0.5, 40 * (1 + kReflectance), 1);
        }
    EXPECT_EQ(checked, 4);
}

double BounceTest::StepBetweenHalves() {
    SceneBuilder scene = Room({-192, -192, -16}, {192, 192, 192});
    scene.AddQuad({{{-128, 128, 0}, {0, 128, 0}, {0, -128, 0}, {-128, -128, 0}}}, TestShader("textures/test/left"));
    scene.AddQuad({{{0, 128, 0}, {128, 128, 0}, {128, -128, 0}, {0, -128, 0}}}, TestShader("textures/test/right"));
    scene.AddEntity(MakeEntity("light", {{"origin", "-150 40 150"}, {"light", "800"}}));
    const Bsp lit = Lit(scene, "-nogrid -bounce 1 -bounceonly -nocollapse");
    // Bytes along the joint at x = 0, from one end to the other.
    const auto along = [&](std::string_view shader) {
        std::vector<int> bytes;
        for (const bspDrawSurface_t &surface : lit.drawSurfaces) {
            if (FieldName(lit.shaders[std::size_t(surface.shaderNum)].shader) != shader)
                continue;
            std::array<std::array<float, 2>, 2> ends{};
            for (int i = 0; i < surface.numVerts; ++i)
                if (const bspDrawVert_t &v = lit.drawVerts[std::size_t(surface.firstVert + i)]; v.xyz[0] == 0)
                    ends[v.xyz[1] > 0] = v.lightmap[0];
            for (int i = 0; i <= 16; ++i) {
                const auto at = [&](std::size_t axis) {
                    return std::size_t(128 * (ends[0][axis] + (ends[1][axis] - ends[0][axis]) * float(i) / 16));
                };
                const std::size_t page = std::size_t(surface.lightmapNum[0]) * 128;
                bytes.push_back(lit.lightmaps[((page + at(1)) * 128 + at(0)) * 3]);
            }
        }
        return bytes;
    };
    const std::vector<int> left = along("textures/test/left"), right = along("textures/test/right");
    EXPECT_EQ(left.size(), 17u);
    EXPECT_EQ(right.size(), 17u);
    double steps = 0;
    for (std::size_t i = 0; i < std::min(left.size(), right.size()); ++i) {
        EXPECT_GT(left[i], 50);
        steps += std::abs(left[i] - right[i]);
    }
    return steps / 17;
}

TEST_F(BounceTest, NoStepWhereLightmapsTouch) {
    Script("textures/test/left\n{\n\tq3map_splotchFix\n\t{\n\t\tmap $whiteimage\n\t}\n}\n");
    // Less than a step of a display with 6 bits a channel, 4 bytes: no edge shows.
    EXPECT_LT(StepBetweenHalves(), 3.0);
}

/// Sum of the lightmap bytes of the surfaces whose normal is -x, in their red channel.
double SumFacingBack(const Bsp &bsp) {
    double total = 0;
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        if (surface.numVerts > 0 && bsp.drawVerts[std::size_t(surface.firstVert)].normal[0] < -0.5f)
            for (const double byte : RedTexels(bsp, surface))
                total += byte;
    return total;
}

TEST_F(BounceTest, FastEndsFaintPieces) {
    Script("textures/test/black\n{\n\tq3map_bouncescale 0\n\t{\n\t\tmap $whiteimage\n\t}\n}\n"
           "textures/test/bright\n{\n\tq3map_nofast\n\t{\n\t\tmap $whiteimage\n\t}\n}\n");
    const auto farEnd = [&](float length, std::string_view shader, std::string_view options) {
        SceneBuilder scene;
        scene.SetInterior({0, -128, -128}, {length, 128, 128}, TestShader("textures/test/black"));
        scene.SetWallShader(BoxFace::MinusX, TestShader(shader));
        scene.SetWorldKey("_ambient", "4000");
        return SumFacingBack(Lit(scene, fmt::format("-nogrid -bounce 1 -bounceonly -bouncerays 256 {}", options)));
    };
    // Two triangles of 256 x 256 / 2: of white 255 each gives 140.625 * area / (pi * distance^2), 1 at 1211 units.
    const double near = farEnd(1000, "textures/test/wall", "");
    EXPECT_GT(near, 0);
    EXPECT_NEAR(farEnd(1000, "textures/test/wall", "-fast"), near, 0.2 * near);
    const double beyond = farEnd(1500, "textures/test/wall", "");
    EXPECT_GT(beyond, 0);
    EXPECT_EQ(farEnd(1500, "textures/test/wall", "-fast"), 0);
    EXPECT_NEAR(farEnd(1500, "textures/test/bright", "-fast"), beyond, 0.25 * beyond);
}

/// A room with a black sliver, 4 high, that faces a plate from x0 to x1 at height z. Its luxels ask from half a luxel
/// higher where they lie in the floor.
class SliverTest : public BounceTest {
  protected:
    double AtSliver(float x0, float x1, float z, std::string_view options, float bottom = 0.2f) {
        Script("textures/test/black\n{\n\tq3map_bouncescale 0\n\t{\n\t\tmap $whiteimage\n\t}\n}\n"
               "textures/test/sliver\n{\n\tq3map_bouncescale 0\n\t{\n\t\tmap $whiteimage\n\t}\n}\n");
        SceneBuilder scene;
        scene.SetInterior({-256, -256, 0}, {256, 256, 256}, TestShader("textures/test/black"));
        const float top = bottom + 3.8f;
        scene.AddQuad({{{100, 64, bottom}, {100, 64, top}, {100, -64, top}, {100, -64, bottom}}},
                      TestShader("textures/test/sliver"));
        scene.AddQuad({{{x0, -64, z}, {x0, 64, z}, {x1, 64, z}, {x1, -64, z}}}, TestShader("textures/test/plate"));
        scene.SetWorldKey("_ambient", "200");
        const Bsp lit = Lit(scene, fmt::format("-nogrid -bounce 1 -bounceonly -bouncerays 256 {}", options));
        return MeanOn(lit, "textures/test/sliver");
    }
};

TEST_F(SliverTest, FastEndsPiecesThatItLiesBehindOrThatLieBehindIt) {
    // The row above, which only texture filtering reads, is over the plate, and smoothing takes its share.
    const double seen = AtSliver(0, 96, 0.5f, "");
    EXPECT_GT(seen, 20);
    EXPECT_LT(AtSliver(0, 96, 0.5f, "-fast"), 0.6 * seen) << "the sliver's receivers are behind the plate";
    EXPECT_GT(AtSliver(0, 96, 0.005f, "-fast"), 5);
    EXPECT_GT(AtSliver(60, 220, 0.005f, ""), 5);
    EXPECT_EQ(AtSliver(60, 220, 0.005f, "-fast"), 0) << "the middles of the plate's triangles are behind the sliver";
}

TEST_F(SliverTest, FastCountsWhatLiesBehindItAgainstTheRestOfAPiece) {
    // Both triangles have their middle before the sliver, but reach 40 units behind it.
    const double seen = AtSliver(0, 140, 0.005f, ""), left = AtSliver(0, 140, 0.005f, "-fast");
    EXPECT_GT(seen, 20);
    EXPECT_LT(left, 0.8 * seen);
    EXPECT_GT(left, 0.2 * seen);
    EXPECT_NEAR(AtSliver(0, 97, 0.005f, "-fast"), AtSliver(0, 97, 0.005f, ""), 1.5) << "nothing behind";
    const double higher = AtSliver(0, 140, 0.005f, "", 24);
    EXPECT_GT(higher, 20);
    EXPECT_NEAR(AtSliver(0, 140, 0.005f, "-fast", 24), higher, 2) << "only near the plane of the piece";
}

TEST_F(BounceTest, SameBytesForAnyNumberOfThreads) {
    const Bsp pillar = CompiledMapOf("pillar");
    const Bsp one = Lit(pillar, "-bounce 2 -bouncegrid -dirty", 1),
              three = Lit(pillar, "-bounce 2 -bouncegrid -dirty", 3);
    EXPECT_EQ(one.lightmaps, three.lightmaps);
    EXPECT_EQ(
        std::memcmp(one.gridPoints.data(), three.gridPoints.data(), one.gridPoints.size() * sizeof(bspGridPoint_t)), 0);
}

} // namespace

} // namespace q3::test
