// GPL-2.0-or-later. Light at the vertices of static props: the BSPX lump STATIC_PROP_LIGHT.
#include "q3map2/bspfile/prop_light.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/entities.h"

#include <cstring>
#include <limits>

namespace q3 {

namespace {

/// The generator polynomial of CRC-32 (ISO 3309), x^32 left out, its lowest power in the highest bit.
constexpr std::uint32_t kCrcPolynomial = 0xEDB88320u;

/// kCrcTable[b]: the CRC register after byte b, if it was 0 before.
constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t value = i;
        for (int bit = 0; bit < 8; ++bit)
            value = (value & 1) != 0 ? value >> 1 ^ kCrcPolynomial : value >> 1;
        table[i] = value;
    }
    return table;
}();

std::uint32_t CheckedCount(std::size_t count, std::string_view what) {
    if (count > std::numeric_limits<std::uint32_t>::max())
        throw Error("{}: {} {}, expected at most {}", kBspxPropLight, count, what,
                    std::numeric_limits<std::uint32_t>::max());
    return std::uint32_t(count);
}

template <typename Record> std::vector<Record> TakeRecords(std::span<const std::byte> &bytes, std::uint32_t count) {
    std::vector<Record> records(count);
    if (count > 0)
        std::memcpy(records.data(), bytes.data(), sizeof(Record) * count);
    bytes = bytes.subspan(sizeof(Record) * count);
    return records;
}

/// Errors: props or meshes that do not follow each other, or that do not cover all of what they index.
void CheckOrder(const PropLight &light) {
    std::uint64_t mesh = 0, color = 0;
    for (std::size_t i = 0; i < light.props.size(); ++i) {
        const bspPropLight_t &prop = light.props[i];
        if (i > 0 && prop.entity <= light.props[i - 1].entity)
            throw Error("prop {}: entity {} after entity {}", i, prop.entity, light.props[i - 1].entity);
        if (prop.firstMesh != mesh)
            throw Error("prop {}: firstMesh {}, expected {}", i, prop.firstMesh, mesh);
        mesh += prop.meshCount;
    }
    if (mesh != light.meshes.size())
        throw Error("the props have {} meshes, expected {}", mesh, light.meshes.size());
    for (std::size_t i = 0; i < light.meshes.size(); ++i) {
        if (light.meshes[i].firstColor != color)
            throw Error("mesh {}: firstColor {}, expected {}", i, light.meshes[i].firstColor, color);
        color += light.meshes[i].colorCount;
    }
    if (color != light.colors.size())
        throw Error("the meshes have {} colors, expected {}", color, light.colors.size());
}

} // namespace

std::uint32_t Crc32(std::span<const std::byte> bytes) {
    std::uint32_t crc = ~0u;
    for (const std::byte byte : bytes)
        crc = crc >> 8 ^ kCrcTable[(crc ^ std::uint32_t(byte)) & 0xFF];
    return ~crc;
}

std::uint32_t ModelNameCrc(std::string_view model) {
    const std::string lower = LowerCase(model);
    return Crc32(std::as_bytes(std::span(lower.data(), lower.size())));
}

ByteRanges PropLightRanges(const PropLight &light) {
    bspPropLightHeader_t header;
    header.propCount = CheckedCount(light.props.size(), "props");
    header.meshCount = CheckedCount(light.meshes.size(), "meshes");
    header.colorCount = CheckedCount(light.colors.size(), "colors");
    ByteRanges bytes;
    bytes.AddCopy(header);
    bytes.Add(light.props);
    bytes.Add(light.meshes);
    bytes.Add(light.colors);
    return bytes;
}

std::vector<std::byte> EncodePropLight(const PropLight &light) {
    return PropLightRanges(light).Bytes();
}

PropLight DecodePropLight(std::span<const std::byte> lump) {
    if (lump.size() < sizeof(bspPropLightHeader_t))
        throw Error("length {} is under the {} of its head", lump.size(), sizeof(bspPropLightHeader_t));
    std::span<const std::byte> rest = lump;
    const bspPropLightHeader_t header = TakeRecords<bspPropLightHeader_t>(rest, 1).front();
    if (header.magic != bspPropLightHeader_t{}.magic)
        throw Error("does not start with SPL1");
    if (header.version != 1)
        throw Error("version {}, expected 1", header.version);
    const std::uint64_t expected = std::uint64_t(header.propCount) * sizeof(bspPropLight_t) +
                                   std::uint64_t(header.meshCount) * sizeof(bspPropMesh_t) +
                                   std::uint64_t(header.colorCount) * sizeof(std::uint32_t);
    if (rest.size() != expected)
        throw Error("length {}, expected {} for {} props, {} meshes and {} colors", lump.size(),
                    expected + sizeof header, header.propCount, header.meshCount, header.colorCount);
    PropLight light;
    light.props = TakeRecords<bspPropLight_t>(rest, header.propCount);
    light.meshes = TakeRecords<bspPropMesh_t>(rest, header.meshCount);
    light.colors = TakeRecords<std::uint32_t>(rest, header.colorCount);
    CheckOrder(light);
    return light;
}

std::optional<PropLight> ReadPropLight(const BspxSource &from) {
    try {
        return DecodePropLight(from.Bytes());
    } catch (const Error &error) {
        from.log.Warn(from.lump, "{}: BSPX lump {} is dropped: {}", from.fileName, from.lump, error.what());
        return {};
    }
}

std::string PropLightFault(const Bsp &bsp) {
    if (!bsp.propLight)
        return {};
    try {
        CheckOrder(*bsp.propLight);
        const std::vector<Entity> entities = StoredEntities(bsp.entities, "entities");
        for (const bspPropLight_t &prop : bsp.propLight->props) {
            if (prop.entity >= entities.size())
                throw Error("entity {} is not one of {}", prop.entity, entities.size());
            if (const auto model = entities[prop.entity].Value("model"); ModelNameCrc(model) != prop.nameCrc)
                throw Error("entity {} has another model now, \"{}\"", prop.entity, model);
        }
    } catch (const Error &error) {
        return error.what();
    }
    return {};
}

} // namespace q3
