// GPL-2.0-or-later. SH grid: -sherror says how far it is off, and which cells halve that.
#include "libs/sh/sh.h"
#include "q3map2/light/grid/gridsh_error.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/light/sources/light_sources.h"

#include "tests/support/light_fixture.h"

#include <cmath>
#include <iterator>
#include <sstream>

namespace q3::test {

namespace {

class GridSHErrorTest : public LightTest {
  protected:
    /// Measures the grid of a map that is lit already.
    GridSHError Measure(const Bsp &bsp, std::string_view options = "-sh", int threads = 1,
                        const IndirectLight *indirect = nullptr) {
        Log log(Log::Nowhere());
        std::istringstream text{std::string(options)};
        Arguments arguments({std::istream_iterator<std::string>(text), {}});
        const Game &game = *FindGame("quake3");
        const LightOptions parsed = ParseLightOptions(arguments, game, log);
        VirtualFileSystem vfs(log);
        vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
        ShaderLibrary library(vfs, game, parsed.shader, log);
        const std::vector<Entity> entities = ParseEntities(bsp.entities, "test");
        const WorldLight world = ReadWorldLight(entities.front(), parsed);
        SurfaceTable table = MakeSurfaceTable(bsp, entities, "", "test.srf", library, log);
        const BspSpace space(bsp, OpaqueBrushes(bsp, library));
        const std::vector<Light> created = CreateLights(space, entities, table, parsed, world, library, log);
        const LightScene scene(bsp, table, parsed, 64);
        int culled = 0;
        const std::vector<Light> lights =
            SetupEnvelopes(created, LightPass::GridSH, parsed, space, SkySeenFrom(space, table), culled);
        const JobPool jobs(threads);
        return MeasureGridSH({space, scene, parsed, world, jobs, log, indirect}, *bsp.gridSH, lights);
    }
};

SceneBuilder Ambient(std::string_view light) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", light);
    return scene;
}

/// Adds that much to coefficient k of all points, in 255ths.
void Corrupt(Bsp &bsp, std::size_t k, double amount) {
    for (bspGridPointSH_t &point : bsp.gridSH->points)
        for (float &c : point.coeffs[k])
            c += float(amount / 255);
}

TEST_F(GridSHErrorTest, UniformLightHasNone) {
    for (const std::string_view options : {"-sh", "-sh -shradiance", "-sh -gridscale 2", "-sh -shdering"}) {
        const GridSHError error = Measure(Lit(Ambient("60"), options), options);
        EXPECT_EQ(error.receivers, 2000u) << options;
        EXPECT_LT(error.rms, 1e-3) << options;
        EXPECT_LT(error.percentile95, 1e-3) << options;
        EXPECT_LT(error.doubled, 1e-3) << options;
        EXPECT_EQ(error.leak, 0) << options;
    }
}

TEST_F(GridSHErrorTest, ExactLightHasAllKindsOfLight) {
    // So fine a grid is nearly exact. Minimum light and floodlight count in both too.
    SceneBuilder scene = Room({-100, -100, 4}, {100, 100, 204});
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/vec/lite"));
    scene.SetWorldKey("_ambient", "5");
    scene.SetWorldKey("_mingridlight", "20");
    scene.AddEntity(MakeEntity("light", {{"origin", "96 96 200"}, {"light", "20"}, {"_color", "1 0.5 0.2"}}));
    // Light that the lamps throw back would end at a plane in mid-air.
    for (const std::string_view options :
         {"-sh -gridsh 8 8 8 -backsplash 0 0", "-sh -shradiance -gridsh 8 8 8 -backsplash 0 0 -floodlight"}) {
        const GridSHError error = Measure(Lit(scene, options), options);
        EXPECT_GT(error.rms, 0) << options;
        EXPECT_LT(error.rms, 1.5) << options;
        EXPECT_EQ(error.leak, 0) << options;
    }
}

/// The same light from above everywhere.
class LightFromAbove : public IndirectLight {
  public:
    explicit LightFromAbove(float light) : light_(light) {}
    int RaysPerPoint() const override { return 1; }
    void Gather(const Vec3f &, std::uint64_t, std::vector<IndirectRay> &rays) const override {
        rays = {{{0, 0, 1}, {light_, light_, light_}}};
    }

