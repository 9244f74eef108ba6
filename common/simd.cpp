// GPL-2.0-or-later. The instruction set that vector code uses.
#include "common/simd.h"

#include <algorithm>
#include <cstdlib>

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

Isa ChosenIsa() {
    const char *limit = std::getenv("Q3MAP2_SIMD");
    return std::min(WidestOfProcessor(), IsaOfName(limit != nullptr ? limit : "").value_or(Isa::Avx512));
}

} // namespace

const Isa kVectorIsa = ChosenIsa();

std::optional<Isa> IsaOfName(std::string_view name) {
    if (name == "sse2")
        return Isa::Sse2;
    if (name == "avx2")
        return Isa::Avx2;
    if (name == "avx512")
        return Isa::Avx512;
    return std::nullopt;
}

} // namespace q3
