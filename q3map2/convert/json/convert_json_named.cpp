// GPL-2.0-or-later. The SH light grid that names lights as JSON.
#include "common/error.h"
#include "q3map2/bspfile/bspfile_named.h"
#include "q3map2/convert/json/convert_json_bspx.h"
#include "q3map2/convert/json/convert_json_records.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

namespace q3 {

namespace {

constexpr std::string_view kNamedLights = "lights", kNamedPolygons = "polygons", kNamedNodes = "nodes";
constexpr std::string_view kNamedName = "name", kNamedVertices = "vertices";
constexpr std::string_view kNamedLists[] = {kNamedLights, kNamedPolygons, kNamedNodes, kJsonGridSHPoints};

constexpr std::string_view kLightTypes[] = {"point", "spot", "sun", "polygons"};
constexpr std::string_view kLightCurves[] = {"inverseSquare", "linear", "windowed", "polynomial"};
constexpr std::string_view kLightCones[] = {"radius", "angles"};

constexpr std::size_t kNodeMasks = 3;     ///< numbers of a node before its names: inner, stored, hanging
constexpr std::size_t kPointNumbers = 28; ///< numbers of a point before its shares: scale, steps

template <typename JsonArchive> void DescribeNamed(JsonArchive &a, bspNamedGridHeader_t &header) {
    auto levels = std::int32_t(header.levels);
    a.Field("mins", header.mins);
    a.Field("cell", header.cell);
    a.Field("roots", header.roots);
    a.Field("levels", levels);
    header.levels = std::uint32_t(levels);
}

/// A count or an index, which must fit an int32 in JSON. isNeeded: see FieldIf.
template <typename JsonArchive>
void DescribeNumber(JsonArchive &a, bool isNeeded, std::string_view name, std::uint32_t &number) {
    auto value = std::int32_t(number);
    a.FieldIf(isNeeded, name, value);
    a.Check(value >= 0, fmt::format("{}: expected an integer of at least 0", name));
    number = std::uint32_t(value);
}

/// Whether all floats in the bytes `begin` to `end` of a record are finite.
template <typename Record> bool IsFinite(const Record &record, std::size_t begin, std::size_t end) {
    std::array<float, sizeof(Record) / sizeof(float)> floats{};
    std::memcpy(floats.data(), &record, sizeof record);
    return std::all_of(floats.begin() + std::ptrdiff_t(begin / sizeof(float)),
                       floats.begin() + std::ptrdiff_t(end / sizeof(float)),
                       [](float value) { return std::isfinite(value); });
}

/// Members that the type or the curve of the light does not need are written only if they are not 0.
template <typename JsonArchive> void DescribeNamed(JsonArchive &a, GridLight &light) {
    a.Word(true, "type", light.type, kLightTypes);
    const bool isSpot = light.type == SHGRID_SPOT, hasPosition = isSpot || light.type == SHGRID_POINT;
    const bool isSun = light.type == SHGRID_SUN, hasPolygons = light.type == SHGRID_POLYGONS;
    a.Field("style", light.style);
    a.Check(light.style <= kLastStyle, fmt::format("style: expected an integer in 0..{}", kLastStyle));
    a.Field("color", light.color);
    a.Field("intensity", light.intensity);
    a.FieldIf(hasPosition, "origin", light.origin);
    a.FieldIf(isSpot || isSun, "normal", light.normal);

    a.Word(hasPosition, "curve", light.curve, kLightCurves);
    const bool isPolynomial = hasPosition && light.curve == SHGRID_POLYNOMIAL;
    a.FieldIf(hasPosition, "extraDist", light.extraDist);
    a.FieldIf(hasPosition, "nearest", light.nearest);
    a.FieldIf(hasPosition && light.curve == SHGRID_LINEAR, "fade", light.fade);
    a.FieldIf(isPolynomial || (hasPosition && light.curve == SHGRID_WINDOWED), "end", light.end);
    a.FieldIf(isPolynomial, "fadeFrom", light.fadeFrom);
    a.FieldIf(isPolynomial, "flatFrom", light.flatFrom);
    a.FieldIf(isPolynomial, "constant", light.constant);
    a.FieldIf(isPolynomial, "linear", light.linear);
    a.FieldIf(isPolynomial, "quadratic", light.quadratic);

    // cone: index in kLightCones.
    std::uint8_t cone = (light.flags & SHGRID_CONE_BY_ANGLES) != 0, twoSided = (light.flags & SHGRID_TWO_SIDED) != 0;
    a.Word(isSpot, "cone", cone, kLightCones);
    a.FieldIf(isSpot && cone == 1, "cosInner", light.cosInner);
    a.FieldIf(isSpot && cone == 1, "cosOuter", light.cosOuter);
    a.FieldIf(isSpot && cone == 1, "exponent", light.exponent);
    a.FieldIf(isSpot && cone == 0, "coneRadius", light.coneRadius);
    a.FieldIf(isSpot && cone == 0, "coneFade", light.coneFade);
    a.FieldIf(isSun, "spread", light.spread);
    a.FieldIf(hasPolygons, "twoSided", twoSided);
    a.Check(twoSided <= 1, "twoSided: expected 0 or 1");
    light.flags = std::uint8_t((cone != 0 ? SHGRID_CONE_BY_ANGLES : 0) | (twoSided != 0 ? SHGRID_TWO_SIDED : 0));
    DescribeNumber(a, hasPolygons, "firstPolygon", light.firstPolygon);
    DescribeNumber(a, hasPolygons, "polygonCount", light.polygonCount);
    a.Check(IsFinite(light, offsetof(GridLight, color), offsetof(GridLight, firstPolygon)), "expected finite numbers");
}

template <typename JsonArchive> void DescribeNamed(JsonArchive &a, GridPolygon &polygon) {
    a.Field("normal", polygon.normal);
    a.Field("dist", polygon.dist);
    a.Field("center", polygon.center);
    a.Field("area", polygon.area);
    a.Field("radius", polygon.radius);
    a.Check(IsFinite(polygon, offsetof(GridPolygon, normal), sizeof polygon), "expected finite numbers");
}

/// Reads the members of the file, and checks that they fit together.
class NamedJsonReader {
  public:
    NamedJsonReader(const std::filesystem::path &path, const JsonReadRules &rules) : path_(path), rules_(rules) {}

