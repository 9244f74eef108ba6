// GPL-2.0-or-later. Writes a record to JSON and reads it back; Describe() lists the members for both.
#pragma once

#include "q3map2/convert/game/game_flags.h"
#include "q3map2/convert/json/convert_json.h"
#include "q3map2/convert/json/convert_json_read.h"
#include "q3map2/convert/json/convert_json_write.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace q3 {

/// Extra member of a record with a NaN other than the usual one: the bits of all its NaNs, in member order.
inline constexpr std::string_view kJsonNanBits = "nanBits";

/// Writes one record. Bytes behind the NUL of a name and bits of unusual NaNs follow as extra members.
class JsonRecordWriter {
  public:
    JsonRecordWriter(JsonWriter &writer, const Game &game) : writer_(writer), game_(game) {}

    template <typename T> void Field(std::string_view name, const T &value) {
        Open();
        writer_.Member(name);
        writer_.Value(value);
        NoteNans(value);
    }
    /// A member that not every record needs: left out if it is not needed and all its bytes are 0.
    template <typename T> void FieldIf(bool isNeeded, std::string_view name, const T &value) {
        const auto bytes = std::as_bytes(std::span(&value, 1));
        if (isNeeded || std::ranges::any_of(bytes, [](std::byte byte) { return byte != std::byte{}; }))
            Field(name, value);
    }
    /// Writes the record as a bare value instead of an object.
    template <typename T> void Whole(const T &value) {
        isBareValue_ = true;
        writer_.Value(value);
    }
    /// Writes an object with what `members` writes.
    template <typename Members> void Group(std::string_view name, const Members &members) {
        Open();
        writer_.Member(name);
        writer_.BeginObject();
        members();
        writer_.EndObject();
    }
    void Text(std::string_view name, const std::string &value) { Field(name, std::string_view(value)); }
    /// A word of a table: that at index `value`, which is in it. Left out if it is not needed and the first.
    void Word(bool isNeeded, std::string_view name, std::uint8_t value, std::span<const std::string_view> words) {
        if (isNeeded || value != 0)
            Field(name, words[value]);
    }
    /// Writes member `second` if `other` is not empty, else member `first`.
    void OneOf(std::string_view first, const std::string &value, std::string_view second, const std::string &other) {
        other.empty() ? Text(first, value) : Text(second, other);
    }
    void Name(std::string_view name, const std::array<char, 64> &field);
    /// An object with a member for each named part of the value: see SplitFlags.
    void Flags(std::string_view name, std::uint32_t value, FlagKind kind);
    /// A member of that name for each pair, an array of key and value.
    void Pairs(std::string_view name, const std::vector<std::pair<std::string, std::string>> &pairs);
    /// Values of the program itself are in range.
    void Check(bool, std::string_view) {}
    /// Call once after the last member.
    void Finish();

  private:
    void Open() {
        if (!std::exchange(open_, true))
            writer_.BeginObject();
    }
    template <typename T> void NoteNans(const T &) {}
    template <typename T, std::size_t N> void NoteNans(const std::array<T, N> &values) {
        for (const T &value : values)
            NoteNans(value);
    }
    void NoteNans(float value) {
        if (std::isnan(value))
            NoteNan(value);
    }
    void NoteNan(float value);

    JsonWriter &writer_;
    const Game &game_;
    bool open_ = false, isBareValue_ = false, hasOddNans_ = false;
    /// Extra members: all bytes, in hexadecimal, of name fields that the name and zeros do not reproduce.
    std::vector<std::pair<std::string, std::string>> nameBytes_;
    std::vector<std::string> nanBits_; ///< of every NaN of the record, in member order
};

/// Context of reading a record.
struct JsonReadRules {
    const Game &game;
    const PackJsonOptions &options;
    Log &log;
};

/// Reads one record. Errors: Error with file, record, member and what was expected.
class JsonRecordReader {
  public:
    JsonRecordReader(const JsonRecord &record, const JsonReadRules &rules);

