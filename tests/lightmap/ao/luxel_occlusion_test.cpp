// GPL-2.0-or-later. Dirt and floodlight on luxels, against distances to boxes worked out one by one.
#include "q3map2/lightmap/ao/luxel_occlusion.h"
#include "tests/support/surface_case.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace q3::test {

namespace {

constexpr std::string_view kDirtFloor = "textures/test/floor";
const Boundsf kRoom{{-101.3f, -90.7f, -50}, {111.9f, 95.1f, 121.7f}};

/// A shader whose picture is one texel of that opacity.
std::string Tga(int alpha) {
    std::string file(18, '\0');
    file[2] = 2;
    file[12] = file[14] = 1;
    file[16] = 32;
    file[17] = 8;
    for (const int c : {50, 100, 200, alpha})
        file += char(c);
    return file;
}

/// Distance from inside a box to its surface.
double WayOut(const Vec3d &p, const Vec3d &d, const Boundsf &box) {
    double way = 1e30;
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (d[axis] != 0)
            way = std::min(way, (double(d[axis] > 0 ? box.maxs[axis] : box.mins[axis]) - p[axis]) / d[axis]);
    return way;
}

/// Distance from outside to a box; nothing if the ray misses it.
std::optional<double> WayIn(const Vec3d &p, const Vec3d &d, const Boundsf &box) {
    double enter = 0, leave = 1e30;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double a = (double(box.mins[axis]) - p[axis]) / d[axis], b = (double(box.maxs[axis]) - p[axis]) / d[axis];
        if (a > b)
            std::swap(a, b);
        enter = std::max(enter, a), leave = std::min(leave, b);
    }
    return enter < leave ? std::optional(enter) : std::nullopt;
}

/// A floor inside a room with boxes in it, facing up.
class DirtTest : public testing::Test {
  protected:
    void AddFloor(SceneBuilder &scene) const { scene.AddQuad(Rectangle(-75, -70, 85, 77, 0), Shaded(kDirtFloor)); }
    /// The room, its floor, and boxes.
    SceneBuilder Room() const {
        SceneBuilder scene = EmptyRoom(kRoom.mins, kRoom.maxs);
        AddFloor(scene);
        for (const Boundsf &box : boxes)
            scene.AddBox(box.mins, box.maxs, Shaded("textures/test/box"), BoxKind::Detail);
        return scene;
    }
    /// Distance to the solid on the way of a ray that is `reach` long, or else to the nearest box.
    double Distance(const Vec3d &p, const Vec3d &d, double reach) const {
        double way = WayOut(p, d, kRoom);
        if (way > reach)
            for (const Boundsf &box : boxes)
                way = std::min(way, WayIn(p, d, box).value_or(way));
        return way;
    }
    /// Share of the hemisphere over p that is shut: what rings of rays miss of their length.
    double Shut(const Vec3d &p, int elevations, double step, double reach, bool alsoUp) const {
        double sum = alsoUp ? 1 - std::min(1.0, Distance(p, {1e-9, 1e-9, 1}, reach) / reach) : 0;
        for (int e = 0; e < elevations; ++e)
            for (int a = 0; a < 16; ++a) {
                const double elevation = (e + 0.5) * step * std::numbers::pi / 180, azimuth = a * std::numbers::pi / 8;
                // Straight up, right is x and up is y.
                const Vec3d d{std::sin(elevation) * std::cos(azimuth), std::sin(elevation) * std::sin(azimuth),
                              std::cos(elevation)};
                sum += 1 - std::min(1.0, Distance(p, d, reach) / reach);
            }
        return sum / (16 * elevations + (alsoUp ? 1 : 0));
    }
    double RawDirt(const Vec3d &p, const LightmapOptions &o) const {
        const double shut = Shut(p, 3, 29, double(o.dirtDepth), true);
        return 1 - std::min(1.0, std::pow(shut, double(o.dirtGain)) * double(o.dirtScale));
    }
    /// Dirt of all luxels: worked out for each, then smoothed in reading order.
    std::vector<double> Expected(const RawLightmap &raw, const LightmapOptions &o) const {
        std::vector<double> dirt(raw.luxelClusters.size());
        for (std::size_t i = 0; i < dirt.size(); ++i)
            if (raw.Mapped(i))
                dirt[i] = RawDirt(Vec3d(raw.positions[i]), o);
        for (int y = 0; y < raw.SuperHeight(); ++y)
            for (int x = 0; x < raw.SuperWidth(); ++x) {
                double sum = dirt[raw.SuperIndex(x, y)];
                int count = 1;
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        const int u = x + dx, v = y + dy;
                        if ((dx == 0 && dy == 0) || u < 0 || v < 0 || u >= raw.SuperWidth() || v >= raw.SuperHeight())
                            continue;
                        const std::size_t other = raw.SuperIndex(u, v);
                        if (raw.Mapped(other) && dirt[other] > 0)
                            sum += dirt[other], ++count;
                    }
                dirt[raw.SuperIndex(x, y)] = sum / count;
            }
        return dirt;
    }
    CaseSettings Dirty() const {
        CaseSettings settings;
        settings.lightmap.dirty = true;
        return settings;
    }
    SurfaceLight DirtOf(SurfaceCase &c) const {
        SurfaceLight surfaces = c.Mapped();
        DirtLuxels(c.Inputs(), surfaces);
        return surfaces;
    }
    void ExpectDirt(const CaseSettings &settings) const {
        SurfaceCase c(Room(), folder, settings);
        const SurfaceLight surfaces = DirtOf(c);
        const RawLightmap &raw = LightmapOf(c, surfaces, kDirtFloor);
        const std::vector<double> expected = Expected(raw, settings.lightmap);
        ASSERT_EQ(raw.dirt.size(), expected.size());
        int mapped = 0;
        for (std::size_t i = 0; i < expected.size(); ++i)
            if (raw.Mapped(i)) {
                ++mapped;
                EXPECT_NEAR(raw.dirt[i], expected[i], 1e-3) << i;
            }
        EXPECT_GT(mapped, 80);
    }

    GameFolder folder;
    std::vector<Boundsf> boxes;
};