    NamedGridSH Read() {
        ReadJsonRecords(path_, kNamedLists, [this](const JsonRecord &source) { Take(source); });
        if (!hasHeader_ || grid_.nodes.empty())
            throw Error("{}: {} or {}: missing or empty", path_.string(), kJsonGridSHHeader, kNamedNodes);
        CheckLists();
        NumberNamedNodes(grid_);
        CheckNamedGrid(grid_, path_.string());
        return std::move(grid_);
    }

  private:
    void Take(const JsonRecord &source) {
        if (source.inList) {
            if (source.name == kNamedLights)
                TakeLight(source);
            else if (source.name == kNamedPolygons)
                TakePolygon(source);
            else
                source.name == kNamedNodes ? TakeNode(source) : TakePoint(source);
        } else if (source.name == kJsonGridSHHeader) {
            if (std::exchange(hasHeader_, true))
                source.Fail("is given twice");
            bspNamedGridHeader_t head;
            ReadMembers(source, head);
            grid_.mins = head.mins, grid_.cell = head.cell, grid_.roots = head.roots;
            grid_.levels = std::int32_t(head.levels);
        } else if (std::ranges::find(kNamedLists, source.name) != std::end(kNamedLists)) {
            source.Fail("expected an array");
        }
    }

    template <typename Record> void ReadMembers(const JsonRecord &source, Record &record) {
        JsonRecordReader archive(source, rules_);
        DescribeNamed(archive, record);
        archive.Finish();
    }

    void TakeLight(const JsonRecord &source) {
        GridLight &light = grid_.table.lights.emplace_back();
        ReadMembers(source, light);
        std::string name;
        JsonRecordReader(source, rules_).Text(kNamedName, name);
        if (name.find('\0') != name.npos)
            source.Fail(fmt::format("{}: expected text without NUL", kNamedName));
        light.name = std::uint32_t(grid_.table.text.size());
        grid_.table.text += name;
        grid_.table.text += '\0';
    }

    void TakePolygon(const JsonRecord &source) {
        GridPolygon &polygon = grid_.table.polygons.emplace_back();
        ReadMembers(source, polygon);
        polygon.firstVertex = std::uint32_t(grid_.table.vertices.size());
        const std::size_t list = source.Find(0, kNamedVertices);
        const JsonNode &vertices = source.nodes[list];
        if (list == 0 || vertices.kind != JsonNode::Array || vertices.count < 3 ||
            vertices.count > SHGRID_POLYGON_VERTICES)
            source.Fail(
                fmt::format("{}: expected an array of 3 to {} positions", kNamedVertices, SHGRID_POLYGON_VERTICES));
        polygon.vertexCount = std::uint32_t(vertices.count);
        for (std::size_t at = list + 1; at < vertices.next; at = source.nodes[at].next)
            grid_.table.vertices.push_back(Position(source, at));
    }

