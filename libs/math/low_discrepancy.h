// GPL-2.0-or-later. Hashes and low-discrepancy points as functions of an index.
#pragma once

#include <cstdint>

namespace q3 {

/// A hash of 64 bits: the output function of SplitMix64 (Steele, Lea and Flood, 2014).
constexpr std::uint64_t HashIndex(std::uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

/// 0 <= value < 1 from the upper bits of a hash.
constexpr double UnitFromHash(std::uint64_t hash) {
    return double(hash >> 11) * 0x1p-53;
}

struct Sample2 {
    double u, v;
};

/// Steps of the R2 sequence, the additive recurrence with the plastic number (Roberts, 2018).
inline constexpr double kPlasticA1 = 0.7548776662466927, kPlasticA2 = 0.5698402909980532;

/// Point `i` of the R2 sequence in [0, 1)^2, with a toroidal shift by a hash of `seed`.
constexpr Sample2 PlasticSample(std::uint32_t i, std::uint64_t seed) {
    const std::uint64_t hash = HashIndex(seed);
    const double u = UnitFromHash(hash) + kPlasticA1 * double(i),
                 v = UnitFromHash(HashIndex(hash)) + kPlasticA2 * double(i);
    return {u - double(std::int64_t(u)), v - double(std::int64_t(v))};
}

struct Sample3 {
    double u, v, w;
};

/// Point `i` of the R3 sequence in [0, 1)^3, likewise: steps are powers of the root of x^4 = x + 1.
constexpr Sample3 PlasticSample3(std::uint32_t i, std::uint64_t seed) {
    constexpr double kSteps[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    std::uint64_t hash = seed;
    double at[3] = {};
    for (int axis = 0; axis < 3; ++axis) {
        hash = HashIndex(hash);
        const double value = UnitFromHash(hash) + kSteps[axis] * double(i);
        at[axis] = value - double(std::int64_t(value));
    }
    return {at[0], at[1], at[2]};
}

} // namespace q3
