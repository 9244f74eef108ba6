// GPL-2.0-or-later. L2 spherical harmonics without negative lobes.
#include "libs/sh/dering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace q3 {

namespace {

/// Rounding nine coefficients to float changes the sum by less than 5e-7 of its mean, so this much is left above zero.
constexpr double kMargin = 1e-6;
constexpr double kRounding = 1e-8; ///< of the mean
/// Below this mean, floats may have too few digits to stay above zero.
constexpr double kLeastMean = 1e-30;
/// Farther from zero than this, in means, bands 1 and 2 count by their direction only.
constexpr double kFarthest = 1e4;

double Value(const ShVector &c, const ShVector &basis) {
    double sum = 0;
    for (std::size_t k = 0; k < 9; ++k)
        sum += c[k] * basis[k];
    return sum;
}

/// Symmetric 3 x 3 matrix with trace 0.
struct Quadratic {
    double xx, yy, zz, xy, yz, xz;
    Vec3d operator*(const Vec3d &v) const {
        return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
    }
    /// Square of the Frobenius norm.
    double Norm2() const { return xx * xx + yy * yy + zz * zz + 2 * (xy * xy + yz * yz + xz * xz); }
};

Quadratic QuadraticOf(const ShVector &c) {
    const double z = kShC3 * c[6], d = kShC4 * c[8], half = kShC2 / 2;
    return {d - z, -d - z, 2 * z, half * c[4], half * c[5], half * c[7]};
}

/// Eigenvalues, ascending, and unit eigenvectors.
struct Eigen {
    std::array<double, 3> value;
    std::array<Vec3d, 3> axis;
};

/// Unit vector across v, a unit vector.
Vec3d Across(const Vec3d &v) {
    return Normalize(std::abs(v.x) > std::abs(v.y) ? Vec3d{-v.z, 0, v.x} : Vec3d{0, v.z, -v.y});
}

/// Null vector of m - value, for the eigenvalue that is farthest from the others.
Vec3d LoneAxis(const Quadratic &m, double value) {
    const Vec3d r0{m.xx - value, m.xy, m.xz}, r1{m.xy, m.yy - value, m.yz}, r2{m.xz, m.yz, m.zz - value};
    const Vec3d c0 = Cross(r0, r1), c1 = Cross(r0, r2), c2 = Cross(r1, r2);
    const double d0 = Dot(c0, c0), d1 = Dot(c1, c1), d2 = Dot(c2, c2);
    const double largest = std::max({d0, d1, d2});
    return (largest == d0 ? c0 : largest == d1 ? c1 : c2) / std::sqrt(largest);
}

/// Eigenvalues by the cubic's trigonometric form; the eigenvector of the lone eigenvalue first, the others in the plane
/// across it, which keeps them exact when their eigenvalues meet.
Eigen EigenOf(const Quadratic &m) {
    const double p = std::sqrt(m.Norm2() / 6);
    if (!(p > 0))
        return {{0, 0, 0}, {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}};
    const Quadratic s{m.xx / p, m.yy / p, m.zz / p, m.xy / p, m.yz / p, m.xz / p};
    const double det =
        s.xx * (s.yy * s.zz - s.yz * s.yz) - s.xy * (s.xy * s.zz - s.yz * s.xz) + s.xz * (s.xy * s.yz - s.yy * s.xz);
    // The lone eigenvalue is the largest when the determinant is positive, else the least.
    const double side = det < 0 ? -1 : 1;
    const double lone = side * 2 * std::cos(std::acos(std::min(1.0, std::abs(det) / 2)) / 3);
    const Vec3d w = LoneAxis(s, lone), u = Across(w), v = Cross(w, u);
    const Vec3d su = s * u, sv = s * v;
    const double uu = Dot(u, su), uv = Dot(u, sv), vv = Dot(v, sv);
    const double half = (uu - vv) / 2, root = std::sqrt(half * half + uv * uv), middle = (uu + vv) / 2;
    Vec3d low = half > 0 ? u * uv - v * (half + root) : u * (half - root) + v * uv;
    const double length = Length(low);
    low = length > 0 ? low / length : u;
    const Vec3d high = Cross(w, low);
    const double a = (middle - root) * p, b = (middle + root) * p;
    if (side > 0)
        return {{a, b, lone * p}, {low, high, w}};
    return {{lone * p, a, b}, {w, low, high}};
}

/// The minimum of f(n) = n . A n + 2 h . n on the unit sphere is at (A - l) n = -h with l at most the least eigenvalue.
/// Its length, in the frame of the eigenvectors, falls with t = least eigenvalue - l: sum h_i^2 / (gap_i + t)^2 = 1 has
/// one root. Without one the least axis makes up the length. Forsythe and Golub, 1965; More and Sorensen, 1983.
Vec3d LowestInFrame(const Vec3d &gap, const Vec3d &h) {
    double t = 0;
    for (std::size_t i = 0; i < 3; ++i)
        t = std::max(t, std::abs(h[i]) - gap[i]);
    Vec3d n;
    for (int step = 0; step < 30; ++step) {
        double g = 0, slope = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            n[i] = h[i] == 0 ? 0 : -h[i] / (gap[i] + t);
            g += n[i] * n[i];
            slope += h[i] == 0 ? 0 : n[i] * n[i] / (gap[i] + t);
        }
        if (!(g > 1 + 1e-14))
            break;
        const double root = std::sqrt(g);
        const double next = t + (root - 1) * g / slope;
        if (!(next > t))
            break;
        t = next;
    }
    if (t == 0) {
        const double rest = n.y * n.y + n.z * n.z;
        n.x = std::copysign(std::sqrt(std::max(0.0, 1 - rest)), n.x);
    }
    return Normalize(n);
}

