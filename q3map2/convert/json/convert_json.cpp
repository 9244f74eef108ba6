// GPL-2.0-or-later. A compiled map as a folder of JSON files, and back. See docs/reference/json.md.
#include "q3map2/convert/json/convert_json.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/bspfile/bsp_validate.h"
#include "q3map2/bspfile/bspfile_rbsp.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/convert/json/convert_json_archive.h"
#include "q3map2/convert/json/convert_json_bspx.h"
#include "q3map2/convert/json/convert_json_records.h"

#include <algorithm>
#include <array>
#include <system_error>
#include <type_traits>
#include <unordered_set>

namespace q3 {

// ---- Unpacking ----

namespace {

namespace fs = std::filesystem;

/// Writes the files of one folder together: if one cannot be written, all old ones stay.
class Unpacker {
  public:
    Unpacker(const Bsp &bsp, const Game &game, const fs::path &folder, Log &log)
        : bsp_(bsp), game_(game), folder_(folder), log_(log) {}

    void Run() {
        written_.AddFolder(folder_);
        WriteFiles();
        written_.Commit();
        RemoveFiles();
    }

  private:
    void WriteFiles() {
        const bool hasStyles = bsp_.ident != kIbspIdent;
        ForEachJsonFile(bsp_, [&](std::string_view file, std::string_view prefix, const auto &records) {
            if constexpr (std::is_same_v<decltype(records), const std::vector<bspGridPoint_t> &>)
                if (!hasStyles)
                    return WriteRecords(file, prefix, WithColorsInAllSlots(records));
            WriteRecords(file, prefix, records);
        });
        WriteIf(hasStyles, kJsonFormat, [this] {
            WriteRecords(kJsonFormat, "format", std::vector<JsonFormat>{{std::string(bsp_.ident), bsp_.lightmapSide}});
        });
        WriteEntities();
        WriteIf(!bsp_.advertisements.empty(), kJsonAdvertisements,
                [this] { WriteRecords(kJsonAdvertisements, "Advertisement", bsp_.advertisements); });
        for (const JsonLump &lump : kJsonLumps) {
            const bool isWritten = RowOf(lump.id).has(bsp_) && (lump.fitsFile == nullptr || lump.fitsFile(bsp_, log_));
            inFile_[std::size_t(lump.id)] = isWritten;
            WriteIf(isWritten, lump.file, [&] { lump.write(Announce(lump.file), bsp_, game_); });
        }
        const std::vector<JsonBspxEntry> entries = BspxEntries();
        WriteIf(!entries.empty(), kJsonBspx, [&] { WriteRecords(kJsonBspx, "bspx", entries); });
    }

    /// Those of an earlier map, which -pack would read.
    void RemoveFiles() const {
        for (const std::string_view file : unwanted_) {
            std::error_code error;
            fs::remove(folder_ / file, error);
            if (error)
                log_.Warn("file of an earlier map", "{}: cannot be removed, and -json -pack would read it: {}",
                          (folder_ / file).string(), error.message());
        }
    }

    /// As NetRadiant's q3map2 writes points of IBSP maps.
    static std::vector<bspGridPoint_t> WithColorsInAllSlots(std::vector<bspGridPoint_t> points) {
        for (bspGridPoint_t &point : points) {
            point.ambient.fill(point.ambient[0]);
            point.directed.fill(point.directed[0]);
        }
        return points;
    }

    FileReplacement &Announce(std::string_view file) {
        const fs::path path = folder_ / file;
        log_.Print("writing {}\n", path.string());
        return written_.Add(path);
    }

    template <typename Write> void WriteIf(bool wanted, std::string_view file, const Write &write) {
        if (wanted)
            write();
        else
            unwanted_.push_back(file);
    }

    template <typename Record> void WriteRecord(JsonWriter &writer, Record record) const {
        JsonRecordWriter archive(writer, game_);
        Describe(archive, record);
        archive.Finish();
    }

    template <typename Record>
    void WriteRecords(std::string_view file, std::string_view prefix, const std::vector<Record> &records) {
        JsonWriter writer(Announce(file));
        writer.BeginObject();
        for (std::size_t i = 0; i < records.size(); i++) {
            writer.Member(prefix, i);
            WriteRecord(writer, records[i]);
        }
        writer.EndObject();
        writer.Finish();
    }

    void WriteEntities() {
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
        WriteIf(!same, kJsonEntityText,
                [this] { Announce(kJsonEntityText).Append(std::as_bytes(std::span(bsp_.entities))); });
    }

    bool IsInFile(BspxId id) const { return inFile_[std::size_t(id)]; }

    /// Lumps of other programs, and those without a file, as hexadecimal text.
    std::vector<JsonBspxEntry> BspxEntries() const {
        std::vector<JsonBspxEntry> entries;
        for (const BspxOutput &lump : WriteBspxLumps(bsp_)) {
            const BspxRow *row = FindBspxRow(lump.name);
            const bool inFile = row != nullptr && IsInFile(row->id);
            entries.push_back({std::string(lump.name), inFile ? "" : HexText(lump.bytes.Bytes()),
                               inFile ? std::string(RowOf(kJsonLumps, row->id).file) : ""});
        }
        return entries;
    }

