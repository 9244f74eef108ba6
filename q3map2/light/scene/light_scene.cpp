// GPL-2.0-or-later. Solids, surfaces, skies and see-through surfaces in Embree, and rays traced against them.
#include "q3map2/light/scene/light_scene.h"

#include "common/hash.h"
#include "q3map2/light/scene/light_embree.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/shadow_casters.h"
#include "q3map2/light/scene/sky_faces.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <vector>

namespace q3 {

namespace {

/// Legacy sun rays look for the sky this far beyond the first solid. Game units.
constexpr float kSkySlack = 0.125f;
/// Transmittance up to this counts as opaque.
constexpr float kOpaqueTint = 0.001f;
/// Hits of one see-through surface closer together than this count once: a ray on the common edge of two triangles hits
/// both. Game units.
constexpr float kSameHit = 0.01f;

/// Transmittance of the texel under a hit, per channel: rgb / 255 of a light filter, times 1 - alpha / 255 of an alpha
/// shadow. st: texture coordinates of the three corners; u, v: barycentric coordinates of the hit.
Vec3f FilterAt(const ShaderInfo &shader, const std::array<float, 6> &st, float u, float v) {
    const Image &image = *shader.lightImage;
    const auto texel = [&](std::size_t i, int size) {
        const float t = (1 - u - v) * st[i] + u * st[2 + i] + v * st[4 + i];
        const float fraction = t - std::floor(t);
        return std::isfinite(fraction) ? std::clamp(int(fraction * float(size)), 0, size - 1) : 0;
    };
    const auto rgba = image.Texel(texel(0, image.width), texel(1, image.height));
    Vec3f through{1, 1, 1};
    if ((shader.compileFlags & C_LIGHTFILTER) != 0)
        through = Vec3f{float(rgba[0]), float(rgba[1]), float(rgba[2])} / 255;
    if ((shader.compileFlags & C_ALPHASHADOW) != 0)
        through *= float(255 - rgba[3]) / 255;
    return through;
}

/// Embree user data of see-through geometries and of props.
struct FilterSurfaces {
    const Triangles *triangles;
    const SurfaceTable *table;
    const std::vector<int> *props; ///< by surface number: the static prop, -1 for draw surfaces
};

/// A packet on its way through see-through surfaces. The Embree context comes first, so that the filter gets this
/// record.
struct FilterContext {
    EmbreeContext embree;
    const Triangles *triangles[2]; ///< kFilters, kFilterPatches
    const SurfaceTable *table;
    const std::vector<int> *props; ///< by surface number: the static prop, -1 for draw surfaces
    int ignoredProp;               ///< -1: none
    struct Crossing {
        unsigned ray;
        int surface;
        float distance;
    };
    std::vector<Crossing> crossings; ///< empty for most packets
    Lanes3 tint;                     ///< valid if there are crossings
};

/// Filter of see-through surfaces for rays to lights: multiplies the ray's tint, and stops the ray only where that is
/// opaque. In all filters, `valid` is -1 for hits to decide about, and 0 lets the ray go on.
void FilterHit(const RTCFilterFunctionNArguments *arguments) {
    auto &context = *reinterpret_cast<FilterContext *>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1)
            continue;
        const bool patch = RTCHitN_geomID(arguments->hit, arguments->N, i) == kFilterPatches;
        const Triangles &triangles = *context.triangles[patch ? 1 : 0];
        const unsigned primitive = RTCHitN_primID(arguments->hit, arguments->N, i);
        const float distance = RTCRayN_tfar(arguments->ray, arguments->N, i);
        const unsigned ray = RTCRayN_id(arguments->ray, arguments->N, i);
        const int surface = triangles.surface[primitive];
        if (context.ignoredProp >= 0 && (*context.props)[std::size_t(surface)] == context.ignoredProp) {
            arguments->valid[i] = 0;
            continue;
        }
        const auto same = [&](const FilterContext::Crossing &c) {
            return c.ray == ray && c.surface == surface && std::abs(c.distance - distance) < kSameHit;
        };
        if (context.crossings.empty())
            context.tint.Fill({1, 1, 1});
        if (std::none_of(context.crossings.begin(), context.crossings.end(), same)) {
            context.crossings.push_back({ray, surface, distance});
            context.tint.Set(ray, context.tint[ray] * FilterAt(*(*context.table)[std::size_t(surface)].shader,
                                                               triangles.st[primitive],
                                                               RTCHitN_u(arguments->hit, arguments->N, i),
                                                               RTCHitN_v(arguments->hit, arguments->N, i)));
        }
        if (MaxComponent(context.tint[ray]) > kOpaqueTint)
            arguments->valid[i] = 0;
    }
}