/// A sum over the basis in the frame of its quadratic part.
struct Frame {
    Eigen eigen;
    Vec3d lowest; ///< the minimum's direction, in the frame

    explicit Frame(const ShVector &c) : eigen(EigenOf(QuadraticOf(c))) {
        const Vec3d half = Vec3d{c[3], c[1], c[2]} * (kShC1 / 2);
        const Vec3d gap{0, eigen.value[1] - eigen.value[0], eigen.value[2] - eigen.value[0]};
        lowest = LowestInFrame(gap, {Dot(half, eigen.axis[0]), Dot(half, eigen.axis[1]), Dot(half, eigen.axis[2])});
    }
    Vec3d World(const Vec3d &v) const {
        return Normalize(eigen.axis[0] * v.x + eigen.axis[1] * v.y + eigen.axis[2] * v.z);
    }
};

/// Whether the linear and the quadratic part are too small to reach below zero. The least eigenvalue of a matrix of
/// trace 0 is at least -sqrt(2/3) of its norm.
bool SurelyPositive(const ShVector &c) {
    const double linear = kShC1 * std::sqrt(c[1] * c[1] + c[2] * c[2] + c[3] * c[3]);
    return kShC0 * c[0] > (linear + std::sqrt(QuadraticOf(c).Norm2() * (2.0 / 3))) * (1 + 1e-9);
}

} // namespace

ShMinimum MinimumOfSh(const ShVector &c) {
    const Frame frame(c);
    const Vec3d direction = frame.World(frame.lowest);
    return {direction, Value(c, ShBasis(direction))};
}

namespace {

// A sum over the basis up to band 2 is nowhere negative exactly when it is a sum of squares of linear functions,
// (p . n + w)^2 added up (the S-lemma). So the nearest one is found among such sums: v = (p, w), the matrix M = sum of
// v v^T, its quadratic part the upper left block without its trace, its linear part twice the right column. It is the
// nearest of all when the gradient Z of the squared distance with respect to M, less a multiplier for the mean, has no
// negative eigenvalue. Burer and Monteiro, 2003.

using Vector4 = std::array<double, 4>;
using Matrix4 = std::array<Vector4, 4>;
template <std::size_t R> using Squares = std::array<Vector4, R>;

/// Squared length of coefficients by the quadratic and by the linear part.
constexpr double kQuadraticWeight = 8 * std::numbers::pi / 15, kLinearWeight = 4 * std::numbers::pi / 3;
/// Mean of (p . n + w)^2 is |p|^2 / 3 + w^2.
constexpr Vector4 kMeanWeight = {1, 1, 1, 3};
constexpr int kMaxSteps = 40;
/// Eigenvalues of Z that count as zero, relative to its size.
constexpr double kFlat = 1e-9;
/// Steps end when the gradient is this small, relative to Z.
constexpr double kConverged = 1e-6;

double Dot4(const Vector4 &a, const Vector4 &b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

Matrix4 MatrixOf(const ShVector &c) {
    const Quadratic q = QuadraticOf(c);
    const double half = kShC1 / 2, x = half * c[3], y = half * c[1], z = half * c[2];
    return {Vector4{q.xx, q.xy, q.xz, x}, Vector4{q.xy, q.yy, q.yz, y}, Vector4{q.xz, q.yz, q.zz, z},
            Vector4{x, y, z, 0}};
}

template <std::size_t R> Matrix4 Gram(const Squares<R> &v) {
    Matrix4 m{};
    for (const Vector4 &one : v)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < 4; ++j)
                m[i][j] += one[i] * one[j];
    return m;
}

/// Scales the mean to 1.
template <std::size_t R> void Normalise(Squares<R> &v) {
    double mean = 0;
    for (const Vector4 &one : v)
        for (std::size_t i = 0; i < 4; ++i)
            mean += kMeanWeight[i] * one[i] * one[i] / 3;
    const double scale = 1 / std::sqrt(mean);
    for (Vector4 &one : v)
        for (double &x : one)
            x *= scale;
}

/// Half the squared distance from the target, and Z.
template <std::size_t R> double Distance(const Matrix4 &target, const Squares<R> &v, Matrix4 &z) {
    const Matrix4 m = Gram(v);
    const double third = (m[0][0] + m[1][1] + m[2][2]) / 3;
    double distance = 0, along = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const double off = m[i][j] - (i == j ? third : 0) - target[i][j];
            z[i][j] = kQuadraticWeight * off;
            distance += z[i][j] * off / 2;
            along += z[i][j] * m[i][j] / 3;
        }
        const double off = 2 * (m[i][3] - target[i][3]);
        z[i][3] = z[3][i] = kLinearWeight * off;
        distance += z[i][3] * off / 2;
        along += z[i][3] * m[i][3] * 2 / 3;
    }
    z[3][3] = 0;
    for (std::size_t i = 0; i < 4; ++i)
        z[i][i] -= along * kMeanWeight[i];
    return distance;
}

