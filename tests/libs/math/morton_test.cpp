// GPL-2.0-or-later. Morton codes.
#include "libs/math/morton.h"

#include <gtest/gtest.h>

#include <random>

namespace q3 {
namespace {

TEST(MortonCode, InterleavesTheLowest21BitsOfCoordinates) {
    std::mt19937 random(1);
    for (int i = 0; i < 1000; ++i) {
        const std::uint32_t coordinates[3] = {std::uint32_t(random()), std::uint32_t(random()),
                                              std::uint32_t(random())};
        std::uint64_t expected = 0;
        for (unsigned bit = 0; bit < 21; ++bit)
            for (unsigned axis = 0; axis < 3; ++axis)
                expected |= std::uint64_t(coordinates[axis] >> bit & 1) << (3 * bit + axis);
        EXPECT_EQ(MortonCode(coordinates[0], coordinates[1], coordinates[2]), expected);
    }
}

} // namespace
} // namespace q3