    // Each function down to Finish is the counterpart of the writer's function of the same name.
    template <typename T> void Field(std::string_view name, T &value) {
        if (!Read(Require(name), value))
            Fail(name, "expected " + Expected<T>());
    }
    template <typename T> void FieldIf(bool isNeeded, std::string_view name, T &value) {
        if (isNeeded || Has(name))
            Field(name, value);
        else
            value = {};
    }
    template <typename T> void Whole(T &value) {
        if (!Read(0, value))
            record_.Fail("expected " + Expected<T>());
    }
    template <typename Members> void Group(std::string_view name, const Members &members) {
        const std::size_t node = Require(name);
        if (record_.nodes[node].kind != JsonNode::Object)
            Fail(name, "expected an object");
        const auto outer = std::exchange(object_, node);
        group_ = name;
        members();
        object_ = outer;
        group_ = {};
    }
    void Text(std::string_view name, std::string &value);
    void Word(bool isNeeded, std::string_view name, std::uint8_t &value, std::span<const std::string_view> words);
    void OneOf(std::string_view first, std::string &value, std::string_view second, std::string &other);
    void Name(std::string_view name, std::array<char, 64> &field);
    void Flags(std::string_view name, std::uint32_t &value, FlagKind kind);
    void Pairs(std::string_view name, std::vector<std::pair<std::string, std::string>> &pairs);
    /// Error with the text unless the values that were read are in range.
    void Check(bool holds, std::string_view text) const {
        if (!holds)
            record_.Fail(text);
    }
    void Finish();

  private:
    template <typename T> struct IsArray : std::false_type {};
    template <typename T, std::size_t N> struct IsArray<std::array<T, N>> : std::true_type {};

    bool Read(std::size_t node, float &value);
    bool Read(std::size_t node, std::int32_t &value) const;
    bool Read(std::size_t node, std::uint8_t &value) const;
    template <typename T, std::size_t N> bool Read(std::size_t node, std::array<T, N> &values) {
        if (record_.nodes[node].kind != JsonNode::Array || record_.nodes[node].count != N)
            return false;
        std::size_t child = node + 1;
        for (T &value : values) {
            if (!Read(child, value))
                return false;
            child = record_.nodes[child].next;
        }
        return true;
    }

    template <typename T> static std::string Expected() {
        if constexpr (IsArray<T>::value)
            return ExpectedCount<T>() + ExpectedUnit<T>();
        else
            return (std::is_same_v<T, float> ? "a " : "an ") + ExpectedUnit<T>();
    }
    template <typename T> static std::string ExpectedCount() {
        using Element = typename T::value_type;
        const std::string count = std::to_string(std::tuple_size_v<T>) + ' ';
        if constexpr (IsArray<Element>::value)
            return count + "x " + ExpectedCount<Element>();
        else
            return count;
    }
    template <typename T> static std::string ExpectedUnit(std::string_view plural = "") {
        if constexpr (IsArray<T>::value)
            return ExpectedUnit<typename T::value_type>("s");
        else
            return fmt::format("{}{}{}", std::is_same_v<T, float> ? "number" : "integer", plural,
                               std::is_same_v<T, float>          ? ""
                               : std::is_same_v<T, std::uint8_t> ? " in 0..255"
                                                                 : " in -2147483648..2147483647");
    }

    bool Has(std::string_view name) const;
    std::size_t Require(std::string_view name) const;
    std::string_view RequireText(std::string_view name) const;
    std::uint32_t FlagBits(std::string_view member, const JsonNode &node, FlagKind kind) const;
    [[noreturn]] void Fail(std::string_view name, std::string_view text) const;

    const JsonRecord &record_;
    const JsonReadRules &rules_;
    std::size_t object_ = 0;             ///< node whose members are read
    std::string_view group_;             ///< name of object_; empty: the record itself
    std::vector<std::uint32_t> nanBits_; ///< from kJsonNanBits; empty: all NaNs are the usual one
    std::size_t nanCount_ = 0;           ///< NaNs read so far
};

/// Parses hexadecimal text. False: an odd number of digits or any other character.
bool ParseHexText(std::string_view text, std::vector<std::byte> &bytes);

} // namespace q3
