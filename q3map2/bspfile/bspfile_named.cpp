// GPL-2.0-or-later. The SH light grid that names lights, and its BSPX lump.
#include "q3map2/bspfile/bspfile_named.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace q3 {

namespace {

constexpr float kMaxNamedStep = 127; ///< coefficients are stored in steps from -127 to 127

bspNamedGridHeader_t NamedHeaderOf(const NamedGridSH &grid) {
    bspNamedGridHeader_t head;
    head.mins = grid.mins, head.cell = grid.cell, head.roots = grid.roots;
    head.levels = std::uint32_t(grid.levels);
    head.nodes = std::uint32_t(grid.nodes.size()), head.points = std::uint32_t(grid.points.size());
    head.lights = std::uint32_t(grid.table.lights.size()), head.polygons = std::uint32_t(grid.table.polygons.size());
    head.vertices = std::uint32_t(grid.table.vertices.size());
    head.names = std::uint32_t(grid.names.size()), head.shares = std::uint32_t(grid.shares.size());
    head.textBytes = std::uint32_t(grid.table.text.size());
    head.bytes = std::uint32_t(
        sizeof head + sizeof(GridLight) * grid.table.lights.size() + sizeof(GridPolygon) * grid.table.polygons.size() +
        sizeof(Float3) * grid.table.vertices.size() + sizeof(NamedGridNode) * grid.nodes.size() +
        sizeof(NamedGridPoint) * grid.points.size() + Align4(sizeof(std::uint16_t) * grid.names.size()) +
        Align4(grid.shares.size()) + Align4(grid.table.text.size()));
    return head;
}

/// Errors: what the reader for engines refuses.
void CheckLump(std::span<const std::byte> lump) {
    if (lump.size() < 4 || std::memcmp(lump.data(), bspNamedGridHeader_t{}.magic.data(), 4) != 0)
        throw Error("does not start with SHGL");
    shgrid_grid grid;
    if (const shgrid_result result = shgrid_parse(lump.data(), lump.size(), &grid); result != SHGRID_OK)
        throw Error("{}", shgrid_message(result));
}

} // namespace

NamedGridPoint QuantizeNamed(const bspGridPointSH_t &value) {
    float most = 0;
    for (std::size_t k = 0; k < 9; ++k)
        for (const float c : value.coeffs[k])
            most = std::max(most, std::abs(c) / NamedBandLimit(k));
    NamedGridPoint point;
    point.scale = SparseScaleCode(most);
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float steps =
                kMaxNamedStep * (value.coeffs[k][channel] / (SparseScale(point.scale) * NamedBandLimit(k)));
            point.steps[3 * k + channel] = std::int8_t(std::lround(std::clamp(steps, -kMaxNamedStep, kMaxNamedStep)));
        }
    return point;
}

bspGridPointSH_t DequantizeNamed(const NamedGridPoint &point) {
    bspGridPointSH_t value{};
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            value.coeffs[k][channel] = std::max<float>(point.steps[3 * k + channel], -kMaxNamedStep) / kMaxNamedStep *
                                       SparseScale(point.scale) * NamedBandLimit(k);
    return value;
}

void NumberNamedNodes(NamedGridSH &grid) {
    std::uint64_t children = 1, points = 0, names = 0, shares = 0;
    for (const std::int32_t roots : grid.roots)
        children *= std::uint64_t(std::clamp(roots, 0, kMaxSparseCells)); // CheckNamedGrid reports other values
    for (NamedGridNode &node : grid.nodes) {
        node.children = std::uint32_t(children), node.points = std::uint32_t(points);
        node.names = std::uint32_t(names), node.shares = std::uint32_t(shares);
        const auto stored = std::uint64_t(std::popcount(node.stored));
        children += std::uint64_t(std::popcount(node.inner));
        points += stored;
        names += node.nameCount;
        shares += node.nameCount * stored;
    }
}

ByteRanges NamedRanges(const NamedGridSH &grid) {
    ByteRanges bytes, names, shares, text;
    bytes.AddCopy(NamedHeaderOf(grid));
    bytes.Add(grid.table.lights);
    bytes.Add(grid.table.polygons);
    bytes.Add(grid.table.vertices);
    bytes.Add(grid.nodes);
    bytes.Add(grid.points);
    names.Add(grid.names), shares.Add(grid.shares);
    text.Add(std::span<const char>(grid.table.text));
    bytes.AddPadded(std::move(names));
    bytes.AddPadded(std::move(shares));
    bytes.AddPadded(std::move(text));
    return bytes;
}

std::vector<std::byte> EncodeNamedGrid(const NamedGridSH &grid) {
    std::vector<std::byte> lump = NamedRanges(grid).Bytes();
    CheckLump(lump);
    return lump;
}

NamedGridSH DecodeNamedGrid(std::span<const std::byte> lump) {
    CheckLump(lump); // from here on all counts fit the length of the lump
    const auto head = LoadRecord<bspNamedGridHeader_t>(lump, 0);
    NamedGridSH grid;
    grid.mins = head.mins, grid.cell = head.cell, grid.roots = head.roots, grid.levels = std::int32_t(head.levels);
    std::size_t at = sizeof head;
    const auto take = [&](auto &records, std::size_t count) {
        records.resize(count);
        const std::size_t bytes = count * sizeof(records[0]);
        if (bytes > 0)
            std::memcpy(records.data(), lump.data() + at, bytes);
        at += std::size_t(Align4(bytes));
    };
    take(grid.table.lights, head.lights);
    take(grid.table.polygons, head.polygons);
    take(grid.table.vertices, head.vertices);
    take(grid.nodes, head.nodes);
    take(grid.points, head.points);
    take(grid.names, head.names);
    take(grid.shares, head.shares);
    take(grid.table.text, head.textBytes);
    return grid;
}

NamedGridSH ReadNamedGrid(const BspxSource &from) {
    try {
        return DecodeNamedGrid(from.Bytes());
    } catch (const Error &error) {
        from.Fail(error.what());
    }
}

void CheckNamedGrid(const NamedGridSH &grid, std::string_view name) {
    try {
        EncodeNamedGrid(grid);
    } catch (const Error &error) {
        throw Error("{}: BSPX lump {}: {}", name, kBspxNamedGridSH, error.what());
    }
}

} // namespace q3
