// GPL-2.0-or-later. A map that has every BSPX lump, for tests of all of them.
#pragma once

#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/prop_light.h"
#include "tests/support/named_grid.h"
#include "tests/support/small_bsp.h"

namespace q3::test {

/// Gives the map that lump, with values that count up from `first`. The map is SmallBsp with lightmaps of 128 x 128.
inline void AddLump(Bsp &bsp, BspxId id, std::uint32_t first) {
    const auto codes = [first](std::size_t count) {
        std::vector<std::uint32_t> all(count);
        for (std::size_t i = 0; i < count; ++i)
            all[i] = first + std::uint32_t(i);
        return all;
    };
    const std::size_t texels = bsp.lightmaps.size() / 3;
    switch (id) {
    case BspxId::PropLight:
        bsp.propLight = PropLight{{{1, ModelNameCrc(""), first, 0, 1}}, {{0, 3}}, codes(3)};
        break;
    case BspxId::LightGridSH:
        bsp.gridSH = SmallGridSH();
        bsp.gridSH->points[1].coeffs[0][0] = float(first);
        bsp.gridSHContainer = GridSHContainer::Bspx;
        break;
    case BspxId::LightmapsE5bgr9:
        bsp.lightmapsE5bgr9 = codes(texels);
        break;
    case BspxId::VertexE5bgr9:
        bsp.vertexE5bgr9 = codes(bsp.drawVerts.size());
        break;
    case BspxId::Rnm:
        bsp.rnm.emplace().header.side = 128;
        bsp.rnm->header.pageCount = 1;
        bsp.rnm->pages = {{0, {codes(texels), codes(texels), codes(texels)}}};
        break;
    case BspxId::SparseGridSH: {
        SparseGridTree tree{{-64, 8, 0}, {16, 16, 32}, {1, 1, 1}, 1, {{0, 0, 0, 255, 0, 0}}, {}};
        tree.values.resize(8);
        for (bspGridPointSH_t &value : tree.values)
            value.coeffs[0] = {float(first), 1, 2};
        bsp.sparseGridSH = PackSparseGrid(tree);
        break;
    }
    case BspxId::NamedGridSH:
        bsp.namedGridSH = SmallNamedGrid(float(first));
        break;
    case BspxId::AmbientCubes:
        bsp.ambientCubes = AmbientCubes{{{0, 1}, {1, 0}, {0, 1}}, std::vector<bspCubeSample_t>(1)};
        bsp.ambientCubes->samples[0].sides[0] = {std::uint8_t(first), 2, 3, 4};
        break;
    case BspxId::Count:
        break;
    }
}

/// A map with a lightmap, without BSPX lumps.
inline Bsp MapWithoutLumps() {
    Bsp bsp = SmallBsp();
    bsp.lightmaps.resize(kLightmapPageBytes);
    bsp.drawSurfaces[0].lightmapNum[0] = 0;
    return bsp;
}

/// The bytes of a lump; empty: the map has none.
inline std::vector<std::byte> LumpOf(const Bsp &bsp, BspxId id) {
    const BspxRow &row = RowOf(id);
    return row.has(bsp) ? row.write(bsp).Bytes() : std::vector<std::byte>{};
}

} // namespace q3::test
