// GPL-2.0-or-later. Light styles through the whole light stage: direct and bounced light of several styles add up to
// what the same lights give in one style.
#include "q3map2/lightmap/light_stage.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "tests/support/compiled_map.h"
#include "tests/support/light_fixture.h"

#include <array>
#include <set>

namespace q3::test {

namespace {

/// Light of luxels of all raw lightmaps and of vertices, summed over styles.
struct Summed {
    std::vector<Vec3f> luxels, vertices;
    std::vector<int> luxelStyles; ///< by luxel: number of styles that its lightmap holds
    std::set<int> styles;
};

class StylesBakeTest : public testing::Test {
  protected:
    /// A room with a pillar and a lamp of each of these styles.
    static SceneBuilder WithLamps(const std::vector<int> &styles, int intensity) {
        SceneBuilder scene = Room();
        scene.AddBox({-20, -20, 4}, {20, 20, 120}, TestShader("textures/test/pillar"));
        for (std::size_t i = 0; i < styles.size(); ++i)
            scene.AddEntity(
                MakeEntity("light", {{"origin", fmt::format("{} {} 150", -150 + 100 * int(i), 60 - 40 * int(i))},
                                     {"light", fmt::format("{}", intensity)},
                                     {"_color", fmt::format("1 {} {}", 0.2 * double(i), 1 - 0.2 * double(i))},
                                     {"style", fmt::format("{}", styles[i])}}));
        return scene;
    }
    Summed Bake(const SceneBuilder &scene, int bounces, int threads = 1) {
        VirtualFileSystem vfs(quiet.log);
        vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
        const Bsp bsp = CompiledScene(scene, vfs);
        LightOptions light;
        LightmapOptions lightmap;
        lightmap.bounces = bounces;
        ShaderLibrary library(vfs, *FindGame("quake3"), light.shader, quiet.log);
        LightInputs inputs;
        inputs.name = "test";
        const LightSetup setup(bsp, inputs, light, SurfaceDefaultsOf(lightmap), library, quiet.log);
        library.ReleaseImages(bounces > 0 ? KeptImages::OfReflectors : KeptImages::SeeThrough);
        const JobPool jobs(threads);
        SurfacePasses passes(setup, lightmap, jobs, quiet.log);
        passes.Run();
        return Sum(passes.Surfaces());
    }
    static Summed Sum(const SurfaceLight &surfaces) {
        Summed sum;
        for (const RawLightmap &raw : surfaces.lightmaps) {
            std::vector<Vec3f> light(raw.result[0].size());
            for (std::size_t slot = 0; slot < kStyles; ++slot)
                for (std::size_t i = 0; i < raw.result[slot].size(); ++i)
                    light[i] += Max(raw.result[slot][i], Vec3f{});
            sum.luxels.insert(sum.luxels.end(), light.begin(), light.end());
            sum.luxelStyles.resize(sum.luxels.size(), int(std::count_if(raw.styles.begin(), raw.styles.end(),
                                                                        [](int style) { return style != kNoStyle; })));
            for (const std::uint8_t style : raw.styles)
                sum.styles.insert(style);
        }
        sum.vertices.resize(surfaces.vertex.sum[0].size());
        for (const std::vector<Vec3f> &values : surfaces.vertex.sum)
            for (std::size_t v = 0; v < values.size(); ++v)
                sum.vertices[v] += values[v];
        return sum;
    }
    static void ExpectAlike(const std::vector<Vec3f> &got, const std::vector<Vec3f> &wanted, double within) {
        ASSERT_EQ(got.size(), wanted.size());
        double most = 0;
        for (std::size_t i = 0; i < got.size(); ++i)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                EXPECT_NEAR(got[i][channel], wanted[i][channel], within * (1 + double(wanted[i][channel]))) << i;
                most = std::max(most, double(wanted[i][channel]));
            }
        EXPECT_GT(most, 5);
    }

