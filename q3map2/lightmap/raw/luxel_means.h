// GPL-2.0-or-later. Means of supersampled values.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_masks.h"

#include <algorithm>

namespace q3 {

/// Gives luxels next to known ones the mean of their known neighbors, ring by ring, until all are known. Without a
/// known luxel nothing changes. values, known: width x height.
template <typename T> void FillFromNeighbors(int width, int height, LuxelMask &known, std::vector<T> &values) {
    const auto index = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
    const auto mean = [&](int x, int y) {
        T sum{};
        int count = 0;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u)
                if (known[index(u, v)] != 0)
                    sum += values[index(u, v)], ++count;
        return sum / float(count);
    };
    for (bool grown = true; grown;) {
        const LuxelMask ring = Dilate(known, width, height);
        grown = false;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (const std::size_t at = index(x, y); ring[at] != 0 && known[at] == 0)
                    values[at] = mean(x, y), grown = true;
        for (std::size_t at = 0; at < known.size(); ++at)
            known[at] |= ring[at];
    }
}

/// By luxel, width x height: the mean of value(super luxel) over its mapped super luxels. Luxels without mapped
/// super luxels take the mean of their neighbors, as light does; `otherwise` if nothing is mapped.
template <typename T, typename Value>
std::vector<T> LuxelMeans(const RawLightmap &raw, const T &otherwise, const Value &value) {
    std::vector<T> means(std::size_t(raw.width) * std::size_t(raw.height), otherwise);
    LuxelMask known(means.size());
    for (int y = 0; y < raw.height; ++y)
        for (int x = 0; x < raw.width; ++x) {
            T sum{};
            int count = 0;
            for (int sy = y * raw.super; sy < (y + 1) * raw.super; ++sy)
                for (int sx = x * raw.super; sx < (x + 1) * raw.super; ++sx)
                    if (const std::size_t at = raw.SuperIndex(sx, sy); raw.Mapped(at))
                        sum += value(at), ++count;
            if (count > 0)
                means[raw.Index(x, y)] = sum / float(count), known[raw.Index(x, y)] = 1;
        }
    FillFromNeighbors(raw.width, raw.height, known, means);
    return means;
}

} // namespace q3
