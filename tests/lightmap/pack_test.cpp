// GPL-2.0-or-later. Receivers on pages, against a page kept as a plain array.
#include "q3map2/lightmap/store/lightmap_pack.h"

#include <random>

#include <gtest/gtest.h>

namespace q3 {
namespace {

/// The same questions, one texel at a time.
struct PlainPage {
    int width, height;
    std::vector<bool> taken = std::vector<bool>(std::size_t(width) * std::size_t(height));

    bool Fits(const StoredSlot &slot, int x, int y) const {
        if (x < 0 || y < 0 || x + slot.width > width || y + slot.height > height)
            return false;
        for (int row = 0; row < slot.height; ++row)
            for (int column = 0; column < slot.width; ++column)
                if (slot.Used(std::size_t(row) * std::size_t(slot.width) + std::size_t(column)) &&
                    taken[std::size_t(y + row) * std::size_t(width) + std::size_t(x + column)])
                    return false;
        return true;
    }
    std::optional<std::array<int, 2>> Find(const StoredSlot &slot, int stepX, int stepY) const {
        for (int y = 0; y < height; y += stepY)
            for (int x = 0; x < width; x += stepX)
                if (Fits(slot, x, y))
                    return std::array{x, y};
        return std::nullopt;
    }
    template <typename Body> void ForUsed(const StoredSlot &slot, int x, int y, const Body &body) const {
        for (int row = 0; row < slot.height; ++row)
            for (int column = 0; column < slot.width; ++column)
                if (slot.Used(std::size_t(row) * std::size_t(slot.width) + std::size_t(column)))
                    body(std::size_t(y + row) * std::size_t(width) + std::size_t(x + column));
    }
};

StoredSlot RandomSlot(std::mt19937 &random, int most, int unusedPercent) {
    StoredSlot slot;
    slot.width = 1 + int(random() % unsigned(most)), slot.height = 1 + int(random() % unsigned(most));
    slot.texels.resize(std::size_t(slot.width) * std::size_t(slot.height));
    for (Vec3f &texel : slot.texels)
        if (int(random() % 100) < unusedPercent)
            texel = {-1, -1, -1};
    return slot;
}

void ExpectSamePlaces(int width, int height, int most, int unusedPercent) {
    std::mt19937 random(unsigned(width * 7 + most));
    PageSpace space(width, height);
    PlainPage plain{width, height};
    int placed = 0, refused = 0;
    for (int i = 0; i < 60; ++i) {
        const StoredSlot slot = RandomSlot(random, most, unusedPercent);
        const Stamp stamp = MakeStamp(slot);
        const int stepX = 1 + int(random() % 3), stepY = 1 + int(random() % 3);
        const auto at = space.Find(stamp, stepX, stepY);
        ASSERT_EQ(at, plain.Find(slot, stepX, stepY)) << i;
        const int x = int(random() % unsigned(width)) - 2, y = int(random() % unsigned(height)) - 2;
        ASSERT_EQ(space.Fits(stamp, x, y), plain.Fits(slot, x, y)) << i;
        if (!at) {
            ++refused;
            continue;
        }
        const int before = space.Free();
        space.Take(stamp, (*at)[0], (*at)[1]);
        int used = 0;
        plain.ForUsed(slot, (*at)[0], (*at)[1], [&](std::size_t texel) { plain.taken[texel] = true, ++used; });
        ASSERT_EQ(before - space.Free(), used);
        ++placed;
    }
    EXPECT_GT(placed, 5);
    EXPECT_GT(refused, 5) << "the page must have filled up";
}

TEST(Pack, FindsTheFirstFreePlaceOnNarrowPages) {
    ExpectSamePlaces(32, 32, 20, 0);
}

TEST(Pack, FindsTheFirstFreePlaceWithHoles) {
    ExpectSamePlaces(64, 64, 40, 30);
}

TEST(Pack, FindsTheFirstFreePlaceAcrossWords) {
    ExpectSamePlaces(128, 128, 90, 2);
}

TEST(Pack, FindsTheFirstFreePlaceForRunsOfManyWords) {
    ExpectSamePlaces(512, 64, 60, 0);
    ExpectSamePlaces(320, 160, 160, 0);
}

StoredSlot Rectangle(int lightmap, int width, int height, std::size_t style = 0) {
    StoredSlot slot;
    slot.lightmap = lightmap, slot.style = style;
    slot.width = width, slot.height = height;
    slot.texels.resize(std::size_t(width) * std::size_t(height));
    return slot;
}

std::size_t PackAll(std::vector<StoredSlot> &slots, const LightmapOptions &options) {
    StoredSlots stored;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < slots.size(); ++i) {
        stored.slotOf.resize(std::max(stored.slotOf.size(), std::size_t(slots[i].lightmap) + 1), {-1, -1, -1, -1});
        stored.slotOf[std::size_t(slots[i].lightmap)][slots[i].style] = int(i);
        order.push_back(i);
    }
    stored.slots = slots;
    const std::size_t pages = PackSlots(order, options, stored).size();
    slots = stored.slots;
    return pages;
}

TEST(Pack, LightmapsThatAreNotSquareInterlock) {
    std::vector<StoredSlot> slots{Rectangle(0, 128, 128), Rectangle(1, 128, 128)};
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x)
            slots[x > y ? 0 : 1].texels[std::size_t(y * 128 + x)] = {-1, -1, -1};
    EXPECT_EQ(PackAll(slots, {}), 1u) << "two triangles share one page";
}

TEST(Pack, SearchBlocksAndFastAllocation) {
    // 120 x 120 leaves 12 % of a page free: room for the small one of an earlier page.
    std::vector<StoredSlot> slots{Rectangle(0, 120, 120), Rectangle(1, 120, 120), Rectangle(2, 8, 8)};
    LightmapOptions options;
    EXPECT_EQ(PackAll(slots, options), 2u);
    EXPECT_EQ(slots[2].page, 0);
    options.searchBlock = 1;
    PackAll(slots, options);
    EXPECT_EQ(slots[2].page, 1) << "only the last page is looked at";
    // 124 x 124 leaves 6 %: too full for a look unless it is exhaustive.
    slots = {Rectangle(0, 124, 124), Rectangle(1, 4, 4)};
    options = {};
    EXPECT_EQ(PackAll(slots, options), 2u);
    options.fastAllocate = false;
    EXPECT_EQ(PackAll(slots, options), 1u);
}

TEST(Pack, LaterStylesLieWhereTheFirstIs) {
    std::vector<StoredSlot> slots{Rectangle(0, 128, 40), Rectangle(1, 50, 60), Rectangle(1, 50, 60, 1),
                                  Rectangle(1, 50, 60, 2)};
    EXPECT_EQ(PackAll(slots, {}), 2u);
    EXPECT_EQ(slots[1].y, 40);
    EXPECT_EQ((std::array{slots[2].page, slots[2].x, slots[2].y}), (std::array{0, 64, 40})) << "half a page beside";
    EXPECT_EQ((std::array{slots[3].page, slots[3].x, slots[3].y}), (std::array{1, 0, 40})) << "same place, new page";
}

TEST(Pack, PageSizesDoNotMix) {
    std::vector<StoredSlot> slots{Rectangle(0, 8, 8), Rectangle(1, 8, 8)};
    slots[1].pageSize = {256, 64};
    EXPECT_EQ(PackAll(slots, {}), 2u);
}

} // namespace
} // namespace q3