double SizeOf(const Matrix4 &z) {
    return std::abs(z[0][0]) + std::abs(z[1][1]) + std::abs(z[2][2]) + std::abs(z[3][3]);
}

/// Newton's method for the nearest sum of R squares of mean 1.
template <std::size_t R> class NearestSquares {
  public:
    NearestSquares(const Matrix4 &target, const Squares<R> &start) : target_(target), v_(start) {
        Normalise(v_);
        distance_ = Distance(target_, v_, z_);
        for (int step = 0; step < kMaxSteps && Step(); ++step) {
        }
    }
    const Squares<R> &Result() const { return v_; }

    /// Whether nothing is nearer; else `way` is a square that leads there.
    bool Nearest(Vector4 &way) const {
        // Pivots of Z + M: Z is zero along the squares themselves.
        Matrix4 a = Gram(v_), lower{};
        Vector4 pivot{};
        const double size = SizeOf(z_), flat = kFlat * (1 + size);
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j <= i; ++j) {
                double sum = a[i][j] * (1 + size) + z_[i][j] + (i == j ? flat : 0);
                for (std::size_t k = 0; k < j; ++k)
                    sum -= lower[i][k] * lower[j][k] * pivot[k];
                (i == j ? pivot[i] : lower[i][j]) = i == j ? sum : sum / pivot[j];
            }
            if (pivot[i] > 0)
                continue;
            way = {};
            way[i] = 1;
            for (std::size_t k = i; k-- > 0;)
                for (std::size_t m = k + 1; m <= i; ++m)
                    way[k] -= lower[m][k] * way[m];
            return false;
        }
        return true;
    }

  private:
    static constexpr std::size_t kSize = 4 * R;
    using Vector = std::array<double, kSize>;
    using Matrix = std::array<Vector, kSize>;

    /// Second derivatives along squares a and b.
    void AddBlock(std::size_t a, std::size_t b, Matrix &h) const {
        const Vector4 &va = v_[a], &vb = v_[b];
        const double pp = va[0] * vb[0] + va[1] * vb[1] + va[2] * vb[2];
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < 4; ++j) {
                double &at = h[4 * a + i][4 * b + j];
                at = a == b ? z_[i][j] : 0;
                if (i < 3 && j < 3)
                    at += kQuadraticWeight * (vb[i] * va[j] - va[i] * vb[j] * 2 / 3) +
                          (i == j ? kQuadraticWeight * pp + 2 * kLinearWeight * va[3] * vb[3] : 0);
                else
                    at += 2 * kLinearWeight * (i < 3 ? va[3] * vb[i] : j < 3 ? vb[3] * va[j] : pp);
            }
    }

    Matrix Hessian(const Vector &mean) const {
        Matrix h;
        for (std::size_t a = 0; a < R; ++a)
            for (std::size_t b = 0; b < R; ++b)
                AddBlock(a, b, h);
        const double size = 1 + SizeOf(z_);
        for (std::size_t i = 0; i < kSize; ++i)
            for (std::size_t j = 0; j < kSize; ++j)
                h[i][j] += size * mean[i] * mean[j];
        // Turning squares into each other changes nothing: those directions get a slope of their own.
        for (std::size_t a = 0; a < R; ++a)
            for (std::size_t b = a + 1; b < R; ++b)
                for (std::size_t i = 0; i < 8; ++i)
                    for (std::size_t j = 0; j < 8; ++j) {
                        const double left = i < 4 ? v_[b][i] : -v_[a][i - 4];
                        const double right = j < 4 ? v_[b][j] : -v_[a][j - 4];
                        h[4 * (i < 4 ? a : b) + i % 4][4 * (j < 4 ? a : b) + j % 4] += size * left * right;
                    }
        return h;
    }

    static bool Factor(const Matrix &h, double shift, Matrix &lower) {
        for (std::size_t i = 0; i < kSize; ++i)
            for (std::size_t j = 0; j <= i; ++j) {
                double sum = h[i][j] + (i == j ? shift : 0);
                for (std::size_t k = 0; k < j; ++k)
                    sum -= lower[i][k] * lower[j][k];
                if (i == j && !(sum > 1e-9))
                    return false;
                lower[i][j] = i == j ? std::sqrt(sum) : sum / lower[j][j];
            }
        return true;
    }

    static void Solve(const Matrix &lower, Vector &x) {
        for (std::size_t i = 0; i < kSize; ++i) {
            for (std::size_t k = 0; k < i; ++k)
                x[i] -= lower[i][k] * x[k];
            x[i] /= lower[i][i];
        }
        for (std::size_t i = kSize; i-- > 0;) {
            for (std::size_t k = i + 1; k < kSize; ++k)
                x[i] -= lower[k][i] * x[k];
            x[i] /= lower[i][i];
        }
    }

    /// False at the end.
    bool Step() {
        Vector way, mean;
        double slope = 0;
        for (std::size_t a = 0; a < R; ++a)
            for (std::size_t i = 0; i < 4; ++i) {
                const double gradient = Dot4(z_[i], v_[a]);
                slope += gradient * gradient;
                way[4 * a + i] = -gradient;
                mean[4 * a + i] = kMeanWeight[i] * v_[a][i];
            }
        const double size = 1 + SizeOf(z_);
        if (slope < kConverged * kConverged * size * size)
            return false;
        const Matrix h = Hessian(mean);
        Matrix lower;
        for (double shift = 0; !Factor(h, shift, lower);)
            shift = shift > 0 ? 4 * shift : 0.01 * size;
        // The step keeps the mean to first order.
        Vector across = mean;
        Solve(lower, way);
        Solve(lower, across);
        double off = 0, scale = 0;
        for (std::size_t i = 0; i < kSize; ++i)
            off += mean[i] * way[i], scale += mean[i] * across[i];
        for (std::size_t i = 0; i < kSize; ++i)
            way[i] -= across[i] * off / scale;
        return Move(way);
    }

    bool Move(const Vector &way) {
        for (double share = 1; share > 1e-6; share /= 2) {
            Squares<R> next = v_;
            for (std::size_t i = 0; i < kSize; ++i)
                next[i / 4][i % 4] += share * way[i];
            Normalise(next);
            Matrix4 z;
            const double distance = Distance(target_, next, z);
            if (distance <= distance_ * (1 + 1e-15)) {
                v_ = next, z_ = z, distance_ = distance;
                return true;
            }
        }
        return false;
    }

    const Matrix4 &target_;
    Squares<R> v_;
    Matrix4 z_{};
    double distance_ = 0;
};