    static Float3 Position(const JsonRecord &source, std::size_t at) {
        Float3 position{};
        bool isGood = source.nodes[at].kind == JsonNode::Array && source.nodes[at].count == position.size();
        for (std::size_t axis = 0; isGood && axis < position.size(); ++axis) {
            const JsonNode &node = source.nodes[at + 1 + axis];
            isGood = (node.kind == JsonNode::Integer || node.kind == JsonNode::Real) && std::isfinite(node.real);
            position[axis] = node.real;
        }
        if (!isGood)
            source.Fail(fmt::format("{}: expected positions of 3 finite numbers", kNamedVertices));
        return position;
    }

    /// Errors: `message` if the record is not an array of `least` to `least` + UINT8_MAX elements.
    static void RequireNumbers(const JsonRecord &source, std::size_t least, std::string_view message) {
        const std::size_t count = source.nodes.size() - 1;
        if (source.nodes[0].kind != JsonNode::Array || count < least || count > least + UINT8_MAX)
            source.Fail(message);
    }
    /// Element `at` of the record. what: its name in messages. Errors: no integer in least..most.
    static std::int32_t Number(const JsonRecord &source, std::size_t at, std::string_view what, int least, int most) {
        const JsonNode &node = source.nodes[1 + at];
        if (node.kind != JsonNode::Integer || node.integer < least || node.integer > most)
            source.Fail(fmt::format("expected {} in {}..{}", what, least, most));
        return std::int32_t(node.integer);
    }

    void TakeNode(const JsonRecord &source) {
        RequireNumbers(source, kNodeMasks, "expected an array of inner, stored, hanging and at most 255 names");
        const auto mask = [&](std::size_t at) { return std::uint8_t(Number(source, at, "masks", 0, UINT8_MAX)); };
        NamedGridNode &node = grid_.nodes.emplace_back(); // NumberNamedNodes sets the other fields
        node.inner = mask(0), node.stored = mask(1), node.hanging = mask(2);
        node.nameCount = std::uint8_t(source.nodes.size() - 1 - kNodeMasks);
        for (std::size_t at = kNodeMasks; at + 1 < source.nodes.size(); ++at)
            grid_.names.push_back(std::uint16_t(Number(source, at, "numbers of lights", 0, SHGRID_LIGHTS - 1)));
    }

    void TakePoint(const JsonRecord &source) {
        RequireNumbers(source, kPointNumbers, "expected an array of a scale, 27 steps and a share for each name");
        NamedGridPoint &point = grid_.points.emplace_back();
        point.scale = std::uint8_t(Number(source, 0, "a scale", 0, UINT8_MAX));
        for (std::size_t i = 0; i < point.steps.size(); ++i)
            point.steps[i] = std::int8_t(Number(source, 1 + i, "steps", INT8_MIN, INT8_MAX));
        shareCounts_.push_back(std::uint8_t(source.nodes.size() - 1 - kPointNumbers));
        for (std::size_t at = kPointNumbers; at + 1 < source.nodes.size(); ++at)
            grid_.shares.push_back(std::uint8_t(Number(source, at, "shares", 0, UINT8_MAX)));
    }

    /// Errors: names without a light, points without a node, points with another number of shares than their node has
    /// names.
    void CheckLists() const {
        std::size_t name = 0, point = 0;
        for (std::size_t i = 0; i < grid_.nodes.size(); ++i) {
            const NamedGridNode &node = grid_.nodes[i];
            for (const std::size_t end = name + node.nameCount; name < end; ++name)
                if (grid_.names[name] >= grid_.table.lights.size())
                    throw Error("{}: {}[{}]: names light {}, but there are {} lights", path_.string(), kNamedNodes, i,
                                grid_.names[name], grid_.table.lights.size());
            for (const std::size_t end = point + std::size_t(std::popcount(node.stored)); point < end; ++point)
                if (point >= shareCounts_.size() || shareCounts_[point] != node.nameCount)
                    throw Error("{}: {}[{}]: expected {} shares as {}[{}] has names, found {}", path_.string(),
                                kJsonGridSHPoints, point, node.nameCount, kNamedNodes, i,
                                point < shareCounts_.size() ? fmt::format("{}", shareCounts_[point]) : "no point");
        }
        if (point != grid_.points.size())
            throw Error("{}: {}: expected {} points as the nodes store, found {}", path_.string(), kJsonGridSHPoints,
                        point, grid_.points.size());
    }

