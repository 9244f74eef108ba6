// GPL-2.0-or-later. Reference: path traced light at luxels and positions of a map, kept in a cache.
#include "tools/measure/bounce_error/reference.h"

#include "common/platform/platform.h"
#include "q3map2/lightmap/bounce/bounce_scene.h"
#include "tools/measure/bounce_error/record_cache.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace q3::bounce {

namespace {

/// Change this with the computation of the reference or the file format, to invalidate cached files.
constexpr std::string_view kVersion = "bounce_error reference 4";

struct MappedTriangle {
    int surface = 0;
    std::array<FaceCorner, 3> corners;
};

void AddReflection(bench::Hash &hash, const SurfaceInputs &in) {
    hash.Value(in.lightmap.bounceScale), hash.Value(in.lightmap.bounceColorRatio), hash.Value(in.lightmap.sRgbTexture);
    hash.Value(in.lightmap.linearReflectance);
    hash.Value(in.options.noDrawSurfaceFlags), hash.Value(in.options.patchShadows), hash.Value(in.options.noTrace);
    for (const SurfaceEntry &entry : in.table) {
        const ShaderInfo &shader = *entry.shader;
        hash.Value(shader.bounceScale), hash.Value(shader.twoSided), hash.Value(shader.autosprite);
        hash.Value(shader.averageColor), hash.Value(shader.imageFound), hash.Value(shader.lightmap.sampleOffset);
        hash.Value(entry.ambient), hash.Value(entry.receiveShadows);
        if (shader.imageFound && shader.lightImage)
            hash.Value(shader.lightImage->width), hash.Records(shader.lightImage->rgba);
    }
}

void AddReceiver(bench::Hash &hash, const LuxelReceiver &luxel) {
    hash.Value(luxel.normal), hash.Value(luxel.places.size());
    for (const Vec3f &place : luxel.places)
        hash.Value(place);
}

std::string KeyOf(const SurfaceInputs &in, const DirectLights &lights, const Receivers &receivers, int paths) {
    bench::Hash hash;
    hash.Value(kVersion), hash.Value(paths);
    bench::AddGeometry(hash, in.bsp);
    bench::AddSurfaces(hash, in.table);
    AddReflection(hash, in);
    AddLights(hash, lights.Lights());
    for (const LuxelReceiver &one : receivers.luxels)
        AddReceiver(hash, one);
    for (const Vec3f &position : receivers.positions)
        hash.Value(position);
    return hash.Hex();
}

/// Triangles of surfaces with lightmaps, to be drawn by area.
class MappedArea {
  public:
    MappedArea(const SurfaceInputs &in, const SurfaceLight &surfaces) {
        for (std::size_t s = 0; s < in.bsp.drawSurfaces.size(); ++s)
            if (surfaces.lightmapOf[s] >= 0)
                for (const Face &face : FacesOf(in, surfaces, s))
                    for (std::size_t i = 2; i < face.size(); ++i)
                        Add({int(s), {face[0], face[i - 1], face[i]}});
    }
    bool Empty() const { return triangles_.empty() || !(areas_.back() > 0); }
    struct Point {
        int surface = 0;
        Vec3f position, normal; ///< position: 1 unit off the surface
        std::array<float, 2> luxel{};
    };
    /// A point uniform by area. In a triangle, of uniform u and v: weights 1 - sqrt u, sqrt u (1 - v), sqrt u v of the
    /// corners (Turk, 1990).
    Point Draw(PathRandom &random) const {
        const double at = random.Unit() * areas_.back(), rootU = std::sqrt(random.Unit()), v = random.Unit();
        const auto number = std::size_t(std::upper_bound(areas_.begin(), areas_.end(), at) - areas_.begin());
        const MappedTriangle &triangle = triangles_[std::min(number, triangles_.size() - 1)];
        const std::array<double, 3> weights{1 - rootU, rootU * (1 - v), rootU * v};
        Point point{triangle.surface, {}, {}, {}};
        for (std::size_t k = 0; k < 3; ++k) {
            const FaceCorner &corner = triangle.corners[k];
            point.position += corner.xyz * float(weights[k]), point.normal += corner.normal * float(weights[k]);
            for (std::size_t axis = 0; axis < 2; ++axis)
                point.luxel[axis] += float(weights[k]) * corner.luxel[axis];
        }
        point.normal = Normalize(point.normal);
        point.position += point.normal;
        return point;
    }

  private:
    void Add(const MappedTriangle &triangle) {
        const auto &c = triangle.corners;
        triangles_.push_back(triangle);
        areas_.push_back((areas_.empty() ? 0 : areas_.back()) +
                         double(Length(Cross(c[1].xyz - c[0].xyz, c[2].xyz - c[0].xyz))) / 2);
    }
    std::vector<MappedTriangle> triangles_;
    std::vector<double> areas_; // running sum
};

/// A place is not clear if a solid is this near. Game units.
constexpr float kPlaceMargin = 0.25f;
/// A place is not clear if a larger share of rays from it hits backs of surfaces: it is behind them.
constexpr double kMaxBackShare = 0.25;
constexpr int kPlaceRays = 64;         ///< rays that look for backs
constexpr int kPlaceTries = 64;        ///< places on a luxel that are tried, until kMaxPlaces of them are clear
constexpr std::size_t kMaxPlaces = 16; ///< of a luxel

} // namespace

