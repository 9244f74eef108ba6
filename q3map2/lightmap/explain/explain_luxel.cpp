// GPL-2.0-or-later. The luxel nearest to a point: where it is lit, its samples and its lights.
#include "q3map2/lightmap/explain/explain_luxel.h"

#include "q3map2/lightmap/ao/luxel_occlusion.h"
#include "q3map2/lightmap/direct/lightmap_average.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "q3map2/lightmap/direct/luxel_samples.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"
#include "q3map2/lightmap/raw/luxel_map.h"
#include "q3map2/lightmap/raw/luxel_normal.h"
#include "q3map2/lightmap/raw/luxel_position.h"
#include "q3map2/lightmap/raw/luxel_raster.h"
#include "q3map2/lightmap/raw/macro_texture.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

constexpr float kBehind = 0.25f; ///< points this far behind a surface still count as in front. Game units

/// Point of the triangle a b c nearest to p, as weights of its corners: clamped to each edge where p projects beside.
Vec3f NearestWeights(const Vec3f &p, const Vec3f &a, const Vec3f &b, const Vec3f &c) {
    const Vec3f ab = b - a, ac = c - a, normal = Cross(ab, ac);
    const float area2 = Dot(normal, normal);
    if (!(area2 > 0))
        return {1, 0, 0};
    const float v = Dot(Cross(p - a, ac), normal) / area2, w = Dot(Cross(ab, p - a), normal) / area2;
    if (v >= 0 && w >= 0 && v + w <= 1)
        return {1 - v - w, v, w};
    const std::array<Vec3f, 3> corners{a, b, c};
    Vec3f best;
    float least = -1;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3f from = corners[i], edge = corners[(i + 1) % 3] - from;
        const float length2 = Dot(edge, edge);
        const float t = length2 > 0 ? std::clamp(Dot(p - from, edge) / length2, 0.0f, 1.0f) : 0;
        const Vec3f off = from + edge * t - p;
        if (const float d = Dot(off, off); least < 0 || d < least) {
            least = d;
            best = {};
            best[i] = 1 - t, best[(i + 1) % 3] = t;
        }
    }
    return best;
}

std::array<float, 2> Blended(const std::array<std::array<float, 2>, 3> &corners, const Vec3f &weights) {
    std::array<float, 2> sum{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t axis = 0; axis < 2; ++axis)
            sum[axis] += corners[i][axis] * weights[i];
    return sum;
}

} // namespace

/// A place on a surface with a lightmap.
struct LuxelExplainer::Spot {
    int surface = -1;
    std::size_t lightmap = 0;
    float distance = kLuxelReach;
    Vec3f at, normal;                                       ///< on the surface; of the triangle
    std::array<Vec3f, 3> corners{};                         ///< of the triangle
    std::array<std::array<float, 2>, 3> luxels{}, texels{}; ///< of the corners: super grid; page, 0 to 1
    std::array<float, 2> luxel{};

    /// World position of super grid coordinates, by the triangle.
    Vec3f OnSurface(float x, float y) const {
        SurfaceVertex v[3];
        for (std::size_t i = 0; i < 3; ++i)
            v[i].xyz = corners[i], v[i].luxel = luxels[i];
        const LuxelSteps steps = LuxelStepsOf(v[0], v[1], v[2]);
        return at + steps[0] * (x - luxel[0]) + steps[1] * (y - luxel[1]);
    }
};

LuxelExplainer::LuxelExplainer(const SurfaceInputs &in, const LightSetup &setup, const MapSource &source,
                               const ObstacleFinder &obstacles)
    : in_(in), obstacles_(obstacles), explainer_(setup, source, obstacles),
      lights_(PrepareLights(setup, LightPass::Surfaces, in.lightmap.fastPoint)), surfaces_(SetupSurfaceLight(in)) {
    int culled = 0;
    passLights_ = SetupEnvelopes(setup.lights, LightPass::Surfaces, setup.options, setup.space, setup.skySeenFrom,
                                 culled, in.lightmap.fastPoint);
    surfaces_.styled = std::ranges::any_of(setup.lights, [](const Light &light) { return light.style != 0; });
    if (in.lightmap.shade)
        SmoothNormals(in, surfaces_);
}

