// GPL-2.0-or-later. Rays in packets, and the falloff of light.
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/transfer/light_contribution.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace q3 {
namespace {

TEST(RayBatcherTest, EveryRayIsTracedOnceAndItsTagGetsItsResult) {
    constexpr int kRays = 2 * int(kPacketSize) + 3;
    std::vector<std::size_t> packets;
    std::vector<float> found(kRays, -1);
    auto rays = MakeRayBatcher<int>([&](RayPacket &packet, std::span<const int> tags) {
        packets.push_back(tags.size());
        EXPECT_EQ(packet.live.Count(), int(tags.size()));
        for (std::size_t i = 0; i < tags.size(); ++i)
            found[std::size_t(tags[i])] = packet.origin[i].x + packet.distance[i];
        packet.live = {}; // as if all were blocked
    });
    for (int i = 0; i < kRays; ++i)
        rays.Aim(i, {float(i), 0, 0}, {float(i), 0, 100});
    rays.Flush();
    rays.Flush();
    EXPECT_EQ(packets, (std::vector<std::size_t>{kPacketSize, kPacketSize, 3}));
    for (int i = 0; i < kRays; ++i)
        EXPECT_EQ(found[std::size_t(i)], float(i + 100));
}

TEST(FalloffTest, InverseSquareFromSixteenUnitsOn) {
    Light light;
    light.photons = 40000;
    EXPECT_FLOAT_EQ(Falloff(light).At(100), 4);
    EXPECT_FLOAT_EQ(Falloff(light).At(100, 0.5f), 2);
    EXPECT_FLOAT_EQ(Falloff(light).At(3), 40000.0f / 256);
    EXPECT_FLOAT_EQ(Falloff(light).Reach(4), 100);
    EXPECT_FLOAT_EQ(Falloff(light).Reach(0), kSunDistance);
    light.extraDist = 300;
    EXPECT_FLOAT_EQ(Falloff(light).At(400), 40000.0f / (500 * 500));
}

TEST(FalloffTest, TheAngleDoesNotWeakenTheFadeOfLinearLights) {
    Light light;
    light.photons = 8000 * 300, light.curve = FalloffCurve::Linear, light.fade = 2;
    EXPECT_FLOAT_EQ(Falloff(light).At(100), 300 - 200);
    EXPECT_NEAR(Falloff(light).At(100, 0.75f), 225 - 200, 1e-4);
    EXPECT_FLOAT_EQ(Falloff(light).Reach(0), 150);
    EXPECT_FLOAT_EQ(Falloff(light).Reach(20), 140);
}

TEST(FaintLightsTest, ChosenOnesStandForAllLight) {
    float residual = 0, sum = 0;
    int chosen = 0;
    for (int i = 0; i < 100; ++i) {
        float weight = 1;
        if (!SelectFaintLight(1, 0.125f, residual, weight))
            continue;
        ++chosen;
        sum += 0.125f * weight;
    }
    EXPECT_EQ(chosen, 12);
    EXPECT_FLOAT_EQ(sum + residual, 100 * 0.125f);
    float weight = 1;
    EXPECT_TRUE(SelectFaintLight(1, 5, residual, weight));
    EXPECT_EQ(weight, 1);
}

TEST(LightsByClusterTest, GivesTheLightsThatAnyOfTheClustersSees) {
    std::vector<Light> lights(70);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lights[i].seenFrom.assign(4, false);
        lights[i].seenFrom[i % 3] = true;
    }
    lights[5].seenFrom.clear(); // everywhere
    lights[66].type = LightType::Sun;
    const auto seen = [&](SunsSeen suns, std::vector<int> clusters) {
        std::set<std::size_t> numbers;
        const std::size_t left = LightsByCluster(lights, suns).ForEach(clusters, [&](std::size_t i) {
            EXPECT_TRUE(numbers.empty() || *numbers.rbegin() < i) << "in order";
            numbers.insert(i);
        });
        EXPECT_EQ(left + numbers.size(), lights.size());
        return numbers;
    };
    for (const SunsSeen suns : {SunsSeen::ByVisibility, SunsSeen::Everywhere}) {
        const auto found = seen(suns, {1, -1, 3, 99});
        for (std::size_t i = 0; i < lights.size(); ++i)
            EXPECT_EQ(found.count(i), std::size_t(i % 3 == 1 || i == 5 || (i == 66 && suns == SunsSeen::Everywhere)))
                << i;
    }
}

} // namespace
} // namespace q3
