// GPL-2.0-or-later. A compiled map from a folder of JSON files.
#include "q3map2/convert/json/convert_json_pack.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/bspfile/bsp_layout.h"
#include "q3map2/bspfile/bsp_validate.h"
#include "q3map2/bspfile/bspx.h"
#include "q3map2/convert/json/convert_json_archive.h"
#include "q3map2/convert/json/convert_json_cubes.h"
#include "q3map2/convert/json/convert_json_files.h"
#include "q3map2/convert/json/convert_json_hdr.h"
#include "q3map2/convert/json/convert_json_props.h"
#include "q3map2/convert/json/convert_json_records.h"
#include "q3map2/convert/json/convert_json_sparse.h"

#include <algorithm>
#include <system_error>
#include <unordered_set>

namespace q3 {

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