/// One more square, as long along `way` as brings it nearest.
template <std::size_t R> Squares<R + 1> Extend(const Matrix4 &target, const Squares<R> &v, const Vector4 &way) {
    Squares<R + 1> best{};
    double least = std::numeric_limits<double>::max();
    const double length = std::sqrt(Dot4(way, way));
    for (const double share : {1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125}) {
        Squares<R + 1> longer{};
        std::copy(v.begin(), v.end(), longer.begin());
        for (std::size_t i = 0; i < 4; ++i)
            longer[R][i] = way[i] * share / length;
        Normalise(longer);
        Matrix4 z;
        if (const double distance = Distance(target, longer, z); distance < least)
            best = longer, least = distance;
    }
    return best;
}

/// Squares that were nearest to one channel: where to start for the next.
struct Found {
    std::size_t count = 0;
    Squares<3> squares{};
};

/// Adds squares until nothing is nearer; three are always enough where the target is negative somewhere.
template <std::size_t R> Matrix4 NearestFrom(const Matrix4 &target, const Squares<R> &start, Found &found) {
    const NearestSquares<R> nearest(target, start);
    Vector4 way;
    if constexpr (R < 3) {
        if (!nearest.Nearest(way))
            return NearestFrom(target, Extend(target, nearest.Result(), way), found);
    }
    found.count = R;
    std::copy(nearest.Result().begin(), nearest.Result().end(), found.squares.begin());
    return Gram(nearest.Result());
}

