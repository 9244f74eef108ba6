// GPL-2.0-or-later. The BSPX lumps that have a JSON file each. See docs/reference/json.md.
#pragma once

#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/convert/json/convert_json_archive.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace q3 {

/// The file of a lump. Functions may be null where there is nothing to do.
struct JsonLump {
    BspxId id;
    std::string_view file;
    /// Writes the file. Errors: those of JsonWriter.
    void (*write)(FileReplacement &file, const Bsp &bsp, const Game &game);
    /// Reads it into its member. Errors: Error with file, member and what was expected.
    void (*read)(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp);
    /// False: the lump stays in hexadecimal, after a warning if it is damaged. Null: every lump fits.
    bool (*fitsFile)(const Bsp &bsp, Log &log);
    /// Reads what stayed in hexadecimal. Errors: Error without names.
    void (*readBytes)(std::span<const std::byte> bytes, Bsp &bsp);
};

// Members of the files of both SH grids.
inline constexpr std::string_view kJsonGridSHHeader = "header", kJsonGridSHPoints = "points";

// The functions of a lump are in a source of its own.
void WriteJsonGridSH(FileReplacement &file, const Bsp &bsp, const Game &game);
void ReadJsonGridSH(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp);
/// Appends each code to the list that is being written, as an E5BGR9 color of four numbers.
void WriteColorCodes(JsonWriter &writer, std::span<const std::uint32_t> codes, const Game &game);
void WriteJsonLightmaps(FileReplacement &file, const Bsp &bsp, const Game &game);
void ReadJsonLightmaps(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp);
void WriteJsonVertexLight(FileReplacement &file, const Bsp &bsp, const Game &game);
void ReadJsonVertexLight(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp);
void WriteJsonRnm(FileReplacement &file, const Bsp &bsp, const Game &game);
void ReadJsonRnm(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp);
void WriteJsonSparseGrid(FileReplacement &file, const Bsp &bsp, const Game &game);
void ReadJsonSparseGrid(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp);
void WriteJsonNamedGrid(FileReplacement &file, const Bsp &bsp, const Game &game);
void ReadJsonNamedGrid(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp);
/// Whether names and vertices are stored in the order of lights and polygons, without gaps, as this program does.
bool NamedFitsJson(const Bsp &bsp, Log &log);
void ReadNamedBytes(std::span<const std::byte> bytes, Bsp &bsp);
void WriteJsonCubes(FileReplacement &file, const Bsp &bsp, const Game &game);
void ReadJsonCubes(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp);
void WriteJsonProps(FileReplacement &file, const Bsp &bsp, const Game &game);
void ReadJsonProps(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp);
bool PropsFitJson(const Bsp &bsp, Log &log);
void ReadPropBytes(std::span<const std::byte> bytes, Bsp &bsp);

/// A row for each lump, in the order in which files are written.
inline constexpr JsonLump kJsonLumps[] = {
    {BspxId::LightGridSH, "GridPointsSH.json", WriteJsonGridSH, ReadJsonGridSH, nullptr, nullptr},
    {BspxId::LightmapsE5bgr9, "LightTexelsE5BGR9.json", WriteJsonLightmaps, ReadJsonLightmaps, nullptr, nullptr},
    {BspxId::VertexE5bgr9, "DrawVertE5BGR9.json", WriteJsonVertexLight, ReadJsonVertexLight, nullptr, nullptr},
    {BspxId::Rnm, "LightTexelsRNM.json", WriteJsonRnm, ReadJsonRnm, nullptr, nullptr},
    {BspxId::SparseGridSH, "GridPointsSHSparse.json", WriteJsonSparseGrid, ReadJsonSparseGrid, nullptr, nullptr},
    {BspxId::NamedGridSH, "GridPointsSHLights.json", WriteJsonNamedGrid, ReadJsonNamedGrid, NamedFitsJson,
     ReadNamedBytes},
    {BspxId::AmbientCubes, "AmbientCubes.json", WriteJsonCubes, ReadJsonCubes, nullptr, nullptr},
    {BspxId::PropLight, "PropLight.json", WriteJsonProps, ReadJsonProps, PropsFitJson, ReadPropBytes},
};
static_assert(HasRowOfEachLump(kJsonLumps));

} // namespace q3
