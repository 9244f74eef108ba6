// GPL-2.0-or-later. The SH light grid that names lights, and its BSPX lump: octrees whose points hold visible shares of
// lights in a table, and SH coefficients of all other light.
#pragma once

#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/bspfile_sparse.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A light that points of the grid name. A surface that faces it gets `color` times a strength, 1 = byte 255;
/// docs/reference/bsp_format.md has the formula of the strength for each type. Fields that the type and the curve do
/// not need are 0. Distances are in game units.
struct GridLight {
    std::uint8_t type = SHGRID_POINT;
    std::uint8_t curve = SHGRID_INVERSE_SQUARE; ///< points and spots: falloff with distance
    std::uint8_t style = 0;
    std::uint8_t flags = 0; ///< SHGRID_TWO_SIDED, SHGRID_CONE_BY_ANGLES
    Float3 color{};         ///< below 0 for lights that subtract
    Float3 origin{};        ///< points and spots: position; others: a position for messages
    Float3 normal{};        ///< spot: direction of the beam; sun: toward the sun; unit
    float intensity = 0;    ///< points and spots: photons; sun: irradiance; polygons: radiosity
    float extraDist = 0;    ///< points and spots: see Light
    float fade = 0;         ///< linear: light lost per game unit
    float end = 0;          ///< windowed, polynomial: distance at which the light ends
    float fadeFrom = 0, flatFrom = 0, constant = 0, linear = 0, quadratic = 0; ///< polynomial
    float cosInner = 0, cosOuter = 0, exponent = 0;                            ///< cone by angles
    float coneRadius = 0;                             ///< cone by radius: radius per unit of distance
    float spread = 0;                                 ///< sun: sine of its angular radius
    float nearest = 0;                                ///< points and spots: smaller distances count as this one
    float coneFade = 0;                               ///< cone by radius: width of the rim where it fades
    std::uint32_t firstPolygon = 0, polygonCount = 0; ///< polygons
    std::uint32_t name = 0;                           ///< offset in GridLights::text
    bool operator==(const GridLight &) const = default;
};

/// A convex, planar polygon of a light. Its vertices are clockwise seen from the front.
struct GridPolygon {
    std::uint32_t firstVertex = 0, vertexCount = 0;
    Float3 normal{};
    float dist = 0; ///< the plane is normal . p = dist
    Float3 center{};
    float area = 0, radius = 0; ///< radius: of a sphere around `center` that contains it
    bool operator==(const GridPolygon &) const = default;
};

/// A node like SparseGridNode, with the lights that its points name.
struct NamedGridNode {
    std::uint32_t children = 0, points = 0;
    std::uint8_t inner = 0, stored = 0, hanging = 0;
    std::uint8_t nameCount = 0;
    std::uint32_t names = 0;  ///< index of its first name
    std::uint32_t shares = 0; ///< index of the first share of its points, which have nameCount each
    bool operator==(const NamedGridNode &) const = default;
};

/// The rest of the light at a point. Coefficient k of a channel is steps[3 k + channel] / 127 * SparseScale(scale) *
/// NamedBandLimit(k).
struct NamedGridPoint {
    std::uint8_t scale = 0;
    std::array<std::int8_t, 27> steps{};
    bool operator==(const NamedGridPoint &) const = default;
};
static_assert(kPinned<GridLight, SHGRID_LIGHT_BYTES> && kPinned<GridPolygon, SHGRID_POLYGON_BYTES>);
static_assert(kPinned<NamedGridNode, SHGRID_LIGHTS_NODE_BYTES> && kPinned<NamedGridPoint, SHGRID_SPARSE_POINT_BYTES>);

/// The lights that a grid can name.
struct GridLights {
    std::vector<GridLight> lights;
    std::vector<GridPolygon> polygons;
    std::vector<Float3> vertices;
    std::string text; ///< names of lights, each with a NUL behind it
    bool operator==(const GridLights &) const = default;
};

/// The grid as it is stored. Its tree and its interpolation are those of SparseGridSH. The light at a position is the
/// interpolated rest plus, for each light that one of these points names, its unshadowed light there times its
/// interpolated share. The share of a point that does not name the light is 0.
struct NamedGridSH {
    Float3 mins{}, cell{}; ///< as in SparseGridSH
    Int3 roots{};
    std::int32_t levels = 0;
    GridLights table;
    std::vector<NamedGridNode> nodes;
    std::vector<NamedGridPoint> points;
    std::vector<std::uint16_t> names; ///< numbers of lights, by node
    std::vector<std::uint8_t> shares; ///< 0 to 255, by point
    bool operator==(const NamedGridSH &) const = default;
};

/// Largest absolute value of coefficient k at SparseScale 1.
constexpr float NamedBandLimit(std::size_t k) {
    return k == 0 ? 1 : kSparseBandLimits[k < 4 ? 0 : 1];
}

/// Quantizes finite coefficients. Each changes by at most half a step if the largest scale can hold it.
NamedGridPoint QuantizeNamed(const bspGridPointSH_t &value);
bspGridPointSH_t DequantizeNamed(const NamedGridPoint &point);

/// Sets `children`, `points`, `names` and `shares` of all nodes, which are sums over the nodes before them.
void NumberNamedNodes(NamedGridSH &grid);

/// The bytes of the lump. Errors: those of CheckNamedGrid.
std::vector<std::byte> EncodeNamedGrid(const NamedGridSH &grid);
/// Errors: what the reader for engines refuses.
NamedGridSH DecodeNamedGrid(std::span<const std::byte> lump);

class ByteRanges;
struct BspxSource;
/// Reads the lump from a file. Errors: those of DecodeNamedGrid.
NamedGridSH ReadNamedGrid(const BspxSource &from);
/// The bytes of the lump, without checks.
ByteRanges NamedRanges(const NamedGridSH &grid);
/// Errors: what the reader for engines refuses.
void CheckNamedGrid(const NamedGridSH &grid, std::string_view name);

} // namespace q3
