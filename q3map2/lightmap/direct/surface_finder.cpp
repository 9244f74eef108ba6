// GPL-2.0-or-later. Finds the drawn surface at a place, and its luxels there.
#include "q3map2/lightmap/direct/surface_finder.h"

#include "q3map2/light/scene/light_embree.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

struct FinderTriangle {
    int surface = 0;
    std::array<FaceCorner, 3> corners;
    Vec3f front; // normal on the front side, not normalized
};

} // namespace

struct SurfaceFinder::State {
    std::vector<FinderTriangle> triangles;
    DevicePtr device;
    ScenePtr scene;

    void Add(int surface, const Face &face) {
        Vec3f front;
        for (const FaceCorner &corner : face)
            front += corner.normal;
        for (std::size_t i = 2; i < face.size(); ++i) {
            const FaceCorner &a = face[0], &b = face[i - 1], &c = face[i];
            const Vec3f normal = Cross(c.xyz - a.xyz, b.xyz - a.xyz);
            triangles.push_back({surface, {a, b, c}, Dot(normal, front) < 0 ? -normal : normal});
        }
    }
    void Commit() {
        device = NewDevice();
        scene = NewScene(device.get());
        if (triangles.empty())
            return rtcCommitScene(scene.get());
        std::vector<float> corners;
        corners.reserve(9 * triangles.size());
        for (const FinderTriangle &triangle : triangles)
            for (const FaceCorner &corner : triangle.corners)
                corners.insert(corners.end(), {corner.xyz.x, corner.xyz.y, corner.xyz.z});
        const GeometryPtr geometry = NewTriangles(device.get(), corners);
        rtcAttachGeometry(scene.get(), geometry.get());
        rtcCommitScene(scene.get());
    }
};

SurfaceFinder::SurfaceFinder(const SurfaceInputs &in, const SurfaceLight &surfaces)
    : in_(in), surfaces_(surfaces), models_(in.bsp.drawSurfaces.size()) {
    FindModels();
    for (std::unique_ptr<State> &state : states_)
        state = std::make_unique<State>();
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i) {
        const bspShader_t &record = in.bsp.shaders[std::size_t(in.bsp.drawSurfaces[i].shaderNum)];
        const ShaderInfo &shader = *in.table[i].shader;
        if ((shader.compileFlags & (C_NODRAW | C_SKY)) != 0 || shader.autosprite || in.table[i].skyBoxCopy ||
            (record.surfaceFlags & in.options.noDrawSurfaceFlags) != 0)
            continue;
        for (const Face &face : FacesOf(in, surfaces, i))
            states_[IsTranslucent(int(i)) ? 1 : 0]->Add(int(i), face);
    }
    for (const std::unique_ptr<State> &state : states_)
        state->Commit();
}

SurfaceFinder::~SurfaceFinder() = default;

void SurfaceFinder::FindModels() {
    for (std::size_t m = 1; m < in_.bsp.models.size(); ++m) {
        const bspModel_t &model = in_.bsp.models[m];
        for (int i = std::max(0, model.firstBSPSurface);
             i < std::min(model.firstBSPSurface + model.numBSPSurfaces, int(models_.size())); ++i)
            models_[std::size_t(i)] = int(m);
    }
}

bool SurfaceFinder::IsTranslucent(int surface) const {
    return (in_.table[std::size_t(surface)].shader->compileFlags & C_TRANSLUCENT) != 0;
}

SurfaceFinder::Places SurfaceFinder::FirstHits(const RayPacket &rays, bool translucent) const {
    const State &state = *states_[translucent ? 1 : 0];
    alignas(64) RTCRayHit16 hits;
    SetRays(rays.origin, rays.direction, rays.distance, rays.live, 0, hits.ray);
    std::fill(std::begin(hits.hit.geomID), std::end(hits.hit.geomID), RTC_INVALID_GEOMETRY_ID);
    EmbreeContext context;
    InitContext(context);
    Intersect16(rays.live.data(), state.scene.get(), context, hits);
    Places places;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        if (rays.live[i] == 0 || hits.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID)
            continue;
        const FinderTriangle &triangle = state.triangles[hits.hit.primID[i]];
        if (!(Dot(triangle.front, rays.direction[i]) < 0))
            continue;
        SurfacePlace &place = places[i];
        place.surface = triangle.surface;
        place.lightmap = surfaces_.lightmapOf[std::size_t(triangle.surface)];
        const std::array<float, 3> weights{1 - hits.hit.u[i] - hits.hit.v[i], hits.hit.u[i], hits.hit.v[i]};
        for (std::size_t k = 0; k < 3; ++k) {
            const FaceCorner &corner = triangle.corners[k];
            place.position += corner.xyz * weights[k];
            place.normal += corner.normal * weights[k];
            for (std::size_t axis = 0; axis < 2; ++axis)
                place.luxel[axis] += corner.luxel[axis] * weights[k];
        }
        place.normal = Normalize(place.normal);
    }
    return places;
}

void SurfaceFinder::TraceOccluded(RayPacket &rays) const {
    alignas(64) RTCRay16 shadow;
    SetRays(rays.origin, rays.direction, rays.distance, rays.live, 0, shadow);
    EmbreeContext context;
    InitContext(context);
    Occluded16(rays.live.data(), states_[0]->scene.get(), context, shadow);
    for (const std::size_t i : kEachLane)
        rays.live[i] &= shadow.tfar[i] < 0 ? 0 : -1;
}

bool SurfaceFinder::FindTap(const SurfacePlace &place, LuxelTap &tap) const {
    const RawLightmap &raw = surfaces_.lightmaps[std::size_t(place.lightmap)];
    tap.lightmap = std::uint32_t(place.lightmap);
    const auto split = [](float at, int size, std::array<int, 2> &luxels, std::array<float, 2> &shares) {
        const float first = std::isfinite(at) ? std::floor(std::clamp(at - 0.5f, 0.0f, float(size - 1))) : 0;
        luxels = {int(first), std::min(int(first) + 1, size - 1)};
        shares[1] = std::isfinite(at) ? std::clamp(at - 0.5f - first, 0.0f, 1.0f) : 0;
        shares[0] = 1 - shares[1];
    };
    std::array<int, 2> x{}, y{};
    std::array<float, 2> across{}, down{};
    split(place.luxel[0], raw.SuperWidth(), x, across);
    split(place.luxel[1], raw.SuperHeight(), y, down);
    float sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t luxel = raw.SuperIndex(x[i & 1], y[i >> 1]);
        tap.luxels[i] = std::uint32_t(luxel);
        tap.weights[i] = raw.Mapped(luxel) ? across[i & 1] * down[i >> 1] : 0;
        sum += tap.weights[i];
    }
    for (float &weight : tap.weights)
        weight = sum > 0 ? weight / sum : 0;
    return sum > 0;
}

} // namespace q3
