// GPL-2.0-or-later. Cache of reference light: files named by a hash of everything that it depends on.
#include "common/error.h"
#include "common/files/files.h"
#include "tools/shbench/truth.h"

#include <glib.h>

#include <cstring>
#include <memory>
#include <type_traits>

namespace q3::bench {

namespace {

/// Change it with the computation of the reference or the file format: it invalidates old files.
constexpr std::string_view kVersion = "shbench truth 1";

class Hash {
  public:
    Hash() : sum_(g_checksum_new(G_CHECKSUM_SHA256), g_checksum_free) {}

    template <typename T> void Value(const T &value) {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        Bytes(&value, sizeof value);
    }
    void Value(const Vec3f &v) { Value(v.x), Value(v.y), Value(v.z); }
    void Value(std::string_view text) {
        Value(text.size());
        Bytes(text.data(), text.size());
    }
    template <typename T> void Records(const std::vector<T> &records) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
        Value(records.size());
        Bytes(records.data(), records.size() * sizeof(T));
    }
    std::string Hex() const { return g_checksum_get_string(sum_.get()); }

  private:
    void Bytes(const void *data, std::size_t size) {
        if (size > 0)
            g_checksum_update(sum_.get(), static_cast<const guchar *>(data), gssize(size));
    }
    std::unique_ptr<GChecksum, void (*)(GChecksum *)> sum_;
};

void AddGeometry(Hash &hash, const Bsp &bsp) {
    hash.Value(std::string_view(bsp.entities));
    hash.Records(bsp.shaders), hash.Records(bsp.planes), hash.Records(bsp.nodes), hash.Records(bsp.leafs);
    hash.Records(bsp.leafSurfaces), hash.Records(bsp.leafBrushes), hash.Records(bsp.models);
    hash.Records(bsp.brushes), hash.Records(bsp.brushSides);
    hash.Records(bsp.drawVerts), hash.Records(bsp.drawIndexes), hash.Records(bsp.drawSurfaces);
    hash.Records(bsp.visibility);
}

void AddSurfaces(Hash &hash, const SurfaceTable &table) {
    hash.Value(table.size());
    for (const SurfaceEntry &entry : table) {
        hash.Value(entry.origin), hash.Value(entry.castShadows), hash.Value(entry.longestCurve);
        hash.Value(entry.skyBoxCopy), hash.Value(entry.skyIndex), hash.Value(entry.shader->compileFlags);
        if ((entry.shader->compileFlags & (C_ALPHASHADOW | C_LIGHTFILTER)) == 0 || !entry.shader->lightImage)
            continue;
        hash.Value(entry.shader->imageFound), hash.Value(entry.shader->lightImage->width);
        hash.Records(entry.shader->lightImage->rgba);
    }
}

void AddLight(Hash &hash, const Light &light) {
    hash.Value(light.type), hash.Value(light.curve), hash.Value(light.twoSided), hash.Value(light.negative);
    hash.Value(light.color), hash.Value(light.photons), hash.Value(light.add);
    hash.Value(light.origin), hash.Value(light.normal), hash.Value(light.fade), hash.Value(light.radiusByDist);
    const Attenuation &k = light.attenuation;
    hash.Value(k.constant), hash.Value(k.linear), hash.Value(k.quadratic);
    hash.Value(k.flatFrom), hash.Value(k.fadeFrom), hash.Value(k.end);
    hash.Value(light.cone.byAngles), hash.Value(light.cone.cosInner), hash.Value(light.cone.cosOuter);
    hash.Value(light.cone.exponent);
    hash.Value(light.extraDist), hash.Value(light.skyIndex), hash.Value(light.w.size());
    for (const Vec3f &corner : light.w)
        hash.Value(corner);
}

void AddWorld(Hash &hash, const WorldLight &world, const LightOptions &options) {
    hash.Value(world.ambient), hash.Value(world.minGrid), hash.Value(world.hasFloodlight);
    hash.Value(world.floodColor), hash.Value(world.floodDistance), hash.Value(world.floodIntensity);
    hash.Value(options.floodlight), hash.Value(options.lowQuality), hash.Value(options.gridScale);
    hash.Value(options.noTrace), hash.Value(options.structuralShadowsOnly), hash.Value(options.sunOnly);
    hash.Value(options.patchShadows), hash.Value(options.noDrawSurfaceFlags);
}

/// Header of a file; the points follow.
struct FileHead {
    std::array<char, 64> key;
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
    std::error_code failed;
    std::filesystem::create_directories(path.parent_path(), failed);
    if (failed)
        throw Error("{}: {}", path.parent_path().string(), failed.message());
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
                  const std::filesystem::path &folder, bool &hit) {
    hit = false;
    const std::string key = TruthKey(map, settings);
    const std::filesystem::path path = folder / (key + ".truth");
    if (!folder.empty())
        if (auto stored = Load(path, key)) {
            hit = true;
            return std::move(*stored);
        }
    Truth truth = MakeTruth(map, settings, jobs);
    if (!folder.empty())
        Store(path, key, truth);
    return truth;
}

} // namespace q3::bench