/// The square whose linear part is that of c, or as near as its mean allows.
Squares<1> FirstSquare(const ShVector &c) {
    const double length = kShC1 * std::sqrt(c[1] * c[1] + c[2] * c[2] + c[3] * c[3]);
    const double angle = std::asin(std::min(1.0, length / std::numbers::sqrt3)) / 2;
    if (!(length > 0))
        return {Vector4{0, 0, 0, 1}};
    const double scale = std::numbers::sqrt3 * std::sin(angle) * kShC1 / length;
    return {Vector4{scale * c[3], scale * c[1], scale * c[2], std::cos(angle)}};
}

Matrix4 NearestTo(const ShVector &c, Found &found) {
    const Matrix4 target = MatrixOf(c);
    if (found.count == 2)
        return NearestFrom<2>(target, {found.squares[0], found.squares[1]}, found);
    return NearestFrom(target, found.count == 1 ? Squares<1>{found.squares[0]} : FirstSquare(c), found);
}

/// Bands 1 and 2 of the sum of squares.
void SetBands(const Matrix4 &m, double scale, ShVector &c) {
    const double linear = 2 * scale / kShC1, mixed = 2 * scale / kShC2;
    c[1] = linear * m[1][3], c[2] = linear * m[2][3], c[3] = linear * m[0][3];
    c[4] = mixed * m[0][1], c[5] = mixed * m[1][2], c[7] = mixed * m[0][2];
    c[6] = scale * (2 * m[2][2] - m[0][0] - m[1][1]) / (6 * kShC3);
    c[8] = scale * (m[0][0] - m[1][1]) / (2 * kShC4);
}

/// Whether b is a multiple of a, up to rounding of floats, so that what is nearest to it is that multiple too.
bool Proportional(const ShVector &a, const ShVector &b) {
    if (!(a[0] > kLeastMean && b[0] > kLeastMean))
        return false;
    const double ratio = b[0] / a[0];
    for (std::size_t k = 1; k < 9; ++k)
        if (!(std::abs(b[k] - ratio * a[k]) <= kMargin * b[0]))
            return false;
    return true;
}

bool RemoveLobes(ShVector &c, Found &found) {
    if (SurelyPositive(c))
        return false;
    const ShMinimum lobe = MinimumOfSh(c);
    if (lobe.value >= 0)
        return false;
    const double mean = kShC0 * c[0];
    if (!(mean > kLeastMean)) {
        const bool plain = c == ShVector{c[0]};
        c = {c[0]};
        return !plain;
    }
    // A lone lobe: the nearest is along the basis at its direction, if that leaves no other.
    ShVector one = c;
    const ShVector basis = ShBasis(lobe.direction);
    for (std::size_t k = 1; k < 9; ++k)
        one[k] -= lobe.value / (kShBandReach * kShBandReach) * basis[k];
    const double left = MinimumOfSh(one).value;
    if (left >= -kRounding * mean) {
        for (std::size_t k = 1; k < 9; ++k)
            c[k] = one[k] * (1 - kMargin - kRounding);
        return true;
    }
    double length = 0;
    for (std::size_t k = 1; k < 9; ++k)
        length += c[k] * c[k];
    ShVector unit = c;
    for (double &x : unit)
        x *= std::min(1 / mean, kFarthest / std::sqrt(length));
    SetBands(NearestTo(unit, found), mean * (1 - kMargin), c);
    return true;
}

} // namespace

bool RemoveNegativeLobes(ShVector &c) {
    Found found;
    return RemoveLobes(c, found);
}

std::array<bool, 3> RemoveNegativeLobes(std::array<ShVector, 3> &channels) {
    const std::array<ShVector, 3> before = channels;
    std::array<bool, 3> changed{};
    Found found;
    for (std::size_t i = 0; i < 3; ++i) {
        // Nearest values of neighbours are neighbours: projections onto convex sets do not spread.
        std::size_t like = 0;
        while (like < i && !(changed[like] && Proportional(before[like], channels[i])))
            ++like;
        changed[i] = like < i || RemoveLobes(channels[i], found);
        for (std::size_t k = 1; k < 9 && like < i; ++k)
            channels[i][k] = channels[like][k] * (channels[i][0] / channels[like][0]);
    }
    return changed;
}

} // namespace q3