std::optional<LuxelExplainer::Spot> LuxelExplainer::FindSpot(const Vec3f &p) const {
    std::optional<Spot> best;
    for (std::size_t i = 0; i < in_.bsp.drawSurfaces.size(); ++i) {
        if (surfaces_.lightmapOf[i] < 0 || surfaces_.bounds[i].Distance(p) > (best ? best->distance : kLuxelReach))
            continue;
        const auto lightmap = std::size_t(surfaces_.lightmapOf[i]);
        for (const Face &face : FacesOf(in_, surfaces_, i))
            for (std::size_t k = 2; k < face.size(); ++k) {
                const std::array<const FaceCorner *, 3> c{&face[0], &face[k - 1], &face[k]};
                const Vec3f normal = Normalize(Cross(c[2]->xyz - c[0]->xyz, c[1]->xyz - c[0]->xyz));
                const float height = Dot(p - c[0]->xyz, normal);
                if (height < -kBehind && !surfaces_.lightmaps[lightmap].twoSided)
                    continue;
                const Vec3f weights = NearestWeights(p, c[0]->xyz, c[1]->xyz, c[2]->xyz);
                const Vec3f at = c[0]->xyz * weights.x + c[1]->xyz * weights.y + c[2]->xyz * weights.z;
                const float distance = Length(at - p);
                if (distance >= (best ? best->distance : kLuxelReach))
                    continue;
                best.emplace();
                best->surface = int(i), best->lightmap = lightmap, best->distance = distance;
                best->at = at, best->normal = normal;
                for (std::size_t n = 0; n < 3; ++n) {
                    best->corners[n] = c[n]->xyz, best->luxels[n] = c[n]->luxel;
                    best->texels[n] = in_.bsp.drawVerts[std::size_t(c[n]->vertex)].lightmap[0];
                }
                best->luxel = Blended(best->luxels, weights);
            }
    }
    return best;
}

std::vector<SurfaceTriangle> LuxelExplainer::Triangles() const {
    std::vector<SurfaceTriangle> triangles;
    for (std::size_t i = 0; i < in_.bsp.drawSurfaces.size(); ++i) {
        if (surfaces_.lightmapOf[i] < 0)
            continue;
        for (const Face &face : FacesOf(in_, surfaces_, i))
            for (std::size_t k = 2; k < face.size(); ++k) {
                const Vec3f &a = face[0].xyz, &b = face[k - 1].xyz, &c = face[k].xyz;
                triangles.push_back({{a, b, c}, Normalize(Cross(c - a, b - a))});
            }
    }
    return triangles;
}

/// The raw lightmap of the spot alone, mapped, with dirt and floodlight.
SurfaceLight LuxelExplainer::OneLightmap(const Spot &spot) const {
    SurfaceLight one;
    one.verts = surfaces_.verts, one.bounds = surfaces_.bounds, one.clusters = surfaces_.clusters;
    one.styled = surfaces_.styled;
    for (const int lightmap : surfaces_.lightmapOf)
        one.lightmapOf.push_back(lightmap == int(spot.lightmap) ? 0 : -1);
    one.lightmaps.push_back(surfaces_.lightmaps[spot.lightmap]);
    MapLuxels(in_, one);
    FindTangents(in_, one);
    FindTints(in_, one);
    if (in_.lightmap.dirty)
        DirtLuxels(in_, one);
    FloodLuxels(in_, one);
    return one;
}

void LuxelExplainer::AddPage(const Spot &spot, LuxelAccount &account) const {
    const bspDrawSurface_t &surface = in_.bsp.drawSurfaces[std::size_t(spot.surface)];
    account.page = surface.lightmapNum[0];
    if (account.page < 0)
        return;
    const RawLightmap &raw = surfaces_.lightmaps[spot.lightmap];
    // The texel whose center is nearest to that of the luxel, by the coordinates of the triangle.
    const float super = float(raw.super);
    const auto center = [&](std::size_t axis) { return (std::floor(spot.luxel[axis] / super) + 0.5f) * super; };
    const float x = center(0) - spot.luxels[0][0], y = center(1) - spot.luxels[0][1];
    const auto edge = [&](std::size_t corner, std::size_t axis) {
        return spot.luxels[corner][axis] - spot.luxels[0][axis];
    };
    const float area = edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0);
    const float v = area != 0 ? (x * edge(2, 1) - y * edge(2, 0)) / area : 0;
    const float w = area != 0 ? (edge(1, 0) * y - edge(1, 1) * x) / area : 0;
    const std::array<float, 2> at = Blended(spot.texels, {1 - v - w, v, w});
    const int side = in_.bsp.lightmapSide;
    for (std::size_t axis = 0; axis < 2; ++axis)
        account.texel[axis] = LuxelOf(at[axis] * float(side), side);
    const std::size_t offset = std::size_t(account.page) * LightmapPageBytes(side) +
                               3 * (std::size_t(account.texel[1]) * std::size_t(side) + std::size_t(account.texel[0]));
    if (offset + 3 <= in_.bsp.lightmaps.size())
        account.stored = {in_.bsp.lightmaps[offset], in_.bsp.lightmaps[offset + 1], in_.bsp.lightmaps[offset + 2]};
}

/// What keeps a position from being lit: what it is in, or what is between it and the surface.
std::optional<Obstacle> LuxelExplainer::WhyNotLit(const Vec3f &from, const Vec3f &wanted) const {
    if (auto solid = obstacles_.SolidAt(wanted))
        return solid;
    const Vec3f offset = wanted - from;
    const float length = Length(offset);
    if (!(length > 0))
        return {};
    const ShadowRay one{offset / length, length};
    const std::vector<Obstacle> between = obstacles_.Blocking(from, {&one, 1}, {});
    return between.empty() ? std::optional<Obstacle>() : between.front();
}