  private:
    float light_;
};

TEST_F(GridSHErrorTest, ExactLightHasBouncedLight) {
    constexpr float kBounced = 40;
    Bsp bsp = Lit(Ambient("60"), "-sh");
    const SHVector basis = SHBasis(Vec3d{0, 0, 1});
    for (std::size_t k = 0; k < 9; ++k)
        Corrupt(bsp, k, double(kBounced) * kCosineLobe[k] * basis[k]);
    const LightFromAbove bounced(kBounced);
    EXPECT_LT(Measure(bsp, "-sh", 1, &bounced).rms, 1e-3);
    EXPECT_GT(Measure(bsp).rms, 5);
}

TEST_F(GridSHErrorTest, KnownDamageIsReported) {
    Bsp bsp = Lit(Ambient("100"), "-sh");
    Corrupt(bsp, 0, 5 / kSHC0);
    GridSHError error = Measure(bsp);
    EXPECT_NEAR(error.rms, 5, 1e-3);
    EXPECT_NEAR(error.percentile95, 5, 1e-3);
    EXPECT_NEAR(error.doubled, 5, 1e-3);

    bsp = Lit(Ambient("100"), "-sh");
    Corrupt(bsp, 2, 20 / kSHC1);
    // 20 n.z: a third of the squares of the 26 directions is along z.
    error = Measure(bsp);
    EXPECT_NEAR(error.rms, 20 / std::sqrt(3), 1e-3);
    EXPECT_NEAR(error.percentile95, 20, 1e-3);
}

TEST_F(GridSHErrorTest, WhatNoScreenShowsDoesNotCount) {
    Bsp bsp = Lit(Ambient("300"), "-sh");
    Corrupt(bsp, 0, 40 / kSHC0);
    EXPECT_EQ(Measure(bsp).rms, 0);
    Corrupt(bsp, 0, -95 / kSHC0); // 245 instead of 300, which shows as 255
    EXPECT_NEAR(Measure(bsp).rms, 10, 1e-3);
}

TEST_F(GridSHErrorTest, LightInADarkRoomIsALeak) {
    SceneBuilder scene = Room();
    scene.AddBox({0, -186, 4}, {16, 186, 252}, TestShader("textures/test/wall"));
    scene.AddEntity(MakeEntity("light", {{"origin", "-120 0 230"}, {"light", "100"}}));
    Bsp bsp = Lit(scene, "-sh");
    EXPECT_LT(Measure(bsp).leak, 0.02);
    Corrupt(bsp, 0, 60);
    // Receivers 16 units clear of walls: from -234 to -16 and from 32 to 234.
    EXPECT_NEAR(Measure(bsp).leak, 202.0 / 420, 0.07);
}

TEST_F(GridSHErrorTest, SuggestedCellsHalveIt) {
    // Two lights by their formula at all points, so that nothing but blending between points is off.
    const Vec3d white{0, 0, 380}, blue{-240, 240, 60};
    SceneBuilder scene = Room({-250, -250, 4}, {250, 250, 400});
    scene.AddEntity(MakeEntity("light", {{"origin", "0 0 380"}, {"light", "300"}}));
    scene.AddEntity(MakeEntity("light", {{"origin", "-240 240 60"}, {"light", "40"}, {"_color", "0.2 0.5 1"}}));
    Bsp bsp = scene.Build();
    const auto measure = [&](const Float3 &cell) {
        const GridLayout layout = LayoutGrid({-400, -400, -160}, {400, 400, 560}, cell);
        bsp.gridSH = LightGridSH{{layout.mins, layout.size, layout.bounds, std::int32_t(layout.Count())}, {}};
        for (int z = 0; z < layout.bounds[2]; z++)
            for (int y = 0; y < layout.bounds[1]; y++)
                for (int x = 0; x < layout.bounds[0]; x++) {
                    const Vec3d p(layout.Position(x, y, z));
                    const Coefficients c = FromPoint(p, white, 300) + FromPoint(p, blue, 40, {0.2, 0.5, 1});
                    bspGridPointSH_t &point = bsp.gridSH->points.emplace_back();
                    for (std::size_t k = 0; k < 9; k++)
                        point.coeffs[k] = {float(c[k].x), float(c[k].y), float(c[k].z)};
                }
        return Measure(bsp);
    };
    for (const float cell : {24.0f, 32.0f, 48.0f}) {
        const GridSHError error = measure({cell, cell, cell});
        const Float3 finer = CellOfHalfError({cell, cell, cell}, error);
        EXPECT_GT(error.percentile95, 0.1);
        EXPECT_NEAR(measure(finer).percentile95 / error.percentile95, 0.5, 0.1) << cell << " -> " << finer[0];
    }
}

TEST_F(GridSHErrorTest, CellsNeverGetTooSmall) {
    GridSHError error;
    error.order = 0.5;
    EXPECT_EQ(CellOfHalfError({64, 40, 8}, error), (Float3{16, 10, 8}));
    error.order = 1;
    EXPECT_EQ(CellOfHalfError({64, 40, 8}, error), (Float3{32, 20, 8}));
    error.order = 2;
    EXPECT_EQ(CellOfHalfError({64, 40, 11}, error), (Float3{45, 28, 8}));
}

TEST_F(GridSHErrorTest, AnyNumberOfThreadsSaysTheSame) {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/vec/lite"));
    scene.AddBox({-60, -50, 60}, {70, 80, 76}, TestShader("textures/test/wall"), BoxKind::Detail);
    const Bsp bsp = Lit(scene, "-sh");
    const GridSHError one = Measure(bsp), three = Measure(bsp, "-sh", 3);
    EXPECT_GT(one.rms, 0);
    EXPECT_EQ(one.rms, three.rms);
    EXPECT_EQ(one.percentile95, three.percentile95);
    EXPECT_EQ(one.doubled, three.doubled);
    EXPECT_EQ(one.leak, three.leak);
}

TEST_F(GridSHErrorTest, IsPrintedOnRequest) {
    SceneBuilder scene = Room();
    scene.AddEntity(MakeEntity("light", {{"origin", "40 -24 150"}, {"light", "300"}}));
    Lit(scene, "-sh");
    EXPECT_FALSE(Printed("CheckGridSH"));
    Lit(scene, "-sh -sherror");
    EXPECT_TRUE(Printed("--- CheckGridSH ---"));
    EXPECT_TRUE(Printed("2000 receivers that a player can be in"));
    EXPECT_TRUE(Printed("would halve the 95th percentile"));
    Lit(scene, "-sh -sherror -gridsh 8 8 8");
    EXPECT_TRUE(Printed("Smaller cells are not possible"));
    Lit(Ambient("60"), "-sh -sherror");
    EXPECT_TRUE(Printed("This error is hardly visible"));
}

TEST_F(GridSHErrorTest, NothingIsSaidWhereNobodyFits) {
    SceneBuilder scene = Room({-100, -100, 4}, {100, 100, 34});
    scene.AddEntity(MakeEntity("light", {{"origin", "0 0 20"}, {"light", "100"}}));
    Lit(scene, "-sh -sherror");
    EXPECT_TRUE(Printed("nothing to check"));
}

} // namespace

} // namespace q3::test
