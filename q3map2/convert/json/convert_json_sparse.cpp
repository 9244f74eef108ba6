// GPL-2.0-or-later. The sparse SH light grid as JSON.
#include "common/error.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "q3map2/convert/json/convert_json_bspx.h"
#include "q3map2/convert/json/convert_json_records.h"

#include <algorithm>
#include <array>
#include <utility>

namespace q3 {

namespace {

constexpr std::string_view kJsonSparseNodes = "nodes";

constexpr std::size_t kNodeNumbers = 4; ///< of a node: inner, stored, hanging, scale

template <typename JsonArchive> void DescribeSparse(JsonArchive &a, bspSparseGridHeader_t &header) {
    auto levels = std::int32_t(header.levels);
    a.Field("mins", header.mins);
    a.Field("cell", header.cell);
    a.Field("roots", header.roots);
    a.Field("levels", levels);
    header.levels = std::uint32_t(levels);
}

/// A point of the sparse SH grid: mantissas of red, green and blue and the exponent of coefficient 0, then the steps of
/// coefficients 1 to 8.
template <typename JsonArchive> void DescribeSparse(JsonArchive &a, SparseGridPoint &point) {
    std::array<std::int32_t, 28> numbers{};
    for (std::uint32_t i = 0; i < 4; ++i)
        numbers[i] = std::int32_t(point.mean >> 9 * i & std::uint32_t(kJsonMaxMantissa));
    std::ranges::copy(point.bands, numbers.begin() + 4);
    a.Whole(numbers);
    point.mean = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::int32_t number = numbers[i];
        a.Check(i < 4 ? number >= 0 && number <= (i < 3 ? kJsonMaxMantissa : kJsonMaxExponent)
                      : number >= INT8_MIN && number <= INT8_MAX,
                "expected three mantissas in 0..511, an exponent in 0..31 and 24 steps in -128..127");
        if (i < 4)
            point.mean |= std::uint32_t(number) << 9 * i;
        else
            point.bands[i - 4] = std::int8_t(number);
    }
}

/// The nodes from a flat list with inner, stored, hanging and scale of each in turn. Errors: another form.
std::vector<SparseGridNode> SparseNodes(const JsonRecord &source) {
    if (source.nodes[0].kind != JsonNode::Array || source.nodes[0].count % kNodeNumbers != 0)
        source.Fail("expected an array of inner, stored, hanging and scale of each node");
    const auto byte = [&](std::size_t at) {
        const JsonNode &node = source.nodes[at];
        if (node.kind != JsonNode::Integer || node.integer < 0 || node.integer > UINT8_MAX)
            source.Fail(fmt::format("expected integers in 0..{}", UINT8_MAX));
        return std::uint8_t(node.integer);
    };
    std::vector<SparseGridNode> nodes; // NumberSparseNodes sets their first two members
    for (std::size_t at = 1; at + kNodeNumbers <= source.nodes.size(); at += kNodeNumbers)
        nodes.push_back({0, 0, byte(at), byte(at + 1), byte(at + 2), byte(at + 3)});
    return nodes;
}

} // namespace

void WriteJsonSparseGrid(FileReplacement &file, const Bsp &bsp, const Game &game) {
    const SparseGridSH &grid = *bsp.sparseGridSH;
    JsonWriter writer(file);
    const auto record = [&](auto value) {
        JsonRecordWriter archive(writer, game);
        DescribeSparse(archive, value);
        archive.Finish();
    };
    writer.BeginObject();
    writer.Member(kJsonGridSHHeader);
    record(HeaderOf(grid));
    writer.Member(kJsonSparseNodes);
    writer.BeginList();
    for (const SparseGridNode &node : grid.nodes)
        for (const std::uint8_t number : {node.inner, node.stored, node.hanging, node.scale}) {
            writer.Element();
            writer.Value(std::int32_t(number));
        }
    writer.EndList();
    writer.Member(kJsonGridSHPoints);
    writer.BeginList();
    for (const SparseGridPoint &point : grid.points) {
        writer.Element();
        record(point);
    }
    writer.EndList();
    writer.EndObject();
    writer.Finish();
}

void ReadJsonSparseGrid(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp) {
    SparseGridSH grid;
    bool hasHeader = false;
    const auto read = [&](const JsonRecord &source, auto &record) {
        JsonRecordReader archive(source, rules);
        DescribeSparse(archive, record);
        archive.Finish();
    };
    ReadJsonRecords(path, kJsonGridSHPoints, [&](const JsonRecord &source) {
        if (source.inList) {
            read(source, grid.points.emplace_back());
        } else if (source.name == kJsonGridSHHeader) {
            if (std::exchange(hasHeader, true))
                source.Fail("is given twice");
            bspSparseGridHeader_t head;
            read(source, head);
            grid = {head.mins,
                    head.cell,
                    head.roots,
                    std::int32_t(head.levels),
                    std::move(grid.nodes),
                    std::move(grid.points)};
        } else if (source.name == kJsonSparseNodes) {
            grid.nodes = SparseNodes(source);
        } else if (source.name == kJsonGridSHPoints) {
            source.Fail("expected an array");
        }
    });
    if (!hasHeader || grid.nodes.empty())
        throw Error("{}: {} or {}: missing or empty", path.string(), kJsonGridSHHeader, kJsonSparseNodes);
    NumberSparseNodes(grid);
    CheckSparseGrid(grid, path.string());
    bsp.sparseGridSH = std::move(grid);
}

} // namespace q3
