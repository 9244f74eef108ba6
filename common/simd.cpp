// GPL-2.0-or-later. The instruction set that vector code uses.
#include "common/simd.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace q3 {

namespace {

Isa WidestOfProcessor() {
#if Q3_SIMD_VERSIONS
    __builtin_cpu_init();
    const bool isV3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                      __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    if (isV3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512cd"))
        return Isa::Avx512;
    if (isV3)
        return Isa::Avx2;
#endif
    return Isa::Sse2;
}

/// Other names set no limit.
Isa LimitOfEnvironment() {
    const char *text = std::getenv("Q3MAP2_SIMD");
    const std::string_view name = text != nullptr ? text : "";
    return name == "sse2" ? Isa::Sse2 : name == "avx2" ? Isa::Avx2 : Isa::Avx512;
}

} // namespace

const Isa kVectorIsa = std::min(WidestOfProcessor(), LimitOfEnvironment());

} // namespace q3
