// GPL-2.0-or-later. Textures of SH grids that name lights: the shaders, read as C++, give what the reader gives.
#include "tests/libs/shgrid/random_tree.h"
#include "tests/libs/shgrid/shgrid_shaders.h"
#include "tests/support/named_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>

namespace q3::test {

namespace {

using namespace shaders;

/// A random tree around the lights of a table, in a box of 128 x 64 x 64 from (-104 0 16). Each node names `named`
/// random lights of the first `lights`, and points have random shares and coefficients, below 0 too.
NamedGridSH RandomNamedGrid(const TreeShape &shape, unsigned seed, GridLights table, std::size_t lights, int named) {
    const RandomTree tree(shape, seed);
    NamedGridSH grid;
    grid.roots = shape.roots, grid.levels = shape.levels;
    grid.mins = {-104, 0, 16};
    for (std::size_t axis = 0; axis < 3; ++axis)
        grid.cell[axis] = (axis == 0 ? 128.0f : 64.0f) / float(tree.Bounds()[axis]);
    grid.table = std::move(table);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1);
    for (const SparseGridNode &from : tree.Tree().nodes) {
        NamedGridNode &node = grid.nodes.emplace_back();
        node.inner = from.inner, node.stored = from.stored, node.hanging = from.hanging;
        std::vector<std::uint16_t> all(lights);
        std::iota(all.begin(), all.end(), std::uint16_t(0));
        std::shuffle(all.begin(), all.end(), random);
        node.nameCount = std::uint8_t(std::min(std::size_t(named), lights));
        grid.names.insert(grid.names.end(), all.begin(), all.begin() + node.nameCount);
        for (int point = 0; point < std::popcount(node.stored); ++point) {
            bspGridPointSH_t value{};
            for (auto &coefficient : value.coeffs)
                for (float &channel : coefficient)
                    channel = unit(random) - 0.5f;
            grid.points.push_back(QuantizeNamed(value));
            for (int i = 0; i < node.nameCount; ++i)
                grid.shares.push_back(std::uint8_t(random() % 256));
        }
    }
    NumberNamedNodes(grid);
    return grid;
}

/// The textures of a grid that names lights.
struct NamedTextures {
    std::vector<std::byte> lump;
    shgrid_grid grid{};
    shgrid_atlas atlas{};
    usampler3D indirection, names;
    std::array<sampler3D, 7> t;
    sampler3D shares;
    sampler2D table;

    explicit NamedTextures(const NamedGridSH &from) : lump(EncodeNamedGrid(from)) {
        EXPECT_EQ(shgrid_parse(lump.data(), lump.size(), &grid), SHGRID_OK);
        shgrid_atlas_measure(&grid, &atlas);
        const std::size_t texels = shgrid_atlas_texels(&atlas);
        std::vector<unsigned char> entries(shgrid_indirection_bytes(&atlas)), shareBytes(shgrid_shares_bytes(&atlas));
        std::vector<std::uint16_t> halfs(7 * 4 * texels), lists(shgrid_names_bytes(&atlas) / 2);
        std::vector<float> floats(shgrid_table_bytes(&atlas) / 4);
        std::array<void *, 7> pointers{};
        for (std::size_t i = 0; i < 7; ++i)
            pointers[i] = halfs.data() + i * 4 * texels;
        shgrid_atlas_fill_lights(&grid, &atlas, entries.data(), pointers.data(), lists.data(), shareBytes.data(),
                                 floats.data());
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int groups = axis == 2 ? SHGRID_BRICK_NAMES / 4 : 1;
            indirection.size[axis] = atlas.entries[axis];
            names.size[axis] = groups * atlas.bricks[axis];
            shares.size[axis] = groups * 5 * atlas.bricks[axis];
        }
        indirection.entries.assign(entries.begin(), entries.end());
        names.entries.assign(lists.begin(), lists.end());
        for (std::size_t i = 0; i < shareBytes.size(); i += 4)
            shares.texels.emplace_back(shareBytes[i] / 255.0, shareBytes[i + 1] / 255.0, shareBytes[i + 2] / 255.0,
                                       shareBytes[i + 3] / 255.0);
        for (std::size_t i = 0; i < halfs.size(); i += 4)
            t[i / (4 * texels)].texels.emplace_back(FromHalf(halfs[i]), FromHalf(halfs[i + 1]), FromHalf(halfs[i + 2]),
                                                    FromHalf(halfs[i + 3]));
        for (sampler3D &texture : t)
            texture.size = {5 * atlas.bricks[0], 5 * atlas.bricks[1], 5 * atlas.bricks[2]};
        table.size = {SHGRID_TABLE_WIDTH, atlas.tableRows};
        for (std::size_t i = 0; i < floats.size(); i += 4)
            table.texels.emplace_back(floats[i], floats[i + 1], floats[i + 2], floats[i + 3]);
    }

