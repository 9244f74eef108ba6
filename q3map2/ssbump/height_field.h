// GPL-2.0-or-later. Height fields: bilinear surfaces over the texels of an image.
#pragma once

#include "common/image/image.h"
#include "common/jobs.h"
#include "libs/math/vec.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace q3 {

/// The coordinate from 0 on of a texel of a tiling image.
inline int Wrapped(int coordinate, int size) {
    return (coordinate % size + size) % size;
}

/// Heights at the centers of texels, in texels, row 0 on top. Between centers they are bilinear.
struct HeightField {
    int width = 0, height = 0;
    bool tiles = true; ///< repeats without end; else there is nothing beyond the outer centers
    std::vector<float> heights{};

    float At(int x, int y) const { return heights[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    /// The height at (x + right, y + down); nullopt beyond the edges of a field that does not tile.
    std::optional<float> Beside(int x, int y, int right, int down) const;
};

/// A slope: growth of the height along s (to the right) and t (down), texels per texel.
struct Gradient {
    float s = 0, t = 0;
};

/// By central differences; at edges of a field that does not tile, one-sided ones.
Gradient GradientAt(const HeightField &field, int x, int y);
/// The unit normal of a surface with this gradient: x along s, y along t, z up.
Vec3f NormalOf(const Gradient &gradient);

/// Heights from the luminance (30 % red, 59 % green, 11 % blue) of an image; `scale`: height of white, in texels.
HeightField HeightsOf(const DeepImage &image, double scale, bool tiles);

/// Smooths the terraces that few bits make of a slope: `passes` of relaxation toward a thin plate, in which no height
/// moves by more than half a step. `step`: height between neighboring values of the image, in texels.
void SmoothSteps(HeightField &field, int passes, double step, const JobPool &jobs);

} // namespace q3
