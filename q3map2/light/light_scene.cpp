// GPL-2.0-or-later. What rays see: solids, surfaces, skies and see-through surfaces in Embree.
#include "q3map2/light/light_scene.h"

#include "common/error.h"
#include "q3map2/light/light_embree.h"
#include "q3map2/light/light_patch.h"
#include "q3map2/light/light_space.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace q3 {

namespace {

/// Skies stand this far in front of their brushes, so that rays meet them before the solid behind. Game units.
constexpr float kSkyLift = 1.0f / 16;
/// Legacy sun rays look for the sky this far beyond the first solid. Game units.
constexpr float kSkySlack = 0.125f;
/// Light under this share counts as blocked.
constexpr float kOpaqueTint = 0.001f;
/// Two hits of one see-through surface nearer than this are one: the shared edge of its triangles. Game units.
constexpr float kSameHit = 0.01f;

/// In the established program an opaque leaf larger than this that at least so many triangles reach into stops being
/// solid.
constexpr int kLostLeafSize = 32, kLostLeafTriangles = 5;
constexpr double kLostLeafEpsilon = 0.25;

enum GeometryId : unsigned {
    kSolids,
    kSurfaces,
    kPatches,
    kSkies,
    kFilters,
    kFilterPatches,
    kLegacySolids,
    kGeometries
};

/// Triangles of one kind with what a hit needs to know.
struct Triangles {
    std::vector<float> corners; // 9 a triangle
    std::vector<int> surface;   // draw surface of each triangle
    std::vector<std::array<float, 6>> st;

    void Add(const Vec3f &a, const Vec3f &b, const Vec3f &c, int surfaceNumber) {
        for (const Vec3f &p : {a, b, c})
            corners.insert(corners.end(), {p.x, p.y, p.z});
        surface.push_back(surfaceNumber);
    }
    std::size_t Count() const { return surface.size(); }
};

GeometryPtr MakeGeometry(RTCDevice device, const Triangles &triangles) {
    GeometryPtr geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    const std::size_t vertices = triangles.corners.size() / 3;
    auto *positions = static_cast<float *>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                                   RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices));
    auto *indices = static_cast<unsigned *>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.Count()));
    if (!positions || !indices)
        throw Error("out of memory for {} triangles", triangles.Count());
    std::copy(triangles.corners.begin(), triangles.corners.end(), positions);
    for (std::size_t i = 0; i < vertices; ++i)
        indices[i] = unsigned(i);
    rtcCommitGeometry(geometry.get());
    return geometry;
}

/// Multiplies what the texel under the hit lets through; spec of alpha shadows and light filters.
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

/// A packet on its way through see-through surfaces. The Embree context comes first, so that the filter gets this
/// record.
struct FilterContext {
    EmbreeContext embree;
    const Triangles *triangles[2]; // kFilters, kFilterPatches
    const SurfaceTable *table;
    struct Crossing {
        int surface;
        float distance;
    };
    struct Ray {
        Vec3f tint{1, 1, 1};
        std::vector<Crossing> crossings;
    };
    std::array<Ray, kPacketSize> rays;
};

void FilterHit(const RTCFilterFunctionNArguments *arguments) {
    auto &context = *reinterpret_cast<FilterContext *>(arguments->context);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (arguments->valid[i] != -1)
            continue;
        const bool patch = RTCHitN_geomID(arguments->hit, arguments->N, i) == kFilterPatches;
        const Triangles &triangles = *context.triangles[patch ? 1 : 0];
        const unsigned primitive = RTCHitN_primID(arguments->hit, arguments->N, i);
        const float distance = RTCRayN_tfar(arguments->ray, arguments->N, i);
        FilterContext::Ray &ray = context.rays[RTCRayN_id(arguments->ray, arguments->N, i)];
        const int surface = triangles.surface[primitive];
        const auto same = [&](const FilterContext::Crossing &c) {
            return c.surface == surface && std::abs(c.distance - distance) < kSameHit;
        };
        if (std::none_of(ray.crossings.begin(), ray.crossings.end(), same)) {
            ray.crossings.push_back({surface, distance});
            ray.tint = ray.tint * FilterAt(*(*context.table)[std::size_t(surface)].shader, triangles.st[primitive],
                                           RTCHitN_u(arguments->hit, arguments->N, i),
                                           RTCHitN_v(arguments->hit, arguments->N, i));
        }
        if (MaxComponent(ray.tint) > kOpaqueTint)
            arguments->valid[i] = 0;
    }
}

} // namespace

