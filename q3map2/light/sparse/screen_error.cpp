// GPL-2.0-or-later. Difference of two lights on surfaces as a screen shows them.
#include "q3map2/light/sparse/screen_error.h"

#include "libs/sh/sh.h"
#include "q3map2/light/batch/simd.h"

#include <algorithm>

namespace q3 {

namespace {

/// Pairs of opposite normals, and normals.
constexpr int kAxes = 13, kNormals = 2 * kAxes;

/// A channel at the normals, as the sums over even and odd bands: at the opposite normals odd bands change sign.
struct Halves {
    Lanes even, odd;
};

Q3_VECTOR Halves HalvesOf(const std::array<Lanes, 9> &basis, const float *light) {
    Halves halves;
    for (const std::size_t i : kEachLane) {
        halves.odd[i] = basis[1][i] * light[3] + basis[2][i] * light[6] + basis[3][i] * light[9];
        halves.even[i] = basis[0][i] * light[0] + basis[4][i] * light[12] + basis[5][i] * light[15] +
                         basis[6][i] * light[18] + basis[7][i] * light[21] + basis[8][i] * light[24];
    }
    return halves;
}

Q3_VECTOR float SumOfSquares(const Halves &a, const Halves &b) {
    Lanes squares;
    for (const std::size_t i : kEachLane) {
        const float up = std::clamp(a.even[i] + a.odd[i], 0.0f, 1.0f) - std::clamp(b.even[i] + b.odd[i], 0.0f, 1.0f);
        const float down = std::clamp(a.even[i] - a.odd[i], 0.0f, 1.0f) - std::clamp(b.even[i] - b.odd[i], 0.0f, 1.0f);
        squares[i] = up * up + down * down;
    }
    float sum = 0;
    for (const std::size_t i : kEachLane)
        sum += squares[i];
    return sum;
}

} // namespace

ScreenError::ScreenError() : basis_{} {
    for (int i = 0; i < kAxes; ++i) { // the first half of the 3 x 3 x 3 directions; the other half is opposite to it
        const Vec3d n = Normalize(Vec3d{double(i % 3 - 1), double(i / 3 % 3 - 1), double(i / 9 - 1)});
        const ShVector basis = ShBasis(n);
        for (std::size_t k = 0; k < 9; ++k)
            basis_[k][std::size_t(i)] = float(basis[k]);
    }
}

float ScreenError::Squared(const ShFloats &a, const ShFloats &b) const {
    float sum = 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
        sum += SumOfSquares(HalvesOf(basis_, a.data() + channel), HalvesOf(basis_, b.data() + channel));
    return sum * (255.0f * 255.0f / float(3 * kNormals));
}

} // namespace q3
