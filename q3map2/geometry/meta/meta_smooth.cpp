// GPL-2.0-or-later. Smoothed normals.
#include "q3map2/geometry/meta/meta_smooth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {
namespace {

constexpr double kSameNormal = 0.01; ///< per component
constexpr double kAngleSlack = 1e-6; ///< radians

/// A corner of a triangle at the point that is being smoothed.
struct SmoothedCorner {
    int triangle = 0, corner = 0;
    double shadeAngle = 0; ///< radians
    Vec3d normal;
    bool done = false;
};

double ShadeAngle(const DrawSurface &surface, const BspOptions &options) {
    float degrees = options.nonPlanarAngle;
    if (surface.shader->lightmap.shadeAngle > 0)
        degrees = surface.shader->lightmap.shadeAngle;
    else if (surface.settings.shadeAngle > 0)
        degrees = surface.settings.shadeAngle;
    return std::max(0., double(degrees)) * std::numbers::pi / 180;
}

std::vector<SmoothedCorner> CornersOf(const MetaMesh &mesh, int group, const std::vector<double> &angles) {
    std::vector<SmoothedCorner> corners;
    for (const int v : mesh.Group(group))
        for (const int t : mesh.Verts()[std::size_t(v)].triangles) {
            const MetaTriangle &triangle = mesh.Triangles()[std::size_t(t)];
            const double angle = angles[std::size_t(triangle.surface)];
            if (angle > 0)
                corners.push_back({t, int(std::ranges::find(triangle.verts, v) - triangle.verts.begin()), angle,
                                   Vec3d(mesh.Verts()[std::size_t(v)].vert.normal), false});
        }
    return corners;
}

bool Together(const SmoothedCorner &a, const SmoothedCorner &b) {
    const double angle = std::acos(std::clamp(Dot(a.normal, b.normal), -1., 1.));
    return angle + kAngleSlack < std::min(a.shadeAngle, b.shadeAngle);
}

/// Adds up the distinct normals and returns their number.
int AddDistinctNormals(const std::vector<SmoothedCorner *> &corners, Vec3d &sum) {
    std::vector<Vec3d> distinct;
    for (const SmoothedCorner *corner : corners) {
        const bool known = std::ranges::any_of(distinct, [&](const Vec3d &n) {
            const Vec3d d = n - corner->normal;
            return std::abs(d.x) <= kSameNormal && std::abs(d.y) <= kSameNormal && std::abs(d.z) <= kSameNormal;
        });
        if (known)
            continue;
        distinct.push_back(corner->normal);
        sum += corner->normal;
    }
    return int(distinct.size());
}

/// Returns the number of corners whose normal changed.
int SmoothPoint(std::vector<SmoothedCorner> corners, std::vector<std::array<Vec3f, 3>> &normals) {
    int changed = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (corners[i].done)
            continue;
        std::vector<SmoothedCorner *> together{&corners[i]};
        for (std::size_t k = i + 1; k < corners.size(); ++k)
            if (!corners[k].done && Together(corners[i], corners[k]))
                together.push_back(&corners[k]);
        if (together.size() < 2)
            continue;
        for (SmoothedCorner *corner : together)
            corner->done = true;
        Vec3d sum;
        const bool several = AddDistinctNormals(together, sum) > 1;
        const Vec3f normal(Normalize(sum));
        if (!several || normal == Vec3f{})
            continue;
        for (const SmoothedCorner *corner : together)
            normals[std::size_t(corner->triangle)][std::size_t(corner->corner)] = normal;
        changed += int(together.size());
    }
    return changed;
}

} // namespace

void SmoothNormals(MetaMesh &mesh, const Geometry &geometry, const BspContext &context) {
    std::vector<double> angles(geometry.surfaces.size());
    bool any = false;
    for (const MetaTriangle &triangle : mesh.Triangles()) {
        const auto number = std::size_t(triangle.surface);
        angles[number] = ShadeAngle(geometry.surfaces[number], context.options);
        any |= angles[number] > 0;
    }
    if (!any)
        return;
    std::vector<std::array<Vec3f, 3>> normals(mesh.Triangles().size());
    for (std::size_t t = 0; t < normals.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c)
            normals[t][c] = mesh.Verts()[std::size_t(mesh.Triangles()[t].verts[c])].vert.normal;
    int changed = 0;
    for (int group = 0; group < mesh.GroupCount(); ++group)
        changed += SmoothPoint(CornersOf(mesh, group, angles), normals);
    context.log.VerboseCount(changed, "smoothed corners");
    if (changed > 0)
        mesh.ReplaceNormals(normals);
}

} // namespace q3
