// GPL-2.0-or-later. A small SH light grid that names a light of each kind.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile_named.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string_view>

namespace q3::test {

/// Adds a light with that name to a table.
inline GridLight &AddLight(GridLights &table, std::string_view name, std::uint8_t type) {
    GridLight &light = table.lights.emplace_back();
    light.type = type;
    light.color = {1, 0.5f, 0.25f};
    light.intensity = 1;
    light.name = std::uint32_t(table.text.size());
    table.text += name;
    table.text += '\0';
    return light;
}

/// Adds a polygon light of one convex, planar polygon, clockwise seen from the front.
inline GridLight &AddPolygonLight(GridLights &table, std::string_view name, std::initializer_list<Vec3f> corners) {
    GridPolygon &polygon = table.polygons.emplace_back();
    polygon.firstVertex = std::uint32_t(table.vertices.size());
    polygon.vertexCount = std::uint32_t(corners.size());
    const Vec3f *const p = corners.begin();
    Vec3f area, center;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        table.vertices.push_back(p[i].Array());
        if (i < 2)
            continue;
        const Vec3f triangle = Cross(p[i] - p[0], p[i - 1] - p[0]) * 0.5f;
        area = area + triangle;
        center = center + (p[0] + p[i - 1] + p[i]) * (Length(triangle) / 3);
    }
    polygon.area = Length(area);
    center = center / polygon.area;
    polygon.normal = Normalize(area).Array(), polygon.center = center.Array();
    polygon.dist = Dot(Normalize(area), center);
    for (const Vec3f &corner : corners)
        polygon.radius = std::max(polygon.radius, Length(corner - center));
    GridLight &light = AddLight(table, name, SHGRID_POLYGONS);
    light.firstPolygon = std::uint32_t(table.polygons.size() - 1), light.polygonCount = 1;
    return light;
}

/// A light of each type, curve and cone.
inline GridLights LightsOfAllKinds() {
    GridLights table;
    for (std::uint8_t curve = SHGRID_INVERSE_SQUARE; curve <= SHGRID_POLYNOMIAL; ++curve) {
        GridLight &light = AddLight(table, std::array{"", "lamp", "lamp \"2\"", "lamp\xe9"}[curve], SHGRID_POINT);
        light.curve = curve, light.style = std::uint8_t(5 * curve);
        light.origin = {-40, 20 + 4.0f * float(curve), 90};
        light.nearest = 16, light.extraDist = 2;
        light.intensity = std::array{9000.0f, 1600.0f, 9000.0f, 1.0f}[curve];
    }
    table.lights[1].fade = 1e-3f;
    table.lights[2].end = 300;
    GridLight &polynomial = table.lights[3];
    polynomial.nearest = 1, polynomial.fadeFrom = 100, polynomial.flatFrom = 150, polynomial.end = 200;
    polynomial.constant = 0.5f, polynomial.linear = 0.01f, polynomial.quadratic = 1e-3f;
    for (int byAngles = 0; byAngles < 2; ++byAngles) {
        GridLight &spot = AddLight(table, byAngles == 0 ? "by radius" : "by angles", SHGRID_SPOT);
        spot.origin = {-50, 24, 100}, spot.normal = {0, 0, -1};
        spot.nearest = 16, spot.intensity = 7000;
    }
    table.lights[4].coneRadius = 0.8f, table.lights[4].coneFade = 32;
    table.lights[5].flags = SHGRID_CONE_BY_ANGLES;
    table.lights[5].cosInner = 0.95f, table.lights[5].cosOuter = 0.6f, table.lights[5].exponent = 1.5f;
    GridLight &sun = AddLight(table, "sun", SHGRID_SUN);
    sun.normal = {0.48f, -0.6f, 0.64f}, sun.spread = 0.3f;
    // The first cuts through the grid, which is on both of its sides; the second acts as a point there.
    AddPolygonLight(table, "panel", {{-72, -20, 50}, {-72, 60, 50}, {-8, 60, 50}, {-8, -20, 50}}).intensity = 0.4f;
    table.lights[7].flags = SHGRID_TWO_SIDED;
    AddPolygonLight(table, "far", {{-200, 0, 20}, {-200, 20, 10}, {-200, 0, 0}}).intensity = 40;
    return table;
}

/// A root of eight cells of 16 x 16 x 32 from (-64 8 0), all of whose points name all lights of LightsOfAllKinds.
/// `light`: coefficient 0 of red.
inline NamedGridSH SmallNamedGrid(float light) {
    NamedGridSH grid;
    grid.mins = {-64, 8, 0}, grid.cell = {16, 16, 32}, grid.roots = {1, 1, 1}, grid.levels = 1;
    grid.table = LightsOfAllKinds();
    NamedGridNode &node = grid.nodes.emplace_back();
    node.stored = 255, node.nameCount = std::uint8_t(grid.table.lights.size());
    for (std::uint16_t i = 0; i < node.nameCount; ++i)
        grid.names.push_back(i);
    for (int i = 0; i < 8; ++i) {
        bspGridPointSH_t value{};
        value.coeffs[0] = {light, 1, 2};
        value.coeffs[3] = {0.1f * float(i), 0, -0.2f};
        grid.points.push_back(QuantizeNamed(value));
        for (int name = 0; name < node.nameCount; ++name)
            grid.shares.push_back(std::uint8_t(255 - 20 * ((i + name) % 4)));
    }
    NumberNamedNodes(grid);
    return grid;
}

} // namespace q3::test
