// GPL-2.0-or-later. Light at the vertices of static props: the BSPX lump STATIC_PROP_LIGHT.
#pragma once

#include "q3map2/bspfile/bsp.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

inline constexpr std::string_view kBspxPropLight = "STATIC_PROP_LIGHT";

/// Head of the lump. Props, meshes and colors follow.
struct bspPropLightHeader_t {
    std::array<char, 4> magic{'S', 'P', 'L', '1'};
    std::uint32_t version = 1;
    std::uint32_t propCount = 0, meshCount = 0, colorCount = 0;
};
/// One prop. Props are in ascending order of entities, and the meshes of each follow those of the one before.
struct bspPropLight_t {
    std::uint32_t entity = 0;   ///< number in the entities lump
    std::uint32_t nameCrc = 0;  ///< Crc32 of the value of its key "model", in lower case
    std::uint32_t modelCrc = 0; ///< Crc32 of the bytes of the model file
    std::uint32_t firstMesh = 0, meshCount = 0;
};
/// Colors of the vertices of a mesh; they follow those of the mesh before.
struct bspPropMesh_t {
    std::uint32_t firstColor = 0, colorCount = 0;
};
static_assert(kPinned<bspPropLightHeader_t, 20> && kPinned<bspPropLight_t, 20> && kPinned<bspPropMesh_t, 8>);

/// The lump as records.
struct PropLight {
    std::vector<bspPropLight_t> props;
    std::vector<bspPropMesh_t> meshes;
    std::vector<std::uint32_t> colors; ///< E5BGR9, unit scale
};

/// CRC-32 of ISO 3309, as zip archives have it.
std::uint32_t Crc32(std::span<const std::byte> bytes);
/// bspPropLight_t::nameCrc of a model.
std::uint32_t ModelNameCrc(std::string_view model);

/// The bytes of the lump. Errors: more than 2^32 - 1 of anything.
std::vector<std::byte> EncodePropLight(const PropLight &light);
/// Errors: another magic or version, a length that does not fit the counts, props or meshes out of order.
PropLight DecodePropLight(std::span<const std::byte> lump);

/// The lump of the map; null: it has none.
const BspxLump *FindPropLight(const Bsp &bsp);
/// Replaces the lump, or removes it.
void SetPropLight(Bsp &bsp, const std::optional<PropLight> &light);
/// What is wrong with the lump or does not fit the entities of the map; empty: nothing.
std::string PropLightFault(const Bsp &bsp);

} // namespace q3
