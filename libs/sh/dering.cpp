// GPL-2.0-or-later. Deringing of L2 spherical harmonics. Derivation: docs/sh_math.md.
#include "libs/sh/dering.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

template <std::size_t N> using Vector = std::array<double, N>;
template <std::size_t N> using Matrix = std::array<Vector<N>, N>;
using Matrix4 = Matrix<4>;

/// An SH sum is (n, 1) G (n, 1)^T at the unit direction n, with the symmetric Gram matrix G linear in the coefficients.
/// Coefficient k adds `value` times itself to entry (row, column). k = 0 stands for a multiple of 1 - |n|^2 = 0.
struct GramTerm {
    std::size_t k, row, column;
    double value;
};
constexpr GramTerm kGramTerms[] = {
    {0, 0, 0, -1},        {0, 1, 1, -1},        {0, 2, 2, -1},        {0, 3, 3, 1},         {1, 1, 3, kShC1 / 2},
    {1, 3, 1, kShC1 / 2}, {2, 2, 3, kShC1 / 2}, {2, 3, 2, kShC1 / 2}, {3, 0, 3, kShC1 / 2}, {3, 3, 0, kShC1 / 2},
    {4, 0, 1, kShC2 / 2}, {4, 1, 0, kShC2 / 2}, {5, 1, 2, kShC2 / 2}, {5, 2, 1, kShC2 / 2}, {6, 0, 0, -kShC3},
    {6, 1, 1, -kShC3},    {6, 2, 2, 2 * kShC3}, {7, 0, 2, kShC2 / 2}, {7, 2, 0, kShC2 / 2}, {8, 0, 0, kShC4},
    {8, 1, 1, -kShC4},
};

Matrix4 GramOf(const Vector<9> &c) {
    Matrix4 gram{};
    for (const GramTerm &term : kGramTerms)
        gram[term.row][term.column] += term.value * c[term.k];
    return gram;
}

/// The sum as mean + 2 Dot(linear, n) + n . quadratic n, with trace 0.
struct ShPolynomial {
    double mean;
    Vec3d linear;
    Matrix<3> quadratic;

    explicit ShPolynomial(ShVector c) : mean(kShC0 * c[0]) {
        c[0] = 0;
        const Matrix4 gram = GramOf(c);
        for (std::size_t i = 0; i < 3; ++i) {
            linear[i] = gram[i][3];
            std::copy_n(gram[i].begin(), 3, quadratic[i].begin());
        }
    }
    /// Quick sufficient condition. Eigenvalues of a traceless matrix are at most sqrt(2/3) of its Frobenius norm.
    bool IsSurelyPositive() const {
        double norm2 = 0;
        for (const Vector<3> &row : quadratic)
            for (const double x : row)
                norm2 += x * x;
        return mean > (2 * Length(linear) + std::sqrt(norm2 * 2 / 3)) * (1 + 1e-9);
    }
};

struct Eigensystem {
    Vec3d value;
    std::array<Vec3d, 3> axis; ///< unit eigenvectors
};

/// Jacobi's method.
Eigensystem EigensystemOf(Matrix<3> m) {
    std::array<Vec3d, 3> axis = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    constexpr int kSweeps = 12; // it converges quadratically, in about five
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
    for (int step = 0; step < 30; ++step) {
        double square = 0, slope = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            n[i] = h[i] == 0 ? 0 : -h[i] / (gap[i] + t);
            square += n[i] * n[i];
            slope += h[i] == 0 ? 0 : n[i] * n[i] / (gap[i] + t);
        }
        const double next = square > 1 + 1e-14 ? t + (std::sqrt(square) - 1) * square / slope : t;
        if (!(next > t))
            break;
        t = next;
    }
    // The hard case: h is orthogonal to the axis of the least eigenvalue, and n takes what it lacks along that axis.
    for (std::size_t i = 0; t == 0 && i < 3; ++i)
        if (gap[i] == 0) {
            n[i] += std::sqrt(std::max(0.0, 1 - Dot(n, n)));
            break;
        }
    return Normalize(n);
}

/// Cholesky factor of a symmetric matrix; false if that is not positive definite.
template <std::size_t N> bool Factor(const Matrix<N> &m, Matrix<N> &lower) {
    for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = m[i][j];
            for (std::size_t k = 0; k < j; ++k)
                sum -= lower[i][k] * lower[j][k];
            if (i == j && !(sum > 0))
                return false;
            lower[i][j] = i == j ? std::sqrt(sum) : sum / lower[j][j];
        }
    return true;
}
/// Solves lower lower^T x = b.
template <std::size_t N> Vector<N> Solve(const Matrix<N> &lower, Vector<N> x) {
    for (std::size_t i = 0; i < N; ++i) {
        for (std::size_t k = 0; k < i; ++k)
            x[i] -= lower[i][k] * x[k];
        x[i] /= lower[i][i];
    }
    for (std::size_t i = N; i-- > 0;) {
        for (std::size_t k = i + 1; k < N; ++k)
            x[i] -= lower[k][i] * x[k];
        x[i] /= lower[i][i];
    }
    return x;
}

Matrix4 Product(const Matrix4 &a, const Matrix4 &b) {
    Matrix4 product{};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t j = 0; j < 4; ++j)
                product[i][j] += a[i][k] * b[k][j];
    return product;
}
double TraceOfProduct(const Matrix4 &a, const Matrix4 &b) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            sum += a[i][j] * b[j][i];
    return sum;
}
Matrix4 Sum(Matrix4 a, double scale, const Matrix4 &b) {
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            a[i][j] += scale * b[i][j];
    return a;
}

