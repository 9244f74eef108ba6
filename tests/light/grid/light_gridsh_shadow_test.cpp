// GPL-2.0-or-later. SH grid: shadows of random boxes against slow slab tests, and the same bytes from every thread
// count.
#include "tests/support/light_fixture.h"

#include <cstdlib>
#include <cstring>
#include <random>

namespace q3::test {

namespace {

struct BoxScene {
    SceneBuilder scene = Room({-300, -300, 0}, {300, 300, 300});
    std::vector<Boundsf> boxes;

    explicit BoxScene(unsigned seed) {
        std::mt19937 random(seed);
        const auto within = [&](int low, int high) { return float(low + int(random() % unsigned(high - low))); };
        for (int i = 0; i < 14; i++) {
            const Vec3f at{within(-290, 230), within(-290, 230), within(1, 240)};
            const Vec3f size{within(2, 90), within(2, 90), within(2, 90)};
            boxes.push_back({at, Min(at + size, Vec3f{299, 299, 299})});
            scene.AddBox(boxes.back().mins, boxes.back().maxs, TestShader("textures/test/wall"),
                         i % 2 ? BoxKind::Detail : BoxKind::Structural);
        }
    }
    bool InBox(const Vec3d &p, double margin) const {
        for (const Boundsf &box : boxes)
            if (Inside(p, box, -margin))
                return true;
        return false;
    }
    bool Blocked(const Vec3d &a, const Vec3d &b, double margin) const {
        for (const Boundsf &box : boxes)
            if (SegmentMeets(a, b, box, margin))
                return true;
        return false;
    }
};

class VisibilityTest : public LightTest, public testing::WithParamInterface<unsigned> {};

TEST_P(VisibilityTest, ShadowsAreThoseOfTheBoxes) {
    BoxScene made(GetParam());
    std::mt19937 random(GetParam() + 100);
    std::vector<Vec3d> lights;
    while (lights.size() < 3) {
        const Vec3d at{double(random() % 580) - 290, double(random() % 580) - 290, double(random() % 280) + 10};
        if (made.InBox(at, 2))
            continue;
        lights.push_back(at);
        made.scene.AddEntity(
            MakeEntity("light", {{"origin", fmt::format("{} {} {}", at.x, at.y, at.z)}, {"light", "200"}}));
    }
    int shadowed = 0, lit = 0;
    ExpectPoints(LitGrid(made.scene, "-gridsh 24 24 24"), kExact, 3000, [&](const Vec3d &p, Coefficients &c) {
        if (!Inside(p, {{-300, -300, 0}, {300, 300, 300}}) || made.InBox(p, 1))
            return false;
        for (const Vec3d &light : lights) {
            const bool blocked = made.Blocked(p, light, -0.5);
            if (blocked != made.Blocked(p, light, 0.5))
                return false;
            (blocked ? shadowed : lit)++;
            if (!blocked)
                c = c + FromPoint(p, light, 200);
        }
        return true;
    });
    EXPECT_GT(shadowed, 500);
    EXPECT_GT(lit, 500);
}

INSTANTIATE_TEST_SUITE_P(Seeds, VisibilityTest, testing::Range(1u, 7u));

using ThreadsTest = LightTest;

std::vector<std::byte> BytesOf(const Bsp &bsp) {
    return WriteBsp(bsp, {});
}

/// Boxes, lamps, a sun and many dim lights.
SceneBuilder SceneOfAllLights() {
    BoxScene made(11);
    const auto add = [&](std::string_view shader, const std::array<Vec3f, 4> &corners) {
        made.scene.AddQuad(corners, TestShader(shader));
    };
    add("textures/vec/lite", {{{-100, -100, 295}, {100, -100, 295}, {100, 100, 295}, {-100, 100, 295}}});
    add("textures/vec/lite_two", {{{-250, -40, 60}, {-250, -40, 140}, {-250, 40, 140}, {-250, 40, 60}}});
    made.scene.SetWallShader(BoxFace::PlusX, TestShader("textures/vec/sky_sun"));
    std::mt19937 random(5);
    for (int i = 0; i < 60; i++)
        made.scene.AddEntity(
            MakeEntity("light", {{"origin", fmt::format("{} {} {}", int(random() % 580) - 290,
                                                        int(random() % 580) - 290, random() % 280 + 10)},
                                 {"light", "20"},
                                 {"_samples", "2"},
                                 {"_deviance", "10"}}));
    return made.scene;
}

TEST_F(ThreadsTest, EveryThreadCountGivesTheSameBytes) {
    const SceneBuilder scene = SceneOfAllLights();
    const std::string options = "-gridsh 40 40 40 -floodlight";
    const Bsp one = Lit(scene, options, 1);
    EXPECT_GT(result.gridSH.counts.refined, 100u) << "the scene has penumbras";
    EXPECT_EQ(BytesOf(one), BytesOf(Lit(scene, options, 2)));
    EXPECT_EQ(BytesOf(one), BytesOf(Lit(scene, options, 7)));
}

#ifdef __x86_64__

/// What Embree may use of the processor; the usual again at the end.
class EmbreeFor {
  public:
    explicit EmbreeFor(const std::string &processor) { setenv("Q3MAP2_EMBREE", ("isa=" + processor).c_str(), 1); }
    ~EmbreeFor() { unsetenv("Q3MAP2_EMBREE"); }
};

/// On processors without vectors of 16 floats Embree takes packets apart, and looks at rays that are not live.
class ProcessorTest : public LightTest, public testing::WithParamInterface<std::string> {};

TEST_P(ProcessorTest, EveryProcessorGivesTheSameLight) {
    const SceneBuilder scene = SceneOfAllLights();
    const std::string options = "-gridsh 80 80 80 -floodlight -samplesize 32 -samples 2 -dirty -bounce 1 -bouncegrid";
    surfaces = true;
    const Bsp usual = Lit(scene, options);
    const EmbreeFor other(GetParam());
    const Bsp bsp = Lit(scene, options);
    const GridView grid(bsp), usualGrid(usual);
    ASSERT_EQ(grid.Count(), usualGrid.Count());
    double off = 0;
    for (std::size_t i = 0; i < grid.Count(); ++i)
        off += Difference(grid.At(i), usualGrid.At(i)) * 255 / double(grid.Count());
    EXPECT_LT(off, 0.01) << "bytes, mean; a ray may meet or miss an edge";
    ASSERT_EQ(bsp.lightmaps.size(), usual.lightmaps.size());
    ASSERT_GT(bsp.lightmaps.size(), 0u);
    double lightmapOff = 0;
    for (std::size_t i = 0; i < bsp.lightmaps.size(); ++i)
        lightmapOff += std::abs(int(bsp.lightmaps[i]) - int(usual.lightmaps[i])) / double(bsp.lightmaps.size());
    EXPECT_LT(lightmapOff, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Processors, ProcessorTest, testing::Values("sse4.2", "avx", "avx2"),
                         [](const auto &one) { return one.param == "sse4.2" ? "sse42" : one.param; });

#endif

} // namespace

} // namespace q3::test
