// GPL-2.0-or-later. Error of bounced light in the lightmaps of .bsp files lit by any program.
#include "tools/measure/bounce_error/lit_files.h"

#include "common/error.h"
#include "q3map2/lightmap/bounce/bounce_scene.h"
#include "tools/measure/lightmap_compare/luxel_cover.h"

#include <algorithm>

namespace q3::bounce {

namespace {

Vec3f NormalAt(const Bsp &bsp, const compare::SurfacePoint &point) {
    Vec3f normal;
    for (std::size_t i = 0; i < point.count; ++i)
        normal += Vec3f(bsp.drawVerts[std::size_t(point.verts[i])].normal) * float(point.weights[i]);
    return Normalize(normal);
}

} // namespace

std::vector<LitPoint> LitPoints(const SurfaceInputs &in, const PathScene &scene, const LitFiles &files, int count,
                                std::uint64_t seed) {
    constexpr int kTries = 100;            // at most, for each point wanted
    constexpr int kPointsOfSurface = 1024; // to choose from
    const Bsp &bsp = files.direct.Map();
    if (bsp.drawSurfaces.size() != in.bsp.drawSurfaces.size() ||
        files.all.Map().drawSurfaces.size() != in.bsp.drawSurfaces.size())
        throw Error("the lit files have {} and {} surfaces, expected {} as in the map", bsp.drawSurfaces.size(),
                    files.all.Map().drawSurfaces.size(), in.bsp.drawSurfaces.size());
    const compare::LuxelCover coverDirect(files.direct), coverAll(files.all);
    std::vector<double> areas;
    std::vector<std::vector<compare::SurfacePoint>> places(bsp.drawSurfaces.size());
    double area = 0;
    for (std::size_t s = 0; s < bsp.drawSurfaces.size(); ++s)
        areas.push_back(area += files.direct.PageOf(s) >= 0 && files.all.PageOf(s) >= 0 && IsInBounceScene(in, s)
                                    ? compare::AreaOf(bsp, s)
                                    : 0);
    PathRandom random(seed);
    std::vector<LitPoint> points;
    for (std::int64_t tries = 0; int(points.size()) < count && tries < std::int64_t(kTries) * count; ++tries) {
        const double at = random.Unit() * area;
        const auto s = std::size_t(std::upper_bound(areas.begin(), areas.end(), at) - areas.begin());
        if (s >= places.size())
            continue;
        if (places[s].empty())
            places[s] = compare::PointsOn(bsp, s, kPointsOfSurface);
        if (places[s].empty())
            continue;
        const compare::SurfacePoint &point = places[s][std::size_t(random.Unit() * double(places[s].size()))];
        const Vec3f normal = NormalAt(bsp, point);
        const Vec3f position = Vec3f(files.direct.Position(point)) + in.table[s].origin + normal;
        if (coverDirect.Covers(s, point) && coverAll.Covers(s, point) && IsClear(in, scene, position, normal))
            points.push_back({s, point, position, normal});
    }
    return points;
}

Receivers ReceiversOf(const std::vector<LitPoint> &points) {
    Receivers receivers;
    for (const LitPoint &one : points)
        receivers.luxels.push_back({0, 0, int(one.surface), one.position, one.normal, {one.position}});
    return receivers;
}

std::vector<ComparedLight> CompareLit(const std::vector<LitPoint> &points, const Reference &reference,
                                      std::size_t limit, const LitFiles &files) {
    std::vector<ComparedLight> light;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d direct = files.direct.Light(points[i].surface, points[i].point);
        const Vec3d all = files.all.Light(points[i].surface, points[i].point);
        const Estimate &estimate = reference.luxels[i];
        if (std::max(MaxComponent(direct), MaxComponent(all)) <= kMaxComparedLight)
            light.push_back({Vec3f(direct), Vec3f(all - direct), estimate.light[limit], estimate.error[limit]});
    }
    return light;
}

} // namespace q3::bounce