struct LightScene::State {
    const SurfaceTable table;
    float legacyIgnoreRadius;
    bool trace;
    std::array<Triangles, kGeometries> triangles; // by GeometryId
    DevicePtr device;
    std::array<GeometryPtr, kGeometries> geometries;
    ScenePtr legacySolids, surfaces, all, skies, filters, filtersWithoutPatches;

    State(const SurfaceTable &t, float radius, bool traces) : table(t), legacyIgnoreRadius(radius), trace(traces) {}

    ScenePtr MakeScene(std::initializer_list<GeometryId> ids) const {
        ScenePtr scene(rtcNewScene(device.get()));
        rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
        bool any = false;
        for (const GeometryId id : ids)
            if (geometries[id]) {
                rtcAttachGeometryByID(scene.get(), geometries[id].get(), id);
                any = true;
            }
        if (!any)
            return nullptr;
        rtcCommitScene(scene.get());
        return scene;
    }

    void Tint(RayPacket &packet, const ScenePtr &scene, float nearest) const;
};

namespace {

bool CastsShadow(const SurfaceEntry &entry, const bspShader_t &record, std::uint32_t noDrawBit) {
    const std::uint32_t flags = entry.shader->compileFlags;
    const bool seeThrough = (flags & (C_ALPHASHADOW | C_LIGHTFILTER)) != 0;
    return entry.castShadows > 0 && !entry.skyBoxCopy && (flags & C_NODRAW) == 0 &&
           ((flags & C_TRANSLUCENT) == 0 || seeThrough) && (record.surfaceFlags & noDrawBit) == 0;
}

GeometryId KindOf(const ShaderInfo &shader, bool patch) {
    if ((shader.compileFlags & C_SKY) != 0)
        return kSkies;
    const bool filter = (shader.compileFlags & (C_ALPHASHADOW | C_LIGHTFILTER)) != 0 && shader.imageFound;
    return filter ? (patch ? kFilterPatches : kFilters) : (patch ? kPatches : kSurfaces);
}

struct Corner {
    Vec3f xyz;
    std::array<float, 2> st;
};

void AddTriangle(Triangles &triangles, bool sky, int surface, const Corner &a, const Corner &b, const Corner &c) {
    Vec3f lift;
    if (sky)
        lift = Normalize(Cross(c.xyz - a.xyz, b.xyz - a.xyz)) * kSkyLift;
    triangles.Add(a.xyz + lift, b.xyz + lift, c.xyz + lift, surface);
    triangles.st.push_back({a.st[0], a.st[1], b.st[0], b.st[1], c.st[0], c.st[1]});
}

void AddSurface(const Bsp &bsp, int number, const SurfaceEntry &entry, std::array<Triangles, kGeometries> &triangles) {
    const bspDrawSurface_t &surface = bsp.drawSurfaces[std::size_t(number)];
    const bool patch = surface.surfaceType == MST_PATCH;
    const GeometryId kind = KindOf(*entry.shader, patch);
    const bool sky = kind == kSkies;
    if (patch) {
        const Mesh mesh = TessellatePatch(bsp, surface, entry.longestCurve);
        const auto corner = [&](const MeshVert &v) { return Corner{v.xyz + entry.origin, v.st}; };
        for (int y = 0; y + 1 < mesh.height; ++y)
            for (int x = 0; x + 1 < mesh.width; ++x) {
                const auto q = MeshQuad(mesh, x, y);
                AddTriangle(triangles[kind], sky, number, corner(q[0]), corner(q[1]), corner(q[2]));
                AddTriangle(triangles[kind], sky, number, corner(q[0]), corner(q[2]), corner(q[3]));
            }
        return;
    }
    if (surface.surfaceType != MST_PLANAR && surface.surfaceType != MST_TRIANGLE_SOUP)
        return;
    for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
        std::array<Corner, 3> c;
        for (int k = 0; k < 3; ++k) {
            const int index = bsp.drawIndexes[std::size_t(surface.firstIndex + i + k)];
            const bspDrawVert_t &v = bsp.drawVerts[std::size_t(surface.firstVert + index)];
            c[std::size_t(k)] = {Vec3f(v.xyz) + entry.origin, v.st};
        }
        AddTriangle(triangles[kind], sky, number, c[0], c[1], c[2]);
    }
}

void AddSolids(const Bsp &bsp, const std::vector<bool> &solidLeafs, Triangles &triangles) {
    for (const Winding<double> &w : SolidHull(bsp, solidLeafs))
        for (std::size_t i = 2; i < w.size(); ++i)
            triangles.Add(Vec3f(w[0]), Vec3f(w[i - 1]), Vec3f(w[i]), -1);
}