    /// As ExpectAlike for luxels, but a surface may lack styles whose bounced light is under 1/16 byte everywhere on
    /// it.
    static void ExpectAlikeButForFaintStyles(const Summed &got, const Summed &wanted, int styles, double within) {
        ASSERT_EQ(got.luxels.size(), wanted.luxels.size());
        int whole = 0;
        for (std::size_t i = 0; i < got.luxels.size(); ++i) {
            whole += got.luxelStyles[i] == styles ? 1 : 0;
            const double faint = 0.0625 * (styles - got.luxelStyles[i]);
            for (std::size_t channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(got.luxels[i][channel], wanted.luxels[i][channel],
                            within * (1 + double(wanted.luxels[i][channel])) + faint)
                    << i;
        }
        EXPECT_GT(whole, int(got.luxels.size() / 2));
    }

    KeptLog quiet;
};

TEST_F(StylesBakeTest, DirectLightOfAllStylesIsThatOfOne) {
    const Summed styled = Bake(WithLamps({0, 5, 32, 7}, 60), 0), plain = Bake(WithLamps({0, 0, 0, 0}, 60), 0);
    EXPECT_EQ(styled.styles, (std::set<int>{0, 5, 7, 32, 255}));
    EXPECT_EQ(plain.styles, (std::set<int>{0, 255}));
    ExpectAlike(styled.luxels, plain.luxels, 1e-5);
    ExpectAlike(styled.vertices, plain.vertices, 1e-5);
}

/// Under weak lamps no emitter is bright: gather rays, which all styles share, gather all light. Under strong lamps the
/// bright emitters are sampled by style, so the estimates differ by their noise.
TEST_F(StylesBakeTest, BouncedLightOfAllStylesIsThatOfOne) {
    for (const auto &[intensity, within] : std::array<std::pair<int, double>, 2>{{{4, 1e-5}, {60, 0.1}}})
        for (const int bounces : {1, 3}) {
            const Summed styled = Bake(WithLamps({0, 5, 32, 7}, intensity), bounces);
            const SceneBuilder plainRoom = WithLamps({0, 0, 0, 0}, intensity);
            const Summed plain = Bake(plainRoom, bounces), direct = Bake(plainRoom, 0);
            ExpectAlikeButForFaintStyles(styled, plain, 4, within);
            double bounced = 0, all = 0, sum = 0;
            for (std::size_t i = 0; i < plain.luxels.size(); ++i)
                bounced += double(plain.luxels[i].x - direct.luxels[i].x), all += double(plain.luxels[i].x),
                    sum += double(styled.luxels[i].x);
            const double faint = intensity < 10 ? 0.01 : 0; // the light of omitted styles counts in a dim room
            EXPECT_NEAR(sum, all, (2e-3 + faint) * all);
            EXPECT_GT(bounced, 0.2 * all) << "there is something to compare";
        }
}

/// Four lamps have four styles, but beside style 0 a surface has three slots: the weakest style is dropped, and its
/// lamp is named once.
TEST_F(StylesBakeTest, TheWeakestStyleGoesAndItsLightIsNamed) {
    SceneBuilder scene = Room();
    const std::array<std::pair<int, int>, 4> lamps{{{9, 30}, {3, 12}, {6, 40}, {2, 35}}};
    for (const auto &[style, intensity] : lamps)
        scene.AddEntity(MakeEntity("light", {{"origin", "0 0 200"},
                                             {"light", fmt::format("{}", intensity)},
                                             {"targetname", fmt::format("lamp{}", style)},
                                             {"style", fmt::format("{}", style)}}));
    const Summed one = Bake(scene, 0), four = Bake(scene, 0, 4);
    EXPECT_EQ(one.styles, (std::set<int>{0, 2, 6, 9}));
    EXPECT_EQ(one.luxels, four.luxels);
    EXPECT_NE(quiet.text.find(
                  "light left out where 3 other styles come first: light \"lamp3\" at \"0 0 200\" (lightmaps: 6)"),
              std::string::npos)
        << quiet.text;
    EXPECT_EQ(quiet.text.find("lamp2"), std::string::npos);
    EXPECT_EQ(quiet.text.find("lamp9"), std::string::npos);
}

/// Three styles in a room and a fourth behind a wall with a gap, through which only its bounced light passes.
TEST_F(StylesBakeTest, BouncedStylesThatFindNoSlotAreNamedAndFaintOnesTakeNone) {
    const auto behindWall = [](const char *style, const char *light) {
        SceneBuilder scene = Room();
        scene.AddBox({100, -186, 4}, {120, 60, 252}, TestShader("textures/test/pillar"));
        scene.AddEntity(MakeEntity("light", {{"origin", "150 -120 100"}, {"light", light}, {"style", style}}));
        return scene;
    };
    const auto surfacesHold = [](const Summed &light, int styles) {
        return std::count(light.luxelStyles.begin(), light.luxelStyles.end(), styles) > 0;
    };
    const Summed strong = Bake(behindWall("9", "1000"), 2), weak = Bake(behindWall("9", "2"), 2);
    EXPECT_TRUE(surfacesHold(strong, 2) && !surfacesHold(strong, 1));
    EXPECT_TRUE(surfacesHold(weak, 2) && surfacesHold(weak, 1));
    SceneBuilder full = behindWall("9", "1000");
    for (const char *style : {"3", "5", "6"})
        full.AddEntity(MakeEntity("light", {{"origin", "-100 0 150"}, {"light", "100"}, {"style", style}}));
    Bake(full, 2);
    EXPECT_NE(quiet.text.find(", light of style 9 (lightmaps: 3)"), std::string::npos) << quiet.text;
    EXPECT_EQ(quiet.text.find("light of style 3"), std::string::npos);
}

} // namespace

} // namespace q3::test
