// GPL-2.0-or-later. Path traced light at luxels and positions of a map.
#include "tools/bounce_error/reference.h"

#include "common/cpu_time.h"
#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/lightmap/bounce/bounce_scene.h"
#include "tools/shbench/map_hash.h"

#include <algorithm>
#include <cstring>

namespace q3::bounce {

namespace {

/// Change it with the computation of the reference or the file format: it invalidates old files.
constexpr std::string_view kVersion = "bounce_error reference 1";

struct MappedTriangle {
    int surface = 0;
    std::array<FaceCorner, 3> corners;
};

void AddReflection(bench::Hash &hash, const SurfaceInputs &in) {
    hash.Value(in.lightmap.bounceScale), hash.Value(in.lightmap.bounceColorRatio), hash.Value(in.lightmap.sRgbTexture);
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

std::string KeyOf(const SurfaceInputs &in, const DirectLights &lights, const Receivers &receivers, int paths) {
    bench::Hash hash;
    hash.Value(kVersion), hash.Value(paths);
    bench::AddGeometry(hash, in.bsp);
    bench::AddSurfaces(hash, in.table);
    AddReflection(hash, in);
    for (const Light &light : lights.Lights()) {
        bench::AddLight(hash, light);
        hash.Value(light.envelope), hash.Value(light.fast), hash.Value(light.tolerance);
        hash.Value(light.angle), hash.Value(light.angleScale);
    }
    for (const LuxelReceiver &one : receivers.luxels)
        hash.Value(one.position), hash.Value(one.normal);
    for (const Vec3f &position : receivers.positions)
        hash.Value(position);
    return hash.Hex();
}

/// Header of a file; the estimates of luxels, then of positions follow.
struct ReferenceHead {
    std::array<char, 64> key;
    double cpuSeconds;
    std::uint64_t luxels, positions;
};

bool LoadReference(const std::filesystem::path &path, const std::string &key, Reference &reference) {
    static_assert(std::is_trivially_copyable_v<Estimate> && std::is_trivially_copyable_v<PositionEstimate>);
    if (!std::filesystem::exists(path))
        return false;
    const std::vector<std::byte> bytes = ReadFile(path);
    const std::size_t luxels = reference.luxels.size() * sizeof(Estimate);
    const std::size_t positions = reference.positions.size() * sizeof(PositionEstimate);
    ReferenceHead head;
    if (bytes.size() != sizeof head + luxels + positions)
        return false;
    std::memcpy(&head, bytes.data(), sizeof head);
    if (std::string_view(head.key.data(), head.key.size()) != key)
        return false;
    reference.cpuSeconds = head.cpuSeconds;
    std::copy_n(bytes.data() + sizeof head, luxels, reinterpret_cast<std::byte *>(reference.luxels.data()));
    std::copy_n(bytes.data() + sizeof head + luxels, positions,
                reinterpret_cast<std::byte *>(reference.positions.data()));
    return true;
}

void StoreReference(const std::filesystem::path &path, const std::string &key, const Reference &reference) {
    ReferenceHead head{{}, reference.cpuSeconds, reference.luxels.size(), reference.positions.size()};
    std::memcpy(head.key.data(), key.data(), head.key.size());
    std::vector<std::byte> bytes;
    const auto add = [&](const void *data, std::size_t size) {
        const auto *first = static_cast<const std::byte *>(data);
        bytes.insert(bytes.end(), first, first + size);
    };
    add(&head, sizeof head);
    add(reference.luxels.data(), reference.luxels.size() * sizeof(Estimate));
    add(reference.positions.data(), reference.positions.size() * sizeof(PositionEstimate));
    std::error_code failed;
    std::filesystem::create_directories(path.parent_path(), failed);
    if (failed)
        throw Error("{}: {}", path.parent_path().string(), failed.message());
    ReplaceFile(path, bytes);
}

} // namespace

std::vector<LuxelReceiver> LuxelsByArea(const SurfaceInputs &in, const SurfaceLight &surfaces, int count,
                                        std::uint64_t seed) {
    std::vector<MappedTriangle> triangles;
    std::vector<double> areas;
    double area = 0;
    for (std::size_t s = 0; s < in.bsp.drawSurfaces.size(); ++s) {
        if (surfaces.lightmapOf[s] < 0)
            continue;
        for (const Face &face : FacesOf(in, surfaces, s))
            for (std::size_t i = 2; i < face.size(); ++i) {
                triangles.push_back({int(s), {face[0], face[i - 1], face[i]}});
                area += double(Length(Cross(face[i - 1].xyz - face[0].xyz, face[i].xyz - face[0].xyz))) / 2;
                areas.push_back(area);
            }
    }
    constexpr int kTries = 100; // for each luxel
    PathRandom random(seed);
    std::vector<LuxelReceiver> luxels;
    for (std::int64_t tries = 0; int(luxels.size()) < count && tries < std::int64_t(kTries) * count; ++tries) {
        const double at = random.Unit() * area, root = std::sqrt(random.Unit()), part = random.Unit();
        const auto number = std::size_t(std::upper_bound(areas.begin(), areas.end(), at) - areas.begin());
        if (number >= triangles.size())
            continue;
        const MappedTriangle &triangle = triangles[number];
        const std::array<double, 3> weights{1 - root, root * (1 - part), root * part};
        const auto lightmap = std::size_t(surfaces.lightmapOf[std::size_t(triangle.surface)]);
        const RawLightmap &raw = surfaces.lightmaps[lightmap];
        std::array<int, 2> luxel{};
        for (std::size_t axis = 0; axis < 2; ++axis) {
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k)
                sum += weights[k] * double(triangle.corners[k].luxel[axis]);
            luxel[axis] = std::clamp(int(sum), 0, (axis == 0 ? raw.SuperWidth() : raw.SuperHeight()) - 1);
        }
        const std::size_t index = raw.SuperIndex(luxel[0], luxel[1]);
        if (raw.Mapped(index))
            luxels.push_back({lightmap, index, triangle.surface, raw.positions[index], raw.normals[index]});
    }
    return luxels;
}

Reference MakeReference(const SurfaceInputs &in, const PathTracer &tracer, const DirectLights &lights,
                        const Receivers &receivers, int paths, const std::filesystem::path &cache) {
    Reference reference;
    reference.luxels.resize(receivers.luxels.size());
    reference.positions.resize(receivers.positions.size());
    const std::string key = KeyOf(in, lights, receivers, paths);
    const std::filesystem::path path = cache / (key + ".bounce");
    if (!cache.empty() && LoadReference(path, key, reference)) {
        reference.fromCache = true;
        return reference;
    }
    const CpuTimer timer;
    in.jobs.For(std::int64_t(receivers.luxels.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        const LuxelReceiver &luxel = receivers.luxels[i];
        reference.luxels[i] = tracer.OnSurface(luxel.position, luxel.normal, paths, i);
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
    if (!cache.empty())
        StoreReference(path, key, reference);
    return reference;
}

} // namespace q3::bounce
