// GPL-2.0-or-later. -shade: phong shading of vertex normals.
#include "q3map2/lightmap/raw/lightmap_shade.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

namespace q3 {

namespace {

/// Vertices this near on each axis share a position. Game units.
constexpr float kSamePosition = 0.001f;
/// Normals whose components differ by less count once in the mean.
constexpr float kSameNormal = 0.01f;
/// Rounding of angles: normals at exactly the shading angle are not joined. Radians.
constexpr float kAngleSlack = 1e-6f;
/// Largest number of vertices that share one normal.
constexpr std::size_t kMaxGroup = 256;

/// Side of the hash cells that vertices are found by. Game units.
constexpr double kCell = 0.125;

bool Near(const Vec3f &a, const Vec3f &b, float epsilon) {
    return std::abs(a.x - b.x) < epsilon && std::abs(a.y - b.y) < epsilon && std::abs(a.z - b.z) < epsilon;
}

std::uint64_t CellKey(const Vec3f &p) {
    std::uint64_t key = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double cell = std::clamp(std::floor(double(p[i]) / kCell), -1e15, 1e15);
        key = key * 0x9E3779B97F4A7C15u + std::uint64_t(std::int64_t(cell));
    }
    return key;
}

/// Cells that positions within kSamePosition of p can be in, each once.
std::vector<std::uint64_t> CellsAround(const Vec3f &p) {
    std::vector<std::uint64_t> keys;
    for (const float x : {-kSamePosition, kSamePosition})
        for (const float y : {-kSamePosition, kSamePosition})
            for (const float z : {-kSamePosition, kSamePosition})
                keys.push_back(CellKey(p + Vec3f{x, y, z}));
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    return keys;
}

/// Shading angle of every vertex, radians; empty when all are 0.
std::vector<float> ShadeAngles(const SurfaceInputs &in) {
    std::vector<float> angles(in.bsp.drawVerts.size());
    bool any = false;
    for (std::size_t s = 0; s < in.table.size(); ++s) {
        const bspDrawSurface_t &surface = in.bsp.drawSurfaces[s];
        if (surface.surfaceType == MST_TRIANGLE_SOUP)
            continue;
        const float own = in.table[s].shader->lightmap.shadeAngle;
        const float degrees = own > 0 ? own : in.lightmap.shadeAngle;
        any = any || degrees > 0;
        for (int k = 0; k < surface.numVerts; ++k)
            angles[std::size_t(surface.firstVert + k)] = degrees * std::numbers::pi_v<float> / 180;
    }
    if (!any)
        angles.clear();
    return angles;
}

float AngleBetween(const Vec3f &a, const Vec3f &b) {
    return std::acos(std::clamp(Dot(a, b), -1.0f, 1.0f));
}

} // namespace

void SmoothNormals(const SurfaceInputs &in, SurfaceLight &surfaces) {
    if (!in.lightmap.shade)
        return;
    const std::vector<float> angles = ShadeAngles(in);
    std::vector<SurfaceVertex> &verts = surfaces.verts;
    std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells;
    for (std::size_t i = 0; i < angles.size(); ++i)
        if (angles[i] > 0)
            cells[CellKey(verts[i].xyz)].push_back(i);
    const auto original = [&](std::size_t i) { return Vec3f(in.bsp.drawVerts[i].normal); };
    std::vector<bool> done(verts.size());
    std::vector<std::size_t> group;
    std::vector<Vec3f> distinct;
    std::size_t smoothed = 0;
    for (std::size_t i = 0; i < angles.size(); ++i) {
        if (!(angles[i] > 0) || done[i])
            continue;
        group.clear();
        distinct.clear();
        Vec3f sum;
        for (const std::uint64_t key : CellsAround(verts[i].xyz)) {
            const auto cell = cells.find(key);
            if (cell == cells.end())
                continue;
            for (const std::size_t j : cell->second)
                if (j >= i && !done[j] && Near(verts[i].xyz, verts[j].xyz, kSamePosition) &&
                    (j == i || AngleBetween(original(i), original(j)) + kAngleSlack < std::min(angles[i], angles[j])))
                    group.push_back(j);
        }
        std::sort(group.begin(), group.end());
        group.resize(std::min(group.size(), kMaxGroup));
        for (const std::size_t j : group) {
            const Vec3f normal = original(j);
            if (std::none_of(distinct.begin(), distinct.end(),
                             [&](const Vec3f &other) { return Near(other, normal, kSameNormal); })) {
                distinct.push_back(normal);
                sum += normal;
            }
        }
        if (group.size() < 2 || Normalize(sum) == Vec3f{})
            continue;
        for (const std::size_t j : group) {
            verts[j].normal = Normalize(sum);
            done[j] = true;
        }
        smoothed += group.size();
    }
    in.log.Count((long long)(smoothed), "vertices with smoothed normals");
}

} // namespace q3
