// GPL-2.0-or-later. -filter: blur of light over luxels.
#include "q3map2/lightmap/direct/luxel_filter.h"

#include <algorithm>

namespace q3 {

void LuxelFilter::Apply(const RawLightmap &lightmap, int radius, std::vector<Vec3f> &values) {
    const int width = lightmap.SuperWidth(), height = lightmap.SuperHeight();
    rows_.assign(values.size(), {});
    rowWeight_.assign(values.size(), 0);
    // A separable kernel: rows, then columns.
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::size_t at = lightmap.SuperIndex(x, y);
            for (int k = std::max(x - radius, 0); k <= std::min(x + radius, width - 1); ++k) {
                const std::size_t from = lightmap.SuperIndex(k, y);
                const float weight = !lightmap.Mapped(from) ? 0 : std::abs(k - x) == radius ? 0.5f : 1.0f;
                rows_[at] += values[from] * weight;
                rowWeight_[at] += weight;
            }
        }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::size_t at = lightmap.SuperIndex(x, y);
            Vec3f sum;
            float weights = 0;
            for (int k = std::max(y - radius, 0); k <= std::min(y + radius, height - 1); ++k) {
                const std::size_t from = lightmap.SuperIndex(x, k);
                const float weight = std::abs(k - y) == radius ? 0.5f : 1.0f;
                sum += rows_[from] * weight;
                weights += rowWeight_[from] * weight;
            }
            values[at] = lightmap.Mapped(at) && weights > 0 ? sum / weights : Vec3f{};
        }
}

} // namespace q3