using FloodTest = DirtTest;

TEST_F(DirtTest, OffWithoutTheOption) {
    SurfaceCase c(Room(), folder);
    for (const RawLightmap &raw : DirtOf(c).lightmaps)
        EXPECT_TRUE(raw.dirt.empty());
}

TEST_F(DirtTest, NothingNearIsClean) {
    SceneBuilder scene = EmptyRoom();
    AddFloor(scene);
    SurfaceCase c(scene, folder, Dirty());
    const SurfaceLight surfaces = DirtOf(c);
    const RawLightmap &raw = LightmapOf(c, surfaces, kDirtFloor);
    for (std::size_t i = 0; i < raw.dirt.size(); ++i)
        if (raw.Mapped(i)) {
            EXPECT_EQ(raw.dirt[i], 1) << i;
        }
}

TEST_F(DirtTest, WallsByTheirDistance) {
    ExpectDirt(Dirty());
}

TEST_F(DirtTest, BoxesWhereNoSolidIsOnTheWay) {
    boxes = {{{-60.3f, -50.1f, 4.7f}, {-31.1f, -22.9f, 41.3f}},
             {{20.9f, 11.3f, 9.1f}, {55.7f, 60.7f, 20.3f}},
             {{-20.3f, 20.1f, 30.7f}, {70.9f, 44.9f, 66.1f}},
             {{40.7f, -61.3f, 2.9f}, {52.3f, -8.7f, 90.9f}}};
    ExpectDirt(Dirty());
}

TEST_F(DirtTest, OfManyBoxesTheNearest) {
    std::uint32_t seed = 12345;
    const auto random = [&](float low, float high) {
        seed = seed * 1664525u + 1013904223u;
        return low + (high - low) * float(seed >> 8) / float(1 << 24);
    };
    for (int i = 0; i < 60; ++i) {
        const Vec3f at{random(-80, 80), random(-70, 70), random(5, 100)};
        boxes.push_back({at, at + Vec3f{random(2, 12), random(2, 12), random(2, 12)}});
    }
    ExpectDirt(Dirty());
}

TEST_F(DirtTest, DepthScaleAndGain) {
    CaseSettings settings = Dirty();
    settings.lightmap.dirtDepth = 64;
    settings.lightmap.dirtScale = 1.5f;
    settings.lightmap.dirtGain = 0.7f;
    ExpectDirt(settings);
}

TEST_F(DirtTest, MoreThanBlackIsBlack) {
    CaseSettings settings = Dirty();
    settings.lightmap.dirtScale = 100;
    SurfaceCase c(Room(), folder, settings);
    const SurfaceLight surfaces = DirtOf(c);
    for (const float dirt : LightmapOf(c, surfaces, kDirtFloor).dirt)
        EXPECT_EQ(dirt, 0);
}

