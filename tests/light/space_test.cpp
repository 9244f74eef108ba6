// GPL-2.0-or-later. Point and box queries: what boxes say holds for the points in them.
#include "tests/light/compiled_map.h"
#include "tests/light/light_test.h"

#include "q3map2/light/light.h"
#include "q3map2/light/light_space.h"

#include <random>

namespace q3::test {

namespace {

/// A room with detail brushes of many sizes, which do not cut the tree into solid leafs.
class SpaceTest : public ::testing::Test {
  protected:
    SpaceTest() : vfs(quiet.log), bsp(Compiled()) {}

    Bsp Compiled() {
        vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
        SceneBuilder scene = Room({-512, -512, -512}, {512, 512, 512});
        std::mt19937 random(23);
        const auto below = [&](int most) { return float(random() % unsigned(most)); };
        for (int i = 0; i < 12; ++i) {
            const Vec3f from{below(800) - 512, below(800) - 512, below(800) - 512};
            scene.AddBox(from, from + Vec3f{64 + below(300), 64 + below(300), 64 + below(300)},
                         TestShader("textures/test/wall"), BoxKind::Detail);
        }
        return CompiledScene(scene, vfs);
    }

    QuietLog quiet;
    VirtualFileSystem vfs;
    Bsp bsp;
};

TEST_F(SpaceTest, BoxesWithoutOpenPlacesHaveNone) {
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size(), true));
    std::mt19937 random(29);
    std::uniform_real_distribution<float> place(-520, 520), size(0, 30), share(-1, 1);
    int inBrushes = 0, open = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3f center{std::round(place(random)), std::round(place(random)), std::round(place(random))};
        const Vec3f half{size(random), size(random), size(random)};
        for (const float epsilon : {-0.125f, 0.0f, 0.125f}) {
            const bool any = space.AnyOpen(center - half, center + half, epsilon);
            open += any ? 1 : 0;
            inBrushes += !any && !space.Whole().InSolidLeaf(center) ? 1 : 0;
            for (int k = 0; k < 30 && !any; ++k) {
                // Corners and edges of the box too.
                const auto within = [&] { return std::round(share(random) * 3) / 2; };
                const Vec3f at{std::clamp(within(), -1.0f, 1.0f), std::clamp(within(), -1.0f, 1.0f), share(random)};
                ASSERT_LT(space.ClusterAt(center + half * at, epsilon), 0);
            }
        }
    }
    EXPECT_GT(inBrushes, 100);
    EXPECT_GT(open, 100);
}

} // namespace

} // namespace q3::test
