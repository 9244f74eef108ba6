// GPL-2.0-or-later. Textures of sparse SH grids: the shaders, read as C++, give what the reader gives.
#include "libs/math/packed_color.h"
#include "tests/libs/shgrid/random_tree.h"
#include "tests/libs/shgrid/shgrid_shaders.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

namespace q3::test {

namespace {

using namespace shaders;

/// The textures of a tree.
struct Textures {
    RandomTree tree;
    std::vector<std::byte> lump;
    shgrid_grid grid{};
    shgrid_atlas atlas{};
    shgrid_atlas_format format;
    usampler3D indirection;
    std::array<sampler3D, 7> textures;

    Textures(const RandomTree &from, shgrid_atlas_format form) : tree(from), format(form) {
        const SparseGridSH packed = PackSparseGrid(tree.Tree());
        tree.SetValues(DequantizePoints(packed));
        lump = EncodeSparseGrid(packed);
        EXPECT_EQ(shgrid_parse(lump.data(), lump.size(), &grid), SHGRID_OK);
        shgrid_atlas_measure(&grid, &atlas);
        std::array<std::vector<std::uint32_t>, 7> bytes;
        std::array<void *, 7> pointers{};
        for (std::size_t i = 0; i < 7; ++i) {
            bytes[i].resize(shgrid_atlas_bytes(&atlas, format) / 4);
            pointers[i] = bytes[i].data();
        }
        std::vector<unsigned char> entries(shgrid_indirection_bytes(&atlas));
        shgrid_atlas_fill(&grid, &atlas, format, entries.data(), pointers.data());
        indirection.entries.assign(entries.begin(), entries.end());
        for (std::size_t axis = 0; axis < 3; ++axis)
            indirection.size[axis] = atlas.entries[axis];
        for (std::size_t i = 0; i < 7; ++i)
            textures[i] = Decoded(bytes[i], i);
    }

    sampler3D Decoded(const std::vector<std::uint32_t> &bytes, std::size_t number) const {
        sampler3D texture;
        for (std::size_t axis = 0; axis < 3; ++axis)
            texture.size[axis] = 5 * atlas.bricks[axis];
        for (std::size_t i = 0; i < shgrid_atlas_texels(&atlas); ++i) {
            if (format == SHGRID_ATLAS_HALF) {
                std::array<std::uint16_t, 4> half{};
                std::memcpy(half.data(), &bytes[2 * i], 8);
                texture.texels.emplace_back(FromHalf(half[0]), FromHalf(half[1]), FromHalf(half[2]), FromHalf(half[3]));
            } else if (number == 0) {
                const Vec3f mean = DecodeE5bgr9(bytes[i]);
                texture.texels.emplace_back(mean.x, mean.y, mean.z, 1);
            } else {
                const auto share = [&](int shift) { return std::int8_t(bytes[i] >> shift & 255) / 127.0; };
                texture.texels.emplace_back(share(0), share(8), share(16), share(24));
            }
        }
        return texture;
    }

    template <typename Atlas> Atlas Constants() const {
        const auto vec = [](const auto &v) { return vec3(double(v[0]), double(v[1]), double(v[2])); };
        return {vec(grid.mins),          vec(grid.cell),  vec(grid.bounds), vec(atlas.bricks),
                float(1 << atlas.shift), atlas.limits[0], atlas.limits[1]};
    }
    std::array<vec3, 2> Light(vec3 position, vec3 normal) const {
        const auto &t = textures;
        const auto g = Constants<glsl::ShgridAtlas>();
        const auto h = Constants<hlsl::ShgridAtlas>();
        if (format == SHGRID_ATLAS_HALF)
            return {glsl::ShgridHalf(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], g, position, normal),
                    hlsl::ShgridHalf(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], {}, h, position, normal)};
        return {glsl::ShgridSnorm(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], g, position, normal),
                hlsl::ShgridSnorm(indirection, t[0], t[1], t[2], t[3], t[4], t[5], t[6], {}, h, position, normal)};
    }
};