TEST_F(DirtTest, RandomRaysAgreeWithTheMeanOverTheCone) {
    boxes = {{{-60.3f, -50.1f, 4.7f}, {-31.1f, -22.9f, 41.3f}}};
    CaseSettings settings = Dirty();
    settings.lightmap.dirtRandom = true;
    SurfaceCase c(Room(), folder, settings);
    const SurfaceLight surfaces = DirtOf(c);
    const RawLightmap &raw = LightmapOf(c, surfaces, kDirtFloor);
    double sum = 0, expected = 0;
    int count = 0;
    for (std::size_t i = 0; i < raw.dirt.size(); ++i)
        if (raw.Mapped(i)) {
            // Elevations of even spread, 48 rays to one straight up.
            const Vec3d p(raw.positions[i]);
            const double up = 1 - std::min(1.0, Distance(p, {1e-9, 1e-9, 1}, 128) / 128);
            sum += double(raw.dirt[i]), ++count;
            expected += 1 - (Shut(p, 44, 2, 128, false) * 48 + up) / 49;
        }
    ASSERT_GT(count, 80);
    EXPECT_NEAR(sum / count, expected / count, 0.01);
}

TEST_F(DirtTest, ThreadsMakeNoDifference) {
    for (const bool random : {false, true}) {
        CaseSettings settings = Dirty();
        settings.lightmap.dirtRandom = random;
        settings.lightmap.super = 3;
        SurfaceCase one(Room(), folder, settings);
        settings.threads = 4;
        SurfaceCase four(Room(), folder, settings);
        const SurfaceLight a = DirtOf(one), b = DirtOf(four);
        ASSERT_EQ(a.lightmaps.size(), b.lightmaps.size());
        for (std::size_t i = 0; i < a.lightmaps.size(); ++i)
            EXPECT_EQ(a.lightmaps[i].dirt, b.lightmaps[i].dirt);
    }
}

TEST_F(DirtTest, ShadersMayBeWithout) {
    CaseSettings settings = Dirty();
    settings.script = "textures/test/floor\n{\nq3map_noDirty\n}\n";
    SurfaceCase c(Room(), folder, settings);
    const SurfaceLight surfaces = DirtOf(c);
    for (const float dirt : LightmapOf(c, surfaces, kDirtFloor).dirt)
        EXPECT_EQ(dirt, 1);
}

TEST_F(DirtTest, ReceiversOfNoShadowAreClean) {
    CaseSettings settings = Dirty();
    settings.surfaces = "default\n{\nreceiveShadows 0\nsampleSize 16\nlightmapAxis ( 0 0 1 )\n}\n";
    SurfaceCase c(Room(), folder, settings);
    const SurfaceLight surfaces = DirtOf(c);
    const RawLightmap &raw = LightmapOf(c, surfaces, kDirtFloor);
    int mapped = 0;
    for (std::size_t i = 0; i < raw.dirt.size(); ++i)
        if (raw.Mapped(i)) {
            EXPECT_EQ(raw.dirt[i], 1) << i;
            ++mapped;
        }
    EXPECT_GT(mapped, 0);
}

TEST_F(DirtTest, SeeThroughRoofsCountWhereTheyAreOpaque) {
    for (const int alpha : {0, 128, 255}) {
        folder.Write("textures/test/roof.tga", Tga(alpha));
        SceneBuilder scene = EmptyRoom();
        AddFloor(scene);
        scene.AddQuad(Rectangle(-900, -900, 900, 900, 33), Shaded("textures/test/roof"));
        CaseSettings settings = Dirty();
        settings.script = "textures/test/roof\n{\nsurfaceparm alphashadow\n}\n";
        SurfaceCase c(scene, folder, settings);
        const SurfaceLight surfaces = DirtOf(c);
        const RawLightmap &raw = LightmapOf(c, surfaces, kDirtFloor);
        double gathered = 0; // 32 units to the roof
        for (const double elevation : {14.5, 43.5, 72.5})
            gathered += 16 * (1 - 32 / std::cos(elevation * std::numbers::pi / 180) / 128);
        const double shut = (gathered + 1 - 32.0 / 128) / 49;
        for (std::size_t i = 0; i < raw.dirt.size(); ++i)
            if (raw.Mapped(i)) {
                EXPECT_NEAR(raw.dirt[i], alpha == 255 ? 1 - shut : 1, 1e-3) << alpha;
            }
    }
}

