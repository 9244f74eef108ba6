// GPL-2.0-or-later. Means of supersampled values.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// By luxel, width x height: the mean of value(super luxel) over its mapped super luxels; `otherwise` without any.
template <typename T, typename Value>
std::vector<T> LuxelMeans(const RawLightmap &raw, const T &otherwise, const Value &value) {
    std::vector<T> means(std::size_t(raw.width) * std::size_t(raw.height), otherwise);
    for (int y = 0; y < raw.height; ++y)
        for (int x = 0; x < raw.width; ++x) {
            T sum{};
            int count = 0;
            for (int sy = y * raw.super; sy < (y + 1) * raw.super; ++sy)
                for (int sx = x * raw.super; sx < (x + 1) * raw.super; ++sx)
                    if (const std::size_t at = raw.SuperIndex(sx, sy); raw.Mapped(at))
                        sum += value(at), ++count;
            if (count > 0)
                means[raw.Index(x, y)] = sum / float(count);
        }
    return means;
}

} // namespace q3
