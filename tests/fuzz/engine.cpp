// GPL-2.0-or-later. Fuzz target engine: the headers of libs as engines use them, on whole files and on lumps, with
// every call at positions, normals and indexes of the input.
#include "libs/ambientcubes/ambient_cubes.h"
#include "libs/bspx/bspx.h"
#include "libs/directional/directional.h"
#include "libs/hdrlight/hdrlight.h"
#include "libs/shgrid/shgrid.h"
#include "libs/staticprops/staticprops.h"
#include "tests/fuzz/fuzz_target.h"

#include <array>
#include <cmath>
#include <vector>

namespace q3::fuzz {
namespace {

/// Where the readers are asked: any bits, so also NaN and infinity.
struct Query {
    std::array<float, 3> position{}, normal{};
    std::int32_t index = 0;
    float radius = 0;
};

void RequireLight(const float rgb[3]) {
    for (int channel = 0; channel < 3; ++channel)
        Require(!(rgb[channel] < 0) && !std::isnan(rgb[channel]), "light below zero");
}

// ---- SH grids ----

constexpr std::size_t kMostTexels =
    1 << 18; ///< larger textures are not filled, since small grids may ask for large ones

void FillAtlas(const shgrid_grid &grid) {
    shgrid_atlas atlas;
    shgrid_atlas_measure(&grid, &atlas);
    const std::size_t texels = shgrid_atlas_texels(&atlas);
    if (texels > kMostTexels || shgrid_indirection_bytes(&atlas) > 4 * kMostTexels)
        return;
    std::vector<unsigned char> indirection(shgrid_indirection_bytes(&atlas));
    const auto fill = [&](shgrid_atlas_format format, const auto &call) {
        std::vector<std::vector<std::uint32_t>> textures(7);
        std::array<void *, 7> pointers{};
        for (std::size_t i = 0; i < textures.size(); ++i) {
            textures[i].resize(shgrid_atlas_bytes(&atlas, format) / 4);
            pointers[i] = textures[i].data();
        }
        call(pointers.data());
    };
    for (const auto format : {SHGRID_ATLAS_HALF, SHGRID_ATLAS_SNORM})
        fill(format, [&](void *const *to) { shgrid_atlas_fill(&grid, &atlas, format, indirection.data(), to); });
    if (atlas.tableRows == 0)
        return;
    std::vector<std::uint16_t> names(shgrid_names_bytes(&atlas) / 2);
    std::vector<unsigned char> shares(shgrid_shares_bytes(&atlas));
    std::vector<float> table(shgrid_table_bytes(&atlas) / 4);
    fill(SHGRID_ATLAS_HALF, [&](void *const *to) {
        shgrid_atlas_fill_lights(&grid, &atlas, indirection.data(), to, names.data(), shares.data(), table.data());
    });
}

void FillUniform(const shgrid_grid &grid) {
    if (grid.levels != 0 || std::size_t(grid.count) > kMostTexels)
        return;
    std::vector<std::vector<std::uint64_t>> textures(7, std::vector<std::uint64_t>(std::size_t(grid.count)));
    std::array<void *, 7> pointers{};
    for (std::size_t i = 0; i < textures.size(); ++i)
        pointers[i] = textures[i].data();
    shgrid_fill_half(&grid, pointers.data());
}

void AskGrid(const shgrid_grid &grid, const Query &query) {
    const float *position = query.position.data(), *normal = query.normal.data();
    shgrid_coeffs coeffs;
    shgrid_sample(&grid, position, &coeffs);
    float rgb[3];
    shgrid_evaluate(&coeffs, normal, rgb);
    RequireLight(rgb);
    shgrid_convolve(&coeffs);
    shgrid_light(&grid, position, normal, rgb);
    RequireLight(rgb);
    shgrid_lighting lighting;
    std::array<float, 64> styles{};
    styles.fill(query.radius);
    for (const float *brightness : {static_cast<const float *>(nullptr), static_cast<const float *>(styles.data())}) {
        shgrid_lights(&grid, position, brightness, &lighting);
        std::array<float, 3 * 17> normals{}, colors{};
        std::copy_n(normal, 3, normals.data() + 48);
        shgrid_shade_many(&lighting, normals.data(), 3, 17, colors.data(), 3);
        shgrid_limit_lights(&lighting, query.index);
        shgrid_shade(&lighting, normal, rgb);
        RequireLight(rgb);
    }
    shgrid_light_name(&grid, query.index);
    for (int light = 0; light < lighting.count; ++light)
        shgrid_light_name(&grid, lighting.direct[light].light);
    std::array<float, 3> near[4];
    shgrid_points_near(&grid, position, query.radius, std::size(near), reinterpret_cast<float(*)[3]>(near));
    const std::int32_t bounds[3] = {2, 2, 1};
    shgrid_coeffs lattice[4];
    shgrid_expand(&grid, position, normal, bounds, lattice);
    if (grid.points == nullptr)
        return;
    std::int32_t at[3];
    for (int axis = 0; axis < 3; ++axis)
        at[axis] = std::int32_t(std::uint32_t(query.index) % std::uint32_t(grid.bounds[axis]));
    shgrid_point(&grid, at[0], at[1], at[2], &coeffs);
}

void AskGridOfLump(std::span<const std::byte> lump, const Query &query) {
    shgrid_grid grid;
    const bool isGood = shgrid_parse(lump.data(), lump.size(), &grid) == SHGRID_OK;
    Require(isGood == (grid.points != nullptr) || (isGood && grid.count == 0), "a grid without points");
    AskGrid(grid, query); // black if it failed to load
    if (isGood) {
        FillUniform(grid);
        FillAtlas(grid);
    }
}

void AskTone(std::span<const std::byte> bytes, const Query &query) {
    const std::string text(reinterpret_cast<const char *>(bytes.data()), bytes.size());
    shgrid_tone tone;
    shgrid_message(shgrid_parse_tone(text.c_str(), &tone));
    float rgb[3] = {query.normal[0], query.normal[1], query.normal[2]};
    shgrid_apply_tone(&tone, rgb);
    for (const float channel : rgb)
        Require(channel >= 0 && channel <= 1, "a tone outside 0 to 1");
}

// ---- Other lumps ----

void AskCubes(const ambient_cubes &cubes, const Query &query) {
    for (const std::uint32_t leaf : {0u, std::uint32_t(query.index), cubes.leafCount - 1}) {
        float rgb[3];
        ambient_cubes_light(&cubes, leaf, query.position.data(), query.normal.data(), rgb);
    }
}

/// Leafs are the end of the bytes.
void AskCubesOfLump(std::span<const std::byte> bytes, const Query &query) {
    const std::size_t leafs = bytes.size() < AMBIENT_CUBES_HEADER_BYTES
                                  ? 0
                                  : bspx_u32(reinterpret_cast<const unsigned char *>(bytes.data()) + 8);
    const std::size_t leafBytes = std::min(leafs, bytes.size()) * AMBIENT_CUBES_BSP_LEAF_BYTES;
    const std::size_t split = bytes.size() - std::min(bytes.size(), leafBytes);
    ambient_cubes cubes;
    ambient_cubes_message(ambient_cubes_parse(bytes.data(), split, bytes.data() + split, bytes.size() - split, &cubes));
    AskCubes(cubes, query);
}

void AskProps(const staticprops_light &light, const Query &query) {
    staticprops_prop prop;
    if (staticprops_of_entity(&light, std::uint32_t(query.index), &prop) == 0)
        return;
    for (std::uint32_t i = 0; i < prop.meshCount; ++i) {
        const staticprops_mesh mesh = staticprops_get_mesh(&light, prop.firstMesh + i);
        for (std::uint32_t color = 0; color < mesh.colorCount; ++color) {
            float rgb[3];
            staticprops_color(&light, mesh.firstColor + color, rgb);
            RequireLight(rgb);
        }
    }
}

void AskPropsOfLump(std::span<const std::byte> lump, const Query &query) {
    staticprops_light light;
    staticprops_message(staticprops_parse(lump.data(), lump.size(), &light));
    AskProps(light, query);
    staticprops_crc(lump.data(), lump.size());
}

void AskHdr(const hdrlight &light, const Query &query) {
    float rgb[3];
    hdrlight_vertex(&light, std::uint32_t(query.index), rgb);
    for (const std::uint32_t side : {1u, 128u, std::uint32_t(query.index)})
        if (const unsigned char *page = hdrlight_page(&light, query.index & 1, side))
            hdrlight_color(page + 4 * (std::size_t(side) * side - 1), rgb);
    for (unsigned basis = 0; basis < 4; ++basis)
        if (const unsigned char *map = hdrlight_rnm_map(&light, query.index & 3, basis))
            hdrlight_color(map + 4 * (std::size_t(light.rnmSide) * light.rnmSide - 1), rgb);
}

/// Colors and encodings of directional light take any bits.
void AskDirectional(std::span<const std::byte> bytes, const Query &query) {
    std::array<float, 24> v{};
    std::memcpy(v.data(), bytes.data(), std::min(bytes.size(), sizeof v));
    std::array<unsigned char, 4> code{};
    std::memcpy(code.data(), bytes.data(), std::min(bytes.size(), sizeof code));
    const float *normal = query.normal.data(), *flat = query.position.data();
    float rgb[4], basis[3][3];
    directional_e5bgr9(std::uint32_t(query.index), rgb), directional_rgbe(code.data(), rgb);
    directional_exp32(code.data(), rgb), directional_texel(code.data(), rgb);
    directional_deluxe(v.data(), flat, normal, rgb);
    directional_rnm_basis(basis), directional_rnm_weights(normal, rgb);
    for (const auto decode : {directional_rnm_raw, directional_rnm_rescaled, directional_rnm_squared, directional_l1,
                              directional_l1_curved})
        decode(v.data(), normal, rgb);
    directional_ssbump(v.data(), v.data() + 3, query.radius, rgb), directional_ssbump_normal(v.data(), rgb);
    directional_ssbump_light(v.data(), normal);
    directional_sky_occlusion(v.data(), rgb);
}

/// Everything that is found in a whole file.
void AskFile(std::span<const std::byte> file, const Query &query) {
    for (const auto form : {SHGRID_ANY, SHGRID_UNIFORM, SHGRID_SPARSE, SHGRID_NAMED}) {
        shgrid_grid grid;
        shgrid_message(shgrid_load_form(file.data(), file.size(), form, &grid));
        AskGrid(grid, query);
    }
    ambient_cubes cubes;
    ambient_cubes_message(ambient_cubes_load(file.data(), file.size(), &cubes));
    AskCubes(cubes, query);
    staticprops_light props;
    staticprops_message(staticprops_load(file.data(), file.size(), &props));
    AskProps(props, query);
    hdrlight light;
    hdrlight_message(hdrlight_load(file.data(), file.size(), &light));
    AskHdr(light, query);
    bspx_file bsp;
    bspx_lump lump;
    if (bspx_open(file.data(), file.size(), &bsp) == BSPX_OK)
        for (unsigned slot = 0; slot < 24; ++slot)
            if (bspx_slot(&bsp, slot, &lump) == BSPX_OK && lump.size > 0)
                Require(lump.data >= bsp.data && lump.data + lump.size <= bsp.data + bsp.size, "a lump outside");
}

} // namespace
} // namespace q3::fuzz

// Byte 0: what is read. 32 bytes of the query. The rest: the bytes that are read.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    constexpr void (*kReaders[])(std::span<const std::byte>, const Query &) = {
        AskFile, AskGridOfLump, AskCubesOfLump, AskPropsOfLump, AskDirectional, AskTone};
    Input input(data, size);
    const std::size_t which = input.Choose(std::size(kReaders));
    const Query query{input.Take<std::array<float, 3>>(), input.Take<std::array<float, 3>>(),
                      input.Take<std::int32_t>(), input.Take<float>()};
    kReaders[which](input.Rest(), query);
    return 0;
}
