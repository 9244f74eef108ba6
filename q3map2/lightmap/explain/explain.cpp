// GPL-2.0-or-later. Explains why points of a map are lit as they are: those of -explain, and places all over a map for
// pages that show them.
#include "q3map2/lightmap/explain/explain.h"

#include "q3map2/bspfile/light_keys.h"
#include "q3map2/lightmap/explain/explain_report.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace q3 {

namespace {

/// With a source and _keepLights, lights are those of the .bsp, by their numbers there.
std::optional<std::vector<Entity>> KeptLights(const LightInputs &inputs, const LightSetup &setup) {
    if (!inputs.mapEntities || !keys::kKeepLights.Flag(setup.bspEntities.front()))
        return {};
    return setup.bspEntities;
}

/// Whether surfaces name their entities by numbers in the source, which the .srf has, or without a source in the .bsp.
bool HasSurfaceNumbers(const LightInputs &inputs) {
    return !inputs.mapEntities || !inputs.surfaceFile.empty();
}

} // namespace

Explainer::Explainer(const Bsp &bsp, const LightInputs &inputs, const std::string &mapText, const std::string &mapName,
                     const LightOptions &options, const LightmapOptions &lightmap, ShaderLibrary &library,
                     const Game &game, const JobPool &jobs, Log &log)
    : quiet_(Log::Nowhere()), setup_(bsp, inputs, options, SurfaceDefaultsOf(lightmap), library, log),
      lightmap_(lightmap),
      source_(inputs.mapEntities.value_or(setup_.bspEntities), KeptLights(inputs, setup_), HasSurfaceNumbers(inputs)),
      obstacles_(setup_, source_), lights_(setup_, source_, obstacles_),
      prepared_(PrepareLights(setup_, LightPass::GridSH, lightmap_.fastPoint)),
      grid_(setup_, obstacles_, jobs), in_{setup_.bsp, setup_.space, setup_.scene, setup_.table, setup_.options,
                                           lightmap_,  setup_.world, jobs,         quiet_},
      luxels_(in_, setup_, source_, obstacles_) {
    if (!mapText.empty())
        source_.Read(mapText, mapName, game, library, log);
}

PlaceAccount Explainer::PlaceOf(const Vec3f &p) const {
    const Bsp &bsp = setup_.bsp;
    PlaceAccount place;
    place.point = p;
    place.leaf = LeafAt(bsp, p);
    place.area = bsp.leafs[std::size_t(place.leaf)].area;
    place.cluster = setup_.space.ClusterAt(p, 0);
    place.solid = obstacles_.SolidAt(p);
    return place;
}

std::optional<PlaceInFront> Explainer::PlaceInFrontOf(const SurfaceTriangle &triangle, const Vec3f &p) const {
    constexpr float kPlayerOrigin = 24; // height of a player's origin over the floor. Game units
    constexpr float kLeast = 2;         // height of the last try. Game units
    constexpr float kStart = 0.5f;      // off the surface, so that rays do not meet it. Game units
    const Vec3f from = p + triangle.normal * kStart;
    for (const float height : {kPlayerOrigin, kPlayerOrigin / 3, kLeast}) {
        const Vec3f point = p + triangle.normal * height;
        const ShadowRay ray{triangle.normal, height - kStart};
        if (PlaceInOpen(setup_.space, point).state == PointState::Open &&
            obstacles_.Blocking(from, {&ray, 1}, {}).empty())
            return PlaceInFront{p, point};
    }
    return {};
}

Explanation Explainer::Explain(const Vec3f &p) const {
    Explanation result;
    result.place = PlaceOf(p);
    result.bounces = lightmap_.bounces > 0;
    PlacedPoint from = PlaceInOpen(setup_.space, p);
    if (from.state != PointState::Open && from.cluster < 0)
        from = PlaceBeside(setup_.space, p);
    if (from.cluster >= 0) {
        result.place.litFrom = from.position;
        result.lights = lights_.AtPoint(prepared_, from.position, from.cluster);
    }
    const LightOptions &options = setup_.options;
    if (options.sh || options.shAdaptive || setup_.bsp.gridSH)
        result.grid = grid_.CellAt(p);
    if (!options.noGrid)
        result.legacy = grid_.LegacyCellAt(p);
    if (!lightmap_.onlyGrid)
        result.luxel = luxels_.NearestTo(p);
    return result;
}

// ---- Places all over a map ----

