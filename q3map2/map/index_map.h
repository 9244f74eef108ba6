// GPL-2.0-or-later. Index maps: pictures that say which layer of a terrain is where.
#pragma once

#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace q3 {

struct IndexMap {
    Boundsf bounds; ///< what the picture covers, game units; its top row at the largest y
    int width = 0, height = 0, layers = 1;
    std::vector<std::uint8_t> pixels; ///< numbers of layers
    std::vector<float> offsets;       ///< heights of layers, game units; missing ones are 0
    std::string shader;               ///< without "textures/" and the layer's number

    int LayerAt(const Vec3f &p) const;
    float OffsetOf(int layer) const;
};

/// The map that the keys of an entity name, over its brushes and patches moved by `shift`. Null without such keys, and
/// after a warning when one is missing or the picture (tga, png, pcx) cannot be read or is under 2 x 2.
std::shared_ptr<const IndexMap> ReadIndexMap(const MapEntity &entity, const Vec3f &shift, const BspContext &context);

} // namespace q3
