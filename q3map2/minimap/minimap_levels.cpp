// GPL-2.0-or-later. Level curves of minimaps.
#include "q3map2/minimap/minimap_levels.h"

#include <algorithm>

namespace q3 {

namespace {

void BoostValues(std::vector<float> &values, double boost) {
    constexpr double kLeast = 1e-6; // a boost below 1 has a pole above 1, where solids overlap
    for (float &value : values)
        value = float(value * boost / std::max((boost - 1) * value + 1, kLeast));
}

struct LevelCurve {
    double contrast, brightness;
};

/// The curve that follows a stretch of the values to 0..1. The lowest counts as 1 at most, the highest as 0 at least.
LevelCurve AutoLevel(const std::vector<float> &values, LevelCurve curve, Log &log) {
    double low = 1, high = 0;
    for (const float value : values)
        low = std::min(low, double(value)), high = std::max(high, double(value));
    if (high > low) {
        curve.brightness -= curve.contrast * low / (high - low);
        curve.contrast /= high - low;
        log.Print("Auto level: brightness {:f}, contrast {:f}\n", curve.brightness, curve.contrast);
    }
    return curve;
}

/// (8 s + 1) v - s (sum of the eight neighbors); outside counts as 0.
void SharpenImage(MinimapValues &image, double s) {
    const MinimapValues from = image;
    const auto at = [&](int x, int y) {
        const bool inside = x >= 0 && y >= 0 && x < from.size && y < from.size;
        return inside ? double(from.values[std::size_t(y) * std::size_t(from.size) + std::size_t(x)]) : 0;
    };
    for (int y = 0; y < from.size; ++y)
        for (int x = 0; x < from.size; ++x) {
            double around = -at(x, y);
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx)
                    around += at(x + dx, y + dy);
            image.values[std::size_t(y) * std::size_t(from.size) + std::size_t(x)] =
                float((8 * s + 1) * at(x, y) - s * around);
        }
}

} // namespace

void ApplyMinimapLevels(MinimapValues &image, const MinimapOptions &options, Log &log) {
    if (options.boost != 1)
        BoostValues(image.values, options.boost);
    LevelCurve curve{options.contrast, options.brightness};
    if (options.autoLevel)
        curve = AutoLevel(image.values, curve, log);
    if (curve.contrast != 1 || curve.brightness != 0)
        for (float &value : image.values)
            value = float(value * curve.contrast + curve.brightness);
    if (options.sharpen > 0)
        SharpenImage(image, options.sharpen);
}

} // namespace q3