    void SetStyles(const std::array<float, 64> &styles) {
        for (std::size_t i = 0; i < SHGRID_STYLE_TEXELS; ++i)
            table.texels[i] = {styles[4 * i], styles[4 * i + 1], styles[4 * i + 2], styles[4 * i + 3]};
    }
    template <typename Atlas> Atlas Constants() const {
        const auto vec = [](const auto &v) { return vec3(double(v[0]), double(v[1]), double(v[2])); };
        return {vec(grid.mins), vec(grid.cell), vec(grid.bounds), vec(atlas.bricks), float(1 << atlas.shift), 0, 0};
    }
    std::array<vec3, 2> Light(vec3 position, vec3 normal) const {
        return {glsl::ShgridHalfLights(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], names, shares, table,
                                       Constants<glsl::ShgridAtlas>(), position, normal),
                hlsl::ShgridHalfLights(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], names, shares, table, {},
                                       Constants<hlsl::ShgridAtlas>(), position, normal)};
    }
    /// The list of a brick.
    std::vector<unsigned> List(std::size_t brick) const {
        std::vector<unsigned> list;
        for (std::size_t i = 0; i < SHGRID_BRICK_NAMES; ++i)
            list.push_back(names.entries[4 * (brick + i / 4 * (names.entries.size() / SHGRID_BRICK_NAMES)) + i % 4]);
        return list;
    }
};

/// A random position in the box of a grid, and a normal.
struct NamedPlace {
    float position[3], normal[3];
    NamedPlace(const shgrid_grid &grid, std::mt19937 &random) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float edge = grid.cell[axis] * float(grid.bounds[axis]);
            position[axis] = grid.mins[axis] + std::uniform_real_distribution<float>(0, edge)(random);
            normal[axis] = std::normal_distribution<float>()(random);
        }
        const float length = std::hypot(normal[0], normal[1], normal[2]);
        for (float &component : normal)
            component /= length;
    }
};

/// What a share of 1 of all lights that are named at a place gives there; red.
float WholeLight(const shgrid_grid &grid, const NamedPlace &place, const shgrid_sum_ &sum) {
    float light = 0;
    for (int i = 0; i < sum.names; ++i) {
        shgrid_beam_ beam;
        shgrid_beam_at_(&grid, sum.light[i], place.position, &beam);
        shgrid_coeffs wide{};
        for (std::size_t k = 0; k < 9; ++k)
            wide.c[k][0] = beam.hasSH ? beam.sh[k] : 0;
        float rgb[3];
        shgrid_sum_basis_(&wide, place.normal, rgb);
        const float cosine = std::inner_product(place.normal, place.normal + 3, beam.direction, 0.0f);
        light += std::abs(rgb[0]) + beam.strength * shgrid_lobe_(cosine, beam.spread);
    }
    return light;
}

const TreeShape kShapes[] = {{{1, 1, 1}, 1, 0, 0, 0.25f},
                             {{2, 1, 1}, 2, 0.5, 0, 0.25f},
                             {{2, 1, 1}, 3, 0.6, 0, 0.25f},
                             {{1, 1, 1}, 4, 0.4, 0, 0.25f}};

// The sum of the absolute values of nine basis functions is at most sqrt(9 * 9 / (4 pi)).
constexpr float kBasis = 2.54f;

/// The difference of shaders from the reader, in terms of its bound.
struct Comparison {
    int lit = 0, near = 0, partial = 0; ///< near: to the panel, which acts as coefficients there
    double worst = 0, sum = 0;
};

