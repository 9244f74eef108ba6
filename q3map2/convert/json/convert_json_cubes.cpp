// GPL-2.0-or-later. Ambient cubes as JSON.
#include "common/error.h"
#include "q3map2/convert/json/convert_json_bspx.h"
#include "q3map2/convert/json/convert_json_records.h"

namespace q3 {

namespace {

constexpr std::string_view kJsonCubeLeafs = "leafs", kJsonCubeSamples = "samples";

std::uint16_t CubeNumber(const JsonRecord &source, const JsonNode &node) {
    if (node.kind != JsonNode::Integer || node.integer < 0 || node.integer > UINT16_MAX)
        source.Fail(fmt::format("expected integers in 0..{}", UINT16_MAX));
    return std::uint16_t(node.integer);
}

/// A flat list: count and first of each leaf in turn.
std::vector<bspCubeLeaf_t> CubeLeafs(const JsonRecord &source) {
    if (source.nodes[0].kind != JsonNode::Array || source.nodes[0].count % 2 != 0)
        source.Fail("expected an array of pairs: count and first of each leaf");
    std::vector<bspCubeLeaf_t> leafs;
    for (std::size_t at = 1; at + 1 < source.nodes.size(); at += 2)
        leafs.push_back({CubeNumber(source, source.nodes[at]), CubeNumber(source, source.nodes[at + 1])});
    return leafs;
}

} // namespace

void WriteJsonCubes(FileReplacement &file, const Bsp &bsp, const Game &game) {
    const AmbientCubes &cubes = *bsp.ambientCubes;
    JsonWriter writer(file);
    writer.BeginObject();
    writer.Member(kJsonCubeLeafs);
    writer.BeginList();
    for (const bspCubeLeaf_t &leaf : cubes.leafs)
        for (const std::uint16_t number : {leaf.count, leaf.first}) {
            writer.Element();
            writer.Value(std::int32_t(number));
        }
    writer.EndList();
    writer.Member(kJsonCubeSamples);
    writer.BeginList();
    for (bspCubeSample_t sample : cubes.samples) {
        writer.Element();
        JsonRecordWriter archive(writer, game);
        Describe(archive, sample);
        archive.Finish();
    }
    writer.EndList();
    writer.EndObject();
    writer.Finish();
}

void ReadJsonCubes(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp) {
    AmbientCubes cubes;
    ReadJsonRecords(path, kJsonCubeSamples, [&](const JsonRecord &source) {
        if (source.inList) {
            JsonRecordReader archive(source, rules);
            Describe(archive, cubes.samples.emplace_back());
            archive.Finish();
        } else if (source.name == kJsonCubeLeafs) {
            cubes.leafs = CubeLeafs(source);
        } else if (source.name == kJsonCubeSamples) {
            source.Fail("expected an array");
        }
    });
    if (cubes.leafs.empty() || cubes.samples.empty())
        throw Error("{}: {} or {}: missing or empty", path.string(), kJsonCubeLeafs, kJsonCubeSamples);
    bsp.ambientCubes = std::move(cubes);
}

} // namespace q3
