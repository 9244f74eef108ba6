// GPL-2.0-or-later. Vector code on the stack. g++ 12 aligns the temporary of a struct that a function returns to the 16
// bytes of the base processor, even if its type asks for 64.
#include "common/simd.h"

#include <gtest/gtest.h>

#include <array>

namespace q3 {

namespace {

#if defined(__GNUC__)
#define NOT_INLINED __attribute__((noinline))
#else
#define NOT_INLINED
#endif

struct alignas(64) SixteenFloats : std::array<float, 16> {};

NOT_INLINED SixteenFloats CopyOf(const SixteenFloats &floats) {
    SixteenFloats copy;
    Vectorize([&]() Q3_INLINE { copy = floats; });
    return copy;
}

/// The copy goes to a temporary first, since CopyOf reads what is assigned to. Its place on the stack depends on kSize.
template <std::size_t kSize> NOT_INLINED void AssignCopy(SixteenFloats &floats) {
    std::array<volatile char, kSize> other;
    other.front() = 0;
    floats = CopyOf(floats);
    other.back() = 0;
}

TEST(SimdTest, TemporariesNeedNoAlignment) {
    SixteenFloats floats;
    floats.fill(1);
    AssignCopy<16>(floats);
    AssignCopy<32>(floats);
    AssignCopy<48>(floats);
    AssignCopy<64>(floats);
    for (const float each : floats)
        EXPECT_EQ(each, 1);
}

} // namespace

} // namespace q3
