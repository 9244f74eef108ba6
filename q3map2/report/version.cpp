// GPL-2.0-or-later. Version and build of the program.
#include "q3map2/report/version.h"

#include "common/simd.h"
#include "q3map2/report/commit.h"

#if Q3_EMBREE_MAJOR == 3
#include <embree3/rtcore_config.h>
#else
#include <embree4/rtcore_config.h>
#endif

#include <fmt/format.h>

namespace q3 {

namespace {

/// The widest SIMD instructions that both the program and this machine have.
std::string_view SimdLevel() {
#if Q3_VECTOR_CLONES
    // The choice that the loader makes among the clones of common/simd.h.
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512dq"))
        return "AVX-512 (x86-64-v4)";
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        return "AVX2 (x86-64-v3)";
    return "SSE2 (x86-64)";
#else
#if defined(__AVX512F__)
    return "AVX-512 (x86-64-v4)";
#elif defined(__AVX2__)
    return "AVX2 (x86-64-v3)";
#elif defined(__x86_64__)
    return "SSE2 (x86-64)";
#else
    return "base processor of the architecture";
#endif
#endif
}

} // namespace

std::string VersionText() {
    return fmt::format("{}\ncommit   {}\ncompiler {}\nEmbree   {}\nSIMD     {}\n", kVersion, kCommit,
#if defined(__clang__)
                       fmt::format("Clang {}", __clang_version__),
#elif defined(__GNUC__)
                       fmt::format("GCC {}", __VERSION__),
#else
                       "unknown",
#endif
                       RTC_VERSION_STRING, SimdLevel());
}

} // namespace q3
