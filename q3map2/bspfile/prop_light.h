// GPL-2.0-or-later. Light at the vertices of static props: the BSPX lump STATIC_PROP_LIGHT.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// CRC-32 of ISO 3309, as zip archives have it.
std::uint32_t Crc32(std::span<const std::byte> bytes);
/// bspPropLight_t::nameCrc of a model.
std::uint32_t ModelNameCrc(std::string_view model);

/// The bytes of the lump. Errors: more than 2^32 - 1 of anything.
std::vector<std::byte> EncodePropLight(const PropLight &light);
/// Errors: another magic or version, a length that does not fit the counts, props or meshes out of order.
PropLight DecodePropLight(std::span<const std::byte> lump);

/// What is wrong with the light or does not fit the entities of the map; empty: nothing.
std::string PropLightFault(const Bsp &bsp);

/// Reads the lump of a map. A damaged one gives nothing, with a warning.
std::optional<PropLight> ReadPropLight(const BspxSource &from);
/// The bytes of the lump. Errors: as EncodePropLight.
ByteRanges PropLightRanges(const PropLight &light);

} // namespace q3