/// A packet on its way to a light. The Embree context comes first, so that the filters get this record.
struct OcclusionContext {
    EmbreeContext embree;
    float nearestSurface; ///< kLegacySurfaces nearer than this do not block. Game units
    int ignoredProp;      ///< -1: none
};

/// Filter of kLegacySurfaces: surfaces nearer than nearestSurface do not block.
void NearSurfaceHit(const RTCFilterFunctionNArguments *arguments) {
    const float nearest = reinterpret_cast<const OcclusionContext *>(arguments->context)->nearestSurface;
    for (unsigned i = 0; i < arguments->N; ++i)
        if (RTCRayN_tfar(arguments->ray, arguments->N, i) < nearest)
            arguments->valid[i] = 0;
}

/// Filter of props: that of RayPacket::ignoredProp does not block.
void PropHit(const RTCFilterFunctionNArguments *arguments) {
    const int ignored = reinterpret_cast<const OcclusionContext *>(arguments->context)->ignoredProp;
    const auto &surfaces = *static_cast<const FilterSurfaces *>(arguments->geometryUserPtr);
    for (unsigned i = 0; i < arguments->N && ignored >= 0; ++i) {
        if (arguments->valid[i] != -1)
            continue;
        const unsigned primitive = RTCHitN_primID(arguments->hit, arguments->N, i);
        if ((*surfaces.props)[std::size_t(surfaces.triangles->surface[primitive])] == ignored)
            arguments->valid[i] = 0;
    }
}

/// Filter of nearest-hit rays: see-through surfaces stop a ray where their texel is opaque.
void OpaqueHit(const RTCFilterFunctionNArguments *arguments) {
    const auto &[triangles, table, props] = *static_cast<const FilterSurfaces *>(arguments->geometryUserPtr);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1)
            continue;
        const unsigned primitive = RTCHitN_primID(arguments->hit, arguments->N, i);
        const ShaderInfo &shader = *(*table)[std::size_t(triangles->surface[primitive])].shader;
        const Vec3f through = FilterAt(shader, triangles->st[primitive], RTCHitN_u(arguments->hit, arguments->N, i),
                                       RTCHitN_v(arguments->hit, arguments->N, i));
        if (MaxComponent(through) > kOpaqueTint)
            arguments->valid[i] = 0;
    }
}

/// Triangles and their Embree geometries, by GeometryId.
struct Casters {
    std::array<Triangles, kGeometries> triangles;
    std::array<GeometryPtr, kGeometries> geometries;
    std::array<FilterSurfaces, kGeometries> filterSurfaces{};
};

} // namespace

struct LightScene::State {
    const Bsp &bsp;
    const SurfaceTable table; ///< of draw surfaces, then of props.casters
    const PropShadows props;
    const std::vector<int> propOf; ///< by surface number; -1: a draw surface
    const LightOptions options;
    float legacyIgnoreRadius;
    bool trace; ///< false, with -notrace: no shadows
    RTCDevice device = nullptr;
    Casters main;                ///< for receivers of group 1
    std::vector<int> skyIndexes; ///< by triangle of kSkies
    std::optional<SkyFaces> skyFaces;
    ScenePtr all, skies, filters, filtersWithoutPatches;
    // Made on first use: not every run needs them.
    std::once_flag legacyMade, legacySunsMade, blockersMade;
    std::mutex making;
    ScenePtr legacyAll;                          ///< see MakeLegacy
    ScenePtr legacySolids, legacySurfaces;       ///< see MakeLegacySuns
    ScenePtr solidHull, blockerSolids, blockers; ///< for TraceBlockers, see MakeBlockers

    /// Shadow casters for receivers of a group other than 0 and 1.
    struct Group {
        int receiveShadows = 0;
        Casters casters;
        ScenePtr all, filters, blockers;
    };
    std::vector<std::unique_ptr<Group>> groups;
    std::vector<Fingerprint> fingerprints;

