// GPL-2.0-or-later. Real L2 spherical harmonics: basis, cosine convolution, projection of lights, and deringing.
#include "libs/sh/sh.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Minimum left above zero after rounding to float, divided by the mean; twice as much is left before. Rounding nine
/// coefficients changes their sum by less than 5e-7 of the mean.
constexpr double kMargin = 1e-6;
/// Below this mean, floats may have too few digits to stay above zero.
constexpr double kLeastMean = 1e-30;

using Matrix3 = std::array<std::array<double, 3>, 3>;

struct Eigensystem {
    Vec3d value;
    std::array<Vec3d, 3> axis; ///< unit eigenvectors
};

/// Jacobi's method.
Eigensystem EigensystemOf(Matrix3 m) {
    std::array<Vec3d, 3> axis = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    constexpr int kSweeps = 12; // converges quadratically, in about five sweeps
    for (int step = 0; step < 3 * kSweeps; ++step) {
        const std::size_t i = step % 3 == 2 ? 1 : 0, j = step % 3 == 0 ? 1 : 2, k = 3 - i - j;
        if (m[i][j] == 0)
            continue;
        const double theta = (m[j][j] - m[i][i]) / (2 * m[i][j]);
        const double t = std::copysign(1 / (std::abs(theta) + std::hypot(theta, 1)), theta);
        const double cosine = 1 / std::sqrt(t * t + 1), sine = t * cosine;
        m[i][i] -= t * m[i][j], m[j][j] += t * m[i][j];
        const double ki = m[k][i], kj = m[k][j];
        m[k][i] = m[i][k] = cosine * ki - sine * kj, m[k][j] = m[j][k] = sine * ki + cosine * kj;
        m[i][j] = m[j][i] = 0;
        const Vec3d ai = axis[i], aj = axis[j];
        axis[i] = ai * cosine - aj * sine, axis[j] = ai * sine + aj * cosine;
    }
    return {{m[0][0], m[1][1], m[2][2]}, axis};
}

/// Minimizes 2 Dot(h, n) + sum of gap_i n_i^2 over unit n; the least gap is 0. Stationary points have
/// n_i = -h_i / (gap_i + t), and at the minimum t >= 0 makes n a unit vector. Newton's method on |n| = 1 rises
/// monotonically to that t from a lower bound (Moré and Sorensen, 1983).
Vec3d MinimizeOnSphere(const Vec3d &gap, const Vec3d &h) {
    double t = 0;
    for (std::size_t i = 0; i < 3; ++i)
        t = std::max(t, std::abs(h[i]) - gap[i]);
    Vec3d n;
    constexpr int kMostSteps = 30;            // it converges quadratically
    constexpr double kLongEnough = 1 + 1e-14; // |n|^2 up to rounding
    for (int step = 0; step < kMostSteps; ++step) {
        double square = 0, slope = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            n[i] = h[i] == 0 ? 0 : -h[i] / (gap[i] + t);
            square += n[i] * n[i];
            slope += h[i] == 0 ? 0 : n[i] * n[i] / (gap[i] + t);
        }
        const double next = square > kLongEnough ? t + (std::sqrt(square) - 1) * square / slope : t;
        if (!(next > t))
            break;
        t = next;
    }
    // The hard case: h is orthogonal to the axis of the least eigenvalue, and n gets its missing length along it.
    for (std::size_t i = 0; t == 0 && i < 3; ++i)
        if (gap[i] == 0) {
            n[i] += std::sqrt(std::max(0.0, 1 - Dot(n, n)));
            break;
        }
    return Normalize(n);
}

/// The SH sum as mean + 2 Dot(linear, n) + n . A n, A symmetric with trace 0, in the frame of A's eigenvectors.
class SHPolynomial {
  public:
    explicit SHPolynomial(const SHVector &c) : mean_(kSHC0 * c[0]) {
        const double z = kSHC3 * c[6], d = kSHC4 * c[8], half = kSHC2 / 2;
        const double xy = half * c[4], yz = half * c[5], xz = half * c[7];
        frame_ = EigensystemOf({{{d - z, xy, xz}, {xy, -d - z, yz}, {xz, yz, 2 * z}}});
        const Vec3d linear = Vec3d{c[3], c[1], c[2]} * (kSHC1 / 2);
        for (std::size_t i = 0; i < 3; ++i)
            linear_[i] = Dot(linear, frame_.axis[i]);
        least_ = std::min({frame_.value.x, frame_.value.y, frame_.value.z});
    }
    double Mean() const { return mean_; }
    /// Quick sufficient condition.
    bool IsSurelyPositive() const { return mean_ + least_ > 2 * Length(linear_) * (1 + 1e-9); }
    /// Global minimum of the sum with bands 1 and 2 scaled, and its direction.
    SHMinimum Minimum(double scale1, double scale2) const {
        const Vec3d gap = frame_.value - Vec3d{least_, least_, least_};
        const Vec3d h = linear_ * scale1, n = MinimizeOnSphere(gap * scale2, h);
        const double value =
            mean_ + 2 * Dot(h, n) +
            scale2 * (frame_.value.x * n.x * n.x + frame_.value.y * n.y * n.y + frame_.value.z * n.z * n.z);
        return {Normalize(frame_.axis[0] * n.x + frame_.axis[1] * n.y + frame_.axis[2] * n.z), value};
    }

  private:
    double mean_, least_;
    Eigensystem frame_;
    Vec3d linear_;
};

/// Window of band l: 1 / (1 + lambda l^2 (l + 1)^2).
struct Window {
    double band1, band2;
    explicit Window(double lambda) : band1(1 / (1 + 4 * lambda)), band2(1 / (1 + 36 * lambda)) {}
};

} // namespace

SHMinimum MinimumOfSH(const SHVector &c) {
    const Vec3d direction = SHPolynomial(c).Minimum(1, 1).direction;
    const SHVector basis = SHBasis(direction);
    double value = 0;
    for (std::size_t k = 0; k < 9; ++k)
        value += c[k] * basis[k];
    return {direction, value};
}

bool RemoveNegativeLobes(SHVector &c) {
    if (!(c[0] >= kLeastMean)) {
        const bool changed = std::any_of(c.begin() + 1, c.end(), [](double x) { return x != 0; });
        std::fill(c.begin() + 1, c.end(), 0.0);
        return changed;
    }
    const SHPolynomial sum(c);
    if (sum.IsSurelyPositive() || sum.Minimum(1, 1).value >= 0)
        return false;
    const auto isPositive = [&](double lambda) {
        const Window window(lambda);
        return sum.Minimum(window.band1, window.band2).value >= 2 * kMargin * sum.Mean();
    };
    double low = 0, high = 1.0 / 36;
    while (!isPositive(high))
        low = high, high *= 2;
    constexpr double kPrecision = 1e-4; // of 1 + 36 lambda, hence of the window
    while (high - low > kPrecision / 36 * (1 + 36 * low)) {
        const double middle = (low + high) / 2;
        (isPositive(middle) ? high : low) = middle;
    }
    const Window window(high);
    for (std::size_t k = 1; k < 9; ++k)
        c[k] *= k < 4 ? window.band1 : window.band2;
    return true;
}

} // namespace q3
