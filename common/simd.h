// GPL-2.0-or-later. Vector code for several kinds of x86-64 processors from one source.
#pragma once

/// 1: code within Vectorize is compiled for several kinds of processors (CMake option Q3MAP2_SIMD); 0: once, like all
/// other code.
#ifndef Q3MAP2_SIMD
#define Q3MAP2_SIMD 1
#endif

#if defined(__GNUC__)
#define Q3_INLINE __attribute__((always_inline))
#else
#define Q3_INLINE
#endif

/// 1: Vectorize chooses among three versions of its code. A compiler that targets more than the base processor compiles
/// one version, for that target.
#if Q3MAP2_SIMD && defined(__x86_64__) && defined(__GNUC__) && !defined(__SSE3__)
#define Q3_SIMD_VERSIONS 1
#else
#define Q3_SIMD_VERSIONS 0
#endif

namespace q3 {

/// Instruction sets of x86-64 processors: SSE2, x86-64-v3 (AVX2) and x86-64-v4 (AVX-512).
enum class Isa { Sse2, Avx2, Avx512 };

/// The instruction set that Vectorize uses: the widest that this processor has, up to the one that Q3MAP2_SIMD in the
/// environment names: sse2, avx2 or avx512; other text sets no limit. Set when the program starts.
extern const Isa kVectorIsa;

#if Q3_SIMD_VERSIONS
template <class Code> __attribute__((target("arch=x86-64-v3"))) auto VectorizeForAvx2(Code code) {
    return code();
}
template <class Code> __attribute__((target("arch=x86-64-v4"))) auto VectorizeForAvx512(Code code) {
    return code();
}
#endif

/// Runs code, a lambda marked Q3_INLINE, as compiled for the widest vectors of this processor: 512, 256 or 128 bits.
/// Fused multiply-add is off (-ffp-contract=off), so all versions give the same bits. What the code calls is compiled
/// for the base processor unless it is inlined. Numbers of the function around it are captured by value: if they were
/// references, the arrays that a loop writes might alias them.
///
///     Vectorize([&, weight]() Q3_INLINE {
///         for (const std::size_t i : kEachLane)
///             sum[i] += weight * value[i];
///     });
template <class Code> Q3_INLINE inline auto Vectorize(const Code &code) {
#if Q3_SIMD_VERSIONS
    if (kVectorIsa == Isa::Avx512)
        return VectorizeForAvx512(code);
    if (kVectorIsa == Isa::Avx2)
        return VectorizeForAvx2(code);
#endif
    return code();
}

} // namespace q3

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