    State(const Bsp &map, const SurfaceTable &t, const LightOptions &o, float radius, const PropShadows &p)
        : bsp(map), table(WithProps(t, p)), props(p), propOf(PropsOf(t.size(), p)), options(o),
          legacyIgnoreRadius(radius), trace(!o.noTrace) {}
    static SurfaceTable WithProps(SurfaceTable table, const PropShadows &props);
    static std::vector<int> PropsOf(std::size_t surfaces, const PropShadows &props);

    /// Makes, on first use, the scenes of TraceBlockers: for dirt and floodlight on surfaces. Safe from several
    /// threads.
    void MakeBlockers();
    /// The same for rays from the legacy grid to lights, and to suns.
    void MakeLegacy();
    void MakeLegacySuns();
    /// Calls make() the first time. One thread at a time: scenes share geometries.
    template <typename Make> void Once(std::once_flag &made, const Make &make) {
        std::call_once(made, [&] {
            const std::lock_guard lock(making);
            make();
        });
    }

    /// Boxes that stand for props have no shader; they are closed, so they count as one-sided.
    bool IsOneSided(int surface) const {
        const ShaderInfo *shader = table[std::size_t(surface)].shader;
        return !shader || !shader->twoSided;
    }
    void MakeGeometries(Casters &casters) const;
    /// Adds the fingerprints of the triangles for receivers of a group.
    void AddFingerprints(const Casters &casters, int group);
    /// Copies the triangles of a kind, if any, to Embree and frees their corners, except those of filters.
    void MakeGeometry(GeometryId id, Casters &casters) const;
    ScenePtr MakeScene(const Casters &casters, std::initializer_list<GeometryId> ids) const;
    ScenePtr MakeScene(std::initializer_list<GeometryId> ids) const { return MakeScene(main, ids); }
    void MakeGroup(int receiveShadows);
    /// Null for group 1.
    const Group *FindGroup(int receiveShadows) const {
        for (const auto &group : groups)
            if (group->receiveShadows == receiveShadows)
                return group.get();
        return nullptr;
    }
    /// Sets the tint of the live rays by the see-through surfaces of `scene` beyond `nearest`; rays that these stop are
    /// live no longer.
    void Tint(RayPacket &packet, const Casters &casters, const ScenePtr &scene, float nearest) const;
    void Tint(RayPacket &packet, const ScenePtr &scene, float nearest) const { Tint(packet, main, scene, nearest); }
    void FindSky(const RayPacket &packet, float nearest, SkyHits &hits) const;
    void SkipSkyBacks(const RayPacket &packet, SkyHits &hits) const;
};

namespace {

/// Clears `live` of rays that something in the scene blocks; kLegacySurfaces block from `nearestSurface` on only.
void MaskOccluded(RTCScene scene, RayPacket &packet, float nearest, float nearestSurface = 0) {
    Vectorize([&, scene, nearest, nearestSurface]() Q3_INLINE {
        alignas(64) RTCRay16 rays;
        SetRays(packet.origin, packet.direction, packet.distance, packet.live, nearest, rays);
        OcclusionContext context;
        InitContext(context.embree);
        context.nearestSurface = nearestSurface;
        context.ignoredProp = packet.ignoredProp;
        Occluded16(packet.live.data(), scene, context.embree, rays);
        for (const std::size_t i : kEachLane)
            packet.live[i] = rays.tfar[i] < 0 ? 0 : packet.live[i];
    });
}

/// Ends rays at the sky and drops rays that miss it. Finding the sky first is cheap, and up to there any hit blocks:
/// the nearest one need not be found.
void ClipToSky(const SkyHits &hits, int skyIndex, RayPacket &packet) {
    for (const std::size_t i : kEachLane)
        packet.live.Set(i, hits.hit[i] != 0 && (skyIndex < 0 || hits.skyIndex[i] == skyIndex));
    packet.distance = hits.distance;
}

} // namespace

SurfaceTable LightScene::State::WithProps(SurfaceTable table, const PropShadows &props) {
    for (const PropCaster &caster : props.casters) {
        table.emplace_back().shader = caster.shader;
        table.back().castShadows = caster.castShadows;
    }
    return table;
}

std::vector<int> LightScene::State::PropsOf(std::size_t surfaces, const PropShadows &props) {
    std::vector<int> result(surfaces, -1);
    for (const PropCaster &caster : props.casters)
        result.push_back(caster.prop);
    return result;
}

