// GPL-2.0-or-later. Values of the sparse SH light grid, quantized.
#include "q3map2/bspfile/sparse_grid.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspfile_sparse.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

namespace {

constexpr int kPlainScale = 128; ///< the code of scale 1
constexpr int kScaleSteps = 8;   ///< codes to a doubling of the scale
constexpr float kMaxStep = 127;  ///< of the signed bytes of bands 1 and 2

/// 2^(i / 8).
constexpr std::array<float, kScaleSteps> kEighths = {1.0f,        1.09050773f, 1.18920712f, 1.29683955f,
                                                     1.41421356f, 1.54221083f, 1.68179283f, 1.83400809f};

float BandLimit(std::size_t k) {
    return kSparseBandLimits[k < 4 ? 0 : 1];
}

void CheckFinite(const bspGridPointSH_t &value, std::size_t index) {
    for (std::size_t k = 0; k < 9; ++k)
        for (const float c : value.coeffs[k])
            if (!std::isfinite(c))
                throw Error("{}: point {}: coefficient {} is {}, not a finite number", kBspxSparseGridSH, index, k, c);
}

/// The largest ratio of a coefficient of bands 1 and 2 to the limit of its band: the scale that the point needs. mean:
/// coefficient 0 as stored. Where rounding made that smaller, the exact one counts here, and Quantize clamps the
/// coefficients by no more than the error of the mean.
float NeededScale(const bspGridPointSH_t &value, const Vec3f &mean) {
    float most = 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t k = 1; mean[channel] > 0 && k < 9; ++k)
            most = std::max(most, std::abs(value.coeffs[k][channel]) /
                                      (BandLimit(k) * std::max(mean[channel], value.coeffs[0][channel])));
    return most;
}

/// The code of the smallest scale that is at least `needed`.
std::uint8_t ScaleCode(float needed) {
    if (!(needed > 0))
        return 0;
    const double code = std::ceil(kPlainScale + kScaleSteps * std::log2(double(needed)));
    int scale = int(std::clamp(code, 0.0, 255.0));
    if (scale < 255 && SparseScale(std::uint8_t(scale)) < needed) // by rounding
        ++scale;
    return std::uint8_t(scale);
}

SparseGridPoint Quantize(const bspGridPointSH_t &value, std::uint8_t scale) {
    SparseGridPoint point;
    point.mean = EncodeE5bgr9(Vec3f(value.coeffs[0]));
    const Vec3f mean = DecodeE5bgr9(point.mean);
    for (std::size_t k = 1; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float unit = SparseScale(scale) * BandLimit(k) * mean[channel];
            const float steps = unit > 0 ? kMaxStep * (value.coeffs[k][channel] / unit) : 0;
            point.bands[3 * (k - 1) + channel] = std::int8_t(std::lround(std::clamp(steps, -kMaxStep, kMaxStep)));
        }
    return point;
}

} // namespace

float SparseScale(std::uint8_t scale) {
    return std::ldexp(kEighths[scale % kScaleSteps], (scale - kPlainScale - scale % kScaleSteps) / kScaleSteps);
}

void NumberSparseNodes(SparseGridSH &grid) {
    std::uint64_t children = 1, points = 0;
    for (const std::int32_t roots : grid.roots)
        children *= std::uint64_t(std::clamp(roots, 0, kMaxSparseCells)); // CheckSparseGrid says what is wrong
    for (SparseGridNode &node : grid.nodes) {
        node.children = std::uint32_t(children);
        node.points = std::uint32_t(points);
        children += std::uint64_t(std::popcount(node.inner));
        points += std::uint64_t(std::popcount(node.stored));
    }
}

SparseGridSH PackSparseGrid(const SparseGridTree &tree) {
    SparseGridSH grid{tree.mins, tree.cell, tree.roots, tree.levels, tree.nodes, {}};
    NumberSparseNodes(grid);
    grid.points.resize(tree.values.size());
    CheckSparseGrid(grid, "packing");
    for (SparseGridNode &node : grid.nodes) {
        const std::size_t count = std::size_t(std::popcount(node.stored));
        float needed = 0;
        for (std::size_t i = node.points; i < node.points + count; ++i) {
            CheckFinite(tree.values[i], i);
            needed = std::max(needed,
                              NeededScale(tree.values[i], DecodeE5bgr9(EncodeE5bgr9(Vec3f(tree.values[i].coeffs[0])))));
        }
        node.scale = ScaleCode(needed);
        for (std::size_t i = node.points; i < node.points + count; ++i)
            grid.points[i] = Quantize(tree.values[i], node.scale);
    }
    return grid;
}

bspGridPointSH_t DequantizePoint(const SparseGridPoint &point, std::uint8_t scale) {
    bspGridPointSH_t value{};
    const Vec3f mean = DecodeE5bgr9(point.mean);
    const float factor = SparseScale(scale);
    value.coeffs[0] = mean.Array();
    for (std::size_t k = 1; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float steps = std::max<float>(point.bands[3 * (k - 1) + channel], -kMaxStep);
            value.coeffs[k][channel] = steps / kMaxStep * BandLimit(k) * factor * mean[channel];
        }
    return value;
}

std::vector<bspGridPointSH_t> DequantizePoints(const SparseGridSH &grid) {
    std::vector<bspGridPointSH_t> values(grid.points.size());
    for (const SparseGridNode &node : grid.nodes)
        for (std::size_t i = node.points; i < node.points + std::size_t(std::popcount(node.stored)); ++i)
            values[i] = DequantizePoint(grid.points[i], node.scale);
    return values;
}

} // namespace q3
