// GPL-2.0-or-later. Index maps: images with the terrain layer of each texel.
#pragma once

#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace q3 {

/// An image of layer numbers over a terrain.
struct IndexMap {
    Boundsf bounds;                   ///< extent of the image, game units; its top row is at the largest y
    int width = 0, height = 0;        ///< texels
    int layers = 1;                   ///< number of layers
    std::vector<std::uint8_t> pixels; ///< layer numbers, row by row
    std::vector<float> offsets;       ///< heights of layers, game units; missing ones are 0
    std::string shader;               ///< without "textures/" and the layer's number

    /// The layer at x and y of a point; outside the image that of its border.
    int LayerAt(const Vec3f &p) const;
    /// The height of a layer, game units.
    float OffsetOf(int layer) const;
};

/// The index map that the keys of an entity name. Its default extent: bounds of the brushes and patches, moved by
/// `shift`. Null without such keys; null after a warning if a key is missing, or the image (tga, png, pcx) cannot be
/// read or is smaller than 2 x 2.
std::shared_ptr<const IndexMap> ReadIndexMap(const MapEntity &entity, const Vec3f &shift, const BspContext &context);

} // namespace q3
