// GPL-2.0-or-later. Normals of stored luxels. Internal to the folder.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Mean normal of the super luxels of a luxel.
inline Vec3f MeanNormal(const RawLightmap &lightmap, int x, int y) {
    Vec3f sum;
    for (int sy = y * lightmap.super; sy < (y + 1) * lightmap.super; ++sy)
        for (int sx = x * lightmap.super; sx < (x + 1) * lightmap.super; ++sx)
            if (const std::size_t at = lightmap.SuperIndex(sx, sy); lightmap.luxelClusters[at] != kUnmapped)
                sum += lightmap.normals[at];
    return sum == Vec3f{} ? lightmap.planeNormal : Normalize(sum);
}

} // namespace q3