void ComparePlaces(const NamedTextures &textures, const std::array<float, 64> &styles, std::mt19937 &random,
                   Comparison &all) {
    for (int i = 0; i < 1000; ++i) {
        const NamedPlace place(textures.grid, random);
        shgrid_sum_ sum;
        shgrid_sample_tree_(&textures.grid, place.position, &sum);
        if (sum.total < 0.3f)
            continue;
        shgrid_lighting lighting;
        shgrid_lights(&textures.grid, place.position, styles.data(), &lighting);
        float rgb[3];
        shgrid_shade(&lighting, place.normal, rgb);
        // Shares are bytes. Coefficients are halves of at most 0.5. Both are divided by the weight of corners with a
        // value; the others have neighbors' values, with little weight. Numbers of the shaders are floats.
        const float whole = WholeLight(textures.grid, place, sum), filled = sum.total < 0.99999f ? 1.0f : 0.0f;
        const float error = (kBasis * 0.5f / 4096 + whole * 0.5f / 255) / sum.total + 3e-4f * (1 + whole) +
                            filled * SHGRID_FILLED_WEIGHT / sum.total * (kBasis + whole);
        all.lit += rgb[0] > 0.1f;
        all.near += std::abs(place.position[2] - 50) < 8;
        all.partial += sum.total < 0.9f;
        const vec3 position(place.position[0], place.position[1], place.position[2]);
        const vec3 normal(place.normal[0], place.normal[1], place.normal[2]);
        for (const vec3 &light : textures.Light(position, normal)) {
            ASSERT_NEAR(light.x, rgb[0], error) << position.x << ' ' << position.y << ' ' << position.z;
            ASSERT_NEAR(light.y, rgb[1], error);
            ASSERT_NEAR(light.z, rgb[2], error);
            all.worst = std::max(all.worst, double(std::abs(light.x - rgb[0]) / error));
            all.sum += double(std::abs(light.x - rgb[0]));
        }
    }
}

TEST(AtlasOfNamedLights, TexturesGiveTheLightOfTheReader) {
    std::mt19937 random(67);
    std::array<float, 64> styles{};
    for (float &style : styles)
        style = std::uniform_real_distribution<float>(0, 1)(random);
    Comparison all;
    for (TreeShape shape : kShapes)
        for (unsigned seed = 0; seed < 6; ++seed) {
            shape.absent = seed % 2 == 0 ? 0 : 0.2;
            NamedTextures textures(RandomNamedGrid(shape, seed, LightsOfAllKinds(), 9, 6));
            textures.SetStyles(styles);
            ComparePlaces(textures, styles, random, all);
        }
    EXPECT_GT(all.lit, 5000);
    EXPECT_GT(all.near, 2000);
    EXPECT_GT(all.partial, 5000) << "cells with corners without a value";
    EXPECT_LT(all.sum, 2 * 20000 * 3e-3) << "most differences are far below the bound";
    EXPECT_GT(all.worst, 0.2) << "bounds that are too wide prove little";
}

/// Adds light `number` of the reader to coefficients, at full brightness.
void AddNamed(const shgrid_grid &grid, std::uint32_t number, float share, const float position[3], shgrid_coeffs &sum) {
    shgrid_sum_ one;
    shgrid_clear_(&one);
    one.names = 1, one.light[0] = number, one.share[0] = share;
    shgrid_add_named_lights_(&grid, position, &one);
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            sum.c[k][channel] += one.coeffs.c[k][channel];
}

/// Many lamps around the box.
GridLights ManyLamps(int count) {
    std::mt19937 random(71);
    std::uniform_real_distribution<float> unit(0, 1);
    GridLights table;
    for (int i = 0; i < count; ++i) {
        GridLight &lamp = AddLight(table, "lamp", SHGRID_POINT);
        lamp.origin = {200 + 100 * unit(random), -100 + 200 * unit(random), 200};
        lamp.nearest = 16, lamp.intensity = 500 + 9000 * unit(random);
    }
    return table;
}

