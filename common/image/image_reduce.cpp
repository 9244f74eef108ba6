// GPL-2.0-or-later. Images of fewer texels.
#include "common/image/image_reduce.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// What a texel of the small image covers along one axis, in texels of the large one.
struct Interval {
    double low = 0, high = 0;

    int First() const { return int(low); }
    /// One past the last, where the large image has `size`.
    int End(int size) const { return std::min(size, int(std::ceil(high))); }
    double Overlap(int texel) const { return std::min(high, double(texel + 1)) - std::max(low, double(texel)); }
};

std::array<std::uint8_t, 4> Mean(const Image &image, const Interval &columns, const Interval &rows) {
    std::array<double, 4> sums{};
    double weights = 0;
    for (int row = rows.First(); row < rows.End(image.height); ++row)
        for (int column = columns.First(); column < columns.End(image.width); ++column) {
            const double weight = rows.Overlap(row) * columns.Overlap(column);
            const auto texel = image.Texel(column, row);
            for (std::size_t channel = 0; channel < 4; ++channel)
                sums[channel] += weight * texel[channel];
            weights += weight;
        }
    std::array<std::uint8_t, 4> mean{};
    for (std::size_t channel = 0; channel < 4; ++channel)
        mean[channel] = std::uint8_t(std::lround(sums[channel] / weights));
    return mean;
}

} // namespace

Image Reduced(const Image &image, int longestSide) {
    const double scale = double(std::max(image.width, image.height)) / longestSide;
    if (scale <= 1)
        return image;
    const auto side = [&](int size) { return std::max(1, int(std::lround(size / scale))); };
    Image small{side(image.width), side(image.height), {}};
    small.rgba.reserve(4 * std::size_t(small.width) * std::size_t(small.height));
    const double perColumn = double(image.width) / small.width, perRow = double(image.height) / small.height;
    for (int row = 0; row < small.height; ++row)
        for (int column = 0; column < small.width; ++column) {
            const auto mean =
                Mean(image, {column * perColumn, (column + 1) * perColumn}, {row * perRow, (row + 1) * perRow});
            small.rgba.insert(small.rgba.end(), mean.begin(), mean.end());
        }
    return small;
}

} // namespace q3
