// GPL-2.0-or-later. Cache of reference light: files named by a hash of everything that it depends on.
#include "common/error.h"
#include "common/files/files.h"
#include "tools/measure/shbench/map_hash.h"
#include "tools/measure/shbench/truth.h"

#include <cstring>
#include <type_traits>

namespace q3::bench {

namespace {

/// Change it with the computation of the reference or the file format: it invalidates old files.
constexpr std::string_view kVersion = "shbench truth 1";

void AddWorld(Hash &hash, const WorldLight &world, const LightOptions &options) {
    hash.Value(world.ambient), hash.Value(world.minGrid), hash.Value(world.hasFloodlight);
    hash.Value(world.floodColor), hash.Value(world.floodDistance), hash.Value(world.floodIntensity);
    hash.Value(options.floodlight), hash.Value(options.lowQuality), hash.Value(options.gridScale);
    hash.Value(options.noTrace), hash.Value(options.structuralShadowsOnly), hash.Value(options.sunOnly);
    hash.Value(options.patchShadows), hash.Value(options.noDrawSurfaceFlags);
}

/// Header of a file; the points follow.
struct FileHead {
    std::array<char, 64> key; // hexadecimal digits of a SHA-256
    double noise, cpuSeconds;
    std::uint64_t rays, points;
};

std::optional<Truth> Load(const std::filesystem::path &path, const std::string &key) {
    if (!std::filesystem::exists(path))
        return std::nullopt;
    const std::vector<std::byte> bytes = ReadFile(path);
    FileHead head;
    if (bytes.size() < sizeof head)
        return std::nullopt;
    std::memcpy(&head, bytes.data(), sizeof head);
    const std::size_t left = bytes.size() - sizeof head;
    if (std::string_view(head.key.data(), head.key.size()) != key || left % sizeof(TruthPoint) != 0 ||
        head.points != left / sizeof(TruthPoint))
        return std::nullopt;
    Truth truth;
    truth.noise = head.noise, truth.rays = head.rays, truth.cpuSeconds = head.cpuSeconds;
    truth.points.resize(head.points);
    std::memcpy(truth.points.data(), bytes.data() + sizeof head, left);
    return truth;
}

void Store(const std::filesystem::path &path, const std::string &key, const Truth &truth) {
    FileHead head{{}, truth.noise, truth.cpuSeconds, truth.rays, truth.points.size()};
    std::memcpy(head.key.data(), key.data(), head.key.size());
    std::vector<std::byte> bytes(sizeof head + truth.points.size() * sizeof(TruthPoint));
    std::memcpy(bytes.data(), &head, sizeof head);
    std::memcpy(bytes.data() + sizeof head, truth.points.data(), truth.points.size() * sizeof(TruthPoint));
    MakeFolder(path.parent_path());
    ReplaceFile(path, bytes);
}

} // namespace

std::string TruthKey(const BenchMap &map, const TruthSettings &settings) {
    static_assert(std::is_trivially_copyable_v<TruthPoint>);
    Hash hash;
    hash.Value(kVersion);
    hash.Value(settings.positions), hash.Value(settings.seed), hash.Value(settings.noise);
    AddGeometry(hash, map.bsp);
    AddSurfaces(hash, map.table);
    AddWorld(hash, map.world, map.options);
    hash.Value(map.lights.size());
    for (const Light &light : map.lights)
        AddLight(hash, light);
    return hash.Hex();
}

Truth CachedTruth(const BenchMap &map, const TruthSettings &settings, const JobPool &jobs,
                  const std::filesystem::path &folder, bool &fromCache) {
    fromCache = false;
    const std::string key = TruthKey(map, settings);
    const std::filesystem::path path = folder / (key + ".truth");
    if (!folder.empty())
        if (auto stored = Load(path, key)) {
            fromCache = true;
            return std::move(*stored);
        }
    Truth truth = MakeTruth(map, settings, jobs);
    if (!folder.empty())
        Store(path, key, truth);
    return truth;
}

} // namespace q3::bench
