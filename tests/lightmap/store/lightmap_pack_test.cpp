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

    bool Fits(const LightmapLayer &layer, int x, int y) const {
        if (x < 0 || y < 0 || x + layer.width > width || y + layer.height > height)
            return false;
        for (int row = 0; row < layer.height; ++row)
            for (int column = 0; column < layer.width; ++column)
                if (layer.Used(std::size_t(row) * std::size_t(layer.width) + std::size_t(column)) &&
                    taken[std::size_t(y + row) * std::size_t(width) + std::size_t(x + column)])
                    return false;
        return true;
    }
    std::optional<std::array<int, 2>> Find(const LightmapLayer &layer, int stepX, int stepY) const {
        for (int y = 0; y < height; y += stepY)
            for (int x = 0; x < width; x += stepX)
                if (Fits(layer, x, y))
                    return std::array{x, y};
        return std::nullopt;
    }
    template <typename Body> void ForUsed(const LightmapLayer &layer, int x, int y, const Body &body) const {
        for (int row = 0; row < layer.height; ++row)
            for (int column = 0; column < layer.width; ++column)
                if (layer.Used(std::size_t(row) * std::size_t(layer.width) + std::size_t(column)))
                    body(std::size_t(y + row) * std::size_t(width) + std::size_t(x + column));
    }
};

LightmapLayer RandomLayer(std::mt19937 &random, int most, int unusedPercent) {
    LightmapLayer layer;
    layer.width = 1 + int(random() % unsigned(most)), layer.height = 1 + int(random() % unsigned(most));
    layer.texels.resize(std::size_t(layer.width) * std::size_t(layer.height));
    for (Vec3f &texel : layer.texels)
        if (int(random() % 100) < unusedPercent)
            texel = {-1, -1, -1};
    return layer;
}

void ExpectSamePlaces(int width, int height, int most, int unusedPercent) {
    std::mt19937 random(unsigned(width * 7 + most));
    PageSpace space(width, height);
    PlainPage plain{width, height};
    int placed = 0, refused = 0;
    for (int i = 0; i < 60; ++i) {
        const LightmapLayer layer = RandomLayer(random, most, unusedPercent);
        const Stamp stamp = MakeStamp(layer);
        const int stepX = 1 + int(random() % 3), stepY = 1 + int(random() % 3);
        const auto at = space.Find(stamp, stepX, stepY);
        ASSERT_EQ(at, plain.Find(layer, stepX, stepY)) << i;
        const int x = int(random() % unsigned(width)) - 2, y = int(random() % unsigned(height)) - 2;
        ASSERT_EQ(space.Fits(stamp, x, y), plain.Fits(layer, x, y)) << i;
        if (!at) {
            ++refused;
            continue;
        }
        const int before = space.FreeTexels();
        space.Take(stamp, (*at)[0], (*at)[1]);
        int used = 0;
        plain.ForUsed(layer, (*at)[0], (*at)[1], [&](std::size_t texel) { plain.taken[texel] = true, ++used; });
        ASSERT_EQ(before - space.FreeTexels(), used);
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

LightmapLayer Rectangle(int lightmap, int width, int height, std::size_t style = 0) {
    LightmapLayer layer;
    layer.lightmap = lightmap, layer.slot = style;
    layer.width = width, layer.height = height;
    layer.texels.resize(std::size_t(width) * std::size_t(height));
    return layer;
}

std::size_t PackAll(std::vector<LightmapLayer> &layers, const LightmapOptions &options) {
    LightmapLayers stored;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        stored.layerOf.resize(std::max(stored.layerOf.size(), std::size_t(layers[i].lightmap) + 1), {-1, -1, -1, -1});
        stored.layerOf[std::size_t(layers[i].lightmap)][layers[i].slot] = int(i);
        order.push_back(i);
    }
    stored.layers = layers;
    const std::size_t pages = PackLayers(order, options, stored).size();
    layers = stored.layers;
    return pages;
}

TEST(Pack, LightmapsThatAreNotSquareInterlock) {
    std::vector<LightmapLayer> layers{Rectangle(0, 128, 128), Rectangle(1, 128, 128)};
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x)
            layers[x > y ? 0 : 1].texels[std::size_t(y * 128 + x)] = {-1, -1, -1};
    EXPECT_EQ(PackAll(layers, {}), 1u) << "two triangles share one page";
}

TEST(Pack, SearchBlocksAndFastAllocation) {
    // 120 x 120 leaves 12 % of a page free: room for the small one of an earlier page.
    std::vector<LightmapLayer> layers{Rectangle(0, 120, 120), Rectangle(1, 120, 120), Rectangle(2, 8, 8)};
    LightmapOptions options;
    EXPECT_EQ(PackAll(layers, options), 2u);
    EXPECT_EQ(layers[2].page, 0);
    options.searchBlock = 1;
    PackAll(layers, options);
    EXPECT_EQ(layers[2].page, 1) << "only the last page is looked at";
    // 124 x 124 leaves 6 %: too full for a look unless it is exhaustive.
    layers = {Rectangle(0, 124, 124), Rectangle(1, 4, 4)};
    options = {};
    EXPECT_EQ(PackAll(layers, options), 2u);
    options.fastAllocate = false;
    EXPECT_EQ(PackAll(layers, options), 1u);
}

TEST(Pack, LaterStylesLieWhereTheFirstIs) {
    std::vector<LightmapLayer> layers{Rectangle(0, 128, 40), Rectangle(1, 50, 60), Rectangle(1, 50, 60, 1),
                                      Rectangle(1, 50, 60, 2)};
    EXPECT_EQ(PackAll(layers, {}), 2u);
    EXPECT_EQ(layers[1].y, 40);
    EXPECT_EQ((std::array{layers[2].page, layers[2].x, layers[2].y}), (std::array{0, 64, 40})) << "half a page beside";
    EXPECT_EQ((std::array{layers[3].page, layers[3].x, layers[3].y}), (std::array{1, 0, 40})) << "same place, new page";
}

TEST(Pack, PageSizesDoNotMix) {
    std::vector<LightmapLayer> layers{Rectangle(0, 8, 8), Rectangle(1, 8, 8)};
    layers[1].pageSize = {256, 64};
    EXPECT_EQ(PackAll(layers, {}), 2u);
}

} // namespace
} // namespace q3