// In places with the textures' coefficients, the lights of the lists and their shares are all light that is there.
TEST(AtlasOfNamedLights, LightsThatAreNotInAListAreCoefficients) {
    std::mt19937 random(73);
    const NamedTextures textures(RandomNamedGrid({{2, 1, 1}, 3, 0.6, 0, 0.25f}, 5, ManyLamps(40), 40, 30));
    std::size_t full = 0;
    int compared = 0;
    const auto atlas = textures.Constants<glsl::ShgridAtlas>();
    for (std::size_t brick = 0; brick < std::size_t(textures.atlas.count); ++brick)
        full += textures.List(brick).back() < 40;
    EXPECT_EQ(full, std::size_t(textures.atlas.count));
    // Half a step of 16 shares of lamps of strength 0.2 at most, and half a step of halves of up to 4.
    const float error = 16 * 0.2f * 0.886f / 510 + 1e-3f;
    for (std::size_t round = 0; round < 500; ++round) {
        // A corner of a smallest cell is a texel of the finest bricks.
        float position[3];
        for (std::size_t axis = 0; axis < 3; ++axis)
            position[axis] = textures.grid.mins[axis] +
                             textures.grid.cell[axis] * float(random() % std::size_t(textures.grid.bounds[axis]));
        const vec4 at = glsl::ShgridPlace(textures.indirection, atlas, vec3(position[0], position[1], position[2]));
        const vec3 p(at.x, at.y, at.z);
        const auto texel = [&](float share, int size) { return int(std::floor(share * float(size))); };
        const auto &size = textures.t[0].size;
        const auto isBetween = [](float share, int texels) {
            const float texel = share * float(texels);
            return std::abs(texel - std::floor(texel) - 0.5f) > 0.01f;
        };
        if (isBetween(p.x, size[0]) || isBetween(p.y, size[1]) || isBetween(p.z, size[2]))
            continue; // the brick is coarse there
        ++compared;
        const int x = texel(p.x, size[0]), y = texel(p.y, size[1]), z = texel(p.z, size[2]);
        const float weight = textures.t[6].Texel(x, y, z).w;
        shgrid_coeffs sum{}, all;
        for (std::size_t n = 0; n < 27; ++n)
            sum.c[n / 3][n % 3] = textures.t[n / 4].Texel(x, y, z)[int(n % 4)];
        const std::size_t brick =
            std::size_t(x / 5 + textures.atlas.bricks[0] * (y / 5 + textures.atlas.bricks[1] * (z / 5)));
        const std::vector<unsigned> list = textures.List(brick);
        for (std::size_t i = 0; i < list.size(); ++i)
            AddNamed(textures.grid, list[i], textures.shares.Texel(x, y, z + int(i / 4) * size[2])[int(i % 4)],
                     position, sum);
        shgrid_sample(&textures.grid, position, &all);
        for (std::size_t k = 0; k < 9; ++k)
            ASSERT_NEAR(sum.c[k][0] / weight, all.c[k][0], error / weight) << k;
    }
    EXPECT_GT(compared, 100);
}

/// One cell of eight points that name `count` lamps at the same place, each of that intensity.
NamedGridSH LampsOfIntensity(const std::vector<float> &intensities) {
    NamedGridSH grid = SmallNamedGrid(1);
    grid.table = {};
    grid.names.clear(), grid.shares.clear();
    for (std::size_t i = 0; i < intensities.size(); ++i) {
        GridLight &lamp = AddLight(grid.table, "", SHGRID_POINT);
        lamp.origin = {500, 500, 500}, lamp.nearest = 16, lamp.intensity = intensities[i];
        grid.names.push_back(std::uint16_t(i));
    }
    grid.nodes[0].nameCount = std::uint8_t(intensities.size());
    grid.shares.assign(8 * intensities.size(), 255);
    NumberNamedNodes(grid);
    return grid;
}

TEST(AtlasOfNamedLights, ListsHoldTheStrongestLightsAndThoseWithAStyleFirst) {
    std::vector<float> intensities(20);
    for (std::size_t i = 0; i < 20; ++i)
        intensities[i] = float(7 * i % 20);
    NamedGridSH grid = LampsOfIntensity(intensities);
    std::vector<unsigned> expected(20);
    for (unsigned i = 0; i < 20; ++i)
        expected[19 - 7 * i % 20] = i;
    expected.resize(16);
    EXPECT_EQ(NamedTextures(grid).List(0), expected);
    grid.table.lights[3].style = 3; // the weakest but one
    expected.pop_back();
    expected.insert(expected.begin(), 3);
    EXPECT_EQ(NamedTextures(grid).List(0), expected);
    expected.assign(16, SHGRID_NO_NAME);
    expected[0] = 2, expected[1] = 1, expected[2] = 0;
    EXPECT_EQ(NamedTextures(LampsOfIntensity({0, 2, 3})).List(0), expected);
}

TEST(AtlasOfNamedLights, PlacesWithMoreNamesThanAListOfCandidatesStayInside) {
    for (unsigned seed = 0; seed < 3; ++seed) {
        const NamedTextures textures(RandomNamedGrid({{2, 1, 1}, 3, 0.6, 0.3, 0.25f}, seed, ManyLamps(2000), 2000, 90));
        for (std::size_t brick = 0; brick < std::size_t(textures.atlas.count); ++brick)
            for (const unsigned name : textures.List(brick))
                EXPECT_LT(name, 2000u);
    }
}

