// GPL-2.0-or-later. Light of static props as JSON.
#include "common/error.h"
#include "q3map2/bspfile/prop_light.h"
#include "q3map2/convert/json/convert_json_bspx.h"
#include "q3map2/convert/json/convert_json_records.h"

#include <charconv>

namespace q3 {

namespace {

constexpr std::string_view kJsonProps = "props";
constexpr std::string_view kPropEntity = "entity", kPropNameCrc = "nameCrc", kPropModelCrc = "modelCrc",
                           kPropMeshes = "meshes";

std::string CrcText(std::uint32_t crc) {
    return fmt::format("0x{:08x}", crc);
}

/// Reads one prop and appends it to `light`.
class PropReader {
  public:
    PropReader(const JsonRecord &source, PropLight &light) : source_(source), light_(light) {}

    void Read() {
        bspPropLight_t prop;
        const JsonNode &entity = Member(kPropEntity);
        if (entity.kind != JsonNode::Integer || entity.integer < 0 || entity.integer > INT32_MAX)
            Fail(kPropEntity, fmt::format("expected an integer in 0..{}", INT32_MAX));
        prop.entity = std::uint32_t(entity.integer);
        prop.nameCrc = Crc(kPropNameCrc);
        prop.modelCrc = Crc(kPropModelCrc);
        prop.firstMesh = std::uint32_t(light_.meshes.size());
        const JsonNode &meshes = Member(kPropMeshes);
        if (meshes.kind != JsonNode::Array)
            Fail(kPropMeshes, "expected an array of meshes");
        prop.meshCount = std::uint32_t(meshes.count);
        for (std::size_t at = Index(meshes) + 1; at < meshes.next; at = source_.nodes[at].next)
            ReadMesh(at);
        light_.props.push_back(prop);
    }

  private:
    [[noreturn]] void Fail(std::string_view member, std::string_view text) const {
        source_.Fail(fmt::format("{}: {}", member, text));
    }
    std::size_t Index(const JsonNode &node) const { return std::size_t(&node - source_.nodes.data()); }

    const JsonNode &Member(std::string_view name) const {
        if (source_.nodes[0].kind != JsonNode::Object)
            source_.Fail("expected an object");
        const std::size_t found = source_.Find(0, name);
        if (found == 0)
            Fail(name, "missing");
        return source_.nodes[found];
    }

    std::uint32_t Crc(std::string_view name) const {
        const JsonNode &node = Member(name);
        const std::string_view text = node.kind == JsonNode::Text ? source_.Text(node) : std::string_view();
        std::uint32_t crc = 0;
        const char *const end = text.data() + text.size();
        constexpr std::size_t kCrcText = 10; // bytes of "0x" and eight digits
        if (text.size() != kCrcText || !text.starts_with("0x") ||
            std::from_chars(text.data() + 2, end, crc, 16).ptr != end)
            Fail(name, "expected 0x and eight hexadecimal digits");
        return crc;
    }

    void ReadMesh(std::size_t at) {
        const JsonNode &mesh = source_.nodes[at];
        if (mesh.kind != JsonNode::Array)
            Fail(kPropMeshes, "expected an array of colors for each mesh");
        light_.meshes.push_back({std::uint32_t(light_.colors.size()), std::uint32_t(mesh.count)});
        for (std::size_t color = at + 1; color < mesh.next; color = source_.nodes[color].next)
            light_.colors.push_back(Color(color));
    }

    std::uint32_t Color(std::size_t at) const {
        const JsonNode &node = source_.nodes[at];
        bool isValid = node.kind == JsonNode::Array && node.count == 4;
        std::uint32_t code = 0;
        for (std::uint32_t i = 0; i < 4 && isValid; ++i) {
            const JsonNode &part = source_.nodes[at + 1 + i];
            isValid = part.kind == JsonNode::Integer && part.integer >= 0 &&
                      part.integer <= (i < 3 ? kJsonMaxMantissa : kJsonMaxExponent);
            code |= std::uint32_t(isValid ? part.integer : 0) << 9 * i;
        }
        if (!isValid)
            Fail(kPropMeshes, "expected colors of three mantissas in 0..511 and an exponent in 0..31");
        return code;
    }

    const JsonRecord &source_;
    PropLight &light_;
};

void WriteProp(JsonWriter &writer, const PropLight &light, const bspPropLight_t &prop, const Game &game) {
    writer.BeginObject();
    writer.Member(kPropEntity);
    writer.Value(std::int32_t(prop.entity));
    writer.Member(kPropNameCrc);
    writer.Value(CrcText(prop.nameCrc));
    writer.Member(kPropModelCrc);
    writer.Value(CrcText(prop.modelCrc));
    writer.Member(kPropMeshes);
    writer.BeginList();
    for (const bspPropMesh_t &mesh : std::span(light.meshes).subspan(prop.firstMesh, prop.meshCount)) {
        writer.Element();
        writer.BeginList();
        WriteColorCodes(writer, std::span(light.colors).subspan(mesh.firstColor, mesh.colorCount), game);
        writer.EndList();
    }
    writer.EndList();
    writer.EndObject();
}

} // namespace

bool PropsFitJson(const Bsp &bsp, Log &log) {
    const PropLight &light = *bsp.propLight;
    std::string fault = PropLightFault(bsp);
    if (fault.empty() && !light.props.empty() &&
        light.props.back().entity > INT32_MAX) // entities are in ascending order
        fault = fmt::format("entity {}, expected at most {}", light.props.back().entity, INT32_MAX);
    if (!fault.empty())
        log.Warn(kBspxPropLight, "BSPX lump {} stays in hexadecimal: {}", kBspxPropLight, fault);
    // PropLight.json must not be empty, so a lump without props stays in hexadecimal.
    return fault.empty() && !light.props.empty();
}

void ReadPropBytes(std::span<const std::byte> bytes, Bsp &bsp) {
    bsp.propLight = DecodePropLight(bytes);
}

void WriteJsonProps(FileReplacement &file, const Bsp &bsp, const Game &game) {
    const PropLight &light = *bsp.propLight;
    JsonWriter writer(file);
    writer.BeginObject();
    writer.Member(kJsonProps);
    writer.BeginList();
    for (const bspPropLight_t &prop : light.props) {
        writer.Element();
        WriteProp(writer, light, prop, game);
    }
    writer.EndList();
    writer.EndObject();
    writer.Finish();
}

void ReadJsonProps(const std::filesystem::path &path, const JsonReadRules &, Bsp &bsp) {
    PropLight light;
    ReadJsonRecords(path, kJsonProps, [&](const JsonRecord &source) {
        if (source.inList)
            PropReader(source, light).Read();
        else if (source.name == kJsonProps)
            source.Fail("expected an array");
    });
    if (light.props.empty())
        throw Error("{}: {}: missing or empty", path.string(), kJsonProps);
    bsp.propLight = std::move(light);
}

} // namespace q3