LightScene::LightScene(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, float legacyIgnoreRadius,
                       const PropShadows &props)
    : state_(std::make_unique<State>(bsp, table, options, legacyIgnoreRadius, props)) {
    State &state = *state_;
    state.main.triangles = ShadowCasters(bsp, table, options);
    AddProps(props, int(table.size()), 1, kProps, SeeThroughProps::Add, state.main.triangles);
    AddProps(props, int(table.size()), 1, kLegacySurfaces, SeeThroughProps::LeaveOut, state.main.triangles);
    for (const int surface : state.main.triangles[kSkies].surface)
        state.skyIndexes.push_back(table[std::size_t(surface)].skyIndex);
    state.skyFaces.emplace(state.main.triangles[kSkies], state.skyIndexes);
    state.device = SharedDevice();
    state.AddFingerprints(state.main, 1);
    state.MakeGeometries(state.main);
    state.all = state.MakeScene({kSolids, kSurfaces, kPatches, kProps});
    state.skies = state.MakeScene({kSkies});
    state.filters = state.MakeScene({kFilters, kFilterPatches});
    state.filtersWithoutPatches = state.MakeScene({kFilters});
    std::vector<int> groups = props.receiveShadows;
    for (const SurfaceEntry &entry : table)
        groups.push_back(entry.receiveShadows);
    for (const int group : groups)
        if (group != 0 && group != 1 && !state.FindGroup(group))
            state.MakeGroup(group);
    std::ranges::sort(state.fingerprints, {}, &Fingerprint::hash);
}

LightScene::~LightScene() = default;

void LightScene::State::AddFingerprints(const Casters &casters, int group) {
    for (unsigned id = 0; id < kGeometries; ++id) {
        const Triangles &triangles = casters.triangles[id];
        for (std::size_t i = 0; i < triangles.Count(); ++i) {
            KeyBuilder key;
            key.Add(id, group);
            key.AddAll(std::span(triangles.corners).subspan(9 * i, 9));
            if (const int surface = triangles.surface[i]; surface >= 0) {
                const SurfaceEntry &entry = table[std::size_t(surface)];
                key.Add(entry.skyIndex, entry.castShadows, IsOneSided(surface), propOf[std::size_t(surface)]);
                key.AddText(entry.shader ? std::string_view(entry.shader->name) : std::string_view());
            }
            if (!triangles.st.empty())
                key.AddAll(std::span<const float>(triangles.st[i]));
            Fingerprint &print = fingerprints.emplace_back(Fingerprint{key.Key().low, {}});
            for (const Vec3d &corner : triangles.Corners(i))
                print.box.Add(Vec3f(corner));
        }
    }
}

const std::vector<LightScene::Fingerprint> &LightScene::Fingerprints() const {
    return state_->fingerprints;
}

bool LightScene::HasFilters() const {
    return state_->filters != nullptr ||
           std::ranges::any_of(state_->groups, [](const auto &group) { return group->filters != nullptr; });
}

void LightScene::State::MakeLegacy() {
    Once(legacyMade, [&] { legacyAll = MakeScene({kLegacySolids, kLegacySurfaces}); });
}

void LightScene::State::MakeLegacySuns() {
    Once(legacySunsMade, [&] {
        legacySolids = MakeScene({kLegacySolids});
        legacySurfaces = MakeScene({kLegacySurfaces});
    });
}

void LightScene::State::MakeBlockers() {
    Once(blockersMade, [&] {
        solidHull = MakeScene({kSolids});
        AddBlockers(bsp, table, options, main.triangles);
        AddProps(props, int(bsp.drawSurfaces.size()), 1, kBlockerSurfaces, SeeThroughProps::LeaveOut, main.triangles);
        MakeGeometry(kBlockerSolids, main);
        MakeGeometry(kBlockerSurfaces, main);
        blockerSolids = MakeScene({kBlockerSolids});
        blockers = MakeScene({kBlockerSurfaces, kPatches, kFilters, kFilterPatches});
    });
}

void LightScene::State::MakeGeometries(Casters &casters) const {
    for (unsigned id = 0; id < kGeometries; ++id)
        MakeGeometry(GeometryId(id), casters);
}

