// GPL-2.0-or-later. Height fields: bilinear surfaces over the texels of an image.
#include "q3map2/ssbump/height_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace q3 {

namespace {

constexpr double kWhite = 100 * 65535.0; // weights of the channels add up to 100

/// Slope at `here`: central difference of its two neighbors, one-sided if one is missing.
float Slope(std::optional<float> before, float here, std::optional<float> after) {
    const float distance = (before ? 1.0f : 0.0f) + (after ? 1.0f : 0.0f);
    return distance > 0 ? (after.value_or(here) - before.value_or(here)) / distance : 0;
}

/// A quarter of the discrete Laplacian. At an edge the second difference across it is 0: the surface goes on straight.
float Curvature(const HeightField &field, int x, int y) {
    const float here = field.At(x, y);
    float sum = 0;
    for (const auto &[right, down] : {std::pair{1, 0}, std::pair{0, 1}}) {
        const auto before = field.Beside(x, y, -right, -down), after = field.Beside(x, y, right, down);
        if (before && after)
            sum += *before - 2 * here + *after;
    }
    return sum / 4;
}

/// Calls body(x, y, index) for all texels, each row in one worker.
template <typename Body> void ForTexels(const HeightField &field, const JobPool &jobs, const Body &body) {
    jobs.For(field.height, [&](std::int64_t y, int) {
        for (int x = 0; x < field.width; ++x)
            body(x, int(y), std::size_t(y) * std::size_t(field.width) + std::size_t(x));
    });
}

} // namespace

std::optional<float> HeightField::Beside(int x, int y, int right, int down) const {
    const int column = x + right, row = y + down;
    if (tiles)
        return At(Wrapped(column, width), Wrapped(row, height));
    if (column < 0 || column >= width || row < 0 || row >= height)
        return std::nullopt;
    return At(column, row);
}

Gradient GradientAt(const HeightField &field, int x, int y) {
    const float here = field.At(x, y);
    return {Slope(field.Beside(x, y, -1, 0), here, field.Beside(x, y, 1, 0)),
            Slope(field.Beside(x, y, 0, -1), here, field.Beside(x, y, 0, 1))};
}

Vec3f NormalOf(const Gradient &gradient) {
    return Normalize(Vec3f{-gradient.s, -gradient.t, 1});
}

HeightField HeightsOf(const DeepImage &image, double scale, bool tiles) {
    HeightField field{image.width, image.height, tiles};
    field.heights.reserve(image.rgba.size() / 4);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const int sum = 30 * image.rgba[i] + 59 * image.rgba[i + 1] + 11 * image.rgba[i + 2];
        field.heights.push_back(float(sum * scale / kWhite));
    }
    return field;
}

void SmoothSteps(HeightField &field, int passes, double step, const JobPool &jobs) {
    constexpr float kRelaxation = 0.45f; // converges below 2 / 4: eigenvalues of Curvature applied twice reach 4
    const std::vector<float> original = field.heights;
    HeightField curvature = field;
    const auto half = float(step / 2);
    for (int pass = 0; pass < passes; ++pass) {
        ForTexels(field, jobs, [&](int x, int y, std::size_t at) { curvature.heights[at] = Curvature(field, x, y); });
        ForTexels(field, jobs, [&](int x, int y, std::size_t at) {
            const float height = field.heights[at] - kRelaxation * Curvature(curvature, x, y);
            field.heights[at] = std::clamp(height, original[at] - half, original[at] + half);
        });
    }
}

} // namespace q3
