// GPL-2.0-or-later. Keys of units of light, and the hull of two boxes.
#include "q3map2/light/sources/light_units.h"

#include <gmock/gmock.h>

#include <random>

namespace q3::test {

namespace {

Boundsf Box(const Vec3f &mins, const Vec3f &maxs) {
    Boundsf box;
    box.Add(mins);
    box.Add(maxs);
    return box;
}

bool Overlap(const Boundsf &a, const Boundsf &b) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (a.mins[axis] > b.maxs[axis] || a.maxs[axis] < b.mins[axis])
            return false;
    return true;
}

TEST(HullMeets, AgreesWithManyBoxesBetweenTheTwo) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> place(-100, 100), size(0, 60);
    int meets = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto box = [&] {
            const Vec3f at{place(random), place(random), place(random)};
            return Box(at, at + Vec3f{size(random), size(random), size(random)});
        };
        const Boundsf a = box(), b = box(), c = box();
        bool found = false;
        for (int step = 0; step <= 4000 && !found; ++step) {
            const float t = float(step) / 4000;
            found = Overlap(Box(a.mins * (1 - t) + b.mins * t, a.maxs * (1 - t) + b.maxs * t), c);
        }
        meets += found ? 1 : 0;
        if (found) {
            EXPECT_TRUE(HullMeets(a, b, c)) << i;
        }
        // The steps between boxes are at most 0.06 units.
        const Vec3f less{0.1f, 0.1f, 0.1f};
        if (!found && c.maxs.x - c.mins.x > 0.2f && c.maxs.y - c.mins.y > 0.2f && c.maxs.z - c.mins.z > 0.2f) {
            EXPECT_FALSE(HullMeets(a, b, Box(c.mins + less, c.maxs - less))) << i;
        }
    }
    EXPECT_GT(meets, 50);
}

/// Two receivers in clusters, one light.
struct Scene {
    std::vector<Light> lights = std::vector<Light>(1);
    ReceiverBatch receivers;
    UnitStore units{UnitStore::Purpose::Cache};

    Scene(int firstCluster, int secondCluster, std::vector<bool> seenFrom) {
        lights[0].origin = {0, 0, 100};
        lights[0].seenFrom = std::move(seenFrom);
        receivers.Add({0, 0, 0}, {0, 0, 0}, firstCluster, 5);
        receivers.Add({10, 0, 0}, {10, 0, 0}, secondCluster, 6);
    }
    LightUnitKey Key() const {
        const LightHashes hashes(lights, &units);
        LightUnitKey key("test", hashes, units);
        key.AddReceivers(std::span<const ReceiverBatch>(&receivers, 1));
        key.AddLight(lights[0]);
        return key;
    }
};

TEST(LightUnitKey, NumbersOfClustersDoNotCountButWhoSeesTheLight) {
    const Hash128 key = Scene(0, 1, {true, false, false}).Key().Key();
    EXPECT_EQ(Scene(2, 1, {false, false, true}).Key().Key(), key);
    EXPECT_NE(Scene(0, 1, {true, true, false}).Key().Key(), key);
}

TEST(LightUnitKey, LightsAndReceiversCount) {
    const Scene scene(0, 0, {});
    Scene moved(0, 0, {});
    moved.lights[0].origin.x += 1;
    EXPECT_NE(moved.Key().Key(), scene.Key().Key());
    Scene brighter(0, 0, {});
    brighter.lights[0].photons += 1;
    EXPECT_NE(brighter.Key().Key(), scene.Key().Key());
    Scene named(0, 0, {});
    named.lights[0].name = "lamp", named.lights[0].entity = 7;
    EXPECT_EQ(named.Key().Key(), scene.Key().Key()) << "a name gives no light";
}

TEST(LightUnitKey, IsTouchedByWhatChangedBetweenLightAndReceivers) {
    Scene scene(0, 0, {});
    EXPECT_FALSE(scene.Key().IsTouched());
    scene.units.changedBoxes = {Box({2, -5, 50}, {4, 5, 52})};
    EXPECT_TRUE(scene.Key().IsTouched());
    scene.units.changedBoxes = {Box({40, -5, 50}, {44, 5, 52}), Box({-10, -10, 120}, {10, 10, 130})};
    EXPECT_FALSE(scene.Key().IsTouched()) << "beside, and behind the light";
    scene.lights[0].type = LightType::Sun;
    scene.lights[0].normal = {0, 0, -1};
    EXPECT_TRUE(scene.Key().IsTouched()) << "rays to suns go on";
}

} // namespace

} // namespace q3::test
