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

#if defined(__AVX512F__)
constexpr std::string_view kBaseIsa = "AVX-512 (x86-64-v4)";
#elif defined(__AVX2__)
constexpr std::string_view kBaseIsa = "AVX2 (x86-64-v3)";
#elif defined(__x86_64__)
constexpr std::string_view kBaseIsa = "SSE2 (x86-64)";
#elif defined(__aarch64__)
constexpr std::string_view kBaseIsa = "NEON (ARM64)";
#else
constexpr std::string_view kBaseIsa = "base processor of the architecture";
#endif

/// The instruction set of the vector code that runs here.
std::string_view SimdLevel() {
    if (kVectorIsa == Isa::Avx512)
        return "AVX-512 (x86-64-v4)";
    if (kVectorIsa == Isa::Avx2)
        return "AVX2 (x86-64-v3)";
    return kBaseIsa;
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
