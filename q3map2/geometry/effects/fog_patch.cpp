// GPL-2.0-or-later. Patches cut by a plane.
#include "q3map2/geometry/effects/fog_patch.h"

#include <algorithm>
#include <cmath>

namespace q3 {
namespace {

struct Grid {
    int width = 0, height = 0;
    std::vector<DrawVert> verts;
    const DrawVert &At(int column, int row) const { return verts[std::size_t(row * width + column)]; }
};

/// Turned by 90 degrees: rows become columns, and the front side stays the front.
Grid Turned(const Grid &grid) {
    Grid turned{grid.height, grid.width, {}};
    for (int row = 0; row < turned.height; ++row)
        for (int column = 0; column < turned.width; ++column)
            turned.verts.push_back(grid.At(grid.width - 1 - row, column));
    return turned;
}

Grid TurnedBack(const Grid &grid) {
    return Turned(Turned(Turned(grid)));
}

/// Index of the column after which every row crosses the plane. -1: rows cross it elsewhere, never or repeatedly.
int CrossingColumn(const Grid &grid, const Plane &plane, double epsilon) {
    int found = -1;
    for (int row = 0; row < grid.height; ++row) {
        int crossing = -1;
        for (int column = 0; column + 1 < grid.width; ++column) {
            const bool a = plane.Distance(Vec3d(grid.At(column, row).xyz)) > epsilon;
            const bool b = plane.Distance(Vec3d(grid.At(column + 1, row).xyz)) > epsilon;
            if (a == b)
                continue;
            if (crossing >= 0)
                return -1;
            crossing = column;
        }
        if (crossing < 0 || (found >= 0 && crossing != found))
            return -1;
        found = crossing;
    }
    return found;
}

/// Linear interpolation from a (t = 0) to b (t = 1).
DrawVert Between(const DrawVert &a, const DrawVert &b, double t) {
    DrawVert v = a;
    v.xyz = Vec3f(Vec3d(a.xyz) + (Vec3d(b.xyz) - Vec3d(a.xyz)) * t);
    const Vec3f normal = Normalize(Vec3f(Vec3d(a.normal) + (Vec3d(b.normal) - Vec3d(a.normal)) * t));
    v.normal = normal == Vec3f{} ? a.normal : normal;
    for (std::size_t i = 0; i < 2; ++i)
        v.st[i] = float(double(a.st[i]) + (double(b.st[i]) - double(a.st[i])) * t);
    for (std::size_t i = 0; i < 4; ++i)
        v.color[i] = std::uint8_t(std::lround(a.color[i] + (b.color[i] - a.color[i]) * t));
    return v;
}

std::vector<DrawVert> CrossingVerts(const Grid &grid, int column, const Plane &plane) {
    std::vector<DrawVert> verts;
    for (int row = 0; row < grid.height; ++row) {
        const DrawVert &a = grid.At(column, row), &b = grid.At(column + 1, row);
        const double da = plane.Distance(Vec3d(a.xyz)), db = plane.Distance(Vec3d(b.xyz));
        verts.push_back(Between(a, b, std::clamp(da / (da - db), 0., 1.)));
    }
    return verts;
}

/// Columns from..to plus, at the cut end, one or two columns on the plane, whichever makes the width odd. No part is
/// wider than the whole, whose width is odd, because at least one of its columns is left out.
Grid Part(const Grid &grid, int from, int to, const std::vector<DrawVert> &crossing) {
    const int copies = (to - from + 1) % 2 == 0 ? 1 : 2;
    Grid part{to - from + 1 + copies, grid.height, {}};
    for (int row = 0; row < grid.height; ++row) {
        if (from > 0)
            part.verts.insert(part.verts.end(), std::size_t(copies), crossing[std::size_t(row)]);
        for (int column = from; column <= to; ++column)
            part.verts.push_back(grid.At(column, row));
        if (from == 0)
            part.verts.insert(part.verts.end(), std::size_t(copies), crossing[std::size_t(row)]);
    }
    return part;
}

DrawSurface WithGrid(DrawSurface surface, Grid grid) {
    surface.width = grid.width, surface.height = grid.height;
    surface.verts = std::move(grid.verts);
    surface.bounds = {};
    for (const DrawVert &vert : surface.verts)
        surface.bounds.Add(vert.xyz);
    return surface;
}

} // namespace

PatchCut CutPatchSurface(const DrawSurface &surface, const Plane &plane, double epsilon) {
    bool anyFront = false, anyBack = false;
    for (const DrawVert &vert : surface.verts) {
        const double d = plane.Distance(Vec3d(vert.xyz));
        anyFront |= d > epsilon, anyBack |= d < -epsilon;
    }
    if (!anyBack)
        return {PatchCut::Outside, {}, {}};
    if (!anyFront)
        return {PatchCut::Inside, {}, {}};
    Grid grid{surface.width, surface.height, surface.verts};
    int column = CrossingColumn(grid, plane, epsilon);
    const bool turned = column < 0;
    if (turned) {
        grid = Turned(grid);
        column = CrossingColumn(grid, plane, epsilon);
    }
    if (column < 0)
        return {PatchCut::Impossible, {}, {}};
    const std::vector<DrawVert> crossing = CrossingVerts(grid, column, plane);
    Grid low = Part(grid, 0, column, crossing), high = Part(grid, column + 1, grid.width - 1, crossing);
    const bool lowIsFront = plane.Distance(Vec3d(grid.At(0, 0).xyz)) > epsilon;
    if (turned)
        low = TurnedBack(low), high = TurnedBack(high);
    DrawSurface lowSurface = WithGrid(surface, std::move(low)), highSurface = WithGrid(surface, std::move(high));
    if (lowIsFront)
        return {PatchCut::Cut, std::move(highSurface), std::move(lowSurface)};
    return {PatchCut::Cut, std::move(lowSurface), std::move(highSurface)};
}

} // namespace q3
