// GPL-2.0-or-later. A compiled map as a folder of JSON files.
#include "q3map2/convert/json/convert_json.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/convert/json/convert_json_archive.h"
#include "q3map2/convert/json/convert_json_cubes.h"
#include "q3map2/convert/json/convert_json_files.h"
#include "q3map2/convert/json/convert_json_hdr.h"
#include "q3map2/convert/json/convert_json_props.h"
#include "q3map2/convert/json/convert_json_records.h"
#include "q3map2/convert/json/convert_json_sparse.h"

#include <system_error>

namespace q3 {

namespace {

namespace fs = std::filesystem;

/// Writes the files of one folder.
class Unpacker {
  public:
    Unpacker(const Bsp &bsp, const Game &game, const fs::path &folder, Log &log)
        : bsp_(bsp), game_(game), folder_(folder), log_(log) {}

    void Run() {
        ForEachJsonFile(bsp_, [this](std::string_view file, std::string_view prefix, const auto &records) {
            WriteRecords(file, prefix, records);
        });
        WriteEntities();
        WriteIf(!bsp_.advertisements.empty(), kJsonAdvertisements,
                [this] { WriteRecords(kJsonAdvertisements, "Advertisement", bsp_.advertisements); });
        WriteIf(bsp_.gridSH.has_value(), kJsonGridSH, [this] { WriteGridSH(*bsp_.gridSH); });
        const bool gridInBspx = bsp_.gridSH && bsp_.gridSHContainer == GridSHContainer::Bspx;
        const auto codes = [this](std::string_view file, const std::vector<std::uint32_t> &all) {
            WriteIf(!all.empty(), file, [&] { WriteJsonCodes(Announce(file), all, game_); });
        };
        codes(kJsonLightmapsE5bgr9, bsp_.lightmapsE5bgr9);
        codes(kJsonVertexE5bgr9, bsp_.vertexE5bgr9);
        WriteIf(bsp_.rnm.has_value(), kJsonRnm, [this] { WriteJsonRnm(Announce(kJsonRnm), *bsp_.rnm, game_); });
        WriteIf(bsp_.sparseGridSH.has_value(), kJsonSparseGrid,
                [this] { WriteJsonSparseGrid(Announce(kJsonSparseGrid), *bsp_.sparseGridSH, game_); });
        WriteIf(bsp_.ambientCubes.has_value(), kJsonCubes,
                [this] { WriteJsonCubes(Announce(kJsonCubes), *bsp_.ambientCubes, game_); });
        const std::optional<PropLight> props = PropLightForFile();
        WriteIf(props.has_value(), kJsonPropLight, [&] { WriteJsonProps(Announce(kJsonPropLight), *props, game_); });
        const std::vector<JsonBspxEntry> entries = BspxEntries(gridInBspx, props.has_value());
        WriteIf(!entries.empty(), kJsonBspx, [&] { WriteRecords(kJsonBspx, "bspx", entries); });
    }

  private:
    fs::path Announce(std::string_view file) const {
        const fs::path path = folder_ / file;
        log_.Print("writing {}\n", path.string());
        return path;
    }

    /// Writes the file, or removes one left from an earlier map, which -pack would read.
    template <typename Write> void WriteIf(bool wanted, std::string_view file, const Write &write) const {
        if (wanted) {
            write();
            return;
        }
        std::error_code error;
        fs::remove(folder_ / file, error);
        if (error)
            throw Error("{}: cannot remove this file of an earlier map: {}", (folder_ / file).string(),
                        error.message());
    }

    template <typename Record> void WriteRecord(JsonWriter &writer, Record record) const {
        JsonRecordWriter archive(writer, game_);
        Describe(archive, record);
        archive.Finish();
    }

    template <typename Record>
    void WriteRecords(std::string_view file, std::string_view prefix, const std::vector<Record> &records) const {
        JsonWriter writer(Announce(file));
        writer.BeginObject();
        for (std::size_t i = 0; i < records.size(); i++) {
            writer.Member(prefix, i);
            WriteRecord(writer, records[i]);
        }
        writer.EndObject();
        writer.Finish();
    }

    void WriteEntities() const {
        std::vector<Entity> entities;
        bool same = false;
        try {
            entities = ParseEntities(bsp_.entities, "entity lump");
            same = FormatEntities(entities) == bsp_.entities;
        } catch (const Error &error) {
            log_.Warn("entity text", "{}: the text goes to {} as it is, no entity to {}", error.what(), kJsonEntityText,
                      kJsonEntities);
        }
        WriteRecords(kJsonEntities, "entity", entities);
        WriteIf(!same, kJsonEntityText, [this] { ReplaceTextFile(Announce(kJsonEntityText), bsp_.entities); });
    }

    void WriteGridSH(const LightGridSH &grid) const {
        JsonWriter writer(Announce(kJsonGridSH));
        writer.BeginObject();
        writer.Member(kJsonGridSHHeader);
        WriteRecord(writer, grid.header);
        writer.Member(kJsonGridSHPoints);
        writer.BeginList();
        for (const bspGridPointSH_t &point : grid.points) {
            writer.Element();
            WriteRecord(writer, point);
        }
        writer.EndList();
        writer.EndObject();
        writer.Finish();
    }

    std::optional<PropLight> PropLightForFile() const {
        const BspxLump *lump = FindPropLight(bsp_);
        if (lump == nullptr)
            return {};
        std::string fault;
        std::optional<PropLight> light = JsonPropLight(*lump, fault);
        if (!fault.empty())
            log_.Warn(kBspxPropLight, "BSPX lump {} stays in hexadecimal: {}", kBspxPropLight, fault);
        return light;
    }

    /// propsInFile: the first prop light lump is written to kJsonPropLight, not as hexadecimal text.
    std::vector<JsonBspxEntry> BspxEntries(bool gridInBspx, bool propsInFile) const {
        std::vector<JsonBspxEntry> entries;
        for (const BspxLump &lump : bsp_.bspx) {
            const bool inOwnFile = propsInFile && &lump == FindPropLight(bsp_);
            entries.push_back(
                {lump.name, inOwnFile ? "" : HexText(lump.data), inOwnFile ? std::string(kJsonPropLight) : ""});
        }
        const auto inFile = [&](bool wanted, std::string_view lump, std::string_view file) {
            if (wanted)
                entries.push_back({std::string(lump), "", std::string(file)});
        };
        inFile(gridInBspx, kBspxLightGridSH, kJsonGridSH);
        inFile(!bsp_.lightmapsE5bgr9.empty(), kBspxLightmapsE5bgr9, kJsonLightmapsE5bgr9);
        inFile(!bsp_.vertexE5bgr9.empty(), kBspxVertexE5bgr9, kJsonVertexE5bgr9);
        inFile(bsp_.rnm.has_value(), kBspxRnm, kJsonRnm);
        inFile(bsp_.sparseGridSH.has_value(), kBspxSparseGridSH, kJsonSparseGrid);
        inFile(bsp_.ambientCubes.has_value(), kBspxAmbientCubes, kJsonCubes);
        return entries;
    }

    const Bsp &bsp_;
    const Game &game_;
    const fs::path &folder_;
    Log &log_;
};

} // namespace

void UnpackJson(const Bsp &bsp, const Game &game, const fs::path &folder, Log &log) {
    MakeFolder(folder);
    Unpacker(bsp, game, folder, log).Run();
}

} // namespace q3
