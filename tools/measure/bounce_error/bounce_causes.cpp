// GPL-2.0-or-later. Causes of the error of baked bounced light; a check of the reference's direct light.
#include "tools/measure/bounce_error/bounce_causes.h"

#include "q3map2/lightmap/bounce/bounce_scene.h"

#include <algorithm>
#include <cmath>

namespace q3::bounce {

namespace {

/// Texels on a side of the image that the bake averages a texture down to.
constexpr int kCoarseSide = 16;
/// Length of the rays from luxels down to their surfaces, which are 1 unit away unless a shader says otherwise. Game
/// units.
constexpr float kSurfaceRayLength = 4;
/// Lights that DirectCheckText samples at each point.
constexpr int kLightSamples = 64;

std::size_t LuxelAt(const RawLightmap &raw, const PathHit &hit) {
    const int x = std::clamp(int(hit.luxel[0]), 0, raw.SuperWidth() - 1);
    const int y = std::clamp(int(hit.luxel[1]), 0, raw.SuperHeight() - 1);
    return raw.SuperIndex(x, y);
}

/// The luxel at a hit; raw is null on surfaces that are lit at their vertices.
struct HitLuxel {
    const RawLightmap *raw = nullptr;
    std::size_t luxel = 0;
    Vec3f light; ///< baked direct light
};

HitLuxel LuxelOf(const CauseInputs &inputs, const PathHit &hit) {
    const int lightmap = inputs.surfaces.lightmapOf[std::size_t(hit.surface)];
    if (lightmap < 0)
        return {};
    const RawLightmap &raw = inputs.surfaces.lightmaps[std::size_t(lightmap)];
    const std::size_t luxel = LuxelAt(raw, hit);
    return {&raw, luxel, Max(inputs.direct.light[std::size_t(lightmap)][luxel], Vec3f{})};
}

/// Coarse reflectance at the center of a luxel: where a ray from its position meets the surface, else at `hit`.
Vec3f ReflectanceOfLuxel(const CauseInputs &inputs, const HitLuxel &at, const PathHit &hit) {
    if (!at.raw->Mapped(at.luxel))
        return inputs.tracer.Scene().MeanReflectanceAt(std::size_t(hit.surface), hit.st, kCoarseSide);
    RayPacket rays;
    rays.Set(0, at.raw->positions[at.luxel], -at.raw->normals[at.luxel], kSurfaceRayLength);
    PathScene::Hits hits;
    inputs.tracer.Scene().FirstHits(rays, hits);
    const PathHit &center = hits[0] ? *hits[0] : hit;
    return inputs.tracer.Scene().MeanReflectanceAt(std::size_t(center.surface), center.st, kCoarseSide);
}

/// Sets BounceSteps::atTexels and coarse for a surface with that normal: means over rays, which start at each of
/// `places` in turn.
BounceSteps StepsAt(const CauseInputs &inputs, std::span<const Vec3f> places, const Vec3f &normal, int rayCount,
                    std::uint64_t seed) {
    Vec3d atTexels, coarse;
    for (int first = 0; first < rayCount; first += int(kPacketSize)) {
        RayPacket rays;
        for (std::size_t i = 0; i < kPacketSize; ++i)
            rays.Set(i, places[(std::size_t(first) + i) % places.size()],
                     CosineDirection(normal, PlasticSample(std::uint32_t(first) + std::uint32_t(i), seed)), kRayLength);
        PathScene::Hits hits;
        inputs.tracer.Scene().FirstHits(rays, hits);
        for (const auto &hit : hits) {
            Vec3f light, mean;
            if (hit) {
                if (const HitLuxel at = LuxelOf(inputs, *hit); at.raw) {
                    light = at.light * hit->reflectance;
                    mean = at.light * ReflectanceOfLuxel(inputs, at, *hit);
                } else {
                    RayCounts counts;
                    light = mean = inputs.lights.At(inputs.tracer.ReceiverAt(*hit), counts) * hit->reflectance;
                }
            }
            atTexels += Vec3d(light), coarse += Vec3d(mean);
        }
    }
    const double count = double((rayCount + int(kPacketSize) - 1) / int(kPacketSize)) * double(kPacketSize);
    BounceSteps steps;
    steps.atTexels = Vec3f(atTexels / count), steps.coarse = Vec3f(coarse / count);
    return steps;
}

/// Mean and RMS of differences over channels.
struct DifferenceSum {
    double sum = 0, squares = 0, count = 0;
    void Add(const Vec3f &difference) {
        for (const float d : {difference.x, difference.y, difference.z})
            sum += double(d), squares += double(d) * double(d), count += 1;
    }
    std::string Text() const {
        return fmt::format("mean {:+.4f}, RMS {:.4f}", sum / std::max(1.0, count),
                           std::sqrt(squares / std::max(1.0, count)));
    }
};

/// Sets `window` to the mean of `coarse` over the window of the bake's filter, if it is complete.
void StepOverWindow(const CauseInputs &inputs, const LuxelReceiver &receiver, int rays, std::uint64_t seed,
                    BounceSteps &step) {
    constexpr int kReach = 2;          // luxels on each side of the center, as in the bake's filter
    constexpr float kMinCosine = 0.9f; // between normals of the window, chosen: 26 degrees
    const RawLightmap &raw = inputs.surfaces.lightmaps[receiver.lightmap];
    const int x = int(receiver.luxel) % raw.SuperWidth(), y = int(receiver.luxel) / raw.SuperWidth();
    if (x < kReach || y < kReach || x + kReach >= raw.SuperWidth() || y + kReach >= raw.SuperHeight())
        return;
    std::vector<std::size_t> luxels;
    for (int oy = y - kReach; oy <= y + kReach; ++oy)
        for (int ox = x - kReach; ox <= x + kReach; ++ox) {
            const std::size_t luxel = raw.SuperIndex(ox, oy);
            if (!raw.Mapped(luxel) || Dot(raw.normals[luxel], receiver.normal) < kMinCosine)
                return;
            luxels.push_back(luxel);
        }
    for (const std::size_t luxel : luxels) {
        const std::vector<Vec3f> places = PlacesOf(inputs.in, inputs.tracer.Scene(), raw, luxel);
        if (places.empty())
            return;
        const BounceSteps neighbor = StepsAt(inputs, places, raw.normals[luxel], rays, HashIndex(seed) + luxel);
        step.window += neighbor.coarse / float(luxels.size());
    }
    step.complete = true;
}

} // namespace

std::vector<BounceSteps> StepsOfFirstBounce(const CauseInputs &inputs, int rays) {
    constexpr int kWindowRayDivisor = 8; // each of the 25 luxels of a window gets an eighth of the rays
    std::vector<BounceSteps> steps(inputs.receivers.luxels.size());
    inputs.in.jobs.For(std::int64_t(steps.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        const LuxelReceiver &luxel = inputs.receivers.luxels[i];
        steps[i] = StepsAt(inputs, luxel.places, luxel.normal, rays, i);
        StepOverWindow(inputs, luxel, rays / kWindowRayDivisor, i, steps[i]);
    });
    return steps;
}

std::string CausesText(const CauseInputs &inputs, std::span<const ComparedLight> light, int rays) {
    const std::vector<BounceSteps> steps = StepsOfFirstBounce(inputs, rays);
    DifferenceSum all, noiseOfTruth, texels, coarse, rest, window, noise, rim, beside;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const BounceSteps &step = steps[i];
        all.Add(light[i].bounced - light[i].traced), noiseOfTruth.Add(light[i].tracedError);
        texels.Add(step.atTexels - light[i].traced), coarse.Add(step.coarse - step.atTexels);
        rest.Add(light[i].bounced - step.coarse);
        if (inputs.receivers.luxels[i].places.size() > 1)
            beside.Add(light[i].bounced - step.coarse);
        else if (step.complete)
            window.Add(step.window - step.coarse), noise.Add(light[i].bounced - step.window);
        else
            rim.Add(light[i].bounced - step.coarse);
    }
    const auto line = [&](std::string_view what, const DifferenceSum &sum) {
        return fmt::format("  {}: {}; {:.0f} % of luxels, squares {:.3f} of all\n", what, sum.Text(),
                           100 * sum.count / std::max(1.0, all.count), sum.squares / all.squares);
    };
    return "first bounce, bytes, not cut:\n" + line("baked - traced", all) +
           line("noise of the reference", noiseOfTruth) +
           line("emission of the luxel in place of the point that is hit", texels) +
           line("reflectance of the luxel's center, 16 x 16 texels", coarse) +
           line("few rays, and the noise filter over 5 x 5 luxels", rest) +
           line("  of this in complete windows: mean over the window", window) + line("  ... few rays", noise) +
           line("  ... at the rims of lightmaps and curves", rim) +
           line("  ... luxels at the edge of a wall, whose position is not clear", beside);
}

