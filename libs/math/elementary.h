// GPL-2.0-or-later. Elementary functions of floats whose results hardly depend on the C library.
#pragma once

#include <cmath>

namespace q3 {

// The float functions of C libraries differ in the last bit of some results, even between processors. Those of doubles
// do too, but a relative error near 2^-52 hardly ever changes the float that the result is rounded to.

inline float Pow(float base, float exponent) {
    return float(std::pow(double(base), double(exponent)));
}
inline float Exp(float x) {
    return float(std::exp(double(x)));
}
inline float Exp2(float x) {
    return float(std::exp2(double(x)));
}
inline float Log2(float x) {
    return float(std::log2(double(x)));
}
inline float Sin(float x) {
    return float(std::sin(double(x)));
}
inline float Cos(float x) {
    return float(std::cos(double(x)));
}
inline float Acos(float x) {
    return float(std::acos(double(x)));
}
inline float Atan2(float y, float x) {
    return float(std::atan2(double(y), double(x)));
}

} // namespace q3
