// GPL-2.0-or-later. Values of sixteen receivers or rays side by side (structure of arrays), for vector code.
#pragma once

#include "libs/math/vec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

/// 1: functions marked Q3_VECTOR are compiled for several processors (CMake option Q3MAP2_SIMD); 0: once, like all
/// other functions.
#ifndef Q3MAP2_SIMD
#define Q3MAP2_SIMD 1
#endif

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define Q3_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define Q3_SANITIZED 1
#endif
#endif

/// On the definition of a function: compiles it for processors with vectors of 512, 256 and 128 bits; the loader
/// picks. Fused multiply-add is off (-ffp-contract=off), so all give the same bits. No clones in sanitizer builds: the
/// loader picks before the sanitizer is set up. No clones with clang, which resolves them through other symbols: it
/// compiles once, for the processor of the CMake option Q3MAP2_ARCH.
#if Q3MAP2_SIMD && defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) &&            \
    !defined(Q3_SANITIZED)
#define Q3_VECTOR __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#define Q3_VECTOR_CLONES 1
#else
#define Q3_VECTOR
#define Q3_VECTOR_CLONES 0
#endif

/// Before a loop over the lanes: forbids unrolling, which compilers would otherwise do first and then fail to
/// vectorize.
#if defined(__clang__)
#define Q3_ROLLED _Pragma("clang loop unroll(disable)")
#elif defined(__GNUC__)
#define Q3_ROLLED _Pragma("GCC unroll 1")
#else
#define Q3_ROLLED
#endif

/// Before a loop over the lanes whose arrays do not overlap, where g++ cannot see that. clang checks it at run time.
#if defined(__GNUC__) && !defined(__clang__)
#define Q3_INDEPENDENT _Pragma("GCC ivdep")
#else
#define Q3_INDEPENDENT
#endif

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