/// Solid leafs as the established program sees them: without those that surfaces sunk into walls have opened.
std::vector<bool> LegacySolidLeafs(const Bsp &bsp, const std::array<Triangles, kGeometries> &triangles) {
    std::vector<int> counts(bsp.leafs.size());
    for (const GeometryId id : {kSurfaces, kPatches, kSkies, kFilters, kFilterPatches})
        for (std::size_t i = 0; i < triangles[id].Count(); ++i) {
            const float *c = triangles[id].corners.data() + 9 * i;
            CountTriangles(bsp, {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}}, kLostLeafEpsilon, counts);
        }
    std::vector<bool> solid = SolidLeafs(bsp);
    for (std::size_t i = 0; i < solid.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (counts[i] >= kLostLeafTriangles &&
                std::int64_t(bsp.leafs[i].maxs[axis]) - bsp.leafs[i].mins[axis] > kLostLeafSize)
                solid[i] = false;
    return solid;
}

void FillRays(const RayPacket &packet, float nearest, RTCRay16 &rays) {
    const auto row = [](const Lanes &from, float *to) { std::copy(from.begin(), from.end(), to); };
    row(packet.origin.x, rays.org_x), row(packet.origin.y, rays.org_y), row(packet.origin.z, rays.org_z);
    row(packet.direction.x, rays.dir_x), row(packet.direction.y, rays.dir_y), row(packet.direction.z, rays.dir_z);
    row(packet.distance, rays.tfar);
    std::fill_n(rays.tnear, kPacketSize, nearest);
    std::fill_n(rays.time, kPacketSize, 0.0f);
    std::fill_n(rays.mask, kPacketSize, ~0u);
    std::fill_n(rays.flags, kPacketSize, 0u);
    std::iota(rays.id, rays.id + kPacketSize, 0u);
}

/// Rays of the packet that something in the scene blocks live no longer.
void EndBlocked(RTCScene scene, RayPacket &packet, float nearest) {
    alignas(64) RTCRay16 rays;
    FillRays(packet, nearest, rays);
    EmbreeContext context;
    InitContext(context);
    Occluded16(packet.live.data(), scene, context, rays);
    for (std::size_t i = 0; i < kPacketSize; ++i)
        packet.live[i] = rays.tfar[i] < 0 ? 0 : packet.live[i];
}

/// Nearest hit of every live ray.
void FindNearest(RTCScene scene, const RayPacket &packet, float nearest, RTCRayHit16 &hits) {
    FillRays(packet, nearest, hits.ray);
    std::fill(std::begin(hits.hit.geomID), std::end(hits.hit.geomID), RTC_INVALID_GEOMETRY_ID);
    EmbreeContext context;
    InitContext(context);
    Intersect16(packet.live.data(), scene, context, hits);
}

} // namespace

LightScene::LightScene(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, float legacyIgnoreRadius)
    : state_(std::make_unique<State>(table, legacyIgnoreRadius, !options.noTrace)) {
    State &s = *state_;
    AddSolids(bsp, SolidLeafs(bsp), s.triangles[kSolids]);
    for (std::size_t i = 0; i < table.size(); ++i) {
        const bool sky = (table[i].shader->compileFlags & C_SKY) != 0;
        const bspDrawSurface_t &surface = bsp.drawSurfaces[i];
        const bool patch = surface.surfaceType == MST_PATCH;
        if (!CastsShadow(table[i], bsp.shaders[std::size_t(surface.shaderNum)], options.noDrawSurfaceFlags) ||
            (patch && !options.patchShadows) || (options.noSurfaces && !sky))
            continue;
        AddSurface(bsp, int(i), table[i], s.triangles);
    }
    AddSolids(bsp, LegacySolidLeafs(bsp, s.triangles), s.triangles[kLegacySolids]);
    s.device.reset(rtcNewDevice("threads=1"));
    if (!s.device)
        throw Error("Embree: cannot make a device");
    for (std::size_t id = 0; id < s.geometries.size(); ++id)
        if (s.triangles[id].Count() > 0) {
            s.geometries[id] = MakeGeometry(s.device.get(), s.triangles[id]);
            if (id == kFilters || id == kFilterPatches) {
                rtcSetGeometryOccludedFilterFunction(s.geometries[id].get(), FilterHit);
                rtcCommitGeometry(s.geometries[id].get());
            } else
                s.triangles[id].corners = {};
        }
    s.legacySolids = s.MakeScene({kLegacySolids});
    s.surfaces = s.MakeScene({kSurfaces});
    s.all = s.MakeScene({kSolids, kSurfaces, kPatches});
    s.skies = s.MakeScene({kSkies});
    s.filters = s.MakeScene({kFilters, kFilterPatches});
    s.filtersWithoutPatches = s.MakeScene({kFilters});
}

