// GPL-2.0-or-later. Vector code for several kinds of processors from one source.
#pragma once

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
