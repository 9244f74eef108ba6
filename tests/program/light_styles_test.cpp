// GPL-2.0-or-later. Files with four light styles: the light in a slot is that of its lamp alone.
#include "tests/program/lit_room.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <type_traits>

namespace q3::test {

namespace {

using testing::HasSubstr;

constexpr Vec3f kWhite{1, 1, 1};

class LightStylesTest : public LitRoomTest {
  protected:
    LightStylesTest() {
        std::filesystem::copy(folder_ / "base/baseq3/scripts", folder_ / "base/baseq3/shaders",
                              std::filesystem::copy_options::recursive);
    }

    /// A lamp with a targetname, which the game can switch.
    static std::string Switched(std::string_view name, const Vec3f &at, const Vec3f &color = kWhite) {
        return Lamp(at, 150, color, {{"targetname", std::string(name)}});
    }

    /// The room with these entities, compiled and lit for Jedi Academy. Sets text_.
    Bsp Lit(const std::string &entities, std::string_view lightOptions = {}) {
        Compile(entities, {}, brushes_);
        for (const std::string_view stage : {"-meta", "-vis"})
            EXPECT_EQ(RunStage(stage, {}, stage == "-meta" ? "room.map" : "room.bsp").status, 0);
        const Outcome outcome = RunStage("-light", lightOptions, "room.bsp");
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        text_ = outcome.text;
        return Load();
    }
    Outcome RunStage(std::string_view stage, std::string_view options, std::string_view file) {
        std::vector<std::string> arguments{"-game",        "ja",     "-fs_basepath",    (folder_ / "base").string(),
                                           "-fs_basegame", "baseq3", std::string(stage)};
        std::istringstream words{std::string(options)};
        for (std::string word; words >> word;)
            arguments.push_back(word);
        arguments.push_back((maps_ / file).string());
        return RunProgramFile(arguments, folder_.Root());
    }

    static std::size_t SlotOf(const Styles &styles, int style) {
        return std::size_t(std::ranges::find(styles, style) - styles.begin());
    }

    /// Texels of the floor that a style has, at FloorPoints; empty: it has none there.
    std::vector<std::array<int, 3>> Floor(const Bsp &bsp, int style) const {
        const LitFace face = FaceOf(bsp, "textures/test/floor", kUpward);
        const bspDrawSurface_t &surface = bsp.drawSurfaces[std::size_t(face.surface)];
        const std::size_t slot = SlotOf(surface.lightmapStyles, style);
        if (slot == kStyles)
            return {};
        const bspDrawVert_t &vert = bsp.drawVerts[std::size_t(surface.firstVert)];
        std::vector<std::array<int, 3>> texels;
        for (const Vec3f &p : FloorPoints()) {
            std::array<float, 2> at = face.At(p);
            for (std::size_t axis = 0; axis < 2; ++axis)
                at[axis] += (vert.lightmap[slot][axis] - vert.lightmap[0][axis]) * kPageSide;
            const auto texel = std::size_t(surface.lightmapNum[slot]) * kPageTexels + std::size_t(at[1]) * kPageSide +
                               std::size_t(at[0]);
            texels.push_back({bsp.lightmaps[3 * texel], bsp.lightmaps[3 * texel + 1], bsp.lightmaps[3 * texel + 2]});
        }
        return texels;
    }

    static void ExpectAlike(const std::vector<std::array<int, 3>> &a, const std::vector<std::array<int, 3>> &b) {
        ASSERT_EQ(a.size(), b.size());
        ASSERT_FALSE(a.empty());
        for (std::size_t i = 0; i < a.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(a[i][c], b[i][c], 1) << i;
    }

    /// Mean light of a style at grid points over all normals: ambient + directed / 4. 0 where the point has no
    /// such light, negative where a byte is full, which cuts light off.
    static std::vector<double> Grid(const Bsp &bsp, int style) {
        std::vector<double> light;
        for (const bspGridPoint_t &point : bsp.gridPoints) {
            const std::size_t slot = SlotOf(point.styles, style);
            const bool isFull = slot < kStyles && std::ranges::max(point.directed[slot]) == UINT8_MAX;
            for (std::size_t c = 0; c < 3; ++c)
                light.push_back(isFull           ? -1
                                : slot < kStyles ? point.ambient[slot][c] + point.directed[slot][c] / 4.0
                                                 : 0);
        }
        return light;
    }

    /// Fractions of both bytes are cut off, and ambient light of 0 is stored as 1 in style 0.
    static void ExpectAlike(const std::vector<double> &a, const std::vector<double> &b) {
        ASSERT_EQ(a.size(), b.size());
        double compared = 0, sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            if (a[i] < 0 || b[i] < 0)
                continue;
            ++compared;
            sum += std::abs(a[i] - b[i]);
            EXPECT_LT(std::abs(a[i] - b[i]), 2.3) << i << ": " << a[i] << ' ' << b[i];
        }
        EXPECT_GT(compared, double(a.size()) / 4);
        EXPECT_LT(sum / compared, 1);
    }

