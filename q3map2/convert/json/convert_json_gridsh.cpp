// GPL-2.0-or-later. The uniform SH light grid as JSON.
#include "common/error.h"
#include "q3map2/convert/json/convert_json_bspx.h"
#include "q3map2/convert/json/convert_json_records.h"

#include <algorithm>
#include <utility>

namespace q3 {

namespace {

/// A point of the SH light grid takes at least this many bytes of text: 27 digits, 26 commas and 20 brackets are 73.
constexpr std::uintmax_t kMinPointText = 72;

template <typename Record> void WriteGridRecord(JsonWriter &writer, const Game &game, Record record) {
    JsonRecordWriter archive(writer, game);
    Describe(archive, record);
    archive.Finish();
}

template <typename Record> void ReadGridRecord(const JsonRecord &source, const JsonReadRules &rules, Record &record) {
    JsonRecordReader archive(source, rules);
    Describe(archive, record);
    archive.Finish();
}

// Avoids reallocations; the file size limits the memory that a wrong header can request.
void Reserve(const std::filesystem::path &path, LightGridSH &grid) {
    std::uintmax_t room = std::filesystem::file_size(path) / kMinPointText;
    for (const std::int32_t bound : grid.header.gridBounds)
        if (bound < 1 || std::uintmax_t(bound) > room)
            return;
    const auto &bounds = grid.header.gridBounds;
    const std::uintmax_t layer = std::uintmax_t(bounds[0]) * std::uintmax_t(bounds[1]);
    if (layer <= room && layer * std::uintmax_t(bounds[2]) <= room)
        grid.points.reserve(layer * std::uintmax_t(bounds[2]));
}

std::int32_t CountPoints(const std::filesystem::path &path, const LightGridSH &grid) {
    const auto &bounds = grid.header.gridBounds;
    std::uint64_t product = 1;
    for (const std::int32_t bound : bounds) {
        if (bound < 1)
            throw Error("{}: header: gridBounds: expected 3 integers of at least 1", path.string());
        // Limited, so that the next factor cannot overflow: no int32 counts more points.
        product = std::min<std::uint64_t>(product * std::uint64_t(bound), std::uint64_t(1) << 31);
    }
    if (product != grid.points.size())
        throw Error("{}: points: expected {} x {} x {} points as gridBounds says, found {}", path.string(), bounds[0],
                    bounds[1], bounds[2], grid.points.size());
    return std::int32_t(product);
}

} // namespace

void WriteJsonGridSH(FileReplacement &file, const Bsp &bsp, const Game &game) {
    const LightGridSH &grid = *bsp.gridSH;
    JsonWriter writer(file);
    writer.BeginObject();
    writer.Member(kJsonGridSHHeader);
    WriteGridRecord(writer, game, grid.header);
    writer.Member(kJsonGridSHPoints);
    writer.BeginList();
    for (const bspGridPointSH_t &point : grid.points) {
        writer.Element();
        WriteGridRecord(writer, game, point);
    }
    writer.EndList();
    writer.EndObject();
    writer.Finish();
}

void ReadJsonGridSH(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp) {
    LightGridSH grid;
    bool hasHeader = false, hasPoints = false;
    ReadJsonRecords(path, kJsonGridSHPoints, [&](const JsonRecord &source) {
        if (source.inList) {
            hasPoints = true;
            ReadGridRecord(source, rules, grid.points.emplace_back());
        } else if (source.name == kJsonGridSHHeader) {
            if (std::exchange(hasHeader, true))
                source.Fail("is given twice");
            ReadGridRecord(source, rules, grid.header);
            Reserve(path, grid);
        } else if (source.name == kJsonGridSHPoints) {
            source.Fail("expected an array");
        }
    });
    if (!hasHeader)
        throw Error("{}: {}: missing", path.string(), kJsonGridSHHeader);
    if (!hasPoints)
        throw Error("{}: {}: missing or empty", path.string(), kJsonGridSHPoints);
    grid.header.numPoints = CountPoints(path, grid);
    bsp.gridSH = std::move(grid);
}

} // namespace q3
