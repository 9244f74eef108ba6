// GPL-2.0-or-later. A compiled map as a folder of JSON files, and back. See docs/json.md.
#include "q3map2/convert/json/convert_json.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/bspfile/bsp_validate.h"
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "q3map2/bspfile/bspx.h"
#include "q3map2/convert/json/convert_json_archive.h"
#include "q3map2/convert/json/convert_json_cubes.h"
#include "q3map2/convert/json/convert_json_hdr.h"
#include "q3map2/convert/json/convert_json_props.h"
#include "q3map2/convert/json/convert_json_records.h"
#include "q3map2/convert/json/convert_json_sparse.h"

#include <algorithm>
#include <system_error>
#include <unordered_set>

namespace q3 {

// ---- A compiled map as a folder of JSON files ----

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

// ---- A compiled map from a folder of JSON files ----

namespace {

namespace fs = std::filesystem;

/// A point of the SH light grid takes at least this many bytes of text: 27 digits, commas and brackets.
constexpr std::uintmax_t kMinPointText = 72;

/// Reads the files of one folder.
class Packer {
  public:
    Packer(const fs::path &folder, const Game &game, const PackJsonOptions &options, Log &log)
        : folder_(folder), rules_{game, options, log} {}

    Bsp Run() {
        ForEachJsonFile(bsp_, [this](std::string_view file, std::string_view, auto &records) {
            ReadRecords(folder_ / file, records);
        });
        ReadEntities();
        if (Exists(kJsonAdvertisements))
            ReadRecords(folder_ / kJsonAdvertisements, bsp_.advertisements);
        if (Exists(kJsonGridSH))
            ReadGridSH();
        if (Exists(kJsonBspx))
            ReadBspx();
        ValidateBsp(bsp_, folder_.string(), rules_.log);
        return std::move(bsp_);
    }

  private:
    bool Exists(std::string_view file) const {
        std::error_code error;
        const bool there = fs::exists(folder_ / file, error);
        if (error)
            throw Error("{}: cannot read: {}", (folder_ / file).string(), error.message());
        return there;
    }

    template <typename Record> void ReadRecord(const JsonRecord &source, Record &record) const {
        JsonRecordReader archive(source, rules_);
        Describe(archive, record);
        archive.Finish();
    }

    template <typename Record> void ReadRecords(const fs::path &path, std::vector<Record> &records) const {
        ReadJsonRecords(path, "", [&](const JsonRecord &source) { ReadRecord(source, records.emplace_back()); });
    }

    void ReadEntities() {
        std::vector<Entity> entities;
        ReadRecords(folder_ / kJsonEntities, entities);
        bsp_.entities = FormatEntities(entities);
        if (Exists(kJsonEntityText))
            ReadEntityText(entities);
    }

    // Users edit entities.json, so the text is used only if it parses to the same pairs.
    void ReadEntityText(const std::vector<Entity> &entities) {
        const fs::path path = folder_ / kJsonEntityText;
        std::string text = ReadTextFile(path);
        if (text.find('\0') != text.npos)
            throw Error("{}: expected text without NUL bytes", path.string());
        std::vector<Entity> parsed;
        try {
            parsed = ParseEntities(text, path.string());
        } catch (const Error &error) {
            rules_.log.Warn("entity text", "{}", error.what());
        }
        if (std::ranges::equal(parsed, entities, {}, &Entity::pairs, &Entity::pairs))
            bsp_.entities = std::move(text);
        else
            rules_.log.Warn("entity text", "{} is ignored: {} has other pairs", path.string(), kJsonEntities);
    }

    void ReadGridSH() {
        const fs::path path = folder_ / kJsonGridSH;
        LightGridSH grid;
        bool header = false, points = false;
        ReadJsonRecords(path, kJsonGridSHPoints, [&](const JsonRecord &source) {
            if (source.inList) {
                points = true;
                ReadRecord(source, grid.points.emplace_back());
            } else if (source.name == kJsonGridSHHeader) {
                if (std::exchange(header, true))
                    source.Fail("is given twice");
                ReadRecord(source, grid.header);
                Reserve(path, grid);
            } else if (source.name == kJsonGridSHPoints) {
                source.Fail("expected an array");
            }
        });
        if (!header)
            throw Error("{}: {}: missing", path.string(), kJsonGridSHHeader);
        if (!points)
            throw Error("{}: {}: missing or empty", path.string(), kJsonGridSHPoints);
        grid.header.numPoints = CountPoints(path, grid);
        bsp_.gridSH = std::move(grid);
    }