TEST_F(DirtTest, LuxelsInThePlaneOfAWallSeeAwayFromIt) {
    // Rays along the wall and away from it are free, the others end at once.
    SceneBuilder scene = EmptyRoom();
    AddFloor(scene);
    SurfaceCase c(scene, folder, Dirty());
    SurfaceLight surfaces = c.Mapped();
    RawLightmap &raw = surfaces.lightmaps[std::size_t(surfaces.lightmapOf[std::size_t(SurfacesOf(c, kDirtFloor)[0])])];
    raw.width = raw.height = raw.super = 1;
    raw.positions = {{1024, 0, 1}};
    raw.normals = {{0, 0, 1}};
    raw.luxelClusters = {0};
    DirtLuxels(c.Inputs(), surfaces);
    EXPECT_NEAR(raw.dirt[0], 1 - 3 * 7 / 49.0, 1e-3);
}

TEST_F(FloodTest, OffWithoutTheOption) {
    SurfaceCase c(Room(), folder);
    SurfaceLight surfaces = c.Mapped();
    FloodLuxels(c.Inputs(), surfaces);
    for (const RawLightmap &raw : surfaces.lightmaps)
        EXPECT_TRUE(raw.floodlight.empty());
}

TEST_F(FloodTest, WorldsByOpenness) {
    boxes = {{{-60.3f, -50.1f, 4.7f}, {-31.1f, -22.9f, 41.3f}}};
    SceneBuilder scene = Room();
    scene.SetWorldKey("_floodlight", "2 1 0.5 200 80 0.25");
    SurfaceCase c(scene, folder);
    SurfaceLight surfaces = c.Mapped();
    FloodLuxels(c.Inputs(), surfaces);
    const RawLightmap &raw = LightmapOf(c, surfaces, kDirtFloor);
    EXPECT_EQ(raw.floodDirectionScale, 0.25f);
    int mapped = 0;
    for (std::size_t i = 0; i < raw.luxelClusters.size(); ++i)
        if (raw.Mapped(i)) {
            const double open = 1 - Shut(Vec3d(raw.positions[i]), 4, 22, 200, false);
            EXPECT_NEAR(raw.floodlight[i].x, 80 * open, 0.1);
            EXPECT_NEAR(raw.floodlight[i].z, 20 * open, 0.1);
            ++mapped;
        }
    EXPECT_GT(mapped, 80);
}

TEST_F(FloodTest, ShadersAddTheirOwn) {
    SceneBuilder scene = EmptyRoom();
    AddFloor(scene);
    CaseSettings settings;
    settings.script = "textures/test/floor\n{\nq3map_floodLight 0 1 0 500 30 0.5\n}\n";
    for (const bool world : {false, true}) {
        settings.light.floodlight = world;
        SurfaceCase c(scene, folder, settings);
        SurfaceLight surfaces = c.Mapped();
        FloodLuxels(c.Inputs(), surfaces);
        const RawLightmap &raw = LightmapOf(c, surfaces, kDirtFloor);
        const auto open = std::size_t(
            std::find_if(raw.luxelClusters.begin(), raw.luxelClusters.end(), [](int c0) { return c0 >= 0; }) -
            raw.luxelClusters.begin());
        ASSERT_LT(open, raw.luxelClusters.size());
        EXPECT_EQ(raw.floodDirectionScale, 0.5f);
        // Walls are 1024 away and more; the world's light reaches 1024.
        EXPECT_NEAR(raw.floodlight[open].y - raw.floodlight[open].x, 30, 1e-3);
        EXPECT_EQ(raw.floodlight[open].x > 100, world);
        EXPECT_TRUE(LightmapOf(c, surfaces, kDirtFloor).floodlight.size() == raw.luxelClusters.size());
    }
}

TEST_F(FloodTest, LowQualityIsNearToTheWholeOne) {
    CaseSettings settings;
    settings.light.floodlight = true;
    std::array<Vec3f, 2> mean;
    for (const bool low : {false, true}) {
        settings.light.lowQuality = low;
        SurfaceCase c(Room(), folder, settings);
        SurfaceLight surfaces = c.Mapped();
        FloodLuxels(c.Inputs(), surfaces);
        const RawLightmap &raw = LightmapOf(c, surfaces, kDirtFloor);
        for (const Vec3f &light : raw.floodlight)
            mean[low ? 1 : 0] += light / float(raw.floodlight.size());
    }
    EXPECT_GT(mean[0].x, 5);
    EXPECT_NEAR(mean[1].x, mean[0].x, 0.05f * mean[0].x);
}

} // namespace

} // namespace q3::test