/// A random position, and what reader and tree say about it.
struct Place {
    vec3 position, normal;
    float rgb[3];
    shgrid_coeffs coeffs;
    SlowValue slow;

    Place(const Textures &textures, std::mt19937 &random) {
        std::array<double, 3> at{};
        float where[3], facing[3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            at[axis] = std::uniform_real_distribution<>(0, textures.tree.Bounds()[axis])(random);
            where[axis] = float(double(textures.grid.mins[axis]) + at[axis] * double(textures.grid.cell[axis]));
            facing[axis] = std::uniform_real_distribution<float>(-1, 1)(random);
        }
        const float length = std::hypot(facing[0], facing[1], facing[2]);
        for (float &f : facing)
            f /= length;
        position = vec3(where[0], where[1], where[2]);
        normal = vec3(facing[0], facing[1], facing[2]);
        slow = textures.tree.Blend(at);
        shgrid_sample(&textures.grid, where, &coeffs);
        shgrid_evaluate(&coeffs, facing, rgb);
    }
};

const TreeShape kAtlasShapes[] = {{{1, 1, 1}, 1, 0, 0, 0.25f},   {{2, 1, 1}, 2, 0.5, 0, 0.25f},
                                  {{1, 2, 1}, 3, 0.6, 0, 0.25f}, {{1, 1, 1}, 4, 0.4, 0, 0.25f},
                                  {{3, 1, 1}, 2, 1, 0, 0.25f},   {{1, 1, 1}, 5, 0.35, 0, 0.25f}};

TEST(SparseAtlas, HalfTexturesGiveTheLightOfTheReader) {
    std::mt19937 random(31);
    int compared = 0;
    for (const TreeShape &shape : kAtlasShapes)
        for (unsigned seed = 0; seed < 3; ++seed) {
            const Textures textures(RandomTree(shape, seed), SHGRID_ATLAS_HALF);
            for (int i = 0; i < 1000; ++i) {
                const Place place(textures, random);
                if (place.slow.weight < 0.99999)
                    continue;
                ++compared;
                for (const vec3 &light : textures.Light(place.position, place.normal)) {
                    ASSERT_NEAR(light.x, place.rgb[0], 1e-3 * place.coeffs.c[0][0]);
                    ASSERT_NEAR(light.y, place.rgb[1], 1e-3 * place.coeffs.c[0][1]);
                    ASSERT_NEAR(light.z, place.rgb[2], 1e-3 * place.coeffs.c[0][2]);
                }
            }
        }
    EXPECT_GT(compared, 3000);
}

TEST(SparseAtlas, CellsWithSomeValuesAreNeverBlack) {
    std::mt19937 random(37);
    int partial = 0;
    for (unsigned seed = 0; seed < 6; ++seed) {
        const Textures textures(RandomTree({{2, 1, 1}, 4, 0.5, 0.4, 0.25f}, seed), SHGRID_ATLAS_HALF);
        const auto atlas = textures.Constants<glsl::ShgridAtlas>();
        for (int i = 0; i < 2000; ++i) {
            const Place place(textures, random);
            if (!(place.slow.weight > 0))
                continue;
            partial += place.slow.weight < 0.9;
            const vec4 at = glsl::ShgridPlace(textures.indirection, atlas, place.position);
            const vec4 texel = textureLod(textures.textures[0], vec3(at.x, at.y, at.z), 0);
            EXPECT_EQ(at.w, 1);
            ASSERT_GE(texel.x, 0.249f);
            ASSERT_LE(texel.x, 1.001f);
        }
    }
    EXPECT_GT(partial, 2000);
}

/// The component of a texel of texture 1 + 3 (k - 1) / 4 that holds the red of coefficient k.
float RedShare(const vec4 &t, std::size_t k) {
    const std::size_t component = 3 * (k - 1) % 4;
    return component == 0 ? t.x : component == 1 ? t.y : component == 2 ? t.z : t.w;
}