LightScene::~LightScene() = default;

void LightScene::State::Tint(RayPacket &packet, const ScenePtr &scene, float nearest) const {
    if (!scene || !packet.live.Any())
        return;
    FilterContext context;
    InitContext(context.embree);
    context.triangles[0] = &triangles[kFilters];
    context.triangles[1] = &triangles[kFilterPatches];
    context.table = &table;
    alignas(64) RTCRay16 rays;
    FillRays(packet, nearest, rays);
    Occluded16(packet.live.data(), scene.get(), context.embree, rays);
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        packet.live[i] = rays.tfar[i] < 0 ? 0 : packet.live[i];
        packet.tint.Set(i, context.rays[i].tint);
        packet.tinted = packet.tinted || (packet.live[i] != 0 && !context.rays[i].crossings.empty());
    }
}

void LightScene::TraceToLight(RayPacket &packet, ShadowRules rules, RayCounts &counts) const {
    packet.tinted = false;
    const State &s = *state_;
    if (!s.trace)
        return;
    counts.rays += std::uint64_t(packet.live.Count());
    if (rules == ShadowRules::Exact) {
        if (s.all)
            EndBlocked(s.all.get(), packet, 0);
        s.Tint(packet, s.filters, 0);
        return;
    }
    if (s.legacySolids)
        EndBlocked(s.legacySolids.get(), packet, 0);
    if (s.surfaces)
        EndBlocked(s.surfaces.get(), packet, s.legacyIgnoreRadius);
    s.Tint(packet, s.filtersWithoutPatches, s.legacyIgnoreRadius);
}

void LightScene::TraceToSky(RayPacket &packet, int skyIndex, ShadowRules rules, RayCounts &counts) const {
    packet.tinted = false;
    const State &s = *state_;
    if (!s.trace)
        return;
    counts.rays += std::uint64_t(packet.live.Count());
    if (!s.skies) {
        packet.live = {};
        return;
    }
    const bool exact = rules == ShadowRules::Exact;
    const float nearest = exact ? 0 : s.legacyIgnoreRadius;
    alignas(64) RTCRayHit16 hits;
    if (!exact && s.legacySolids) {
        FindNearest(s.legacySolids.get(), packet, 0, hits);
        for (std::size_t i = 0; i < kPacketSize; ++i)
            packet.distance[i] = std::min(packet.distance[i], hits.ray.tfar[i] + kSkySlack);
    }
    // Skies are few triangles, so their nearest hit is cheap; then blockers up to there need not be the nearest.
    FindNearest(s.skies.get(), packet, nearest, hits);
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        if (packet.live[i] == 0)
            continue;
        bool lit = hits.hit.geomID[i] == kSkies;
        if (lit && skyIndex >= 0)
            lit = s.table[std::size_t(s.triangles[kSkies].surface[hits.hit.primID[i]])].skyIndex == skyIndex;
        packet.live.Set(i, lit);
        packet.distance[i] = hits.ray.tfar[i];
    }
    if (const ScenePtr &blockers = exact ? s.all : s.surfaces; blockers && packet.live.Any())
        EndBlocked(blockers.get(), packet, nearest);
    s.Tint(packet, exact ? s.filters : s.filtersWithoutPatches, nearest);
}

void LightScene::TraceDistance(RayPacket &packet, float ignoreRadius, RayCounts &counts) const {
    const State &s = *state_;
    counts.rays += std::uint64_t(packet.live.Count());
    if (!s.all)
        return;
    alignas(64) RTCRayHit16 blockers, skies;
    FindNearest(s.all.get(), packet, ignoreRadius, blockers);
    RayPacket toSky = packet;
    std::copy_n(blockers.ray.tfar, kPacketSize, toSky.distance.begin());
    if (s.skies)
        FindNearest(s.skies.get(), toSky, ignoreRadius, skies);
    for (std::size_t i = 0; i < kPacketSize; ++i)
        if (packet.live[i] != 0 && blockers.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID &&
            !(s.skies && skies.hit.geomID[i] == kSkies))
            packet.distance[i] = blockers.ray.tfar[i];
}

std::size_t LightScene::TriangleCount() const {
    std::size_t count = 0;
    for (const GeometryId id : {kSolids, kSurfaces, kPatches, kSkies, kFilters, kFilterPatches})
        count += state_->triangles[id].Count();
    return count;
}

} // namespace q3