    const Bsp &bsp_;
    const Game &game_;
    const fs::path &folder_;
    Log &log_;
    std::array<bool, kBspxIdCount> inFile_{}; ///< by BspxId
    FileSet written_;
    std::vector<std::string_view> unwanted_;
};

} // namespace

void UnpackJson(const Bsp &bsp, const Game &game, const fs::path &folder, Log &log) {
    Unpacker(bsp, game, folder, log).Run();
}

// ---- Packing ----

namespace {

constexpr const JsonLump &kUniformGrid = RowOf(kJsonLumps, BspxId::LightGridSH);

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
        ReadFormat();
        if (Exists(kJsonAdvertisements))
            ReadRecords(folder_ / kJsonAdvertisements, bsp_.advertisements);
        if (Exists(kUniformGrid.file))
            kUniformGrid.read(folder_ / kUniformGrid.file, rules_, bsp_);
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

    void ReadFormat() {
        const auto setFormat = [this](std::string_view ident) {
            bsp_.ident = ident;
            bsp_.gridSHContainer = ident == kIbspIdent ? GridSHContainer::Lump : GridSHContainer::Bspx;
            bsp_.lightmapSide = ident == kFbspIdent ? FbspLightmapSide(StoredWorld(bsp_.entities)) : kLightmapSide;
        };
        setFormat(rules_.game.bspIdent);
        if (!Exists(kJsonFormat))
            return;
        ReadJsonRecords(folder_ / kJsonFormat, "", [&](const JsonRecord &source) {
            JsonFormat format;
            ReadRecord(source, format);
            constexpr std::array kIdents{kRbspIdent, kFbspIdent};
            const auto ident = std::ranges::find(kIdents, format.ident);
            if (ident == kIdents.end())
                source.Fail("ident: expected RBSP or FBSP");
            setFormat(*ident);
            if (format.lightmapSide != bsp_.lightmapSide)
                source.Fail(fmt::format("lightmapSide: expected {}, which entities.json gives", bsp_.lightmapSide));
        });
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

    void ReadBspx() {
        const fs::path path = folder_ / kJsonBspx;
        std::unordered_set<std::string> seen;
        ReadJsonRecords(path, "", [&](const JsonRecord &source) {
            JsonBspxEntry entry;
            ReadRecord(source, entry);
            if (entry.name.size() > kBspxNameBytes || entry.name.find('\0') != entry.name.npos)
                source.Fail(fmt::format("name: expected at most {} bytes without NUL", kBspxNameBytes));
            const BspxRow *row = FindBspxRow(entry.name);
            // A file of an unknown lump is an error, which ReadBspxGrid reports.
            if ((row != nullptr && row->id == BspxId::LightGridSH) || (row == nullptr && !entry.file.empty())) {
                ReadBspxGrid(source, entry);
                return;
            }
            if (!seen.insert(entry.name).second)
                source.Fail(fmt::format("name: a lump {} is already there", ShownText(entry.name)));
            if (row == nullptr)
                bsp_.bspx.push_back({entry.name, HexBytes(source, entry)});
            else
                ReadBspxMember(source, entry, RowOf(kJsonLumps, row->id));
        });
    }

    static std::vector<std::byte> HexBytes(const JsonRecord &source, const JsonBspxEntry &entry) {
        std::vector<std::byte> bytes;
        if (!ParseHexText(entry.bytes, bytes))
            source.Fail("bytes: expected pairs of hexadecimal digits");
        return bytes;
    }

    /// The uniform SH grid has a file whether or not it is in the BSPX directory.
    void ReadBspxGrid(const JsonRecord &source, const JsonBspxEntry &entry) {
        if (entry.name != kBspxLightGridSH || entry.file != kUniformGrid.file)
            source.Fail(fmt::format("expected the name {} with the file {}", kBspxLightGridSH, kUniformGrid.file));
        if (!bsp_.gridSH)
            source.Fail(fmt::format("file: there is no {}", kUniformGrid.file));
        bsp_.gridSHContainer = GridSHContainer::Bspx;
    }

    void ReadBspxMember(const JsonRecord &source, const JsonBspxEntry &entry, const JsonLump &lump) {
        if (entry.file.empty() && lump.readBytes != nullptr) {
            try {
                lump.readBytes(HexBytes(source, entry), bsp_);
            } catch (const Error &error) {
                throw Error("{}: BSPX lump {}: {}", folder_.string(), entry.name, error.what());
            }
            return;
        }
        if (entry.file != lump.file)
            source.Fail(fmt::format("expected the file {}", lump.file));
        lump.read(folder_ / lump.file, rules_, bsp_);
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