void LightScene::State::MakeGeometry(GeometryId id, Casters &casters) const {
    if (casters.triangles[id].Count() == 0)
        return;
    casters.geometries[id] = NewTriangles(device, casters.triangles[id].corners);
    const RTCGeometry geometry = casters.geometries[id].get();
    if (id == kFilters || id == kFilterPatches) {
        rtcSetGeometryOccludedFilterFunction(geometry, FilterHit);
        casters.filterSurfaces[id] = {&casters.triangles[id], &table, &propOf};
        rtcSetGeometryUserData(geometry, &casters.filterSurfaces[id]);
        rtcSetGeometryIntersectFilterFunction(geometry, OpaqueHit);
        rtcCommitGeometry(geometry);
    } else
        casters.triangles[id].corners = {};
    if (id == kProps) {
        casters.filterSurfaces[id] = {&casters.triangles[id], &table, &propOf};
        rtcSetGeometryUserData(geometry, &casters.filterSurfaces[id]);
        rtcSetGeometryOccludedFilterFunction(geometry, PropHit);
        rtcCommitGeometry(geometry);
    }
    if (id == kLegacySurfaces) {
        rtcSetGeometryOccludedFilterFunction(geometry, NearSurfaceHit);
        rtcCommitGeometry(geometry);
    }
}

ScenePtr LightScene::State::MakeScene(const Casters &casters, std::initializer_list<GeometryId> ids) const {
    ScenePtr scene = NewScene(device);
    bool any = false;
    for (const GeometryId id : ids)
        if (casters.geometries[id]) {
            rtcAttachGeometryByID(scene.get(), casters.geometries[id].get(), id);
            any = true;
        }
    if (!any)
        return nullptr;
    CommitScene(device, scene.get());
    return scene;
}

void LightScene::State::MakeGroup(int receiveShadows) {
    auto group = std::make_unique<Group>();
    group->receiveShadows = receiveShadows;
    AddSurfaces(bsp, table, options, receiveShadows, group->casters.triangles);
    AddProps(props, int(bsp.drawSurfaces.size()), receiveShadows, kProps, SeeThroughProps::Add,
             group->casters.triangles);
    AddFingerprints(group->casters, receiveShadows);
    MakeGeometries(group->casters);
    if (const RTCGeometry shared = main.geometries[kSolids].get()) {
        rtcRetainGeometry(shared);
        group->casters.geometries[kSolids].reset(shared);
    }
    group->all = MakeScene(group->casters, {kSolids, kSurfaces, kPatches, kProps});
    group->filters = MakeScene(group->casters, {kFilters, kFilterPatches});
    group->blockers = MakeScene(group->casters, {kSurfaces, kPatches, kProps, kFilters, kFilterPatches});
    groups.push_back(std::move(group));
}

void LightScene::State::Tint(RayPacket &packet, const Casters &casters, const ScenePtr &scene, float nearest) const {
    if (!scene || !packet.live.Any())
        return;
    FilterContext context;
    InitContext(context.embree);
    context.triangles[0] = &casters.triangles[kFilters];
    context.triangles[1] = &casters.triangles[kFilterPatches];
    context.table = &table;
    context.props = &propOf;
    context.ignoredProp = packet.ignoredProp;
    alignas(64) RTCRay16 rays;
    SetRays(packet.origin, packet.direction, packet.distance, packet.live, nearest, rays);
    Occluded16(packet.live.data(), scene.get(), context.embree, rays);
    packet.filtered = {};
    if (context.crossings.empty())
        return;
    for (const FilterContext::Crossing &crossing : context.crossings)
        packet.filtered[crossing.ray] = -1;
    packet.tint = context.tint;
    for (const std::size_t i : kEachLane) {
        packet.live[i] = rays.tfar[i] < 0 ? 0 : packet.live[i];
        packet.tinted = packet.tinted || (packet.live[i] & packet.filtered[i]) != 0;
    }
}

void LightScene::TraceToLight(RayPacket &packet, ShadowRules rules, RayCounts &counts) const {
    packet.tinted = false;
    State &state = *state_;
    if (!state.trace)
        return;
    counts.rays += std::uint64_t(packet.live.Count());
    if (rules == ShadowRules::Exact) {
        if (state.all)
            MaskOccluded(state.all.get(), packet, 0);
        state.Tint(packet, state.filters, 0);
        return;
    }
    state.MakeLegacy();
    if (state.legacyAll)
        MaskOccluded(state.legacyAll.get(), packet, 0, state.legacyIgnoreRadius);
    state.Tint(packet, state.filtersWithoutPatches, state.legacyIgnoreRadius);
}

