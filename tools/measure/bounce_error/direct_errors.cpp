// GPL-2.0-or-later. Error of baked direct light against brute force, and its causes.
#include "tools/measure/bounce_error/direct_errors.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>
#include <cmath>

namespace q3::bounce {

namespace {

/// Of a luxel's places, the truth takes at most this many.
constexpr std::size_t kMaxTruthPlaces = 4;
/// Luxels on each side of the center, whose shadows are compared with its own.
constexpr int kEdgeReach = 2;

bool IsAtSeam(const RawLightmap &raw, std::size_t luxel) {
    constexpr int kNeighbors = 8;
    bool mapped = true;
    const int inside =
        ForLuxelsAround(raw, luxel, 1, [&](std::size_t neighbor) { mapped = mapped && raw.Mapped(neighbor); });
    return inside < kNeighbors || !mapped;
}

/// The largest displayed error of a channel.
double LargestError(const ComparedLight &light) {
    double largest = 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
        largest = std::max(largest, std::abs(ShownDifference(light, channel)));
    return largest;
}

/// A place's normal and that of a luxel there have at least this cosine: 26 degrees.
constexpr float kSameNormal = 0.9f;

/// A mapped luxel and its distance from a place.
struct FoundLuxel {
    double distance = 0;
    std::size_t luxel = 0;
};
/// Normals count as for NearestLuxel.
std::optional<FoundLuxel> NearestOf(const RawLightmap &raw, const AskedPlace &place) {
    std::optional<FoundLuxel> nearest;
    for (std::size_t i = 0; i < raw.luxelClusters.size(); ++i)
        if (raw.Mapped(i) && (place.normal == Vec3f{} || Dot(raw.normals[i], place.normal) >= kSameNormal))
            if (const double distance = double(Length(raw.positions[i] - place.position));
                !nearest || distance < nearest->distance)
                nearest = {distance, i};
    return nearest;
}

} // namespace

DirectErrors DirectErrorsOf(std::span<const ComparedDirect> light) {
    DirectErrors errors;
    std::vector<ComparedLight> all, clear;
    double squares = 0;
    for (const ComparedDirect &one : light) {
        all.push_back(one.light);
        if (one.isClear)
            clear.push_back(one.light);
        const auto cause = std::size_t(one.cause);
        const double square = SquaredError(one.light);
        errors.receivers[cause] += 1, errors.squares[cause] += square, squares += square;
        errors.grossShare += !one.nearEdge && LargestError(one.light) > kGrossError;
    }
    const double count = std::max(1.0, double(light.size()));
    errors.all = ErrorsOf(all);
    errors.rmseClear = ErrorsOf(clear).rmse;
    errors.grossShare /= count;
    for (std::size_t cause = 0; cause < kCauseNames.size(); ++cause) {
        errors.receivers[cause] /= count;
        errors.squares[cause] /= squares > 0 ? squares : 1;
    }
    return errors;
}

TruthReceiver TruthReceiverOf(const SurfaceLight &surfaces, const LuxelReceiver &luxel) {
    const RawLightmap &raw = surfaces.lightmaps[luxel.lightmap];
    TruthReceiver receiver;
    for (std::size_t i = 0; i < std::min(luxel.places.size(), kMaxTruthPlaces); ++i)
        receiver.places.push_back({.position = luxel.places[i],
                                   .normal = luxel.normal,
                                   .twoSided = raw.twoSided,
                                   .receiveShadows = raw.receiveShadows});
    receiver.ambient = raw.ambient;
    ForLuxelsAround(raw, luxel.luxel, kEdgeReach, [&](std::size_t neighbor) {
        if (raw.Mapped(neighbor))
            receiver.around.push_back(raw.positions[neighbor]);
    });
    return receiver;
}

ErrorCause CauseOf(const SurfaceLight &surfaces, const LuxelReceiver &luxel, const LuxelTruth &truth) {
    if (truth.crossedLamps)
        return ErrorCause::CrossedLamps;
    if (truth.contact)
        return ErrorCause::Contact;
    if (truth.penumbra)
        return ErrorCause::Penumbra;
    return IsAtSeam(surfaces.lightmaps[luxel.lightmap], luxel.luxel) ? ErrorCause::Seams : ErrorCause::Rest;
}

std::optional<LuxelReceiver> NearestLuxel(const SurfaceInputs &in, const SurfaceLight &surfaces, const PathScene &scene,
                                          const AskedPlace &place) {
    constexpr double kClearReach = 64; // game units
    struct Candidate {
        FoundLuxel found;
        std::size_t lightmap = 0;
    };
    std::vector<Candidate> candidates;
    for (std::size_t m = 0; m < surfaces.lightmaps.size(); ++m)
        if (const auto found = NearestOf(surfaces.lightmaps[m], place))
            candidates.push_back({*found, m});
    std::sort(candidates.begin(), candidates.end(),
              [](const Candidate &a, const Candidate &b) { return a.found.distance < b.found.distance; });
    const auto receiverOf = [&](const Candidate &one, const std::vector<Vec3f> &places) {
        const RawLightmap &raw = surfaces.lightmaps[one.lightmap];
        const Vec3f &position = raw.positions[one.found.luxel];
        return LuxelReceiver{one.lightmap,
                             one.found.luxel,
                             raw.surfaces.front(),
                             position,
                             raw.normals[one.found.luxel],
                             places.empty() ? std::vector<Vec3f>{position} : places};
    };
    for (const Candidate &one : candidates) {
        if (one.found.distance > kClearReach)
            break;
        const auto places = PlacesOf(in, scene, surfaces.lightmaps[one.lightmap], one.found.luxel);
        if (!places.empty())
            return receiverOf(one, places);
    }
    if (candidates.empty())
        return std::nullopt;
    return receiverOf(candidates.front(), {});
}

LuxelReceiver AtPlace(LuxelReceiver luxel, const AskedPlace &place) {
    luxel.position = place.position + place.normal, luxel.normal = place.normal;
    luxel.places = {luxel.position};
    return luxel;
}

std::vector<LuxelReceiver> LuxelsOf(const SurfaceLight &surfaces, std::vector<LitPoint> &points) {
    std::vector<LuxelReceiver> luxels;
    std::vector<LitPoint> kept;
    for (const LitPoint &one : points) {
        const int lightmap = surfaces.lightmapOf[one.surface];
        if (lightmap < 0)
            continue;
        const auto found = NearestOf(surfaces.lightmaps[std::size_t(lightmap)], {one.position, {}});
        if (!found)
            continue;
        kept.push_back(one);
        luxels.push_back(
            {std::size_t(lightmap), found->luxel, int(one.surface), one.position, one.normal, {one.position}});
    }
    points = std::move(kept);
    return luxels;
}

std::vector<ComparedDirect> CompareDirect(const SurfaceLight &surfaces, std::span<const LuxelReceiver> luxels,
                                          std::span<const LuxelTruth> truth, std::span<const Vec3f> baked) {
    std::vector<ComparedDirect> light;
    for (std::size_t i = 0; i < luxels.size(); ++i)
        light.push_back({{{}, baked[i], truth[i].light, truth[i].error},
                         CauseOf(surfaces, luxels[i], truth[i]),
                         truth[i].nearEdge,
                         luxels[i].places == std::vector<Vec3f>{luxels[i].position}});
    return light;
}

void RemoveTooBright(std::vector<LuxelReceiver> &luxels, std::vector<ComparedDirect> &light) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < light.size(); ++i)
        if (double(MaxComponent(light[i].light.bounced)) <= kMaxComparedLight) {
            std::swap(luxels[kept], luxels[i]);
            light[kept++] = light[i];
        }
    luxels.resize(kept), light.resize(kept);
}