TEST(AtlasOfNamedLights, SharesHaveTheWeightOfCornersWithAValue) {
    std::mt19937 random(79);
    int partial = 0;
    for (unsigned seed = 0; seed < 3; ++seed) {
        NamedGridSH grid = RandomNamedGrid({{2, 1, 1}, 3, 0.6, 0.3, 0.25f}, seed, LampsOfIntensity({1}).table, 1, 1);
        std::fill(grid.shares.begin(), grid.shares.end(), std::uint8_t(255));
        const NamedTextures textures(grid);
        const auto atlas = textures.Constants<glsl::ShgridAtlas>();
        for (int i = 0; i < 2000; ++i) {
            const NamedPlace place(textures.grid, random);
            shgrid_sum_ sum;
            shgrid_sample_tree_(&textures.grid, place.position, &sum);
            if (!(sum.total > 0.02f))
                continue;
            const vec4 at = glsl::ShgridPlace(textures.indirection, atlas,
                                              vec3(place.position[0], place.position[1], place.position[2]));
            const float share = textureLod(textures.shares, vec3(at.x, at.y, 0.25f * at.z), 0).x;
            const float weight = textureLod(textures.t[6], vec3(at.x, at.y, at.z), 0).w;
            partial += sum.total < 0.9f;
            ASSERT_EQ(at.w, 1);
            ASSERT_NEAR(weight, sum.total, SHGRID_FILLED_WEIGHT + 1e-3f);
            ASSERT_NEAR(share, weight, 0.5f / 255 + 1e-3f) << "all shares are 1";
        }
    }
    EXPECT_GT(partial, 1000);
}

TEST(AtlasOfNamedLights, SizesAndTheTable) {
    const NamedTextures textures(SmallNamedGrid(1));
    EXPECT_EQ(textures.atlas.count, 1);
    EXPECT_EQ(textures.atlas.tableRows, 1);
    EXPECT_EQ(shgrid_names_bytes(&textures.atlas), 32u);
    EXPECT_EQ(shgrid_shares_bytes(&textures.atlas), 2000u);
    EXPECT_EQ(shgrid_table_bytes(&textures.atlas), 16384u);
    for (int i = 0; i < SHGRID_STYLE_TEXELS; ++i)
        EXPECT_EQ(textures.table.texels[std::size_t(i)][3], 1);
    const vec4 color = textures.table.texels[SHGRID_STYLE_TEXELS + 5 * SHGRID_LIGHT_TEXELS + 1];
    EXPECT_EQ(color.y, 0.5f);
    EXPECT_EQ(color.w, 7000) << "intensity of the spot by angles";

    const RandomTree tree({{1, 1, 1}, 1, 0, 0, 1}, 1);
    const std::vector<std::byte> plain = EncodeSparseGrid(PackSparseGrid(tree.Tree()));
    shgrid_grid grid;
    shgrid_atlas atlas;
    ASSERT_EQ(shgrid_parse(plain.data(), plain.size(), &grid), SHGRID_OK);
    shgrid_atlas_measure(&grid, &atlas);
    EXPECT_EQ(atlas.count, 1);
    EXPECT_EQ(atlas.tableRows, 0) << "it names no lights";
}

TEST(AtlasOfNamedLights, TablesThatAreTooLargeAreNotMade) {
    NamedGridSH grid = SmallNamedGrid(1);
    const std::uint32_t most = SHGRID_TABLE_WIDTH * SHGRID_TABLE_ROWS / SHGRID_POLYGON_TEXELS;
    grid.table.polygons.resize(most, grid.table.polygons[0]);
    grid.table.lights[7].firstPolygon = most - 1;
    const std::vector<std::byte> lump = EncodeNamedGrid(grid);
    shgrid_grid reader;
    shgrid_atlas atlas;
    ASSERT_EQ(shgrid_parse(lump.data(), lump.size(), &reader), SHGRID_OK);
    shgrid_atlas_measure(&reader, &atlas);
    EXPECT_EQ(atlas.count, 1);
    EXPECT_EQ(atlas.tableRows, 0);
}

} // namespace
} // namespace q3::test