/// The nearest sky on each live ray.
void LightScene::State::FindSky(const RayPacket &packet, float nearest, SkyHits &hits) const {
    if (skyFaces->Few())
        return skyFaces->Find(packet.origin, packet.direction, packet.distance, packet.live, nearest, hits);
    alignas(64) RTCRayHit16 found;
    FindNearest(skies.get(), packet, nearest, found);
    for (const std::size_t i : kEachLane) {
        // Embree's normal; corners are clockwise seen from the front, so it points to the back.
        const Vec3f back{found.hit.Ng_x[i], found.hit.Ng_y[i], found.hit.Ng_z[i]};
        const bool hit = packet.live[i] != 0 && found.hit.geomID[i] == kSkies;
        hits.hit.Set(i, hit);
        hits.behind.Set(i, hit && Dot(packet.direction[i], back) < 0);
        hits.distance[i] = found.ray.tfar[i];
        hits.skyIndex[i] = hit ? skyIndexes[found.hit.primID[i]] : 0;
    }
}

/// Where a floor touches a sky, receivers can lie in the sky's plane: their rays into the room hit the sky from behind
/// first, which does not count.
void LightScene::State::SkipSkyBacks(const RayPacket &packet, SkyHits &hits) const {
    LaneMask again{};
    for (const std::size_t i : kEachLane)
        again.Set(i, hits.behind[i] != 0 && hits.distance[i] < kSurfaceIgnoreRadius);
    if (!again.Any())
        return;
    RayPacket rays = packet;
    rays.live = again;
    SkyHits next;
    FindSky(rays, kSurfaceIgnoreRadius, next);
    for (const std::size_t i : kEachLane)
        if (again[i] != 0) {
            hits.hit[i] = next.hit[i];
            hits.distance[i] = next.distance[i];
            hits.skyIndex[i] = next.skyIndex[i];
        }
}

void LightScene::TraceSurfaceToLight(RayPacket &packet, int receiveShadows, RayCounts &counts) const {
    packet.tinted = false;
    packet.filtered = {};
    const State &state = *state_;
    if (!state.trace || receiveShadows == 0)
        return;
    counts.rays += std::uint64_t(packet.live.Count());
    const State::Group *group = state.FindGroup(receiveShadows);
    // Solids that a ray enters within the radius still block it with their far side. Only corners that it also leaves
    // within the radius do not, on purpose: else they would darken half of a low wall's luxels.
    if (const ScenePtr &blockers = group ? group->all : state.all)
        MaskOccluded(blockers.get(), packet, kSurfaceIgnoreRadius);
    state.Tint(packet, group ? group->casters : state.main, group ? group->filters : state.filters,
               kSurfaceIgnoreRadius);
}

void LightScene::TraceSurfaceToSky(RayPacket &packet, int skyIndex, int receiveShadows, RayCounts &counts) const {
    packet.tinted = false;
    packet.filtered = {};
    const State &state = *state_;
    if (!state.trace || receiveShadows == 0)
        return;
    if (state.skies) {
        SkyHits hits;
        state.FindSky(packet, 0, hits);
        state.SkipSkyBacks(packet, hits);
        ClipToSky(hits, skyIndex, packet);
    } else
        packet.live = {};
    if (packet.live.Any())
        TraceSurfaceToLight(packet, receiveShadows, counts);
}

void LightScene::TraceToSky(RayPacket &packet, int skyIndex, ShadowRules rules, RayCounts &counts) const {
    packet.tinted = false;
    State &state = *state_;
    if (!state.trace)
        return;
    counts.rays += std::uint64_t(packet.live.Count());
    if (!state.skies) {
        packet.live = {};
        return;
    }
    const bool exact = rules == ShadowRules::Exact;
    if (!exact)
        state.MakeLegacySuns();
    const float nearest = exact ? 0 : state.legacyIgnoreRadius;
    alignas(64) RTCRayHit16 solids;
    if (!exact && state.legacySolids) {
        FindNearest(state.legacySolids.get(), packet, 0, solids);
        for (const std::size_t i : kEachLane)
            packet.distance[i] = std::min(packet.distance[i], solids.ray.tfar[i] + kSkySlack);
    }
    SkyHits hits;
    state.FindSky(packet, nearest, hits);
    ClipToSky(hits, skyIndex, packet);
    if (const ScenePtr &blockers = exact ? state.all : state.legacySurfaces; blockers && packet.live.Any())
        MaskOccluded(blockers.get(), packet, nearest);
    state.Tint(packet, exact ? state.filters : state.filtersWithoutPatches, nearest);
}

