// GPL-2.0-or-later. The BSPX lump LIGHTGRID_OCTREE: light without direction.
#include "q3map2/gridformats/octree_encode.h"

#include "q3map2/gridformats/ambient_directed.h"
#include "q3map2/gridformats/grid_octree.h"

namespace q3 {

std::vector<std::byte> EncodeOctreeLump(const GridSource &source, const GridTone &tone) {
    OctreePoints points{.layout = source.Layout(), .occluded = source.Voids(), .append = {}};
    points.append = [&](std::size_t point, std::vector<std::byte> &bytes) {
        bytes.push_back(std::byte(1)); // one style
        bytes.push_back(kGridStyle);
        for (const std::uint8_t value : tone.Bytes(MeanLight(source.Point(point))))
            bytes.push_back(std::byte(value));
    };
    return EncodeGridOctree(points);
}

} // namespace q3
