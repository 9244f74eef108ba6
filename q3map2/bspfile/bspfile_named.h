// GPL-2.0-or-later. The SH light grid that names lights: octrees whose points hold visible shares of lights of a table,
// and SH coefficients of all other light; its BSPX lump.
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

/// A light that points of the grid name. Its light on a surface that faces it is color times what the type says, 1 =
/// byte 255. Numbers that its type or curve does not need are 0. Formulas: docs/bsp_format.md.
struct GridLight {
    std::uint8_t type = SHGRID_POINT;
    std::uint8_t curve = SHGRID_INVERSE_SQUARE; ///< of points and spots
    std::uint8_t style = 0;
    std::uint8_t flags = 0; ///< SHGRID_TWO_SIDED, SHGRID_CONE_BY_ANGLES
    Float3 color{};
    Float3 origin{};     ///< points and spots: position; others: one for messages
    Float3 normal{};     ///< spot: direction of the beam; sun: toward the sun; unit
    float intensity = 0; ///< points and spots: photons; sun: light; polygons: radiosity
    float extraDist = 0; ///< see Light
    float fade = 0;      ///< linear: light lost per game unit
    float end = 0;       ///< windowed, polynomial
    float fadeFrom = 0, flatFrom = 0, constant = 0, linear = 0, quadratic = 0; ///< polynomial
    float cosInner = 0, cosOuter = 0, exponent = 0;                            ///< cone by angles
    float coneRadius = 0;                                                      ///< cone by radius: radius per game unit
    float spread = 0;                                                          ///< sun: sine of its angular radius
    float nearest = 0;                                ///< points and spots: smaller distances count as this one
    float coneFade = 0;                               ///< cone by radius: width of its fringe
    std::uint32_t firstPolygon = 0, polygonCount = 0; ///< polygons
    std::uint32_t name = 0;                           ///< offset of a text in NamedGridSH::text
    bool operator==(const GridLight &) const = default;
};

/// A convex, planar polygon of a light: clockwise seen from the front.
struct GridPolygon {
    std::uint32_t firstVertex = 0, vertexCount = 0;
    Float3 normal{};
    float dist = 0; ///< of points p in its plane: normal . p
    Float3 center{};
    float area = 0, radius = 0; ///< radius: around the center
    bool operator==(const GridPolygon &) const = default;
};

/// A node as SparseGridNode, with the lights that its points name.
struct NamedGridNode {
    std::uint32_t children = 0, points = 0;
    std::uint8_t inner = 0, stored = 0, hanging = 0;
    std::uint8_t nameCount = 0;
    std::uint32_t names = 0;  ///< index of its first name
    std::uint32_t shares = 0; ///< index of the first share of its first point; nameCount for each point
    bool operator==(const NamedGridNode &) const = default;
};

/// Coefficients of a point: coefficient k of a channel is steps[3 k + channel] / 127 times SparseScale(scale) times
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
    std::string text; ///< names, each with a NUL behind it
    bool operator==(const GridLights &) const = default;
};

/// The grid as it is stored. Tree and blend: those of SparseGridSH. The light at a position is the blend of the points'
/// coefficients plus, for each light that some of them name, what it gives there without shadows times the blend of its
/// shares, 0 where a point does not name it.
struct NamedGridSH {
    Float3 mins{}, cell{}; ///< as of SparseGridSH
    Int3 roots{};
    std::int32_t levels = 0;
    GridLights table;
    std::vector<NamedGridNode> nodes;
    std::vector<NamedGridPoint> points;
    std::vector<std::uint16_t> names; ///< numbers of lights
    std::vector<std::uint8_t> shares; ///< of 255
    bool operator==(const NamedGridSH &) const = default;
};

/// Limit of coefficients k of scale 1.
constexpr float NamedBandLimit(std::size_t k) {
    return k == 0 ? 1 : kSparseBandLimits[k < 4 ? 0 : 1];
}

/// Quantizes coefficients; an error of at most half a step in each. Errors: none for finite ones.
NamedGridPoint QuantizeNamed(const bspGridPointSH_t &value);
bspGridPointSH_t DequantizeNamed(const NamedGridPoint &point);

/// Sets the running sums of all nodes: children, points, names, shares.
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
