// GPL-2.0-or-later. Lump 15 and lightgrid.raw made of the SH grid, as engines read them.
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "q3map2/gridformats/grid_source.h"
#include "q3map2/gridformats/legacy_encode.h"
#include "tests/gridformats/sample_grid.h"
#include "tests/support/grid_readers/legacy_reader.h"

#include <numbers>
#include <numeric>

namespace q3::test {

namespace {

constexpr LegacyTarget kForIoquake3{.ambientScale = 0.6, .ambientAdded = 8, .angleSteps = 256, .skipsSolid = true};
constexpr LegacyTarget kForAll{};
const Vec3f kWorldMins{-300, -70, -130}, kWorldMaxs{300, 260, 257};
const Vec3d kSun = Normalize(Vec3d{1, -2, 3});

/// Linear in the position, from one direction, so that engines blend without loss. Byte scale: ambient from 20, sum
/// up to 220.
bspGridPointSH_t SunAndSky(const Vec3f &p) {
    const double along = double(p.x + 300) / 600;
    return LightFrom(kSun, {0.3 + 0.2 * along, 0.4, 0.1}) + ConstantLight({0.12, 0.1 + 0.2 * along, 0.08});
}

struct Fixture {
    StoredGridSH stored = SampleGrid({19, 14, 14}, {-288, -96, -128}, SunAndSky);
    GridSource source{stored, std::vector<bool>(stored.grid.points.size())};
    GridLayout layout = LayoutGrid(kWorldMins.Array(), kWorldMaxs.Array(), {64, 64, 128});
    LegacyPlaces places{kWorldMins, kWorldMaxs, {64, 64, 128}};
    LegacyPoints points = OpenPoints(source, layout);
};

/// Positions all over the grid.
std::vector<Vec3f> Probes() {
    std::vector<Vec3f> probes;
    for (int i = 0; i < 200; ++i)
        probes.push_back({-250.0f + float(i * 37 % 500), -60.0f + float(i * 53 % 250), -120.0f + float(i * 71 % 240)});
    return probes;
}

/// The largest difference of the fit from the light, anywhere and on any normal, byte scale, plus what rounding can
/// add: half a byte of each part and half a step of each angle.
double ErrorBound(double partRounding, int angleSteps) {
    double fitError = 0, directed = 0;
    for (const float x : {-300.0f, 300.0f}) {
        const auto light = SunAndSky({x, 0, 0});
        const AmbientDirected fit = FitAmbientDirected(light);
        directed = std::max(directed, MaxComponent(fit.directed));
        for (const Vec3f &n : ProbeNormals())
            for (std::size_t i = 0; i < 3; ++i) {
                const double shown = fit.ambient[i] + fit.directed[i] * std::max(0.0, Dot(Vec3d(n), fit.direction));
                fitError = std::max(fitError, std::abs(LightOn(light, Vec3d(n))[i] - shown));
            }
    }
    const double halfStep = std::numbers::pi / angleSteps;
    return 255 * (fitError + directed * std::sqrt(2.0) * halfStep) + partRounding;
}

void ExpectNear(const LegacyGridReader &reader, double bound) {
    EXPECT_LT(bound, 20);
    for (const Vec3f &p : Probes()) {
        const LegacyLight light = reader.At(p);
        for (const Vec3f &n : ProbeNormals()) {
            const Vec3d exact = LightOn(SunAndSky(p), Vec3d(n)) * 255.0;
            const Vec3f shown = light.On(n);
            for (std::size_t i = 0; i < 3; ++i)
                ASSERT_NEAR(double(shown[i]), exact[i], bound) << p.x << ' ' << p.y << ' ' << p.z;
        }
    }
}

TEST(LegacyGridFromSH, Ioquake3ShowsTheLightOfTheSHGrid) {
    const Fixture f;
    const auto lump = EncodeLegacyGrid(f.points, kForIoquake3, GridTone(), 1);
    const auto reader = LegacyGridReader::Load(IbspGridLump(lump), f.places, kIoquake3Engine);
    ASSERT_TRUE(reader);
    ExpectNear(*reader, ErrorBound(0.5 + 0.3, 256));
    // Not compensated, it is too dark: by 40 % of the ambient light, less the constant.
    const auto plain = EncodeLegacyGrid(f.points, kForAll, GridTone(), 1);
    const auto dim = LegacyGridReader::Load(IbspGridLump(plain), f.places, kIoquake3Engine);
    const Vec3f p{100, 100, 0}, away(-kSun);
    EXPECT_LT(dim->At(p).On(away).y, reader->At(p).On(away).y - 5);
}

TEST(LegacyGridFromSH, OtherEnginesShowIt) {
    const Fixture f;
    const auto lump = EncodeLegacyGrid(f.points, kForAll, GridTone(), 1);
    const auto reader = LegacyGridReader::Load(IbspGridLump(lump), f.places, kPlainEngine);
    ASSERT_TRUE(reader);
    ExpectNear(*reader, ErrorBound(1, 255));
}

// Daemon keeps (ambient + k directed) / (1 + k) of a point.
TEST(LegacyGridFromSH, DaemonKeepsTheMeanLight) {
    const Fixture f;
    for (const double k : {0.25, 0.4}) {
        const auto lump = EncodeLegacyGrid(f.points, {.skipsSolid = true, .directedWeight = k}, GridTone(), 1);
        for (std::size_t i = 0; i < lump.size(); ++i) {
            const Vec3d mean = MeanLight(f.points.light[i]) * 255.0;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const double kept = (lump[i].ambient[0][channel] + k * lump[i].directed[0][channel]) / (1 + k);
                ASSERT_NEAR(kept * (1 + k), mean[channel], 0.5 + 0.5 * k + 1e-3);
            }
            ASSERT_GT(std::accumulate(lump[i].ambient[0].begin(), lump[i].ambient[0].end(), 0), 0) << "0 is in a wall";
        }
    }
}

TEST(RawGridFromSH, BothRend2RenderersShowIt) {
    const Fixture f;
    constexpr LegacyTarget raw{.ambientScale = 0.6, .angleSteps = 256, .skipsSolid = true};
    const auto lump = EncodeLegacyGrid(f.points, kForIoquake3, GridTone(), 1);
    const auto bytes = EncodeRawGrid(f.points, raw, GridTone(), 1, 1);
    const auto reader = LegacyGridReader::LoadRaw(IbspGridLump(lump), bytes, f.places, {0.6f, 1, 0, 256, true}, 1);
    ASSERT_TRUE(reader);
    ExpectNear(*reader, ErrorBound(0.01, 256));

    const auto openJk = EncodeRawGrid(f.points, {.angleSteps = 256}, GridTone(), 1, std::numbers::pi / 255);
    const auto rend2 = LegacyGridReader::LoadRend2(IbspGridLump(lump), openJk, f.places, {});
    ASSERT_TRUE(rend2);
    ExpectNear(*rend2, ErrorBound(0.01, 256));
}

// What the engine limits to full light comes out with its hue; nothing before it has limited it.
TEST(RawGridFromSH, BrightLightIsNotLimited) {
    const auto stored = SampleGrid({2, 2, 2}, {}, [](const Vec3f &) { return ConstantLight({4, 2, 1}); });
    const GridSource source(stored, std::vector<bool>(8));
    const auto points = OpenPoints(source, {{}, {64, 64, 128}, {1, 1, 1}});
    const auto bytes = EncodeRawGrid(points, {}, GridTone(), 1, 1);
    float rgb[3];
    std::memcpy(rgb, bytes.data(), sizeof rgb);
    EXPECT_NEAR(rgb[0], 4 * 255, 0.01);
    EXPECT_NEAR(rgb[2], 255, 0.01);
    const auto lump = EncodeLegacyGrid(points, {}, GridTone(), 1);
    EXPECT_EQ(lump[0].ambient[0], (std::array<std::uint8_t, 3>{255, 128, 64}));
}

TEST(LegacyGridFromSH, LengthsFitTheBoundsOfTheWorld) {
    const std::pair<Vec3f, Vec3f> worlds[] = {{{-64, -128, -128}, {64, 128, 128}}, // exactly on points
                                              {{-65, -1, -127}, {65, 63, 129}},
                                              {{1, 1, 1}, {200, 64, 128}},
                                              {{-500, -500, -500}, {-70, -130, -120}}};
    for (const auto &[mins, maxs] : worlds) {
        const Bsp bsp = WorldWithWall(mins.Array(), maxs.Array(), -1000);
        const GridLayout layout = LegacyLayout(bsp);
        const auto stored = SampleGrid({2, 2, 2}, mins.Array(), [](const Vec3f &) { return ConstantLight({1, 1, 1}); });
        const LegacyPoints points = OpenPoints(GridSource(stored, std::vector<bool>(8)), layout);
        const LegacyPlaces places(mins, maxs, {64, 64, 128});
        EXPECT_EQ(IbspGridLump(EncodeLegacyGrid(points, {}, GridTone(), 1)).size(), 8 * places.Points());
        EXPECT_EQ(EncodeRawGrid(points, {}, GridTone(), 1, 1).size(), 24 * places.Points());
    }
    EXPECT_EQ(LegacyPlaces(worlds[0].first, worlds[0].second, {64, 64, 128}).Points(), 3u * 5 * 3);
}

TEST(LegacyGridFromSH, PointsInTheOpenAreNeverBlack) {
    const auto stored = SampleGrid({2, 2, 2}, {}, [](const Vec3f &) { return bspGridPointSH_t{}; });
    const auto points = OpenPoints(GridSource(stored, std::vector<bool>(8)), {{}, {64, 64, 128}, {1, 1, 1}});
    for (const LegacyTarget &reader : {kForAll, kForIoquake3})
        EXPECT_EQ(EncodeLegacyGrid(points, reader, GridTone(), 1)[0].ambient[0], (std::array<std::uint8_t, 3>{1, 1, 1}));
}

TEST(LegacyGridFromSH, ToneAndAmbientFactor) {
    const auto stored = SampleGrid({2, 2, 2}, {}, [](const Vec3f &) { return ConstantLight({0.25, 0.25, 0.25}); });
    const auto points = OpenPoints(GridSource(stored, std::vector<bool>(8)), {{}, {64, 64, 128}, {1, 1, 1}});
    const auto red = [&](const char *tone, double factor) {
        return int(EncodeLegacyGrid(points, {}, GridTone(tone), factor)[0].ambient[0][0]);
    };
    EXPECT_EQ(red("", 1), 64);
    EXPECT_EQ(red("gamma 2", 1), 128);
    EXPECT_EQ(red("gamma 2 scale 0.5", 1), 64);
    EXPECT_EQ(red("", 0.5), 32);
    EXPECT_EQ(red("maxlight 20", 1), 20);
    const auto raw = EncodeRawGrid(points, {}, GridTone("gamma 2 scale 4"), 1, 1);
    float value;
    std::memcpy(&value, raw.data(), sizeof value);
    EXPECT_NEAR(value, 2 * 255, 0.01) << "the tone without its limit";
}

// A wall fills x below 100. The SH grid has light in the wall up to x = 64, fitted by the light stage.
TEST(LegacyGridFromSH, PointsInSolids) {
    const Bsp bsp = WorldWithWall({-256, -64, -128}, {256, 64, 128}, 100);
    const auto stored = SampleGrid({17, 5, 9}, {-256, -64, -128}, [](const Vec3f &p) {
        return p.x < 64 ? bspGridPointSH_t{} : ConstantLight({0.5, 0.5, 0.5});
    });
    const BspSpace space(bsp, {});
    const GridLayout shLayout{stored.grid.header.gridMins, stored.grid.header.gridSize, stored.grid.header.gridBounds};
    const GridSource source(stored, SolidPoints(space, shLayout));
    const LegacyPoints points = SampleLegacyPoints(source, space, LegacyLayout(bsp));
    const auto at = [&](int x) { return std::size_t(points.layout.Index((x + 256) / 64, 1, 1)); };
    EXPECT_EQ(points.use[at(128)], PointUse::Open);
    EXPECT_EQ(points.use[at(64)], PointUse::Solid);
    EXPECT_EQ(points.use[at(0)], PointUse::Void) << "the cell ends at 64, inside the wall";
    const auto red = [&](const LegacyTarget &reader, int x) {
        return int(EncodeLegacyGrid(points, reader, GridTone(), 1)[at(x)].ambient[0][0]);
    };
    EXPECT_EQ(red(kForAll, 128), 128);
    EXPECT_EQ(red(kForAll, 64), 128) << "for engines that blend it";
    EXPECT_EQ(red(kForIoquake3, 64), 0) << "for engines that leave it out";
    EXPECT_EQ(red(kForAll, 0), 0);
}

// A corridor narrower than a cell between two points: all engines need the points in its walls.
TEST(LegacyGridFromSH, PointsThatNoneInTheOpenCanReplace) {
    Bsp bsp = WorldWithWall({0, -64, -128}, {128, 64, 128}, 10);
    bsp.planes.insert(bsp.planes.end(), {{{1, 0, 0}, 50}, {{-1, 0, 0}, -50}});
    bsp.nodes[0].children[0] = 1;
    bsp.nodes.push_back({2, {-3, -2}, bsp.nodes[0].mins, bsp.nodes[0].maxs});
    bsp.leafs[1].maxs[0] = 50;
    // Behind the second plane is solid leaf 2; the corridor is x = 10 to 50.
    const auto stored = SampleGrid({5, 5, 9}, {0, -64, -128}, [](const Vec3f &p) {
        return p.x < 65 ? ConstantLight({0.5, 0.5, 0.5}) : bspGridPointSH_t{};
    });
    const BspSpace space(bsp, {});
    const GridLayout shLayout{stored.grid.header.gridMins, stored.grid.header.gridSize, stored.grid.header.gridBounds};
    const LegacyPoints points =
        SampleLegacyPoints(GridSource(stored, SolidPoints(space, shLayout)), space, LegacyLayout(bsp));
    for (const std::int64_t x : {0, 1}) {
        const auto index = std::size_t(points.layout.Index(x, 1, 1));
        EXPECT_EQ(points.use[index], PointUse::SoleSource);
        EXPECT_GT(EncodeLegacyGrid(points, kForIoquake3, GridTone(), 1)[index].ambient[0][0], 100);
    }
}

// Light one cell into the wall comes from neighbors, the nearer counting more; order does not matter.
TEST(LegacyGridFromSH, SolidPointsWithoutLightGetItFromNeighbors) {
    const Bsp bsp = WorldWithWall({0, -64, -128}, {256, 64, 128}, 100);
    const auto stored = SampleGrid({9, 5, 9}, {0, -64, -128}, [](const Vec3f &p) {
        return p.x < 100 ? bspGridPointSH_t{} : ConstantLight({p.y > 30 ? 1.0 : 0.5, 0.5, 0.5});
    });
    const BspSpace space(bsp, {});
    const GridLayout shLayout{stored.grid.header.gridMins, stored.grid.header.gridSize, stored.grid.header.gridBounds};
    const LegacyPoints points =
        SampleLegacyPoints(GridSource(stored, SolidPoints(space, shLayout)), space, LegacyLayout(bsp));
    const auto value = [&](int y) { return MeanLight(points.light[std::size_t(points.layout.Index(1, y, 1))]).x; };
    EXPECT_GT(value(0), 0.49);
    EXPECT_GT(value(2), value(0) + 0.1);
    EXPECT_LT(value(2), 1);
}

TEST(LegacyGridFromSH, RadianceIsConvolvedFirst) {
    StoredGridSH stored = SampleGrid({2, 2, 2}, {}, [](const Vec3f &) {
        bspGridPointSH_t light{};
        for (float &value : light.coeffs[0])
            value = float(2 / std::sqrt(std::numbers::pi)); // of radiance 1/pi, so light 1 on all surfaces
        return light;
    });
    stored.isRadiance = true;
    const GridSource source(stored, std::vector<bool>(8));
    EXPECT_NEAR(MeanLight(source.Point(0)).x, 1, 1e-6);
}

TEST(LegacyGridFromSH, DirectionsWithinHalfAStep) {
    for (const int steps : {255, 256})
        for (int i = 0; i < 500; ++i) {
            const double z = -1 + 2 * (i + 0.5) / 500, angle = 2.4 * i, radius = std::sqrt(1 - z * z);
            const Vec3d direction{radius * std::cos(angle), radius * std::sin(angle), z};
            const auto bytes = EncodeDirection(direction, steps);
            const double unit = 2 * std::numbers::pi / steps, polar = bytes[0] * unit, around = bytes[1] * unit;
            const Vec3d read{std::cos(around) * std::sin(polar), std::sin(around) * std::sin(polar), std::cos(polar)};
            EXPECT_GT(Dot(read, direction), std::cos(unit / 2 * std::sqrt(2.0)) - 1e-9);
        }
    EXPECT_EQ(EncodeDirection({0, 0, -1}, 256), (std::array<std::uint8_t, 2>{128, 0}));
}

} // namespace

} // namespace q3::test
