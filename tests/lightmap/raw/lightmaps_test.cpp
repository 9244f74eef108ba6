// GPL-2.0-or-later. One byte for each luxel.
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

bool HoldsAround(const LuxelMask &mask, int width, int height, int x, int y) {
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u)
            if (mask[std::size_t(v * width + u)] != 0)
                return true;
    return false;
}

TEST(LuxelMaskTest, SpreadsToNeighborsButNotAroundTheEnds) {
    std::mt19937 random(3);
    for (const auto &[width, height] : {std::pair(1, 1), {1, 9}, {9, 1}, {2, 2}, {17, 23}, {64, 5}}) {
        LuxelMask mask(std::size_t(width * height));
        for (std::uint8_t &one : mask)
            one = random() % 8 == 0 ? 1 : 0;
        const LuxelMask spread = Dilate(mask, width, height);
        ASSERT_EQ(spread.size(), mask.size());
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                EXPECT_EQ(spread[std::size_t(y * width + x)] != 0, HoldsAround(mask, width, height, x, y))
                    << x << " " << y << " of " << width << " x " << height;
    }
    EXPECT_TRUE(Dilate({}, 0, 0).empty());
}

} // namespace

} // namespace q3::test
