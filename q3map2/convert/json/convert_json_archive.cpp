// GPL-2.0-or-later. Writes a record to JSON and reads it back.
#include "q3map2/convert/json/convert_json_archive.h"

#include "common/error.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <span>

namespace q3 {

namespace {

constexpr std::uint32_t kPlainNan = 0x7FC00000; ///< bits of the NaN that the word NaN of JSON text stands for
constexpr std::size_t kMaxName = 63;            ///< bytes of a name: the field of 64 ends in NUL
constexpr std::string_view kBytesSuffix = "Bytes";

/// The field of a name: padded with zeros.
std::array<char, 64> PlainName(std::string_view name) {
    std::array<char, 64> field{};
    std::ranges::copy(name, field.begin());
    return field;
}

std::string BitsText(std::uint32_t bits) {
    return fmt::format("0x{:08x}", bits);
}

int HexDigit(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

} // namespace

bool ParseHexText(std::string_view text, std::vector<std::byte> &bytes) {
    bytes.clear();
    if (text.size() % 2 != 0)
        return false;
    bytes.reserve(text.size() / 2);
    for (std::size_t i = 0; i < text.size(); i += 2) {
        const int high = HexDigit(text[i]), low = HexDigit(text[i + 1]);
        if (high < 0 || low < 0)
            return false;
        bytes.push_back(std::byte(high * 16 + low));
    }
    return true;
}

void JsonRecordWriter::Name(std::string_view name, const std::array<char, 64> &field) {
    const std::string_view text = FieldName(field);
    Field(name, text);
    if (text.size() > kMaxName || PlainName(text) != field)
        nameBytes_.emplace_back(std::string(name).append(kBytesSuffix), HexText(std::as_bytes(std::span(field))));
}

void JsonRecordWriter::Flags(std::string_view name, std::uint32_t value, FlagKind kind) {
    Group(name, [&] {
        for (const auto &[flag, bits] : SplitFlags(value, game_, kind))
            Text(flag, BitsText(bits));
    });
}

void JsonRecordWriter::Pairs(std::string_view name, const std::vector<std::pair<std::string, std::string>> &pairs) {
    for (const auto &[key, value] : pairs)
        Field(name, std::array<std::string_view, 2>{key, value});
}

void JsonRecordWriter::NoteNan(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    hasOddNans_ |= bits != kPlainNan;
    nanBits_.push_back(BitsText(bits));
}

void JsonRecordWriter::Finish() {
    if (isBareValue_)
        return;
    for (const auto &[name, bytes] : nameBytes_)
        Text(name, bytes);
    Open();
    if (hasOddNans_) {
        writer_.Member(kJsonNanBits);
        writer_.Value(nanBits_);
    }
    writer_.EndObject();
}

JsonRecordReader::JsonRecordReader(const JsonRecord &record, const JsonReadRules &rules)
    : record_(record), rules_(rules) {
    if (record.nodes[0].kind != JsonNode::Object)
        return;
    const std::size_t list = record.Find(0, kJsonNanBits);
    if (list == 0)
        return;
    for (std::size_t at = list + 1; at < record.nodes[list].next; at = record.nodes[at].next) {
        std::uint32_t bits = 0;
        if (!ParseFlagNumber(record.Text(record.nodes[at]), bits) || !std::isnan(std::bit_cast<float>(bits)))
            record.Fail("nanBits: expected the bits of a NaN such as \"0x7fc00001\"");
        nanBits_.push_back(bits);
    }
    if (nanBits_.empty())
        record.Fail("nanBits: expected an array of bits such as \"0x7fc00001\"");
}

bool JsonRecordReader::Has(std::string_view name) const {
    return record_.nodes[0].kind == JsonNode::Object && record_.Find(object_, name) != 0;
}

std::size_t JsonRecordReader::Require(std::string_view name) const {
    if (record_.nodes[0].kind != JsonNode::Object)
        record_.Fail("expected an object");
    const std::size_t node = record_.Find(object_, name);
    if (node == 0)
        Fail(name, "missing");
    return node;
}

std::string_view JsonRecordReader::RequireText(std::string_view name) const {
    const JsonNode &node = record_.nodes[Require(name)];
    if (node.kind != JsonNode::Text)
        Fail(name, "expected a string");
    return record_.Text(node);
}

void JsonRecordReader::Fail(std::string_view name, std::string_view text) const {
    record_.Fail(fmt::format("{}{}{}: {}", group_, group_.empty() ? "" : ".", name, text));
}

// JSON text spells all NaNs alike. If one is not kPlainNan, nanBits lists the bits of all NaNs of the record.
bool JsonRecordReader::Read(std::size_t node, float &value) {
    const JsonNode &source = record_.nodes[node];
    if (source.kind != JsonNode::Integer && source.kind != JsonNode::Real && !source.special)
        return false;
    value = source.real;
    if (std::isnan(value)) {
        if (nanCount_ < nanBits_.size())
            value = std::bit_cast<float>(nanBits_[nanCount_]);
        nanCount_++;
    }
    return true;
}

bool JsonRecordReader::Read(std::size_t node, std::int32_t &value) const {
    const JsonNode &source = record_.nodes[node];
    if (source.kind != JsonNode::Integer || source.integer < std::numeric_limits<std::int32_t>::min() ||
        source.integer > std::numeric_limits<std::int32_t>::max())
        return false;
    value = std::int32_t(source.integer);
    return true;
}

bool JsonRecordReader::Read(std::size_t node, std::uint8_t &value) const {
    const JsonNode &source = record_.nodes[node];
    if (source.kind != JsonNode::Integer || source.integer < 0 || source.integer > 255)
        return false;
    value = std::uint8_t(source.integer);
    return true;
}

void JsonRecordReader::Text(std::string_view name, std::string &value) {
    value = RequireText(name);
}

void JsonRecordReader::Word(bool isNeeded, std::string_view name, std::uint8_t &value,
                            std::span<const std::string_view> words) {
    value = 0;
    if (!isNeeded && !Has(name))
        return;
    const auto found = std::ranges::find(words, RequireText(name));
    if (found == words.end())
        Fail(name, fmt::format("expected one of: {}", fmt::join(words, ", ")));
    value = std::uint8_t(found - words.begin());
}

void JsonRecordReader::OneOf(std::string_view first, std::string &value, std::string_view second, std::string &other) {
    Require(record_.Find(object_, second) != 0 ? second : first);
    record_.Find(object_, second) != 0 ? Text(second, other) : Text(first, value);
}

void JsonRecordReader::Name(std::string_view name, std::array<char, 64> &field) {
    const std::string_view text = RequireText(name);
    if (text.find('\0') != text.npos)
        Fail(name, "expected a name without NUL");
    const std::string bytesName = std::string(name).append(kBytesSuffix);
    if (record_.Find(object_, bytesName) != 0) {
        std::vector<std::byte> bytes;
        if (!ParseHexText(RequireText(bytesName), bytes) || bytes.size() != field.size())
            Fail(bytesName, "expected 128 hexadecimal digits");
        std::memcpy(field.data(), bytes.data(), field.size());
        // If the name was edited since, these bytes belong to the old name and are ignored.
        if (FieldName(field) == text)
            return;
    }
    if (text.size() > kMaxName)
        Fail(name, fmt::format("expected at most {} bytes, found {}", kMaxName, text.size()));
    field = PlainName(text);
}

void JsonRecordReader::Flags(std::string_view name, std::uint32_t &value, FlagKind kind) {
    const std::size_t object = Require(name);
    if (record_.nodes[object].kind != JsonNode::Object)
        Fail(name, "expected an object");
    value = 0;
    for (std::size_t at = object + 1; at < record_.nodes[object].next; at = record_.nodes[at].next)
        value |= FlagBits(name, record_.nodes[at], kind);
}

std::uint32_t JsonRecordReader::FlagBits(std::string_view member, const JsonNode &node, FlagKind kind) const {
    const std::string_view flag = record_.Name(node);
    if (rules_.options.useFlagNames) {
        if (const SurfaceParm *parm = rules_.game.FindParm(flag))
            return ParmBits(*parm, kind);
        rules_.log.Warn("unknown flag", "{}: {}: {}: game {} has no flag {}, {}", record_.file, record_.Label(), member,
                        rules_.game.name, ShownText(flag),
                        rules_.options.dropUnknownFlags ? "it is dropped" : "its value is used");
        if (rules_.options.dropUnknownFlags)
            return 0;
    }
    std::uint32_t bits = 0;
    if (node.kind != JsonNode::Text || !ParseFlagNumber(record_.Text(node), bits))
        Fail(member, fmt::format("{}: expected a number in quotes such as \"0x00000001\"", ShownText(flag)));
    return bits;
}

void JsonRecordReader::Pairs(std::string_view name, std::vector<std::pair<std::string, std::string>> &pairs) {
    const auto &nodes = record_.nodes;
    if (nodes[0].kind != JsonNode::Object)
        record_.Fail("expected an object");
    for (std::size_t at = 1; at < nodes[0].next; at = nodes[at].next) {
        if (record_.Name(nodes[at]) != name)
            continue;
        const bool two = nodes[at].kind == JsonNode::Array && nodes[at].count == 2;
        if (!two || nodes[at + 1].kind != JsonNode::Text || nodes[at + 2].kind != JsonNode::Text)
            Fail(name, "expected 2 strings");
        std::string key(record_.Text(nodes[at + 1])), value(record_.Text(nodes[at + 2]));
        for (const std::string &text : {key, value})
            if (text.find('"') != text.npos || text.find('\0') != text.npos)
                Fail(name, fmt::format("{}: entity text cannot hold a quote or NUL inside a string", ShownText(key)));
        pairs.emplace_back(std::move(key), std::move(value));
    }
}

void JsonRecordReader::Finish() {
    if (!nanBits_.empty() && nanCount_ != nanBits_.size())
        record_.Fail(fmt::format("nanBits: expected {} entries, one for every NaN of the record, found {}", nanCount_,
                                 nanBits_.size()));
}

} // namespace q3