    // Avoids reallocations; the file size limits the memory that a wrong header can request.
    static void Reserve(const fs::path &path, LightGridSH &grid) {
        std::uintmax_t room = fs::file_size(path) / kMinPointText;
        for (const std::int32_t bound : grid.header.gridBounds)
            if (bound < 1 || std::uintmax_t(bound) > room)
                return;
        const auto &bounds = grid.header.gridBounds;
        const std::uintmax_t layer = std::uintmax_t(bounds[0]) * std::uintmax_t(bounds[1]);
        if (layer <= room && layer * std::uintmax_t(bounds[2]) <= room)
            grid.points.reserve(layer * std::uintmax_t(bounds[2]));
    }

    static std::int32_t CountPoints(const fs::path &path, const LightGridSH &grid) {
        const auto &bounds = grid.header.gridBounds;
        std::uint64_t product = 1;
        for (const std::int32_t bound : bounds) {
            if (bound < 1)
                throw Error("{}: header: gridBounds: expected 3 integers of at least 1", path.string());
            product = std::min<std::uint64_t>(product * std::uint64_t(bound), std::uint64_t(1) << 31);
        }
        if (product != grid.points.size())
            throw Error("{}: points: expected {} x {} x {} points as gridBounds says, found {}", path.string(),
                        bounds[0], bounds[1], bounds[2], grid.points.size());
        return std::int32_t(product);
    }

    void ReadBspx() {
        const fs::path path = folder_ / kJsonBspx;
        std::unordered_set<std::string> seen;
        ReadJsonRecords(path, "", [&](const JsonRecord &source) {
            JsonBspxEntry entry;
            ReadRecord(source, entry);
            if (entry.name.size() > kBspxNameBytes || entry.name.find('\0') != entry.name.npos)
                source.Fail(fmt::format("name: expected at most {} bytes without NUL", kBspxNameBytes));
            if (ReadBspxMember(source, entry, kBspxAmbientCubes, kJsonCubes, bsp_.ambientCubes, ReadJsonCubes) ||
                ReadBspxMember(source, entry, kBspxSparseGridSH, kJsonSparseGrid, bsp_.sparseGridSH,
                               ReadJsonSparseGrid))
                return;
            const bool isPropFile = entry.name == kBspxPropLight && !entry.file.empty();
            if (entry.name == kBspxLightGridSH ||
                (!entry.file.empty() && JsonHdrFile(entry.name).empty() && !isPropFile)) {
                ReadBspxGrid(source, entry);
                return;
            }
            if (!seen.insert(entry.name).second)
                source.Fail(fmt::format("name: a lump {} is already there", ShownText(entry.name)));
            if (!JsonHdrFile(entry.name).empty()) {
                ReadBspxHdr(source, entry);
                return;
            }
            BspxLump lump{entry.name, {}};
            if (isPropFile)
                lump.data = ReadBspxProps(source, entry);
            else if (!ParseHexText(entry.bytes, lump.data))
                source.Fail("bytes: expected pairs of hexadecimal digits");
            bsp_.bspx.push_back(std::move(lump));
        });
    }

    /// Reads the file of a lump that is a member of the map. False: the entry is another lump.
    template <typename Member, typename Read>
    bool ReadBspxMember(const JsonRecord &source, const JsonBspxEntry &entry, std::string_view lump,
                        std::string_view file, std::optional<Member> &member, const Read &read) const {
        if (entry.name != lump)
            return false;
        if (entry.file != file)
            source.Fail(fmt::format("expected the file {}", file));
        if (member)
            source.Fail(fmt::format("name: a lump {} is already there", lump));
        member = read(folder_ / file, rules_);
        return true;
    }

    void ReadBspxGrid(const JsonRecord &source, const JsonBspxEntry &entry) {
        if (entry.name != kBspxLightGridSH || entry.file != kJsonGridSH)
            source.Fail(fmt::format("expected the name {} with the file {}", kBspxLightGridSH, kJsonGridSH));
        if (!bsp_.gridSH)
            source.Fail(fmt::format("file: there is no {}", kJsonGridSH));
        bsp_.gridSHContainer = GridSHContainer::Bspx;
    }

    std::vector<std::byte> ReadBspxProps(const JsonRecord &source, const JsonBspxEntry &entry) const {
        if (entry.file != kJsonPropLight)
            source.Fail(fmt::format("expected the file {}", kJsonPropLight));
        return EncodePropLight(ReadJsonProps(folder_ / kJsonPropLight));
    }

    void ReadBspxHdr(const JsonRecord &source, const JsonBspxEntry &entry) {
        const std::string_view file = JsonHdrFile(entry.name);
        if (entry.file != file)
            source.Fail(fmt::format("expected the file {}", file));
        ReadJsonHdr(folder_ / file, entry.name, rules_, bsp_);
    }

    const fs::path &folder_;
    JsonReadRules rules_;
    Bsp bsp_;
};

} // namespace

Bsp PackJson(const fs::path &folder, const Game &game, const PackJsonOptions &options, Log &log) {
    return Packer(folder, game, options, log).Run();
}

} // namespace q3
