// GPL-2.0-or-later. Elementary functions without branches or calls other than square roots, so that compilers vectorize
// loops that use them.
#pragma once

#include <cmath>
#include <numbers>

namespace q3 {

struct SineCosine {
    double sine, cosine;
};

/// Sine and cosine of an angle from -pi to pi, error 1e-15: Taylor series of half the angle.
inline SineCosine SineCosineOf(double angle) {
    const double half = angle * 0.5, square = half * half;
    double sine = 1, cosine = 1;
    for (int n = 20; n >= 2; n -= 2) { // Horner's scheme; the terms left out are below 2e-17
        sine = 1 - sine * square * (1.0 / ((n + 1) * n));
        cosine = 1 - cosine * square * (1.0 / (n * (n - 1)));
    }
    sine *= half;
    return {2 * sine * cosine, cosine * cosine - sine * sine};
}

/// atan2(y, x) for y >= 0, from 0 to pi, relative error 2e-15; 0 where both are 0. The angle is halved three
/// times, until the series of the arc tangent converges fast.
inline double AngleOf(double y, double x) {
    // tan(a / 2) = y / (r + x) and = t / (1 + sqrt(1 + t^2)) with t = tan(a).
    const double sum = std::sqrt(x * x + y * y) + std::abs(x);
    double t = y / (sum > 0 ? sum : 1);
    t = t / (1 + std::sqrt(1 + t * t));
    t = t / (1 + std::sqrt(1 + t * t));
    const double square = t * t; // at most tan(pi / 16)^2, 0.04
    double series = 1.0 / 23;
    for (int n = 21; n >= 1; n -= 2)
        series = 1.0 / n - series * square;
    const double angle = 8 * t * series;
    return x < 0 ? std::numbers::pi - angle : angle;
}

/// The same in float, error 3e-7. Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49.
inline float AngleOf(float y, float x) {
    constexpr float kPi = std::numbers::pi_v<float>;
    const float across = std::abs(x), big = across > y ? across : y, small = across > y ? y : across;
    const float t = small / (big > 0 ? big : 1), t2 = t * t;
    const float series =
        -0.3333314528f +
        t2 * (0.1999355085f +
              t2 * (-0.1420889944f +
                    t2 * (0.1065626393f +
                          t2 * (-0.0752896400f + t2 * (0.0429096138f + t2 * (-0.0161657367f + t2 * 0.0028662257f))))));
    const float angle = t + t * t2 * series;
    const float acute = y > across ? 0.5f * kPi - angle : angle;
    return x < 0 ? kPi - acute : acute;
}

} // namespace q3