std::vector<Vec3f> LightAt(const SurfaceLight &surfaces, std::span<const LuxelReceiver> luxels,
                           const BakedLuxels &baked) {
    bool same = baked.light.size() == surfaces.lightmaps.size();
    for (std::size_t m = 0; same && m < baked.light.size(); ++m)
        same = baked.light[m].size() == surfaces.lightmaps[m].luxelClusters.size();
    if (!same)
        throw Error("the bake has other lightmaps than the reference: its options change their sizes");
    std::vector<Vec3f> light;
    for (const LuxelReceiver &at : luxels)
        light.push_back(Max(baked.light[at.lightmap][at.luxel], Vec3f{}));
    return light;
}

std::string DirectTables(std::span<const DirectRow> rows) {
    std::string text = "| map | setting | CPU s | RMSE | RMSE clear | 95 % | 99 % | bias | noise | mean | gross % |\n"
                       "|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (const DirectRow &row : rows) {
        const BounceErrors &e = row.errors.all;
        text += fmt::format(
            "| {} | {} | {} | {:.3f} | {:.3f} | {:.2f} | {:.2f} | {:+.3f} | {:.3f} | {:.2f} | {:.2f} |\n", row.map,
            row.setting, row.seconds < 0 ? "-" : fmt::format("{:.2f}", row.seconds), e.rmse, row.errors.rmseClear,
            e.percentile95, e.percentile99, e.bias, e.noise, e.meanLight, 100 * row.errors.grossShare);
    }
    text += "\n| map | setting | share of |";
    for (const std::string_view name : kCauseNames)
        text += fmt::format(" {} |", name);
    text += "\n|---|---|---|---|---|---|---|---|\n";
    const auto line = [&](const DirectRow &row, std::string_view what, const auto &shares) {
        text += fmt::format("| {} | {} | {} |", row.map, row.setting, what);
        for (const double share : shares)
            text += fmt::format(" {:.1f} % |", 100 * share);
        text += "\n";
    };
    for (const DirectRow &row : rows) {
        line(row, "squared error", row.errors.squares);
        line(row, "receivers", row.errors.receivers);
    }
    return text;
}

std::string DirectText(const Bsp &bsp, const LuxelReceiver &luxel, const ComparedDirect &light) {
    const auto vector = [](const Vec3f &v) { return fmt::format("{:.1f} {:.1f} {:.1f}", v.x, v.y, v.z); };
    const auto &shader = bsp.shaders[std::size_t(bsp.drawSurfaces[std::size_t(luxel.surface)].shaderNum)];
    return fmt::format("  error {:.2f} at {} normal {:.2f} {:.2f} {:.2f}: baked {}, true {} +- {}; {}; {}{}\n",
                       std::sqrt(SquaredError(light.light) / 3), vector(luxel.position), luxel.normal.x, luxel.normal.y,
                       luxel.normal.z, vector(light.light.bounced), vector(light.light.traced),
                       vector(light.light.tracedError), FieldName(shader.shader), kCauseNames[std::size_t(light.cause)],
                       light.nearEdge ? ", near a shadow edge" : "");
}

} // namespace q3::bounce