namespace {

using Json = nlohmann::ordered_json;

/// A cell of a lattice, and which side of a cube the surfaces face whose places it takes: 0 to 5.
using LatticeKey = std::array<int, 4>;

/// A point of a surface that may get a place.
struct Candidate {
    LatticeKey key{};
    float fromMiddle = 0; ///< distance to the middle of the cell. Game units
    const SurfaceTriangle *triangle = nullptr;
    Vec3f at;
};

Candidate CandidateAt(const SurfaceTriangle &triangle, const Vec3f &p, float cell) {
    const Vec3f &normal = triangle.normal;
    const Vec3f size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    Candidate candidate{{0, 0, 0, 2 * axis + (normal[std::size_t(axis)] < 0 ? 1 : 0)}, 0, &triangle, p};
    Vec3f middle;
    for (std::size_t i = 0; i < 3; ++i) {
        candidate.key[i] = int(std::floor(p[i] / cell));
        middle[i] = (float(candidate.key[i]) + 0.5f) * cell;
    }
    candidate.fromMiddle = Length(p - middle);
    return candidate;
}

float AreaOf(const SurfaceTriangle &triangle) {
    const auto &[a, b, c] = triangle.corners;
    return Length(Cross(b - a, c - a)) / 2;
}

/// Points of the triangle about half a cell apart; the middle of a small one.
void AddCandidates(const SurfaceTriangle &triangle, float cell, std::vector<Candidate> &candidates) {
    const auto &[a, b, c] = triangle.corners;
    const float longest = std::max({Length(b - a), Length(c - b), Length(a - c)});
    const int steps = std::max(1, int(std::ceil(2 * longest / cell)));
    for (int i = 0; i < steps; ++i)
        for (int k = 0; k + i < steps; ++k) {
            const float u = (float(i) + 1.0f / 3) / float(steps), v = (float(k) + 1.0f / 3) / float(steps);
            candidates.push_back(CandidateAt(triangle, a + (b - a) * u + (c - a) * v, cell));
        }
}

/// One place in each cell of a lattice for each side that surfaces face there, the nearest to the middle of the cell.
std::vector<PlaceInFront> PlacesOfLattice(const Explainer &explainer, const std::vector<SurfaceTriangle> &triangles,
                                          float cell) {
    std::vector<Candidate> candidates;
    for (const SurfaceTriangle &triangle : triangles)
        AddCandidates(triangle, cell, candidates);
    std::ranges::stable_sort(candidates, {}, [](const Candidate &c) { return std::pair(c.key, c.fromMiddle); });
    std::vector<PlaceInFront> places;
    const LatticeKey *taken = nullptr;
    for (const Candidate &candidate : candidates) {
        if (taken && *taken == candidate.key)
            continue;
        if (const auto place = explainer.PlaceInFrontOf(*candidate.triangle, candidate.at)) {
            taken = &candidate.key;
            places.push_back(*place);
        }
    }
    return places;
}

/// To hundredths, so that the text stays short.
Json Rounded(const Vec3f &v) {
    Json numbers = Json::array();
    for (const float c : {v.x, v.y, v.z})
        numbers.push_back(std::round(double(c) * 100) / 100);
    return numbers;
}

Json RaysOf(const std::vector<LightAccount> &lights, std::size_t most) {
    Json rays = Json::array();
    for (const LightAccount &light : lights) {
        if (rays.size() == most || (light.fate != LightFate::Arrives && light.fate != LightFate::Blocked))
            continue;
        Json ray{{"to", Rounded(light.origin)}, {"visible", std::round(double(light.Visible()) * 100) / 100}};
        if (light.type == LightType::Sun)
            ray["sun"] = true;
        for (const Obstacle &obstacle : light.obstacles)
            ray["stops"].push_back(Rounded(obstacle.at));
        rays.push_back(std::move(ray));
    }
    return rays;
}

} // namespace

std::vector<PlaceInFront> PlacesInFrontOfSurfaces(const Explainer &explainer, std::size_t count) {
    const std::vector<SurfaceTriangle> triangles = explainer.LightmappedTriangles();
    float area = 0;
    for (const SurfaceTriangle &triangle : triangles)
        area += AreaOf(triangle);
    if (!(area > 0) || count == 0)
        return {};
    // Lattices of larger and larger cells, until there are few enough places. Each cell takes up to six, one for each
    // side, so if even the last lattice has more than `count`, only some of its places are kept.
    constexpr float kGrowth = 1.1f; // of the cell from try to try: up to a fifth of the places stays unused
    constexpr int kTries = 24;      // which make the cells 9.8 times as large
    float cell = std::sqrt(area / float(count));
    std::vector<PlaceInFront> places = PlacesOfLattice(explainer, triangles, cell);
    for (int i = 0; i < kTries && places.size() > count; ++i)
        places = PlacesOfLattice(explainer, triangles, cell *= kGrowth);
    if (places.size() <= count)
        return places;
    std::vector<PlaceInFront> kept(count);
    for (std::size_t i = 0; i < count; ++i)
        kept[i] = places[i * places.size() / count];
    return kept;
}

std::string ExplanationsJson(const Explainer &explainer, std::span<const PlaceInFront> places, std::string_view map,
                             std::string_view options, const JobPool &jobs, Log &log) {
    std::vector<Json> list(places.size());
    Progress progress(log, std::int64_t(places.size()));
    const auto explain = [&](std::int64_t i, int) {
        const ReportLimits limits{.lights = 8, .nothing = 6, .sources = 4};
        const PlaceInFront &place = places[std::size_t(i)];
        const Explanation explanation = explainer.Explain(place.point);
        list[std::size_t(i)] = {{"at", Rounded(place.point)},
                                {"on", Rounded(place.onSurface)},
                                {"text", ReportOf(explanation, limits)},
                                {"rays", RaysOf(explanation.lights, limits.lights)}};
    };
    jobs.For(std::int64_t(places.size()), explain, [&](std::int64_t done) { progress.Update(done, 0); });
    progress.Finish();
    const Json all{
        {"format", "q3map2-sh explanations"}, {"version", 1}, {"map", map}, {"options", options}, {"places", list}};
    return all.dump(-1, ' ', true, Json::error_handler_t::replace);
}

} // namespace q3
