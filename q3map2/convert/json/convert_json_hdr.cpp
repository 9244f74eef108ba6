// GPL-2.0-or-later. HDR light of BSPX lumps as JSON.
#include "common/error.h"
#include "q3map2/convert/json/convert_json_bspx.h"
#include "q3map2/convert/json/convert_json_records.h"

#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

namespace {

constexpr std::string_view kJsonCodes = "colors";
constexpr std::string_view kJsonRnmStorage = "storage", kJsonRnmSide = "side", kJsonRnmPages = "lightmapNums";
constexpr std::string_view kJsonRnmRaw = "raw", kJsonRnmRescaled = "rescaled";

void WriteCodeFile(FileReplacement &file, std::span<const std::uint32_t> codes, const Game &game) {
    JsonWriter writer(file);
    writer.BeginObject();
    writer.Member(kJsonCodes);
    writer.BeginList();
    WriteColorCodes(writer, codes, game);
    writer.EndList();
    writer.EndObject();
    writer.Finish();
}

std::uint32_t ReadCode(const JsonRecord &source, const JsonReadRules &rules) {
    JsonE5bgr9 color;
    JsonRecordReader archive(source, rules);
    Describe(archive, color);
    archive.Finish();
    return color.code;
}

std::vector<std::uint32_t> ReadCodeFile(const std::filesystem::path &path, const JsonReadRules &rules) {
    std::vector<std::uint32_t> codes;
    ReadJsonRecords(path, kJsonCodes, [&](const JsonRecord &source) {
        if (source.inList)
            codes.push_back(ReadCode(source, rules));
        else if (source.name == kJsonCodes)
            source.Fail("expected an array");
    });
    if (codes.empty())
        throw Error("{}: {}: missing or empty", path.string(), kJsonCodes);
    return codes;
}

/// Reads the members of LIGHTING_RNM, then puts the colors into pages.
class RnmJsonReader {
  public:
    RnmJsonReader(const std::filesystem::path &path, const JsonReadRules &rules) : path_(path), rules_(rules) {}

    RnmLightmaps Read() {
        ReadJsonRecords(path_, kJsonCodes, [this](const JsonRecord &source) { Take(source); });
        const std::size_t texels = std::size_t(rnm_.header.side) * rnm_.header.side, maps = 3 * rnm_.pages.size();
        if (maps == 0 || texels == 0)
            throw Error("{}: {} or {}: missing", path_.string(), kJsonRnmPages, kJsonRnmSide);
        if (codes_.size() != maps * texels)
            throw Error("{}: {}: expected {} pages x 3 x {} x {}, found {}", path_.string(), kJsonCodes,
                        rnm_.pages.size(), rnm_.header.side, rnm_.header.side, codes_.size());
        auto from = codes_.begin();
        for (RnmPage &page : rnm_.pages)
            for (std::vector<std::uint32_t> &map : page.maps) {
                map.assign(from, from + std::ptrdiff_t(texels));
                from += std::ptrdiff_t(texels);
            }
        return std::move(rnm_);
    }

  private:
    /// Reads one top-level member, or one color.
    void Take(const JsonRecord &source) {
        if (source.inList) {
            codes_.push_back(ReadCode(source, rules_));
        } else if (source.name == kJsonRnmStorage) {
            const std::string_view word = source.Text(source.nodes[0]);
            if (source.nodes[0].kind != JsonNode::Text || (word != kJsonRnmRaw && word != kJsonRnmRescaled))
                source.Fail(fmt::format("expected \"{}\" or \"{}\"", kJsonRnmRaw, kJsonRnmRescaled));
            rnm_.header.storage = word == kJsonRnmRaw ? RnmStorage::Raw : RnmStorage::Rescaled;
        } else if (source.name == kJsonRnmSide) {
            rnm_.header.side = std::uint32_t(IntegerUpTo(source, source.nodes[0], std::int32_t(kMaxRnmSide)));
        } else if (source.name == kJsonRnmPages) {
            if (source.nodes[0].kind != JsonNode::Array)
                source.Fail("expected an array");
            for (std::size_t at = 1; at < source.nodes.size(); ++at)
                rnm_.pages.push_back({IntegerUpTo(source, source.nodes[at], INT32_MAX), {}});
            rnm_.header.pageCount = std::uint32_t(rnm_.pages.size());
        } else if (source.name == kJsonCodes) {
            source.Fail("expected an array");
        }
    }

    static std::int32_t IntegerUpTo(const JsonRecord &source, const JsonNode &node, std::int32_t most) {
        if (node.kind != JsonNode::Integer || node.integer < 0 || node.integer > most)
            source.Fail(fmt::format("expected an integer in 0..{}", most));
        return std::int32_t(node.integer);
    }

    const std::filesystem::path &path_;
    const JsonReadRules &rules_;
    RnmLightmaps rnm_;
    std::vector<std::uint32_t> codes_;
};

} // namespace

void WriteColorCodes(JsonWriter &writer, std::span<const std::uint32_t> codes, const Game &game) {
    for (const std::uint32_t code : codes) {
        writer.Element();
        JsonE5bgr9 color{code};
        JsonRecordWriter archive(writer, game);
        Describe(archive, color);
        archive.Finish();
    }
}

void WriteJsonRnm(FileReplacement &file, const Bsp &bsp, const Game &game) {
    const RnmLightmaps &rnm = *bsp.rnm;
    JsonWriter writer(file);
    writer.BeginObject();
    writer.Member(kJsonRnmStorage);
    writer.Value(rnm.header.storage == RnmStorage::Raw ? kJsonRnmRaw : kJsonRnmRescaled);
    writer.Member(kJsonRnmSide);
    writer.Value(std::int32_t(rnm.header.side));
    writer.Member(kJsonRnmPages);
    writer.BeginList();
    for (const RnmPage &page : rnm.pages) {
        writer.Element();
        writer.Value(page.lightmapNum);
    }
    writer.EndList();
    writer.Member(kJsonCodes);
    writer.BeginList();
    for (const RnmPage &page : rnm.pages)
        for (const std::vector<std::uint32_t> &map : page.maps)
            WriteColorCodes(writer, map, game);
    writer.EndList();
    writer.EndObject();
    writer.Finish();
}

void WriteJsonLightmaps(FileReplacement &file, const Bsp &bsp, const Game &game) {
    WriteCodeFile(file, bsp.lightmapsE5bgr9, game);
}

void ReadJsonLightmaps(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp) {
    bsp.lightmapsE5bgr9 = ReadCodeFile(path, rules);
}

void WriteJsonVertexLight(FileReplacement &file, const Bsp &bsp, const Game &game) {
    WriteCodeFile(file, bsp.vertexE5bgr9, game);
}

void ReadJsonVertexLight(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp) {
    bsp.vertexE5bgr9 = ReadCodeFile(path, rules);
}

void ReadJsonRnm(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp) {
    bsp.rnm = RnmJsonReader(path, rules).Read();
}

} // namespace q3