bool IsClear(const SurfaceInputs &in, const PathScene &scene, const Vec3f &place, const Vec3f &normal) {
    const Vec3f margin{kPlaceMargin, kPlaceMargin, kPlaceMargin};
    if (in.space.AnySolid(place - margin, place + margin))
        return false;
    int backs = 0;
    for (int first = 0; first < kPlaceRays; first += int(kPacketSize)) {
        RayPacket rays;
        for (std::size_t i = 0; i < kPacketSize; ++i)
            rays.Set(i, place, CosineDirection(normal, PlasticSample(std::uint32_t(first) + std::uint32_t(i), 0)),
                     kRayLength);
        backs += scene.CountBackHits(rays);
    }
    return backs <= int(kMaxBackShare * kPlaceRays);
}

std::vector<Vec3f> PlacesOf(const SurfaceInputs &in, const PathScene &scene, const RawLightmap &raw,
                            std::size_t luxel) {
    const Vec3f position = raw.positions[luxel], normal = raw.normals[luxel];
    if (IsClear(in, scene, position, normal))
        return {position};
    const float size = raw.actualSampleSize / float(raw.super);
    const Vec3f axis = std::abs(normal.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1};
    const Vec3f right = Normalize(Cross(axis, normal));
    const Vec3f u = raw.hasVectors ? raw.step[0] : right * size;
    const Vec3f v = raw.hasVectors ? raw.step[1] : Cross(normal, right) * size;
    std::vector<Vec3f> places;
    for (std::uint32_t i = 0; i < std::uint32_t(kPlaceTries) && places.size() < kMaxPlaces; ++i) {
        const Sample2 s = PlasticSample(i, luxel);
        const Vec3f place = position + u * float(s.u - 0.5) + v * float(s.v - 0.5);
        if (IsClear(in, scene, place, normal))
            places.push_back(place);
    }
    return places;
}

std::vector<LuxelReceiver> LuxelsByArea(const SurfaceInputs &in, const SurfaceLight &surfaces, const PathScene &scene,
                                        int count, std::uint64_t seed, double *hiddenShare) {
    constexpr int kTries = 100; // at most, for each luxel wanted
    const MappedArea area(in, surfaces);
    PathRandom random(seed);
    std::vector<LuxelReceiver> luxels;
    double hidden = 0;
    for (std::int64_t tries = 0; int(luxels.size()) < count && tries < std::int64_t(kTries) * count && !area.Empty();
         ++tries) {
        const MappedArea::Point at = area.Draw(random);
        const auto lightmap = std::size_t(surfaces.lightmapOf[std::size_t(at.surface)]);
        const RawLightmap &raw = surfaces.lightmaps[lightmap];
        const std::size_t luxel = raw.SuperIndex(std::clamp(int(at.luxel[0]), 0, raw.SuperWidth() - 1),
                                                 std::clamp(int(at.luxel[1]), 0, raw.SuperHeight() - 1));
        if (!raw.Mapped(luxel))
            continue;
        if (!IsClear(in, scene, at.position, at.normal)) {
            hidden += 1;
            continue;
        }
        std::vector<Vec3f> places = PlacesOf(in, scene, raw, luxel);
        if (places.empty())
            places = {at.position};
        luxels.push_back({lightmap, luxel, at.surface, raw.positions[luxel], raw.normals[luxel], std::move(places)});
    }
    if (hiddenShare)
        *hiddenShare = hidden / std::max(1.0, hidden + double(luxels.size()));
    return luxels;
}

Reference MakeReference(const SurfaceInputs &in, const PathTracer &tracer, const DirectLights &lights,
                        const Receivers &receivers, int paths, const std::filesystem::path &cache) {
    Reference reference;
    reference.luxels.resize(receivers.luxels.size());
    reference.positions.resize(receivers.positions.size());
    const RecordCache kept(cache, KeyOf(in, lights, receivers, paths), "bounce");
    const std::array parts{RecordBytes(reference.luxels), RecordBytes(reference.positions)};
    reference.fromCache = kept.Load(parts, reference.cpuSeconds);
    if (reference.fromCache)
        return reference;
    const CpuTimer timer;
    in.jobs.For(std::int64_t(receivers.luxels.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        const LuxelReceiver &luxel = receivers.luxels[i];
        reference.luxels[i] = tracer.OnSurface(luxel.places, luxel.normal, paths, i);
    });
    std::vector<Vec3f> normals;
    for (const Vec3d &normal : bench::Normals())
        normals.push_back(Vec3f(normal));
    in.jobs.For(std::int64_t(receivers.positions.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        const auto found = tracer.InSpace(receivers.positions[i], normals, paths, ~std::uint64_t(i));
        std::copy(found.begin(), found.end(), reference.positions[i].begin());
    });
    reference.cpuSeconds = timer.Seconds();
    kept.Store(parts, reference.cpuSeconds);
    return reference;
}

} // namespace q3::bounce
