// GPL-2.0-or-later. The values in HDR pages, basis maps and Lightmass's layout, read as engines would.
#include "common/files/files.h"
#include "common/image/image.h"
#include "libs/directional/directional.h"
#include "tests/program/lit_room.h"

#include <cmath>
#include <cstring>
#include <functional>

namespace q3::test {

namespace {

constexpr float kQuantum = 1.0f / 512, kRgbeQuantum = 1.0f / 256; // half a step of the mantissa's largest channel

Vec3f Decoded(std::uint32_t code) {
    float rgb[3];
    directional_e5bgr9(code, rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

void ExpectColor(const Vec3f &got, const Vec3f &expected, float within, const std::string &what) {
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(got[c], expected[c], within) << what << ", channel " << c;
}

Vec3f FloatsAt(const std::vector<std::byte> &file, std::size_t at) {
    float rgb[3];
    std::memcpy(rgb, file.data() + at, sizeof rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

class LightValuesTest : public LitRoomTest {
  protected:
    std::vector<Vec3f> Hdr() const {
        std::vector<Vec3f> light;
        for (const std::uint32_t code : Load().lightmapsE5bgr9)
            light.push_back(Decoded(code));
        return light;
    }
    /// The three maps of all RNM pages.
    std::vector<Vec3f> BasisMaps() const {
        std::vector<Vec3f> light;
        const Bsp bsp = Load();
        for (const auto &page : bsp.rnm->pages)
            for (const auto &map : page.maps)
                for (const std::uint32_t code : map)
                    light.push_back(Decoded(code));
        return light;
    }
    LitFace Floor() const { return FaceOf(Load(), "textures/test/floor", kUpward); }
    /// The texel of a point of the floor, which is a center.
    static std::size_t TexelOf(const LitFace &floor, const Vec3f &p) {
        const int at = floor.TexelAt(p);
        EXPECT_GE(at, 0) << p.x << ' ' << p.y;
        return std::size_t(std::max(at, 0));
    }
};

/// A lamp 50 units above the point where light is received, a unit above the floor: 340 * 7500 / 50^2 = 4 * 255.
class FourTimesFullTest : public LightValuesTest {
  protected:
    FourTimesFullTest() { Compile(Lamp({0, 0, 51}, 340)); }
};

TEST_F(FourTimesFullTest, InLumpsAndFiles) {
    Light("-hdrfiles pfm");
    const LitFace floor = Floor();
    const std::size_t at = TexelOf(floor, {0, 0, 0}), page = std::size_t(floor.page);
    const int x = int(at) % kPageSide, y = int(at) / kPageSide;
    const Vec3f four{4, 4, 4};
    ExpectColor(Pfm(floor.page).Texel(x, y), four, 1e-5f, "pfm");
    const Bsp bsp = Load();
    ExpectColor(Decoded(bsp.lightmapsE5bgr9[page * kPageTexels + at]), four, 4 * kQuantum, "lump");
    EXPECT_EQ(bsp.lightmaps[3 * (page * kPageTexels + at)], 255);
    Light("-hdrfiles ioquake3");
    const std::string name = fmt::format("lm_{:04}", page);
    ASSERT_EQ(Floor().TexelAt({0, 0, 0}), int(at)) << "packed alike";
    ExpectColor(FloatsAt(ReadFile(Beside(name + ".hdr")), 3 + 12 * at), four * 255, 1e-3f, "ioquake3");
    Light("-hdrfiles rend2");
    const FloatImage image = DecodeHdr(ReadFile(Beside(name + ".hdr")), name);
    ExpectColor(image.Texel(x, kPageSide - 1 - y), four, 4 * kRgbeQuantum, "rend2");
    if (HasOpenExr()) {
        Light("-hdrfiles exr");
        ExpectColor(DecodeExr(ReadFile(Beside(name + ".exr")), name).Texel(x, y), four, 1e-5f, "exr");
    }
}

TEST_F(FourTimesFullTest, AtVertices) {
    // The top of the box has a corner under the lamp.
    Compile(Lamp({0, 0, 91}, 340), {}, BoxText({-64, -64, 0}, {0, 0, 40}, "test/pillar"));
    for (const auto &[form, full] : {std::pair{"rend2", 1.0f}, {"ioquake3", 255.0f}}) {
        Light(fmt::format("-hdrfiles {}", form));
        const Bsp bsp = Load();
        const auto raw = ReadFile(Beside("vertlight.raw"));
        ASSERT_EQ(raw.size(), 12 * bsp.drawVerts.size());
        float most = 0;
        for (std::size_t v = 0; v < bsp.drawVerts.size(); ++v) {
            const Vec3f light = FloatsAt(raw, 12 * v) / full;
            ExpectColor(Decoded(bsp.vertexE5bgr9[v]), light, kQuantum * MaxComponent(light), form);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(bsp.drawVerts[v].color[0][c], std::min(255.0f, light[c] * 255), 1) << form;
            most = std::max(most, light.x);
        }
        EXPECT_NEAR(most, 4, 0.0001) << "the corner, a unit above its place";
    }
}

/// Eight times the light is eight times as bright, of the same hue, where 8-bit light ends.
TEST_F(LightValuesTest, OverbrightLightKeepsItsHue) {
    std::vector<Vec3f> dim, bright;
    for (const float light : {1000.0f, 8000.0f}) {
        Compile(Lamp({0, 0, 60}, light, {1, 0.5f, 0.25f}));
        Light("-both -nocollapse");
        (light == 1000 ? dim : bright) = Hdr();
    }
    ASSERT_EQ(dim.size(), bright.size());
    for (std::size_t i = 0; i < dim.size(); ++i)
        ASSERT_EQ(bright[i], dim[i] * 8) << i;
    const LitFace floor = Floor();
    const std::size_t at = std::size_t(floor.page) * kPageTexels + TexelOf(floor, {0, 0, 0});
    EXPECT_GT(bright[at].x, 40);
    EXPECT_NEAR(bright[at].y / bright[at].x, 0.5, 0.004);
    EXPECT_NEAR(bright[at].z / bright[at].x, 0.25, 0.004);
    const Bsp bsp = Load();
    EXPECT_EQ(bsp.lightmaps[3 * at], 255);
}

TEST_F(LightValuesTest, ToneOfEightBitsDoesNotReachHdrButItsFactorsDo) {
    Compile(Lamp({-60, 30, 60}, 100, {1, 0.5f, 0.25f}));
    const auto bake = [&](const std::string &options) {
        Light("-hdrfiles pfm -nocollapse " + options);
        return Pfm(0).texels;
    };
    const std::vector<Vec3f> plain = bake("");
    for (const auto &[options, factor] : std::initializer_list<std::pair<std::string, float>>{
             {"-gamma 2.2", 1}, {"-exposure 200", 1}, {"-brightness 2", 2}, {"-compensate 4", 0.25f}}) {
        const std::vector<Vec3f> other = bake(options);
        const auto lump = Hdr();
        for (std::size_t i = 0; i < kPageTexels; ++i) {
            ASSERT_EQ(other[i], plain[i] * factor) << options;
            ASSERT_LE(Length(lump[i] - other[i]), 2 * kQuantum * MaxComponent(other[i])) << options;
        }
    }
}

TEST_F(LightValuesTest, LightAddsUp) {
    constexpr std::size_t kUnderPillar = 192 / 16 + 1;
    const std::string a = Lamp({-100, 60, 90}, 200, {1, 0.5f, 0.25f}), b = Lamp({120, -20, 150}, 300, {0.2f, 0.9f, 1});
    std::vector<Vec3f> hdr[3], basis[3];
    for (std::size_t i = 0; i < 3; ++i) {
        Compile((i != 1 ? a : "") + (i != 0 ? b : ""), {}, BoxText({-8, -96, 0}, {8, 96, 96}, "test/pillar"));
        Light("-hdr -rnmall -rnmstorage raw");
        hdr[i] = Hdr(), basis[i] = BasisMaps();
    }
    for (const auto &[one, other, both] : {std::tie(hdr[0], hdr[1], hdr[2]), std::tie(basis[0], basis[1], basis[2])}) {
        ASSERT_EQ(one.size(), both.size());
        ASSERT_EQ(other.size(), both.size());
        std::size_t lit = 0, more = 0;
        for (std::size_t i = 0; i < both.size(); ++i) {
            const float within =
                kQuantum * (MaxComponent(one[i]) + MaxComponent(other[i]) + MaxComponent(both[i])) + 1e-6f;
            const Vec3f excess = both[i] - one[i] - other[i];
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_GE(excess[c], -within) << i;
            more += MaxComponent(excess) > within;
            lit += MaxComponent(one[i]) > 0.05f && MaxComponent(other[i]) > 0.05f;
        }
        EXPECT_GT(lit, 500u);
        // Luxels under the pillar take the least light of its two sides, and each lamp reaches one of them.
        EXPECT_LE(more, kUnderPillar * (both.size() / hdr[2].size()));
    }
}

TEST_F(LightValuesTest, TwiceTheLightIsTwiceTheValue) {
    std::vector<Vec3f> values[2];
    for (const float factor : {1.0f, 2.0f}) {
        Compile(Lamp({-100, 60, 90}, 200 * factor, {1, 0.5f, 0.25f}) + Lamp({120, -20, 150}, 300 * factor));
        Light("-hdr -rnmall -rnmstorage raw");
        std::vector<Vec3f> &all = values[factor == 1 ? 0 : 1];
        all = Hdr();
        const std::vector<Vec3f> basis = BasisMaps();
        all.insert(all.end(), basis.begin(), basis.end());
    }
    ASSERT_EQ(values[0].size(), values[1].size());
    for (std::size_t i = 0; i < values[0].size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            // The format has full precision from 2^-16 up.
            const float within = MaxComponent(values[1][i]) < 0x1p-15f ? 0x1p-24f : 0;
            ASSERT_NEAR(values[1][i][c], values[0][i][c] * 2, within) << i;
        }
}

TEST_F(LightValuesTest, RescaledBasisMapsGiveTheFlatLight) {
    Compile(Lamp({-100, 60, 90}, 300, {1, 0.2f, 0.1f}) + Lamp({120, -20, 150}, 300, {0.1f, 0.3f, 1}), {},
            BoxText({-8, -96, 0}, {8, 96, 96}, "test/pillar"));
    Light("-both -rnmall");
    const std::vector<Vec3f> flat = Hdr();
    const Bsp bsp = Load();
    std::size_t count = 0, shaped = 0;
    for (const auto &page : bsp.rnm->pages)
        for (std::size_t at = 0; at < kPageTexels; ++at) {
            float maps[3][3], rgb[3];
            float most = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                directional_e5bgr9(page.maps[i][at], maps[i]);
                most += std::max({maps[i][0], maps[i][1], maps[i][2]}) / 3;
            }
            const float up[3] = {0, 0, 1};
            directional_rnm_rescaled(&maps[0][0], up, rgb);
            const Vec3f &expected = flat[std::size_t(page.lightmapNum) * kPageTexels + at];
            const float within = 1.01f * kQuantum * (most + MaxComponent(expected)) + 1e-7f;
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(rgb[c], expected[c], within) << at;
            count += expected.x > 0;
            shaped += std::abs(maps[0][0] - maps[1][0]) > 0.2f * expected.x && expected.x > 0;
        }
    EXPECT_GT(count, 200u);
    EXPECT_GT(shaped, 200u);
}

/// What one map has above 1 goes to the others: the mean stays. Raw maps end at 1.
TEST_F(LightValuesTest, EightBitBasisMapsKeepTheMean) {
    Compile(Lamp({-100, 60, 70}, 500, {1, 0.6f, 0.3f}) + Lamp({120, -20, 150}, 300));
    for (const bool rescaled : {true, false}) {
        Light(fmt::format("-external -rnmall -hdrfiles pfm -rnmstorage {}", rescaled ? "rescaled" : "raw"));
        const FloatImage flat = Pfm(0);
        std::vector<FloatImage> maps;
        std::vector<Image> bytes;
        for (const std::string_view suffix : {"_b1", "_b2", "_b3"}) {
            maps.push_back(Pfm(0, suffix));
            const std::string name = fmt::format("lm_0000{}.tga", suffix);
            bytes.push_back(DecodeTga(ReadFile(Beside(name)), name));
        }
        int moved = 0;
        for (std::size_t at = 0; at < kPageTexels; ++at)
            for (std::size_t c = 0; c < 3; ++c) {
                double mean = 0, most = 0;
                for (std::size_t i = 0; i < 3; ++i) {
                    const double value = double(maps[i].texels[at][c]), byte = bytes[i].rgba[4 * at + c];
                    mean += byte / 3, most = std::max(most, value);
                    if (!rescaled) {
                        ASSERT_NEAR(byte, 255 * std::min(1.0, value), 0.51) << at;
                    }
                }
                if (rescaled) {
                    ASSERT_NEAR(mean, 255 * std::min(1.0, double(flat.texels[at][c])), 0.51) << at;
                }
                moved += most > 1.1 && flat.texels[at][c] < 0.95f;
            }
        EXPECT_GT(moved, 15);
    }
}

/// Raw maps are exact for one lamp, as long as it and the normal are within 35 degrees of the surface's own.
TEST_F(LightValuesTest, RawBasisMapsGiveTheLightOfBumps) {
    const Vec3f lamp{0, 0, 201};
    Compile(Lamp(lamp, 300, {1, 0.5f, 0.25f}));
    Light("-hdrfiles pfm -rnmall -rnmstorage raw");
    const LitFace floor = Floor();
    const FloatImage flat = Pfm(floor.page);
    const FloatImage maps[3] = {Pfm(floor.page, "_b1"), Pfm(floor.page, "_b2"), Pfm(floor.page, "_b3")};
    const Vec3f s{1, 0, 0}, t{0, -1, 0}; // of the texture: images hang with their top to the north
    std::size_t count = 0;
    for (const Vec3f &p : FloorPoints()) {
        const Vec3f to = lamp - (p + kUpward), w = Normalize(to);
        if (w.z < 0.82f)
            continue;
        const std::size_t at = TexelOf(floor, p);
        const Vec3f light = Vec3f{1, 0.5f, 0.25f} * (300 * 7500 / 255.0f / Dot(to, to));
        ExpectColor(flat.texels[at], light * w.z, 1e-4f * light.x, "flat");
        for (const Vec3f &bump : {Vec3f{0, 0, 1}, {0.3f, 0, 1}, {-0.2f, 0.4f, 1}, {0, -0.5f, 1}}) {
            const Vec3f n = Normalize(bump), world = s * n.x + t * n.y + kUpward * n.z;
            float texel[3][3], rgb[3];
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t c = 0; c < 3; ++c)
                    texel[i][c] = maps[i].texels[at][c];
            const float normal[3] = {n.x, n.y, n.z};
            directional_rnm_raw(&texel[0][0], normal, rgb);
            ExpectColor({rgb[0], rgb[1], rgb[2]}, light * Dot(world, w), 1e-4f * light.x, "bump");
        }
        ++count;
    }
    EXPECT_GT(count, 200u);
}

} // namespace

} // namespace q3::test
