// GPL-2.0-or-later. Images of -lightmass, decoded as an engine would.
#include "libs/directional/directional.h"
#include "tests/program/lit_room.h"

#include <cmath>

namespace q3::test {

namespace {

float LuminanceOf(const Vec3f &c) {
    return 0.3f * c.x + 0.59f * c.y + 0.11f * c.z;
}

/// The luxels of a lightmap of lightmass.json.
struct MassPlace {
    int page, x, y, width, height;
    Vec3f normal;
    directional_range high, low;
};

class LightmassFilesTest : public LitRoomTest {
  protected:
    std::vector<MassPlace> Places() const {
        const Bsp bsp = Load();
        std::vector<MassPlace> places;
        const auto json = Lightmass();
        for (const auto &from : json.at("lightmaps")) {
            MassPlace place{from["page"], from["x"], from["y"], from["width"], from["height"], {}, {}, {}};
            const auto &surface = bsp.drawSurfaces.at(from["surfaces"].at(0));
            const auto &n = bsp.drawVerts[std::size_t(surface.firstVert)].normal;
            place.normal = {n[0], n[1], n[2]};
            for (std::size_t image = 0; image < 4; ++image)
                for (std::size_t c = 0; c < 4; ++c) {
                    directional_range &range = image < 2 ? place.high : place.low;
                    range.multiply[image % 2][c] = from["multiply"][image][c];
                    range.add[image % 2][c] = from["add"][image][c];
                }
            places.push_back(place);
        }
        return places;
    }
    /// The page of the floor and the texel of one of its luxels.
    std::size_t FloorTexel(const LitFace &floor, const Vec3f &p) const {
        const int at = floor.TexelAt(p);
        EXPECT_GE(at, 0);
        return std::size_t(std::max(at, 0));
    }
    LitFace Floor() const { return FaceOf(Load(), "textures/test/floor", kUpward); }
    static constexpr int kDiamondLuxels = 12; ///< at most so many luxels have no free place beside the diamond
    static std::string Diamond() { return DiamondText({100, 100, 0}, 40, 80, "test/pillar"); }
};

using Decode = void(const float[4], const float[4], const directional_range *, const float *, float[3]);

struct DecodedQuality {
    std::vector<std::uint8_t> color, direction;
    const directional_range *range;
    Decode *decode;
    float black, share; ///< error of luminance: share of luminance + black
};

/// Decodes a luxel at its own normal and compares.
void ExpectLuxel(const DecodedQuality &quality, std::size_t at, const Vec3f &normal, const Vec3f &flat) {
    float color[4], direction[4], rgb[3];
    directional_texel(quality.color.data() + 4 * at, color);
    directional_texel(quality.direction.data() + 4 * at, direction);
    const float n[3] = {normal.x, normal.y, normal.z};
    quality.decode(color, direction, quality.range, n, rgb);
    const float luminance = LuminanceOf(flat), within = quality.share * (luminance + quality.black);
    ASSERT_NEAR(LuminanceOf({rgb[0], rgb[1], rgb[2]}), luminance, within + 2e-6f * luminance);
    // Roots are rounded to half a step; the rounding of all of them is made up for in luminance.
    float scaled = 0;
    float steps[3];
    for (std::size_t c = 0; c < 3; ++c) {
        const float step = quality.range->multiply[0][c] / 510, root = std::sqrt(flat[c] / luminance);
        steps[c] = (2 * root * step + step * step) * luminance;
        scaled += (c == 0 ? 0.3f : c == 1 ? 0.59f : 0.11f) * steps[c];
    }
    for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(rgb[c], flat[c], steps[c] + 1.1f * (scaled + within) * flat[c] / luminance + 1e-5f) << c;
}

TEST_F(LightmassFilesTest, OwnNormalsHaveTheFlatLight) {
    Compile(Lamp({-100, 60, 90}, 300, {1, 0.2f, 0.1f}) + Lamp({120, -20, 150}, 900, {0.1f, 0.3f, 1}),
            {{"ambient", "5"}, {"_color", "1 0.8 0.6"}}, BoxText({-8, -96, 0}, {8, 96, 96}, "test/pillar") + Diamond());
    Light("-hdrfiles pfm -lightmass -bounce 1");
    const FloatImage flat = Pfm(0);
    const auto coverage = MassImage(0, "coverage", 1);
    DecodedQuality high{MassImage(0, "hq_color", 4),
                        MassImage(0, "hq_direction", 4),
                        nullptr,
                        directional_lightmass_high,
                        0.01858136f,
                        1.2e-4f};
    DecodedQuality low{MassImage(0, "lq_color", 4),
                       MassImage(0, "lq_direction", 4),
                       nullptr,
                       directional_lightmass_low,
                       0.00390625f,
                       0.023f};
    std::size_t used = 0, compared = 0;
    for (std::size_t at = 0; at < kPageTexels; ++at) {
        ASSERT_EQ(coverage[at], flat.texels[at].x > 0 ? 255 : 0) << at;
        used += coverage[at] == 255;
    }
    for (const MassPlace &place : Places()) {
        high.range = &place.high, low.range = &place.low;
        for (int y = place.y; y < place.y + place.height; ++y)
            for (int x = place.x; x < place.x + place.width; ++x) {
                const auto at = std::size_t(y * kPageSide + x);
                if (coverage[at] == 0)
                    continue;
                ASSERT_NO_FATAL_FAILURE(ExpectLuxel(high, at, place.normal, flat.texels[at])) << x << ' ' << y;
                ASSERT_NO_FATAL_FAILURE(ExpectLuxel(low, at, place.normal, flat.texels[at])) << x << ' ' << y;
                ++compared;
            }
    }
    EXPECT_GT(used, 4000u);
    EXPECT_EQ(compared, used) << "each texel has one lightmap";
}

/// One lamp gives 0.25 + 0.5 w.n of itself in two bands; over the constant term, 0.282095, that is 0.56419 w.
TEST_F(LightmassFilesTest, DirectionsPointToTheLamp) {
    const Vec3f lamp{-100, 60, 120};
    Compile(Lamp(lamp, 300));
    Light("-lightmass");
    const LitFace floor = Floor();
    const int page = floor.page;
    const auto direction = MassImage(page, "hq_direction", 4);
    std::size_t count = 0;
    for (const MassPlace &place : Places())
        for (const Vec3f &p : FloorPoints()) {
            const auto at = FloorTexel(floor, p);
            const int x = int(at) % kPageSide, y = int(at) / kPageSide;
            if (place.page != page || x < place.x || y < place.y || x >= place.x + place.width ||
                y >= place.y + place.height || place.normal.z < 0.9f)
                continue;
            float d[4];
            directional_texel(direction.data() + 4 * at, d);
            for (std::size_t c = 0; c < 3; ++c)
                d[c] = d[c] * place.high.multiply[1][c] + place.high.add[1][c];
            const Vec3f w = Normalize(lamp - (p + kUpward)), got{d[2], d[0], d[1]};
            EXPECT_LT(Length(got - w * 0.56419f), 0.01f) << p.x << ' ' << p.y;
            ++count;
        }
    EXPECT_GT(count, 200u);
}

/// Dirt darkens light by a factor, whose root is stored.
TEST_F(LightmassFilesTest, AmbientOcclusionIsTheRootOfDirt) {
    Compile(Lamp({-100, 60, 90}, 300), {{"ambient", "50"}}, Diamond());
    Light("-hdrfiles pfm -nocollapse");
    const std::vector<Vec3f> clean = Pfm(0).texels;
    Light("-hdrfiles pfm -nocollapse -lightmass -dirty");
    const std::vector<Vec3f> dirty = Pfm(0).texels;
    const auto occlusion = MassImage(0, "ao", 1), coverage = MassImage(0, "coverage", 1);
    std::size_t open = 0, closed = 0;
    int filled = 0;
    for (std::size_t at = 0; at < kPageTexels; ++at) {
        if (coverage[at] == 0)
            continue;
        const double expected = 255 * std::sqrt(double(dirty[at].x) / double(clean[at].x));
        const double error = std::abs(occlusion[at] - expected);
        filled += error > 0.6; // luxels that take light and dirt from their neighbors
        EXPECT_LT(error, 20) << at;
        open += expected > 240, closed += expected < 200;
    }
    EXPECT_LE(filled, kDiamondLuxels);
    EXPECT_GT(open, 500u);
    EXPECT_GT(closed, 150u);
}

TEST_F(LightmassFilesTest, ShadowMapOfALamp) {
    const auto bake = [&](const Keys &keys) {
        Compile(Lamp({-120, 0, 60}, 300, {1, 1, 1}, keys) + Lamp({120, 0, 150}, 300), {},
                BoxText({-8, -96, 0}, {8, 96, 96}, "test/pillar") + Diamond());
        Light("-lightmass -shadowmap lamp1 -samples 1");
        return MassImage(0, "shadow_lamp1", 1);
    };
    const auto hard = bake({{"targetname", "lamp1"}});
    const LitFace floor = Floor();
    const auto at = [&](const std::vector<std::uint8_t> &map, float x, float y) {
        return int(map[FloorTexel(floor, {x, y, 0})]);
    };
    for (std::size_t i = 0; i < kPageTexels; ++i)
        ASSERT_TRUE(hard[i] == 0 || hard[i] == 255) << i;
    EXPECT_EQ(at(hard, -96, 64), 255);
    EXPECT_EQ(at(hard, -240, -240), 255);
    EXPECT_EQ(at(hard, 96, 0), 0);
    EXPECT_EQ(at(hard, 32, 80), 0);
    EXPECT_EQ(at(hard, 96, 240), 255) << "beside the wall";
    const auto soft = bake({{"targetname", "lamp1"}, {"_deviance", "16"}, {"_samples", "32"}});
    EXPECT_EQ(at(soft, -96, 64), 255);
    EXPECT_EQ(at(soft, 96, 0), 0);
    int between = 0, open = 0;
    for (const Vec3f &p : FloorPoints()) {
        const int value = at(soft, p.x, p.y);
        between += value > 16 && value < 239;
        open += value == 255;
    }
    EXPECT_GT(between, 15);
    EXPECT_GT(open, 200);
}

/// Luxels that take their light from neighbors take the rest from them too.
TEST_F(LightmassFilesTest, FilledLuxelsAreNotInShadow) {
    Compile(Lamp({0, 0, 250}, 900, {1, 1, 1}, {{"targetname", "lamp1"}}), {},
            DiamondText({64, 64, 0}, 40, 4, "test/pillar"));
    Light("-hdrfiles pfm -lightmass -shadowmap lamp1");
    const LitFace floor = Floor();
    const auto shadow = MassImage(floor.page, "shadow_lamp1", 1), coverage = MassImage(floor.page, "coverage", 1);
    const FloatImage flat = Pfm(floor.page);
    int lit = 0;
    for (const Vec3f &p : FloorPoints()) {
        const auto at = FloorTexel(floor, p);
        if (coverage[at] == 0 || flat.texels[at].x < 0.05f)
            continue;
        EXPECT_GT(shadow[at], 0) << p.x << ' ' << p.y;
        ++lit;
    }
    EXPECT_GT(lit, 500);
}

/// The lightmap of an L leaves texels to others.
TEST_F(LightmassFilesTest, TexelsWithoutSurfaceAreBlack) {
    Compile(Lamp({0, 0, 250}, 900, {1, 1, 1}, {{"targetname", "lamp1"}}), {{"ambient", "5"}},
            BoxText({-200, -200, 0}, {160, -150, 20}, "test/pillar") +
                BoxText({-200, -150, 0}, {-150, 160, 20}, "test/pillar"));
    Light("-hdrfiles pfm -lightmass -dirty -shadowmap lamp1");
    const auto coverage = MassImage(0, "coverage", 1), shadow = MassImage(0, "shadow_lamp1", 1);
    const auto occlusion = MassImage(0, "ao", 1), color = MassImage(0, "hq_color", 4);
    const FloatImage flat = Pfm(0);
    std::vector<bool> inPlace(kPageTexels);
    for (const MassPlace &place : Places())
        for (int y = place.y; y < place.y + place.height; ++y)
            for (int x = place.x; x < place.x + place.width; ++x)
                inPlace[std::size_t(y * kPageSide + x)] = true;
    int left = 0;
    for (std::size_t at = 0; at < kPageTexels; ++at) {
        ASSERT_EQ(coverage[at] != 0, flat.texels[at].x > 0) << at;
        if (coverage[at] != 0)
            continue;
        ASSERT_EQ(shadow[at] | occlusion[at] | color[4 * at + 3], 0) << at;
        left += inPlace[at];
    }
    EXPECT_GT(left, 20);
}

TEST_F(LightmassFilesTest, SkyOcclusion) {
    std::vector<std::uint8_t> image;
    const auto bake = [&](const std::string &brushes, std::string_view ceiling) {
        Compile(Lamp({0, 0, 100}, 100), {}, brushes, ceiling);
        Light("-skyocclusion");
        const LitFace floor = Floor();
        image = MassImage(floor.page, "sky_occlusion", 4);
        return floor;
    };
    const auto sky = [&](const LitFace &floor, const Vec3f &p) {
        float texel[4], out[3];
        directional_texel(image.data() + 4 * FloorTexel(floor, p), texel);
        directional_sky_occlusion(texel, out);
        return Vec3f{out[0], out[1], out[2]};
    };
    const LitFace open = bake({}, "test/sky");
    for (const Vec3f &p : FloorPoints()) {
        const Vec3f up = sky(open, p);
        ASSERT_NEAR(up.z, 1, 0.005);
        ASSERT_LT(Length(up - kUpward), 0.015f);
    }
    EXPECT_TRUE(Lightmass().at("lightmaps").at(0).at("hasSkyOcclusion"));
    const LitFace floor = bake(BoxText({64, -256, 0}, {80, 256, 256}, "test/wall"), "test/sky");
    const Vec3f half = sky(floor, {48, 0, 0});
    EXPECT_NEAR(half.y, 0, 0.05);
    EXPECT_LT(half.x, -0.15f) << "away from the wall";
    EXPECT_GT(half.z, 0.25f);
    EXPECT_NEAR(Length(half), 0.53, 0.07) << "half of the sky is seen";
    const LitFace closed = bake({}, "test/ceiling");
    for (const Vec3f &p : FloorPoints())
        ASSERT_EQ(sky(closed, p), Vec3f{});
    EXPECT_FALSE(Lightmass().at("lightmaps").at(0).at("hasSkyOcclusion"));
}

} // namespace

} // namespace q3::test