std::string SurroundingsText(const CauseInputs &inputs, const LuxelReceiver &luxel) {
    constexpr float kMargin = 0.25f; // game units
    const Vec3f margin{kMargin, kMargin, kMargin};
    const bool solid = inputs.in.space.AnySolid(luxel.position - margin, luxel.position + margin);
    std::string text = solid ? "in a solid or beside it" : "clear of solids";
    for (const float distance : {2.0f, 16.0f}) {
        int ended = 0, reflecting = 0;
        constexpr int kRays = 512;
        for (int first = 0; first < kRays; first += int(kPacketSize)) {
            RayPacket rays;
            for (std::size_t i = 0; i < kPacketSize; ++i)
                rays.Set(i, luxel.position,
                         CosineDirection(luxel.normal, PlasticSample(std::uint32_t(first) + std::uint32_t(i), 0)),
                         distance);
            PathScene::Hits hits;
            LaneMask met{};
            inputs.tracer.Scene().FirstHits(rays, hits, &met);
            ended += met.Count();
            reflecting += int(std::count_if(hits.begin(), hits.end(), [](const auto &hit) { return hit.has_value(); }));
        }
        text += fmt::format(", {:.0f} % of rays end within {:.0f} units, {:.0f} % reflect", 100.0 * ended / kRays,
                            distance, 100.0 * reflecting / kRays);
    }
    return text;
}

