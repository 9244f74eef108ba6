// GPL-2.0-or-later. HDR light of BSPX lumps as JSON. See docs/json.md.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/convert/json/convert_json_archive.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Name of the JSON file for a BSPX lump of HDR light; empty: `lump` is another one.
std::string_view JsonHdrFile(std::string_view lump);

/// Each writes one file. Errors: those of JsonWriter.
void WriteJsonCodes(const std::filesystem::path &path, std::span<const std::uint32_t> codes, const Game &game);
void WriteJsonRnm(const std::filesystem::path &path, const RnmLightmaps &rnm, const Game &game);

/// Reads the file of such a lump into its member. Errors: Error with file, member and what was expected.
void ReadJsonHdr(const std::filesystem::path &path, std::string_view lump, const JsonReadRules &rules, Bsp &bsp);

} // namespace q3