void LightScene::TraceDistance(RayPacket &packet, float ignoreRadius, RayCounts &counts) const {
    const State &state = *state_;
    counts.rays += std::uint64_t(packet.live.Count());
    if (!state.all)
        return;
    alignas(64) RTCRayHit16 blockers;
    FindNearest(state.all.get(), packet, ignoreRadius, blockers);
    RayPacket toSky = packet;
    std::copy(std::begin(blockers.ray.tfar), std::end(blockers.ray.tfar), toSky.distance.begin());
    SkyHits skies;
    if (state.skies)
        state.FindSky(toSky, ignoreRadius, skies);
    for (const std::size_t i : kEachLane)
        if (packet.live[i] != 0 && blockers.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID && skies.hit[i] == 0)
            packet.distance[i] = blockers.ray.tfar[i];
}

void LightScene::TraceBlockers(const RayPacket &packet, BlockerKind kind, int receiveShadows, const Lanes &nearest,
                               Blockers &blockers, RayCounts &counts) const {
    if (kind != BlockerKind::Casters)
        state_->MakeBlockers();
    const State &state = *state_;
    counts.rays += std::uint64_t(packet.live.Count());
    blockers.hit = blockers.behind = {};
    const State::Group *group = kind == BlockerKind::Casters ? nullptr : state.FindGroup(receiveShadows);
    const ScenePtr &scene = kind == BlockerKind::Solids         ? state.solidHull
                            : kind == BlockerKind::LegacySolids ? state.blockerSolids
                            : kind == BlockerKind::Casters      ? state.all
                            : group                             ? group->blockers
                                                                : state.blockers;
    if (!scene || receiveShadows == 0)
        return;
    alignas(64) RTCRayHit16 hits;
    FindNearest(scene.get(), packet, nearest, hits);
    const Casters &casters = group ? group->casters : state.main;
    const bool hitsSurfaces = kind == BlockerKind::Casters || kind == BlockerKind::Surfaces;
    for (const std::size_t i : kEachLane) {
        const unsigned id = hits.hit.geomID[i];
        const bool hit = packet.live[i] != 0 && id != RTC_INVALID_GEOMETRY_ID;
        blockers.hit.Set(i, hit);
        blockers.distance[i] = hits.ray.tfar[i];
        const int surface = hit && hitsSurfaces ? casters.triangles[id].surface[hits.hit.primID[i]] : -1;
        blockers.surface[i] = surface;
        // As in FindSky: the normal points to the back.
        const Vec3f back{hits.hit.Ng_x[i], hits.hit.Ng_y[i], hits.hit.Ng_z[i]};
        blockers.behind.Set(i, surface >= 0 && Dot(packet.direction[i], back) < 0 && state.IsOneSided(surface));
    }
}

std::vector<LightScene::BlockerTriangle> LightScene::BlockerTriangles() const {
    state_->MakeBlockers();
    std::vector<BlockerTriangle> result;
    for (const GeometryId id : {kBlockerSolids, kBlockerSurfaces, kPatches, kFilters, kFilterPatches}) {
        const RTCGeometry geometry = state_->main.geometries[id].get();
        if (!geometry)
            continue;
        const auto *c = static_cast<const float *>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
        for (const int surface : state_->main.triangles[id].surface) {
            const std::array<Vec3f, 3> corners = {{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}}};
            result.push_back({corners, surface, id == kFilters || id == kFilterPatches});
            c += 9;
        }
    }
    return result;
}

std::size_t LightScene::TriangleCount() const {
    std::size_t count = 0;
    for (const GeometryId id : {kSolids, kSurfaces, kPatches, kSkies, kFilters, kFilterPatches, kProps})
        count += state_->main.triangles[id].Count();
    return count;
}

} // namespace q3