std::string DirectCheckText(const CauseInputs &inputs) {
    const std::size_t count = inputs.receivers.luxels.size();
    /// Direct light of the reference for one luxel.
    struct Found {
        Vec3f own;        ///< at the luxel's position
        bool hit = false; ///< whether a ray from there down meets the luxel's surface
        Vec3f atHit;      ///< at that hit
        Vec3f sampled;    ///< at that hit, from sampled lights
    };
    std::vector<Found> found(count);
    inputs.in.jobs.For(std::int64_t(count), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        const LuxelReceiver &luxel = inputs.receivers.luxels[i];
        const RawLightmap &raw = inputs.surfaces.lightmaps[luxel.lightmap];
        RayCounts counts;
        const SurfacePoint own{luxel.position, luxel.normal, raw.luxelClusters[luxel.luxel], raw.twoSided,
                               raw.receiveShadows};
        found[i].own = inputs.lights.At(own, counts) + raw.ambient;
        RayPacket rays;
        rays.Set(0, luxel.position, -luxel.normal, kSurfaceRayLength);
        PathScene::Hits hits;
        inputs.tracer.Scene().FirstHits(rays, hits);
        found[i].hit = hits[0] && inputs.surfaces.lightmapOf[std::size_t(hits[0]->surface)] == int(luxel.lightmap);
        if (!found[i].hit)
            return;
        const SurfacePoint at = inputs.tracer.ReceiverAt(*hits[0]);
        found[i].atHit = inputs.lights.At(at, counts) + raw.ambient;
        PathRandom random(i);
        Vec3f sum;
        for (int sample = 0; sample < kLightSamples; ++sample)
            if (const UnshadowedLight one = inputs.lights.Sample(at, random); one.light)
                sum += ArrivingLight(inputs.in.scene, one, at, counts);
        found[i].sampled = sum / float(kLightSamples) + raw.ambient;
    });
    DifferenceSum own, atHit, sampled, light;
    for (std::size_t i = 0; i < count; ++i) {
        const LuxelReceiver &luxel = inputs.receivers.luxels[i];
        const Vec3f baked = Max(inputs.direct.light[luxel.lightmap][luxel.luxel], Vec3f{});
        light.Add(baked), own.Add(found[i].own - baked);
        if (found[i].hit)
            atHit.Add(found[i].atHit - baked), sampled.Add(found[i].sampled - found[i].atHit);
    }
    constexpr int kChannels = 3; // DifferenceSum::count counts each of them
    return fmt::format(
        "direct light of {} luxels, bytes, not cut: {}\n  evaluated at their positions - baked: {}\n"
        "  evaluated at {:.0f} hits beneath them - baked: {}\n  {} sampled lights - all lights there: {}\n",
        count, light.Text(), own.Text(), atHit.count / kChannels, atHit.Text(), kLightSamples, sampled.Text());
}

} // namespace q3::bounce