TEST(SparseAtlas, SnormTexturesDifferByTheirStepsAndByFilteringSharesAlone) {
    std::mt19937 random(41);
    for (const TreeShape &shape : kAtlasShapes) {
        const Textures textures(RandomTree(shape, 7), SHGRID_ATLAS_SNORM);
        const auto atlas = textures.Constants<glsl::ShgridAtlas>();
        for (int i = 0; i < 500; ++i) {
            const Place place(textures, random);
            if (place.slow.weight < 0.99999)
                continue;
            const vec4 at = glsl::ShgridPlace(textures.indirection, atlas, place.position);
            const vec3 p(at.x, at.y, at.z);
            for (std::size_t k = 1; k < 9; ++k) {
                const sampler3D &shares = textures.textures[1 + 3 * (k - 1) / 4], &means = textures.textures[0];
                std::array<float, 2> range = {1, -1}, brightness = {1e9f, 0};
                for (int corner = 0; corner < 8; ++corner) {
                    const auto texel = [&](float x, int size, int bit) {
                        return std::min(int(std::floor(x * float(size) - 0.5f)) + (corner >> bit & 1), size - 1);
                    };
                    const int x = texel(p.x, means.size[0], 0), y = texel(p.y, means.size[1], 1),
                              z = texel(p.z, means.size[2], 2);
                    const float share = RedShare(shares.Texel(x, y, z), k), mean = means.Texel(x, y, z).x;
                    range = {std::min(range[0], share), std::max(range[1], share)};
                    brightness = {std::min(brightness[0], mean), std::max(brightness[1], mean)};
                }
                const float limit = k < 4 ? atlas.limit1 : atlas.limit2;
                const float light = RedShare(textureLod(shares, p, 0), k) * limit * textureLod(means, p, 0).x;
                const float separate = (range[1] - range[0]) * (brightness[1] - brightness[0]) * limit / 4;
                const float step = limit * brightness[1] * (1.0f / 254 + 1.0f / 256);
                ASSERT_NEAR(light, place.coeffs.c[k][0], separate + step + 1e-5f) << k;
            }
        }
    }
}

TEST(SparseAtlas, SnormTexturesOfEvenLightDifferByTheirStepsAlone) {
    std::mt19937 random(43);
    const Textures textures(RandomTree({{1, 1, 1}, 4, 0.5, 0, 1}, 7), SHGRID_ATLAS_SNORM);
    for (int i = 0; i < 2000; ++i) {
        const Place place(textures, random);
        if (place.slow.weight < 0.99999)
            continue;
        for (const vec3 &light : textures.Light(place.position, place.normal)) {
            // Half a step of each coefficient times its basis function, at most 0.49 of band 1 and 0.63 to 0.55 of 2.
            const double bound =
                (3 * 0.489 * double(textures.atlas.limits[0]) + 5 * 0.6 * double(textures.atlas.limits[1])) / 254;
            ASSERT_NEAR(light.x, place.rgb[0], bound);
            ASSERT_NEAR(light.z, place.rgb[2], bound);
        }
    }
}

TEST(SparseAtlas, SizesOfSmallTrees) {
    const Textures single(RandomTree({{1, 1, 1}, 1, 0, 0, 1}, 1), SHGRID_ATLAS_HALF);
    EXPECT_EQ(single.atlas.count, 1);
    EXPECT_EQ(shgrid_atlas_texels(&single.atlas), 125u);
    EXPECT_EQ(shgrid_atlas_bytes(&single.atlas, SHGRID_ATLAS_HALF), 1000u);
    EXPECT_EQ(shgrid_indirection_bytes(&single.atlas), 4u);
    const Textures full(RandomTree({{3, 1, 1}, 2, 1, 0, 1}, 1), SHGRID_ATLAS_HALF);
    EXPECT_EQ(full.atlas.count, 3) << "each root is 4 x 4 x 4 cells";
    EXPECT_EQ(full.atlas.shift, 2);
    EXPECT_EQ(full.atlas.entries[0], 3);
    const Textures empty(RandomTree({{1, 1, 1}, 2, 1, 1, 1}, 1), SHGRID_ATLAS_HALF);
    EXPECT_EQ(empty.atlas.count, 0) << "no value anywhere";
    EXPECT_EQ(shgrid_atlas_texels(&empty.atlas), 0u);
    shgrid_grid uniform{};
    shgrid_atlas atlas;
    shgrid_atlas_measure(&uniform, &atlas);
    EXPECT_EQ(atlas.count, 0);
}

