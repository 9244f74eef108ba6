// GPL-2.0-or-later. The picture of a grid's errors.
#include "common/error.h"
#include "common/image/image.h"
#include "tests/tools/shbench/bench_fixture.h"
#include "tools/measure/shbench/drawing.h"
#include "tools/measure/shbench/error_top_view.h"

#include <cmath>

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using namespace bench;

using Texel = std::array<std::uint8_t, 4>;

/// A room with a pillar from floor to ceiling and a crate on the floor; three positions, the second errs most.
class ErrorTopViewTest : public BenchTest {
  protected:
    ErrorTopViewTest() {
        SceneBuilder scene = Room();
        scene.AddEntity(PointLight({300, 300, 100}, 300));
        scene.AddBox({-100, -50, -512}, {-20, 50, 512}, {"textures/test/wall"});
        scene.AddBox({100, -200, -512}, {200, -100, -400}, {"textures/test/wall"});
        map_ = Map(scene);
        for (const Vec3f &p : {Vec3f{-400, -400, 0}, Vec3f{200, 100, 0}, Vec3f{400, 400, 300}}) {
            TruthPoint point;
            point.position = p;
            truth_.points.push_back(point);
        }
        errors_ = {{1, 1, 0}, {40, 1, 40}, {20, 1, 20}};
        causes_ = {Cause::Floor, Cause::Wall, Cause::NearLight};
        worst_ = {{1, 0, 40, {}}, {2, 0, 20, {}}};
    }
    ErrorTopView Plan() const {
        return MakeErrorTopView(*map_, {truth_, errors_, causes_, worst_, WorstBy::Reference, "SH grid", "default"},
                                JobPool(2));
    }
    /// Pixel of a PNG, so far beside the place of a position on the map.
    static Texel At(const Image &image, const ErrorTopView &plan, const Vec3f &p, double right = 0, double up = 0) {
        const TopViewFrame frame = FrameOf(plan.area);
        const double x = frame.x + double(p.x - plan.area.mins.x) * frame.scale + right;
        const double y = frame.y + double(plan.area.maxs.y - p.y) * frame.scale - up;
        return image.Texel(int(2 * x), int(2 * y));
    }
    Image Written(const ErrorTopView &plan) {
        WriteErrorTopView(plan, folder / "plan.png");
        const std::string png = folder.ReadBack("plan.png");
        return DecodePng(std::as_bytes(std::span(png)), "plan.png");
    }
    static int Brightness(const Texel &texel) { return texel[0] + texel[1] + texel[2]; }

    std::unique_ptr<BenchMap> map_;
    Truth truth_;
    std::vector<PositionErrors> errors_;
    std::vector<Cause> causes_;
    std::vector<WorstPosition> worst_;
};

TEST_F(ErrorTopViewTest, ShowsTheMapAtTheHeightOfTheWorst) {
    const ErrorTopView plan = Plan();
    EXPECT_EQ(plan.height, 0); // the lower of the two in the middle
    ASSERT_EQ(plan.rings.size(), 2u);
    EXPECT_EQ(plan.rings[0].dot, 1u);
    EXPECT_EQ(plan.rings[0].cause, Cause::Wall);
    EXPECT_EQ(plan.lights.size(), 1u);
    const auto ground = [&](float x, float y) {
        const Vec3f size = plan.area.maxs - plan.area.mins;
        const auto column = std::size_t((x - plan.area.mins.x) / size.x * float(plan.columns));
        const auto row = std::size_t((plan.area.maxs.y - y) / size.y * float(plan.rows));
        return plan.ground[row * std::size_t(plan.columns) + column];
    };
    EXPECT_EQ(ground(0, 0), TopViewGround::Open);
    EXPECT_EQ(ground(-60, 0), TopViewGround::Solid);
    EXPECT_EQ(ground(-60, 45), TopViewGround::Solid);
    EXPECT_EQ(ground(-60, 55), TopViewGround::Open);
    EXPECT_EQ(ground(150, -150), TopViewGround::Open);
    int steps = 0;
    for (float x = 90; x < 110; x += 0.5f)
        steps += ground(x, -150) == TopViewGround::Step;
    EXPECT_GT(steps, 0); // the crate's edge
}

TEST_F(ErrorTopViewTest, RingsTheWorstAndColorsThemByTheirError) {
    const ErrorTopView plan = Plan();
    const Image image = Written(plan);
    EXPECT_EQ(image.width, 2000);
    const Vec3f worst = truth_.points[1].position;
    EXPECT_EQ(plan.fullScaleError, 50); // the scale ends at a round number
    const Vec3f color = ErrorColor(0.8);
    const Texel center = At(image, plan, worst);
    for (std::size_t channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(center[channel], 255 * color[channel], 2);
    EXPECT_LT(Brightness(At(image, plan, worst, 0, 8)), 200);  // ink, above, where no label is
    EXPECT_LT(Brightness(At(image, plan, worst, 0, -8)), 200); // and below
    EXPECT_GT(Brightness(At(image, plan, worst, 0, 14)), 750); // the open floor around
    // A position that is not among the worst has its dot and no ring.
    const Vec3f other = truth_.points[0].position;
    EXPECT_LT(Brightness(At(image, plan, other)), 750);
    EXPECT_GT(Brightness(At(image, plan, other, 0, 8)), 750);
    EXPECT_LT(Brightness(At(image, plan, {-60, 0, 0})), 620); // the pillar
}

TEST_F(ErrorTopViewTest, IsAnSvgByItsName) {
    WriteErrorTopView(Plan(), folder / "plan.svg");
    EXPECT_THAT(folder.ReadBack("plan.svg"), testing::HasSubstr("<svg"));
    EXPECT_THROW(WriteErrorTopView(Plan(), folder / "plan.jpg"), Error);
    EXPECT_THROW(WriteErrorTopView(Plan(), folder / "missing/plan.png"), Error);
}

TEST_F(ErrorTopViewTest, CutsTextBetweenCharacters) {
    const std::string text = "Säule, größer als 20 µm – überall";
    const auto draw = [&](Drawing &drawing) {
        EXPECT_EQ(drawing.Fitting(text, 1000), text);
        for (double width = 0; width < 200; width += 5) {
            const std::string fitting = drawing.Fitting(text, width);
            ASSERT_TRUE(fitting.ends_with("..."));
            const std::size_t kept = fitting.size() - 3;
            EXPECT_EQ(fitting.substr(0, kept), text.substr(0, kept));
            EXPECT_NE(text[kept] & 0xC0, 0x80) << "the next byte begins a character; width " << width;
        }
    };
    WriteDrawing(1000, 100, folder / "text.svg", draw);
}

TEST(ErrorColor, DarkensAllTheWay) {
    float before = 3;
    for (double share = 0; share <= 1; share += 0.125) {
        const Vec3f color = ErrorColor(share);
        EXPECT_LT(color.x + color.y + color.z, before) << share;
        before = color.x + color.y + color.z;
    }
    EXPECT_EQ(ErrorColor(7), ErrorColor(1));
}

} // namespace

} // namespace q3::test
