// GPL-2.0-or-later. The BSPX lump LIGHTGRIDS: light on six sides.
#include "q3map2/gridformats/grids_encode.h"

#include "common/error.h"
#include "q3map2/gridformats/ambient_directed.h"
#include "q3map2/gridformats/grid_octree.h"

#include <cstdint>
#include <cstring>
#include <limits>

namespace q3 {

namespace {

/// Appends the count of styles, the style, a bit for each side that is not black, and those sides.
void AppendSides(const bspGridPointSH_t &light, const GridTone &tone, std::vector<std::byte> &bytes) {
    bytes.push_back(std::byte(1));
    bytes.push_back(kGridStyle);
    const std::size_t flags = bytes.size();
    bytes.push_back(std::byte(0));
    for (unsigned side = 0; side < 6; ++side) {
        Vec3d normal;
        normal[side / 2] = side % 2 == 0 ? 1 : -1;
        const auto color = tone.Bytes(LightOn(light, normal));
        if (color == std::array<std::uint8_t, 3>{})
            continue;
        bytes[flags] |= std::byte(1u << side);
        for (const std::uint8_t value : color)
            bytes.push_back(std::byte(value));
    }
}

} // namespace

std::vector<std::byte> EncodeGridsLump(const GridSource &source, const GridTone &tone) {
    OctreePoints points{.layout = source.Layout(), .occluded = source.Voids(), .append = {}, .leafHasStyles = true};
    points.append = [&](std::size_t point, std::vector<std::byte> &bytes) {
        AppendSides(source.Point(point), tone, bytes);
    };
    const std::vector<std::byte> grid = EncodeGridOctree(points);
    if (grid.size() > std::numeric_limits<std::uint32_t>::max())
        throw Error("{}: the grid has {} bytes, expected less than 2^32", kBspxGrids, grid.size());
    const auto length = std::uint32_t(grid.size());
    std::vector<std::byte> lump(sizeof length + grid.size());
    std::memcpy(lump.data(), &length, sizeof length);
    std::memcpy(lump.data() + sizeof length, grid.data(), grid.size());
    return lump;
}

} // namespace q3