TEST(SparseAtlas, TreesThatContradictTheirGeometryStayInside) {
    std::mt19937 random(47);
    for (unsigned seed = 0; seed < 30; ++seed) {
        SparseGridTree tree = RandomTree({{2, 1, 1}, 4, 0.5, 0.3, 0.25f}, seed).Tree();
        std::size_t points = 0;
        for (SparseGridNode &node : tree.nodes) {
            if (&node - tree.nodes.data() >= 2) {
                const auto change = std::uint8_t(random() & random());
                node.hanging = std::uint8_t((node.hanging ^ change) & ~node.inner);
                node.stored = std::uint8_t(node.stored & ~node.hanging);
            }
            points += std::size_t(std::popcount(node.stored));
        }
        tree.values.resize(points, tree.values.front());
        const std::vector<std::byte> lump = EncodeSparseGrid(PackSparseGrid(tree));
        shgrid_grid grid;
        ASSERT_EQ(shgrid_parse(lump.data(), lump.size(), &grid), SHGRID_OK);
        shgrid_atlas atlas;
        shgrid_atlas_measure(&grid, &atlas);
        std::vector<std::uint32_t> texels(7 * shgrid_atlas_bytes(&atlas, SHGRID_ATLAS_SNORM) / 4);
        std::vector<unsigned char> indirection(shgrid_indirection_bytes(&atlas));
        std::array<void *, 7> pointers{};
        for (std::size_t i = 0; i < 7; ++i)
            pointers[i] = texels.data() + i * texels.size() / 7;
        shgrid_atlas_fill(&grid, &atlas, SHGRID_ATLAS_SNORM, indirection.data(), pointers.data());
        for (std::size_t i = 0; i < indirection.size(); i += 4) {
            const int brick =
                indirection[i] + atlas.bricks[0] * (indirection[i + 1] + atlas.bricks[1] * indirection[i + 2]);
            EXPECT_LT(brick, atlas.count);
        }
    }
}

TEST(SparseAtlas, HalvesAndPackedMeansAreRoundedToNearest) {
    for (unsigned code = 0; code < 0x7bff; ++code) {
        const float value = FromHalf(std::uint16_t(code)), next = FromHalf(std::uint16_t(code + 1));
        ASSERT_EQ(shgrid_half_(value), code);
        ASSERT_EQ(shgrid_half_(-value), code == 0 ? 0u : code | 0x8000u);
        ASSERT_EQ(shgrid_half_(value + (next - value) * 0.498f), code);
        ASSERT_EQ(shgrid_half_(value + (next - value) * 0.502f), code + 1);
    }
    EXPECT_EQ(shgrid_half_(1e9f), 0x7bff);
    EXPECT_EQ(shgrid_half_(-INFINITY), 0xfbff);
    EXPECT_EQ(shgrid_half_(NAN), 0);
    std::mt19937 random(3);
    for (int i = 0; i < 20000; ++i) {
        float rgb[3];
        for (float &c : rgb)
            c = std::exp2(std::uniform_real_distribution<float>(-30, 18)(random));
        const Vec3f a = DecodeE5bgr9(shgrid_rgb9e5_(rgb)), b = DecodeE5bgr9(EncodeE5bgr9({rgb[0], rgb[1], rgb[2]}));
        ASSERT_EQ(a, b);
    }
    const float odd[3] = {NAN, -1, INFINITY};
    EXPECT_EQ(DecodeE5bgr9(shgrid_rgb9e5_(odd)), Vec3f(0, 0, 65408));
}

} // namespace
} // namespace q3::test
