// GPL-2.0-or-later. Values of sixteen receivers or rays side by side (structure of arrays), for vector code.
#pragma once

#include "common/simd.h"
#include "libs/math/vec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace q3 {

/// Rays that are traced together, and receivers that are lit together: one each per lane.
inline constexpr std::size_t kPacketSize = 16;

/// Lane indices, for loops: `for (const std::size_t i : kEachLane)`.
struct LaneIndices {
    struct Iterator {
        std::size_t i;
        constexpr std::size_t operator*() const { return i; }
        constexpr Iterator &operator++() {
            ++i;
            return *this;
        }
        constexpr bool operator!=(const Iterator &o) const { return i != o.i; }
    };
    constexpr Iterator begin() const { return {0}; }
    constexpr Iterator end() const { return {kPacketSize}; }
};
inline constexpr LaneIndices kEachLane;

/// A float per lane.
struct alignas(64) Lanes : std::array<float, kPacketSize> {};

/// A double per lane, for sums that would lose digits as floats.
struct alignas(64) DoubleLanes : std::array<double, kPacketSize> {};

/// An integer per lane.
struct alignas(64) IntLanes : std::array<std::int32_t, kPacketSize> {};

/// A vector per lane.
struct Lanes3 {
    Lanes x, y, z;
    Vec3f operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
    void Set(std::size_t i, const Vec3f &v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
    void Fill(const Vec3f &v) { x.fill(v.x), y.fill(v.y), z.fill(v.z); }
};

/// A vector's direction and length. The zero vector has direction zero.
struct DirectionAndLength {
    float x, y, z, length;
};
inline DirectionAndLength DirectionOf(float x, float y, float z) {
    const float length = std::sqrt(x * x + y * y + z * z), scale = 1 / (length > 0 ? length : 1);
    return {x * scale, y * scale, z * scale, length};
}

/// LaneMask::Bits of a mask with all lanes set.
inline constexpr unsigned kAllLanes = (1u << kPacketSize) - 1;

/// A boolean per lane: -1 true, 0 false, as in Embree's `valid` argument.
struct alignas(64) LaneMask : std::array<std::int32_t, kPacketSize> {
    void Set(std::size_t i, bool on) { (*this)[i] = on ? -1 : 0; }
    bool Any() const {
        std::int32_t any = 0;
        for (const std::size_t i : kEachLane)
            any |= (*this)[i];
        return any != 0;
    }
    /// Bit i is set if lane i is.
    unsigned Bits() const {
        unsigned bits = 0;
        for (const std::size_t i : kEachLane)
            bits |= unsigned((*this)[i]) & (1u << i);
        return bits;
    }
    /// Clears the lanes whose bit is not set.
    void Keep(unsigned bits) {
        for (const std::size_t i : kEachLane)
            (*this)[i] &= (bits >> i & 1) != 0 ? -1 : 0;
    }
    /// Number of lanes that are set.
    int Count() const {
        std::int32_t count = 0;
        for (const std::size_t i : kEachLane)
            count -= (*this)[i];
        return count;
    }
};

/// The bits of x as an integer: negative if the sign bit of x is set. Compilers vectorize loops that OR such integers,
/// but not loops that OR comparisons.
inline std::int32_t SignBits(float x) {
    return std::bit_cast<std::int32_t>(x);
}

} // namespace q3