    const std::filesystem::path &path_;
    const JsonReadRules &rules_;
    NamedGridSH grid_;
    bool hasHeader_ = false;
    std::vector<std::uint8_t> shareCounts_; ///< by point
};

/// Writes the members of the file. Nodes and points take one line each.
class NamedJsonWriter {
  public:
    NamedJsonWriter(FileReplacement &file, const NamedGridSH &grid, const Game &game)
        : writer_(file), grid_(grid), game_(game) {}

    void Write() {
        bspNamedGridHeader_t head;
        head.mins = grid_.mins, head.cell = grid_.cell, head.roots = grid_.roots;
        head.levels = std::uint32_t(grid_.levels);
        writer_.BeginObject();
        writer_.Member(kJsonGridSHHeader);
        WriteMembers(head, [] {});
        List(kNamedLights, grid_.table.lights, [this](const GridLight &light) { WriteLight(light); });
        List(kNamedPolygons, grid_.table.polygons, [this](const GridPolygon &polygon) { WritePolygon(polygon); });
        List(kNamedNodes, grid_.nodes, [this](const NamedGridNode &node) { WriteNode(node); });
        writer_.Member(kJsonGridSHPoints);
        writer_.BeginList();
        for (const NamedGridNode &node : grid_.nodes)
            for (std::size_t i = 0; i < std::size_t(std::popcount(node.stored)); ++i)
                WritePoint(grid_.points[node.points + i],
                           std::span(grid_.shares).subspan(node.shares + i * node.nameCount, node.nameCount));
        writer_.EndList();
        writer_.EndObject();
        writer_.Finish();
    }

  private:
    template <typename Records, typename WriteOne>
    void List(std::string_view name, const Records &records, const WriteOne &writeOne) {
        writer_.Member(name);
        writer_.BeginList();
        for (const auto &record : records) {
            writer_.Element();
            writeOne(record);
        }
        writer_.EndList();
    }

    /// Writes a record as an object. more: writes further members of it.
    template <typename Record, typename More> void WriteMembers(Record record, const More &more) {
        JsonRecordWriter archive(writer_, game_);
        DescribeNamed(archive, record);
        more();
        archive.Finish();
    }

    void WriteLight(const GridLight &light) {
        WriteMembers(light, [&] {
            writer_.Member(kNamedName);
            writer_.Value(std::string_view(grid_.table.text.c_str() + light.name));
        });
    }

    void WritePolygon(const GridPolygon &polygon) {
        WriteMembers(polygon, [&] {
            writer_.Member(kNamedVertices);
            writer_.Value(std::span(grid_.table.vertices).subspan(polygon.firstVertex, polygon.vertexCount));
        });
    }

    void WriteNode(const NamedGridNode &node) {
        line_ = {node.inner, node.stored, node.hanging};
        const auto names = std::span(grid_.names).subspan(node.names, node.nameCount);
        line_.insert(line_.end(), names.begin(), names.end());
        writer_.Value(std::span(line_));
    }

    void WritePoint(const NamedGridPoint &point, std::span<const std::uint8_t> shares) {
        line_ = {point.scale};
        line_.insert(line_.end(), point.steps.begin(), point.steps.end());
        line_.insert(line_.end(), shares.begin(), shares.end());
        writer_.Element();
        writer_.Value(std::span(line_));
    }

    JsonWriter writer_;
    const NamedGridSH &grid_;
    const Game &game_;
    std::vector<std::int32_t> line_; ///< numbers of the node or point that is written
};

} // namespace

/// JSON has no offsets of names and vertices: they must follow each other in the order of lights and polygons.
bool NamedFitsJson(const Bsp &bsp, Log &) {
    const GridLights &table = bsp.namedGridSH->table;
    std::size_t text = 0, vertices = 0;
    for (const GridLight &light : table.lights) {
        if (light.name != text)
            return false;
        text += std::strlen(table.text.c_str() + light.name) + 1;
    }
    for (const GridPolygon &polygon : table.polygons) {
        if (polygon.firstVertex != vertices)
            return false;
        vertices += polygon.vertexCount;
    }
    return text == table.text.size() && vertices == table.vertices.size();
}

void ReadNamedBytes(std::span<const std::byte> bytes, Bsp &bsp) {
    bsp.namedGridSH = DecodeNamedGrid(bytes);
}

void WriteJsonNamedGrid(FileReplacement &file, const Bsp &bsp, const Game &game) {
    NamedJsonWriter(file, *bsp.namedGridSH, game).Write();
}

void ReadJsonNamedGrid(const std::filesystem::path &path, const JsonReadRules &rules, Bsp &bsp) {
    bsp.namedGridSH = NamedJsonReader(path, rules).Read();
}

} // namespace q3
