// GPL-2.0-or-later. Lights that solids or models hide: what both grids get, and what is said of lights that are lost.
#include "tests/support/light_fixture.h"

namespace q3::test {

namespace {

constexpr char kShaders[] = R"(textures/test/lamp
{
	q3map_surfacelight 600
	q3map_backsplash 0 0
}
textures/test/water
{
	surfaceparm water
	surfaceparm trans
}
)";
constexpr double kLampAdd = 600 * 0.75;

class HiddenLightTest : public LightTest {
  protected:
    void SetUp() override { Script(kShaders); }
    static Entity LightAt(const std::string &origin) {
        return MakeEntity("light", {{"origin", origin}, {"light", "300"}, {"targetname", "lost"}});
    }
    static SceneBuilder WithBox(std::string_view shader, BoxKind kind) {
        SceneBuilder scene = Room();
        scene.AddBox({-32, -32, 96}, {32, 32, 160}, TestShader(shader), kind);
        return scene;
    }
};

TEST_F(HiddenLightTest, BothGridsGetThePartOfALampOnTheirSideOfAWall) {
    for (const BoxKind kind : {BoxKind::Structural, BoxKind::Detail}) {
        SceneBuilder scene = Room();
        scene.AddBox({-20, -186, 4}, {-12, 186, 252}, TestShader("textures/test/wall"), kind);
        scene.AddQuad({{{-200, 90, 8}, {120, 90, 8}, {120, -90, 8}, {-200, -90, 8}}}, TestShader("textures/test/lamp"));
        const Bsp bsp = Lit(scene);
        const GridView grid(bsp);
        ExpectPoints(grid, kExact, 100, [](const Vec3d &p, Coefficients &c) {
            if (!Inside(p, RoomBounds()) || (p.x > -21 && p.x < -11) || p.z < 10)
                return false;
            const double from = p.x < -20 ? -200 : -12, to = p.x < -20 ? -20 : 120;
            c = FromRectangle(p, {from, -90, 8}, {to - from, 0, 0}, {0, 180, 0}, {0, 0, 1}, kLampAdd, {1, 1, 1});
            return true;
        });
        int dark = 0, lit = 0;
        const GridLayout layout = LayoutGrid(bsp.models[0].mins, bsp.models[0].maxs, {64, 64, 128});
        for (std::int64_t i = 0; i < layout.Count(); ++i) {
            const auto at = layout.Coordinates(i);
            const Vec3d p(layout.Position(at[0], at[1], at[2]));
            if (Inside(p, {{-190, -80, 20}, {-30, 80, 240}}))
                ++(bsp.gridPoints[std::size_t(i)].directed[0][0] > 40 ? lit : dark);
        }
        EXPECT_EQ(dark, 0);
        EXPECT_GE(lit, 4);
    }
}

TEST_F(HiddenLightTest, LightInADetailBrushIsNamed) {
    SceneBuilder scene = WithBox("textures/test/wall", BoxKind::Detail);
    scene.AddEntity(LightAt("0 0 128"));
    Lit(scene);
    EXPECT_TRUE(Printed("the light \"lost\" at \"0 0 128\" is inside a detail brush and lights nothing")) << printed;
}

TEST_F(HiddenLightTest, LightInAStructuralBrushIsNamed) {
    SceneBuilder scene = WithBox("textures/test/wall", BoxKind::Structural);
    scene.AddEntity(LightAt("0 0 128"));
    Lit(scene);
    EXPECT_TRUE(Printed("the light \"lost\" at \"0 0 128\" is inside a solid")) << printed;
}

TEST_F(HiddenLightTest, LightInsideAModelIsNamed) {
    SceneBuilder scene = Room();
    // An octahedron, its triangles clockwise seen from outside.
    const Vec3f corners[] = {{40, 0, 128}, {-40, 0, 128}, {0, 40, 128}, {0, -40, 128}, {0, 0, 168}, {0, 0, 88}};
    const std::int32_t triangles[] = {0, 4, 2, 2, 4, 1, 1, 4, 3, 3, 4, 0, 2, 5, 0, 1, 5, 2, 3, 5, 1, 0, 5, 3};
    scene.AddTriangles(corners, triangles, TestShader("textures/test/wall"));
    scene.AddEntity(LightAt("1 2 129"));
    Lit(scene);
    EXPECT_TRUE(Printed("the light \"lost\" at \"1 2 129\" is inside a model or behind curves and lights nothing"))
        << printed;
}

TEST_F(HiddenLightTest, LightsThatShineAreNoMistake) {
    SceneBuilder scene = WithBox("textures/test/water", BoxKind::Detail);
    scene.AddEntity(LightAt("0 0 128"));
    // A quad seen from behind, with the room beyond its edges.
    scene.AddQuad({{{100, -40, 60}, {100, -40, 140}, {100, 40, 140}, {100, 40, 60}}}, TestShader("textures/test/wall"));
    scene.AddEntity(LightAt("110 0 100"));
    scene.AddEntity(LightAt("90 0 100"));
    Lit(scene);
    EXPECT_FALSE(Printed("lights nothing")) << printed;
}

} // namespace

} // namespace q3::test