void LuxelExplainer::AddSamples(const Spot &spot, const RawLightmap &raw, LuxelAccount &account,
                                std::vector<LuxelReceiver> &receivers, std::vector<std::size_t> &sampleOf) const {
    LuxelBlocks blocks;
    blocks.Build(raw);
    LuxelSampler sampler;
    sampler.Start(in_, raw, blocks, LuxelPassOf(in_, {}, raw));
    const int left = LuxelOf(spot.luxel[0] / float(raw.super), raw.width) * raw.super;
    const int top = LuxelOf(spot.luxel[1] / float(raw.super), raw.height) * raw.super;
    const auto light = [&](const Vec3f &position, std::size_t luxel, int cluster, bool inMean) {
        sampleOf.push_back(account.samples.size());
        receivers.push_back({position, raw.normals[luxel], cluster, inMean});
    };
    for (int y = top; y < top + raw.super; ++y)
        for (int x = left; x < left + raw.super; ++x) {
            const std::size_t luxel = raw.SuperIndex(x, y);
            SampleAccount center;
            center.wanted = spot.OnSurface(float(x) + 0.5f, float(y) + 0.5f);
            if (raw.Mapped(luxel)) {
                center.position = raw.positions[luxel];
                light(*center.position, luxel, raw.luxelClusters[luxel], true);
            } else
                center.solid = WhyNotLit(spot.at + spot.normal, center.wanted + spot.normal);
            account.samples.push_back(center);
            for (const LuxelSampler::SamplePlace &place : sampler.FirstSamples(x, y)) {
                SampleAccount sample;
                sample.kind = SampleKind::Sample, sample.wanted = place.position;
                if (place.cluster >= 0) {
                    sample.position = place.position;
                    light(place.position, luxel, place.cluster, false);
                } else
                    sample.solid = WhyNotLit(raw.positions[luxel], place.position);
                account.samples.push_back(sample);
            }
        }
    account.fromNeighbors = std::ranges::none_of(
        account.samples, [](const SampleAccount &s) { return s.kind == SampleKind::Center && s.position.has_value(); });
}

/// Lights the lightmap as the first pass does.
void LuxelExplainer::AddLight(SurfaceLight &surfaces, const Spot &spot, LuxelAccount &account) const {
    RawLightmap &raw = surfaces.lightmaps.front();
    const int x = LuxelOf(spot.luxel[0] / float(raw.super), raw.width);
    const int y = LuxelOf(spot.luxel[1] / float(raw.super), raw.height);
    if (!raw.dirt.empty())
        account.dirt = LuxelMeans(raw, 1.0f, [&](std::size_t at) { return raw.dirt[at]; })[raw.Index(x, y)];
    account.ambient = raw.ambient;
    ContributionCounts counts;
    LightLuxels(in_, passLights_, {}, surfaces, counts);
    RawLightmap filled = raw;
    FillWallLuxels(in_.space, filled);
    for (int sy = y * raw.super; sy < (y + 1) * raw.super; ++sy)
        for (int sx = x * raw.super; sx < (x + 1) * raw.super; ++sx)
            if (const std::size_t at = raw.SuperIndex(sx, sy); !raw.light[0].empty())
                account.isInWall =
                    account.isInWall || (!in_.lightmap.dark && !(filled.light[0][at] == raw.light[0][at]));
    FinishLuxels(in_, {}, surfaces);
    AverageLuxels(in_, {}, PassData::Keep, surfaces);
    const std::size_t at = raw.Index(x, y);
    if (at < raw.result[0].size() && raw.result[0][at].x >= 0)
        account.direct = raw.result[0][at];
}

std::optional<LuxelAccount> LuxelExplainer::NearestTo(const Vec3f &p) const {
    const std::optional<Spot> spot = FindSpot(p);
    if (!spot)
        return {};
    SurfaceLight surfaces = OneLightmap(*spot);
    const RawLightmap &raw = surfaces.lightmaps.front();
    LuxelAccount account;
    account.surface = spot->surface;
    account.shader = obstacles_.ShaderOf(spot->surface);
    account.normal = spot->normal, account.distance = spot->distance;
    account.source = obstacles_.OfSurface(spot->surface, spot->at, spot->normal);
    const float super = float(raw.super);
    account.center = spot->OnSurface((std::floor(spot->luxel[0] / super) + 0.5f) * super,
                                     (std::floor(spot->luxel[1] / super) + 0.5f) * super);
    AddPage(*spot, account);
    std::vector<LuxelReceiver> receivers;
    std::vector<std::size_t> sampleOf;
    AddSamples(*spot, raw, account, receivers, sampleOf);
    if (!receivers.empty()) {
        std::vector<Vec3f> arriving;
        account.lights = explainer_.AtLuxel(lights_, raw, LuxelPassOf(in_, {}, raw), receivers, arriving);
        for (std::size_t i = 0; i < arriving.size(); ++i)
            account.samples[sampleOf[i]].light = arriving[i];
    }
    AddLight(surfaces, *spot, account);
    return account;
}

} // namespace q3
