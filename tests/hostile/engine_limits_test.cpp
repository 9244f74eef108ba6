// GPL-2.0-or-later. What engines cannot hold is told, each with its number; what they just can is not.
#include "q3map2/geometry/compile_map.h"
#include "tests/support/game_folder.h"

#include <functional>

#include <gmock/gmock.h>

namespace q3::test {

namespace {

struct Limit {
    const char *name, *what;
    std::size_t most;
    std::function<void(Bsp &, std::size_t)> fill; ///< so many of them
};
std::ostream &operator<<(std::ostream &out, const Limit &limit) {
    return out << limit.name;
}

template <typename List> std::function<void(Bsp &, std::size_t)> Sized(List Bsp::*list) {
    return [list](Bsp &bsp, std::size_t count) { (bsp.*list).resize(count); };
}

std::vector<Limit> Limits() {
    return {{"Models", "models", 256, Sized(&Bsp::models)},
            {"Shaders", "shaders", 1024, Sized(&Bsp::shaders)},
            {"Entities", "entities", 2048,
             [](Bsp &bsp, std::size_t count) {
                 bsp.entities = FormatEntities(std::vector<Entity>(count, Entity{{{"classname", "{"}}}));
             }},
            {"EntityText", "bytes of entity text", 262144, Sized(&Bsp::entities)},
            {"Brushes", "brushes", 32768, Sized(&Bsp::brushes)},
            {"BrushSides", "brush sides", 131072, Sized(&Bsp::brushSides)},
            {"Planes", "planes", 131072, Sized(&Bsp::planes)},
            {"Nodes", "nodes", 131072, Sized(&Bsp::nodes)},
            {"Leafs", "leafs", 131072, Sized(&Bsp::leafs)},
            {"LeafSurfaces", "leaf surfaces", 131072, Sized(&Bsp::leafSurfaces)},
            {"LeafBrushes", "leaf brushes", 262144, Sized(&Bsp::leafBrushes)},
            {"Surfaces", "surfaces", 131072, Sized(&Bsp::drawSurfaces)},
            {"Vertices", "draw vertices", 524288, Sized(&Bsp::drawVerts)},
            {"Indexes", "draw indexes", 524288, Sized(&Bsp::drawIndexes)},
            {"Areas", "areas", 256,
             [](Bsp &bsp, std::size_t count) {
                 bsp.leafs.resize(2);
                 bsp.leafs[1].area = int(count) - 1;
             }},
            {"Fogs", "fogs", 31, Sized(&Bsp::fogs)}};
}

class LimitTest : public testing::TestWithParam<Limit> {
  protected:
    std::string WarningsOf(std::size_t count) {
        KeptLog out;
        Bsp bsp;
        GetParam().fill(bsp, count);
        WarnOfLimits(bsp, *FindGame("quake3"), out.log);
        return out.text;
    }
};

TEST_P(LimitTest, IsToldWithTheNumber) {
    const Limit &limit = GetParam();
    EXPECT_EQ(WarningsOf(limit.most), "");
    const std::string said = WarningsOf(limit.most + 1);
    EXPECT_THAT(said,
                testing::HasSubstr(fmt::format("{} {}, engines hold {}: ", limit.most + 1, limit.what, limit.most)));
    EXPECT_EQ(std::ranges::count(said, '\n'), 1);
}

TEST(LimitsOfGames, RavensGamesHaveOneFogLess) {
    KeptLog out;
    Bsp bsp;
    bsp.fogs.resize(31);
    WarnOfLimits(bsp, *FindGame("ja"), out.log);
    EXPECT_THAT(out.text, testing::HasSubstr("31 fogs, engines hold 30"));
}

INSTANTIATE_TEST_SUITE_P(Engines, LimitTest, testing::ValuesIn(Limits()),
                         [](const auto &limit) { return std::string(limit.param.name); });

} // namespace

} // namespace q3::test
