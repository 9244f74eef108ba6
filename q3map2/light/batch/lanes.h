// GPL-2.0-or-later. Sixteen of everything: neighbouring receivers and their rays, laid out for vector code.
#pragma once

#include "libs/math/vec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

/// Compiles a function several times, for processors with and without wide vectors; the loader picks. Contraction is
/// off, so all give the same bits. Sanitizers come into being after the loader's choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) &&               \
    !defined(__SANITIZE_THREAD__)
#define Q3_VECTOR __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define Q3_VECTOR
#endif

namespace q3 {

/// Rays that are traced together, and receivers that are lit together.
inline constexpr std::size_t kPacketSize = 16;

/// One number of each place.
struct alignas(64) Lanes : std::array<float, kPacketSize> {};

/// One number of each place, where digits count.
struct alignas(64) DoubleLanes : std::array<double, kPacketSize> {};

/// One vector of each place.
struct Lanes3 {
    Lanes x, y, z;
    Vec3f operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
    void Set(std::size_t i, const Vec3f &v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
    void Fill(const Vec3f &v) { x.fill(v.x), y.fill(v.y), z.fill(v.z); }
};

/// Bits of all receivers, see LaneMask::Bits.
inline constexpr unsigned kAllLanes = (1u << kPacketSize) - 1;

/// Which receivers count: -1 those that do, 0 the others, as Embree wants it. Questions about all of them take four at
/// a time, which compilers do not find on their own outside of Q3_VECTOR.
struct alignas(64) LaneMask : std::array<std::int32_t, kPacketSize> {
    void Set(std::size_t i, bool on) { (*this)[i] = on ? -1 : 0; }
    bool Any() const {
        const Four any = At(0) | At(4) | At(8) | At(12);
        return (any[0] | any[1] | any[2] | any[3]) != 0;
    }
    /// Bit i: whether place i counts.
    unsigned Bits() const {
        constexpr Four kBits = {1, 2, 4, 8};
        const Four bits = (At(0) & kBits) | (At(4) & (kBits << 4)) | (At(8) & (kBits << 8)) | (At(12) & (kBits << 12));
        return unsigned(bits[0] | bits[1] | bits[2] | bits[3]);
    }
    /// Receivers without their bit count no longer.
    void Keep(unsigned bits) {
        constexpr Four kBits = {1, 2, 4, 8};
        const auto four = std::int32_t(bits);
        const Four all = {four, four, four, four};
        for (std::size_t i = 0; i < kPacketSize; i += 4) {
            const Four bit = kBits << int(i), kept = At(i) & ((all & bit) == bit);
            std::memcpy(data() + i, &kept, sizeof kept);
        }
    }
    int Count() const {
        const Four count = At(0) + At(4) + At(8) + At(12);
        return -(count[0] + count[1] + count[2] + count[3]);
    }

  private:
    using Four = std::int32_t __attribute__((vector_size(16)));
    Four At(std::size_t i) const {
        Four four;
        std::memcpy(&four, data() + i, sizeof four);
        return four;
    }
};

/// Clusters of up to 16 receivers: neighbours are in few.
struct LaneClusters {
    std::size_t count = 0;
    std::array<int, kPacketSize> number{};     ///< each once
    std::array<unsigned, kPacketSize> lanes{}; ///< bits of the receivers in it

    void Add(std::size_t lane, int cluster) {
        std::size_t i = 0;
        while (i < count && number[i] != cluster)
            ++i;
        if (i == count)
            number[count++] = cluster;
        lanes[i] |= 1u << lane;
    }
};

/// Floats that are not negative are in the order of their bits, and compilers make vector code of the greatest integer
/// but not of the greatest float. Back: std::bit_cast<float>.
inline std::int32_t OrderedBits(float x) {
    return std::bit_cast<std::int32_t>(x);
}

/// Negative if the sign of x is set. Loops that collect such bits, `| Sign(most - x)`, become vector code where those
/// that collect comparisons do not.
inline std::int32_t Sign(float x) {
    return OrderedBits(x);
}

} // namespace q3