/// The nearest nonnegative SH sum of mean 1 as a semidefinite program: minimize |c - target|^2 / 2 over bands 1 and 2,
/// with the Gram matrix positive semidefinite for some multiple c[0] of 1 - |n|^2. Solved by a primal-dual interior
/// point method; the Gram matrix stays positive definite, so every iterate is a positive sum.
class NearestPositive {
  public:
    explicit NearestPositive(const ShVector &target) : target_(target) {
        c_[0] = -0.5; // together with the mean: half the identity
        gram_ = GramOf(c_);
        gram_[3][3] += 1;
        for (std::size_t i = 0; i < 4; ++i) {
            dual_[i][i] = 1;
            for (const double x : target)
                dual_[i][i] += std::abs(x);
        }
    }

    const Vector<9> &Run() {
        constexpr int kMaxSteps = 60; // about 15 are needed
        for (int step = 0; step < kMaxSteps && TraceOfProduct(gram_, dual_) > kGap; ++step)
            Step();
        return c_;
    }

  private:
    /// Bound of the squared distance that is left to gain, so sqrt(kGap) bounds the error of the result.
    static constexpr double kGap = 1e-8;

    /// A Newton step towards gram * dual = mu * identity, with mu a tenth of the present mean of the eigenvalues.
    void Step() {
        const double mu = 0.1 * TraceOfProduct(gram_, dual_) / 4;
        Matrix4 lower4{}, inverse;
        Factor(gram_, lower4);
        for (std::size_t i = 0; i < 4; ++i) {
            Vector<4> unit{};
            unit[i] = 1;
            inverse[i] = Solve(lower4, unit);
        }
        Matrix<9> hessian{}, lower{};
        Vector<9> gradient{};
        for (std::size_t k = 1; k < 9; ++k)
            hessian[k][k] = 1, gradient[k] = target_[k] - c_[k];
        for (const GramTerm &a : kGramTerms) {
            gradient[a.k] += mu * a.value * inverse[a.row][a.column];
            for (const GramTerm &b : kGramTerms) {
                if (b.k > a.k) // symmetric
                    break;
                hessian[a.k][b.k] += a.value * b.value * inverse[a.row][b.row] * dual_[b.column][a.column];
            }
        }
        Factor(hessian, lower);
        Advance(Solve(lower, gradient), inverse, mu);
    }

    /// Goes along the step as far as both matrices stay positive definite.
    void Advance(const Vector<9> &change, const Matrix4 &inverse, double mu) {
        const Matrix4 gramChange = GramOf(change), product = Product(Product(inverse, gramChange), dual_);
        Matrix4 dualChange; // mu inverse(gram) - dual - (inverse(gram) gramChange dual), symmetrized
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < 4; ++j)
                dualChange[i][j] = mu * inverse[i][j] - dual_[i][j] - (product[i][j] + product[j][i]) / 2;
        double length = 1;
        Matrix4 lower{};
        while (length > 1e-9 &&
               !(Factor(Sum(gram_, length, gramChange), lower) && Factor(Sum(dual_, length, dualChange), lower)))
            length *= 0.8;
        length *= length < 1 ? 0.9 : 1;
        for (std::size_t k = 0; k < 9; ++k)
            c_[k] += length * change[k];
        gram_ = Sum(gram_, length, gramChange), dual_ = Sum(dual_, length, dualChange);
    }

    const ShVector &target_;
    Vector<9> c_{};
    Matrix4 gram_{}, dual_{};
};

} // namespace

ShMinimum MinimumOfSh(const ShVector &c) {
    const ShPolynomial p(c);
    const Eigensystem eigen = EigensystemOf(p.quadratic);
    const double least = std::min({eigen.value.x, eigen.value.y, eigen.value.z});
    Vec3d h, direction;
    for (std::size_t i = 0; i < 3; ++i)
        h[i] = Dot(eigen.axis[i], p.linear);
    const Vec3d n = MinimizeOnSphere(eigen.value - Vec3d{least, least, least}, h);
    for (std::size_t i = 0; i < 3; ++i)
        direction += eigen.axis[i] * n[i];
    direction = Normalize(direction);
    const ShVector basis = ShBasis(direction);
    double value = 0;
    for (std::size_t k = 0; k < 9; ++k)
        value += c[k] * basis[k];
    return {direction, value};
}

bool RemoveNegativeLobes(ShVector &c) {
    constexpr double kMinMean = 1e-30;   // smaller floats may have too few digits to stay above zero
    constexpr double kMaxDistance = 1e4; // in means; from farther away only the direction of the bands counts
    constexpr double kMargin = 1e-6;     // rounding to float changes the sum by less than 5e-7 of its mean
    if (ShPolynomial(c).IsSurelyPositive() || MinimumOfSh(c).value >= 0)
        return false;
    const double mean = kShC0 * c[0];
    if (!(mean > kMinMean)) {
        const ShVector before = c;
        c = {c[0]};
        return c != before;
    }
    double length = 0;
    for (std::size_t k = 1; k < 9; ++k)
        length = std::hypot(length, c[k]);
    ShVector target{};
    for (std::size_t k = 1; k < 9; ++k)
        target[k] = c[k] * std::min(1 / mean, kMaxDistance / length);
    NearestPositive program(target);
    const Vector<9> &nearest = program.Run();
    for (std::size_t k = 1; k < 9; ++k)
        c[k] = nearest[k] * mean * (1 - kMargin);
    return true;
}

} // namespace q3