    std::string text_, brushes_;
    const std::string steady_ = Lamp({0, 0, 200}, 100);
    const std::vector<std::string> lamps_{Switched("red", {100, 0, 100}, {1, 0.2f, 0}),
                                          Switched("green", {-100, 60, 80}, {0, 1, 0.1f}),
                                          Switched("blue", {-60, -150, 40}, {0.1f, 0.3f, 1})};
};

TEST_F(LightStylesTest, TheLightInASlotIsThatOfItsLampAlone) {
    const Bsp all = Lit(steady_ + lamps_[0] + lamps_[1] + lamps_[2]);
    EXPECT_EQ(all.ident, kRbspIdent);
    for (std::size_t lamp = 0; lamp <= lamps_.size(); ++lamp) {
        const bool isSteady = lamp == lamps_.size();
        const int style = isSteady ? 0 : 32 + int(lamp);
        const Bsp alone = Lit(isSteady ? steady_ : lamps_[lamp]);
        const int aloneStyle = isSteady ? 0 : 32;
        ExpectAlike(Floor(all, style), Floor(alone, aloneStyle));
        ExpectAlike(Grid(all, style), Grid(alone, aloneStyle));
        for (std::size_t i = 0; i < all.drawSurfaces.size(); ++i) {
            const bspDrawSurface_t &a = all.drawSurfaces[i], &b = alone.drawSurfaces[i];
            EXPECT_EQ(a.vertexStyles, a.lightmapStyles);
            const std::size_t slot = SlotOf(a.vertexStyles, style), aloneSlot = SlotOf(b.vertexStyles, aloneStyle);
            ASSERT_LT(slot, kStyles);
            ASSERT_LT(aloneSlot, kStyles);
            for (int v = 0; v < a.numVerts; ++v)
                for (std::size_t c = 0; c < 3; ++c)
                    EXPECT_NEAR(all.drawVerts[std::size_t(a.firstVert + v)].color[slot][c],
                                alone.drawVerts[std::size_t(b.firstVert + v)].color[aloneSlot][c], 1);
        }
    }
}

TEST_F(LightStylesTest, BouncesHaveStylesToo) {
    constexpr std::string_view kBounces = "-bounce 2 -bouncegrid";
    const Bsp all = Lit(steady_ + lamps_[0] + lamps_[1], kBounces), alone = Lit(lamps_[1], kBounces),
              direct = Lit(lamps_[1]);
    const auto sum = [](const auto &values) {
        double total = 0;
        for (const auto &value : values)
            if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>)
                total += value;
            else
                total += value[0] + value[1] + value[2];
        return total;
    };
    EXPECT_NEAR(sum(Floor(all, 33)), sum(Floor(alone, 32)), 0.01 * sum(Floor(alone, 32)));
    EXPECT_NEAR(sum(Grid(all, 33)), sum(Grid(alone, 32)), 0.02 * sum(Grid(alone, 32)));
    EXPECT_GT(sum(Grid(alone, 32)), 1.1 * sum(Grid(direct, 32)));
}

TEST_F(LightStylesTest, LampsWithoutASlotShineInNoOther) {
    std::string five = steady_;
    for (int i = 0; i < 5; ++i) // the last ones give less
        five += Lamp({-120.0f + 50 * float(i), 40, 90}, 160 - 25 * float(i), kWhite,
                     {{"targetname", "lamp" + std::to_string(i)}});
    const Bsp bsp = Lit(five);
    EXPECT_THAT(text_, HasSubstr("light left out where 3 other styles come first: light \"lamp4\""));
    EXPECT_THAT(text_, HasSubstr("(grid points: "));
    const Bsp steady = Lit(steady_);
    ExpectAlike(Floor(bsp, 0), Floor(steady, 0));
    ExpectAlike(Grid(bsp, 0), Grid(steady, 0));
    EXPECT_TRUE(Floor(bsp, 36).empty());
    EXPECT_FALSE(Floor(bsp, 32).empty());
}

TEST_F(LightStylesTest, ImagesOfPagesHoldAllStyles) {
    const Bsp bsp = Lit(steady_ + lamps_[0] + lamps_[1], "-external");
    EXPECT_TRUE(bsp.lightmaps.empty());
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
        EXPECT_EQ(surface.lightmapStyles, (Styles{0, 32, 33, kNoStyle}));
        for (std::size_t slot = 0; slot < 3; ++slot)
            EXPECT_TRUE(std::filesystem::exists(Beside(fmt::format("lm_{:04}.tga", surface.lightmapNum[slot]))));
        EXPECT_EQ(surface.lightmapNum[3], kLightmapByVertex);
    }
}

TEST_F(LightStylesTest, PointsInWallsHaveNoStyle) {
    brushes_ = BoxText({-160, -160, 0}, {160, 160, 176}, "test/pillar"); // around points far from its sides
    const Bsp bsp = Lit(Lamp({0, 0, 220}, 300) + lamps_[0]);
    std::size_t inWalls = 0, filled = 0;
    for (const bspGridPoint_t &point : bsp.gridPoints) {
        inWalls += point.styles == kNoStyles;
        filled += point.styles == kNoStyles && point.ambient[0][0] + point.directed[0][0] > 0;
        EXPECT_TRUE(point.styles == kNoStyles || point.styles[0] == 0);
    }
    EXPECT_GT(inWalls, 0u);
    EXPECT_GT(filled, 0u) << "for engines that do not look at styles";
    EXPECT_LT(inWalls, bsp.gridPoints.size());
}

TEST_F(LightStylesTest, AMapOfAnotherFormatIsRefused) {
    Compile(steady_);
    const Outcome outcome = RunStage("-light", "", "room.bsp");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.text, HasSubstr("a map of the format IBSP, but those of -game ja are RBSP: give -game with one "
                                        "of quake3"));
}

} // namespace

} // namespace q3::test
